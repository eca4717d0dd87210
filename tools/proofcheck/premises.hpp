#pragma once

#include "conditions.hpp"

namespace {

// ------------------------------------------------------------------------ 13 set and orbit
//
// Level 2 is about the set T, phases -start_strip to 1 + guard_strip between the fences; level 3
// about a thin tube in it around the periodic orbit. Their premises are margins like those of
// conditions, over boxes of the chart of either. What follows from them is in section 21.

// An axis of the chart: phase, level, then parameters of the gait.
// With a change, nothing is said of what is farther than this from the axis before it.
struct Axis {
  string name;
  double low = 0.0, high = 0.0;
  double change = HUGE_VAL;

  bool near() const { return change < HUGE_VAL; }
  bool ends_in(const string& end) const {
    return name.size() >= end.size() && !name.compare(name.size() - end.size(), end.size(), end);
  }
};
using Chart = vector<Axis>;

// A box of the chart by its corners. Of what conditions and theorems ask for, only the axes of the
// state are given: such a box stands for all values of every further axis.
struct Box {
  vector<double> low, high;
};

// The axes of a box that are the state's: phase and level, or all of a chart without these.
Box state_of(const Box& box, const Chart& chart) {
  if (chart[0].name != "phase") return box;
  return {{box.low[0], box.low[1]}, {box.high[0], box.high[1]}};
}

// Whether `root` is what `asked` stands for.
bool is_whole(const Box& root, const Box& asked, const Chart& chart) {
  for (size_t axis = 0; axis < chart.size(); ++axis) {
    const bool given = axis < asked.low.size();
    if (root.low[axis] != (given ? asked.low[axis] : chart[axis].low) ||
        root.high[axis] != (given ? asked.high[axis] : chart[axis].high))
      return false;
  }
  return true;
}

// Whether anything is said about some point of a box. A rounded difference is above a double only
// if the difference is.
bool is_asked(const Box& box, const Chart& chart) {
  for (size_t axis = 1; axis < chart.size(); ++axis)
    if (box.low[axis] - box.high[axis - 1] > chart[axis].change ||
        box.low[axis - 1] - box.high[axis] > chart[axis].change)
      return false;
  return true;
}

struct WalkingSet {
  double start_strip = 0.0, guard_strip = 0.0, risen = 0.0, falling = 0.0;
  // Phases -start_strip, 1 - guard_strip and 1 + guard_strip, as doubles.
  double first = 0.0, before = 0.0, last = 0.0;
  double push[2] = {0.0, 0.0};       // Bound on what may be added to dz.
  double floor = 0.0;                // Each foothold is at most this far off its height [m].
  vector<string> barriers, carried;  // Names of conditions.
  vector<string> told;               // Names of commands; the chart has two axes for each.
  bool claimed = false;

  bool disturbed() const { return push[0] != 0.0 || push[1] != 0.0; }
  // T, its two fences, and the strip around the guard.
  Box whole() const { return {{first, 0.0}, {last, 1.0}}; }
  Box lower() const { return {{first, 0.0}, {last, 0.0}}; }
  Box upper() const { return {{first, 1.0}, {last, 1.0}}; }
  Box strip() const { return {{before, 0.0}, {last, 1.0}}; }
  // The strip around phase 0, its lower edge, and where both begin.
  Box start() const { return {{-start_strip, 0.0}, {start_strip, 1.0}}; }
  Box edge() const { return {{-start_strip, 0.0}, {start_strip, 0.0}}; }
  Box origin() const { return {{0.0, 0.0}, {0.0, 0.0}}; }
};

struct Orbit {
  Tube thin;
  bool nested = false;  // Attraction by nested tubes, not by contraction.
  bool walks = false;   // Of a gait with commands: no thin tube, any two walks converge.
  bool alone = false;   // Of a box of robots: no thin tube, each has an orbit of its own.
  double guard_from = 0.0, guard_to = 0.0;
  vector<double> expansion, slowest, fastest;  // Chebyshev series of bounds on dF/dzeta.
  bool claimed = false;
};

// Constants of one barrier h of level 4, of a fence if `condition` is none; docs/full_order.md.
struct BarrierConstants {
  string name;
  double alpha = 0.0, epsilon = 0.0, coupling = 0.0, reading = 0.0, reset = 0.0,
         reset_slope = 0.0, sigma = 0.0;
  const Condition* condition = nullptr;
  std::optional<size_t> element;  // Of the condition's quantity; it has but one if none is named.
};

// The set D of level 4 and its constants, by the names of docs/full_order.md.
struct FullOrder {
  double bandwidth = 0.0, radius = 0.0, shrink = 0.0, guard_radius = 0.0, start_strip = 0.0,
         guard_strip = 0.0, crossing = 0.0, risen = 0.0, slowest = 0.0, fastest = 0.0,
         inertia = 0.0, mismatch = 0.0, drift = 0.0, gain = 0.0, landing = 0.0,
         landing_slope = 0.0, floor = 0.0;
  vector<BarrierConstants> barriers;
  std::map<string, size_t> numbers;  // Of the barriers, by name.
  vector<double> weights;  // S, upper triangle by rows; the identity if empty.
  // Phases -start_strip, 1 + guard_strip, 1 - guard_strip, 1 - crossing, 1 + crossing, as doubles.
  double first = 0.0, last = 0.0, before = 0.0, near = 0.0, far = 0.0;
  bool claimed = false;

