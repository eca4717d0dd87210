#pragma once

#include "conditions.hpp"

namespace {

// ------------------------------------------------------------------------ 10 set and orbit
//
// Level 2 is about the set T, phases -start_strip to 1 + guard_strip between the fences; level 3
// about a thin tube in it around the periodic orbit. Their premises are margins like those of
// conditions, over boxes of the chart of either. What follows from them is in section 12.

// An axis of the chart: phase, level, then parameters of the gait.
// With a change, nothing is said of what is farther than this from the axis before it.
struct Axis {
  string name;
  double low = 0.0, high = 0.0;
  double change = HUGE_VAL;

  bool near() const { return change < HUGE_VAL; }
};
using Chart = vector<Axis>;

// A box of the chart by its corners. Of what conditions and theorems ask for, only phase and level
// are given: such a box stands for all values of every further axis.
struct Box {
  vector<double> low, high;
};

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
         landing_slope = 0.0;
  vector<BarrierConstants> barriers;
  // Phases -start_strip, 1 + guard_strip, 1 - guard_strip, 1 - crossing, 1 + crossing, as doubles.
  double first = 0.0, last = 0.0, before = 0.0, near = 0.0, far = 0.0;
  bool claimed = false;

  Box tube() const { return {{first, 0.0}, {last, 1.0}}; }
  Box strip() const { return {{before, 0.0}, {last, 1.0}}; }
  Box around() const { return {{near, 0.0}, {far, 1.0}}; }
};

struct Theorems {
  std::optional<WalkingSet> walking;
  std::optional<Orbit> orbit;
  std::optional<FullOrder> full;
};

class FullState;

// A box of the chart, and the states that it stands for in either tube.
class Place {
 public:
  const Model& model;
  const Theorems& theorems;
  const TM phase, level;
  const Box box;
  std::shared_ptr<FullState> full;  // Made when level 4 asks for it first.

  Place(const Model& m, const Theorems& t, const Box& b)
      : model(m), theorems(t), phase(coordinate<TM>(b.low[0], b.high[0], 0)),
        level(coordinate<TM>(b.low[1], b.high[1], 1)), box(b) {}

  Motion<TM>& wide() {
    if (!wide_) wide_.emplace(state_at(model, model.tube, phase, level));
    return *wide_;
  }
  Motion<TM>& thin() {
    if (!thin_) thin_.emplace(state_at(model, theorems.orbit->thin, phase, level));
    return *thin_;
  }

 private:
  std::optional<Motion<TM>> wide_, thin_;
};

// dz at the corners of the disturbance's box. Every margin that is asked there is linear in dz, or
// a quotient of linear functions whose denominator has one sign: no point inside is worse.
Rates pushed(const WalkingSet& set, Motion<TM>& p) {
  if (!set.disturbed()) return {{p.dz1(), p.dz2()}};
  Rates corners;
  for (const double first : {-set.push[0], set.push[0]})
    for (const double second : {-set.push[1], set.push[1]})
      corners.push_back({p.dz1() + TM(first), p.dz2() + TM(second)});
  return corners;
}

// dF/dzeta at a phase: zeta moves by 1 where z2 moves by 1 / z2.
TM expansion(Motion<TM>& p) {
  Motion<Dual> across = p.moving(TM(0.0), inverse(p.z2));
  return flow_slope(across).d;
}

// rho, how far a neighbour is off after guard and reset, per zeta it was off before. With p the
// height of the foot, the level of p through this state runs along t = (-p_z2, p_z1) in z. A
// neighbour that is off by 1 in zeta is off by 1 / z2 in z2; it equals a t plus a multiple of the
// flow for a = dz1 / (z2 dp/dt). The reset carries a t to a Dz(t), which is off by
// z2 (z2' - (dz2 / dz1) z1') in zeta along the flow after the reset.
TM reset_gain(Motion<TM>& p) {
  const TM p1 = p.foot_per_dz1().z, p2 = p.foot_per_dz2().z;
  Motion<Dual> along_ground = p.moving(-p2, p1);
  const Dual hip = along_ground.hip_after(), momentum = along_ground.z2_after();
  Motion<TM>& after = p.after();
  const TM off = after.z2 * (momentum.d - after.dz2() / after.dz1() * hip.d);
  return off * p.dz1() / (p.z2 * (p1 * p.dz1() + p2 * p.dz2()));
}

