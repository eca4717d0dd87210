#pragma once

#include "policy.hpp"

namespace {

// ----------------------------------------------------------------------------- 10 mechanics
//
// A state of the zero dynamics: the robot follows its outputs exactly, so z gives all angles, and
// z with the flow gives all rates. S is TM, or Dual for derivatives along a direction in z.

template <class S>
struct Vec {
  S x, z;
};
template <class S>
Vec<S> operator+(const Vec<S>& a, const Vec<S>& b) { return {a.x + b.x, a.z + b.z}; }
template <class S>
Vec<S> operator-(const Vec<S>& a, const Vec<S>& b) { return {a.x - b.x, a.z - b.z}; }
template <class S>
Vec<S> scaled(const S& k, const Vec<S>& a) { return {k * a.x, k * a.z}; }
template <class S>
Vec<S> quarter_turned(const Vec<S>& a) { return {-a.z, a.x}; }  // Turned counter-clockwise.
template <class S>
S dot(const Vec<S>& a, const Vec<S>& b) { return a.x * b.x + a.z * b.z; }
template <class S>
S cross(const Vec<S>& a, const Vec<S>& b) { return a.x * b.z - a.z * b.x; }

template <class K, class S>
Vec<S> times(const ComplexOf<K>& k, const Vec<S>& a) {
  Vec<S> r{k.along * a.x, k.along * a.z};
  if (is_zero(k.across)) return r;
  return r + Vec<S>{-(k.across * a.z), k.across * a.x};
}

// Sum over links of row[k] times directions[k].
template <class K, class S>
Vec<S> point(const RowOf<K>& row, const vector<Vec<S>>& directions) {
  Vec<S> sum{S(0.0), S(0.0)};
  for (size_t k = 0; k < row.size(); ++k)
    if (!row[k].zero()) sum = sum + times(row[k], directions[k]);
  return sum;
}

// T q: absolute link angles, or their rates, from coordinates.
template <class S>
vector<S> link_angles(const Linkage& robot, const vector<S>& q) {
  vector<S> theta(q.size(), S(0.0));
  theta[0] = q[0];
  for (size_t k = 1; k < q.size(); ++k)
    theta[k] = robot.turn(int(k), int(k)) > 0 ? theta[k - 1] + q[k] : theta[k - 1] - q[k];
  return theta;
}

// The inverse: coordinates from absolute angles.
template <class S>
vector<S> coordinates_of(const Linkage& robot, const vector<S>& theta) {
  vector<S> q(theta.size(), S(0.0));
  q[0] = theta[0];
  for (size_t k = 1; k < q.size(); ++k)
    q[k] = robot.turn(int(k), int(k)) > 0 ? theta[k] - theta[k - 1] : theta[k - 1] - theta[k];
  return q;
}

// Generalised forces in q from moments about the links: T' times them.
template <class S>
vector<S> generalised_forces(const Linkage& robot, const vector<S>& moments) {
  vector<S> forces(moments.size(), S(0.0));
  for (int j = 0; j < robot.links; ++j)
    for (int k = j; k < robot.links; ++k)
      forces[j] = robot.turn(k, j) > 0 ? forces[j] + moments[k] : forces[j] - moments[k];
  return forces;
}

// Solve a x = b for a positive definite matrix: elimination without pivoting.
template <class S>
vector<S> solved(vector<vector<S>> a, vector<S> b) {
  const size_t n = b.size();
  for (size_t k = 0; k < n; ++k) {
    const S share = S(I(1.0)) / a[k][k];
    for (size_t i = k + 1; i < n; ++i) {
      const S factor = a[i][k] * share;
      for (size_t j = k + 1; j < n; ++j) a[i][j] = a[i][j] - factor * a[k][j];
      b[i] = b[i] - factor * b[k];
    }
  }
  for (size_t k = n; k-- > 0;) {
    for (size_t j = k + 1; j < n; ++j) b[k] = b[k] - a[k][j] * b[j];
    b[k] = b[k] / a[k][k];
  }
  return b;
}

// Angles of all links and what follows from them alone.
template <class S>
struct Pose {
  using K = Scalar<S>;
  const RobotOf<K>& robot;
  vector<S> q, theta;
  vector<Vec<S>> e;       // Directions of the links, (-sin, cos).
  vector<Vec<S>> centre;  // Of mass, of each link.

