#pragma once

#include "taylor.hpp"

namespace {

// ------------------------------------------------- 16 Taylor models of several boxes at once
//
// What section 3 does with an interval for every coefficient is done here with doubles, and all that
// is not exact is one number more: a value is, on each box, p(e) + s . xi + x with |x| <= r, where p
// has second degree in e_1 to e_n, each in [-1, 1], s . xi is linear in a vector of the unit ball,
// and r is the remainder. A number of boxes is treated in the same steps, a lane each; no lane knows
// of another.
//
// Rounding. In any rounding mode, and so in ours, upward, the machine's x + y is off by at most
// eps |x + y|, eps = 2^-52, and its x * y by at most eps |x y| + 2^-1074, unless they overflow. So a
// coefficient that is a sum of products, each of which passes through at most k roundings, is off by
// at most ((1 + eps)^k - 1) times the sum of the products' magnitudes, which is less than
// (k + 1) eps times that sum for k < 2^20; and a polynomial is off by at most the sum of that over
// its coefficients, because |e_i|, |e_i e_j| and |xi_k| are at most 1. Each operation below says how
// many roundings there are and what the magnitudes add up to, and adds that to r. kTiny covers
// products that underflow: far fewer than 2^60 of 2^-1074 each.
//
// r and all bounds it is made of are sums and products of numbers that are not negative, rounded
// upward, so they are not too small. What overflows makes the magnitudes, and with them r, infinite
// or no number; both stay in r through every operation, because nothing is compared or left out
// where r is formed. A lane with such an r has no bound. (A coefficient itself may be wrong then.)

#if defined(__AVX512F__)
constexpr int kLanes = 8;
#elif defined(__AVX__)
constexpr int kLanes = 4;
#else
constexpr int kLanes = 2;
#endif
typedef double V __attribute__((vector_size(kLanes * sizeof(double))));
typedef std::int64_t Bits __attribute__((vector_size(kLanes * sizeof(double))));

inline V all(double x) { return V{} + x; }
inline V size(V x) { return (V)((Bits)x & INT64_MAX); }  // |x|: without its sign bit.

constexpr double kEps = 0x1p-52, kTiny = 0x1p-1000;

// Where the numbers of a value are: its coefficients 1, e_i, e_i e_j for i <= j row by row, those of
// xi, then r, and bounds on the magnitudes of what has first degree in e, and of what is neither
// that nor constant: |c_1| + .. + |c_n| and sum |c_ij| + |s|.
struct Layout {
  size_t axes, fibres;

  size_t polynomial() const { return 1 + axes + axes * (axes + 1) / 2; }
  size_t terms() const { return polynomial() + fibres; }
  size_t remainder() const { return terms(); }
  size_t first() const { return terms() + 1; }
  size_t higher() const { return terms() + 2; }
  size_t numbers() const { return terms() + 3; }
};

class Arithmetic {
 public:
  explicit Arithmetic(Layout layout) : at_(layout), n_(layout.axes), terms_(layout.terms()) {}

  // [low, high] on each lane, as in section 3: middle + radius e_axis.
  void coordinate(V* y, size_t axis, const std::array<I, kLanes>& ends) const {
    clear(y);
    for (int lane = 0; lane < kLanes; ++lane) {
      const double low = ends[static_cast<size_t>(lane)].low(),
                   high = ends[static_cast<size_t>(lane)].high();
      const double centre = low + (high - low) * 0.5;
      y[0][lane] = centre;
      y[1 + axis][lane] = larger(high - centre, centre - low);
    }
    measure(y);
  }

  void fibre(V* y, size_t k) const {
    clear(y);
    y[at_.polynomial() + k] = all(1.0);
    measure(y);
  }

  void constant(V* y, I number) const {
    clear(y);
    const double m = middle(number);
    y[0] = all(m);
    y[terms_] = all(larger(number.n + m, number.h - m));
  }

  // A sign is exact.
  void negative(const V* a, V* y) const {
    for (size_t i = 0; i < terms_; ++i) y[i] = -a[i];
    for (size_t i = terms_; i < at_.numbers(); ++i) y[i] = a[i];
  }

