#pragma once

#include "taylor.hpp"

namespace {

// ------------------------------------------------- 16 Taylor models of several boxes at once
//
// What section 3 does with an interval for every coefficient is done here with doubles, and all that
// is not exact is one number more: a value is, on each box, p(e) + t . f + s . xi + x with |x| <= r,
// where p has second degree in e_1 to e_n, each in [-1, 1], as are the elements of f, s . xi is linear
// in a vector of the unit ball, and r is the remainder. The f are remainders of some values (section
// 18): each is the same number wherever it is read. A number of boxes is treated in the same steps, a lane each; no lane knows
// of another.
//
// Rounding. In any rounding mode, and so in ours, upward, the machine's x + y is off by at most
// eps |x + y|, eps = 2^-52, and its x * y by at most eps |x y| + 2^-1074, unless they overflow. So a
// coefficient that is a sum of products, each of which passes through at most k roundings, is off by
// at most ((1 + eps)^k - 1) times the sum of the products' magnitudes, which is less than
// (k + 1) eps times that sum for k < 2^20; and a polynomial is off by at most the sum of that over
// its coefficients, because |e_i|, |e_i e_j|, |f_k| and |xi_k| are at most 1. Each operation below says how
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
// f, those of xi, then r, and what magnitudes add up to: |c_1| + .. + |c_n|, of first degree in e; of
// what is neither that nor constant, sum |c_ij| + sum |t_k| + |s|; and of all that but r.
template <int N>
struct Layout {
  static constexpr size_t kPolynomial = 1 + N + N * (N + 1) / 2;
  size_t fibres;
  size_t symbols = 0;  // Elements of f.

  size_t first_fibre() const { return kPolynomial + symbols; }
  size_t remainder() const { return first_fibre() + fibres; }
  size_t first() const { return remainder() + 1; }
  size_t higher() const { return remainder() + 2; }
  size_t whole() const { return remainder() + 3; }
  size_t numbers() const { return remainder() + 4; }
};

// Of N coordinates. Loops over coefficients are unrolled: they are short, and what they add up stays in
// registers. Of values that depend on neither f nor xi, and have zeros there, `polynomial` says so.
template <int N>
class Arithmetic {
 public:
  explicit Arithmetic(Layout<N> layout, bool polynomial = false)
      : terms_(polynomial ? kPolynomial : layout.remainder()),
        fibres_(std::min(terms_, layout.first_fibre())), remainder_(layout.remainder()),
        first_(layout.first()), higher_(layout.higher()), whole_(layout.whole()) {}

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
    y[fibres_ + k] = all(1.0);
    measure(y);
  }

  // The remainder as the k-th element of f, which is exact.
  void named(V* y, size_t k) const {
    y[kPolynomial + k] = y[remainder_];
    y[remainder_] = all(0.0);
    measure(y);
  }

  void constant(V* y, I number) const {
    clear(y);
    const double m = middle(number);
    y[0] = all(m);
    y[remainder_] = all(larger(number.n + m, number.h - m));
    measure(y);
  }

  // A sign is exact.
  void negative(const V* a, V* y) const {
    for (size_t i = 0; i < terms_; ++i) y[i] = -a[i];
    for (size_t i = remainder_; i <= whole_; ++i) y[i] = a[i];
  }

  // One rounding for each coefficient.
  void plus(const V* a, const V* b, V* y) const {
#pragma GCC unroll 64
    for (size_t i = 0; i < kPolynomial; ++i) y[i] = a[i] + b[i];
    for (size_t i = kPolynomial; i < terms_; ++i) y[i] = a[i] + b[i];
    y[remainder_] = a[remainder_] + b[remainder_] + kEps * (a[whole_] + b[whole_]);
    measure(y);
  }
  void minus(const V* a, const V* b, V* y) const {
#pragma GCC unroll 64
    for (size_t i = 0; i < kPolynomial; ++i) y[i] = a[i] - b[i];
    for (size_t i = kPolynomial; i < terms_; ++i) y[i] = a[i] - b[i];
    y[remainder_] = a[remainder_] + b[remainder_] + kEps * (a[whole_] + b[whole_]);
    measure(y);
  }

  // (A + x)(B + y) = A B + A y + B x + x y, and of A B the part is kept that has second degree in e,
  // or first in xi and none in e. With A = a0 + L + H, L of first degree, the rest of A B is
  // L H' + H L' + H H'. A coefficient sums up to four products, with four roundings each.
  void times(const V* a, const V* b, V* y) const {
    const V a0 = a[0], b0 = b[0];
    y[0] = a0 * b0;
#pragma GCC unroll 64
    for (size_t i = 1; i <= kAxes; ++i) y[i] = a0 * b[i] + a[i] * b0;
    size_t pair = 1 + kAxes;
#pragma GCC unroll 16
    for (size_t i = 1; i <= kAxes; ++i) {
      const V ai = a[i], bi = b[i];
      y[pair] = a0 * b[pair] + a[pair] * b0 + ai * bi;
      ++pair;
#pragma GCC unroll 16
      for (size_t j = i + 1; j <= kAxes; ++j, ++pair)
        y[pair] = a0 * b[pair] + a[pair] * b0 + (ai * b[j] + a[j] * bi);
    }
    for (size_t i = kPolynomial; i < terms_; ++i) y[i] = a0 * b[i] + a[i] * b0;
    const V al = a[first_], ah = a[higher_], ar = a[remainder_], am = a[whole_];
    const V bl = b[first_], bh = b[higher_], br = b[remainder_], bm = b[whole_];
    y[remainder_] = am * br + bm * ar + ar * br + (al * bh + ah * bl + ah * bh) +
                (5.0 * kEps * (am * bm) + kTiny);
    measure(y);
  }

