#pragma once

#include "mechanics.hpp"

namespace {

// ------------------------------------------------------------------------- 10, held torques
//
// Accelerations of all coordinates where those of the outputs are given, the torques that these need,
// and the third derivatives of the outputs while joint torques stay as they are. For these the motion of
// all links is differentiated once more: with D q''' = -R, R all of d/dt (inertial and gravitational
// moments) that does not have q''' in it, q''' is one of the whole robot and knows no policy. What the
// desired outputs do meanwhile follows from their third derivatives and from those of z: z1 is linear in
// q, and z2' = M g x_com. docs/level5_proof.md uses them.

// a1 b1, a1 b2 + a2 b1, a2 b2: what D^2 y_d[a, b] has of its directions.
template <class S>
std::array<S, 3> pairs(const S& a1, const S& a2, const S& b1, const S& b2) {
  return {a1 * b1, a1 * b2 + a2 * b1, a2 * b2};
}

// a1^3, 3 a1^2 a2, 3 a1 a2^2, a2^3: the same of D^3 y_d[a, a, a].
template <class S>
std::array<S, 4> triples(const std::array<S, 3>& squares, const S& a1, const S& a2) {
  return {squares[0] * a1, I(3.0) * (squares[0] * a2), I(3.0) * (squares[2] * a1), squares[2] * a2};
}

// Derivatives of a desired output by z1 and z2, of first and of second order.
template <class S>
struct Bend {
  S d1, d2;
  std::array<S, 3> second;