  // One rounding for each coefficient.
  void plus(const V* a, const V* b, V* y) const {
    for (size_t i = 0; i < terms_; ++i) y[i] = a[i] + b[i];
    y[terms_] = a[terms_] + b[terms_] + kEps * (magnitude(a) + magnitude(b));
    measure(y);
  }
  void minus(const V* a, const V* b, V* y) const {
    for (size_t i = 0; i < terms_; ++i) y[i] = a[i] - b[i];
    y[terms_] = a[terms_] + b[terms_] + kEps * (magnitude(a) + magnitude(b));
    measure(y);
  }

  // (A + x)(B + y) = A B + A y + B x + x y, and of A B the part is kept that has second degree in e,
  // or first in xi and none in e. With A = a0 + L + H, L of first degree, the rest of A B is
  // L H' + H L' + H H'. A coefficient sums up to four products, with four roundings each.
  void times(const V* a, const V* b, V* y) const {
    const V a0 = a[0], b0 = b[0];
    y[0] = a0 * b0;
    for (size_t i = 1; i < terms_; ++i) y[i] = a0 * b[i] + a[i] * b0;
    size_t pair = 1 + n_;
    for (size_t i = 1; i <= n_; ++i) {
      const V ai = a[i], bi = b[i];
      y[pair++] += ai * bi;
      for (size_t j = i + 1; j <= n_; ++j) y[pair++] += ai * b[j] + a[j] * bi;
    }
    const V al = a[at_.first()], ah = a[at_.higher()], ar = a[terms_], am = magnitude(a);
    const V bl = b[at_.first()], bh = b[at_.higher()], br = b[terms_], bm = magnitude(b);
    y[terms_] = am * br + bm * ar + ar * br + (al * bh + ah * bl + ah * bh) +
                (5.0 * kEps * (am * bm) + kTiny);
    measure(y);
  }

  // The same where `k` does not depend on e and xi: one product, one rounding.
  void scaled(const V* k, const V* a, V* y) const {
    const V k0 = k[0], k_size = size(k0), kr = k[terms_], ar = a[terms_], am = magnitude(a);
    for (size_t i = 0; i < terms_; ++i) y[i] = k0 * a[i];
    y[terms_] = k_size * ar + kr * (am + ar) + (2.0 * kEps * (k_size * am) + kTiny);
    measure(y);
  }

  // sum_i k_i t_i + c (c may be none), where no k_i depends on e and xi. A product passes through one
  // rounding of its own and one in each later addition: not more than `count` of them.
  void row(const V* const* k, const V* const* t, size_t count, const V* c, V* y) const {
    V r = all(0.0), sizes = all(0.0);
    if (c) {
      for (size_t i = 0; i < terms_; ++i) y[i] = c[i];
      r = c[terms_];
      sizes = magnitude(c);
    } else {
      for (size_t i = 0; i < terms_; ++i) y[i] = all(0.0);
    }
    for (size_t m = 0; m < count; ++m) {
      const V k0 = k[m][0], k_size = size(k0), kr = k[m][terms_];
      const V *term = t[m], tr = term[terms_], tm = magnitude(term);
      for (size_t i = 0; i < terms_; ++i) y[i] += k0 * term[i];
      r += k_size * tr + kr * (tm + tr);
      sizes += k_size * tm;
    }
    y[terms_] = r + (static_cast<double>(count + 2) * kEps * sizes + kTiny);
    measure(y);
  }