  Pose(const RobotOf<K>& r, vector<S> coordinates)
      : robot(r), q(std::move(coordinates)), theta(link_angles(r, q)) {
    for (const S& angle : theta) {
      S sine, cosine;
      sincos(angle, sine, cosine);
      e.push_back({-sine, cosine});
    }
    for (const RowOf<K>& row : robot.centre) centre.push_back(point(row, e));
  }

  // Rates of the directions, for link rates w.
  vector<Vec<S>> spin(const vector<S>& w) const {
    vector<Vec<S>> out;
    for (size_t k = 0; k < e.size(); ++k) out.push_back(scaled(w[k], quarter_turned(e[k])));
    return out;
  }

  // Angular momentum about `pivot`, counter-clockwise, of links that turn at w while the stance
  // foot stands still; a stance ankle's rotor turns against that foot.
  S momentum(const vector<S>& w, const Vec<S>* pivot = nullptr) const {
    const auto moving = spin(w);
    S sum(0.0);
    if (robot.feet) sum = robot.armature[0] * w[0];
    for (size_t i = 0; i < w.size(); ++i) {
      const Vec<S> arm = pivot ? centre[i] - *pivot : centre[i];
      sum = sum + robot.mass[i] * cross(arm, point(robot.centre[i], moving)) +
            robot.inertia[i] * w[i];
    }
    return sum;
  }

  // Moments about each link (per unit of its angle) of forces at the centres of mass, plus couples.
  vector<S> moments(const vector<Vec<S>>& forces, const vector<S>& couples) const {
    vector<S> out = couples;
    for (size_t k = 0; k < e.size(); ++k) {
      Vec<S> sum{S(0.0), S(0.0)};
      for (size_t i = 0; i < e.size(); ++i) {
        const ComplexOf<K>& arm = robot.centre[i][k];
        // (arm e)' . f = quarter_turned(e) . conjugate(arm) f
        if (!arm.zero()) sum = sum + times(ComplexOf<K>{arm.along, -arm.across}, forces[i]);
      }
      out[k] = out[k] + dot(quarter_turned(e[k]), sum);
    }
    return out;
  }

  // Momenta conjugate to q of links whose centres move at `velocity` and that turn at w.
  vector<S> momenta(const vector<Vec<S>>& velocity, const vector<S>& w) const {
    vector<Vec<S>> linear;
    vector<S> angular;
    for (size_t i = 0; i < w.size(); ++i) {
      linear.push_back({robot.mass[i] * velocity[i].x, robot.mass[i] * velocity[i].z});
      angular.push_back(robot.inertia[i] * w[i]);
    }
    vector<S> found = generalised_forces(robot, moments(linear, angular));
    const vector<S> rates = coordinates_of(robot, w);
    for (size_t j = 0; j < found.size(); ++j) found[j] = found[j] + robot.armature[j] * rates[j];
    return found;
  }

  // Angular momentum of each link per rate of each, about joints. The sum of m (arm_k e_k) . (arm_l e_l)
  // depends on nothing but the angle from link k to link l. The cosine of this one angle has better
  // bounds than the product of two directions, each of which is uncertain.
  vector<vector<S>> mass_of_links() const {
    const size_t n = theta.size();
    vector<vector<S>> found(n, vector<S>(n, S(0.0)));
    for (size_t k = 0; k < n; ++k)
      for (size_t l = k; l < n; ++l) {
        ComplexOf<K> sum{K(0.0), K(0.0)};  // Of m conjugate(arm_k) arm_l.
        for (size_t i = 0; i < n; ++i) {
          const ComplexOf<K> &a = robot.centre[i][k], &b = robot.centre[i][l];
          sum.along = sum.along + robot.mass[i] * (a.along * b.along + a.across * b.across);
          sum.across = sum.across + robot.mass[i] * (a.along * b.across - a.across * b.along);
        }
        if (k == l) {
          found[k][k] = S(sum.along + robot.inertia[k]);
          continue;
        }
        S sine, cosine;
        sincos(theta[l] - theta[k], sine, cosine);
        found[k][l] = sum.along * cosine;
        if (!is_zero(sum.across)) found[k][l] = found[k][l] - sum.across * sine;
        found[l][k] = found[k][l];
      }
    return found;
  }

