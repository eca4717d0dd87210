#pragma once

#include "jerk.hpp"
#include "premises.hpp"

namespace {

// --------------------------------------------------------------------------- 14 full order
//
// Level 4 is about states whose outputs are off zero: with w the double pole of the outputs y,
//
//     xi = (S dy / w, 2 S (y + dy / w)),  V = |xi|^2,
//
// S an upper triangular matrix over the joints, and |xi| at most floor + (radius - floor)
// exp(-shrink phase^2), or guard_radius in the guard's strip. Models have a slope in xi over that
// bound, of the unit ball. docs/full_order.md has the premises and why the conclusion follows from
// them; docs/level5.md has those of level 5, about the same states.

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
  using Moved = Motion<DualOf<BM>>;
  const FullOrder& shape;
  const Model& model;
  const size_t joints;
  const Matrix weights, unweighted;  // S and its inverse.

  FullState(const Model& m, const FullOrder& f, const Box& box)
      : shape(f), model(m), joints(static_cast<size_t>(m.robot.joints())),
        weights(weighting(f, joints)), unweighted(inverse_of(weights)),
        phase_(coordinate<BM>(box.low[0], box.high[0], 0)),
        level_(coordinate<BM>(box.low[1], box.high[1], 1)) {}

  // On the zero dynamics; for any xi of the set in the step; and in the guard's strip.
  Motion<BM>& centre() { return kept(centre_, [] { return std::optional<Off<BM>>(); }); }
  Motion<BM>& step() {
    return kept(step_, [this] {
      return off(bound());
    });
  }
  // Accelerations of the coordinates per unit of S times what is added to ddy, one column each.
  const vector<vector<BM>>& pushed() {
    if (pushed_.empty()) pushed_ = pushed_in(step());
    return pushed_;
  }
  vector<vector<BM>> pushed_in(Motion<BM>& p) const {
    vector<vector<BM>> found;
    for (size_t one = 0; one < joints; ++one) {
      vector<BM> more;
      for (size_t j = 0; j < joints; ++j) more.push_back(BM(unweighted[j][one]));
      const vector<BM> alone = link_angles(model.robot, p.lifted(BM(0.0), more));
      const BM gives = -(p.pose().momentum(alone) / p.transversal());  // ddz1.
      for (size_t j = 0; j < joints; ++j) more[j] = more[j] + gives * p.outputs().d1[j];
      found.push_back(p.lifted(gives, more));
    }
    return found;
  }
  Motion<BM>& guard() {
    return kept(guard_, [this] { return off(BM(shape.guard_radius)); });
  }

  // The same with derivatives along each xi, not over the radius.
  vector<Moved>& step_moved() { return moved(step_moved_, step()); }
  vector<Moved>& guard_moved() { return moved(guard_moved_, guard()); }

  // And along the phase, where level and xi stay.
  Moved& centre_ahead() { return ahead(centre_ahead_, centre()); }
  Moved& guard_ahead() { return ahead(guard_ahead_, guard()); }

  I bandwidth() const { return I(shape.bandwidth); }

  // On sqrt(V) in the set.
  BM bound() const {
    const I floor(shape.floor);
    return BM(floor) + (I(shape.radius) - floor) * exp(I(-shape.shrink) * (phase_ * phase_));
  }

  // S times the outputs' jerk while torques are held, where nothing is off.
  vector<BM> jerk_at_rest() {
    Motion<BM>& p = centre();
    return times(weights, held_jerk(p, vector<BM>(joints, BM(0.0)), third_order()));
  }
  // Its slopes in each xi, or in S times what is added to ddy: one direction after the other.
  vector<BM> jerk_slopes() {
    vector<BM> slopes;
    for (Moved& p : step_moved()) append(slopes, p, p.off->ddy());
    return slopes;
  }
  vector<BM> jerk_pushes() {
    Moved still = step().moving(BM(0.0), BM(0.0));
    vector<BM> slopes;
    for (size_t k = 0; k < joints; ++k) {
      vector<DualOf<BM>> ddy = still.off->ddy();
      for (size_t j = 0; j < joints; ++j) ddy[j].d = BM(unweighted[j][k]);
      append(slopes, still, ddy);
    }
    return slopes;
  }