  Box tube() const { return {{first, 0.0}, {last, 1.0}}; }
  Box strip() const { return {{before, 0.0}, {last, 1.0}}; }
  Box around() const { return {{near, 0.0}, {far, 1.0}}; }
};

// Level 5: what outputs may be pushed by, in the mean over a hold and at most, as first + second
// times the bound on sqrt(V); how fast held torques err; what each barrier of level 4 loses by that.
struct DisturbedBarrier {
  string name;
  double alpha = 0.0, weight = 0.0, lost = 0.0;
};

struct Disturbed {
  double push[2] = {0.0, 0.0}, peak[2] = {0.0, 0.0};
  double hold = 0.0, error = 0.0, jerk = 0.0, growth_slope = 0.0, jerk_push = 0.0;
  vector<DisturbedBarrier> barriers;
  // Of torques that are held through an impact; all 0 if there is a tick at each touchdown.
  double kick = 0.0, kick_slope = 0.0, kick_push = 0.0, kick_peak = 0.0, kick_end = 0.0;
  // Of scheduled PD; all empty or 0 under exact linearisation.
  vector<double> torque_gains, inertia_gains;
  double decay = 0.0, rest = 0.0;
  // Of a measured state; all empty or 0 for the true one.
  vector<double> state_error, state_axes, state_moves, state_slopes;
  double state_radius = 0.0;
  bool measured() const { return !state_error.empty(); }
  bool scheduled() const { return !torque_gains.empty(); }
  bool free_clock() const { return kick_end != 0.0; }
  bool claimed = false;
};

struct Theorems {
  std::optional<WalkingSet> walking;
  std::optional<Orbit> orbit;
  std::optional<FullOrder> full;
  std::optional<Disturbed> disturbed;  // Only beside `full`.
};

class FullState;

// A box of the chart, and the states that it stands for in either tube.
template <class T>
class Place {
 public:
  const Model& model;
  const Step<Scalar<T>>& step;
  const Theorems& theorems;
  const T phase, level;
  std::shared_ptr<FullState> full;  // Made when level 4 asks for it first.

  Place(const Model& m, const Step<Scalar<T>>& s, const Theorems& t, T first, T second)
      : model(m), step(s), theorems(t), phase(std::move(first)), level(std::move(second)) {}

  Motion<T>& wide() {
    if (!wide_) {
      const auto [z1, z2] = z_at(step, phase, level);
      // Formulas of z1 and of the phase apart: bounds do not know that both follow from commands.
      std::optional<T> known_phase;
      if constexpr (std::is_same_v<T, Formula>) known_phase = phase;
      wide_.emplace(model, step, z1, z2, std::optional<Off<T>>(), known_phase);
    }
    return *wide_;
  }
  Motion<T>& thin() {
    if (!thin_) thin_.emplace(state_at(model, theorems.orbit->thin, phase, level));
    return *thin_;
  }