  // Momenta conjugate to q per rate of each coordinate: T' times that of links times T, and what
  // motors add.
  vector<vector<S>> mass_matrix() const {
    const vector<vector<S>> links = mass_of_links();
    vector<vector<S>> found;  // Its columns are its rows.
    for (size_t j = 0; j < links.size(); ++j) {
      vector<S> column(links.size(), S(0.0));
      for (size_t k = 0; k < links.size(); ++k)
        for (size_t l = j; l < links.size(); ++l)
          column[k] = robot.turn(int(l), int(j)) > 0 ? column[k] + links[k][l]
                                                     : column[k] - links[k][l];
      found.push_back(generalised_forces(robot, column));
      found[j][j] = found[j][j] + S(robot.armature[j]);
    }
    return found;
  }

  vector<Vec<S>> velocities(const vector<S>& w) const {
    const auto moving = spin(w);
    vector<Vec<S>> out;
    for (const RowOf<K>& row : robot.centre) out.push_back(point(row, moving));
    return out;
  }
};

// Coordinates, or their rates, after the legs have swapped roles: on point feet the links are read from
// the other end, on flat ones the joints.
template <class S>
vector<S> swapped(const Linkage& robot, vector<S> q, vector<S> theta) {
  if (robot.feet) {
    std::reverse(q.begin(), q.end());
    return q;
  }
  std::reverse(theta.begin(), theta.end());
  return coordinates_of(robot, theta);
}

// After the swing foot has met the ground, the legs having swapped roles.
template <class S>
struct ImpactResult {
  Pose<S> pose;
  vector<S> dq;    // Rates of the coordinates.
  Vec<S> impulse;  // Of the ground on the new stance foot.
};

// Plastic impact of a robot whose links turn at w: the old stance foot is free, the impulse acts at the
// new one, so momenta conjugate to coordinates about the new foot are kept, and the new foot stands
// still after it. Before it, each link moved as it would about a foot that stands still, and with that
// foot besides: what the second brings into the momenta is what rates of coordinates change for.
//
// A flat foot lands level: then joints read from the other end are the new coordinates. If it turns,
// every link turned with it besides, but the rotor of its ankle turned by the joint's rate alone.
template <class S>
ImpactResult<S> plastic_impact(const RobotOf<Scalar<S>>& robot, const Pose<S>& before, vector<S> w) {
  const Vec<S> carried = point(robot.foot, before.spin(w));
  const size_t n = w.size();
  const S foot_turn = robot.feet ? w.back() : S(0.0);
  ImpactResult<S> found{Pose<S>(robot, swapped(robot, before.q, before.theta)),
                  swapped(robot, coordinates_of(robot, w), w), {}};
  vector<S> whole(n, S(0.0));
  vector<Vec<S>> moved(n, carried);
  if (robot.feet) {
    whole.assign(n, foot_turn);
    moved = found.pose.velocities(whole);
    for (Vec<S>& one : moved) one = one + carried;
  }
  vector<S> kept = found.pose.momenta(moved, whole);
  if (robot.feet) kept[0] = kept[0] - robot.armature[0] * foot_turn;
  const vector<S> change = solved(found.pose.mass_matrix(), kept);
  const vector<Vec<S>> more = found.pose.velocities(link_angles(robot, change));
  Vec<S> impulse{S(0.0), S(0.0)};
  if (robot.feet) {
    const Feet& f = *robot.feet;
    const Vec<S> stopped = carried + scaled(foot_turn, Vec<S>{S(-f.z), S(f.x)});
    impulse = {-(f.mass * stopped.x), -(f.mass * stopped.z)};
  }
  for (size_t i = 0; i < n; ++i) {
    const Vec<S> gained = more[i] - moved[i];
    impulse = impulse + Vec<S>{robot.mass[i] * gained.x, robot.mass[i] * gained.z};
    found.dq[i] = found.dq[i] + change[i];
  }
  found.impulse = impulse;
  return found;
}

// y_d and its first derivatives.
template <class S>
struct Outputs {
  vector<S> y, d1, d2;
};

template <class T>
Outputs<T> first_order(const vector<Jet<T>>& jets) {
  Outputs<T> out;
  for (const Jet<T>& jet : jets) {
    out.y.push_back(jet.c[0]);
    out.d1.push_back(jet.c[1]);
    out.d2.push_back(jet.c[2]);
  }
  return out;
}

template <class T>
Outputs<DualOf<T>> along(const vector<Jet<T>>& jets, const T& dz1, const T& dz2) {
  Outputs<DualOf<T>> out;
  for (const Jet<T>& jet : jets) {
    out.y.push_back({jet.c[0], jet.c[1] * dz1 + jet.c[2] * dz2});
    out.d1.push_back({jet.c[1], jet.c[3] * dz1 + jet.c[4] * dz2});
    out.d2.push_back({jet.c[2], jet.c[4] * dz1 + jet.c[5] * dz2});
  }
  return out;
}

// Values and first derivatives of jets at z; `jets` takes z and an order.
template <class S, class Jets>
Outputs<S> outputs_of_jets(Jets jets, const S& z1, const S& z2) {
  if constexpr (Under<S>::has_rate) return along(jets(z1.v, z2.v, 2), z1.d, z2.d);
  else return first_order(jets(z1, z2, 1));
}

// Values alone.
template <class S, class Jets>
vector<S> values_of_jets(Jets jets, const S& z1, const S& z2) {
  vector<S> out;
  if constexpr (Under<S>::has_rate) {
    for (const auto& jet : jets(z1.v, z2.v, 1))
      out.push_back({jet.c[0], jet.c[1] * z1.d + jet.c[2] * z2.d});
  } else {
    for (const auto& jet : jets(z1, z2, 0)) out.push_back(jet.c[0]);
  }
  return out;
}

// Outputs that are off zero, and their rates; they obey ddy = -w^2 y - 2 w dy.
template <class S>
struct Off {
  vector<S> y, dy;
  I bandwidth;  // w