 private:
  const BM phase_, level_;
  std::optional<Motion<BM>> centre_, step_, guard_;
  vector<vector<BM>> pushed_;
  vector<Jet<BM>> third_order_;
  vector<Moved> step_moved_, guard_moved_;
  std::optional<Moved> centre_ahead_, guard_ahead_;

  // The desired outputs' derivatives up to the third.
  const vector<Jet<BM>>& third_order() {
    if (third_order_.empty()) {
      Motion<BM>& p = centre();
      third_order_ = desired_outputs(model.policy, model.step, p.phase(), p.z1, p.z2, 3);
    }
    return third_order_;
  }

  void append(vector<BM>& slopes, Moved& p, const vector<DualOf<BM>>& ddy) {
    for (const DualOf<BM>& one : times(weights, held_jerk(p, ddy, third_order())))
      slopes.push_back(one.d);
  }

  template <class Chosen>
  Motion<BM>& kept(std::optional<Motion<BM>>& motion, Chosen outputs_off) {
    if (!motion) {
      const auto [z1, z2] = z_at(model.step, phase_, level_);
      motion.emplace(model, model.step, z1, z2, outputs_off());
    }
    return *motion;
  }

  std::optional<Off<BM>> off(const BM& radius) const {
    Off<BM> found = {{}, {}, bandwidth()};
    vector<BM> rates, mixed;
    for (size_t j = 0; j < joints; ++j) {
      rates.push_back(radius * ball_coordinate<BM>(j, 2 * joints));
      mixed.push_back(radius * ball_coordinate<BM>(joints + j, 2 * joints));
    }
    if (!shape.weights.empty()) {
      rates = times(unweighted, rates);
      mixed = times(unweighted, mixed);
    }
    for (size_t j = 0; j < joints; ++j) {
      found.y.push_back(I(1.0 / kStiff) * mixed[j] - rates[j]);
      found.dy.push_back(bandwidth() * rates[j]);
    }
    return found;
  }

  vector<Moved>& moved(vector<Moved>& found, Motion<BM>& from) {
    if (!found.empty()) return found;
    vector<Moved> all;
    for (size_t k = 0; k < 2 * joints; ++k) {
      vector<BM> y(joints), dy(joints);
      for (size_t j = 0; j < joints; ++j) {
        const I part = unweighted[j][k % joints];
        y[j] = BM(k < joints ? -part : I(1.0 / kStiff) * part);
        if (k < joints) dy[j] = BM(bandwidth() * part);
      }
      all.push_back(from.moving(BM(0.0), BM(0.0), y, dy));
    }
    return found = std::move(all);
  }

  Moved& ahead(std::optional<Moved>& found, Motion<BM>& from) {
    if (found) return *found;
    const auto [z1, z2] =
        z_at(model.step, DualOf<BM>(phase_, BM(1.0)), DualOf<BM>(level_, BM(0.0)));
    std::optional<Off<DualOf<BM>>> still;
    if (from.off) {
      still = Off<DualOf<BM>>{{}, {}, bandwidth()};
      for (const BM& y : from.off->y) still->y.push_back(DualOf<BM>(y));
      for (const BM& dy : from.off->dy) still->dy.push_back(DualOf<BM>(dy));
    }
    found.emplace(model, model.step, z1, z2, still);
    return *found;
  }
};

