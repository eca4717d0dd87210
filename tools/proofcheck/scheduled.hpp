#pragma once

#include "full_order.hpp"
#include "jerk.hpp"

namespace {

// ----------------------------------------------------------------- 14, the law of scheduled PD
//
// Its torque is u_L = u0 - M' (w^2 y + 2 w dy), u0 and M' polynomials of phase and level whose
// coefficients stand in the file: they are what the law is, and nothing else of it is read. With M the
// inertia that the outputs feel, u_L gives ddy = -w^2 y - 2 w dy + e_L, and a torque that is off by M e
// gives e more. docs/level5_law.md has the premises.

// Accelerations of the coordinates per unit of each direction of what is added to ddy, a column each.
template <class S>
vector<vector<S>> pushed(Motion<S>& p, const Matrix& directions) {
  const size_t m = directions.size();
  vector<vector<S>> found;
  for (size_t one = 0; one < m; ++one) {
    vector<S> more;
    for (size_t j = 0; j < m; ++j) more.push_back(S(directions[j][one]));
    const vector<S> alone = link_angles(p.robot, p.lifted(S(I(0.0)), more));
    const S gives = -(p.pose().momentum(alone) / p.transversal());  // ddz1.
    for (size_t j = 0; j < m; ++j) more[j] = more[j] + gives * p.outputs().d1[j];
    found.push_back(p.lifted(gives, more));
  }
  return found;
}

// Torques of the joints per unit of accelerations of the coordinates.
template <class S>
vector<S> torque_of(Motion<S>& p, const vector<S>& accelerations) {
  const vector<S> w = link_angles(p.robot, accelerations);
  return without_first(p.pose().momenta(p.pose().velocities(w), w));
}

template <class S>
using Square = vector<vector<S>>;  // A matrix, row by row.

// The inertia that these directions feel: torques of the joints.
template <class S>
Square<S> inertia(Motion<S>& p, const Matrix& directions) {
  Square<S> found(directions.size());
  for (const vector<S>& one : pushed(p, directions)) {
    const vector<S> torque = torque_of(p, one);
    for (size_t i = 0; i < found.size(); ++i) found[i].push_back(torque[i]);
  }
  return found;
}

template <class S>
vector<S> minus(vector<S> a, const vector<S>& b) {
  for (size_t i = 0; i < a.size(); ++i) a[i] = a[i] - b[i];
  return a;
}
template <class S>
vector<S> plus(vector<S> a, const vector<S>& b) {
  for (size_t i = 0; i < a.size(); ++i) a[i] = a[i] + b[i];
  return a;
}
template <class S>
vector<S> scaled(const I& k, vector<S> a) {
  for (S& one : a) one = k * one;
  return a;
}
template <class S>
vector<S> times(const Square<S>& matrix, const vector<S>& x) {
  vector<S> out;
  for (const vector<S>& row : matrix) {
    S total(0.0);
    for (size_t j = 0; j < x.size(); ++j) total = total + row[j] * x[j];
    out.push_back(total);
  }
  return out;
}

vector<Formula> values(const vector<DualOf<Formula>>& all) {
  vector<Formula> out;
  for (const DualOf<Formula>& one : all) out.push_back(one.v);
  return out;
}
vector<Formula> rates(const vector<DualOf<Formula>>& all) {
  vector<Formula> out;
  for (const DualOf<Formula>& one : all) out.push_back(one.d);
  return out;
}
vector<DualOf<Formula>> still(const vector<Formula>& all) { return {all.begin(), all.end()}; }

// x of a x = b, with its derivative: a dx = db - da x. The values of a are eliminated once.
vector<DualOf<Formula>> solved_with_rates(const Square<DualOf<Formula>>& a,
                                          const vector<DualOf<Formula>>& b) {
  Square<Formula> now;
  for (const auto& row : a) now.push_back(values(row));
  vector<DualOf<Formula>> x = still(solved(now, values(b)));
  const vector<Formula> more = solved(now, rates(minus(b, times(a, x))));
  for (size_t i = 0; i < x.size(); ++i) x[i].d = more[i];
  return x;
}

// Torques of exact linearisation with these accelerations of the outputs: in a state, or in one that
// moves, its z too.
vector<Formula> exact_torque(FullState&, Motion<Formula>& p, const vector<Formula>& ddy) {
  return torques(p, acceleration(p, ddy, bends(p.jets())));
}
vector<DualOf<Formula>> exact_torque(FullState& f, FullState::Moved& p,
                                     const vector<DualOf<Formula>>& ddy) {
  const auto jets = desired_outputs(f.model.policy, f.here, p.phase().v, p.z1.v, p.z2.v, 3);
  return torques(p, acceleration(p, ddy, bends(jets, p.z1.d, p.z2.d)));
}

// A phase and a level, by which polynomials go.
template <class S>
struct ChartPoint { S phase, level; };

template <class S>
ChartPoint<S> chart_of(Motion<S>& p) {
  return {phase_of(p.step, p.z1), level_of(p.step, p.z1, p.z2)};
}

inline DualOf<Formula> sum(const vector<double>& series, const vector<DualOf<Formula>>& of) {
  return {sum(series, values(of)), sum(series, rates(of))};
}

// u0 and M' of the file: Chebyshev series of phase and level.
class Schedule {
 public:
  Schedule(const Disturbed& its, size_t joints) : m_(joints) {
    for (const Degrees& known : kDegrees)
      if (its.torque_gains.size() == m_ * known.torque.count() &&
          its.inertia_gains.size() == m_ * m_ * known.inertia.count()) {
        torque_ = split(its.torque_gains, known.torque);
        inertia_ = split(its.inertia_gains, known.inertia);
        degrees_ = known;
        return;
      }
    throw Inconsistent{"gains of level 5 that are no polynomials of phase and level of " +
                       std::to_string(joints) + " joints, of the degrees that the law has"};
  }