  vector<S> ddy() const {
    vector<S> out;
    for (size_t j = 0; j < y.size(); ++j)
      out.push_back(-(square(bandwidth) * y[j]) - I(2.0) * bandwidth * dy[j]);
    return out;
  }
};

// Everything is computed when first asked for, and kept only once it is complete: an operation
// without a bound leaves nothing behind.
template <class S>
class Motion {
 public:
  const Model& model;
  using T = typename Under<S>::type;
  using K = Scalar<S>;
  const RobotOf<K>& robot;
  const Step<K>& step;
  const S z1, z2;
  const std::optional<Off<S>> off;  // Nothing: outputs are zero.
  const std::optional<T> known_phase;  // The phase, where it is known apart from z1.

  Motion(const Model& m, const Step<K>& s, S first, S second,
         std::optional<Off<S>> outputs_off = {}, std::optional<T> phase = {},
         std::optional<Outputs<S>> known = {})
      : model(m), robot(walker_of(m, s)), step(s), z1(std::move(first)), z2(std::move(second)),
        off(std::move(outputs_off)), known_phase(std::move(phase)), outputs_(std::move(known)) {}

  // Of the step, by its outputs.
  S phase() const {
    if constexpr (Under<S>::has_rate) {
      if (known_phase) return {*known_phase, inverse(step.span()) * z1.d};
    } else {
      if (known_phase) return *known_phase;
    }
    return inverse(step.span()) * (z1 - S(step.start));
  }

  const Outputs<S>& outputs() {
    const auto jets = [this](const T& first, const T& second, int order) {
      const T phase = known_phase ? *known_phase : inverse(step.span()) * (first - T(step.start));
      return desired_outputs(model.policy, step, phase, first, second, order);
    };
    if (!outputs_) outputs_ = outputs_of_jets(jets, z1, z2);
    return *outputs_;
  }

