#pragma once

#include "families.hpp"

namespace {

// ---------------------------------------------------------------------------- 19 cart-poles
//
// A second family of systems: a pole on a cart, which one motor drives along a rail. Its state is
// (x, theta, x', theta'): the cart's place from the middle of the rail, the pole's angle from the
// upright, and their rates. The chart is an ellipsoid of states: a radius r and three angles. From the
// file's masses and lengths this section forms the equations of cart and pole, of which the force is
// one unknown and the pole's angular acceleration the other; from the weights the policy's gradient;
// and from the ellipsoid's matrix its inverse.
//
// The controller wants the velocity v(z), z = (x, theta, s), with s = J theta' + m l cos(theta) x', and
// makes e = x' - v decay: e' = -k(z, e) e. The network v has no biases and is odd, k is even, and the
// equations of motion are odd. So the flow at the opposite of a state is the opposite, margins are the
// same, and the angles need to cover one half of the directions only.

struct CartPole {
  I mass, moment, inertia;                  // M, m l, J: of both bodies; of the pole about its hinge.
  I cart_damping, pole_damping, gravity;
  I rail, lean, force_limit;                // Limits of |x|, |theta| and the force.
  vector<double> gains, output, scale;      // [3], [h], [3]: the network v,
  vector<vector<double>> hidden;            // [h, 3]
  double decay = 0.0;                       // and what k is at rest,
  vector<double> decay_output, decay_scale; // [h], [4]: with its network,
  vector<vector<double>> decay_hidden;      // [h, 4]
  vector<vector<double>> shape;             // [4, 4]: of the ellipsoid.
  double rate = 0.0;                        // The claimed decay of r.
  vector<string> words;                     // Of the robot.
};

constexpr double kCore = 0.125;

const KnownFamily& cartpoles() {
  static const KnownFamily known = {
      "cartpole",
      "a cart-pole",
      {"radius", "quarter turn", "half turn", "full turn"},
      {"policy", "ball", "decay", "rate"},
      {{"core", {0.0, 0.0}, {kCore, 1.0}},
       {"face", {1.0, 0.0}, {1.0, 1.0}},
       {"ring", {kCore, 0.0}, {1.0, 1.0}},
       {"set", {0.0, 0.0}, {1.0, 1.0}}},
      {{"descent", "ring", "-r'/r less the claimed rate", "1/s", 1},
       {"force", "set", "share of the force limit that is left, either way,", "", 2},
       {"inward", "face", "d/dt (1 - r^2)", "1/s", 1},
       {"rail", "set", "share of the rail that is left, either way,", "", 2},
       {"settling", "core", "-dr'/dr less the claimed rate", "1/s", 1},
       {"upright", "set", "share of the pole's room that is left, either way,", "", 2}}};
  return known;
}

CartPole cartpole_of(const Json& model, const Constants& constants) {
  CartPole c;
  const Json& robot = field(model, "the model", "robot");
  only(robot, "the robot",
       {"cart_mass", "pole_mass", "distance", "pole_inertia", "cart_armature", "pole_armature",
        "cart_damping", "pole_damping", "gravity", "rail_low", "rail_high", "lean", "force_limit",
        "upright", "turn", "gear"});
  const auto number = [&](const char* name) { return hexadecimal(*robot.find(name), name); };
  const auto positive = [&](const char* name) { return number_above(robot, name); };
  const auto not_negative = [&](const char* name) { return number_from(robot, name); };
  const I pole = positive("pole_mass"), distance = positive("distance");
  c.mass = positive("cart_mass") + pole + not_negative("cart_armature");
  c.moment = pole * distance;
  c.inertia = not_negative("pole_inertia") + c.moment * distance + not_negative("pole_armature");
  c.cart_damping = not_negative("cart_damping");
  c.pole_damping = not_negative("pole_damping");
  c.gravity = positive("gravity");
  c.rail = I(0.5) * (I(number("rail_high")) - I(number("rail_low")));
  c.lean = positive("lean");
  // Beyond a quarter turn the pole would not be upright; 1.5707963267948966 is below pi/2.
  if (number("lean") > 1.5707963267948966) refuse("a robot whose lean is over a quarter turn");
  if (number("turn") != 1.0 && number("turn") != -1.0) refuse("a robot whose turn is not 1 or -1");
  for (const char* unused : {"gear", "upright"}) number(unused);
  c.force_limit = positive("force_limit");
  if (!(c.rail.low() > 0.0)) refuse("a rail without length");
  c.rate = hexadecimal(field(model, "the model", "rate"), "a rate");
  if (!(c.rate > 0.0)) refuse("a rate that is not above 0");
  const auto policy =
      arrays_of(field(model, "the model", "policy"), "controls.policy", constants);
  const auto decay = arrays_of(field(model, "the model", "decay"), "controls.decay", constants);
  const auto ball = arrays_of(field(model, "the model", "ball"), "ball", constants);
  if (policy.size() != 4 || decay.size() != 4 || ball.size() != 1 || !policy.count("hidden") ||
      policy.at("hidden").shape.size() != 2)
    refuse("a policy, decay or ball with other arrays");
  const int width = policy.at("hidden").shape[0];
  c.gains = array(policy, "gains", {3}).values;
  c.scale = array(policy, "scale", {3}).values;
  c.output = array(policy, "output", {width}).values;
  c.hidden = rows_of(array(policy, "hidden", {width, 3}));
  c.decay = array(decay, "base", {}).values[0];
  c.decay_scale = array(decay, "scale", {4}).values;
  c.decay_output = array(decay, "output", {width}).values;
  c.decay_hidden = rows_of(array(decay, "hidden", {width, 4}));
  c.shape = rows_of(array(ball, "shape", {4, 4}));
  for (const vector<double>& scale : {c.scale, c.decay_scale})
    for (const double x : scale)
      if (!(x > 0.0)) refuse("a scale of a network that is not above 0");
  for (size_t i = 0; i < 4; ++i)
    for (size_t j = i; j < 4; ++j)
      if (i == j ? !(c.shape[i][j] > 0.0) : c.shape[i][j] != 0.0)
        refuse("a ball whose matrix is not lower triangular with a positive diagonal");
  match_constants(constants,
                  {{"controls.policy", policy}, {"controls.decay", decay}, {"ball", ball}});
  c.words = {"cart " + brief(number("cart_mass")) + " kg, pole " + brief(number("pole_mass")) +
                 " kg with its centre of mass " + brief(number("distance")) +
                 " m from the hinge, inertia about that centre " + brief(number("pole_inertia")) +
                 " kg m^2",
             "armature " + brief(number("cart_armature")) + " kg, " +
                 brief(number("pole_armature")) + " kg m^2; damping " +
                 brief(number("cart_damping")) + " N s/m, " + brief(number("pole_damping")) +
                 " N m s; gravity " + brief(number("gravity")) + " m/s^2",
             "rail from " + brief(number("rail_low")) + " to " + brief(number("rail_high")) +
                 " m, pole within " + brief(number("lean")) + " rad of the upright, force up to " +
                 brief(number("force_limit")) + " N"};
  return c;
}

// The policy's velocity and its gradient, backwards through the network.
template <class S>
S velocity_of(const CartPole& c, const S* z, S* gradient) {
  vector<S> inputs;
  S total(0.0);
  for (size_t i = 0; i < 3; ++i) {
    inputs.push_back(inverse(I(c.scale[i])) * z[i]);
    total = total + I(c.gains[i]) * inputs[i];
    gradient[i] = S(I(c.gains[i]));
  }
  for (size_t k = 0; k < c.output.size(); ++k) {
    const vector<double>& row = c.hidden[k];
    S sum = I(row[0]) * inputs[0] + I(row[1]) * inputs[1] + I(row[2]) * inputs[2];
    const S t = tanh_of(sum);
    total = total + I(c.output[k]) * t;
    const S slope = I(c.output[k]) * (S(1.0) - t * t);
    for (size_t i = 0; i < 3; ++i) gradient[i] = gradient[i] + I(row[i]) * slope;
  }
  for (size_t i = 0; i < 3; ++i) gradient[i] = inverse(I(c.scale[i])) * gradient[i];
  return total;
}

// k: what it is at rest, and a sum of squares of tanh.
template <class S>
S decay_of(const CartPole& c, const S* y) {
  vector<S> inputs;
  for (size_t i = 0; i < 4; ++i) inputs.push_back(inverse(I(c.decay_scale[i])) * y[i]);
  S total{I(c.decay)};
  for (size_t k = 0; k < c.decay_output.size(); ++k) {
    S sum(0.0);
    for (size_t i = 0; i < 4; ++i) sum = sum + I(c.decay_hidden[k][i]) * inputs[i];
    const S t = tanh_of(sum);
    total = total + I(c.decay_output[k]) * (t * t);
  }
  return total;
}

// Rates of a state, and the force: both equations of motion, solved for the cart's acceleration that
// the policy and the decay of e ask for.
template <class S>
S motion(const CartPole& c, const S* state, S* rates) {
  S gradient[3], sine, cosine;
  const S &velocity = state[2], &turning = state[3];
  sincos(state[1], sine, cosine);
  S y[4] = {state[0], state[1], c.inertia * turning + c.moment * (cosine * velocity), S(0.0)};
  y[3] = velocity - velocity_of(c, y, gradient);
  const S torque = (c.moment * c.gravity) * sine - c.pole_damping * turning;
  const S momentum = torque - c.moment * (sine * (turning * velocity));
  const S acceleration = gradient[0] * velocity + gradient[1] * turning + gradient[2] * momentum -
                         decay_of(c, y) * y[3];
  const S angular = inverse(c.inertia) * (torque - c.moment * (cosine * acceleration));
  rates[0] = velocity;
  rates[1] = turning;
  rates[2] = acceleration;
  rates[3] = angular;
  return c.mass * acceleration + c.moment * (cosine * angular) -
         c.moment * (sine * (turning * turning)) + c.cart_damping * velocity;
}

// The inverse of a lower triangular matrix, row by row.
vector<vector<I>> inverse_of(const vector<vector<double>>& lower) {
  const size_t n = lower.size();
  vector<vector<I>> found(n, vector<I>(n, I(0.0)));
  for (size_t column = 0; column < n; ++column)
    for (size_t row = column; row < n; ++row) {
      I left(row == column ? 1.0 : 0.0);
      for (size_t k = column; k < row; ++k) left = left - I(lower[row][k]) * found[k][column];
      found[row][column] = left / I(lower[row][row]);
    }
  return found;
}

// What is known of a state of the ellipsoid: the rate of its radius, and what has a limit.
template <class S>
struct OnBall { S speed, force, x, theta; };

template <class S>
OnBall<S> on_ball(const CartPole& c, const S& radius, const Formula* normal) {
  S y[4], rates[4];
  for (size_t i = 0; i < 4; ++i) {
    Formula along(0.0);
    for (size_t k = 0; k <= i; ++k) along = along + I(c.shape[i][k]) * normal[k];
    y[i] = S(along) * radius;
  }
  OnBall<S> found;
  found.force = motion(c, y, rates);
  found.x = y[0];
  found.theta = y[1];
  const vector<vector<I>> back = inverse_of(c.shape);
  for (size_t i = 0; i < 4; ++i) {
    S part(0.0);
    for (size_t k = 0; k <= i; ++k) part = part + back[i][k] * rates[k];
    found.speed = found.speed + S(normal[i]) * part;
  }
  return found;
}

// Margins of all conditions as formulas of the chart: radius, and angles up to 1.5708, 3.1416 and
// 6.2832 rad. These are more than a quarter, a half and a full turn: every direction of one half is
// there.
std::shared_ptr<const Listing> recorded(const CartPole& c) {
  Recording recording;
  const Formula radius = Formula::axis(recording, 0);
  constexpr double lengths[] = {1.5708, 3.1416, 6.2832};
  Formula sine[3], cosine[3];
  for (size_t k = 0; k < 3; ++k)
    sincos(I(lengths[k]) * Formula::axis(recording, k + 1), sine[k], cosine[k]);
  const Formula inner = sine[0] * sine[1];
  const Formula normal[4] = {cosine[0], sine[0] * cosine[1], inner * cosine[2], inner * sine[2]};
  const auto at = on_ball<Formula>(c, radius, normal);
  const auto moved = on_ball<DualOf<Formula>>(c, {radius, Formula(1.0)}, normal);
  const std::map<string, vector<Formula>> margins = {
      {"inward", {I(-2.0) * at.speed}},
      {"descent", {-(at.speed * inverse(radius)) - Formula(c.rate)}},
      {"settling", {-moved.speed.d - Formula(c.rate)}},
      {"force", both_sides(at.force, c.force_limit)},
      {"rail", both_sides(at.x, c.rail)},
      {"upright", both_sides(at.theta, c.lean)}};
  return listing_of(recording, 4, margins);
}

// What follows for trajectories once each condition holds: `holds` says of which that is so, and how
// much of a margin it has. A trajectory that reached the face would turn back there, so none leaves
// the set. r' is 0 at r = 0; from there on it falls at least like -rate r in the core, and is below
// -rate r on the ring: so r decays like exp(-rate t).
std::map<int, vector<string>> conclusions(const CartPole& c, const ProvedMargin& margin) {
  std::map<int, vector<string>> found;
  for (const char* name : {"force", "rail", "upright"})
    if (!(margin(name) >= 0.0)) return found;
  if (!(margin("inward") > 0.0)) return found;
  found[2] = {"every trajectory of the full order that starts in the set stays in it for ever",
              "on it the motor's force is within its limits, the cart on its rail, the pole upright"};
  if (margin("descent") >= 0.0 && margin("settling") >= 0.0)
    found[3] = {"from every state of the set the radius decays at least like exp(-" +
                brief(c.rate) + " t): the pole comes to rest upright, at the middle of the rail"};
  return found;
}

DerivedSystem derived_cartpole(const Json& model, const Constants& constants, const string& weights) {
  const CartPole c = cartpole_of(model, constants);
  DerivedSystem found = {c.words, recorded(c),
                         [c](const ProvedMargin& margin) { return conclusions(c, margin); }};
  const string width = std::to_string(c.output.size());
  found.words.push_back("policy 3-" + width + "-1, decay of the velocity's error 4-" + width +
                        "-1, tanh; " + weights);
  found.words.push_back("the claimed rate of the radius is " + brief(c.rate) + " 1/s");
  found.words.push_back("set: (x, theta, x', theta') = C n r with |n| = 1, r up to 1, rows of C:");
  for (const vector<double>& row : c.shape) {
    string words = " ";
    for (const double x : row) words += " " + brief(x);
    found.words.push_back(words);
  }
  return found;
}

}  // namespace