FullState& full_state(Place<TM>& at) {
  if (!at.full) at.full = std::make_shared<FullState>(at.model, *at.theorems.full, at.box);
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
BM room(double bound, const vector<BM>& slopes) {
  BM left(square(I(bound)));
  for (const BM& slope : slopes) left = left - slope * slope;
  return left;
}

// Slopes in xi along the guard of functions of an impact: the phase gives way so that the foot
// stays where it is. All functions, one xi after the other.
template <class Function>
vector<BM> along_guard(FullState& f, Function function) {
  const BM fall = f.guard_ahead().foot().z.d;
  const vector<DualOf<BM>> ahead = function(f.guard_ahead());
  vector<BM> slopes;
  for (FullState::Moved& moved : f.guard_moved()) {
    const BM gives = moved.foot().z.d / fall;
    const vector<DualOf<BM>> found = function(moved);
    for (size_t i = 0; i < found.size(); ++i)
      slopes.push_back(found[i].d - gives * ahead[i].d);
  }
  return slopes;
}

// Normal force (or impulse), and what is left on both sides of the friction cone.
vector<BM> cone(I friction, const Vec<BM>& force) {
  return {force.z, friction * force.z - force.x, friction * force.z + force.x};
}

// In weights: normal force and both slacks of the friction cone.
vector<BM> contact_slacks(const Robot& robot, Motion<BM>& p) {
  const I weight = robot.weight_mass * robot.gravity;
  const Vec<BM>& ground = p.forces().ground;
  return cone(robot.friction, {inverse(weight) * ground.x, inverse(weight) * ground.z});
}

// In limits: to both limits of each joint.
vector<BM> torque_slacks(const Robot& robot, Motion<BM>& p) {
  vector<BM> left;
  for (const double sign : {-1.0, 1.0})
    for (size_t j = 0; j < robot.torque_limit.size(); ++j)
      left.push_back(BM(1.0) + I(sign) / robot.torque_limit[j] * p.forces().torque[j]);
  return left;
}

// Premises without a barrier.
vector<BM> full_margins(const string& n, FullState& f) {
  using Moved = FullState::Moved;
  const FullOrder& its = f.shape;
  const Tube& tube = f.model.tube;
  const Robot& robot = f.model.robot;
  if (n == "full/pace") {
    const BM pace = inverse(I(tube.guard) - I(tube.start)) * f.step().dz1();
    return {pace - BM(its.slowest), BM(its.fastest) - pace};
  }
  if (n == "full/inertia") return {-f.step().transversal() - BM(its.inertia)};
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
    vector<BM> slopes;
    for (const DualOf<BM>& xi : xi_after(f.centre_ahead(), f)) slopes.push_back(xi.d);
    return {room(its.drift, slopes)};
  }
  if (n == "full/landing") {
    const BM phase = landing_phase(f.centre());
    return {BM(its.landing) - phase, BM(its.landing) + phase};
  }
  if (n == "full/gain") {
    const auto after = [&f](Moved& p) { return xi_after(p, f); };
    return {room(its.gain, along_guard(f, after))};
  }
  if (n == "full/landing-slope") {
    const auto landing = [](Moved& p) { return vector<DualOf<BM>>{landing_phase(p)}; };
    return {room(its.landing_slope, along_guard(f, landing))};
  }
  throw Unknown{"the output " + n};
}

// Slopes in xi of dh/dt, h being a function of z: its rate depends on xi through dz alone.
vector<BM> couplings(const BarrierConstants& its, bool upper, FullState& f) {
  using Moved = FullState::Moved;
  Moved first = f.centre().moving(BM(1.0), BM(0.0)), second = f.centre().moving(BM(0.0), BM(1.0));
  const BM h1 = height(its, upper, first).d, h2 = height(its, upper, second).d;
  vector<BM> slopes;
  for (Moved& p : f.step_moved()) slopes.push_back(h1 * p.dz1().d + h2 * p.dz2().d);
  return slopes;
}

// And those of one: `upper` says which fence it is, if it is one.
vector<BM> barrier_margins(const string& n, const BarrierConstants& its, bool upper,
                           FullState& f) {
  using Moved = FullState::Moved;
  if (n == "full/rate") {
    const DualOf<BM> h = height(its, upper, f.centre().flow());
    return {h.d + I(its.alpha) * h.v - BM(its.epsilon)};
  }
  if (n == "full/coupling") {
    return {room(its.coupling, couplings(its, upper, f))};
  }
  if (n == "full/reading") {
    vector<BM> slopes;
    for (Moved& p : f.step_moved()) slopes.push_back(height(its, upper, p).d);
    return {room(its.reading, slopes)};
  }
  if (n == "full/reset") return {height(its, upper, f.centre().after()) - BM(its.reset)};
  if (n == "full/reset-slope") {
    const auto after = [&](Moved& p) {
      return vector<DualOf<BM>>{height(its, upper, p.after())};
    };
    return {room(its.reset_slope, along_guard(f, after))};
  }
  throw Unknown{"the output " + n};
}