  template <class S>
  vector<S> torque(const ChartPoint<S>& at) const { return value(torque_, degrees_.torque, at); }
  template <class S>
  Square<S> inertia(const ChartPoint<S>& at) const {
    const vector<S> flat = value(inertia_, degrees_.inertia, at);
    Square<S> rows;
    for (size_t i = 0; i < m_; ++i)
      rows.emplace_back(flat.begin() + static_cast<long>(i * m_),
                        flat.begin() + static_cast<long>((i + 1) * m_));
    return rows;
  }

 private:
  // The series are of what is -1 and 1 this far beyond the tube.
  static constexpr double kBeyondPhase = 0.04, kBeyondLevel = 0.1;
  struct Degree {
    size_t phase = 0, level = 0;
    size_t count() const { return (phase + 1) * (level + 1); }
  };
  struct Degrees { Degree torque, inertia; };
  static constexpr Degrees kDegrees[] = {{{16, 8}, {10, 3}}, {{16, 5}, {8, 2}}};
  const size_t m_;
  Degrees degrees_;
  vector<vector<double>> torque_, inertia_;  // Series in level, for each degree in phase of each.

  static vector<vector<double>> split(const vector<double>& all, const Degree& degree) {
    vector<vector<double>> rows;
    const auto length = static_cast<long>(degree.level + 1);
    for (auto from = all.begin(); from != all.end(); from += length)
      rows.emplace_back(from, from + length);
    return rows;
  }

  // Chebyshev polynomials of x = (2 u - 1) / (1 + 2 beyond).
  template <class S>
  static vector<S> polynomials(const S& u, double beyond, size_t degree) {
    const I width = I(1.0) + I(2.0) * I(beyond);
    const S x = inverse(width) * (I(2.0) * u - S(I(1.0)));
    return chebyshev<S>(I(0.5) * x + S(I(0.5)), degree + 1);
  }

  template <class S>
  static vector<S> value(const vector<vector<double>>& rows, const Degree& degree,
                         const ChartPoint<S>& at) {
    const vector<S> along = polynomials(at.phase, kBeyondPhase, degree.phase),
                    across = polynomials(at.level, kBeyondLevel, degree.level);
    vector<S> found;
    for (size_t k = 0; k < rows.size();) {
      S total(0.0);
      for (size_t i = 0; i <= degree.phase; ++i, ++k) total = total + sum(rows[k], across) * along[i];
      found.push_back(total);
    }
    return found;
  }
};

// What the law makes of states: in the norm of S where a name has S in its comment.
class ScheduledLaw {
 public:
  ScheduledLaw(const Disturbed& its, FullState& f)
      : f_(f), schedule_(its, f.joints), here_{f.phase, f.level} {}

