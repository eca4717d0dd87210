#pragma once

#include "reading.hpp"

namespace {

// ------------------------------------------------------------------------------ 7 the model

struct Array {
  vector<int> shape;
  vector<double> values;
};

using Constants = std::map<string, Array>;  // The Program's named constants.

size_t elements(const vector<int>& shape) {
  size_t count = 1;
  for (const int size : shape) count *= static_cast<size_t>(size);
  return count;
}

vector<int> shape_of(const Json& value, const string& what) {
  vector<int> shape;
  limit(list_of(value, "the shape of " + what).size(), kMostDimensions, "dimensions of an array");
  for (const Json& size : value.items) {
    shape.push_back(integer_of(size, "the shape of " + what));
    if (shape.back() < 1 || shape.back() > 1'000'000 || elements(shape) > 100'000'000)
      refuse("the shape of " + what + " with a size that no array here has");
  }
  return shape;
}

// Arrays of one owner, "policy" or "tube": given as numbers, or as constants of the Program.
std::map<string, Array> arrays_of(const Json& table, const string& owner, const Constants& known) {
  std::map<string, Array> found;
  for (size_t i = 0; i < table.names.size(); ++i) {
    const string name = owner + "." + table.names[i];
    const Json& entry = table.items[i];
    if (entry.type == Json::null) continue;
    Array array;
    const auto constant = known.find(name);
    if (entry.find("constant")) {
      only(entry, name, {"constant"});
      if (text_of(entry.items[0], name) != name || constant == known.end())
        throw Inconsistent{"the model's " + name + " is no constant of the Program"};
      array = constant->second;
    } else {
      only(entry, name, {"shape", "values"});
      array.shape = shape_of(field(entry, name, "shape"), name);
      for (const Json& value : list_of(field(entry, name, "values"), name))
        array.values.push_back(hexadecimal(value, name));
      if (array.values.size() != elements(array.shape)) refuse(name + " of another size");
      if (constant != known.end() && (constant->second.shape != array.shape ||
                                      constant->second.values != array.values))
        throw Inconsistent{"the model's " + name + " is not that of the Program"};
    }
    found[table.names[i]] = array;
  }
  return found;
}

const Array& array(const std::map<string, Array>& table, const string& name, vector<int> shape) {
  const auto found = table.find(name);
  if (found == table.end()) refuse("no array '" + name + "' in the model");
  if (found->second.shape != shape) refuse("the model's array '" + name + "' in another shape");
  return found->second;
}

inline bool is_zero(const I& x) { return magnitude(x) == 0.0; }
inline bool is_zero(const Formula& x) { return x.is(0.0); }

// along e + across (e turned a quarter counter-clockwise), e a link's direction.
template <class K>
struct ComplexOf {
  K along, across;
  bool zero() const { return is_zero(along) && is_zero(across); }
};
// A point of the robot: sum over links of a Complex times e.
template <class K>
using RowOf = vector<ComplexOf<K>>;
using Complex = ComplexOf<I>;
using Row = RowOf<I>;

// Flat feet on ankles with motors. The stance foot lies still and is no link.
struct Feet {
  I heel, toe;     // How far the sole reaches behind the ankle and ahead of it.
  I height;        // Of the ankle above the sole.
  I mass, x, z;    // Of a foot, and its centre of mass from the ankle.
  I torque_limit;  // Of an ankle's motor.
};

// Links and joints, but for where the links' weight is.
struct Linkage {
  int links = 0;  // n: stance leg upwards, torso if there is one, swing leg downwards.
  int leg = 0;    // Links of a leg; of one on a flat foot, those above it.
  bool torso = false;
  vector<I> mass, inertia;       // Of the links.
  Row hip, foot;                 // Hip and swing foot.
  I weight_mass, gravity;        // Total mass, g.
  I friction;                    // Coefficient of the feet.
  vector<I> armature, damping;   // Of the n coordinates; on point feet the first has none.
  std::optional<Feet> feet;      // Nothing on point feet. Else the swing foot is the last link.
  vector<I> torque_limit;        // Of the n - 1 joints.
  vector<I> hip_gradient;        // c: z1 = c q.
  string name;
  vector<string> words;          // Every number of the file about it, a line each part.

