#pragma once

#include "mechanics.hpp"

namespace {

// ------------------------------------------------------------------------- 11 told commands
//
// A step between two commands, before and after. Where a step ends is a function of the command after
// alone: a posture with the swing foot on its foothold. Where it begins, of the one before alone: what
// the impact leaves of the posture at that command.

// The end of a step at a command, and what its impact leaves.
template <class K>
struct End {
  K z1;
  vector<K> outputs, slopes;              // Desired outputs at the guard, and d y_d / d z1.
  Vec<K> foot;                            // The foothold, from the stance foot.
  K sine, cosine;                         // Of the ground's slope there.
  K start;                                // z1 after the impact,
  vector<K> start_outputs, start_slopes;  // and the same of what begins there.
};

// Where in the family commands are: in units of half their ranges from the middle, then by a cubic.
template <class K>
vector<K> places(const Family& family, const vector<K>& commands) {
  vector<K> found;
  for (size_t i = 0; i < commands.size(); ++i) {
    const Command& c = family.commands[i];
    const I middle = I(0.5) * (I(c.low) + I(c.high)), half = I(0.5) * (I(c.high) - I(c.low));
    const K x = inverse(half) * (commands[i] - K(middle));
    K y(0.0);
    for (size_t power = 4; power-- > 0;) y = y * x + K(I(family.curves[i][power]));
    found.push_back(y);
  }
  return found;
}

// Rows of coefficients, a monomial each, at a place of the family.
template <class K>
vector<K> combined(const vector<vector<double>>& rows, const vector<K>& monomial) {
  vector<K> found;
  for (size_t j = 0; j < rows[0].size(); ++j) {
    K total(0.0);
    for (size_t k = 0; k < rows.size(); ++k) total = total + I(rows[k][j]) * monomial[k];
    found.push_back(total);
  }
  return found;
}

// tan(s / 2) of the smaller s with a cos s + b sin s = a + m: with t the tangent,
// (2 a + m) t^2 - 2 b t + m = 0.
template <class K>
K half_tangent(const K& m, const K& a, const K& b) {
  const K r = m / b;
  return r / (K(1.0) + root(K(1.0) - r * ((I(2.0) * a + m) / b)));
}

// What the commands ask for: the foot's way ahead if they do, its height, and the height besides for
// each metre ahead.
template <class K>
struct Foothold {
  std::optional<K> length;
  K height, rise;
};

// Turns the swing leg about the hip until its foot is on the foothold, and for a length the last link
// about its joint first, until the foot is as far from the hip as the foothold.
template <class K>
void put_on_foothold(const RobotOf<K>& robot, const Foothold<K>& foothold, const K& z1,
                     vector<K>& outputs) {
  vector<K> q = outputs;
  K first = z1;
  for (size_t j = 0; j < outputs.size(); ++j) first = first - robot.hip_gradient[j + 1] * outputs[j];
  q.insert(q.begin(), inverse(robot.hip_gradient[0]) * first);
  const Pose<K> pose(robot, q);
  const int at_hip = robot.links - robot.leg, at_last = robot.links - 1;
  const Vec<K> hip = point(robot.hip, pose.e), leg = point(robot.foot, pose.e) - hip;
  const auto turn = [&](int joint, const K& half) {
    K& output = outputs[static_cast<size_t>(joint - 1)];
    output = output + I(2.0 * robot.turn(joint, joint)) * arctan(half);
  };
  if (!foothold.length) {
    // The height over the line through the stance foot that rises like the ground.
    const auto up = [&](const Vec<K>& v) { return v.z - foothold.rise * v.x; };
    const K a = up(leg);
    turn(at_hip, half_tangent<K>(foothold.height - up(hip) - a, a, up(quarter_turned(leg))));
    return;
  }
  if (robot.leg < 2) throw Unknown{"a step length of a robot without knees"};
  const K length = *foothold.length;
  const Vec<K> place = Vec<K>{length, foothold.height + foothold.rise * length} - hip;
  const auto tip = static_cast<size_t>(at_last);
  const Vec<K> last = times(robot.foot[tip], pose.e[tip]), upper = leg - last;
  const K far = dot(place, place);
  const K half = half_tangent<K>(far - dot(leg, leg), I(2.0) * dot(upper, last),
                                 I(2.0) * dot(upper, quarter_turned(last)));
  const K square = half * half, share = I(2.0) * inverse(K(1.0) + square);
  // Turned by s: cos s = 1 - share t^2, sin s = share t.
  const Vec<K> bent = upper + last + scaled<K>(share * half, quarter_turned(last)) -
                      scaled<K>(share * square, last);
  turn(at_hip, cross(bent, place) / (far + dot(bent, place)));
  turn(at_last, half);
}

template <class K>
End<K> end_at(const Model& model, const vector<K>& commands) {
  const Family& family = *model.family;
  const vector<K> monomial = powers(places(family, commands));
  const auto value = [&](const char* name) {
    std::optional<K> found;
    for (size_t i = 0; i < commands.size(); ++i)
      if (family.commands[i].name == name) found = commands[i];
    return found;
  };
  // The policy is that of the robot which the gait believes in.
  const RobotOf<K> robot = leaning(model.robot, value(kLean));
  End<K> end;
  end.cosine = K(1.0);
  if (const auto slope = value("slope")) sincos(*slope, end.sine, end.cosine);
  const Foothold<K> foothold = {value("step_length"), value("step_height").value_or(K(0.0)),
                                end.sine / end.cosine};
  end.z1 = K(0.0);
  for (size_t k = 0; k < monomial.size(); ++k)
    end.z1 = end.z1 + I(family.guard_z1[k]) * monomial[k];
  end.outputs = combined(family.guard_outputs, monomial);
  for (size_t j = 0; j < end.outputs.size(); ++j) {
    const I low(model.policy.lower[j]), width = I(model.policy.upper[j]) - low;
    end.outputs[j] = K(low) + width * logistic(end.outputs[j]);
  }
  put_on_foothold(robot, foothold, end.z1, end.outputs);
  end.slopes = combined(family.guard_slopes, monomial);

  // Coordinates there, and their rates for dz1 = 1.
  const auto lifted = [&](const K& hip, const vector<K>& joints) {
    vector<K> q = joints;
    K first = hip;
    for (size_t j = 0; j < joints.size(); ++j) first = first - robot.hip_gradient[j + 1] * joints[j];
    q.insert(q.begin(), inverse(robot.hip_gradient[0]) * first);
    return q;
  };
  const Pose<K> pose(robot, lifted(end.z1, end.outputs));
  const vector<K> rates = link_angles(robot, lifted(K(1.0), end.slopes));
  const ImpactResult<K> after = plastic_impact(robot, pose, rates);
  const auto along_hip = [&](const vector<K>& q) {
    K total(0.0);
    for (size_t j = 0; j < q.size(); ++j) total = total + robot.hip_gradient[j] * q[j];
    return total;
  };
  const K share = inverse(along_hip(after.dq));
  end.start = along_hip(after.pose.q);
  for (size_t j = 1; j < after.dq.size(); ++j) {
    end.start_outputs.push_back(after.pose.q[j]);
    end.start_slopes.push_back(share * after.dq[j]);
  }
  const K ahead = foothold.length ? *foothold.length : point(robot.foot, pose.e).x;
  end.foot = {ahead, foothold.height + foothold.rise * ahead};
  return end;
}

// Values and slopes in the phase, at both ends of a step, of the logits of the outputs.
template <class K>
vector<K> logits(const Policy& policy, const End<K>& from, const End<K>& to) {
  const K span = to.z1 - from.start;
  const size_t m = policy.lower.size();
  vector<K> found(4 * m);
  for (size_t j = 0; j < m; ++j) {
    const I low(policy.lower[j]), share = inverse(I(policy.upper[j]) - low);
    const K first = share * (from.start_outputs[j] - K(low)), last = share * (to.outputs[j] - K(low));
    const auto slope = [&](const K& s, const K& along) {
      return share * (along * span) / (s * (K(1.0) - s));
    };
    found[j] = logit(first);
    found[m + j] = slope(first, from.start_slopes[j]);
    found[2 * m + j] = logit(last);
    found[3 * m + j] = slope(last, to.slopes[j]);
  }
  return found;
}

template <class K>
Step<K> step_between(const Model& model, const vector<K>& before, const vector<K>& after,
                     const End<K>& from, const End<K>& to) {
  const Family& family = *model.family;
  Step<K> s;
  s.start = s.from = from.start;
  s.guard = s.to = to.z1;
  s.ends = logits(model.policy, from, to);
  s.before = places(family, before);
  s.after = places(family, after);
  vector<K> told = s.before;
  told.insert(told.end(), s.after.begin(), s.after.end());
  for (size_t i = 0; i < family.command_weights.size(); ++i) {
    K bias(I(model.policy.layers[0].biases[i]));
    for (size_t k = 0; k < told.size(); ++k) bias = bias + I(family.command_weights[i][k]) * told[k];
    s.first.push_back(bias);
  }
  s.lower = family.lower;
  s.upper = family.upper;
  s.unit = family.unit;
  s.start_outputs = from.start_outputs;
  s.guard_outputs = to.outputs;
  const auto is_told = [&](const char* name) {
    return std::any_of(family.commands.begin(), family.commands.end(),
                       [&](const Command& c) { return c.name == name; });
  };
  if (is_told("step_height") || is_told("slope")) {
    // Through the old foothold, which is as far behind the stance foot as it was ahead of the last one.
    const K rise = (from.foot.z + to.foot.z) / (from.foot.x + to.foot.x);
    s.ground = Ground<K>{rise, rise * from.foot.x - from.foot.z, from.sine, from.cosine, to.sine,
                         to.cosine};
  }
  return s;
}

// The step of all pairs of commands, on axes 2, 3, .. of the chart: before and after, command by
// command. A robot that is told a lean is off the one after by the next axis, whatever it is told then.
Step<Formula> told_step(const Model& model, Recording& in) {
  vector<Formula> before, after;
  std::optional<Formula> lean;
  const size_t count = model.family->commands.size();
  for (size_t i = 0; i < count; ++i) {
    before.push_back(Formula::axis(in, 2 + 2 * i));
    after.push_back(Formula::axis(in, 3 + 2 * i));
    if (model.family->commands[i].name == kLean)
      lean = after.back() + Formula::axis(in, 2 + 2 * count);
  }
  const End<Formula> from = end_at(model, before), to = end_at(model, after);
  Step<Formula> step = step_between(model, before, after, from, to);
  Step<Formula> then = step_between(model, after, after, to, to);
  step.robot = then.robot = std::make_shared<const RobotOf<Formula>>(leaning(model.robot, lean));
  step.then = std::make_shared<const Step<Formula>>(std::move(then));
  return step;
}

}  // namespace