  // w^2 y + 2 w dy, of outputs that may all be zero.
  template <class S>
  vector<S> pull(const Motion<S>& p) const {
    return p.off ? scaled(I(-1.0), p.off->ddy()) : vector<S>(f_.joints, S(0.0));
  }

  // u_L at a phase and level.
  template <class S>
  vector<S> torque(const Motion<S>& p, const ChartPoint<S>& at) const {
    return minus(schedule_.torque(at), times(schedule_.inertia(at), pull(p)));
  }
  vector<Formula> torque_here(const Motion<Formula>& p) const { return torque(p, here_); }

  // S e_L of a state of the step, and its slopes, one xi after the other.
  vector<Formula> error(Motion<Formula>& p) { return times(f_.weights, plain_error(p)); }
  Square<Formula> error_slopes() {
    Square<Formula> slopes;
    for (FullState::Moved& p : f_.step_moved())
      slopes.push_back(times(f_.weights, rates(plain_error(p))));
    return slopes;
  }

  // S de/dt under held torques where nothing is off, e = 0.
  vector<Formula> growth_at_rest() { return times(f_.weights, plain_growth(f_.centre())); }
  // Its slopes in each xi at e = 0, one xi after the other,
  Square<Formula> growth_slopes() {
    Square<Formula> slopes;
    for (FullState::Moved& p : f_.step_moved())
      slopes.push_back(times(f_.weights, rates(plain_growth(p))));
    return slopes;
  }
  // and in S e, less 2 w on the diagonal: -M^-1 (dM/dt + 2 w (M - M')).
  vector<Formula> growth_pushes() {
    Motion<Formula>& p = f_.step();
    const I twice = I(2.0) * f_.bandwidth();
    const Square<Formula> lack = lacking(p), heavy = plain_inertia(p);
    Square<Formula> change;
    for (const auto& row : plain_inertia(p.flow())) change.push_back(rates(row));
    vector<Formula> slopes;
    for (size_t k = 0; k < f_.joints; ++k) {
      vector<Formula> moved;
      for (size_t j = 0; j < f_.joints; ++j) moved.push_back(Formula(f_.unweighted[j][k]));
      const vector<Formula> more = plus(times(change, moved), scaled(twice, times(lack, moved)));
      for (const Formula& one : times(f_.weights, solved(heavy, more))) slopes.push_back(one);
    }
    return slopes;
  }

 private:
  FullState& f_;
  const Schedule schedule_;
  const ChartPoint<Formula> here_;

  template <class S>
  ChartPoint<S> here() const { return {S(here_.phase), S(here_.level)}; }

  // M, and M - M', of a state of the step.
  template <class S>
  Square<S> plain_inertia(Motion<S>& p) const {
    Matrix one(f_.joints, vector<I>(f_.joints, I(0.0)));
    for (size_t j = 0; j < f_.joints; ++j) one[j][j] = I(1.0);
    return inertia(p, one);
  }
  template <class S>
  Square<S> lacking(Motion<S>& p) const {
    Square<S> found = plain_inertia(p);
    const Square<S> schedule = schedule_.inertia(here<S>());
    for (size_t i = 0; i < found.size(); ++i) found[i] = minus(found[i], schedule[i]);
    return found;
  }

  static vector<Formula> solution(const Square<Formula>& a, const vector<Formula>& b) {
    return solved(a, b);
  }
  static vector<DualOf<Formula>> solution(const Square<DualOf<Formula>>& a,
                                          const vector<DualOf<Formula>>& b) {
    return solved_with_rates(a, b);
  }

  // e_L, of M e_L = u0 - u*(ddy = 0) + (M - M') pull: what is in both torques is left out of either.
  template <class S>
  vector<S> plain_error(Motion<S>& p) {
    const vector<S> none(f_.joints, S(0.0));
    const vector<S> lack = minus(schedule_.torque(here<S>()), exact_torque(f_, p, none));
    return solution(plain_inertia(p), plus(lack, times(lacking(p), pull(p))));
  }

