#pragma once

#include "cartpole.hpp"

namespace {

// ------------------------------------------------------------------------------- 20 hoppers
//
// One leg that slides out of a hub with a wheel. In stance the foot is pinned and the wheel stands
// still: the leg leans by theta and has the policy's length, and with the momentum sigma about the foot
// these are the zero dynamics. The chart is the progress s of the stance and the level between two
// fences of the energy sigma^2/2. Two bodies lie on the leg's line: the upper one, hub and wheel, at the
// length plus an offset from the foot, and the foot's, at an offset that stays. All that follows is
// summed over the two.
//
// In flight the centre of mass falls freely, and the momentum about it stays. The foot comes down where
// the centre of mass is as high as at lift-off, in a fixed posture, its leg locked and its wheel at
// rest: so all of the flight is proportional to sigma at lift-off.

struct Hopper {
  I mass[2], inertia[2];                // Of the upper body and of the foot's, about their centres.
  I upper_offset, foot_offset;          // From the hip away from the foot; from the foot to the hip.
  I gravity, shortest, longest, force_limit, friction;
  double touch = 0.0, lift = 0.0;       // Leans,
  I length, push;                       // and at lift-off the length and its slope over the lean.
  I gain, scale;
  vector<vector<double>> hidden;        // [h, 2]
  vector<double> bias, output;          // [h]
  vector<double> reference, middle, width, weight;  // Polynomials of s, powers upwards.
  double rate = 0.0;                    // 1 + rate is how much closer two hops come.
  vector<string> words;