  // f(m + d) = f + f' d + f''/2 d^2 + x, |x| <= third |d|^3 / 6, with m the constant of a and
  // d = L + H + x of it. Of d^2, L^2 is kept. A lane without a bound has an infinite remainder.
  void expanded(Expansion (*near)(double, double), const V* a, V* y) const {
    const V l = a[at_.first()], h = a[at_.higher()], ar = a[terms_], reach = l + h + ar;
    V f, slope, curve, error;
    for (int lane = 0; lane < kLanes; ++lane) {
      const Split found = split(near, a[0][lane], reach[lane]);
      f[lane] = found.f;
      slope[lane] = found.slope;
      curve[lane] = found.curve;
      error[lane] = found.error;
    }
    y[0] = f;
    for (size_t i = 1; i < terms_; ++i) y[i] = slope * a[i];
    size_t pair = 1 + n_;
    for (size_t i = 1; i <= n_; ++i) {
      const V bent = curve * a[i];
      y[pair++] += bent * a[i];
      for (size_t j = i + 1; j <= n_; ++j) {
        const V mixed = bent * a[j];
        y[pair++] += mixed + mixed;
      }
    }
    // Of a coefficient: one product of two factors and one of three, with three roundings at most;
    // the magnitudes are those of f' (L + H) and of f''/2 L^2.
    const V slope_size = size(slope), curve_size = size(curve);
    y[terms_] = error + slope_size * ar +
                curve_size * (2.0 * (l * h) + h * h + ar * (2.0 * (l + h) + ar)) +
                (4.0 * kEps * (slope_size * (l + h) + curve_size * (l * l)) + kTiny);
    measure(y);
  }

  // The value on one lane, as section 3 has it. Throws if it has no bound.
  template <int N>
  Taylor<N, false> on_lane(const V* a, int lane) const {
    if (n_ > N) throw NoBound();
    Taylor<N, false> found(finite(-a[0][lane], a[0][lane]));
    const double left_out = a[terms_][lane] + length(a)[lane];
    found.c[0] = found.c[0] + symmetric(left_out);
    size_t pair = 1 + n_;
    for (size_t i = 0; i < n_; ++i) {
      found.c[1 + i] = I(a[1 + i][lane]);
      for (size_t j = i; j < n_; ++j)
        found.c[found.pair(static_cast<int>(i), static_cast<int>(j))] = I(a[pair++][lane]);
    }
    return found;
  }

 private:
  const Layout at_;
  const size_t n_, terms_;

  void clear(V* y) const {
    for (size_t i = 0; i < at_.numbers(); ++i) y[i] = all(0.0);
  }

  // All of |p| + |s . xi| but the remainder.
  V magnitude(const V* a) const { return size(a[0]) + a[at_.first()] + a[at_.higher()]; }

  // Bound on |s . xi|.
  V length(const V* a) const {
    V squares = all(0.0);
    for (size_t k = at_.polynomial(); k < terms_; ++k) squares += a[k] * a[k];
    for (int lane = 0; at_.fibres && lane < kLanes; ++lane) squares[lane] = std::sqrt(squares[lane]);
    return squares;
  }

  void measure(V* y) const {
    V first = all(0.0), even = all(0.0), odd = all(0.0);
    for (size_t i = 1; i <= n_; ++i) first += size(y[i]);
    size_t i = 1 + n_;
    for (; i + 1 < at_.polynomial(); i += 2) {
      even += size(y[i]);
      odd += size(y[i + 1]);
    }
    if (i < at_.polynomial()) even += size(y[i]);
    y[at_.first()] = first;
    y[at_.higher()] = at_.fibres ? even + odd + length(y) : even + odd;
  }

  // An expansion as numbers, and what they are off by wherever |d| <= reach.
  struct Split {
    double f, slope, curve, error;
  };
  static Split split(Expansion (*near)(double, double), double m, double reach) {
    if (!(std::abs(m) + reach < HUGE_VAL)) return {0.0, 0.0, 0.0, HUGE_VAL};
    try {
      const Expansion e = near(m, reach);
      const auto off = [](I x) { return larger(x.n + middle(x), x.h - middle(x)); };
      return {middle(e.f), middle(e.slope), middle(e.curve),
              off(e.f) + off(e.slope) * reach + off(e.curve) * (reach * reach) +
                  e.third * (reach * reach * reach) / 6.0};
    } catch (const NoBound&) {
      return {0.0, 0.0, 0.0, HUGE_VAL};
    }
  }
};

}  // namespace