  // What the flow's residual adds to dz, and the reset's to z2 and rates, per z2.
  const vector<S>& flow_correction() {
    const auto jets = [this](const T& first, const T& second, int order) {
      return flow_residual(*model.flow, first, second, order);
    };
    if (!flow_correction_) flow_correction_ = values_of_jets(jets, z1, z2);
    return *flow_correction_;
  }
  const vector<S>& reset_correction() {
    const auto jets = [this](const T& first, const T& second, int order) {
      return reset_residual(*model.reset, first, second, order);
    };
    if (!reset_correction_) reset_correction_ = values_of_jets(jets, z1, z2);
    return *reset_correction_;
  }

  // q with c q = z1 and the joints at `joints`; linear, so it lifts rates as well.
  vector<S> lifted(const S& hip, const vector<S>& joints) const {
    S first = hip;
    for (size_t j = 0; j < joints.size(); ++j)
      if (magnitude(robot.hip_gradient[j + 1]) != 0.0)
        first = first - robot.hip_gradient[j + 1] * joints[j];
    vector<S> q = {inverse(robot.hip_gradient[0]) * first};
    q.insert(q.end(), joints.begin(), joints.end());
    return q;
  }

  const Pose<S>& pose() {
    if (pose_) return *pose_;
    vector<S> joints = outputs().y;
    if (off)
      for (size_t j = 0; j < joints.size(); ++j) joints[j] = joints[j] + off->y[j];
    pose_.emplace(robot, lifted(z1, joints));
    return *pose_;
  }

  // Link rates per unit of dz1 and of dz2.
  const vector<S>& per_dz1() {
    if (!along1_) along1_ = link_angles(robot, lifted(S(I(1.0)), outputs().d1));
    return *along1_;
  }
  const vector<S>& per_dz2() {
    if (!along2_) along2_ = link_angles(robot, lifted(S(I(0.0)), outputs().d2));
    return *along2_;
  }

  // Moment of the weight about the stance foot: dz2 but for the residual.
  const S& weight_moment() {
    if (!weight_moment_) weight_moment_ = robot.gravity * point(robot.moment, pose().e).x;
    return *weight_moment_;
  }
  // Torque of the stance ankle, forward, and what both bring up: dz2 but for the residual.
  S ankle() {
    const auto jets = [this](const T& first, const T& second, int order) {
      return ankle_torque(*model.policy.ankle, first, second, order);
    };
    if (!ankle_) ankle_ = values_of_jets(jets, z1, z2);
    return (*ankle_)[0];
  }
  S momentum_rate() { return model.policy.ankle ? weight_moment() + ankle() : weight_moment(); }
  const S& dz2() {
    if (!dz2_) dz2_ = model.flow ? momentum_rate() + flow_correction()[1] : momentum_rate();
    return *dz2_;
  }

  // Angular momentum per dz1: J s, negative in forward walking.
  const S& transversal() {
    if (!transversal_) transversal_ = pose().momentum(per_dz1());
    return *transversal_;
  }

  // dz1: with z2 = -(momentum per dz1) dz1 - (momentum of all else), but for the residual.
  const S& dz1() {
    if (dz1_) return *dz1_;
    S momentum = z2 + pose().momentum(per_dz2()) * momentum_rate();
    if (off) momentum = momentum + pose().momentum(w_off());
    const S rate = -momentum / transversal();
    dz1_ = model.flow ? rate + flow_correction()[0] : rate;
    return *dz1_;
  }
  // Rates of the links due to outputs that are off zero.
  vector<S> w_off() const { return link_angles(robot, lifted(S(I(0.0)), off->dy)); }

  // Rates of the coordinates, and of the links.
  const vector<S>& dq() {
    if (!dq_) {
      vector<S> joints;
      const Outputs<S>& desired = outputs();
      for (size_t j = 0; j < desired.y.size(); ++j) {
        const S rate = desired.d1[j] * dz1() + desired.d2[j] * dz2();
        joints.push_back(off ? rate + off->dy[j] : rate);
      }
      dq_ = lifted(dz1(), joints);
    }
    return *dq_;
  }
  const vector<S>& w() {
    if (!w_) w_ = link_angles(robot, dq());
    return *w_;
  }

