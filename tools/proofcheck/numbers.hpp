#pragma once


#include <algorithm>
#include <array>
#include <cfenv>
#include <cfloat>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

static_assert(FLT_EVAL_METHOD == 0, "doubles must be rounded to doubles");
static_assert(std::numeric_limits<double>::is_iec559, "doubles must be IEEE 754");

namespace {

using std::string;
using std::vector;

// What may end the evaluation of a box, a statement or the whole.
struct NoBound {};                        // No finite enclosure: the box is too large.
struct Unknown { string what; };          // A condition that this program does not know.
struct Inconsistent { string why; };      // The file contradicts itself: rejected.
struct NotAProof { string why; };         // Not a proof file of this format.

// ------------------------------------------------------------------------------ 1 intervals
//
// The rounding mode is upward throughout. An interval is stored as (-low, high), so that both ends
// round outward: -low is an upper bound of minus the value. Every interval is finite; an operation
// whose result is not finite throws. Hence no NaN can arise, and none can pass as a bound.

struct I {
  double n, h;  // The interval [-n, h].
  I(double point = 0.0) : n(-point), h(point) {}
  I(double minus_low, double high) : n(minus_low), h(high) {}
  double low() const { return -n; }
  double high() const { return h; }
};

inline I finite(double n, double h) {
  if (!(n < HUGE_VAL && h < HUGE_VAL)) throw NoBound();
  return {n, h};
}

inline double larger(double a, double b) { return a < b ? b : a; }
inline double magnitude(I a) { return larger(a.n, a.h); }

inline I operator-(I a) { return {a.h, a.n}; }
inline I operator+(I a, I b) { return finite(a.n + b.n, a.h + b.h); }
inline I operator-(I a, I b) { return finite(a.n + b.h, a.h + b.n); }

inline I operator*(I a, I b) {
  // The four products of ends, rounded up; and their negatives, rounded up.
  const double high = larger(larger(a.n * b.n, (-a.n) * b.h), larger(a.h * (-b.n), a.h * b.h));
  const double low = larger(larger((-a.n) * b.n, a.n * b.h), larger(a.h * b.n, (-a.h) * b.h));
  return finite(low, high);
}

// a p where p is not negative: half the products.
inline I times_positive(I a, I p) {
  return finite(a.n * (a.n > 0.0 ? p.h : p.low()), a.h * (a.h > 0.0 ? p.h : p.low()));
}

inline I inverse(I a) {
  if (!(a.n < 0.0 || a.h < 0.0)) throw NoBound();  // 0 may lie in a.
  return finite(-1.0 / a.h, -1.0 / a.n);
}

inline I operator/(I a, I b) { return a * inverse(b); }

inline I square(I a) {
  const double m = magnitude(a);
  if (a.n < 0.0) return finite((-a.n) * a.n, m * m);  // low > 0
  if (a.h < 0.0) return finite((-a.h) * a.h, m * m);  // high < 0
  return finite(0.0, m * m);
}

inline I root(I a) {
  if (!(a.n < 0.0)) throw NoBound();
  const double low = a.low(), high = std::sqrt(a.h), above = std::sqrt(low);
  return finite((-low) / above, high);  // low / above <= sqrt(low), as above >= sqrt(low).
}

inline I symmetric(double radius) { return finite(radius, radius); }

inline I intersection(I a, I b) {
  const I c(a.n < b.n ? a.n : b.n, a.h < b.h ? a.h : b.h);
  if (-c.n > c.h) throw NoBound();  // Both contain the value, so this does not happen.
  return c;
}

inline double middle(I a) { return 0.5 * (a.h - a.n); }

// True if the processor and the compiled code round as this file needs it.
bool rounding_works() {
  if (std::fesetround(FE_UPWARD) != 0 || std::fegetround() != FE_UPWARD) return false;
  volatile double one = 1.0, tiny = 0x1p-60, three = 3.0, near_one = 1.0 + 0x1p-52;
  const double up = one + tiny, down = -(-one - tiny);
  if (!(up == 1.0 + 0x1p-52 && down == 1.0)) return false;
  const double minus_down = (-one) - (-tiny);  // -1 + 2^-60 rounded up
  if (!(minus_down == -(1.0 - 0x1p-53))) return false;
  const I third = I(one) / I(three);
  if (!(third.low() < third.high() && third.low() >= 0x1.5555555555554p-2 &&
        third.high() <= 0x1.5555555555557p-2))
    return false;
  const I square_up = I(near_one) * I(near_one);  // 1 + 2^-51 + 2^-104
  if (!(square_up.low() == 1.0 + 0x1p-51 && square_up.high() == 1.0 + 0x1p-51 + 0x1p-52))
    return false;
  const I minus = I(-near_one) * I(near_one);
  if (!(minus.low() == -square_up.high() && minus.high() == -square_up.low())) return false;
  volatile double two = 2.0;
  const I r = root(I(two));  // 0x1.6a09e667f3bcc908b2fb...p+0
  return r.low() >= 0x1.6a09e667f3bcbp+0 && r.low() <= 0x1.6a09e667f3bccp+0 &&
         r.high() == 0x1.6a09e667f3bcdp+0;
}

// ------------------------------------------------------------------ 2 elementary functions
//
// Each encloses its value at one double. Arguments are reduced with enclosures of the constants,
// series are summed in intervals, and what is left out is bounded in the line that says so.

const I LN2(-0x1.62e42fefa39efp-1, 0x1.62e42fefa39f0p-1);      // 0.693147180559945309417232...
const I HALF_PI(-0x1.921fb54442d18p+0, 0x1.921fb54442d19p+0);  // 1.570796326794896619231321...

// 1 / j! for j from 0 to 22: these factorials are doubles. Made when first asked for: rounding is upward
// by then.
using Reciprocals = std::array<I, 23>;
const Reciprocals& over_factorials() {
  static const Reciprocals known = [] {
    Reciprocals found;
    double factorial = 1.0;
    for (size_t j = 0; j < found.size(); ++j) {
      if (j > 1) factorial *= static_cast<double>(j);
      found[j] = inverse(I(factorial));
    }
    return found;
  }();
  return known;
}

// exp x = 2^k exp r, r = x - k ln 2.
I exp_at(double x) {
  if (!(x < 700.0)) throw NoBound();
  if (x < -700.0) return {0.0, 1e-300};  // exp(-700) < 1e-303
  const int k = static_cast<int>(x * 1.4426950408889634 + (x < 0.0 ? -0.5 : 0.5));
  const I r = I(x) - I(k) * LN2;
  if (!(magnitude(r) <= 0.5)) throw NoBound();
  const Reciprocals& share = over_factorials();
  const size_t terms = 18;
  I sum = share[terms - 1];
  // Positive: more than 1 / j! - |r| exp |r| / (j + 1)!, and |r| <= 1/2.
  for (size_t j = terms - 1; j-- > 0;) sum = share[j] + times_positive(r, sum);
  // Rest: |r|^18/18! (1 + |r|/19 + ...) <= 2 |r|^18/18!, and |r|^18 <= 2^-18.
  sum = sum + symmetric(0x1p-17 * share[terms].high());
  double scale = 1.0;  // A power of two within the normal range: exact.
  for (int j = 0; j < (k < 0 ? -k : k); ++j) scale *= k < 0 ? 0.5 : 2.0;
  return sum * I(scale);
}

I tanh_at(double x) {
  if (x > 300.0 || x < -300.0) return x > 0 ? I(-1.0 + 1e-15, 1.0) : I(1.0, -1.0 + 1e-15);
  const I value = I(1.0) - I(2.0) / (exp_at(2.0 * x) + I(1.0));
  return intersection(value, symmetric(1.0));
}

I logistic_at(double x) {
  if (x < 0.0) {
    const I e = exp_at(x);
    return intersection(e / (I(1.0) + e), I(0.0, 1.0));
  }
  return intersection(inverse(I(1.0) + exp_at(-x)), I(0.0, 1.0));
}

// log(1 + y) = 2 artanh w = 2 sum w^(2j+1)/(2j+1), w = y/(2 + y), for y in [0, 1].
I log1p_of(I y) {
  if (!(y.n <= 0.0 && y.h <= 1.0)) throw NoBound();
  const I w = y / (I(2.0) + y), w2 = square(w);
  const int terms = 18;
  I sum(0.0);
  for (int j = terms - 1; j >= 0; --j) sum = sum * w2 + inverse(I(2 * j + 1));
  // Rest: sum over j >= 18 of w^(2j) / 37 <= w^36 / 37 / (1 - w^2), and w <= 1/3.
  double rest = 1.125 / 37.0;
  for (int j = 0; j < terms; ++j) rest *= magnitude(w2);
  return I(2.0) * w * (sum + I(0.0, rest));
}

// log(1 + exp x)
I softplus_at(double x) {
  const I tail = log1p_of(intersection(exp_at(x < 0.0 ? x : -x), I(0.0, 1.0)));
  return x < 0.0 ? tail : I(x) + tail;
}

// log y = k ln 2 + log(1 + t), y = 2^k (1 + t) with t in [0, 1).
I log_at(double y) {
  if (!(y > 0.0)) throw NoBound();
  int k = 0;
  const double t = 2.0 * std::frexp(y, &k) - 1.0;  // Exact.
  return I(k - 1) * LN2 + log1p_of(I(t));
}

// log(1 + x)
I log1p_at(double x) {
  const I y = I(1.0) + I(x);
  return {log_at(y.low()).n, log_at(y.high()).h};
}

// log(x / (1 - x))
I logit_at(double x) {
  const I rest = I(1.0) - I(x);
  return log_at(x) - I(log_at(rest.low()).n, log_at(rest.high()).h);
}

// arctan x = 2 arctan(x / (1 + sqrt(1 + x^2))), three times, then its series: x is below 0.2.
I arctan_at(double x) {
  if (!(std::abs(x) < 1e100)) throw NoBound();
  I r(x);
  const int halvings = 3, terms = 12;
  for (int k = 0; k < halvings; ++k) r = r / (I(1.0) + root(I(1.0) + square(r)));
  const I r2 = square(r);
  I sum(0.0);
  for (int j = terms - 1; j >= 0; --j) sum = inverse(I(2 * j + 1)) - r2 * sum;
  // Alternating with decreasing terms: the rest is at most the first term left out.
  double rest = magnitude(r) / (2 * terms + 1);
  for (int j = 0; j < terms; ++j) rest *= magnitude(r2);
  return I(1 << halvings) * (r * sum + symmetric(rest));
}

struct SineCosine { I sine, cosine; };

// x = r + k pi/2; series of sine and cosine at r.
SineCosine sincos_at(double x) {
  if (!(x > -1e6 && x < 1e6)) return {symmetric(1.0), symmetric(1.0)};
  const int k = static_cast<int>(x * 0.6366197723675814 + (x < 0.0 ? -0.5 : 0.5));
  const I r = I(x) - I(k) * HALF_PI, r2 = square(r);
  if (!(magnitude(r) <= 1.0)) throw NoBound();
  const Reciprocals& share = over_factorials();
  const size_t terms = 10;
  I s = share[2 * terms - 1], c = share[2 * terms - 2];
  for (size_t j = terms - 1; j-- > 0;) {  // Positive: terms alternate and decrease, as r^2 <= 1.
    s = share[2 * j + 1] - times_positive(r2, s);
    c = share[2 * j] - times_positive(r2, c);
  }
  // The rest is at most the first term left out, and |r| <= 1.
  s = r * (s + symmetric(share[2 * terms + 1].high()));
  c = c + symmetric(share[2 * terms].high());
  switch (((k % 4) + 4) % 4) {
    case 0: return {s, c};
    case 1: return {c, -s};
    case 2: return {-s, -c};
    default: return {-c, s};
  }
}

}  // namespace
