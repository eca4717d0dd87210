#pragma once

#include "full_order.hpp"
#include "jerk.hpp"

namespace {

// ----------------------------------------------------------------- 14, torques that are off
//
// Level 5 is about the states of level 4 under torques that are off: the outputs have ddy + e in place of
// their own acceleration, and S e is bounded. While torques are held e grows, and at an impact it jumps.
// docs/level5.md, docs/level5_clock.md and docs/level5_law.md have the premises.

// Accelerations of the coordinates per unit of S times what is added to ddy, one column each.
template <class S>
vector<vector<S>> pushed(const FullState& f, Motion<S>& p) {
  vector<vector<S>> found;
  for (size_t one = 0; one < f.joints; ++one) {
    vector<S> more;
    for (size_t j = 0; j < f.joints; ++j) more.push_back(S(f.unweighted[j][one]));
    const vector<S> alone = link_angles(p.robot, p.lifted(S(I(0.0)), more));
    const S gives = -(p.pose().momentum(alone) / p.transversal());  // ddz1.
    for (size_t j = 0; j < f.joints; ++j) more[j] = more[j] + gives * p.outputs().d1[j];
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

// The inertia that S e feels: torques of the joints, row by row, for each element of it.
template <class S>
vector<vector<S>> inertia(const FullState& f, Motion<S>& p) {
  vector<vector<S>> found(f.joints);
  for (const vector<S>& one : pushed(f, p)) {
    const vector<S> torque = torque_of(p, one);
    for (size_t i = 0; i < f.joints; ++i) found[i].push_back(torque[i]);
  }
  return found;
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
template <class S>
vector<S> minus(vector<S> a, const vector<S>& b) {
  for (size_t i = 0; i < a.size(); ++i) a[i] = a[i] - b[i];
  return a;
}
template <class S>
vector<S> times(const vector<vector<S>>& matrix, const vector<S>& x) {
  vector<S> out;
  for (const vector<S>& row : matrix) {
    S total(0.0);
    for (size_t j = 0; j < x.size(); ++j) total = total + row[j] * x[j];
    out.push_back(total);
  }
  return out;
}

// What elimination divides by: all positive if and only if a symmetric matrix is definite.
vector<Formula> pivots(vector<vector<Formula>> a) {
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

// ---- growth under held torques.

vector<DualOf<Formula>> still(const vector<Formula>& all) { return {all.begin(), all.end()}; }

// S times the outputs' jerk where nothing is off.
vector<Formula> jerk_at_rest(FullState& f) {
  const auto& jets = f.third_order();
  const vector<Formula> none(f.joints, Formula(0.0));
  return times(f.weights, held_jerk(f.centre(), none, jets, bends(jets)));
}

// Its slopes along what moves a state that has these accelerations of the outputs.
vector<Formula> jerk_along(FullState& f, FullState::Moved& p, const vector<DualOf<Formula>>& ddy) {
  const auto& jets = f.third_order();
  const auto desired = bends(jets, Formula(0.0), Formula(0.0));
  return rates(times(f.weights, held_jerk(p, ddy, jets, desired)));
}

// Those in S times what is added to ddy, one element after the other.
vector<Formula> jerk_pushes(FullState& f) {
  FullState::Moved at = f.step().moving(Formula(0.0), Formula(0.0));
  vector<Formula> slopes;
  for (size_t k = 0; k < f.joints; ++k) {
    vector<DualOf<Formula>> ddy = still(f.step().off->ddy());
    for (size_t j = 0; j < f.joints; ++j) ddy[j].d = Formula(f.unweighted[j][k]);
    for (const Formula& slope : jerk_along(f, at, ddy)) slopes.push_back(slope);
  }
  return slopes;
}

// Slopes of S de/dt in each xi, one xi after the other: those of the jerk less w^3 (xi_1 + xi_2).
vector<vector<Formula>> growth_slopes(FullState& f) {
  const I cube = f.bandwidth() * square(f.bandwidth());
  vector<vector<Formula>> slopes;
  for (FullState::Moved& p : f.step_moved()) {
    slopes.push_back(jerk_along(f, p, p.off->ddy()));
    Formula& own = slopes.back()[(slopes.size() - 1) % f.joints];
    own = own - Formula(cube);
  }
  return slopes;
}

// 1 - A A' / l^2, A the slope of S de/dt in xi.
vector<Formula> growth_margins(double most, const vector<vector<Formula>>& slopes) {
  const size_t m = slopes[0].size();
  const I share = inverse(I(most));
  vector<vector<Formula>> a(m), left(m, vector<Formula>(m));
  for (size_t i = 0; i < m; ++i)
    for (const vector<Formula>& along : slopes) a[i].push_back(share * along[i]);
  for (size_t i = 0; i < m; ++i)
    for (size_t j = i; j < m; ++j) {
      left[i][j] = Formula(I(i == j ? 1.0 : 0.0));
      for (size_t k = 0; k < slopes.size(); ++k) left[i][j] = left[i][j] - a[i][k] * a[j][k];
    }
  return pivots(left);
}

// ---- errors right after an impact under held torques: motors keep theirs, and joints have new names.

template <class S>
vector<S> renamed(const Linkage& robot, vector<S> torque) {
  torque.insert(torque.begin(), S(0.0));
  return without_first(swapped(robot, torque, link_angles(robot, torque)));
}

// The state right after an impact, in the new step.
template <class S>
Motion<S> landed(const FullState& f, Motion<S>& before) {
  return {f.model, f.here, before.hip_after(), before.z2_after(),
          Off<S>{output_mismatch(before), rate_mismatch(before), f.bandwidth()}};
}

// The law's torques: in a state of the step, and right after an impact in one.
vector<Formula> law_torque(FullState& f, Motion<Formula>& p) {
  const vector<Formula> ddy = p.off ? p.off->ddy() : vector<Formula>(f.joints, Formula(0.0));
  return torques(p, acceleration(p, ddy, bends(p.jets())));
}
// In one that moves, its z too.
vector<DualOf<Formula>> law_torque(FullState& f, FullState::Moved& p) {
  const auto jets = desired_outputs(f.model.policy, f.here, p.phase().v, p.z1.v, p.z2.v, 3);
  return torques(p, acceleration(p, p.off->ddy(), bends(jets, p.z1.d, p.z2.d)));
}

// S e+ from e- = 0 at xi = 0.
vector<Formula> kick(FullState& f) {
  Motion<Formula>& before = f.centre();
  Motion<Formula> after = landed(f, before);
  return solved(inertia(f, after), minus(renamed(before.robot, law_torque(f, before)),
                                         law_torque(f, after)));
}

// Slopes of S e+ in S e-.
vector<Formula> kick_pushes(FullState& f) {
  Motion<Formula>& before = f.guard();
  Motion<Formula> after = landed(f, before);
  const vector<vector<Formula>> heavy = inertia(f, after);
  vector<Formula> slopes;
  for (const vector<Formula>& one : pushed(f, before))
    for (const Formula& slope : solved(heavy, renamed(before.robot, torque_of(before, one))))
      slopes.push_back(slope);
  return slopes;
}

// Those in each xi, e- being zero. With N S e+ = b, N the inertia: N d(S e+) = db - dN S e+.
vector<Formula> kick_slopes(FullState& f) {
  vector<Formula> slopes;
  for (FullState::Moved& before : f.guard_moved()) {
    FullState::Moved after = landed(f, before);
    const vector<DualOf<Formula>> lack =
        minus(renamed(before.robot, law_torque(f, before)), law_torque(f, after));
    const vector<vector<DualOf<Formula>>> heavy = inertia(f, after);
    vector<vector<Formula>> now;
    for (const auto& row : heavy) now.push_back(values(row));
    const vector<DualOf<Formula>> error = still(solved(now, values(lack)));
    const vector<Formula> more = rates(minus(lack, times(heavy, error)));
    for (const Formula& slope : solved(now, more)) slopes.push_back(slope);
  }
  return slopes;
}

// ---- slacks, less what a push takes.

// Slopes of contact_slacks and of torque_slacks in a push: forces are affine in accelerations.
vector<Formula> contact_pushes(FullState& f, const vector<Formula>& accelerations) {
  const Robot& robot = f.model.robot;
  const vector<Formula> w = link_angles(robot, accelerations);
  Vec<Formula> ground{Formula(0.0), Formula(0.0)};
  const vector<Vec<Formula>> moved = f.step().pose().velocities(w);
  for (size_t i = 0; i < moved.size(); ++i)
    ground = ground + Vec<Formula>{robot.mass[i] * moved[i].x, robot.mass[i] * moved[i].z};
  const I share = inverse(robot.weight_mass * robot.gravity);
  return cone(robot.friction, {share * ground.x, share * ground.z});
}
vector<Formula> torque_pushes(FullState& f, const vector<Formula>& accelerations) {
  const vector<Formula> torque = torque_of(f.step(), accelerations);
  const Robot& robot = f.model.robot;
  vector<Formula> left;
  for (const double sign : {-1.0, 1.0})
    for (size_t j = 0; j < f.joints; ++j)
      left.push_back(I(sign) / robot.torque_limit[j] * torque[j]);
  return left;
}

vector<Formula> pushed_slacks(FullState& f, bool contact, const Formula& push) {
  const Robot& robot = f.model.robot;
  vector<Formula> left =
      contact ? contact_slacks(robot, f.step()) : torque_slacks(robot, f.step());
  vector<Formula> squares(left.size());
  for (const vector<Formula>& one : pushed(f, f.step())) {
    const vector<Formula> slopes = contact ? contact_pushes(f, one) : torque_pushes(f, one);
    for (size_t i = 0; i < left.size(); ++i) squares[i] = squares[i] + slopes[i] * slopes[i];
  }
  for (size_t i = 0; i < left.size(); ++i) left[i] = left[i] - push * root(squares[i]);
  return left;
}

vector<Formula> disturbed_margins(const string& n, const Disturbed& its, FullState& f) {
  const Formula peak = Formula(its.peak[0]) + I(its.peak[1]) * f.bound();
  if (n == "disturbed/contact") return pushed_slacks(f, true, peak);
  if (n == "disturbed/torque") return pushed_slacks(f, false, peak);
  if (n == "disturbed/kick-contact") return pushed_slacks(f, true, Formula(its.kick_peak));
  if (n == "disturbed/jerk") return {room(its.jerk, jerk_at_rest(f))};
  if (n == "disturbed/growth-slope") return growth_margins(its.growth_slope, growth_slopes(f));
  if (n == "disturbed/jerk-push") return {room(its.jerk_push, jerk_pushes(f))};
  if (n == "disturbed/kick") return {room(its.kick, kick(f))};
  if (n == "disturbed/kick-slope") return {room(its.kick_slope, kick_slopes(f))};
  if (n == "disturbed/kick-push") return {room(its.kick_push, kick_pushes(f))};
  throw Unknown{"the output " + n};
}

// disturbed/decrease of a barrier.
vector<Formula> decrease(const DisturbedBarrier& its, const BarrierConstants& of, bool upper,
                         FullState& f) {
  const DualOf<Formula> h = height(of, upper, f.centre().flow());
  Formula left = h.d + I(its.alpha) * h.v - Formula(its.lost);
  for (const Formula& slope : couplings(of, upper, f)) left = left - I(its.weight) * (slope * slope);
  return {left};
}

// ---- outputs of the Program, of all levels.

}  // namespace