  const vector<Vec<S>>& spin() {
    if (!spin_) spin_ = pose().spin(w());
    return *spin_;
  }
  Vec<S> foot() { return point(robot.foot, pose().e); }
  Vec<S> foot_velocity() { return point(robot.foot, spin()); }
  // Velocity of the swing foot per unit of dz1 and of dz2.
  Vec<S> foot_per_dz1() { return point(robot.foot, pose().spin(per_dz1())); }
  Vec<S> foot_per_dz2() { return point(robot.foot, pose().spin(per_dz2())); }
  // A vector's part across the line between the footholds of this step, upwards: level, its height.
  S across_ground(const Vec<S>& v) const {
    return step.ground ? v.z - step.ground->rise * v.x : v.z;
  }
  // Of the swing foot above that line, and its rate.
  S foot_height() {
    const S found = across_ground(foot());
    return step.ground ? found - S(step.ground->level) : found;
  }
  S foot_lift() { return across_ground(foot_velocity()); }
  // A vector along and across the ground under the stance foot, or under the next foothold.
  Vec<S> at_stance(const Vec<S>& v) const {
    if (!step.ground) return v;
    return against(step.ground->stance_sine, step.ground->stance_cosine, v);
  }
  Vec<S> at_landing(const Vec<S>& v) const {
    if (!step.ground) return v;
    return against(step.ground->landing_sine, step.ground->landing_cosine, v);
  }
  static Vec<S> against(const K& sine, const K& cosine, const Vec<S>& v) {
    return {cosine * v.x + sine * v.z, cosine * v.z - sine * v.x};
  }
  // Heel and toe of a flat foot from its ankle, in a pose; and of the swing foot, from the ground.
  vector<Vec<S>> sole(const Pose<S>& at) const {
    if (!robot.feet) refuse("a sole of a robot on point feet");
    const Feet& f = *robot.feet;
    const Vec<S> up = at.e.back(), ahead = scaled(S(I(-1.0)), quarter_turned(up));
    const Vec<S> down = scaled(S(-f.height), up);
    return {down + scaled(S(-f.heel), ahead), down + scaled(S(f.toe), ahead)};
  }
  vector<S> sole_heights() {
    vector<S> out;
    for (const Vec<S>& end : sole(pose())) out.push_back(foot().z + end.z + S(robot.feet->height));
    return out;
  }
  // Vertical velocities of heel and toe of the last link, links turning at w.
  vector<S> sole_lifts(const Pose<S>& at, const vector<S>& turning) const {
    const S ankle = point(robot.foot, at.spin(turning)).z;
    vector<S> out;
    for (const Vec<S>& end : sole(at)) out.push_back(ankle + turning.back() * end.x);
    return out;
  }
  Vec<S> hip() { return point(robot.hip, pose().e); }
  Vec<S> hip_velocity() { return point(robot.hip, spin()); }

  // ---- after an impact in this state: the legs have swapped roles.
  const vector<S>& theta_after() {
    if (theta_after_) return *theta_after_;
    if (robot.feet) {
      theta_after_ = link_angles(robot, swapped(robot, pose().q, pose().theta));
    } else {
      theta_after_ = pose().theta;
      std::reverse(theta_after_->begin(), theta_after_->end());
    }
    return *theta_after_;
  }

  S hip_after() {
    const vector<S> q = coordinates_of(robot, theta_after());
    S sum(0.0);
    for (size_t j = 0; j < q.size(); ++j)
      if (magnitude(robot.hip_gradient[j]) != 0.0) sum = sum + robot.hip_gradient[j] * q[j];
    return sum;
  }

  // Angular momentum about the new stance foot is kept, but for the residual.
  S z2_after() {
    const Vec<S> pivot = foot();
    const S kept = robot.feet ? -kept_on_flat_foot() : -pose().momentum(w(), &pivot);
    return model.reset ? kept + reset_correction()[0] * z2 : kept;
  }