  // The same where `k` does not depend on e and xi: one product, one rounding.
  void scaled(const V* k, const V* a, V* y) const {
    const V k0 = k[0], k_size = size(k0), kr = k[remainder_], ar = a[remainder_], am = a[whole_];
#pragma GCC unroll 64
    for (size_t i = 0; i < kPolynomial; ++i) y[i] = k0 * a[i];
    for (size_t i = kPolynomial; i < terms_; ++i) y[i] = k0 * a[i];
    y[remainder_] = k_size * ar + kr * (am + ar) + (2.0 * kEps * (k_size * am) + kTiny);
    measure(y);
  }

  // sum_i k_i t_i + c (c may be none) of numbers k_i. A product passes through one rounding of its own
  // and one in each later addition: not more than `count` of them.
  void row(const double* k, const V* const* t, size_t count, const V* c, V* y) const {
    size_t i = 0;
    for (; i + kBlock <= kPolynomial; i += kBlock) sums<kBlock>(i, k, t, count, c, y);
    sums<kPolynomial % kBlock>(i, k, t, count, c, y);
    for (i = kPolynomial; i < terms_; ++i) sums<1>(i, k, t, count, c, y);
    V r = c ? c[remainder_] : all(0.0), sizes = c ? c[whole_] : all(0.0);
    for (size_t m = 0; m < count; ++m) {
      const V k_size = all(std::abs(k[m]));
      r += k_size * t[m][remainder_];
      sizes += k_size * t[m][whole_];
    }
    y[remainder_] = r + (static_cast<double>(count + 2) * kEps * sizes + kTiny);
    measure(y);
  }

  // f(m + d) = f + f' d + f''/2 d^2 + x, |x| <= third |d|^3 / 6, with m the constant of a and
  // d = L + H + x of it. Of d^2, L^2 is kept. A lane without a bound has an infinite remainder.
  void expanded(Expansion (*near)(double, double), const V* a, V* y) const {
    const V l = a[first_], h = a[higher_], ar = a[remainder_], reach = l + h + ar;
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
    size_t pair = 1 + kAxes;
    for (size_t i = 1; i <= kAxes; ++i) {
      const V bent = curve * a[i];
      y[pair++] += bent * a[i];
      for (size_t j = i + 1; j <= kAxes; ++j) {
        const V mixed = bent * a[j];
        y[pair++] += mixed + mixed;
      }
    }
    // Of a coefficient: one product of two factors and one of three, with three roundings at most;
    // the magnitudes are those of f' (L + H) and of f''/2 L^2.
    const V slope_size = size(slope), curve_size = size(curve);
    y[remainder_] = error + slope_size * ar +
                curve_size * (2.0 * (l * h) + h * h + ar * (2.0 * (l + h) + ar)) +
                (4.0 * kEps * (slope_size * (l + h) + curve_size * (l * l)) + kTiny);
    measure(y);
  }

  // The value on one lane, as section 3 has it. Throws if it has no bound.
  Taylor<N> on_lane(const V* a, int lane) const {
    Taylor<N> found(finite(-a[0][lane], a[0][lane]));
    const double left_out = a[remainder_][lane] + length(a)[lane];
    found.c[0] = found.c[0] + symmetric(left_out);
    for (size_t i = 1; i < kPolynomial; ++i) found.c[i] = I(a[i][lane]);
    return found;
  }

 private:
  static constexpr size_t kAxes = N, kPolynomial = Layout<N>::kPolynomial, kBlock = 8;
  const size_t terms_, fibres_, remainder_, first_, higher_, whole_;

  void clear(V* y) const {
    for (size_t i = 0; i <= whole_; ++i) y[i] = all(0.0);
  }

  // Coefficients `from` to from + count - 1 of a row.
  template <size_t kSome>
  void sums(size_t from, const double* k, const V* const* t, size_t count, const V* c, V* y) const {
    V sum[kSome];
#pragma GCC unroll 8
    for (size_t i = 0; i < kSome; ++i) sum[i] = c ? c[from + i] : all(0.0);
    for (size_t m = 0; m < count; ++m) {
      const V factor = all(k[m]);
      const V* term = t[m] + from;
#pragma GCC unroll 8
      for (size_t i = 0; i < kSome; ++i) sum[i] += factor * term[i];
    }
#pragma GCC unroll 8
    for (size_t i = 0; i < kSome; ++i) y[from + i] = sum[i];
  }

  // Bound on |t . f + s . xi|.
  V length(const V* a) const {
    V sum = all(0.0), squares = all(0.0);
    for (size_t k = kPolynomial; k < fibres_; ++k) sum += size(a[k]);
    for (size_t k = fibres_; k < terms_; ++k) squares += a[k] * a[k];
    for (int lane = 0; fibres_ < terms_ && lane < kLanes; ++lane)
      squares[lane] = std::sqrt(squares[lane]);
    return sum + squares;
  }

  void measure(V* y) const {
    V first = all(0.0), even = all(0.0), odd = all(0.0);
#pragma GCC unroll 16
    for (size_t i = 1; i <= kAxes; ++i) first += size(y[i]);
#pragma GCC unroll 64
    for (size_t i = 1 + kAxes; i < kPolynomial; ++i) ((i % 2) ? even : odd) += size(y[i]);
    V higher = even + odd;
    if (kPolynomial < terms_) higher += length(y);
    y[first_] = first;
    y[higher_] = higher;
    y[whole_] = size(y[0]) + first + higher;
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