  I all() const { return mass[0] + mass[1]; }
  I sweep() const { return I(lift) - I(touch); }
  // Distances of the two centres from the foot.
  template <class S>
  std::array<S, 2> arms(const S& at) const { return {at + S(upper_offset), S(foot_offset)}; }
  // Mass times distance of the centre of mass from the foot, and the inertia about the foot.
  template <class S>
  S moment(const S& at) const {
    const auto r = arms(at);
    return mass[0] * r[0] + mass[1] * r[1];
  }
  template <class S>
  S about_foot(const S& at) const {
    const auto r = arms(at);
    return mass[0] * (r[0] * r[0]) + mass[1] * (r[1] * r[1]) + S(inertia[0] + inertia[1]);
  }
};

// Least rates, shares and widths of its spec.
constexpr double kLeastForward = 0.2, kLeastUpward = 0.3, kLeastSupport = 0.05, kLeastRatio = 0.1;

const KnownFamily& hoppers() {
  static const KnownFamily known = {
      "hopper",
      "a hopper",
      {"progress", "energy level"},
      {"policy", "tube", "rate"},
      {{"high", {0.0, 1.0}, {1.0, 1.0}},
       {"lift-off", {1.0, 0.0}, {1.0, 1.0}},
       {"low", {0.0, 0.0}, {1.0, 0.0}},
       {"stance", {0.0, 0.0}, {1.0, 1.0}}},
      {{"approach", "lift-off", "distance of two hops that the claimed rate leaves", "", 1},
       {"blow", "lift-off", "room of the touchdown's blow in the friction cone", "N s", 2},
       {"chart", "stance", "weight and width of the tube beyond 0.1", "", 2},
       {"closer", "stance", "decrease of the weighted distance of two stances", "", 1},
       {"flies", "lift-off", "upward speed beyond 0.3 m/s, ratio of momenta beyond 0.1", "", 2},
       {"forward", "stance", "rate of the lean beyond 0.2 rad/s, sweep beyond 0.2 rad", "", 2},
       {"grip", "stance", "room in the friction cone, of the weight,", "", 2},
       {"high fence", "high", "flow inward, in widths of the tube a stance,", "", 1},
       {"lands", "lift-off", "level of the next stance above 0, and below 1", "", 2},
       {"low fence", "low", "flow inward, in widths of the tube a stance,", "", 1},
       {"push", "stance", "share of the leg's force limit that is left, either way,", "", 2},
       {"reach", "stance", "room of the leg's length, either way,", "m", 2},
       {"support", "stance", "share of the weight that the floor bears beyond 0.05", "", 1}}};
  return known;
}

// G of the leg's length at touchdown times cos(touch) is that at lift-off.
I landing_length(const Hopper& h) {
  const I moment = h.moment(h.length) * sincos_at(h.lift).cosine / sincos_at(h.touch).cosine;
  return (moment - h.mass[1] * h.foot_offset) / h.mass[0] - h.upper_offset;
}

Hopper hopper_of(const Json& model, const Constants& constants) {
  Hopper h;
  const Json& robot = field(model, "the model", "robot");
  only(robot, "the robot",
       {"upper_mass", "upper_offset", "upper_inertia", "wheel_inertia", "foot_mass", "foot_offset",
        "foot_inertia", "gravity", "shortest", "longest", "force_limit", "torque_limit", "friction",
        "zero_length", "foot_radius", "force_gear", "torque_gear"});
  const auto number = [&](const char* name) { return hexadecimal(*robot.find(name), name); };
  for (const char* unused : {"zero_length", "foot_radius", "force_gear", "torque_gear"}) number(unused);
  for (const char* unused : {"wheel_inertia", "torque_limit"}) number_above(robot, unused);
  h.mass[0] = number_above(robot, "upper_mass");
  h.mass[1] = number_above(robot, "foot_mass");
  h.inertia[0] = number_from(robot, "upper_inertia");
  h.inertia[1] = number_from(robot, "foot_inertia");
  h.upper_offset = I(number("upper_offset"));
  h.foot_offset = I(number("foot_offset"));
  h.gravity = number_above(robot, "gravity");
  h.shortest = number_above(robot, "shortest");
  h.longest = number_above(robot, "longest");
  h.force_limit = number_above(robot, "force_limit");
  h.friction = number_from(robot, "friction");
  h.rate = hexadecimal(field(model, "the model", "rate"), "a rate");
  if (!(h.rate > 0.0)) refuse("a rate that is not above 0");
  const auto policy = arrays_of(field(model, "the model", "policy"), "policy", constants);
  const auto tube = arrays_of(field(model, "the model", "tube"), "tube", constants);
  const auto series = [](const std::map<string, Array>& owner, const char* name) {
    const auto found = owner.find(name);
    if (found == owner.end() || found->second.shape.size() != 1)
      refuse(string("no polynomial '") + name + "' in the model");
    limit(found->second.values.size(), kMostSeries, "powers of a polynomial");
    return found->second.values;
  };
  if (policy.size() != 7 || tube.size() != 3) refuse("a policy or tube with other arrays");
  h.output = series(policy, "output");
  const int width = static_cast<int>(h.output.size());
  h.bias = array(policy, "bias", {width}).values;
  h.hidden = rows_of(array(policy, "hidden", {width, 2}));
  h.gain = I(array(policy, "gain", {}).values[0]);
  const double scale = array(policy, "scale", {}).values[0];
  if (!(scale > 0.0)) refuse("a scale of a network that is not above 0");
  h.scale = I(scale);
  h.reference = series(policy, "reference");
  h.middle = series(tube, "middle");
  h.width = series(tube, "width");
  h.weight = series(tube, "weight");
  const vector<double>& ends = array(policy, "ends", {4}).values;
  if (!(-1.0 < ends[0] && ends[0] < ends[1] && ends[1] < 1.0))
    refuse("leans at touchdown and lift-off that no stance has");
  h.touch = ends[0];
  h.lift = ends[1];
  h.length = I(ends[2]);
  h.push = I(ends[3]);
  match_constants(constants, {{"policy", policy}, {"tube", tube}});
  h.words = {
      "hub and wheel " + brief(number("upper_mass")) + " kg with their centre of mass " +
          brief(number("upper_offset")) + " m beyond the hip, inertia about that centre " +
          brief(number("upper_inertia")) + " kg m^2; wheel " + brief(number("wheel_inertia")) +
          " kg m^2",
      "foot " + brief(number("foot_mass")) + " kg with its centre of mass " +
          brief(number("foot_offset")) + " m from the ground, inertia about it " +
          brief(number("foot_inertia")) + " kg m^2",
      "leg from " + brief(number("shortest")) + " to " + brief(number("longest")) + " m, force up to " +
          brief(number("force_limit")) + " N; friction " + brief(number("friction")) + ", gravity " +
          brief(number("gravity")) + " m/s^2",
      "stance from a lean of " + brief(ends[0]) + " to " + brief(ends[1]) +
          " rad; at lift-off the leg is " + brief(ends[2]) + " m long, and gets longer by " +
          brief(ends[3]) + " m/rad"};
  return h;
}

// A polynomial's value and slope.
template <class S>
std::pair<S, S> polynomial(const vector<double>& powers, const S& s) {
  S value{I(powers.back())}, slope(0.0);
  for (size_t k = powers.size() - 1; k-- > 0;) {
    slope = slope * s + value;
    value = value * s + S(I(powers[k]));
  }
  return {value, slope};
}

// A flight, per unit of the momentum about the foot at lift-off.
struct HopFlight {
  I forward, upward;  // Velocity of the centre of mass at lift-off.
  I landing;          // Momentum about the foot at touchdown.
  I slope;            // Of the leg's length over the lean with which a stance begins.
  I blow[2];          // Of the floor on the foot, forward and upward.
};

HopFlight flight_of(const Hopper& h) {
  HopFlight f;
  const I all = h.all(), low = landing_length(h);
  const auto up = sincos_at(h.lift), down = sincos_at(h.touch);
  const I turning = inverse(h.about_foot(h.length)), sliding = h.push * turning;
  const auto arms = h.arms(h.length);
  const I distance = h.moment(h.length) / all, along = h.mass[0] * sliding / all;
  f.forward = along * up.sine + distance * turning * up.cosine;
  f.upward = along * up.cosine - distance * turning * up.sine;
  // About the centre of mass: of each body, whose sliding is along the leg's line.
  I spin(0.0);
  for (size_t k = 0; k < 2; ++k)
    spin = spin + (h.inertia[k] + h.mass[k] * square(arms[k] - distance)) * turning;
  // At touchdown it moves forward as before, and down as quickly as it went up.
  const I reach = h.moment(low) / all;
  f.landing = spin + all * reach * (down.cosine * f.forward + down.sine * f.upward);
  // The blow acts on the foot: the hip goes on along the leg as it came, the whole turns about the foot.
  const I closing = f.forward * down.sine - f.upward * down.cosine,
          rolling = f.landing / h.about_foot(low);
  f.slope = closing / rolling;
  const I radial = h.mass[0] * closing, tangential = all * reach * rolling;
  f.blow[0] = radial * down.sine + tangential * down.cosine - all * f.forward;
  f.blow[1] = radial * down.cosine - tangential * down.sine + all * f.upward;
  return f;
}

// The leg's length, and its derivatives by s and sigma.
template <class S>
struct LegLength { S length, by_s, by_sigma; };

template <class S>
LegLength<S> length_of(const Hopper& h, const HopFlight& f, const S& s, const S& sigma) {
  const I low = landing_length(h), first = f.slope * h.sweep(), last = h.push * h.sweep();
  const S rest = S(1.0) - s;
  // The cubic by its ends: (1 - s)^2 (low + s (first + 2 low)) + s^2 (high - (1 - s) (last - 2 high)).
  const I near = first + I(2.0) * low, far = last - I(2.0) * h.length;
  const S begin = S(low) + near * s, end = S(h.length) - far * rest;
  const S cubic = rest * rest * begin + s * s * end;
  const S cubic_slope = near * (rest * rest) - I(2.0) * (rest * begin) + far * (s * s) +
                        I(2.0) * (s * end);
  const S centred = s - rest, bump = s * rest;
  const auto [reference, steeper] = polynomial(h.reference, s);
  const I share = inverse(h.scale);
  const S beside = share * (I(0.5) * (sigma * sigma) - reference);
  S network = h.gain * beside, by_centred(0.0), by_beside{h.gain};
  for (size_t k = 0; k < h.output.size(); ++k) {
    const I first_weight(h.hidden[k][0]), second_weight(h.hidden[k][1]);
    const S t = tanh_of(first_weight * centred + second_weight * beside + S(I(h.bias[k])));
    const S slope = I(h.output[k]) * (S(1.0) - t * t);
    network = network + I(h.output[k]) * t;
    by_centred = by_centred + first_weight * slope;
    by_beside = by_beside + second_weight * slope;
  }
  // 16 s^2 (1 - s)^2 (2 s - 1), and its derivative 32 s (1 - s) ((2 s - 1)^2 (-1) + s (1 - s)).
  const S window = I(16.0) * (bump * bump * centred);
  const S window_slope = I(32.0) * (bump * (bump - centred * centred));
  const S network_slope = I(2.0) * by_centred - share * (by_beside * steeper);
  return {cubic + window * network, cubic_slope + window_slope * network + window * network_slope,
          window * by_beside * (share * sigma)};
}

// Rates of the lean and the length along the zero dynamics.
template <class S>
struct LegRates { S length, turning, sliding; };

template <class S>
LegRates<S> rates_of(const Hopper& h, const HopFlight& f, const S& s, const S& sigma) {
  const LegLength<S> leg = length_of(h, f, s, sigma);
  S sine, cosine;
  sincos(S(I(h.touch)) + h.sweep() * s, sine, cosine);
  const S turning = sigma / h.about_foot(leg.length);
  const S falling = h.gravity * (h.moment(leg.length) * sine);
  return {leg.length, turning, leg.by_s * (inverse(h.sweep()) * turning) + leg.by_sigma * falling};
}

// Margins of all conditions as formulas of the chart.
std::shared_ptr<const Listing> recorded(const Hopper& h) {
  using D = DualOf<Formula>;
  Recording recording;
  const Formula s = Formula::axis(recording, 0), level = Formula::axis(recording, 1);
  const HopFlight f = flight_of(h);
  const auto [middle, middle_slope] = polynomial(h.middle, s);
  const auto [width, width_slope] = polynomial(h.width, s);
  const auto [weight, weight_slope] = polynomial(h.weight, s);
  const Formula off = level - Formula(0.5), energy = middle + width * off;
  const Formula sigma = root(I(2.0) * energy);

  // d energy / d s = g G J sin(theta) sweep, and its derivative by the energy at the same s.
  Formula sine, cosine;
  sincos(Formula(I(h.touch)) + h.sweep() * s, sine, cosine);
  const LegLength<Formula> leg = length_of(h, f, s, sigma);
  const Formula moment = h.moment(leg.length), inertia = h.about_foot(leg.length);
  const Formula steep = (h.gravity * h.sweep()) * sine, slope = steep * (moment * inertia);
  const Formula reach = leg.length + Formula(h.upper_offset);
  const Formula by_length = h.mass[0] * inertia + (I(2.0) * h.mass[0]) * (reach * moment);
  const Formula spread = steep * (by_length * (leg.by_sigma / sigma));
  const Formula inward = (slope - middle_slope - width_slope * off) / width;

  // Rates and accelerations of lean and length, along the flow.
  const LegRates<Formula> now = rates_of(h, f, s, sigma);
  const Formula falling = h.gravity * (moment * sine);
  const LegRates<D> moved = rates_of<D>(h, f, {s, inverse(h.sweep()) * now.turning}, {sigma, falling});
  // Of each body, mass times acceleration and weight, along the leg and across it.
  const auto arms = h.arms(leg.length);
  const Formula extending[2] = {moved.sliding.d, Formula(0.0)};
  const Formula sliding[2] = {now.sliding, Formula(0.0)};
  Formula along[2], across(0.0);
  for (size_t k = 0; k < 2; ++k) {
    along[k] = h.mass[k] * (extending[k] - arms[k] * (now.turning * now.turning) + h.gravity * cosine);
    across = across + h.mass[k] * (arms[k] * moved.turning.d +
                                   I(2.0) * (sliding[k] * now.turning) - h.gravity * sine);
  }
  const I share = inverse(h.all() * h.gravity);
  const Formula pressed = along[0] + along[1];
  const Formula forward = share * (pressed * sine + across * cosine);
  const Formula upward = share * (pressed * cosine - across * sine);

  const Formula landing = square(f.landing) * energy;
  const Formula start = (landing - polynomial(h.middle, Formula(0.0)).first) /
                            polynomial(h.width, Formula(0.0)).first + Formula(0.5);
  const auto cone = [&h](const Formula& ahead, const Formula& up) {
    return vector<Formula>{h.friction * up - ahead, h.friction * up + ahead};
  };
  const Formula least(kLeastRatio);
  return listing_of(
      recording, 2,
      {{"low fence", {inward}},
       {"high fence", {-inward}},
       {"forward", {now.turning - Formula(kLeastForward), Formula(h.sweep() - I(kLeastForward))}},
       {"chart", {weight - least, width - least}},
       {"support", {upward - Formula(kLeastSupport)}},
       {"grip", cone(forward, upward)},
       {"push", both_sides(along[0], h.force_limit)},
       {"reach", {leg.length - Formula(h.shortest), Formula(h.longest) - leg.length}},
       {"flies", {f.upward * sigma - Formula(kLeastUpward), Formula(f.landing - I(kLeastRatio))}},
       {"blow", cone(f.blow[0] * sigma, f.blow[1] * sigma)},
       {"lands", {start, Formula(1.0) - start}},
       {"closer", {-(weight_slope + weight * spread)}},
       {"approach",
        {weight - (I(1.0) + I(h.rate)) * square(f.landing) *
                      polynomial(h.weight, Formula(0.0)).first}}});
}

// What follows for trajectories. No stance passes a fence, each comes to its lift-off, and the flight
// brings it back between the fences. The weighted distance of two stances' energies does not grow over
// a stance, and a flight takes it, times 1 + rate, to no more than it was: the hop's map is a
// contraction of an interval.
DerivedSystem derived_hopper(const Json& model, const Constants& constants, const string& weights) {
  const Hopper h = hopper_of(model, constants);
  DerivedSystem found = {h.words, recorded(h), [h](const ProvedMargin& margin) {
    std::map<int, vector<string>> levels;
    const std::set<string> of_distances = {"approach", "closer"};
    for (const SpecCondition& one : hoppers().conditions) {
      const bool fence = string(one.region) == "low" || string(one.region) == "high";
      const double least = margin(one.name);
      if (!of_distances.count(one.name) && !(fence ? least > 0.0 : least >= 0.0)) return levels;
    }
    levels[2] = {"every trajectory of the hybrid zero dynamics that starts in the tube hops for ever, "
                 "each stance within the tube",
                 "in stance the floor bears the forces, and the leg is within its range and its motor's "
                 "limit"};
    if (margin("closer") >= 0.0 && margin("approach") >= 0.0)
      levels[3] = {"there is one orbit in the tube, and every trajectory of the hybrid zero dynamics "
                   "in it comes closer to it at least by the factor 1 / (1 + " + brief(h.rate) +
                   ") a hop, in energies at touchdown"};
    return levels;
  }};
  found.words.push_back("policy 2-" + std::to_string(h.output.size()) + "-1, tanh; " + weights);
  found.words.push_back("the claimed rate of approach is " + brief(h.rate) + " a hop");
  return found;
}

}  // namespace