  int joints() const { return links - 1; }
  // d theta_k / d q_j: angles add up the stance leg and over its hip, and subtract down the other.
  int turn(int k, int j) const { return j > k ? 0 : j > leg ? -1 : 1; }
};

// A robot whose weight is where numbers K say: known ones, or formulas of the lean of its torso.
template <class K>
struct RobotOf : Linkage {
  vector<RowOf<K>> centre;  // Centres of mass.
  RowOf<K> moment;          // Mass times centre of mass of the whole.
};
using Robot = RobotOf<I>;

// The robot whose torso's centre of mass is further ahead than the file says, where it is upright: across
// is counter-clockwise from up, which is to the back.
template <class K>
RobotOf<K> leaning(const Robot& file, const std::optional<K>& lean) {
  const auto copied = [](const Row& row) {
    RowOf<K> found;
    for (const Complex& part : row) found.push_back({K(part.along), K(part.across)});
    return found;
  };
  RobotOf<K> r;
  static_cast<Linkage&>(r) = file;
  for (const Row& row : file.centre) r.centre.push_back(copied(row));
  r.moment = copied(file.moment);
  if (!lean) return r;
  if (!file.torso) refuse("a lean of a robot without a torso");
  const auto torso = static_cast<size_t>(file.leg);
  K& across = r.centre[torso][torso].across;
  across = across - *lean;
  r.moment[torso].across = r.moment[torso].across - file.mass[torso] * *lean;
  return r;
}

Complex times(I k, const Complex& c) { return {k * c.along, k * c.across}; }

// A link in words, with the joint at its upper end if it has one.
string link_words(const Json& link) {
  const auto number = [&link](const char* name) {
    return brief(hexadecimal(field(link, "a link", name), string(name) + " of a link"));
  };
  string words = number("mass") + " kg, centre of mass " + number("along") + " m along and " +
                 number("across") + " m across, inertia " + number("inertia") + " kg m^2";
  if (!link.find("length")) return words;
  return number("length") + " m long, " + words + "; joint above it: rotor " + number("armature") +
         " kg m^2, damping " + number("damping") + " N m s/rad, torque limit " +
         number("torque_limit") + " N m, range " + number("lower") + " to " + number("upper") +
         " rad";
}

Robot robot_of(const Json& table) {
  vector<string> fields = {"name", "leg", "torso", "gravity", "friction", "foot_radius"};
  const Json* sole = table.find("sole");
  if (sole) fields.push_back("sole");
  only(table, "the robot", fields);
  const vector<Json>& leg = list_of(field(table, "the robot", "leg"), "the leg");
  const Json& trunk = field(table, "the robot", "torso");
  if (leg.empty() || leg.size() > 3) refuse("a leg of " + std::to_string(leg.size()) + " links");
  for (const Json& link : leg)
    only(link, "a link", {"length", "mass", "inertia", "armature", "damping", "torque_limit",
                          "lower", "upper", "along", "across"});
  const auto number = [](const Json& link, const char* name) {
    return I(hexadecimal(field(link, "a link", name), string(name) + " of a link"));
  };
  const auto at_least = [](I value, bool strictly, const char* what) {
    if (!(strictly ? value.low() > 0.0 : value.low() >= 0.0)) refuse(what);
    return value;
  };
  Robot r;
  const size_t fixed_links = sole ? 1 : 0;  // Links of a stance leg that do not move.
  r.leg = static_cast<int>(leg.size() - fixed_links);
  r.torso = trunk.type != Json::null;
  if (sole && (r.leg < 1 || !r.torso)) refuse("flat feet of a robot without legs or torso");
  r.links = 2 * r.leg + r.torso + static_cast<int>(fixed_links);
  r.name = text_of(field(table, "the robot", "name"), "the robot's name");
  r.gravity = at_least(number(table, "gravity"), true, "a gravity that is not positive");
  r.friction = at_least(number(table, "friction"), false, "a friction that is negative");
  const I radius = at_least(number(table, "foot_radius"), false, "a foot of negative radius");
  r.words.push_back("gravity " + brief(r.gravity.low()) + " m/s^2, friction of the feet " +
                    brief(r.friction.low()) + ", radius of the feet " + brief(radius.low()) + " m");
  const auto n = static_cast<size_t>(r.links);
  r.mass.resize(n);
  r.inertia.resize(n);
  r.centre.assign(n, Row(n));
  r.armature.assign(n, I(0.0));
  r.damping.assign(n, I(0.0));
  r.torque_limit.assign(n - 1, I(0.0));

  // Walk from the stance foot, or its ankle, up to the hip and down to the swing foot; `here` is the
  // joint.
  Row here(n);
  const auto fill = [&](size_t k, const Json& link) {
    r.mass[k] = at_least(number(link, "mass"), true, "a link whose mass is not positive");
    r.inertia[k] = at_least(number(link, "inertia"), false, "a link of negative inertia");
    r.centre[k] = here;
    r.centre[k][k].along = r.centre[k][k].along + number(link, "along");
    r.centre[k][k].across = number(link, "across");
  };
  for (size_t i = 0; i < leg.size(); ++i) {
    if (!(number(leg[i], "lower").low() <= number(leg[i], "upper").low()))
      refuse("a joint whose range ends before it begins");
    r.words.push_back("link " + std::to_string(i + 1) + " of each leg, from the foot up: " +
                      link_words(leg[i]));
    const I length = at_least(number(leg[i], "length"), true, "a link without length");
    if (i < fixed_links) continue;
    fill(i - fixed_links, leg[i]);
    here[i - fixed_links].along = length;
  }
  r.hip = here;
  if (r.torso) {
    only(trunk, "the torso", {"mass", "inertia", "along", "across"});
    fill(leg.size() - fixed_links, trunk);
    r.words.push_back("torso: " + link_words(trunk));
  }
  for (size_t i = leg.size(); i-- > 0;) {
    const size_t k = n - 1 - i;
    here[k].along = -number(leg[i], "length");  // To the link's lower end, where it is seen from.
    fill(k, leg[i]);
  }
  r.foot = here;
  if (sole) {
    r.foot[n - 1] = {};  // The ankle, below which the foot hangs.
    only(*sole, "the sole", {"heel", "toe"});
    const I height = number(leg[0], "length");
    r.feet = Feet{number(*sole, "heel"), number(*sole, "toe"), height, number(leg[0], "mass"),
                  -number(leg[0], "across"), number(leg[0], "along") - height,
                  at_least(number(leg[0], "torque_limit"), true, "an ankle without torque")};
    if (radius.low() != height.low()) refuse("feet of another height than their radius");
    if (!((r.feet->heel + r.feet->toe).low() > 0.0)) refuse("a sole without length");
    r.words.push_back("the lowest link is a flat foot: a sole from " + brief(r.feet->heel.low()) +
                      " m behind the ankle to " + brief(r.feet->toe.low()) + " m ahead");
  }

  r.moment = Row(n);
  for (size_t i = 0; i < n; ++i) {
    r.weight_mass = r.weight_mass + r.mass[i];
    for (size_t k = 0; k < n; ++k) {
      const Complex part = times(r.mass[i], r.centre[i][k]);
      r.moment[k] = {r.moment[k].along + part.along, r.moment[k].across + part.across};
    }
  }
  // Joint j of a leg is above link j; the hip is its last. Without a torso the hips are one joint.
  // The first coordinate is the joint above a flat stance foot.
  for (size_t j = 1 - fixed_links; j < n; ++j) {
    const size_t i = j <= static_cast<size_t>(r.leg) ? j + fixed_links - 1 : n - 1 - j;
    r.armature[j] = at_least(number(leg[i], "armature"), false, "a negative armature");
    r.damping[j] = at_least(number(leg[i], "damping"), false, "a negative damping");
    const I most =
        at_least(number(leg[i], "torque_limit"), true, "a torque limit that is not positive");
    if (j > 0) r.torque_limit[j - 1] = most;
  }
  // The hip is at -sum l_k sin theta_k: linearised in q.
  r.hip_gradient.assign(n, I(0.0));
  for (int j = 0; j < r.links; ++j)
    for (int k = 0; k < r.leg; ++k)
      if (r.turn(k, j)) r.hip_gradient[j] = r.hip_gradient[j] - I(r.turn(k, j)) * r.hip[k].along;
  return r;
}

struct Layer {
  int rows = 0, columns = 0;
  vector<double> weights, biases;  // [rows, columns], [rows]
};

// Torque of a stance ankle: most (2 logistic(network) - 1), forward.
struct Ankle {
  vector<Layer> layers;
  double most = 0.0;
  vector<double> scale, shift;  // [2] each
};

struct Policy {
  std::optional<Ankle> ankle;
  bool hybrid_invariant = false;  // Else the network alone.
  bool softplus = false;          // Else tanh.
  bool z2_dependence = true;
  vector<Layer> layers;
  vector<double> lower, upper, scale, shift;
  double start = 0.0, guard = 0.0;  // z1 after the impact and at the guard.
  vector<double> cubic;             // [4, m]
};

// The command that says which robot a policy is of, and what the name of the axis ends in that says how
// far from that the robot is.
constexpr char kLean[] = "lean";
constexpr char kNearBelief[] = " beyond the belief (error in m)";

// A number that a gait is told at each touchdown.
struct Command {
  string name;
  double low = 0.0, high = 0.0;
  double change = HUGE_VAL;  // The largest from one step to the next.
};

// What makes a policy and a tube of each pair of commands, before and after: polynomials of second
// degree in the commands, a row a monomial.
struct Family {
  vector<Command> commands;
  vector<vector<double>> guard_outputs, guard_slopes;  // [M, m]
  vector<double> guard_z1;                             // [M]
  vector<vector<double>> curves;                       // [p, 4]: where in the family a command is.
  vector<vector<double>> command_weights;                // [h, 2 p]: weights of the first layer.
  vector<vector<double>> lower, upper;                 // [M, k]: fences, series in the phase.
  double unit = 1.0;
};

// Monomials up to degree 2 in so many numbers: 1, c_i, then c_i c_j for i <= j row by row.
size_t monomials(size_t count) { return 1 + count + count * (count + 1) / 2; }

vector<vector<double>> rows_of(const Array& array) {
  vector<vector<double>> rows;
  const auto columns = static_cast<size_t>(array.shape[1]);
  for (size_t i = 0; i < array.values.size(); i += columns)
    rows.emplace_back(array.values.begin() + i, array.values.begin() + i + columns);
  return rows;
}

// network.weights[i] and network.biases[i] of an owner, from some inputs to `outputs`.
vector<Layer> layers_of(const std::map<string, Array>& arrays, int depth, int outputs,
                        int columns = 2) {
  vector<Layer> layers;
  if (depth < 1 || depth > 50) refuse("a network of " + std::to_string(depth) + " layers");
  for (int i = 0; i < depth; ++i) {
    const string place = "[" + std::to_string(i) + "]";
    const auto found = arrays.find("network.weights" + place);
    if (found == arrays.end() || found->second.shape.size() != 2)
      refuse("no array 'network.weights" + place + "' in the model");
    Layer layer;
    layer.rows = i + 1 == depth ? outputs : found->second.shape[0];
    layer.columns = columns;
    layer.weights = array(arrays, "network.weights" + place, {layer.rows, columns}).values;
    layer.biases = array(arrays, "network.biases" + place, {layer.rows}).values;
    columns = layer.rows;
    layers.push_back(layer);
  }
  return layers;
}

vector<Command> commands_of(const Json& list) {
  vector<Command> found;
  limit(list_of(list, "the commands").size(), 7, "commands");
  for (const Json& row : list.items) {
    only(row, "a command", {"name", "low", "high", "largest_change"});
    Command c;
    c.name = text_of(*row.find("name"), "a command's name");
    only_a_name(c.name, "a command");
    c.low = hexadecimal(*row.find("low"), c.name);
    c.high = hexadecimal(*row.find("high"), c.name);
    const Json& change = *row.find("largest_change");
    if (change.type != Json::null) c.change = hexadecimal(change, c.name);
    if (!(c.low < c.high && c.high - c.low < HUGE_VAL && c.change > 0.0))
      refuse("the command " + c.name + " without a range, or with a change that is none");
    for (const Command& other : found)
      if (other.name == c.name) refuse("two commands named " + c.name);
    found.push_back(c);
  }
  if (found.empty()) refuse("a gait that takes commands, without any");
  return found;
}

// The rest of a family's policy; the first layer's weights of commands are taken out of the network.
Family family_of(Policy& p, const Json& table, const std::map<string, Array>& arrays, int joints) {
  Family f;
  f.commands = commands_of(table);
  const int count = static_cast<int>(f.commands.size());
  const int terms = static_cast<int>(monomials(f.commands.size()));
  f.guard_outputs = rows_of(array(arrays, "guard_outputs", {terms, joints}));
  f.guard_slopes = rows_of(array(arrays, "guard_slopes", {terms, joints}));
  f.guard_z1 = array(arrays, "guard_z1", {terms}).values;
  f.curves = rows_of(array(arrays, "curves", {count, 4}));
  Layer& first = p.layers[0];
  const vector<vector<double>> weights = rows_of({{first.rows, first.columns}, first.weights});
  first.columns = 2;
  first.weights.clear();
  for (const vector<double>& row : weights) {
    first.weights.insert(first.weights.end(), row.begin(), row.begin() + 2);
    f.command_weights.emplace_back(row.begin() + 2, row.end());
  }
  return f;
}

Ankle ankle_of(const Json& table, const Constants& constants) {
  only(table, "the ankle's torque", {"layers", "arrays"});
  const auto arrays =
      arrays_of(field(table, "the ankle's torque", "arrays"), "policy.ankle", constants);
  const int depth = integer_of(field(table, "the ankle's torque", "layers"), "layers");
  Ankle a = {layers_of(arrays, depth, 1), array(arrays, "most", {}).values[0],
             array(arrays, "input_scale", {2}).values, array(arrays, "input_shift", {2}).values};
  if (arrays.size() != 3 + 2 * a.layers.size()) refuse("other arrays of the ankle's torque");
  return a;
}

Policy policy_of(const Json& table, int joints, const Constants& constants,
                 std::optional<Family>& family) {
  vector<string> fields = {"kind", "activation", "layers", "z2_dependence", "arrays"};
  const Json* told = table.find("commands");
  const Json* ankle = table.find("ankle");
  if (told) fields.push_back("commands");
  if (ankle) fields.push_back("ankle");
  only(table, "the policy", fields);
  const auto text = [&](const char* name) {
    return text_of(field(table, "the policy", name), string("the policy's ") + name);
  };
  Policy p;
  const bool commanded = text("kind") == "CommandedPolicy";
  if (commanded != (told != nullptr)) refuse("commands of a policy that takes none, or none of one");
  if (commanded || text("kind") == "HybridInvariantPolicy") p.hybrid_invariant = true;
  else if (text("kind") != "MLPPolicy") throw Unknown{"a policy of the kind " + text("kind")};
  if (text("activation") == "softplus") p.softplus = true;
  else if (text("activation") != "tanh") throw Unknown{"the activation " + text("activation")};
  const Json& dependence = field(table, "the policy", "z2_dependence");
  if (dependence.type != Json::boolean) refuse("z2_dependence that is neither true nor false");
  p.z2_dependence = dependence.number_value != 0.0;
  if (ankle) p.ankle = ankle_of(*ankle, constants);
  if (ankle && (commanded || !p.z2_dependence))
    throw Unknown{"an ankle's torque of a gait with commands, or of z1 alone"};
  const auto arrays = arrays_of(field(table, "the policy", "arrays"), "policy", constants);
  size_t used = 8;
  p.lower = array(arrays, "lower", {joints}).values;
  p.upper = array(arrays, "upper", {joints}).values;
  p.scale = array(arrays, "input_scale", {2}).values;
  p.shift = array(arrays, "input_shift", {2}).values;
  if (p.hybrid_invariant && !commanded) {
    p.guard = array(arrays, "z_guard", {}).values[0];
    p.start = array(arrays, "z_start", {}).values[0];
    p.cubic = array(arrays, "cubic", {4, joints}).values;
    used = 7;
  } else if (!commanded) {
    const vector<double>& ends = array(arrays, "start_and_guard", {2}).values;
    p.start = ends[0];
    p.guard = ends[1];
    used = 5;
  }
  const int depth = integer_of(field(table, "the policy", "layers"), "the number of layers");
  p.layers = layers_of(arrays, depth, joints,
                       commanded ? 2 + 2 * static_cast<int>(list_of(*told, "the commands").size()) : 2);
  if (commanded) family = family_of(p, *told, arrays, joints);
  used += 2 * p.layers.size();
  if (used != arrays.size()) refuse("arrays of the policy that its kind does not have");
  return p;
}

struct Tube {
  vector<double> lower, upper;  // Chebyshev coefficients of zeta = z2^2/2 over the phase.
  double unit = 1.0, start = 0.0, guard = 0.0;  // z1 at phase 0 and 1.
};

Tube tube_of(const Json& table, const Policy& policy, const Constants& constants) {
  only(table, "the tube", {"lower", "upper", "unit", "span"});
  const auto arrays = arrays_of(table, "tube", constants);
  Tube t;
  for (const char* side : {"lower", "upper"}) {
    const auto found = arrays.find(side);
    if (found == arrays.end() || found->second.shape.size() != 1)
      refuse(string("no series '") + side + "' in the tube");
    (string(side) == "lower" ? t.lower : t.upper) = found->second.values;
  }
  t.unit = array(arrays, "unit", {}).values[0];
  t.start = policy.start;
  t.guard = policy.guard;
  if (arrays.count("span")) {
    t.start = array(arrays, "span", {2}).values[0];
    t.guard = array(arrays, "span", {2}).values[1];
  }
  return t;
}

// The fences of a family.
void read_fences(const Json& table, const Constants& constants, Family& f) {
  only(table, "the tube", {"lower", "upper", "unit", "span"});
  const auto arrays = arrays_of(table, "tube", constants);
  if (arrays.count("span")) refuse("a span of a tube that follows commands");
  for (const char* side : {"lower", "upper"}) {
    const auto found = arrays.find(side);
    if (found == arrays.end() || found->second.shape.size() != 2 ||
        found->second.shape[0] != static_cast<int>(f.guard_z1.size()))
      refuse(string("no series '") + side + "' in the tube");
    (string(side) == "lower" ? f.lower : f.upper) = rows_of(found->second);
  }
  f.unit = array(arrays, "unit", {}).values[0];
}

// What was learned of the robot beyond its links; see the policy's section.
struct FlowResidual {
  vector<Layer> layers;
  vector<double> scale, shift, bound;  // [2] each
};

struct ResetResidual {
  Layer layer;
  vector<double> scale, shift, bound;  // [2], [2], [1 + m]
};

FlowResidual flow_residual_of(const Json& table, const Constants& constants) {
  only(table, "the flow's residual", {"layers", "arrays"});
  const auto arrays =
      arrays_of(field(table, "the flow's residual", "arrays"), "residuals.flow", constants);
  const int depth = integer_of(field(table, "the flow's residual", "layers"), "layers");
  FlowResidual r = {layers_of(arrays, depth, 2), array(arrays, "scale", {2}).values,
                    array(arrays, "shift", {2}).values, array(arrays, "bound", {2}).values};
  if (arrays.size() != 3 + 2 * r.layers.size()) refuse("other arrays of the flow's residual");
  return r;
}

ResetResidual reset_residual_of(const Json& table, int joints, const Constants& constants) {
  only(table, "the reset's residual", {"arrays"});
  const auto arrays =
      arrays_of(field(table, "the reset's residual", "arrays"), "residuals.reset", constants);
  const int rows = 1 + joints;
  if (arrays.size() != 5) refuse("other arrays of the reset's residual");
  return {{rows, 2, array(arrays, "weight", {rows, 2}).values, array(arrays, "offset", {rows}).values},
          array(arrays, "scale", {2}).values,
          array(arrays, "shift", {2}).values,
          array(arrays, "bound", {rows}).values};
}

}  // namespace
