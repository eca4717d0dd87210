#pragma once

#include "commanded.hpp"

namespace {

// ---------------------------------------------------------------------------- 12 conditions
//
// A quantity is a function of a state, as the model names it; a condition turns it into margins
// that must not be negative. What a user has written is not known here.

struct Quantity {
  string name, side;
  std::map<string, double> numbers;
  vector<double> bound, sides, centre;
  vector<int> joints;
  std::shared_ptr<Quantity> of;

  double number(const char* key) const { return numbers.at(key); }
};

struct Meaning { const char* words; const char* unit; };

// Quantities without numbers.
const std::map<string, Meaning>& plain_quantities() {
  static const std::map<string, Meaning> table = {
      {"torso_angle", {"torso angle, backwards positive", "rad"}},
      {"joint_angles", {"joint angles", "rad"}},
      {"joint_rates", {"joint rates", "rad/s"}},
      {"torques", {"joint torques", "N m"}},
      {"normal_force", {"normal ground force", "N"}},
      {"foot_height", {"swing-foot height", "m"}},
      {"foot_forward", {"swing foot ahead of the stance foot", "m"}},
      {"foot_vertical_velocity", {"vertical swing-foot velocity", "m/s"}},
      {"hip_height", {"hip height", "m"}},
      {"hip_forward", {"hip ahead of the stance foot", "m"}},
      {"hip_speed", {"forward hip velocity", "m/s"}},
      {"forward_rate", {"rate of the linearised hip position z1", "m/s"}},
      {"transversal_inertia", {"transversal inertia -J s", "kg m"}},
      {"hip_state", {"linearised hip position z1", "m"}},
      {"momentum", {"angular momentum z2", "kg m^2/s"}},
      {"reset_hip_sum", {"z1 after the reset plus z1 before", "m"}},
      {"reset_hip", {"z1 after the reset", "m"}},
      {"output_mismatch", {"outputs after the impact", "rad"}},
      {"squared_mismatch", {"minus the squared output mismatch", "rad^2"}},
      {"rate_mismatch", {"output rates after the impact", "rad/s"}},
      {"state_mismatch", {"state after the impact minus that above z+", "rad, rad/s"}},
      {"impulse", {"impulse on the new stance foot", "N s"}},
      {"normal_impulse", {"normal impulse of the impact", "N s"}},
      {"old_foot_lift", {"vertical velocity of the old stance foot after the impact", "m/s"}},
      {"sole_vertical_velocity", {"vertical velocity of heel and toe of the swing foot", "m/s"}},
      {"old_sole_lift", {"vertical velocity of the old stance foot's heel and toe after the impact",
                         "m/s"}},
      {"stance_ankle", {"angle of the stance ankle", "rad"}}};
  return table;
}

// Quantities with numbers, and the names of these.
const std::map<string, vector<string>>& quantities_with_numbers() {
  static const std::map<string, vector<string>> table = {
      {"at_least", {"of", "bound"}},
      {"at_most", {"of", "bound"}},
      {"after_reset", {"of"}},
      {"friction_forward", {"coefficient"}},
      {"friction_backward", {"coefficient"}},
      {"impulse_cone_forward", {"coefficient"}},
      {"impulse_cone_backward", {"coefficient"}},
      {"torque_reserve", {"side", "share"}},
      {"knee_bend", {"joints", "sides", "least"}},
      {"foot_above_arc", {"clearance"}},
      {"sole_above_arc", {"clearance"}},
      {"ankle_reserve", {"side", "share"}},
      {"pressure_reserve", {"end", "share"}},
      {"impulse_reserve", {"end", "share"}},
      {"foot_on_circle", {"centre", "radius"}},
      {"parabolic_clearance", {"height", "half_width", "slack"}},
      {"orbital_energy", {"height", "tilt"}}};
  return table;
}

vector<double> numbers_of(const Json& value, const string& what) {
  if (value.type == Json::number) return {value.number_value};
  vector<double> out;
  limit(list_of(value, what).size(), kMostSeries, "numbers in " + what);
  for (const Json& item : value.items) out.push_back(number_of(item, what));
  if (out.empty()) refuse(what + " without numbers");
  return out;
}

string side_of(const Json& value) {
  const string side = text_of(value, "a side");
  if (side != "lower" && side != "upper") refuse("the side '" + side + "'");
  return side;
}

Quantity quantity_of(const Json& table, int joints) {
  if (const Json* user = table.find("user"))
    throw Unknown{"a user's function " + text_of(*user, "a name")};
  Quantity q;
  q.name = text_of(field(table, "a quantity", "function"), "the name of a quantity");
  vector<string> names = {"function"};
  if (!plain_quantities().count(q.name)) {
    const auto known = quantities_with_numbers().find(q.name);
    if (known == quantities_with_numbers().end()) throw Unknown{"the quantity " + q.name};
    names.insert(names.end(), known->second.begin(), known->second.end());
  }
  only(table, "the quantity " + q.name, names);
  for (size_t i = 0; i < table.names.size(); ++i) {
    const string& name = table.names[i];
    const Json& value = table.items[i];
    const string what = name + " of the quantity " + q.name;
    if (name == "function") continue;
    if (name == "of") q.of = std::make_shared<Quantity>(quantity_of(value, joints));
    else if (name == "side") q.side = side_of(value);
    else if (name == "end") {
      q.side = text_of(value, "an end of a sole");
      if (q.side != "heel" && q.side != "toe") refuse("the end '" + q.side + "' of a sole");
    }
    else if (name == "bound") q.bound = numbers_of(value, what);
    else if (name == "sides") q.sides = numbers_of(value, what);
    else if (name == "centre") q.centre = numbers_of(value, what);
    else if (name == "joints") {
      for (const Json& joint : list_of(value, what)) {
        q.joints.push_back(integer_of(joint, what));
        if (q.joints.back() < 0 || q.joints.back() >= joints) refuse(what + ", which are none");
      }
    } else q.numbers[name] = number_of(value, what);
  }
  if (q.name == "knee_bend" && (q.joints.empty() || q.joints.size() != q.sides.size()))
    refuse("knees without sides");
  if (q.name == "foot_on_circle" && q.centre.size() != 2) refuse("a circle without a centre");
  return q;
}

template <class S>
vector<S> shifted(const vector<S>& values, const vector<double>& bound, bool at_least) {
  const size_t n = values.size();
  if (bound.size() != 1 && bound.size() != n) refuse("a bound of another size than its quantity");
  vector<S> out;
  for (size_t i = 0; i < n; ++i) {
    const S least(I(bound[bound.size() == 1 ? 0 : i]));
    out.push_back(at_least ? values[i] - least : least - values[i]);
  }
  return out;
}

template <class S>
vector<S> without_first(const vector<S>& values) { return {values.begin() + 1, values.end()}; }

template <class S>
vector<S> output_mismatch(Motion<S>& p) {
  vector<S> joints = without_first(coordinates_of(p.robot, p.theta_after()));
  for (size_t j = 0; j < joints.size(); ++j) joints[j] = joints[j] - p.after().outputs().y[j];
  return joints;
}

template <class S>
vector<S> rate_mismatch(Motion<S>& p) {
  const auto& impact = p.impact();
  const Outputs<S>& desired = p.after().outputs();
  S dz1(0.0);
  for (size_t j = 0; j < impact.dq.size(); ++j)
    if (magnitude(p.robot.hip_gradient[j]) != 0.0)
      dz1 = dz1 + p.robot.hip_gradient[j] * impact.dq[j];
  const S dz2 = p.robot.gravity * point(p.robot.moment, impact.pose.e).x;
  vector<S> out = without_first(impact.dq);
  for (size_t j = 0; j < out.size(); ++j)
    out[j] = out[j] - desired.d1[j] * dz1 - desired.d2[j] * dz2;
  return out;
}

template <class S>
vector<S> state_mismatch(Motion<S>& p) {
  const auto& impact = p.impact();
  vector<S> out;
  for (size_t j = 0; j < impact.dq.size(); ++j)
    out.push_back(impact.pose.q[j] - p.after().pose().q[j]);
  for (size_t j = 0; j < impact.dq.size(); ++j) out.push_back(impact.dq[j] - p.after().dq()[j]);
  return out;
}

// How far a centre of pressure is inside the middle part of a sole, times the force.
template <class S>
S inside_sole(const Quantity& q, const Linkage& robot, const S& normal, const S& moment) {
  if (!robot.feet) refuse("a sole of a robot on point feet");
  const I heel = robot.feet->heel, toe = robot.feet->toe, half(0.5);
  const I middle = half * (toe - heel), reach = half * I(q.number("share")) * (toe + heel);
  if (q.side == "heel") return moment - (middle - reach) * normal;
  return (middle + reach) * normal - moment;
}

// Of the friction cone, on one of its sides.
template <class S>
S slack(I friction, const Vec<S>& force, bool forward) {
  return forward ? friction * force.z - force.x : friction * force.z + force.x;
}

template <class S>
vector<S> value(const Quantity& q, Motion<S>& p) {
  const string& n = q.name;
  const auto& robot = p.robot;
  const auto number = [&q](const char* key) { return I(q.number(key)); };
  if (n == "at_least") return shifted(value(*q.of, p), q.bound, true);
  if (n == "at_most") return shifted(value(*q.of, p), q.bound, false);
  if (n == "after_reset") return value(*q.of, p.after());
  if (n == "torso_angle") {
    if (!robot.torso) refuse("a torso angle of a robot without a torso");
    return {p.pose().theta[static_cast<size_t>(robot.leg)]};
  }
  if (n == "joint_angles") return without_first(p.pose().q);
  if (n == "joint_rates") return without_first(p.dq());
  if (n == "torques") return p.forces().torque;
  if (n == "normal_force") return {p.at_stance(p.forces().ground).z};
  if (n == "friction_forward" || n == "friction_backward")
    return {slack(number("coefficient"), p.at_stance(p.forces().ground), n == "friction_forward")};
  if (n == "torque_reserve") {
    vector<S> out;
    for (size_t j = 0; j < robot.torque_limit.size(); ++j) {
      const S used = inverse(number("share") * robot.torque_limit[j]) * p.forces().torque[j];
      out.push_back(q.side == "lower" ? S(I(1.0)) + used : S(I(1.0)) - used);
    }
    return out;
  }
  if (n == "foot_height") return {p.foot_height()};
  if (n == "foot_forward") return {p.foot().x};
  if (n == "foot_vertical_velocity") return {p.foot_lift()};
  if (n == "foot_above_arc") {
    const S t = p.phase();
    return {p.foot_height() - (I(4.0) * number("clearance")) * (t * (S(I(1.0)) - t))};
  }
  if (n == "sole_above_arc") {
    const S t = p.phase();
    vector<S> out = p.sole_heights();
    for (S& one : out) one = one - (I(4.0) * number("clearance")) * (t * (S(I(1.0)) - t));
    return out;
  }
  if (n == "sole_vertical_velocity") return p.sole_lifts(p.pose(), p.w());
  if (n == "old_sole_lift") return p.sole_lifts(p.impact().pose, p.impact().w);
  if (n == "ankle_reserve") {
    if (!robot.feet) refuse("an ankle of a robot on point feet");
    S torque = robot.damping[0] * p.dq()[0];
    if (p.model.policy.ankle) torque = torque - p.ankle();
    const S used = inverse(number("share") * robot.feet->torque_limit) * torque;
    return {q.side == "lower" ? S(I(1.0)) + used : S(I(1.0)) - used};
  }
  if (n == "stance_ankle") return {p.pose().q[0]};
  if (n == "pressure_reserve")
    return {inside_sole(q, robot, p.at_stance(p.forces().ground).z, p.pressure_moment())};
  if (n == "impulse_reserve")
    return {inside_sole(q, robot, p.at_landing(p.impact().impulse).z, p.impulse_moment())};
  if (n == "foot_on_circle") {
    const Vec<S> off = p.foot() - Vec<S>{S(I(q.centre[0])), S(I(q.centre[1]))};
    return {dot(off, off) - S(square(number("radius")))};
  }
  if (n == "parabolic_clearance") {
    const S x = inverse(number("half_width")) * p.z1;
    return {p.foot().z - number("height") * (S(I(1.0)) - x * x) + S(number("slack"))};
  }
  if (n == "knee_bend") {
    vector<S> out;
    for (size_t i = 0; i < q.joints.size(); ++i)
      out.push_back(I(q.sides[i]) * p.pose().q[static_cast<size_t>(q.joints[i]) + 1] -
                    S(number("least")));
    return out;
  }
  if (n == "hip_height") return {p.hip().z};
  if (n == "hip_forward") return {p.hip().x};
  if (n == "hip_speed") return {p.hip_velocity().x};
  if (n == "forward_rate") return {p.dz1()};
  if (n == "transversal_inertia") return {-p.transversal()};
  if (n == "hip_state") return {p.z1};
  if (n == "momentum") return {p.z2};
  if (n == "orbital_energy") {
    const I h = number("height");
    const S speed = inverse(robot.weight_mass * h) * p.z2;
    return {speed * speed - (robot.gravity / h) * (p.z1 * p.z1) - number("tilt") * p.z1};
  }
  if (n == "reset_hip") return {p.hip_after()};
  if (n == "reset_hip_sum") return {p.hip_after() + p.z1};
  if (n == "output_mismatch") return output_mismatch(p);
  if (n == "squared_mismatch") {
    S sum(0.0);
    for (const S& error : output_mismatch(p)) sum = sum - error * error;
    return {sum};
  }
  if (n == "rate_mismatch") return rate_mismatch(p);
  if (n == "state_mismatch") return state_mismatch(p);
  if (n == "impulse") return {p.impact().impulse.x, p.impact().impulse.z};
  if (n == "normal_impulse") return {p.at_landing(p.impact().impulse).z};
  if (n == "impulse_cone_forward" || n == "impulse_cone_backward")
    return {slack(number("coefficient"), p.at_landing(p.impact().impulse),
                  n == "impulse_cone_forward")};
  if (n == "old_foot_lift") {
    const Vec<S> v = point(robot.foot, p.impact().pose.spin(p.impact().w));
    if (!p.step.ground) return {v.z};
    return {v.z - p.step.ground->landing_sine / p.step.ground->landing_cosine * v.x};
  }
  throw Unknown{"the quantity " + n};
}

// A decimal that is not smaller: printed in the upward mode that is set.
string at_most(double x, int digits = 6) {
  char text[40];
  snprintf(text, sizeof text, "%.*g", digits, x);
  return text;
}

// A decimal that is not larger.
string at_least(double x, int digits = 6) {
  const string text = at_most(-x, digits);
  return text[0] == '-' ? text.substr(1) : "-" + text;
}

string unit_of(const Quantity& q) {
  if (q.of) return unit_of(*q.of);
  const auto plain = plain_quantities().find(q.name);
  if (plain != plain_quantities().end()) return plain->second.unit;
  if (q.name == "torque_reserve") return "of the torque allowed";
  if (q.name == "knee_bend") return "rad";
  if (q.name == "foot_on_circle") return "m^2";
  if (q.name == "orbital_energy") return "m^2/s^2";
  if (q.name.rfind("friction", 0) == 0) return "N";
  if (q.name == "ankle_reserve") return "of the torque allowed";
  if (q.name == "pressure_reserve") return "N m";
  if (q.name == "impulse_reserve") return "N m s";
  if (q.name.rfind("impulse", 0) == 0) return "N s";
  return "m";
}

string words_for(const Quantity& q) {
  const auto plain = plain_quantities().find(q.name);
  if (plain != plain_quantities().end()) return plain->second.words;
  const auto number = [&q](const char* key) { return brief(q.number(key)); };
  string bounds;
  for (const double bound : q.bound) bounds += (bounds.empty() ? "" : ", ") + brief(bound);
  if (q.name == "at_least") return words_for(*q.of) + " above " + bounds + " " + unit_of(*q.of);
  if (q.name == "at_most") return words_for(*q.of) + " below " + bounds + " " + unit_of(*q.of);
  if (q.name == "after_reset") return words_for(*q.of) + ", at the point after the reset";
  if (q.name == "friction_forward")
    return "slack of the friction cone, coefficient " + number("coefficient") + ", forward";
  if (q.name == "friction_backward")
    return "slack of the friction cone, coefficient " + number("coefficient") + ", backward";
  if (q.name == "impulse_cone_forward")
    return "slack of the impulse's cone, coefficient " + number("coefficient") + ", forward";
  if (q.name == "impulse_cone_backward")
    return "slack of the impulse's cone, coefficient " + number("coefficient") + ", backward";
  if (q.name == "torque_reserve")
    return "what is left of " + number("share") + " of the torque limits, " + q.side + " side";
  if (q.name == "knee_bend") {
    string knees;
    for (size_t i = 0; i < q.joints.size(); ++i)
      knees += (i ? ", " : "") + std::to_string(q.joints[i]) + " times " + brief(q.sides[i]);
    return "bend of the knees (joints " + knees + ") beyond " + number("least") + " rad";
  }
  if (q.name == "foot_above_arc")
    return "swing foot above an arc of height " + number("clearance") + " m";
  if (q.name == "ankle_reserve")
    return "what is left of " + number("share") + " of the stance ankle's torque limit, " + q.side +
           " side";
  if (q.name == "sole_above_arc")
    return "heel and toe of the swing foot above an arc of height " + number("clearance") + " m";
  if (q.name == "pressure_reserve" || q.name == "impulse_reserve")
    return string(q.name == "pressure_reserve" ? "force of the ground" : "impulse of the landing") +
           " times its distance inside the middle " + number("share") + " of the sole, towards the " +
           q.side;
  if (q.name == "foot_on_circle")
    return "swing foot outside a circle of radius " + number("radius") + " m about (" +
           brief(q.centre[0]) + ", " + brief(q.centre[1]) + ") m";
  if (q.name == "parabolic_clearance")
    return "swing foot above a parabola of height " + number("height") + " m and half width " +
           number("half_width") + " m, lowered by " + number("slack") + " m";
  return "orbital energy of a pendulum of " + number("height") + " m, less " + number("tilt") +
         " m/s^2 z1";
}

// Whether accelerations are needed.
bool of_forces(const Quantity& q) {
  static const std::set<string> names = {"torques", "normal_force", "friction_forward",
                                         "friction_backward", "torque_reserve",
                                         "pressure_reserve"};
  return q.of ? of_forces(*q.of) : names.count(q.name) > 0;
}

struct Condition {
  string kind, region, side;
  double scale = 1.0, gamma = 0.0, tolerance = 0.0, least = 0.0;
  vector<double> alpha;
  Quantity quantity;
  string unknown;  // Why it cannot be checked here; empty if it can.
};

Condition condition_of(const Json& table, int joints) {
  Condition c;
  c.region = text_of(field(table, "a condition", "region"), "a region's name");
  c.scale = number_of(field(table, "a condition", "scale"), "a scale");
  if (!(c.scale > 0.0)) refuse("a scale that is not positive");
  if (const Json* user = table.find("user")) {
    c.unknown = "a user's kind of condition, " + text_of(*user, "a name");
    return c;
  }
  c.kind = text_of(field(table, "a condition", "kind"), "a kind");
  static const std::map<string, vector<string>> kinds = {
      {"Pointwise", {"quantity"}},
      {"Barrier", {"quantity", "alpha"}},
      {"DiscreteBarrier", {"quantity", "gamma"}},
      {"Equality", {"quantity", "tolerance", "loss"}},
      {"Fence", {"side"}},
      {"Inlet", {"side"}},
      {"TubeWidth", {"least"}},
      {"FencesApart", {}}};
  const auto known = kinds.find(c.kind);
  if (known == kinds.end()) {
    c.unknown = "the kind of condition " + c.kind;
    return c;
  }
  vector<string> names = {"kind", "region", "scale"};
  names.insert(names.end(), known->second.begin(), known->second.end());
  only(table, "a condition of the kind " + c.kind, names);
  if (const Json* side = table.find("side")) c.side = side_of(*side);
  if (const Json* gamma = table.find("gamma")) c.gamma = number_of(*gamma, "gamma");
  if (const Json* least = table.find("least")) c.least = number_of(*least, "a least width");
  if (const Json* t = table.find("tolerance")) c.tolerance = number_of(*t, "a tolerance");
  if (const Json* alpha = table.find("alpha")) c.alpha = numbers_of(*alpha, "alpha");
  // Only gains that make dh/dt >= -alpha(h) keep h >= 0 are conditions of this kind.
  for (const double slope : c.alpha)
    if (!(slope > 0.0)) refuse("a barrier's gain that is not positive");
  if (c.alpha.size() > 2 || !std::is_sorted(c.alpha.begin(), c.alpha.end()))
    refuse("a barrier's gains that are not bent upwards");
  if (table.find("gamma") && !(c.gamma > 0.0 && c.gamma <= 1.0)) refuse("gamma outside (0, 1]");
  try {
    if (const Json* quantity = table.find("quantity")) c.quantity = quantity_of(*quantity, joints);
    if (c.kind == "Barrier" && of_forces(c.quantity))
      c.unknown = "a rate of forces, which needs third derivatives of the policy";
  } catch (const Unknown& unknown) {
    c.unknown = unknown.what;
  }
  return c;
}

// F = d zeta / d phase along the flow, where dz is as given.
template <class S>
S flow_slope(Motion<S>& p, const S& dz1, const S& dz2) {
  return (p.step.to - p.step.from) * (p.z2 * dz2 / dz1);
}
template <class S>
S flow_slope(Motion<S>& p) { return flow_slope(p, p.dz1(), p.dz2()); }

// Fences and their slopes over the phase, by a dual in the phase.
template <class Band, class T>
Fences<DualOf<T>> sloping_fences(const Band& band, const T& phase) {
  return fences(band, DualOf<T>(phase, T(1.0)));
}

template <class T>
using Rates = vector<std::pair<T, T>>;  // Values of (dz1, dz2).

// Flow inward over a fence of a tube, in its widths per step, for each dz given.
template <class Band, class T>
vector<T> inward(const Band& band, const T& phase, Motion<T>& p, bool upper,
                 const Rates<T>& rates) {
  const Fences<DualOf<T>> f = sloping_fences(band, phase);
  const T width = f.upper.v - f.lower.v;
  vector<T> out;
  for (const auto& [dz1, dz2] : rates) {
    const T along = flow_slope(p, dz1, dz2);
    out.push_back((upper ? f.upper.d - along : along - f.lower.d) / width);
  }
  return out;
}

template <class Band, class T>
T reset_level(const Band& band, Motion<T>& p) {
  return level_of(band, p.hip_after(), p.z2_after());
}

// 2 (z2 of the upper fence - z2 of the lower) / their sum.
template <class Band, class T>
T relative_width(const Band& band, const T& phase) {
  const Fences<T> f = fences(band, phase);
  const T low = root(I(2.0) * f.lower), high = root(I(2.0) * f.upper);
  return I(2.0) * (high - low) / (high + low);
}

// dh/dt + alpha(h) in a state that moves.
template <class T>
vector<T> barrier_margins(const Condition& c, Motion<DualOf<T>>& p) {
  vector<T> out;
  const vector<DualOf<T>> h = value(c.quantity, p);
  for (const double slope : c.alpha)
    for (const DualOf<T>& one : h) out.push_back(one.d + I(slope) * one.v);
  return out;
}

// What the lower fence and the gap between both must exceed, in the unit of zeta.
constexpr double kApart = 0.01;

template <class T>
vector<T> margins(const Condition& c, Motion<T>& p, const T& phase) {
  if (c.kind == "Pointwise") return value(c.quantity, p);
  if (c.kind == "Barrier") return barrier_margins(c, p.flow());
  if (c.kind == "DiscreteBarrier") {
    vector<T> now = value(c.quantity, p), later = value(c.quantity, p.after());
    for (size_t i = 0; i < now.size(); ++i)
      later[i] = later[i] - (I(1.0) - I(c.gamma)) * now[i];
    return later;
  }
  if (c.kind == "Equality") {
    vector<T> out;
    for (const double sign : {-1.0, 1.0})
      for (const T& error : value(c.quantity, p)) out.push_back(T(c.tolerance) + I(sign) * error);
    return out;
  }
  if (c.kind == "Fence")
    return inward(p.step, phase, p, c.side == "upper", {{p.dz1(), p.dz2()}});
  if (c.kind == "Inlet") {
    const T level = reset_level(p.step.next(), p);
    return {c.side == "lower" ? level : T(1.0) - level};
  }
  if (c.kind == "TubeWidth") return {relative_width(p.step, phase) - T(c.least)};
  if (c.kind == "FencesApart") {
    const Fences<T> f = fences(p.step, phase);
    const I unit = inverse(I(p.step.unit));
    return {unit * f.lower - T(kApart), unit * (f.upper - f.lower) - T(kApart)};
  }
  throw Unknown{"the kind of condition " + c.kind};
}

// "margin of what >= number unit".
string words_for(const Condition& c, double bound) {
  const string number = at_least(bound), least = " >= " + number + " ";
  if (c.kind == "Fence")
    return "flow inward over the " + c.side + " fence" + least + "tube widths a step";
  if (c.kind == "Inlet")
    return "reset inside the " + c.side + " fence" + least + "tube widths";
  if (c.kind == "TubeWidth")
    return "relative width of the tube in z2 beyond " + brief(c.least) + " >= " + number;
  if (c.kind == "FencesApart")
    return "lower fence, and gap between the fences, beyond " + brief(kApart) +
           " of the unit of zeta" + least + "of it";
  const string unit = unit_of(c.quantity), what = words_for(c.quantity);
  if (c.kind == "Barrier") {
    string gain = brief(c.alpha[0]);
    if (c.alpha.size() == 2) gain += " or " + brief(c.alpha[1]);
    return "dh/dt + " + gain + "/s h" + least + unit + "/s, h: " + what;
  }
  if (c.kind == "DiscreteBarrier")
    return "h after the reset - " + brief(1.0 - c.gamma) + " h" + least + unit + ", h: " + what;
  if (c.kind == "Equality")
    return what + " within " + brief(c.tolerance) + least + unit;
  return what + least + unit;
}

}  // namespace
