#pragma once

#include "steps.hpp"

namespace {

// ----------------------------------------------------------------------------- 9 the policy
//
// Desired outputs as a jet in z: value, d/dz1, d/dz2, the three second derivatives and the four third
// ones, each a Taylor model on the box. `order` says how many of them are wanted.

template <class T>
struct Jet {
  std::array<T, 6> c;  // f, f_1, f_2, f_11, f_12, f_22
  vector<T> third;     // f_111, f_112, f_122, f_222; all 0 if empty.
};

constexpr size_t kThird = 4;

int parts(int order) { return order == 0 ? 1 : order == 1 ? 3 : 6; }

template <class T>
Jet<T> operator+(const Jet<T>& a, const Jet<T>& b) {
  Jet<T> r;
  for (size_t i = 0; i < 6; ++i) r.c[i] = a.c[i] + b.c[i];
  r.third = a.third.empty() ? b.third : a.third;
  if (!a.third.empty() && !b.third.empty())
    for (size_t i = 0; i < kThird; ++i) r.third[i] = a.third[i] + b.third[i];
  return r;
}

template <class K, class T>
Jet<T> operator*(const K& k, const Jet<T>& a) {
  Jet<T> r;
  for (size_t i = 0; i < 6; ++i) r.c[i] = k * a.c[i];
  for (const T& part : a.third) r.third.push_back(k * part);
  return r;
}

template <class T>
Jet<T> product(const Jet<T>& a, const Jet<T>& b, int order) {
  Jet<T> r;
  r.c[0] = a.c[0] * b.c[0];
  if (order < 1) return r;
  r.c[1] = a.c[1] * b.c[0] + a.c[0] * b.c[1];
  r.c[2] = a.c[2] * b.c[0] + a.c[0] * b.c[2];
  if (order < 2) return r;
  const T cross = a.c[1] * b.c[1], other = a.c[2] * b.c[2];
  r.c[3] = a.c[3] * b.c[0] + (cross + cross) + a.c[0] * b.c[3];
  r.c[4] = a.c[4] * b.c[0] + a.c[1] * b.c[2] + a.c[2] * b.c[1] + a.c[0] * b.c[4];
  r.c[5] = a.c[5] * b.c[0] + (other + other) + a.c[0] * b.c[5];
  if (order < 3) return r;
  const I two(2.0), three(3.0);
  r.third = {three * (a.c[3] * b.c[1] + a.c[1] * b.c[3]),
             a.c[3] * b.c[2] + a.c[2] * b.c[3] + two * (a.c[4] * b.c[1] + a.c[1] * b.c[4]),
             a.c[5] * b.c[1] + a.c[1] * b.c[5] + two * (a.c[4] * b.c[2] + a.c[2] * b.c[4]),
             three * (a.c[5] * b.c[2] + a.c[2] * b.c[5])};
  for (size_t i = 0; i < kThird; ++i) {
    if (!a.third.empty()) r.third[i] = r.third[i] + a.third[i] * b.c[0];
    if (!b.third.empty()) r.third[i] = r.third[i] + a.c[0] * b.third[i];
  }
  return r;
}

// f(a) from f, f', f'' and, for a third order, f''' at a's value.
template <class T>
Jet<T> composed(const Jet<T>& a, const T& f, const T& slope, const T& curve, int order,
                const T& twist) {
  Jet<T> r;
  r.c[0] = f;
  if (order < 1) return r;
  r.c[1] = slope * a.c[1];
  r.c[2] = slope * a.c[2];
  if (order < 2) return r;
  const T along = curve * a.c[1];
  r.c[3] = slope * a.c[3] + along * a.c[1];
  r.c[4] = slope * a.c[4] + along * a.c[2];
  r.c[5] = slope * a.c[5] + curve * (a.c[2] * a.c[2]);
  if (order < 3) return r;
  const T &f1 = a.c[1], &f2 = a.c[2];
  const T once = twist * (f1 * f1), twice = twist * (f2 * f2), both = I(2.0) * a.c[4];
  r.third = {once * f1 + I(3.0) * (curve * (f1 * a.c[3])),
             once * f2 + curve * (a.c[3] * f2 + both * f1),
             twice * f1 + curve * (a.c[5] * f1 + both * f2),
             twice * f2 + I(3.0) * (curve * (f2 * a.c[5]))};
  if (!a.third.empty())
    for (size_t i = 0; i < kThird; ++i) r.third[i] = r.third[i] + slope * a.third[i];
  return r;
}

template <class T>
Jet<T> tanh(const Jet<T>& a, int order) {
  const T t = tanh(a.c[0]), g = T(1.0) - t * t;  // tanh' = 1 - t^2, tanh'' = -2 t tanh'
  // tanh''' = -2 tanh' (1 - 3 t^2)
  const T twist = order < 3 ? T(0.0) : I(-2.0) * (g * (T(1.0) - I(3.0) * (t * t)));
  return composed(a, t, g, I(-2.0) * (t * g), order, twist);
}

template <class T>
Jet<T> logistic(const Jet<T>& a, int order) {
  const T s = logistic(a.c[0]), g = s * (T(1.0) - s);  // s' = s (1 - s), s'' = s' (1 - 2 s)
  const T twist = order < 3 ? T(0.0) : g * (T(1.0) - I(6.0) * g);  // s''' = s' (1 - 6 s')
  return composed(a, s, g, g * (T(1.0) - I(2.0) * s), order, twist);
}

template <class T>
Jet<T> softplus(const Jet<T>& a, int order) {
  const T s = logistic(a.c[0]);  // softplus' = s, softplus'' = s (1 - s)
  const T curve = s * (T(1.0) - s);
  const T twist = order < 3 ? T(0.0) : curve * (T(1.0) - I(2.0) * s);
  return composed(a, softplus(a.c[0]), s, curve, order, twist);
}

// sum += w x for one double w.
inline void add_scaled(I* __restrict sum, double w, const I* __restrict x, size_t count) {
  const double size = w < 0.0 ? -w : w;
  if (w < 0.0) {
    for (size_t i = 0; i < count; ++i) {
      sum[i].n += size * x[i].h;
      sum[i].h += size * x[i].n;
    }
  } else {
    for (size_t i = 0; i < count; ++i) {
      sum[i].n += size * x[i].n;
      sum[i].h += size * x[i].h;
    }
  }
}

// The same of Taylor models, the inner loop of every network.
template <class T>
inline void add_scaled(T& sum, double w, const T& x) {
  add_scaled(sum.c.data(), w, x.c.data(), x.c.size());
}

template <class T>
void refuse_infinite(const T& model) {
  for (const I& coefficient : model.c) finite(coefficient.n, coefficient.h);
}

// A layer with its own biases, or those given.
template <class T>
vector<Jet<T>> applied(const Layer& layer, const vector<Jet<T>>& inputs, int order,
                       const vector<Scalar<T>>& biases = {}) {
  vector<Jet<T>> out(static_cast<size_t>(layer.rows));
  const double* weight = layer.weights.data();
  const auto count = static_cast<size_t>(parts(order));
  for (size_t row = 0; row < out.size(); ++row) {
    out[row].c[0] = biases.empty() ? T(layer.biases[row]) : T(biases[row]);
    for (const Jet<T>& input : inputs) {
      for (size_t part = 0; part < count; ++part)
        add_scaled(out[row].c[part], *weight, input.c[part]);
      if (!input.third.empty()) {
        out[row].third.resize(kThird);
        for (size_t part = 0; part < kThird; ++part)
          add_scaled(out[row].third[part], *weight, input.third[part]);
      }
      ++weight;
    }
    for (const T& part : out[row].c) refuse_infinite(part);
    for (const T& part : out[row].third) refuse_infinite(part);
  }
  return out;
}

// The same of formulas: a row of each part.
template <>
vector<Jet<Formula>> applied(const Layer& layer, const vector<Jet<Formula>>& inputs, int order,
                             const vector<Formula>& biases) {
  vector<Jet<Formula>> out(static_cast<size_t>(layer.rows));
  for (size_t row = 0; row < out.size(); ++row) {
    const double* weights = layer.weights.data() + row * inputs.size();
    for (size_t part = 0; part < static_cast<size_t>(parts(order)); ++part) {
      vector<Formula> terms;
      for (const Jet<Formula>& input : inputs) terms.push_back(input.c[part]);
      const Formula bias = biases.empty() ? Formula(layer.biases[row]) : biases[row];
      out[row].c[part] = weighted(weights, terms, part ? Formula(0.0) : bias);
    }
    // All inputs have third derivatives, or none has: those of the first layer are linear.
    for (size_t part = 0; part < kThird && !inputs[0].third.empty(); ++part) {
      vector<Formula> terms;
      for (const Jet<Formula>& input : inputs) terms.push_back(input.third[part]);
      out[row].third.push_back(weighted(weights, terms, Formula(0.0)));
    }
  }
  return out;
}

// z / scale - shift, what networks are given.
template <class T>
vector<Jet<T>> scaled_state(const vector<double>& scale, const vector<double>& shift, const T& z1,
                            const T& z2) {
  Jet<T> first, second;
  first.c[0] = z1;
  first.c[1] = T(1.0);
  second.c[0] = z2;
  second.c[2] = T(1.0);
  vector<Jet<T>> values = {inverse(I(scale[0])) * first, inverse(I(scale[1])) * second};
  for (size_t i = 0; i < 2; ++i) values[i].c[0] = values[i].c[0] - T(shift[i]);
  return values;
}

template <class T>
vector<Jet<T>> network(const vector<Layer>& layers, bool with_softplus, vector<Jet<T>> values,
                       int order, const vector<Scalar<T>>& first = {}) {
  for (size_t i = 0; i < layers.size(); ++i) {
    values = applied(layers[i], values, order, i ? vector<Scalar<T>>() : first);
    if (i + 1 == layers.size()) break;
    for (Jet<T>& value : values)
      value = with_softplus ? softplus(value, order) : tanh(value, order);
  }
  return values;
}

// H of an output, by the powers of its phase t.
template <class K, class T>
Jet<T> by_powers(const Step<K>& step, size_t output, const Jet<T>& t, int order) {
  const size_t m = step.cubic.size() / 4;
  Jet<T> path;
  path.c[0] = T(step.cubic[3 * m + output]);
  for (size_t power = 3; power-- > 0;) {
    path = product(path, t, order);
    path.c[0] = path.c[0] + T(step.cubic[power * m + output]);
  }
  return path;
}

// The same by its ends: near one of them, what is uncertain of the other counts for nothing. With
// s = 1 - t: s^2 (p + t (p' + 2 p)) + t^2 (q - s (q' - 2 q)).
template <class K, class T>
Jet<T> by_ends(const Step<K>& step, size_t output, const Jet<T>& t, const Jet<T>& rest, int order) {
  const size_t m = step.ends.size() / 4;
  const auto end = [&](size_t k) { return step.ends[k * m + output]; };
  Jet<T> near = (end(1) + I(2.0) * end(0)) * t, far = (I(2.0) * end(2) - end(3)) * rest;
  near.c[0] = near.c[0] + T(end(0));
  far.c[0] = far.c[0] + T(end(2));
  return product(product(rest, rest, order), near, order) +
         product(product(t, t, order), far, order);
}

// y_d = lower + (upper - lower) logistic(logit), the logit being the network's output, or
// H(t) + 4 (4 t (1 - t))^2 network with t the phase of the step and H a cubic. The phase is that of
// z1; given apart, bounds of both need not know that it is.
template <class T>
vector<Jet<T>> desired_outputs(const Policy& p, const Step<Scalar<T>>& step, const T& phase,
                               const T& z1, const T& z2, int order) {
  vector<Jet<T>> values = scaled_state(p.scale, p.shift, z1, z2);
  if (!p.z2_dependence) values[1] = Jet<T>();
  values = network(p.layers, p.softplus, values, order, step.first);
  const size_t m = p.lower.size();
  if (p.hybrid_invariant) {
    Jet<T> t, rest;
    t.c[0] = phase;
    t.c[1] = T(inverse(step.span()));
    rest = I(-1.0) * t;
    rest.c[0] = rest.c[0] + T(1.0);
    const Jet<T> bump = I(4.0) * product(t, rest, order);
    const Jet<T> window = I(4.0) * product(bump, bump, order);
    for (size_t i = 0; i < m; ++i) {
      const Jet<T> path = step.ends.empty() ? by_powers(step, i, t, order)
                                            : by_ends(step, i, t, rest, order);
      values[i] = path + product(window, values[i], order);
    }
  }
  for (size_t i = 0; i < m; ++i) {
    values[i] = (I(p.upper[i]) - I(p.lower[i])) * logistic(values[i], order);
    values[i].c[0] = values[i].c[0] + T(p.lower[i]);
  }
  return values;
}

// The torque of a stance ankle.
template <class T>
vector<Jet<T>> ankle_torque(const Ankle& a, const T& z1, const T& z2, int order) {
  vector<Jet<T>> values =
      network(a.layers, false, scaled_state(a.scale, a.shift, z1, z2), order);
  Jet<T> torque = I(2.0) * logistic(values[0], order);
  torque.c[0] = torque.c[0] - T(1.0);
  return {I(a.most) * torque};
}

// ---- what was learned of the robot: residuals of the flow and of the reset.

// What is added to dz: bound tanh(network).
template <class T>
vector<Jet<T>> flow_residual(const FlowResidual& r, const T& z1, const T& z2, int order) {
  vector<Jet<T>> values =
      network(r.layers, false, scaled_state(r.scale, r.shift, z1, z2), order);
  for (size_t i = 0; i < values.size(); ++i) values[i] = I(r.bound[i]) * tanh(values[i], order);
  return values;
}

// What is added to z2 and to the joint rates after an impact, per z2 before it: bound tanh(W z + b).
template <class T>
vector<Jet<T>> reset_residual(const ResetResidual& r, const T& z1, const T& z2, int order) {
  vector<Jet<T>> values = applied(r.layer, scaled_state(r.scale, r.shift, z1, z2), order);
  for (size_t i = 0; i < values.size(); ++i) values[i] = I(r.bound[i]) * tanh(values[i], order);
  return values;
}

}  // namespace
