#pragma once

#include "scheduled.hpp"

namespace {

// ----------------------------------------------------------------- 14, torques that are off
//
// Level 5 is about the states of level 4 under torques that are off: the outputs have ddy + e in place of
// their own acceleration, and S e is bounded. While torques are held e grows, and at an impact it jumps.
// docs/level5.md, docs/level5_clock.md and docs/level5_law.md have the premises.

// ---- growth under held torques.

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

// Slopes of S times the outputs' jerk in each xi, one xi after the other.
Square<Formula> jerk_slopes(FullState& f) {
  Square<Formula> slopes;
  for (FullState::Moved& p : f.step_moved()) slopes.push_back(jerk_along(f, p, p.off->ddy()));
  return slopes;
}

// 1 - A A' / l^2, A the slopes.
vector<Formula> slope_margins(double most, const Square<Formula>& slopes) {
  const size_t m = slopes[0].size();
  const I share = inverse(I(most));
  Square<Formula> a(m), left(m, vector<Formula>(m));
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

// Torques of the law that are held through an impact, and those of the new step.
template <class S>
class Kick {
 public:
  Kick(FullState& f, const Disturbed& its, Motion<S>& before)
      : after(landed(f, before)), f_(f), its_(its), before_(before) {}

  Motion<S> after;

  // What the torques from before are beyond those of the law in the new step.
  vector<S> lack() {
    const ChartPoint<S> here = {S(f_.phase), S(f_.level)};
    return minus(renamed(before_.robot, torque(before_, here)), torque(after, chart_of(after)));
  }

 private:
  FullState& f_;
  const Disturbed& its_;
  Motion<S>& before_;

  vector<S> torque(Motion<S>& p, const ChartPoint<S>& at) {
    if (its_.scheduled()) return ScheduledLaw(its_, f_).torque(p, at);
    return exact_torque(f_, p, p.off ? p.off->ddy() : vector<S>(f_.joints, S(0.0)));
  }
};

// S e+ from e- = 0 at xi = 0.
vector<Formula> kick(FullState& f, const Disturbed& its) {
  Kick<Formula> found(f, its, f.centre());
  return solved(inertia(found.after, f.unweighted), found.lack());
}

// Slopes of S e+ in each xi, e- being zero.
vector<Formula> kick_slopes(FullState& f, const Disturbed& its) {
  vector<Formula> slopes;
  for (FullState::Moved& before : f.guard_moved()) {
    Kick<DualOf<Formula>> found(f, its, before);
    const auto heavy = inertia(found.after, f.unweighted);
    for (const Formula& slope : rates(solved_with_rates(heavy, found.lack())))
      slopes.push_back(slope);
  }
  return slopes;
}

// And in S e-, whatever the law.
vector<Formula> kick_pushes(FullState& f) {
  Motion<Formula>& before = f.guard();
  Motion<Formula> after = landed(f, before);
  const Square<Formula> heavy = inertia(after, f.unweighted);
  vector<Formula> slopes;
  for (const vector<Formula>& one : pushed(before, f.unweighted))
    for (const Formula& slope : solved(heavy, renamed(before.robot, torque_of(before, one))))
      slopes.push_back(slope);
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

// Slacks under the law's own torques.
vector<Formula> law_slacks(FullState& f, const Disturbed& its, bool contact) {
  const Robot& robot = f.model.robot;
  if (!its.scheduled())
    return contact ? contact_slacks(robot, f.step()) : torque_slacks(robot, f.step());
  ScheduledLaw law(its, f);
  vector<Formula> left;
  if (!contact) {  // From the accelerations that polynomials make, they would have wide bounds.
    const vector<Formula> torque = law.torque_here(f.step());
    for (const double sign : {-1.0, 1.0})
      for (size_t j = 0; j < f.joints; ++j)
        left.push_back(Formula(1.0) + I(sign) / robot.torque_limit[j] * torque[j]);
    return left;
  }
  left = contact_slacks(robot, f.step());
  const vector<Formula> error = law.error(f.step());
  const vector<vector<Formula>> directions = pushed(f.step(), f.unweighted);
  for (size_t k = 0; k < f.joints; ++k) {
    const vector<Formula> slopes = contact_pushes(f, directions[k]);
    for (size_t i = 0; i < left.size(); ++i) left[i] = left[i] + slopes[i] * error[k];
  }
  return left;
}

vector<Formula> pushed_slacks(FullState& f, const Disturbed& its, bool contact,
                              const Formula& push) {
  vector<Formula> left = law_slacks(f, its, contact);
  vector<Formula> squares(left.size());
  for (const vector<Formula>& one : pushed(f.step(), f.unweighted)) {
    const vector<Formula> slopes = contact ? contact_pushes(f, one) : torque_pushes(f, one);
    for (size_t i = 0; i < left.size(); ++i) squares[i] = squares[i] + slopes[i] * slopes[i];
  }
  for (size_t i = 0; i < left.size(); ++i) left[i] = left[i] - push * root(squares[i]);
  return left;
}

// Of scheduled PD alone, or what is other under it.
vector<Formula> scheduled_margins(const string& n, const Disturbed& its, FullState& f) {
  ScheduledLaw law(its, f);
  if (n == "disturbed/decay") return decay_margins(its.decay, f, law.error_slopes());
  if (n == "disturbed/rest") return {room(its.rest, law.error(f.centre()))};
  if (n == "disturbed/jerk") return {room(its.jerk, law.growth_at_rest())};
  if (n == "disturbed/growth-slope")
    return slope_margins(its.growth_slope, law.growth_slopes());
  if (n == "disturbed/jerk-push") return {room(its.jerk_push, law.growth_pushes())};
  throw Unknown{"the output " + n};
}

vector<Formula> disturbed_margins(const string& n, const Disturbed& its, FullState& f) {
  const Formula peak = Formula(its.peak[0]) + I(its.peak[1]) * f.bound();
  if (n == "disturbed/contact") return pushed_slacks(f, its, true, peak);
  if (n == "disturbed/torque") return pushed_slacks(f, its, false, peak);
  if (n == "disturbed/kick-contact") return pushed_slacks(f, its, true, Formula(its.kick_peak));
  if (n == "disturbed/kick") return {room(its.kick, kick(f, its))};
  if (n == "disturbed/kick-slope") return {room(its.kick_slope, kick_slopes(f, its))};
  if (n == "disturbed/kick-push") return {room(its.kick_push, kick_pushes(f))};
  if (its.scheduled()) return scheduled_margins(n, its, f);
  if (n == "disturbed/jerk") return {room(its.jerk, jerk_at_rest(f))};
  if (n == "disturbed/jerk-slope") return slope_margins(its.growth_slope, jerk_slopes(f));
  if (n == "disturbed/jerk-push") return {room(its.jerk_push, jerk_pushes(f))};
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