// Rate at which |r| falls outside the thin tube, r being the distance from its middle in its half
// widths; level runs from the thin tube's fence of one side to the set's.
TM narrowing(Place& at, bool upper) {
  const Fences<Dual> thin = sloping_fences(at.theorems.orbit->thin, at.phase);
  const Fences<TM> wide = fences(at.model.tube, at.phase);
  const TM from = upper ? thin.upper.v : thin.lower.v, to = upper ? wide.upper : wide.lower;
  const TM zeta = from + at.level * (to - from);
  const Dual middle = I(0.5) * (thin.lower + thin.upper), width = thin.upper - thin.lower;
  Motion<TM> state = state_of(at.model, at.phase, zeta);
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

vector<TM> inside(const TM& level) { return {level, TM(1.0) - level}; }

vector<TM> set_margins(const string& n, Place& at) {
  const Tube& tube = at.model.tube;
  const WalkingSet& set = *at.theorems.walking;
  Motion<TM>& p = at.wide();
  if (n == "set/inertia") return {-p.transversal()};
  if (n == "set/width") return {relative_width(tube, at.phase)};
  if (n == "set/fence-lower" || n == "set/fence-upper")
    return inward(tube, at.phase, p, n == "set/fence-upper", pushed(set, p));
  if (n == "set/foot-above") return {p.foot().z};
  if (n == "set/foot-below") return {-p.foot().z};
  if (n == "set/reset-phase") {
    const TM phase = phase_of(tube, p.hip_after());
    return {phase, -phase};
  }
  if (n == "set/reset-level") {
    // Levels do not tell forward from backward, so z2 must keep its sign as well.
    vector<TM> margins = inside(reset_level(tube, p));
    margins.push_back(p.z2_after() / p.z2);
    return margins;
  }
  vector<TM> out;
  for (const auto& [dz1, dz2] : pushed(set, p)) {
    const TM rise = p.foot_per_dz1().z * dz1 + p.foot_per_dz2().z * dz2;
    if (n == "set/forward") out.push_back(inverse(I(tube.guard) - I(tube.start)) * dz1);
    else if (n == "set/foot-rises") out.push_back(rise);
    else if (n == "set/foot-falls") out.push_back(-rise);
    else throw Unknown{"the output " + n};
  }
  return out;
}

vector<TM> orbit_margins(const string& n, Place& at) {
  const Orbit& orbit = *at.theorems.orbit;
  const auto series = [&at](const vector<double>& coefficients) {
    return sum(coefficients, chebyshev(at.phase, coefficients.size()));
  };
  if (n == "orbit/expansion") return {series(orbit.expansion) - expansion(at.wide())};
  if (n == "orbit/gain") {
    const TM gain = reset_gain(at.wide());
    return {gain, -gain};
  }
  if (n == "orbit/nested-above") return {narrowing(at, true)};
  if (n == "orbit/nested-below") return {narrowing(at, false)};
  // In the chart of the thin tube.
  Motion<TM>& p = at.thin();
  if (n == "orbit/fence-lower" || n == "orbit/fence-upper")
    return inward(orbit.thin, at.phase, p, n == "orbit/fence-upper", {{p.dz1(), p.dz2()}});
  if (n == "orbit/foot-above") return {p.foot().z};
  if (n == "orbit/foot-below") return {-p.foot().z};
  if (n == "orbit/reset-level") return inside(reset_level(orbit.thin, p));
  if (n == "orbit/inside") return inside(level_of(at.model.tube, p.z1, p.z2));
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

// dh/dt + alpha(h) of a barrier h at the corners of the disturbance's box. Whatever h reads is that
// of the undisturbed surface, so that h is a function of z and its rate is linear in dz.
vector<TM> pushed_rates(const Condition& c, Place& at) {
  Motion<TM>& p = at.wide();
  vector<TM> out;
  p.jets();
  for (const auto& [dz1, dz2] : pushed(*at.theorems.walking, p)) {
    Motion<Dual> moved = p.moving(dz1, dz2);
    const vector<TM> one = barrier_margins(c, moved);
    out.insert(out.end(), one.begin(), one.end());
  }
  return out;
}

}  // namespace