  // Counter-clockwise, in the coordinates of the foot that has landed level, its ankle's rotor included;
  // links turn with that foot besides, and move with its ankle.
  S kept_on_flat_foot() {
    const Pose<S> landed(robot, swapped(robot, pose().q, pose().theta));
    const vector<S> rates = swapped(robot, dq(), w());
    vector<S> turning = link_angles(robot, rates);
    for (S& one : turning) one = one + w().back();
    const vector<Vec<S>> velocity = landed.velocities(turning);
    const Vec<S> carried = foot_velocity();
    S sum = robot.armature[0] * rates[0];
    for (size_t i = 0; i < turning.size(); ++i)
      sum = sum + robot.mass[i] * cross(landed.centre[i], velocity[i] + carried) +
            robot.inertia[i] * turning[i];
    return sum;
  }

  Motion& after() {
    if (!after_) after_ = std::make_unique<Motion>(model, step.next(), hip_after(), z2_after());
    return *after_;
  }

  struct Impact {
    Pose<S> pose;
    vector<S> w, dq;  // Rates of links and coordinates after it.
    Vec<S> impulse;   // Of the ground on the new stance foot; the links' own.
    S first;          // Rate of the first coordinate; the links' own.
  };
  const Impact& impact() {
    if (impact_) return *impact_;
    const ImpactResult<S> found = plastic_impact(robot, pose(), w());
    const vector<S> dq =
        model.reset ? corrected(found.pose, link_angles(robot, found.dq), found.dq) : found.dq;
    impact_ = std::make_unique<Impact>(Impact{found.pose, link_angles(robot, dq), dq, found.impulse,
                                              found.dq[0]});
    return *impact_;
  }

  // Rates after the impact with what the residual adds to the joints' and to z2; the first, which
  // has no motor, follows from both.
  vector<S> corrected(const Pose<S>& after, const vector<S>& w_after, vector<S> rates) {
    const S momentum = after.momentum(w_after) - reset_correction()[0] * z2;  // Minus z2.
    vector<S> alone(rates.size(), S(0.0));
    alone[0] = S(I(1.0));
    rates[0] = S(0.0);
    for (size_t j = 1; j < rates.size(); ++j) rates[j] = rates[j] + reset_correction()[j] * z2;
    rates[0] = (momentum - after.momentum(link_angles(robot, rates))) /
               after.momentum(link_angles(robot, alone));
    return rates;
  }

  // Normal impulse on a flat foot that lands, times its place ahead of the ankle: the foot comes to rest
  // under it, and under what turns its rotor.
  S impulse_moment() {
    if (!robot.feet) refuse("a landing of a robot on point feet");
    const Feet& f = *robot.feet;
    const Vec<S> velocity = foot_velocity();
    const S own = f.mass * (f.x * velocity.z - f.z * velocity.x) +
                  (robot.inertia.back() + f.mass * (f.x * f.x + f.z * f.z)) * w().back();
    const S rotor = robot.armature[0] * (impact().first - dq().back());
    return -own - rotor - f.height * impact().impulse.x;
  }

  // ---- what needs derivatives: not for duals.
  struct Forces {
    vector<S> torque;  // Of the joints.
    Vec<S> ground;     // On the stance foot.
    S first;           // Acceleration of the first coordinate.
  };
  // Normal force on a flat foot times the place of its centre of pressure ahead of the ankle.
  S pressure_moment() {
    if (!robot.feet) refuse("a pressure under a point foot");
    const Feet& f = *robot.feet;
    S sum = S(f.mass * robot.gravity * f.x) - f.height * forces().ground.x -
            robot.armature[0] * forces().first;
    return model.policy.ankle ? sum - ankle() : sum;
  }
  const Forces& forces();

  // Desired outputs with their second derivatives.
  const vector<Jet<T>>& jets() {
    if (!jets_) {
      jets_ = desired_outputs(model.policy, step, phase(), z1, z2, 2);
      outputs_ = first_order(*jets_);
    }
    return *jets_;
  }