// What elimination divides by: all positive if and only if a symmetric matrix is definite.
vector<BM> pivots(vector<vector<BM>> a) {
  vector<BM> found;
  for (size_t k = 0; k < a.size(); ++k) {
    found.push_back(a[k][k]);
    for (size_t i = k + 1; i < a.size(); ++i) {
      const BM share = a[i][k] / a[k][k];
      for (size_t j = k + 1; j < a.size(); ++j) a[i][j] = a[i][j] - share * a[k][j];
    }
  }
  return found;
}

// 1 - A A' / l^2, A the slope of S de/dt in xi: that of the jerk less w^3 (xi_1 + xi_2).
vector<BM> growth_margins(double most, FullState& f) {
  const size_t m = f.joints;
  const vector<BM> jerks = f.jerk_slopes();  // All elements, one xi after the other.
  const I share = inverse(I(most)), cube = f.bandwidth() * square(f.bandwidth());
  vector<vector<BM>> a(m), left(m);
  for (size_t i = 0; i < m; ++i)
    for (size_t k = 0; k < 2 * m; ++k) {
      const BM slope = jerks[k * m + i];
      a[i].push_back(share * (k % m == i ? slope - BM(cube) : slope));
    }
  for (size_t i = 0; i < m; ++i)
    for (size_t j = 0; j < m; ++j) {
      if (j < i) {
        left[i].push_back(left[j][i]);
        continue;
      }
      BM sum(I(i == j ? 1.0 : 0.0));
      for (size_t k = 0; k < 2 * m; ++k) sum = sum - a[i][k] * a[j][k];
      left[i].push_back(sum);
    }
  return pivots(left);
}

// Level 5, of held torques.
vector<BM> jerk_margins(const string& n, const Disturbed& its, FullState& f) {
  if (n == "disturbed/jerk") return {room(its.jerk, f.jerk_at_rest())};
  if (n == "disturbed/growth-slope") return growth_margins(its.growth_slope, f);
  return {room(its.jerk_push, f.jerk_pushes())};
}

// Slopes of contact_slacks and of torque_slacks in a push: forces are affine in accelerations.
vector<BM> contact_pushes(const Robot& robot, FullState& f, size_t one) {
  const Pose<BM>& pose = f.step().pose();
  const vector<BM> w = link_angles(robot, f.pushed()[one]);
  Vec<BM> ground{BM(0.0), BM(0.0)};
  const vector<Vec<BM>> moved = pose.velocities(w);
  for (size_t i = 0; i < moved.size(); ++i)
    ground = ground + Vec<BM>{robot.mass[i] * moved[i].x, robot.mass[i] * moved[i].z};
  const I share = inverse(robot.weight_mass * robot.gravity);
  return cone(robot.friction, {share * ground.x, share * ground.z});
}

// Torques of the joints per unit of accelerations of the coordinates.
vector<BM> torque_of(const Robot& robot, const Pose<BM>& pose, const vector<BM>& accelerations) {
  const vector<BM> w = link_angles(robot, accelerations);
  return pose.momenta(pose.velocities(w), w);
}

vector<BM> torque_pushes(const Robot& robot, FullState& f, size_t one) {
  const vector<BM> torque = torque_of(robot, f.step().pose(), f.pushed()[one]);
  vector<BM> left;
  for (const double sign : {-1.0, 1.0})
    for (size_t j = 0; j < robot.torque_limit.size(); ++j)
      left.push_back(I(sign) / robot.torque_limit[j] * torque[j + 1]);
  return left;
}

// S times the error of the outputs' acceleration right after an impact under held torques; or its
// slopes in that from before the impact. Motors keep their torques, and joints have new names.
vector<BM> kick_margins(const string& n, const Disturbed& its, FullState& f) {
  const Robot& robot = f.model.robot;
  Motion<BM>& before = n == "disturbed/kick" ? f.centre() : f.guard();
  Motion<BM> after(f.model, f.model.step.next(), before.hip_after(), before.z2_after(),
                   Off<BM>{output_mismatch(before), rate_mismatch(before), f.bandwidth()});
  const auto renamed = [&robot](vector<BM> torque) {
    torque.insert(torque.begin(), BM(0.0));
    return without_first(swapped(robot, torque, link_angles(robot, torque)));
  };
  vector<vector<BM>> inertia(f.joints);  // Of S e, in the new step.
  for (const vector<BM>& one : f.pushed_in(after)) {
    const vector<BM> torque = without_first(torque_of(robot, after.pose(), one));
    for (size_t i = 0; i < f.joints; ++i) inertia[i].push_back(torque[i]);
  }
  if (n == "disturbed/kick") {
    vector<BM> lack = renamed(before.forces().torque);
    for (size_t i = 0; i < f.joints; ++i) lack[i] = lack[i] - after.forces().torque[i];
    return {room(its.kick, solved(inertia, lack))};
  }
  vector<BM> slopes;
  for (const vector<BM>& one : f.pushed_in(before))
    for (const BM& slope :
         solved(inertia, renamed(without_first(torque_of(robot, before.pose(), one)))))
      slopes.push_back(slope);
  return {room(its.kick_push, slopes)};
}

