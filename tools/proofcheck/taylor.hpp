#pragma once

#include "numbers.hpp"

namespace {

// -------------------------------------------------------------------------- 3 Taylor models
//
// A function of a box is enclosed by a polynomial of second degree in e_1 to e_N, each in [-1, 1],
// the box's own coordinates: 1, then the e_i, then e_i e_j for i <= j, row by row. Coefficients are
// intervals: for every point of the box some real choice of them gives the function's value. All
// that has a higher degree is enclosed by an interval and added to the constant, which is therefore
// also the remainder.

template <int N>
struct Taylor {
  static constexpr int kTerms = 1 + N + N * (N + 1) / 2;
  // The place of e_i e_j, i <= j.
  static constexpr size_t pair(int i, int j) {
    return static_cast<size_t>(1 + N + i * N - i * (i - 1) / 2 + j - i);
  }
  std::array<I, kTerms> c;

  Taylor(I constant = I(0.0)) { c[0] = constant; }
  Taylor(double constant) { c[0] = I(constant); }
  double linear() const {
    double sum = 0.0;
    for (size_t i = 1; i <= N; ++i) sum += magnitude(c[i]);
    return sum;
  }
  double quadratic() const {
    double sum = 0.0;
    for (size_t i = N + 1; i < kTerms; ++i) sum += magnitude(c[i]);
    return sum;
  }
};

using TM = Taylor<2>;  // Functions of (phase, level).

// [low, high] as middle + radius * coordinate `axis`.
template <class T>
T coordinate(double low, double high, int axis) {
  const double centre = low + (high - low) * 0.5;
  T a(centre);
  a.c[static_cast<size_t>(1 + axis)] = I(larger((high - centre), (centre - low)));
  return a;
}

template <int N>
inline Taylor<N> operator-(const Taylor<N>& a) {
  Taylor<N> r;
  for (size_t i = 0; i < r.c.size(); ++i) r.c[i] = -a.c[i];
  return r;
}
template <int N>
inline Taylor<N> operator+(const Taylor<N>& a, const Taylor<N>& b) {
  Taylor<N> r;
  for (size_t i = 0; i < r.c.size(); ++i) r.c[i] = a.c[i] + b.c[i];
  return r;
}
template <int N>
inline Taylor<N> operator-(const Taylor<N>& a, const Taylor<N>& b) {
  Taylor<N> r;
  for (size_t i = 0; i < r.c.size(); ++i) r.c[i] = a.c[i] - b.c[i];
  return r;
}
template <int N>
inline Taylor<N> operator*(I k, const Taylor<N>& a) {
  Taylor<N> r;
  for (size_t i = 0; i < r.c.size(); ++i) r.c[i] = k * a.c[i];
  return r;
}
template <int N>
inline Taylor<N> operator*(const Taylor<N>& a, const Taylor<N>& b) {
  using T = Taylor<N>;
  T r;
  r.c[0] = a.c[0] * b.c[0];
  for (size_t i = 1; i < r.c.size(); ++i) r.c[i] = a.c[0] * b.c[i] + a.c[i] * b.c[0];
  for (int i = 0; i < N; ++i) {
    const size_t x = static_cast<size_t>(1 + i);
    I& own = r.c[T::pair(i, i)];
    own = own + a.c[x] * b.c[x];
    for (int j = i + 1; j < N; ++j) {
      const size_t y = static_cast<size_t>(1 + j);
      I& mixed = r.c[T::pair(i, j)];
      mixed = mixed + a.c[x] * b.c[y] + a.c[y] * b.c[x];
    }
  }
  // Degree three and four.
  const double a1 = a.linear(), a2 = a.quadratic(), b1 = b.linear(), b2 = b.quadratic();
  r.c[0] = r.c[0] + symmetric(a1 * b2 + a2 * b1 + a2 * b2);
  return r;
}

double distance_from_zero(I a) { return a.n < 0.0 ? -a.n : a.h < 0.0 ? -a.h : 0.0; }

// Lower end of b x + a x^2 over x in [-1, 1], over all a and b of the intervals, as minus it.
double minus_parabola(I b, I a) {
  const double steep = magnitude(b);
  double found = steep + larger(a.n, 0.0);  // >= -|b| - max(0, -a)
  if (a.n < 0.0) {                          // Convex: also >= -b^2/(4a), its least value anywhere.
    // Four times is exact, or more than there is: then nothing is divided by it.
    const double four = 4.0 * a.low();
    const double vertex = four < HUGE_VAL ? steep * steep / four : HUGE_VAL;
    if (vertex < found) found = vertex;
    // The vertex lies outside [-1, 1]: the least value is at an end.
    if (distance_from_zero(b) >= 2.0 * a.h && steep + a.n < found) found = steep + a.n;
  }
  return found;
}

// Minus the least value over the box. A polynomial that is monotone in a coordinate
// is least on an edge: there it is one of the others alone.
template <int N>
double minus_least(const Taylor<N>& a) {
  using T = Taylor<N>;
  auto c = a.c;
  const auto mixed = [&c](int i, int j) -> I& { return c[i < j ? T::pair(i, j) : T::pair(j, i)]; };
  bool gone[N] = {};
  for (bool again = true; again;) {
    again = false;
    for (int i = 0; i < N; ++i) {
      if (gone[i]) continue;
      const I along = c[static_cast<size_t>(1 + i)], own = mixed(i, i);
      double bend = 2.0 * magnitude(own);
      for (int j = 0; j < N; ++j)
        if (j != i && !gone[j]) bend += magnitude(mixed(i, j));
      if (!(distance_from_zero(along) >= bend)) continue;
      const I end = along.n < 0.0 ? I(-1.0) : I(1.0);
      c[0] = c[0] + end * along + own;
      for (int j = 0; j < N; ++j)
        if (j != i && !gone[j])
          c[static_cast<size_t>(1 + j)] = c[static_cast<size_t>(1 + j)] + end * mixed(i, j);
      gone[i] = again = true;
    }
  }
  double found = c[0].n;
  for (int i = 0; i < N; ++i) {
    if (gone[i]) continue;
    found += minus_parabola(c[static_cast<size_t>(1 + i)], mixed(i, i));
    for (int j = i + 1; j < N; ++j)
      if (!gone[j]) found += magnitude(mixed(i, j));
  }
  return found;
}

template <int N>
I range(const Taylor<N>& a) {
  return finite(minus_least(a), minus_least(-a));
}

// What a search wants to know of a margin: its range, how much of it is due to each coordinate of
// the box, and where in [-1, 1] of each it seems to be least.
constexpr int kMostAxes = 16;
struct Estimate {
  I range;
  std::array<double, kMostAxes> influence{};
  std::array<double, kMostAxes> least_at{};
};

template <int N>
Estimate estimate(const Taylor<N>& a) {
  Estimate found;
  found.range = range(a);
  for (int i = 0; i < N; ++i) {
    const I along = a.c[static_cast<size_t>(1 + i)];
    double& size = found.influence[static_cast<size_t>(i)];
    size = magnitude(along);
    for (int j = 0; j < N; ++j)
      size += (i == j ? 1.0 : 0.5) * magnitude(a.c[a.pair(std::min(i, j), std::max(i, j))]);
    const double slope = middle(along), bend = 2.0 * middle(a.c[a.pair(i, i)]);
    const double end = slope > 0.0 ? -1.0 : 1.0;
    found.least_at[static_cast<size_t>(i)] =
        bend > 0.0 && std::abs(slope) < bend ? -slope / bend : end;
  }
  return found;
}

template <class T>
vector<Estimate> estimates(const vector<T>& margins) {
  vector<Estimate> found;
  for (const T& margin : margins) found.push_back(estimate(margin));
  return found;
}

// A function near a point m: f, f' and f''/2 there, and what |f'''| is at most within `reach` of m.
struct Expansion {
  I f, slope, curve;
  double third;
};

// |sin'''| = |cos| and |cos'''| = |sin|, whose slopes are at most one.
Expansion sin_near(double m, double reach) {
  const auto [s, c] = sincos_at(m);
  return {s, c, I(-0.5) * s, std::min(1.0, magnitude(c) + reach)};
}

Expansion cos_near(double m, double reach) {
  const auto [s, c] = sincos_at(m);
  return {c, -s, I(-0.5) * c, std::min(1.0, magnitude(s) + reach)};
}

Expansion exp_near(double m, double reach) {
  const I e = exp_at(m);
  return {e, e, I(0.5) * e, exp_at(m + reach).high()};
}

Expansion log1p_near(double m, double reach) {
  const I slope = inverse(I(1.0) + I(m));
  const I w = inverse(I(1.0) + I(m) + symmetric(reach));  // log1p''' = 2 / (1 + x)^3
  return {log1p_at(m), slope, I(-0.5) * square(slope), magnitude(I(2.0) * square(w) * w)};
}

Expansion tanh_near(double m, double reach) {
  const I t = tanh_at(m), g = I(1.0) - square(t);
  // tanh''' = -2 (1 - t^2)(1 - 3 t^2); t moves by at most `reach`.
  const I u = square(intersection(t + symmetric(reach), symmetric(1.0)));
  return {t, g, -t * g, magnitude(I(2.0) * (I(1.0) - u) * (I(1.0) - I(3.0) * u))};
}

// s (1 - s) and s over the values of the logistic function within `reach` of where it is s.
std::pair<I, I> logistic_nearby(I s, double reach) {
  const I near = intersection(s + symmetric(0.25 * reach), I(0.0, 1.0));
  return {I(0.25) - square(near - I(0.5)), near};
}

Expansion logistic_near(double m, double reach) {
  const I s = logistic_at(m), g = s * (I(1.0) - s);
  const I p = logistic_nearby(s, reach).first;  // s''' = p (1 - 6 p), p = s (1 - s)
  return {s, g, g * (I(0.5) - s), magnitude(p * (I(1.0) - I(6.0) * p))};
}

Expansion softplus_near(double m, double reach) {
  const I s = logistic_at(m);
  const auto [p, near] = logistic_nearby(s, reach);
  return {softplus_at(m), s, I(0.5) * s * (I(1.0) - s), magnitude(p * (I(1.0) - I(2.0) * near))};
}

Expansion inverse_near(double m, double reach) {
  const I v = inverse(I(m));
  const I w = square(inverse(I(m) + symmetric(reach)));  // |(1/x)'''| = 6 / x^4
  return {v, -square(v), v * square(v), magnitude(I(6.0) * w * w)};
}

Expansion root_near(double m, double reach) {
  const I v = root(I(m)), slope = I(0.5) / v;
  const I least = I(m) - I(reach), w = root(least);  // sqrt''' = 3/8 x^(-5/2)
  return {v, slope, I(-0.25) * slope / I(m), magnitude(I(0.375) / (square(least) * w))};
}

// log(x / (1 - x)), whose derivatives are those of log x less those of log(1 - x).
Expansion logit_near(double m, double reach) {
  const I x(m), rest = I(1.0) - x, v = inverse(x), w = inverse(rest);
  const I near = x + symmetric(reach), far = rest + symmetric(reach);
  if (!(near.low() > 0.0 && far.low() > 0.0)) throw NoBound();
  const I v2 = inverse(near), w2 = inverse(far);  // Third derivatives: 2 / x^3 and -2 / (1 - x)^3.
  return {logit_at(m), v + w, I(0.5) * (square(w) - square(v)),
          magnitude(I(2.0) * (square(v2) * v2 + square(w2) * w2))};
}

Expansion arctan_near(double m, double) {
  const I slope = inverse(I(1.0) + square(I(m)));
  return {arctan_at(m), slope, -I(m) * square(slope), 2.0};  // |6 x^2 - 2| <= 2 (1 + x^2)^3
}

// f(a), around the middle of c0.
template <class T>
T expanded(const T& a, Expansion (*near)(double, double)) {
  const double m = middle(a.c[0]);
  T d = a;
  d.c[0] = d.c[0] - I(m);
  const double reach = magnitude(range(d));
  const Expansion f = near(m, reach);
  T r = f.slope * d + f.curve * (d * d);
  r.c[0] = r.c[0] + f.f + symmetric(f.third * reach * reach * reach / 6.0);
  return r;
}

// Sine and cosine together.
template <int N>
void sincos(const Taylor<N>& a, Taylor<N>& sine, Taylor<N>& cosine) {
  const double m = middle(a.c[0]);
  const auto [s, c] = sincos_at(m);
  Taylor<N> d = a;
  d.c[0] = d.c[0] - I(m);
  const Taylor<N> half = I(0.5) * (d * d);
  const double reach = magnitude(range(d)), cube = reach * reach * reach / 6.0;
  sine = c * d - s * half;
  sine.c[0] = sine.c[0] + s + symmetric(std::min(1.0, magnitude(c) + reach) * cube);
  cosine = -s * d - c * half;
  cosine.c[0] = cosine.c[0] + c + symmetric(std::min(1.0, magnitude(s) + reach) * cube);
}

template <int N>
Taylor<N> exp(const Taylor<N>& a) { return expanded(a, exp_near); }
template <int N>
Taylor<N> tanh(const Taylor<N>& a) { return expanded(a, tanh_near); }
template <int N>
Taylor<N> logistic(const Taylor<N>& a) { return expanded(a, logistic_near); }
template <int N>
Taylor<N> softplus(const Taylor<N>& a) { return expanded(a, softplus_near); }
template <int N>
Taylor<N> inverse(const Taylor<N>& a) { return expanded(a, inverse_near); }
template <int N>
Taylor<N> root(const Taylor<N>& a) { return expanded(a, root_near); }

template <int N>
inline Taylor<N> operator/(const Taylor<N>& a, const Taylor<N>& b) {
  return a * inverse(b);
}

// ---------------------------------------------------------------------------------- 4 duals
//
// A value and its derivative along one direction. Along the flow that is the rate.

template <class T>
struct DualOf {
  T v, d;
  DualOf(T value = T(), T derivative = T()) : v(std::move(value)), d(std::move(derivative)) {}
  DualOf(I constant) : v(constant) {}
  DualOf(double constant) : v(constant) {}
};
using Dual = DualOf<TM>;

// What a dual is made of; anything else is made of itself.
template <class S>
struct Under {
  using type = S;
  static constexpr bool has_rate = false;
};
template <class T>
struct Under<DualOf<T>> {
  using type = T;
  static constexpr bool has_rate = true;
};

template <class T>
inline DualOf<T> operator-(const DualOf<T>& a) { return {-a.v, -a.d}; }
template <class T>
inline DualOf<T> operator+(const DualOf<T>& a, const DualOf<T>& b) {
  return {a.v + b.v, a.d + b.d};
}
template <class T>
inline DualOf<T> operator-(const DualOf<T>& a, const DualOf<T>& b) {
  return {a.v - b.v, a.d - b.d};
}
template <class T>
inline DualOf<T> operator*(I k, const DualOf<T>& a) { return {k * a.v, k * a.d}; }
template <class T>
inline DualOf<T> operator*(const DualOf<T>& a, const DualOf<T>& b) {
  return {a.v * b.v, a.d * b.v + a.v * b.d};
}
template <class T>
inline DualOf<T> operator/(const DualOf<T>& a, const DualOf<T>& b) {
  const T share = inverse(b.v), v = a.v * share;
  return {v, (a.d - v * b.d) * share};
}
template <class T>
inline void sincos(const DualOf<T>& a, DualOf<T>& sine, DualOf<T>& cosine) {
  sincos(a.v, sine.v, cosine.v);
  sine.d = cosine.v * a.d;
  cosine.d = -(sine.v * a.d);
}
template <class T>
inline DualOf<T> root(const DualOf<T>& a) {
  const T v = root(a.v);
  return {v, I(0.5) * (a.d / v)};
}

}  // namespace