  // The same state, with derivatives along a direction in z, and in y and dy.
  Motion<DualOf<T>> moving(const T& first, const T& second, const vector<T>& y = {},
                           const vector<T>& dy = {}) {
    std::optional<Off<DualOf<T>>> moved;
    if (off) {
      moved = Off<DualOf<T>>{{}, {}, off->bandwidth};
      for (size_t j = 0; j < off->y.size(); ++j) {
        moved->y.push_back({off->y[j], y.empty() ? T(0.0) : y[j]});
        moved->dy.push_back({off->dy[j], dy.empty() ? T(0.0) : dy[j]});
      }
    }
    return {model, step, DualOf<T>(z1, first), DualOf<T>(z2, second), moved, known_phase,
            along(jets(), first, second)};
  }

  // Along the flow.
  Motion<DualOf<T>>& flow() {
    if (flow_) return *flow_;
    jets();  // Before the rates ask for the outputs' first derivatives alone.
    const vector<T> none;
    flow_ = std::make_unique<Motion<DualOf<T>>>(
        moving(dz1(), dz2(), off ? off->dy : none, off ? off->ddy() : none));
    return *flow_;
  }

 private:
  std::optional<Outputs<S>> outputs_;
  std::optional<Pose<S>> pose_;
  std::optional<vector<S>> along1_, along2_, w_, dq_, theta_after_;
  std::optional<vector<S>> flow_correction_, reset_correction_, ankle_;
  std::optional<S> dz1_, dz2_, weight_moment_, transversal_;
  std::optional<vector<Vec<S>>> spin_;
  std::unique_ptr<Motion> after_;
  std::unique_ptr<Impact> impact_;
  std::unique_ptr<Motion<DualOf<T>>> flow_;
  std::optional<Forces> forces_;
  std::optional<vector<Jet<T>>> jets_;
};

template <class S>
const typename Motion<S>::Forces& Motion<S>::forces() {
  if constexpr (Under<S>::has_rate) throw Unknown{"a rate of forces"};
  else {
    if (forces_) return *forces_;
    const vector<DualOf<S>>& rates = flow().w();
    // Accelerations of the directions: quarter_turned(e) dw - e w^2.
    const Pose<S>& p = pose();
    vector<Vec<S>> turning, push;
    vector<S> couples;
    for (size_t k = 0; k < rates.size(); ++k) {
      const S fast = rates[k].v * rates[k].v;
      turning.push_back(scaled(rates[k].d, quarter_turned(p.e[k])) - scaled(fast, p.e[k]));
      couples.push_back(robot.inertia[k] * rates[k].d);
    }
    // Mass times (acceleration plus gravity) of each link: what ground and joints must bring up.
    Vec<S> ground{S(0.0), S(0.0)};
    for (size_t i = 0; i < rates.size(); ++i) {
      Vec<S> a = point(robot.centre[i], turning);
      a.z = a.z + S(robot.gravity);
      push.push_back({robot.mass[i] * a.x, robot.mass[i] * a.z});
      ground = ground + push.back();
    }
    const vector<S> needed = generalised_forces(robot, p.moments(push, couples));
    const vector<DualOf<S>>& joint_rates = flow().dq();
    vector<S> torque;
    for (size_t j = 1; j < needed.size(); ++j)
      torque.push_back(needed[j] + robot.armature[j] * joint_rates[j].d +
                       robot.damping[j] * joint_rates[j].v);
    if (robot.feet) ground.z = ground.z + S(robot.feet->mass * robot.gravity);
    forces_ = Forces{torque, ground, joint_rates[0].d};
    return *forces_;
  }
}

// A state at a phase of the step, zeta given.
Motion<TM> state_of(const Model& model, const TM& phase, const TM& zeta) {
  const auto [z1, z2] = z_of(model.step, phase, zeta);
  return {model, model.step, z1, z2};
}

// The thin tube's chart has the same z1 at a phase.
Motion<TM> state_at(const Model& model, const Tube& tube, const TM& phase, const TM& level) {
  const Fences<TM> f = fences(tube, phase);
  return state_of(model, phase, f.lower + level * (f.upper - f.lower));
}

}  // namespace