// Level 5: slacks, less what a push may take of them.
vector<BM> disturbed_margins(const string& n, const Disturbed& its, FullState& f) {
  if (n == "disturbed/kick" || n == "disturbed/kick-push") return kick_margins(n, its, f);
  if (n.rfind("disturbed/jerk", 0) == 0 || n == "disturbed/growth-slope")
    return jerk_margins(n, its, f);
  const bool kicked = n == "disturbed/kick-contact";
  const BM push = kicked ? BM(its.kick_peak) : BM(its.peak[0]) + I(its.peak[1]) * f.bound();
  const bool contact = kicked || n == "disturbed/contact";
  const Robot& robot = f.model.robot;
  const vector<BM> still = contact ? contact_slacks(robot, f.step()) : torque_slacks(robot, f.step());
  vector<BM> squares(still.size(), BM(0.0)), left;
  for (size_t one = 0; one < f.joints; ++one) {
    const vector<BM> slopes =
        contact ? contact_pushes(robot, f, one) : torque_pushes(robot, f, one);
    for (size_t i = 0; i < still.size(); ++i) squares[i] = squares[i] + slopes[i] * slopes[i];
  }
  // sqrt x <= (x/m + m)/2 for every m > 0: its tangent, which needs no x away from zero.
  for (size_t i = 0; i < still.size(); ++i) {
    const double middle = 0.5 * (squares[i].c[0].low() + squares[i].c[0].high());
    const I m(std::sqrt(std::max(middle, 1e-12)));
    left.push_back(still[i] - I(0.5) * (push * (inverse(m) * squares[i] + BM(m))));
  }
  return left;
}