 private:
  std::optional<Motion<T>> wide_, thin_;
};

// dz at the corners of the disturbance's box. Every margin that is asked there is linear in dz, or
// a quotient of linear functions whose denominator has one sign: no point inside is worse.
template <class T>
Rates<T> pushed(const WalkingSet& set, Motion<T>& p) {
  if (!set.disturbed()) return {{p.dz1(), p.dz2()}};
  Rates<T> corners;
  for (const double first : {-set.push[0], set.push[0]})
    for (const double second : {-set.push[1], set.push[1]})
      corners.push_back({p.dz1() + T(first), p.dz2() + T(second)});
  return corners;
}

// dF/dzeta at a phase: zeta moves by 1 where z2 moves by 1 / z2.
template <class T>
T expansion(Motion<T>& p) {
  Motion<DualOf<T>> across = p.moving(T(0.0), inverse(p.z2));
  return flow_slope(across).d;
}

// Where a neighbour lands that is off by 1 in zeta at this phase, before guard and reset: how much
// further ahead in z1, and how much higher in zeta.
template <class T>
struct Parted {
  T ahead, zeta;
};

// With p the height of the foot, the level of p through this state runs along t = (-p_z2, p_z1) in z.
// A neighbour that is off by 1 in zeta is off by 1 / z2 in z2; it equals a t plus a multiple of the
// flow for a = dz1 / (z2 dp/dt). The reset carries a t to a Dz(t).
template <class T>
Parted<T> parted_by_reset(Motion<T>& p) {
  const T p1 = p.across_ground(p.foot_per_dz1()), p2 = p.across_ground(p.foot_per_dz2());
  Motion<DualOf<T>> along_ground = p.moving(-p2, p1);
  const DualOf<T> hip = along_ground.hip_after(), momentum = along_ground.z2_after();
  const T a = p.dz1() / (p.z2 * (p1 * p.dz1() + p2 * p.dz2()));
  return {a * hip.d, a * (p.z2_after() * momentum.d)};
}

// rho, how far a neighbour is off after guard and reset, per zeta it was off before: along the flow
// after the reset, zeta changes by z2 dz2 / dz1 a metre.
template <class T>
T reset_gain(Motion<T>& p) {
  const Parted<T> found = parted_by_reset(p);
  Motion<T>& after = p.after();
  return found.zeta - after.z2 * (after.dz2() / after.dz1()) * found.ahead;
}

// Rate at which |r| falls outside the thin tube, r being the distance from its middle in its half
// widths; level runs from the thin tube's fence of one side to the set's.
template <class T>
T narrowing(Place<T>& at, bool upper) {
  const Fences<DualOf<T>> thin = sloping_fences(at.theorems.orbit->thin, at.phase);
  const Fences<T> wide = fences(at.step, at.phase);
  const T from = upper ? thin.upper.v : thin.lower.v, to = upper ? wide.upper : wide.lower;
  const T zeta = from + at.level * (to - from);
  const DualOf<T> middle = I(0.5) * (thin.lower + thin.upper), width = thin.upper - thin.lower;
  Motion<T> state = state_of(at.model, at.phase, zeta);
  return width.d / width.v - (flow_slope(state) - middle.d) / (zeta - middle.v);
}

// What the outputs of the theorems say that concern no single condition.
const std::map<string, Meaning>& theorem_outputs() {
  static const std::map<string, Meaning> table = {
      {"set/forward", {"rate of the phase", "1/s"}},
      {"set/inertia", {"transversal inertia -J s", "kg m"}},
      {"set/width", {"width of the set in z2, of its middle", ""}},
      {"set/fence-lower", {"flow inward over the lower fence", "tube widths a step"}},
      {"set/fence-upper", {"flow inward over the upper fence", "tube widths a step"}},
      {"set/foot-above", {"height of the swing foot", "m"}},
      {"set/foot-below", {"depth of the swing foot", "m"}},
      {"set/foot-rises", {"rise of the swing foot", "m/s"}},
      {"set/foot-falls", {"fall of the swing foot", "m/s"}},
      {"set/reset-phase", {"minus the size of the phase after the reset", ""}},
      {"set/reset-place", {"minus how far from the next step's start the reset lands", "m"}},
      {"set/inlet", {"reset inside the next step's fences at phase 0, and forward", "widths, or of z2"}},
      {"set/stride", {"way of the hip in a step", "m"}},
      {"set/steepness", {"minus the size of the fences' slopes", "tube widths at phase 0, per step"}},
      {"set/within-bounds", {"both ends of a step inside the outputs' bounds", "rad"}},
      {"set/reset-level", {"reset inside the fences and forward", "tube widths, or of z2"}},
      {"orbit/expansion", {"a series less dF/dzeta on the set", "per step"}},
      {"orbit/moved", {"minus how far ahead a neighbour lands", "m of zeta before"}},
      {"orbit/along", {"minus the size of d zeta / d z1 along the flow", "of zeta a m"}},
      {"orbit/gain", {"minus the size of the gain rho on the set's guard", ""}},
      {"orbit/fence-lower", {"flow inward over the thin tube's lower fence", "widths a step"}},
      {"orbit/fence-upper", {"flow inward over the thin tube's upper fence", "widths a step"}},
      {"orbit/foot-above", {"height of the swing foot in the thin tube", "m"}},
      {"orbit/foot-below", {"depth of the swing foot in the thin tube", "m"}},
      {"orbit/reset-level", {"reset inside the thin tube", "widths"}},
      {"orbit/inside", {"thin tube inside the set", "tube widths"}},
      {"orbit/width", {"minus the thin tube's width in z2", "kg m^2/s"}},
      {"orbit/slowest", {"dF/dzeta in the thin tube less a series", "per step"}},
      {"orbit/fastest", {"a series less dF/dzeta in the thin tube", "per step"}},
      {"orbit/reset-gain-low", {"gain rho on the thin tube's guard", ""}},
      {"orbit/reset-gain-high", {"minus the gain rho on the thin tube's guard", ""}},
      {"orbit/nested-above", {"approach to the thin tube from above", "per step"}},
      {"orbit/nested-below", {"approach to the thin tube from below", "per step"}}};
  return table;
}

template <class T>
vector<T> inside(const T& level) { return {level, T(1.0) - level}; }
template <class T>
vector<T> both_signs(const T& x) { return {x, -x}; }

// How far inside the outputs' bounds both ends of a step are kept, as a share of the bounds' width.
constexpr double kInside = 1e-3;

// Where a reset lands, of a gait that is told commands; nothing here depends on the next one.
template <class T>
vector<T> inlet_margins(const string& n, Place<T>& at) {
  const auto& step = at.step;
  Motion<T>& p = at.wide();
  if (n == "set/reset-place") return both_signs<T>(p.hip_after() - T(step.next().from));
  if (n == "set/inlet") {
    const Fences<T> f = fences(step.next(), T(0.0));
    const T z2 = p.z2_after();
    vector<T> margins = inside<T>((I(0.5) * (z2 * z2) - f.lower) / (f.upper - f.lower));
    margins.push_back(z2 / p.z2);
    return margins;
  }
  if (n == "set/stride") return {T(step.to - step.from)};
  if (n == "set/steepness") {
    const Fences<DualOf<T>> f = sloping_fences(step, at.phase);
    const Fences<T> first = fences(step, T(0.0));
    const T share = inverse(first.upper - first.lower), low = share * f.lower.d,
            high = share * f.upper.d;
    return {low, high, -low, -high};
  }
  if (n != "set/within-bounds") throw Unknown{"the output " + n};
  vector<T> out;
  const Policy& policy = at.model.policy;
  for (const auto& end : {step.start_outputs, step.guard_outputs})
    for (const bool upper : {false, true})
      for (size_t j = 0; j < end.size(); ++j) {
        const I low(policy.lower[j]), high(policy.upper[j]), margin = I(kInside) * (high - low);
        out.push_back(upper ? T(high - margin) - T(end[j]) : T(end[j]) - T(low + margin));
      }
  return out;
}

template <class T>
vector<T> set_margins(const string& n, Place<T>& at) {
  const WalkingSet& set = *at.theorems.walking;
  const auto& step = at.step;
  Motion<T>& p = at.wide();
  if (n == "set/inertia") return {-p.transversal()};
  if (n == "set/width") return {relative_width(step, at.phase)};
  if (n == "set/fence-lower" || n == "set/fence-upper")
    return inward(step, at.phase, p, n == "set/fence-upper", pushed(set, p));
  if (n == "set/foot-above") return {p.foot_height()};
  if (n == "set/foot-below") return {-p.foot_height()};
  if (n == "set/reset-phase") return both_signs<T>(phase_of(step, p.hip_after()));
  if (n == "set/reset-level") {
    // Levels do not tell forward from backward, so z2 must keep its sign as well.
    vector<T> margins = inside<T>(reset_level(step, p));
    margins.push_back(p.z2_after() / p.z2);
    return margins;
  }
  if (n != "set/forward" && n != "set/foot-rises" && n != "set/foot-falls")
    return inlet_margins(n, at);
  vector<T> out;
  for (const auto& [dz1, dz2] : pushed(set, p)) {
    const T rise = p.across_ground(p.foot_per_dz1()) * dz1 + p.across_ground(p.foot_per_dz2()) * dz2;
    if (n == "set/forward") out.push_back(inverse(step.to - step.from) * dz1);
    else out.push_back(n == "set/foot-rises" ? rise : -rise);
  }
  return out;
}

// Of two walks that are told the same commands, and of the return map on all of the set.
template <class T>
vector<T> return_margins(const string& n, Place<T>& at) {
  const Orbit& orbit = *at.theorems.orbit;
  Motion<T>& p = at.wide();
  if (n == "orbit/expansion")
    return {sum(orbit.expansion, chebyshev(at.phase, orbit.expansion.size())) - expansion(p)};
  if (n == "orbit/gain")
    return both_signs<T>(orbit.walks ? parted_by_reset(p).zeta : reset_gain(p));
  if (n == "orbit/moved") return both_signs<T>(parted_by_reset(p).ahead);
  if (n == "orbit/along") return both_signs<T>(p.z2 * p.dz2() / p.dz1());
  throw Unknown{"the output " + n};
}

vector<TM> orbit_margins(const string& n, Place<TM>& at) {
  const Orbit& orbit = *at.theorems.orbit;
  if (n == "orbit/expansion" || n == "orbit/gain" || orbit.walks) return return_margins(n, at);
  const auto series = [&at](const vector<double>& coefficients) {
    return sum(coefficients, chebyshev(at.phase, coefficients.size()));
  };
  if (n == "orbit/nested-above") return {narrowing(at, true)};
  if (n == "orbit/nested-below") return {narrowing(at, false)};
  // In the chart of the thin tube.
  Motion<TM>& p = at.thin();
  if (n == "orbit/fence-lower" || n == "orbit/fence-upper")
    return inward(orbit.thin, at.phase, p, n == "orbit/fence-upper", {{p.dz1(), p.dz2()}});
  if (n == "orbit/foot-above") return {p.foot_height()};
  if (n == "orbit/foot-below") return {-p.foot_height()};
  if (n == "orbit/reset-level") return inside<TM>(reset_level(orbit.thin, p));
  if (n == "orbit/inside") return inside<TM>(level_of(at.model.step, p.z1, p.z2));
  if (n == "orbit/width") {
    const Fences<TM> f = fences(orbit.thin, at.phase);
    return {root(I(2.0) * f.lower) - root(I(2.0) * f.upper)};
  }
  if (n == "orbit/slowest") return {expansion(p) - series(orbit.slowest)};
  if (n == "orbit/fastest") return {series(orbit.fastest) - expansion(p)};
  if (n == "orbit/reset-gain-low") return {reset_gain(p)};
  if (n == "orbit/reset-gain-high") return {-reset_gain(p)};
  throw Unknown{"the output " + n};
}
// A thin tube is that of a gait without commands.
vector<Formula> orbit_margins(const string& n, Place<Formula>& at) { return return_margins(n, at); }

// dh/dt + alpha(h) of a barrier h at the corners of the disturbance's box. Whatever h reads is that
// of the undisturbed surface, so that h is a function of z and its rate is linear in dz.
template <class T>
vector<T> pushed_rates(const Condition& c, Place<T>& at) {
  Motion<T>& p = at.wide();
  vector<T> out;
  p.jets();
  for (const auto& [dz1, dz2] : pushed(*at.theorems.walking, p)) {
    Motion<DualOf<T>> moved = p.moving(dz1, dz2);
    const vector<T> one = barrier_margins(c, moved);
    out.insert(out.end(), one.begin(), one.end());
  }
  return out;
}

}  // namespace
