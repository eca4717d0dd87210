#pragma once

#include "premises.hpp"

namespace {

// --------------------------------------------------------------------------- 14 full order
//
// Level 4 is about states whose outputs are off zero: with w the double pole of the outputs y,
//
//     xi = (S dy / w, 2 S (y + dy / w)),  V = |xi|^2,
//
// S an upper triangular matrix over the joints, and |xi| at most floor + (radius - floor)
// exp(-shrink phase^2), or guard_radius in the guard's strip. What is stated of these states is
// written down as formulas of phase, level and xi over that bound, of the unit ball (section 5).
// docs/full_order.md has the premises and why the conclusion follows from them.

constexpr double kStiff = 2.0;  // The 2 in xi.

using Matrix = vector<vector<I>>;

// S of the norm, from the upper triangle that the file has by rows.
Matrix weighting(const FullOrder& f, size_t joints) {
  Matrix s(joints, vector<I>(joints, I(0.0)));
  if (!f.weights.empty() && f.weights.size() != joints * (joints + 1) / 2)
    throw Inconsistent{"weights of level 4 that are no triangle over the joints"};
  size_t next = 0;
  for (size_t i = 0; i < joints; ++i)
    for (size_t j = i; j < joints; ++j)
      s[i][j] = f.weights.empty() ? I(i == j ? 1.0 : 0.0) : I(f.weights[next++]);
  return s;
}

// Its inverse, column by column, from the last row up.
Matrix inverse_of(const Matrix& s) {
  const size_t n = s.size();
  Matrix out(n, vector<I>(n, I(0.0)));
  for (size_t k = 0; k < n; ++k)
    for (size_t i = n; i-- > 0;) {
      I left(i == k ? 1.0 : 0.0);
      for (size_t j = i + 1; j < n; ++j) left = left - s[i][j] * out[j][k];
      out[i][k] = left / s[i][i];
    }
  return out;
}

template <class S>
vector<S> times(const Matrix& matrix, const vector<S>& x) {
  vector<S> out;
  for (const vector<I>& row : matrix) {
    S total(I(0.0));
    for (size_t j = 0; j < x.size(); ++j) total = total + row[j] * x[j];
    out.push_back(total);
  }
  return out;
}

class FullState {
 public:
  using Moved = Motion<DualOf<Formula>>;
  const FullOrder& shape;
  const Model& model;
  const Step<Formula>& here;  // The step, again and again the same.
  const Formula phase, level;
  const size_t joints;
  const Matrix weights, unweighted;  // S and its inverse.

  explicit FullState(const Place<Formula>& at)
      : shape(*at.theorems.full), model(at.model), here(at.step), phase(at.phase), level(at.level),
        joints(static_cast<size_t>(at.model.robot.joints())), weights(weighting(shape, joints)),
        unweighted(inverse_of(weights)) {}

  // On the zero dynamics; for any xi of the set in the step; and in the guard's strip.
  Motion<Formula>& centre() {
    return kept(centre_, [] { return std::optional<Off<Formula>>(); });
  }
  Motion<Formula>& step() {
    return kept(step_, [this] { return off(bound()); });
  }
  Motion<Formula>& guard() {
    return kept(guard_, [this] { return off(Formula(shape.guard_radius)); });
  }

  // The same with derivatives along each xi, not over the radius.
  vector<Moved>& step_moved() { return moved(step_moved_, step()); }
  vector<Moved>& guard_moved() { return moved(guard_moved_, guard()); }

  // And along the phase, where level and xi stay.
  Moved& centre_ahead() { return ahead(centre_ahead_, centre()); }
  Moved& guard_ahead() { return ahead(guard_ahead_, guard()); }

  I bandwidth() const { return I(shape.bandwidth); }

  // On sqrt(V) in the set.
  Formula bound() const {
    const I floor(shape.floor);
    return Formula(floor) + (I(shape.radius) - floor) * exp(I(-shape.shrink) * (phase * phase));
  }

  // The desired outputs' derivatives up to the third.
  const vector<Jet<Formula>>& third_order() {
    if (third_order_.empty()) {
      Motion<Formula>& p = centre();
      third_order_ = desired_outputs(model.policy, here, p.phase(), p.z1, p.z2, 3);
    }
    return third_order_;
  }