  // de/dt at e = 0, of d(M e)/dt = -du_L/dt: pulled - M^-1 (du0/dt - dM'/dt pull + (M - M') pulled), with
  // pulled = w^2 dy + 2 w ddy.
  template <class S>
  vector<S> plain_growth(Motion<S>& p) {
    const I w = f_.bandwidth();
    vector<S> pulled = scaled(I(2.0) * w, minus(plain_error(p), pull(p)));
    if (p.off) pulled = plus(pulled, scaled(square(w), p.off->dy));
    vector<S> change(f_.joints, S(0.0));
    for (const bool second : {false, true}) {
      const S& rate = second ? p.dz2() : p.dz1();
      const ChartPoint<DualOf<Formula>> moving = chart_along(second);
      const Square<DualOf<Formula>> inertia = schedule_.inertia(moving);
      const vector<DualOf<Formula>> torque = schedule_.torque(moving);
      for (size_t i = 0; i < f_.joints; ++i) {
        S slope(torque[i].d);
        for (size_t j = 0; j < f_.joints; ++j) slope = slope - S(inertia[i][j].d) * pull(p)[j];
        change[i] = change[i] + slope * rate;
      }
    }
    return minus(pulled, solution(plain_inertia(p), plus(change, times(lacking(p), pulled))));
  }

  // The point of the chart as z1 or z2 moves.
  ChartPoint<DualOf<Formula>> chart_along(bool second) {
    const Motion<Formula>& p = f_.centre();
    const DualOf<Formula> z1(p.z1, Formula(second ? 0.0 : 1.0)), z2(p.z2, Formula(second ? 1.0 : 0.0));
    return {{here_.phase, phase_of(f_.here, z1).d}, {here_.level, level_of(f_.here, z1, z2).d}};
  }
};

// What elimination divides by: all positive if and only if a symmetric matrix is definite.
vector<Formula> pivots(Square<Formula> a) {
  vector<Formula> found;
  for (size_t k = 0; k < a.size(); ++k) {
    found.push_back(a[k][k]);
    for (size_t i = k + 1; i < a.size(); ++i) {
      const Formula share = a[k][i] / a[k][k];  // Of its upper triangle alone.
      for (size_t j = i; j < a.size(); ++j) a[i][j] = a[i][j] - share * a[k][j];
    }
  }
  return found;
}

// Margins of the decay of V under the law: pivots of -(A + B E) - (A + B E)' - decay, E the slopes of
// S e_L, of dxi/dt = A xi + B E xi. In the coordinates xi = (s + d, s - d): what nearly is not definite
// is d, which B hardly moves. There A has the blocks w (-5/2, 1/2; -1/2, -3/2), and B is (3, -1) / w.
vector<Formula> decay_margins(double decay, const FullState& f, const Square<Formula>& slopes) {
  const size_t m = f.joints;
  const I w = f.bandwidth(), share = inverse(w);
  const I flow[2][2] = {{I(-2.5) * w, I(0.5) * w}, {I(-0.5) * w, I(-1.5) * w}};
  const I turned[2] = {I(3.0) * share, -share};
  Square<Formula> moved(2 * m, vector<Formula>(2 * m));
  for (size_t i = 0; i < 2 * m; ++i)
    for (size_t j = 0; j < 2 * m; ++j) {
      const Formula &one = slopes[j % m][i % m], &other = slopes[m + j % m][i % m];
      moved[i][j] = turned[i / m] * (j < m ? one + other : one - other);
      if (i % m == j % m) moved[i][j] = moved[i][j] + Formula(flow[i / m][j / m]);
    }
  Square<Formula> left(2 * m, vector<Formula>(2 * m));
  for (size_t i = 0; i < 2 * m; ++i)
    for (size_t j = i; j < 2 * m; ++j) {
      left[i][j] = -(moved[i][j] + moved[j][i]);
      if (i == j) left[i][j] = left[i][j] - Formula(I(2.0) * I(decay));
    }
  return pivots(left);
}

}  // namespace