// disturbed/decrease of a barrier.
vector<BM> decrease(const DisturbedBarrier& its, const BarrierConstants& of, bool upper,
                    FullState& f) {
  const DualOf<BM> h = height(of, upper, f.centre().flow());
  BM left = h.d + I(its.alpha) * h.v - BM(its.lost);
  for (const BM& slope : couplings(of, upper, f)) left = left - I(its.weight) * (slope * slope);
  return {left};
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

// ---- outputs of the Program, of all levels.

// An output of the Program: a condition of the spec, or a premise of a theorem.
struct Output {
  size_t elements = 0;  // In the Program.
  string unknown;       // Why it cannot be checked here; empty if it can.
  std::function<vector<Estimate>(Place<TM>&)> margins;
  std::function<vector<Formula>(Place<Formula>&)> formulas;  // Of a gait that is told commands.
  std::function<string(double)> words;  // That the margin is at least this.
};

// Of margins of a place of either kind.
template <class Margins>
Output output_of(Margins margins, std::function<string(double)> words) {
  return {0, "", [margins](Place<TM>& at) { return estimates(margins(at)); },
          [margins](Place<Formula>& at) { return margins(at); }, std::move(words)};
}

Output output_of(const Condition& c) {
  Output found = output_of([&c](auto& at) { return margins(c, at.wide(), at.phase); },
                           [&c](double least) { return words_for(c, least); });
  found.unknown = c.unknown;
  return found;
}

string with_unit(const char* words, double least, const char* unit) {
  return string(words) + " >= " + at_least(least) + (*unit ? " " : "") + unit;
}

Output output_of(const string& name, const Meaning& meaning) {
  const auto words = [&meaning](double least) {
    return with_unit(meaning.words, least, meaning.unit);
  };
  if (name.rfind("set/", 0) == 0)
    return output_of([name](auto& at) { return set_margins(name, at); }, words);
  return output_of([name](auto& at) { return orbit_margins(name, at); }, words);
}

// set/after NAME, set/value NAME, set/rate NAME, of a barrier condition.
Output output_of(const string& what, const Condition& c) {
  if (!c.unknown.empty()) return {0, c.unknown, {}, {}, {}};
  const string h = words_for(c.quantity) + " >= ", unit = " " + unit_of(c.quantity);
  if (what == "set/value")
    return output_of([&c](auto& at) { return value(c.quantity, at.wide()); },
                     [h, unit](double least) { return h + at_least(least) + unit; });
  if (what == "set/after")
    return output_of([&c](auto& at) { return value(c.quantity, at.wide().after()); },
                     [h, unit](double least) {
                       return "after the reset, " + h + at_least(least) + unit;
                     });
  return output_of([&c](auto& at) { return pushed_rates(c, at); },
                   [&c](double least) { return "disturbed, " + words_for(c, least); });
}

// full/NAME.
Output output_of_full_order(const string& name, const Meaning& meaning) {
  return {0, "", [name](Place<TM>& at) { return estimates(full_margins(name, full_state(at))); },
          {}, [&meaning](double least) { return with_unit(meaning.words, least, meaning.unit); }};
}

// disturbed/NAME.
const std::map<string, Meaning>& disturbed_outputs() {
  static const std::map<string, Meaning> table = {
      {"disturbed/contact", {"the contact's slacks, less what a push takes", "weights"}},
      {"disturbed/torque", {"the torques' slacks, less what a push takes", "limits"}},
      {"disturbed/decay", {"pivots of the decay of V under a law", ""}},
      {"disturbed/rest", {"its bound^2 - |S e|^2 of a law, nothing off", "rad^2/s^4"}},
      {"disturbed/jerk", {"j^2 - |S d^3y|^2 under held torques, nothing off", "rad^2/s^6"}},
      {"disturbed/growth-slope", {"pivots of 1 - A A' / l^2, A the slope of S de/dt in xi", ""}},
      {"disturbed/jerk-push", {"its bound^2 - its squared slope in S e", "1/s^2"}},
      {"disturbed/kick", {"its bound^2 - |S e|^2 after an impact, torques held", "rad^2/s^4"}},
      {"disturbed/kick-slope", {"its bound^2 - its squared slope in xi", "1/s^4"}},
      {"disturbed/kick-push", {"its bound^2 - its squared slope in S e from before", ""}},
      {"disturbed/kick-contact", {"the contact's slacks, less what a kick takes", "weights"}}};
  return table;
}

Output output_of_disturbed(const string& name, const Meaning& meaning, const Disturbed& its) {
  string unknown;
  if (name == "disturbed/kick-slope") unknown = "a slope in xi of the error after an impact";
  if (its.scheduled()) unknown = "what follows from the law of scheduled PD";
  return {0, unknown.empty() ? unknown : unknown + " is not derived",
          [name](Place<TM>& at) {
            return estimates(disturbed_margins(name, *at.theorems.disturbed, full_state(at)));
          },
          {}, [&meaning](double least) { return with_unit(meaning.words, least, meaning.unit); }};
}

// disturbed/decrease BARRIER, the barrier of that number.
Output output_of_decrease(size_t number) {
  return {0, "",
          [number](Place<TM>& at) {
            return estimates(decrease(at.theorems.disturbed->barriers[number],
                                      at.theorems.full->barriers[number], number == 1,
                                      full_state(at)));
          },
          {}, [](double least) {
            return with_unit("dh/dt + alpha h - weight |slope of dh/dt in xi|^2 - lost", least, "/s");
          }};
}

// full/WHAT BARRIER, the barrier of that number: the first two are the fences.
Output output_of_barrier(const string& what, size_t number, const Meaning& meaning) {
  return {0, "",
          [what, number](Place<TM>& at) {
            const BarrierConstants& barrier = at.theorems.full->barriers[number];
            return estimates(barrier_margins(what, barrier, number == 1, full_state(at)));
          },
          {}, [&meaning](double least) { return with_unit(meaning.words, least, meaning.unit); }};
}

}  // namespace