 private:
  std::optional<Motion<Formula>> centre_, step_, guard_;
  vector<Jet<Formula>> third_order_;
  vector<Moved> step_moved_, guard_moved_;
  std::optional<Moved> centre_ahead_, guard_ahead_;

  template <class Chosen>
  Motion<Formula>& kept(std::optional<Motion<Formula>>& motion, Chosen outputs_off) {
    if (!motion) {
      const auto [z1, z2] = z_at(here, phase, level);
      motion.emplace(model, here, z1, z2, outputs_off());
    }
    return *motion;
  }

  std::optional<Off<Formula>> off(const Formula& radius) const {
    Off<Formula> found = {{}, {}, bandwidth()};
    const auto xi = [&](size_t k) { return radius * Formula::fibre(phase.recording(), k); };
    vector<Formula> rates, mixed;
    for (size_t j = 0; j < joints; ++j) {
      rates.push_back(xi(j));
      mixed.push_back(xi(joints + j));
    }
    rates = times(unweighted, rates);
    mixed = times(unweighted, mixed);
    for (size_t j = 0; j < joints; ++j) {
      found.y.push_back(I(1.0 / kStiff) * mixed[j] - rates[j]);
      found.dy.push_back(bandwidth() * rates[j]);
    }
    return found;
  }

  vector<Moved>& moved(vector<Moved>& found, Motion<Formula>& from) {
    if (!found.empty()) return found;
    vector<Moved> all;
    for (size_t k = 0; k < 2 * joints; ++k) {
      vector<Formula> y(joints), dy(joints);
      for (size_t j = 0; j < joints; ++j) {
        const I part = unweighted[j][k % joints];
        y[j] = Formula(k < joints ? -part : I(1.0 / kStiff) * part);
        if (k < joints) dy[j] = Formula(bandwidth() * part);
      }
      all.push_back(from.moving(Formula(0.0), Formula(0.0), y, dy));
    }
    return found = std::move(all);
  }