  S along(const std::array<S, 3>& pair) const {
    return second[0] * pair[0] + second[1] * pair[1] + second[2] * pair[2];
  }
};

template <class T>
vector<Bend<T>> bends(const vector<Jet<T>>& jets) {
  vector<Bend<T>> found;
  for (const Jet<T>& j : jets) found.push_back({j.c[1], j.c[2], {j.c[3], j.c[4], j.c[5]}});
  return found;
}

// Of a state whose z moves; the jets have third derivatives if it does.
template <class T>
vector<Bend<DualOf<T>>> bends(const vector<Jet<T>>& jets, const T& dz1, const T& dz2) {
  vector<Bend<DualOf<T>>> found;
  for (const Jet<T>& j : jets) {
    const auto third = [&j](size_t k) { return j.third.empty() ? T(0.0) : j.third[k]; };
    const auto moved = [&](const T& value, const T& by1, const T& by2) {
      return DualOf<T>(value, by1 * dz1 + by2 * dz2);
    };
    found.push_back({moved(j.c[1], j.c[3], j.c[4]), moved(j.c[2], j.c[4], j.c[5]),
                     {moved(j.c[3], third(0), third(1)), moved(j.c[4], third(1), third(2)),
                      moved(j.c[5], third(2), third(3))}});
  }
  return found;
}

// Of the directions of links that turn at w, while w changes at `rates`.
template <class S>
vector<Vec<S>> turning(const Pose<S>& pose, const vector<S>& w, const vector<S>& rates) {
  vector<Vec<S>> out;
  for (size_t k = 0; k < w.size(); ++k)
    out.push_back(scaled(rates[k], quarter_turned(pose.e[k])) - scaled(w[k] * w[k], pose.e[k]));
  return out;
}

// Second derivatives of z and of the coordinates; those of the links' angles, and of their directions.
template <class S>
struct Acceleration {
  S ddz1, ddz2;
  vector<S> ddq, dw;
  vector<Vec<S>> directions;
};

// ddz2 from the centre of mass, ddz1 from the moment about the stance foot.
template <class S>
Acceleration<S> acceleration(Motion<S>& p, const vector<S>& ddy, const vector<Bend<S>>& desired) {
  const auto& robot = p.robot;
  const Pose<S>& pose = p.pose();
  const vector<S>& w = p.w();
  const S ddz2 = robot.gravity * point(robot.moment, pose.spin(w)).x;
  const std::array<S, 3> squares = pairs(p.dz1(), p.dz2(), p.dz1(), p.dz2());
  vector<S> joints;
  for (size_t j = 0; j < desired.size(); ++j)
    joints.push_back(desired[j].along(squares) + desired[j].d2 * ddz2 + ddy[j]);
  const vector<S> known = link_angles(robot, p.lifted(S(I(0.0)), joints));
  const vector<Vec<S>> bent = turning(pose, w, known);
  S moment = p.dz2();
  for (size_t i = 0; i < w.size(); ++i)
    moment = moment + robot.mass[i] * cross(pose.centre[i], point(robot.centre[i], bent)) +
             robot.inertia[i] * known[i];
  const S ddz1 = -moment / p.transversal();
  for (size_t j = 0; j < desired.size(); ++j) joints[j] = joints[j] + desired[j].d1 * ddz1;
  Acceleration<S> found = {ddz1, ddz2, p.lifted(ddz1, joints), {}, {}};
  found.dw = link_angles(robot, found.ddq);
  found.directions = turning(pose, w, found.dw);
  return found;
}

// Mass times (acceleration plus gravity) of each link: what ground and joints must bring up.
template <class S>
vector<Vec<S>> needed_forces(Motion<S>& p, const Acceleration<S>& a) {
  vector<Vec<S>> out;
  for (size_t i = 0; i < a.dw.size(); ++i) {
    Vec<S> one = point(p.robot.centre[i], a.directions);
    one.z = one.z + S(p.robot.gravity);
    out.push_back({p.robot.mass[i] * one.x, p.robot.mass[i] * one.z});
  }
  return out;
}

// Torques of the joints under these accelerations.
template <class S>
vector<S> torques(Motion<S>& p, const Acceleration<S>& a) {
  const auto& robot = p.robot;
  vector<S> couples;
  for (size_t k = 0; k < a.dw.size(); ++k) couples.push_back(robot.inertia[k] * a.dw[k]);
  const vector<S> needed =
      generalised_forces(robot, p.pose().moments(needed_forces(p, a), couples));
  vector<S> out;
  for (size_t j = 1; j < needed.size(); ++j)
    out.push_back(needed[j] + robot.armature[j] * a.ddq[j] + robot.damping[j] * p.dq()[j]);
  return out;
}

// Sums of conjugate(arm) f over the links whose centre moves with each link.
template <class K, class S>
vector<Vec<S>> on_arms(const RobotOf<K>& robot, const vector<Vec<S>>& forces) {
  vector<Vec<S>> out;
  for (size_t k = 0; k < forces.size(); ++k) {
    Vec<S> sum{S(0.0), S(0.0)};
    for (size_t i = 0; i < forces.size(); ++i) {
      const ComplexOf<K>& arm = robot.centre[i][k];
      if (!arm.zero()) sum = sum + times(ComplexOf<K>{arm.along, -arm.across}, forces[i]);
    }
    out.push_back(sum);
  }
  return out;
}

// d^3 y/dt^3 of a state whose outputs' accelerations are ddy and whose z stays; `jets` are those of y_d
// there, of third order.
template <class S, class T>
vector<S> held_jerk(Motion<S>& p, const vector<S>& ddy, const vector<Jet<T>>& jets,
                    const vector<Bend<S>>& desired) {
  const auto& robot = p.robot;
  const Pose<S>& pose = p.pose();
  const vector<S>& w = p.w();
  const size_t n = w.size();
  const Acceleration<S> now = acceleration(p, ddy, desired);

  // R: what moments change by while q''' is zero. Of the directions -3 e w dw - quarter_turned(e) w^3.
  vector<Vec<S>> jerked, change;
  for (size_t k = 0; k < n; ++k) {
    const S square = w[k] * w[k];
    jerked.push_back(scaled(-(I(3.0) * (w[k] * now.dw[k])), pose.e[k]) -
                     scaled(square * w[k], quarter_turned(pose.e[k])));
  }
  for (size_t i = 0; i < n; ++i) {
    const Vec<S> b = point(robot.centre[i], jerked);
    change.push_back({robot.mass[i] * b.x, robot.mass[i] * b.z});
  }
  const vector<Vec<S>> on = on_arms(robot, needed_forces(p, now)), more = on_arms(robot, change);
  vector<S> rest;
  for (size_t k = 0; k < n; ++k)
    rest.push_back(w[k] * dot(pose.e[k], on[k]) - dot(quarter_turned(pose.e[k]), more[k]));
  rest = generalised_forces(robot, rest);
  for (size_t j = 1; j < n; ++j) rest[j] = rest[j] - robot.damping[j] * now.ddq[j];
  const vector<S> dddq = solved(pose.mass_matrix(), rest);

  S dddz1(0.0);
  for (size_t j = 0; j < n; ++j)
    if (magnitude(robot.hip_gradient[j]) != 0.0)
      dddz1 = dddz1 + robot.hip_gradient[j] * dddq[j];
  const S dddz2 = robot.gravity * point(robot.moment, now.directions).x;
  const S &dz1 = p.dz1(), &dz2 = p.dz2();
  const std::array<S, 3> mixed = pairs(dz1, dz2, now.ddz1, now.ddz2);
  const std::array<S, 4> cubes = triples(pairs(dz1, dz2, dz1, dz2), dz1, dz2);
  vector<S> out;
  for (size_t j = 0; j < desired.size(); ++j) {
    S cubic(0.0);
    for (size_t i = 0; i < jets[j].third.size(); ++i) cubic = cubic + S(jets[j].third[i]) * cubes[i];
    out.push_back(dddq[j + 1] - desired[j].d1 * dddz1 - desired[j].d2 * dddz2 -
                  I(3.0) * desired[j].along(mixed) - cubic);
  }
  return out;
}

}  // namespace
