#pragma once

#include "robot.hpp"

namespace {

// ----------------------------------------------------------------------------- 7 the policy
//
// Desired outputs as a jet in z: value, d/dz1, d/dz2, and the three second derivatives, each a
// Taylor model on the box. `order` says how many of them are wanted.

struct Jet {
  std::array<TM, 6> c;  // f, f_1, f_2, f_11, f_12, f_22
};

int parts(int order) { return order == 0 ? 1 : order == 1 ? 3 : 6; }

Jet operator+(const Jet& a, const Jet& b) {
  Jet r;
  for (size_t i = 0; i < 6; ++i) r.c[i] = a.c[i] + b.c[i];
  return r;
}

Jet operator*(I k, const Jet& a) {
  Jet r;
  for (size_t i = 0; i < 6; ++i) r.c[i] = k * a.c[i];
  return r;
}

Jet product(const Jet& a, const Jet& b, int order) {
  Jet r;
  r.c[0] = a.c[0] * b.c[0];
  if (order < 1) return r;
  r.c[1] = a.c[1] * b.c[0] + a.c[0] * b.c[1];
  r.c[2] = a.c[2] * b.c[0] + a.c[0] * b.c[2];
  if (order < 2) return r;
  const TM cross = a.c[1] * b.c[1], other = a.c[2] * b.c[2];
  r.c[3] = a.c[3] * b.c[0] + (cross + cross) + a.c[0] * b.c[3];
  r.c[4] = a.c[4] * b.c[0] + a.c[1] * b.c[2] + a.c[2] * b.c[1] + a.c[0] * b.c[4];
  r.c[5] = a.c[5] * b.c[0] + (other + other) + a.c[0] * b.c[5];
  return r;
}

// f(a) from f, f' and f'' at a's value.
Jet composed(const Jet& a, const TM& f, const TM& slope, const TM& curve, int order) {
  Jet r;
  r.c[0] = f;
  if (order < 1) return r;
  r.c[1] = slope * a.c[1];
  r.c[2] = slope * a.c[2];
  if (order < 2) return r;
  const TM along = curve * a.c[1];
  r.c[3] = slope * a.c[3] + along * a.c[1];
  r.c[4] = slope * a.c[4] + along * a.c[2];
  r.c[5] = slope * a.c[5] + curve * (a.c[2] * a.c[2]);
  return r;
}

const TM ONE(1.0);

Jet tanh(const Jet& a, int order) {
  const TM t = tanh(a.c[0]), g = ONE - t * t;  // tanh' = 1 - t^2, tanh'' = -2 t tanh'
  return composed(a, t, g, I(-2.0) * (t * g), order);
}

Jet logistic(const Jet& a, int order) {
  const TM s = logistic(a.c[0]), g = s * (ONE - s);  // s' = s (1 - s), s'' = s' (1 - 2 s)
  return composed(a, s, g, g * (ONE - I(2.0) * s), order);
}

Jet softplus(const Jet& a, int order) {
  const TM s = logistic(a.c[0]);  // softplus' = s, softplus'' = s (1 - s)
  return composed(a, softplus(a.c[0]), s, s * (ONE - s), order);
}

// sum += w x for one double w, the inner loop of every network.
inline void add_scaled(Jet& __restrict sum, double w, const Jet& __restrict x, int count) {
  const double size = w < 0.0 ? -w : w;
  for (int part = 0; part < count; ++part) {
    I* __restrict s = sum.c[static_cast<size_t>(part)].c.data();
    const I* __restrict v = x.c[static_cast<size_t>(part)].c.data();
    if (w < 0.0) {
      for (int i = 0; i < 6; ++i) {
        s[i].n += size * v[i].h;
        s[i].h += size * v[i].n;
      }
    } else {
      for (int i = 0; i < 6; ++i) {
        s[i].n += size * v[i].n;
        s[i].h += size * v[i].h;
      }
    }
  }
}

vector<Jet> applied(const Layer& layer, const vector<Jet>& inputs, int order) {
  vector<Jet> out(static_cast<size_t>(layer.rows));
  const double* weight = layer.weights.data();
  for (size_t row = 0; row < out.size(); ++row) {
    out[row].c[0] = TM(layer.biases[row]);
    for (const Jet& input : inputs) add_scaled(out[row], *weight++, input, parts(order));
    for (const TM& part : out[row].c)
      for (const I& coefficient : part.c) finite(coefficient.n, coefficient.h);
  }
  return out;
}

// y_d = lower + (upper - lower) logistic(logit), the logit being the network's output, or
// H(t) + 4 (4 t (1 - t))^2 network with t the phase of the step and H a cubic.
vector<Jet> desired_outputs(const Policy& p, const TM& z1, const TM& z2, int order) {
  Jet first, second;
  first.c[0] = z1;
  first.c[1] = ONE;
  second.c[0] = z2;
  second.c[2] = ONE;
  vector<Jet> values = {inverse(I(p.scale[0])) * first, inverse(I(p.scale[1])) * second};
  values[0].c[0] = values[0].c[0] - TM(p.shift[0]);
  values[1].c[0] = values[1].c[0] - TM(p.shift[1]);
  if (!p.z2_dependence) values[1] = Jet();
  for (size_t i = 0; i < p.layers.size(); ++i) {
    values = applied(p.layers[i], values, order);
    if (i + 1 < p.layers.size())
      for (Jet& value : values) value = p.softplus ? softplus(value, order) : tanh(value, order);
  }
  const size_t m = p.lower.size();
  if (p.hybrid_invariant) {
    Jet t = first, rest;
    t.c[0] = t.c[0] - TM(p.start);
    t = inverse(I(p.guard) - I(p.start)) * t;
    rest = I(-1.0) * t;
    rest.c[0] = rest.c[0] + ONE;
    const Jet bump = I(4.0) * product(t, rest, order);
    const Jet window = I(4.0) * product(bump, bump, order);
    for (size_t i = 0; i < m; ++i) {
      Jet path;
      path.c[0] = TM(p.cubic[3 * m + i]);
      for (size_t power = 3; power-- > 0;) {
        path = product(path, t, order);
        path.c[0] = path.c[0] + TM(p.cubic[power * m + i]);
      }
      values[i] = path + product(window, values[i], order);
    }
  }
  for (size_t i = 0; i < m; ++i) {
    values[i] = (I(p.upper[i]) - I(p.lower[i])) * logistic(values[i], order);
    values[i].c[0] = values[i].c[0] + TM(p.lower[i]);
  }
  return values;
}

}  // namespace