  Moved& ahead(std::optional<Moved>& found, Motion<Formula>& from) {
    if (found) return *found;
    const auto [z1, z2] =
        z_at(here, DualOf<Formula>(phase, Formula(1.0)), DualOf<Formula>(level, Formula(0.0)));
    std::optional<Off<DualOf<Formula>>> still;
    if (from.off) {
      still = Off<DualOf<Formula>>{{}, {}, bandwidth()};
      for (const Formula& y : from.off->y) still->y.push_back(DualOf<Formula>(y));
      for (const Formula& dy : from.off->dy) still->dy.push_back(DualOf<Formula>(dy));
    }
    found.emplace(model, here, z1, z2, still);
    return *found;
  }
};

FullState& full_state(Place<Formula>& at) {
  if (!at.full) at.full = std::make_shared<FullState>(at);
  return *at.full;
}

// h of a barrier: a fence's distance in levels, or what its condition's quantity is in a state.
template <class S>
S height(const BarrierConstants& barrier, bool upper, Motion<S>& p) {
  if (!barrier.condition) {
    const S level = level_of(p.step, p.z1, p.z2);
    return upper ? S(I(1.0)) - level : level;
  }
  const vector<S> all = value(barrier.condition->quantity, p);
  if (barrier.element ? *barrier.element >= all.size() : all.size() != 1)
    throw Inconsistent{"the barrier " + barrier.name + " is no one element of its condition"};
  return all[barrier.element.value_or(0)];
}

// The outputs after an impact, as xi.
template <class S>
vector<S> xi_after(Motion<S>& p, const FullState& f) {
  const I bandwidth = f.bandwidth();
  vector<S> y = output_mismatch(p), dy = rate_mismatch(p);
  if (!f.shape.weights.empty()) {
    y = times(f.weights, y);
    dy = times(f.weights, dy);
  }
  vector<S> rates, mixed;
  for (size_t j = 0; j < y.size(); ++j) {
    rates.push_back(inverse(bandwidth) * dy[j]);
    mixed.push_back(I(kStiff) * (y[j] + rates[j]));
  }
  rates.insert(rates.end(), mixed.begin(), mixed.end());
  return rates;
}

template <class S>
S landing_phase(Motion<S>& p) { return phase_of(p.step, p.hip_after()); }

// bound^2 - the sum of squares.
Formula room(double bound, const vector<Formula>& slopes) {
  Formula left(square(I(bound)));
  for (const Formula& slope : slopes) left = left - slope * slope;
  return left;
}

// Slopes in xi along the guard of functions of an impact: the phase gives way so that the foot
// stays where it is. All functions, one xi after the other.
template <class Function>
vector<Formula> along_guard(FullState& f, Function function) {
  const Formula fall = f.guard_ahead().foot().z.d;
  const vector<DualOf<Formula>> ahead = function(f.guard_ahead());
  vector<Formula> slopes;
  for (FullState::Moved& moved : f.guard_moved()) {
    const Formula gives = moved.foot().z.d / fall;
    const vector<DualOf<Formula>> found = function(moved);
    for (size_t i = 0; i < found.size(); ++i)
      slopes.push_back(found[i].d - gives * ahead[i].d);
  }
  return slopes;
}

// Normal force (or impulse), and what is left on both sides of the friction cone.
vector<Formula> cone(I friction, const Vec<Formula>& force) {
  return {force.z, friction * force.z - force.x, friction * force.z + force.x};
}

// In weights: normal force and both slacks of the friction cone.
vector<Formula> contact_slacks(const Robot& robot, Motion<Formula>& p) {
  const I weight = robot.weight_mass * robot.gravity;
  const Vec<Formula>& ground = p.forces().ground;
  return cone(robot.friction, {inverse(weight) * ground.x, inverse(weight) * ground.z});
}

// In limits: to both limits of each joint.
vector<Formula> torque_slacks(const Robot& robot, Motion<Formula>& p) {
  vector<Formula> left;
  for (const double sign : {-1.0, 1.0})
    for (size_t j = 0; j < robot.torque_limit.size(); ++j)
      left.push_back(Formula(1.0) + I(sign) / robot.torque_limit[j] * p.forces().torque[j]);
  return left;
}

// Premises without a barrier.
vector<Formula> full_margins(const string& n, FullState& f) {
  using Moved = FullState::Moved;
  const FullOrder& its = f.shape;
  const Tube& tube = f.model.tube;
  const Robot& robot = f.model.robot;
  if (n == "full/pace") {
    const Formula pace = inverse(I(tube.guard) - I(tube.start)) * f.step().dz1();
    return {pace - Formula(its.slowest), Formula(its.fastest) - pace};
  }
  if (n == "full/inertia") return {-f.step().transversal() - Formula(its.inertia)};
  if (n == "full/contact") return contact_slacks(robot, f.step());
  if (n == "full/torque") return torque_slacks(robot, f.step());
  if (n == "full/foot-rises") return {f.step().foot_velocity().z};
  if (n == "full/foot-above") return {f.step().foot().z};
  if (n == "full/foot-below") return {-f.guard().foot().z};
  if (n == "full/foot-falls") return {-f.guard().foot_velocity().z};
  if (n == "full/crossing-before") return {f.centre().foot().z};
  if (n == "full/crossing-behind") return {-f.centre().foot().z};
  if (n == "full/guard-slope") return {-f.guard_ahead().foot().z.d};
  if (n == "full/impulse") return cone(robot.friction, f.guard().impact().impulse);
  if (n == "full/momentum-after") return {f.guard().z2_after()};
  if (n == "full/mismatch") return {room(its.mismatch, xi_after(f.centre(), f))};
  if (n == "full/drift") {
    vector<Formula> slopes;
    for (const DualOf<Formula>& xi : xi_after(f.centre_ahead(), f)) slopes.push_back(xi.d);
    return {room(its.drift, slopes)};
  }
  if (n == "full/landing") {
    const Formula phase = landing_phase(f.centre());
    return {Formula(its.landing) - phase, Formula(its.landing) + phase};
  }
  if (n == "full/gain") {
    const auto after = [&f](Moved& p) { return xi_after(p, f); };
    return {room(its.gain, along_guard(f, after))};
  }
  if (n == "full/landing-slope") {
    const auto landing = [](Moved& p) { return vector<DualOf<Formula>>{landing_phase(p)}; };
    return {room(its.landing_slope, along_guard(f, landing))};
  }
  throw Unknown{"the output " + n};
}

// Slopes in xi of dh/dt, h being a function of z: its rate depends on xi through dz alone.
vector<Formula> couplings(const BarrierConstants& its, bool upper, FullState& f) {
  using Moved = FullState::Moved;
  Moved first = f.centre().moving(Formula(1.0), Formula(0.0));
  Moved second = f.centre().moving(Formula(0.0), Formula(1.0));
  const Formula h1 = height(its, upper, first).d, h2 = height(its, upper, second).d;
  vector<Formula> slopes;
  for (Moved& p : f.step_moved()) slopes.push_back(h1 * p.dz1().d + h2 * p.dz2().d);
  return slopes;
}

// And those of one: `upper` says which fence it is, if it is one.
vector<Formula> barrier_margins(const string& n, const BarrierConstants& its, bool upper,
                                FullState& f) {
  using Moved = FullState::Moved;
  if (n == "full/rate") {
    const DualOf<Formula> h = height(its, upper, f.centre().flow());
    return {h.d + I(its.alpha) * h.v - Formula(its.epsilon)};
  }
  if (n == "full/coupling") {
    return {room(its.coupling, couplings(its, upper, f))};
  }
  if (n == "full/reading") {
    vector<Formula> slopes;
    for (Moved& p : f.step_moved()) slopes.push_back(height(its, upper, p).d);
    return {room(its.reading, slopes)};
  }
  if (n == "full/reset") return {height(its, upper, f.centre().after()) - Formula(its.reset)};
  if (n == "full/reset-slope") {
    const auto after = [&](Moved& p) {
      return vector<DualOf<Formula>>{height(its, upper, p.after())};
    };
    return {room(its.reset_slope, along_guard(f, after))};
  }
  throw Unknown{"the output " + n};
}

const std::map<string, Meaning>& full_outputs() {
  static const std::map<string, Meaning> table = {
      {"full/pace", {"rate of the phase, from its least and to its most", "1/s"}},
      {"full/inertia", {"transversal inertia -J s, beyond its least", "kg m"}},
      {"full/contact", {"normal force, and both slacks of the friction cone", "weights"}},
      {"full/torque", {"joint torques, to both limits", "limits"}},
      {"full/foot-rises", {"rise of the swing foot", "m/s"}},
      {"full/foot-above", {"height of the swing foot", "m"}},
      {"full/foot-below", {"depth of the swing foot", "m"}},
      {"full/foot-falls", {"fall of the swing foot", "m/s"}},
      {"full/crossing-before", {"height of the swing foot, outputs at zero", "m"}},
      {"full/crossing-behind", {"depth of the swing foot, outputs at zero", "m"}},
      {"full/guard-slope", {"fall of the swing foot per phase", "m"}},
      {"full/impulse", {"normal impulse, and both slacks of the friction cone", "N s"}},
      {"full/momentum-after", {"z2 after the impact", "kg m^2/s"}},
      {"full/mismatch", {"v^2 - V after an impact from outputs at zero", "rad^2"}},
      {"full/drift", {"v'^2 - the square of its slope in the phase", "rad^2"}},
      {"full/landing", {"size of the phase after it, to its bound", ""}},
      {"full/gain", {"L_D^2 - the squared slope of xi after an impact in xi", ""}},
      {"full/landing-slope", {"L_z^2 - the squared slope of the phase after it", "1/rad^2"}}};
  return table;
}

const std::map<string, Meaning>& barrier_outputs() {
  static const std::map<string, Meaning> table = {
      {"full/rate", {"dh/dt + alpha h - epsilon, outputs at zero", "/s"}},
      {"full/coupling", {"c^2 - the squared slope of dh/dt in xi", "/(s rad)^2"}},
      {"full/reading", {"l^2 - the squared slope of h on the robot in xi", "/rad^2"}},
      {"full/reset", {"h after an impact from outputs at zero, beyond its bound", ""}},
      {"full/reset-slope", {"L_h^2 - the squared slope of h after an impact in xi", "/rad^2"}}};
  return table;
}

}  // namespace
