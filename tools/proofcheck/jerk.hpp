#pragma once

#include "mechanics.hpp"

namespace {

// ------------------------------------------------------------------------- 10, held torques
//
// The third derivatives of the outputs while joint torques stay as they are. The motion of all links is
// differentiated once more: with D q''' = -R, R all of d/dt (inertial and gravitational moments) that
// does not have q''' in it, q''' is one of the whole robot and knows no policy. What the desired
// outputs do meanwhile follows from their third derivatives and from those of z: z1 is linear in q,
// and z2' = M g x_com. docs/level5_proof.md uses them.

// A Taylor model, or the value and derivative of one, times a Taylor model that does not move.
template <class T>
T steady(const T& k, const T& a) { return k * a; }
template <class T>
DualOf<T> steady(const T& k, const DualOf<T>& a) { return {k * a.v, k * a.d}; }

// a1 b1, a1 b2 + a2 b1, a2 b2: what D^2 y_d[a, b] has of its directions.
template <class S>
std::array<S, 3> pairs(const S& a1, const S& a2, const S& b1, const S& b2) {
  return {a1 * b1, a1 * b2 + a2 * b1, a2 * b2};
}
template <class S, class T>
S second_along(const Jet<T>& jet, const std::array<S, 3>& pair) {
  return steady(jet.c[3], pair[0]) + steady(jet.c[4], pair[1]) + steady(jet.c[5], pair[2]);
}

// a1^3, 3 a1^2 a2, 3 a1 a2^2, a2^3: the same of D^3 y_d[a, a, a].
template <class S>
std::array<S, 4> triples(const std::array<S, 3>& squares, const S& a1, const S& a2) {
  return {squares[0] * a1, I(3.0) * (squares[0] * a2), I(3.0) * (squares[2] * a1), squares[2] * a2};
}
template <class S, class T>
S third_along(const Jet<T>& jet, const std::array<S, 4>& triple) {
  S sum(0.0);
  for (size_t i = 0; i < jet.third.size(); ++i) sum = sum + steady(jet.third[i], triple[i]);
  return sum;
}

// Sums of conjugate(arm) f over the links whose centre moves with each link.
template <class S>
vector<Vec<S>> on_arms(const Robot& robot, const vector<Vec<S>>& forces) {
  vector<Vec<S>> out;
  for (size_t k = 0; k < forces.size(); ++k) {
    Vec<S> sum{S(0.0), S(0.0)};
    for (size_t i = 0; i < forces.size(); ++i) {
      const Complex& arm = robot.centre[i][k];
      if (!arm.zero()) sum = sum + times(Complex{arm.along, -arm.across}, forces[i]);
    }
    out.push_back(sum);
  }
  return out;
}

// d^3 y/dt^3 of a state whose outputs' accelerations are ddy; `desired` are jets of y_d there.
template <class S, class T>
vector<S> held_jerk(Motion<S>& p, const vector<S>& ddy, const vector<Jet<T>>& desired) {
  const Robot& robot = p.robot;
  const Pose<S>& pose = p.pose();
  const vector<S>& w = p.w();
  const size_t n = w.size(), m = desired.size();
  const S dz1 = p.dz1(), dz2 = p.dz2();

  // Accelerations: ddz2 from the centre of mass, ddz1 from the moment about the stance foot.
  const S ddz2 = robot.gravity * point(robot.moment, pose.spin(w)).x;
  const std::array<S, 3> squares = pairs(dz1, dz2, dz1, dz2);
  vector<S> joints;
  for (size_t j = 0; j < m; ++j)
    joints.push_back(second_along(desired[j], squares) + steady(desired[j].c[2], ddz2) + ddy[j]);
  const auto turning = [&](const vector<S>& rates) {  // Of the directions: quarter_turned(e) dw - e w^2.
    vector<Vec<S>> out;
    for (size_t k = 0; k < n; ++k)
      out.push_back(scaled(rates[k], quarter_turned(pose.e[k])) - scaled(w[k] * w[k], pose.e[k]));
    return out;
  };
  const vector<S> known = link_angles(robot, p.lifted(S(I(0.0)), joints));
  const vector<Vec<S>> bent = turning(known);
  S moment = dz2;
  for (size_t i = 0; i < n; ++i)
    moment = moment + robot.mass[i] * cross(pose.centre[i], point(robot.centre[i], bent)) +
             robot.inertia[i] * known[i];
  const S ddz1 = -moment / p.transversal();
  for (size_t j = 0; j < m; ++j) joints[j] = joints[j] + steady(desired[j].c[1], ddz1);
  const vector<S> ddq = p.lifted(ddz1, joints), dw = link_angles(robot, ddq);
  const vector<Vec<S>> accelerated = turning(dw);

  // R: what moments change by while q''' is zero. Of the directions -3 e w dw - quarter_turned(e) w^3.
  vector<Vec<S>> jerked, force, change;
  for (size_t k = 0; k < n; ++k) {
    const S square = w[k] * w[k];
    jerked.push_back(scaled(-(I(3.0) * (w[k] * dw[k])), pose.e[k]) -
                     scaled(square * w[k], quarter_turned(pose.e[k])));
  }
  for (size_t i = 0; i < n; ++i) {
    Vec<S> a = point(robot.centre[i], accelerated);
    const Vec<S> b = point(robot.centre[i], jerked);
    a.z = a.z + S(robot.gravity);
    force.push_back({robot.mass[i] * a.x, robot.mass[i] * a.z});
    change.push_back({robot.mass[i] * b.x, robot.mass[i] * b.z});
  }
  const vector<Vec<S>> on = on_arms(robot, force), more = on_arms(robot, change);
  vector<S> rest;
  for (size_t k = 0; k < n; ++k)
    rest.push_back(w[k] * dot(pose.e[k], on[k]) - dot(quarter_turned(pose.e[k]), more[k]));
  rest = generalised_forces(robot, rest);
  for (size_t j = 1; j < n; ++j) rest[j] = rest[j] - robot.damping[j] * ddq[j];
  const vector<S> dddq = solved(pose.mass_matrix(), rest);

  S dddz1(0.0);
  for (size_t j = 0; j < n; ++j)
    if (magnitude(robot.hip_gradient[j]) != 0.0)
      dddz1 = dddz1 + robot.hip_gradient[j] * dddq[j];
  const S dddz2 = robot.gravity * point(robot.moment, accelerated).x;
  const std::array<S, 3> mixed = pairs(dz1, dz2, ddz1, ddz2);
  const std::array<S, 4> cubes = triples(squares, dz1, dz2);
  vector<S> out;
  for (size_t j = 0; j < m; ++j)
    out.push_back(dddq[j + 1] - steady(desired[j].c[1], dddz1) - steady(desired[j].c[2], dddz2) -
                  I(3.0) * second_along(desired[j], mixed) - third_along(desired[j], cubes));
  return out;
}

}  // namespace
