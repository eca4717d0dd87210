// proofcheck: an independent check of a gait certificate.
//
// A proof file says: at every state of a region, this condition of the gait holds with this margin;
// and, at levels 2 and 3, what that means for trajectories: they walk for ever, and converge to one
// periodic orbit. It contains link data of a robot, the numbers of a policy, of a tube in the plane
// of the zero dynamics and of the orbit, and for each statement a tree of boxes. This program
// derives everything else from those numbers: positions, momenta, the zero dynamics, accelerations,
// torques, ground forces, the impact, the return map. It never evaluates the list of operations
// ("Program") that the file also contains and that the finder worked with, and shares no formula
// file, derivative rule or library with it.
//
// The story, in sections:
//    1  intervals            numbers enclosed by directed rounding
//    2  elementary functions exp, tanh, logistic, log1p, sin, cos at a point, with remainders
//    3  Taylor models        functions of a box: quadratic polynomials with interval coefficients
//    4  duals                a value and its derivative along a direction
//    5  reading              JSON, hexadecimal floats, base64, sha256
//    6  the model            robot from link data, policy, tube
//    7  the policy           desired outputs and their derivatives up to second order
//    8  mechanics            from (z1, z2) to forces and impact, link by link
//    9  conditions           what is claimed of single states, as formulas and in words
//   10  set and orbit        what levels 2 and 3 rest on, as formulas and in words
//   11  the check            trees of boxes
//   12  what follows         from statements about boxes to statements about trajectories
//   13  the file             consistency of what it says
//   14  the command
//
// proofcheck FILE prints the robot and every statement in words, with all numbers that they depend
// on, and answers with its exit code: 0 proved of what is printed, 1 rejected (false, with a point;
// or the file contradicts itself, or claims what does not follow), 2 not a proof file, 3 undecided (a
// user's own condition, the full-order theorem, boxes that do not reach their bounds, or a condition
// that is not claimed on all of its region), 70 the rounding does not work. Boxes are bounded with models of second
// degree whatever degree the finder used.
//
// Trusted: the C++ compiler, IEEE 754 + - * / sqrt in the rounding mode that is set and tested at
// the start, and the standard library's strings and containers. Signs and symbols are those of
// docs/notation.md: x forward, z up, angles counter-clockwise, z2 forward positive.

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

// r^count / count!, rounded up.
double term_bound(double r, int count) {
  double term = 1.0;
  for (int j = 1; j <= count; ++j) term = term * r / j;
  return term;
}

// exp x = 2^k exp r, r = x - k ln 2.
I exp_at(double x) {
  if (!(x < 700.0)) throw NoBound();
  if (x < -700.0) return {0.0, 1e-300};  // exp(-700) < 1e-303
  const int k = static_cast<int>(x * 1.4426950408889634 + (x < 0.0 ? -0.5 : 0.5));
  const I r = I(x) - I(k) * LN2;
  if (!(magnitude(r) <= 0.5)) throw NoBound();
  const int terms = 18;
  I sum(1.0);
  for (int j = terms - 1; j >= 1; --j) sum = I(1.0) + r * sum / I(j);
  // Rest: |r|^18/18! (1 + |r|/19 + ...) <= 2 |r|^18/18!
  sum = sum + symmetric(2.0 * term_bound(magnitude(r), terms));
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

struct SineCosine { I sine, cosine; };

// x = r + k pi/2; series of sine and cosine at r.
SineCosine sincos_at(double x) {
  if (!(x > -1e6 && x < 1e6)) return {symmetric(1.0), symmetric(1.0)};
  const int k = static_cast<int>(x * 0.6366197723675814 + (x < 0.0 ? -0.5 : 0.5));
  const I r = I(x) - I(k) * HALF_PI, r2 = square(r);
  if (!(magnitude(r) <= 1.0)) throw NoBound();
  const int terms = 10;
  I s(1.0), c(1.0);
  for (int j = terms - 1; j >= 1; --j) {
    s = I(1.0) - r2 * s / I((2 * j) * (2 * j + 1));
    c = I(1.0) - r2 * c / I((2 * j - 1) * (2 * j));
  }
  // Alternating with decreasing terms: the rest is at most the first term left out.
  s = r * s + symmetric(term_bound(magnitude(r), 2 * terms + 1));
  c = c + symmetric(term_bound(magnitude(r), 2 * terms));
  switch (((k % 4) + 4) % 4) {
    case 0: return {s, c};
    case 1: return {c, -s};
    case 2: return {-s, -c};
    default: return {-c, s};
  }
}

// -------------------------------------------------------------------------- 3 Taylor models
//
// A function of the box is enclosed by c0 + c1 x + c2 y + c3 x^2 + c4 xy + c5 y^2 with x, y in
// [-1, 1] the box's own coordinates. Coefficients are intervals: for every point of the box some
// real choice of them gives the function's value. All that has a higher degree is enclosed by an
// interval and added to c0, which is therefore also the remainder.

struct TM {
  std::array<I, 6> c;
  TM(I constant = I(0.0)) { c[0] = constant; }
  TM(double constant) { c[0] = I(constant); }
  double linear() const { return magnitude(c[1]) + magnitude(c[2]); }
  double quadratic() const { return magnitude(c[3]) + magnitude(c[4]) + magnitude(c[5]); }
};

// [low, high] as middle + radius * coordinate `axis`.
TM coordinate(double low, double high, int axis) {
  const double centre = low + (high - low) * 0.5;
  TM a(centre);
  a.c[1 + axis] = I(larger((high - centre), (centre - low)));
  return a;
}

inline TM operator-(const TM& a) {
  TM r;
  for (int i = 0; i < 6; ++i) r.c[i] = -a.c[i];
  return r;
}
inline TM operator+(const TM& a, const TM& b) {
  TM r;
  for (int i = 0; i < 6; ++i) r.c[i] = a.c[i] + b.c[i];
  return r;
}
inline TM operator-(const TM& a, const TM& b) {
  TM r;
  for (int i = 0; i < 6; ++i) r.c[i] = a.c[i] - b.c[i];
  return r;
}
inline TM operator*(I k, const TM& a) {
  TM r;
  for (int i = 0; i < 6; ++i) r.c[i] = k * a.c[i];
  return r;
}
inline TM operator*(const TM& a, const TM& b) {
  TM r;
  r.c[0] = a.c[0] * b.c[0];
  r.c[1] = a.c[0] * b.c[1] + a.c[1] * b.c[0];
  r.c[2] = a.c[0] * b.c[2] + a.c[2] * b.c[0];
  r.c[3] = a.c[0] * b.c[3] + a.c[3] * b.c[0] + a.c[1] * b.c[1];
  r.c[4] = a.c[0] * b.c[4] + a.c[4] * b.c[0] + a.c[1] * b.c[2] + a.c[2] * b.c[1];
  r.c[5] = a.c[0] * b.c[5] + a.c[5] * b.c[0] + a.c[2] * b.c[2];
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
    const double vertex = steep * steep / (4.0 * a.low());
    if (vertex < found) found = vertex;
    // The vertex lies outside [-1, 1]: the least value is at an end.
    if (distance_from_zero(b) >= 2.0 * a.h && steep + a.n < found) found = steep + a.n;
  }
  return found;
}

// Minus the least value over the box. A polynomial that is monotone in x is least on an edge.
double minus_least(const TM& a) {
  const auto& c = a.c;
  if (distance_from_zero(c[1]) >= 2.0 * magnitude(c[3]) + magnitude(c[4])) {
    const I x = c[1].n < 0.0 ? I(-1.0) : I(1.0);
    return (c[0] + x * c[1] + c[3]).n + minus_parabola(c[2] + x * c[4], c[5]);
  }
  if (distance_from_zero(c[2]) >= 2.0 * magnitude(c[5]) + magnitude(c[4])) {
    const I y = c[2].n < 0.0 ? I(-1.0) : I(1.0);
    return (c[0] + y * c[2] + c[5]).n + minus_parabola(c[1] + y * c[4], c[3]);
  }
  return c[0].n + minus_parabola(c[1], c[3]) + minus_parabola(c[2], c[5]) + magnitude(c[4]);
}

I range(const TM& a) { return finite(minus_least(a), minus_least(-a)); }

// f(a) from f, f' and f''/2 at the middle m of c0; `third(R)` bounds |f'''| within R of m.
template <class Third>
TM expanded(const TM& a, double m, I f, I slope, I curve, Third third) {
  TM d = a;
  d.c[0] = d.c[0] - I(m);
  const double reach = magnitude(range(d));
  TM r = slope * d + curve * (d * d);
  r.c[0] = r.c[0] + f + symmetric(third(reach) * reach * reach * reach / 6.0);
  return r;
}

// Sine and cosine together.
void sincos(const TM& a, TM& sine, TM& cosine) {
  const double m = middle(a.c[0]);
  const auto [s, c] = sincos_at(m);
  TM d = a;
  d.c[0] = d.c[0] - I(m);
  const TM half = I(0.5) * (d * d);
  const double reach = magnitude(range(d)), cube = reach * reach * reach / 6.0;
  // |sin'''| = |cos| and |cos'''| = |sin|, whose slopes are at most one.
  sine = c * d - s * half;
  sine.c[0] = sine.c[0] + s + symmetric(std::min(1.0, magnitude(c) + reach) * cube);
  cosine = -s * d - c * half;
  cosine.c[0] = cosine.c[0] + c + symmetric(std::min(1.0, magnitude(s) + reach) * cube);
}

TM tanh(const TM& a) {
  const double m = middle(a.c[0]);
  const I t = tanh_at(m), g = I(1.0) - square(t);
  return expanded(a, m, t, g, -t * g, [t](double reach) {
    // tanh''' = -2 (1 - t^2)(1 - 3 t^2); t moves by at most `reach`.
    const I u = square(intersection(t + symmetric(reach), symmetric(1.0)));
    return magnitude(I(2.0) * (I(1.0) - u) * (I(1.0) - I(3.0) * u));
  });
}

// s (1 - s) and s over the values of the logistic function within `reach` of where it is s.
std::pair<I, I> logistic_nearby(I s, double reach) {
  const I near = intersection(s + symmetric(0.25 * reach), I(0.0, 1.0));
  return {I(0.25) - square(near - I(0.5)), near};
}

TM logistic(const TM& a) {
  const double m = middle(a.c[0]);
  const I s = logistic_at(m), g = s * (I(1.0) - s);
  return expanded(a, m, s, g, g * (I(0.5) - s), [s](double reach) {
    const I p = logistic_nearby(s, reach).first;  // s''' = p (1 - 6 p), p = s (1 - s)
    return magnitude(p * (I(1.0) - I(6.0) * p));
  });
}

TM softplus(const TM& a) {
  const double m = middle(a.c[0]);
  const I s = logistic_at(m);
  return expanded(a, m, softplus_at(m), s, I(0.5) * s * (I(1.0) - s), [s](double reach) {
    const auto [p, near] = logistic_nearby(s, reach);
    return magnitude(p * (I(1.0) - I(2.0) * near));
  });
}

TM inverse(const TM& a) {
  const double m = middle(a.c[0]);
  const I v = inverse(I(m));
  return expanded(a, m, v, -square(v), v * square(v), [m](double reach) {
    const I w = square(inverse(I(m) + symmetric(reach)));  // |(1/x)'''| = 6 / x^4
    return magnitude(I(6.0) * w * w);
  });
}

TM root(const TM& a) {
  const double m = middle(a.c[0]);
  const I v = root(I(m)), slope = I(0.5) / v;
  return expanded(a, m, v, slope, I(-0.25) * slope / I(m), [m](double reach) {
    const I least = I(m) - I(reach), w = root(least);  // sqrt''' = 3/8 x^(-5/2)
    return magnitude(I(0.375) / (square(least) * w));
  });
}

inline TM operator/(const TM& a, const TM& b) { return a * inverse(b); }

// ---------------------------------------------------------------------------------- 4 duals
//
// A value and its derivative along one direction. Along the flow that is the rate.

struct Dual {
  TM v, d;
  Dual(TM value = TM(), TM derivative = TM()) : v(std::move(value)), d(std::move(derivative)) {}
  Dual(I constant) : v(constant) {}
  Dual(double constant) : v(constant) {}
};

inline Dual operator-(const Dual& a) { return {-a.v, -a.d}; }
inline Dual operator+(const Dual& a, const Dual& b) { return {a.v + b.v, a.d + b.d}; }
inline Dual operator-(const Dual& a, const Dual& b) { return {a.v - b.v, a.d - b.d}; }
inline Dual operator*(I k, const Dual& a) { return {k * a.v, k * a.d}; }
inline Dual operator*(const Dual& a, const Dual& b) { return {a.v * b.v, a.d * b.v + a.v * b.d}; }
inline Dual operator/(const Dual& a, const Dual& b) {
  const TM share = inverse(b.v), v = a.v * share;
  return {v, (a.d - v * b.d) * share};
}
inline void sincos(const Dual& a, Dual& sine, Dual& cosine) {
  sincos(a.v, sine.v, cosine.v);
  sine.d = cosine.v * a.d;
  cosine.d = -(sine.v * a.d);
}
inline Dual root(const Dual& a) {
  const TM v = root(a.v);
  return {v, I(0.5) * (a.d / v)};
}

// -------------------------------------------------------------------------------- 5 reading
//
// All numbers of the file are read in the default rounding mode, before upward rounding is set:
// decimals to the nearest double, as every other reader does, hexadecimal numbers exactly.

struct Json {
  enum Type { null, boolean, number, text, list, object } type = null;
  string string_value;  // Of a text; of a number, as it is written.
  double number_value = 0.0;
  vector<Json> items;  // Of a list; of an object, the values.
  vector<string> names;

  const Json* find(const string& name) const {
    for (size_t i = 0; i < names.size(); ++i)
      if (names[i] == name) return &items[i];
    return nullptr;
  }
};

[[noreturn]] void refuse(const string& why) { throw NotAProof{why}; }

// A screen obeys some characters: no text of a proof file has them.
void refuse_control_characters(const string& text) {
  for (size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : 0);
    if (byte < 0x20 || byte == 0x7F || (byte == 0xC2 && next < 0xA0))
      refuse("a text with a control character");
  }
}

// A line on a screen: whatever is not plain ASCII is escaped, so that no text of a file, nor its path,
// can write over what this program says.
void say(const string& text, FILE* screen = stdout) {
  string line;
  char escape[8];
  for (const char c : text) {
    if (c >= 0x20 && c < 0x7F) { line += c; continue; }
    snprintf(escape, sizeof escape, "\\x%02x", static_cast<unsigned char>(c));
    line += escape;
  }
  fprintf(screen, "%s\n", line.c_str());
}

class JsonReader {
 public:
  explicit JsonReader(const string& text) : text_(text) {}

  Json document() {
    Json value = element(0);
    space();
    if (at_ != text_.size()) refuse("text after the end of the JSON object");
    return value;
  }

 private:
  static constexpr int kDeepest = 60;
  const string& text_;
  size_t at_ = 0;

  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void space() {
    while (at_ < text_.size() && strchr(" \t\r\n", text_[at_]) && text_[at_]) ++at_;
  }
  void expect(const char* word) {
    if (text_.compare(at_, strlen(word), word) != 0)
      refuse("no JSON at byte " + std::to_string(at_));
    at_ += strlen(word);
  }

  Json element(int depth) {
    if (depth > kDeepest) refuse("JSON nested more than 60 deep");
    space();
    Json value;
    switch (peek()) {
      case '{': fields(value, depth); break;
      case '[': entries(value, depth); break;
      case '"': value.type = Json::text; value.string_value = quoted(); break;
      case 't': expect("true"); value.type = Json::boolean; value.number_value = 1.0; break;
      case 'f': expect("false"); value.type = Json::boolean; break;
      case 'n': expect("null"); break;
      default: number(value);
    }
    return value;
  }

  void fields(Json& value, int depth) {
    value.type = Json::object;
    std::set<string> seen;
    expect("{");
    space();
    if (peek() == '}') { expect("}"); return; }
    while (true) {
      space();
      string name = quoted();
      if (!seen.insert(name).second) refuse("the field '" + name + "' twice in one object");
      space();
      expect(":");
      value.names.push_back(std::move(name));
      value.items.push_back(element(depth + 1));
      space();
      if (peek() == '}') { expect("}"); return; }
      expect(",");
    }
  }

  void entries(Json& value, int depth) {
    value.type = Json::list;
    expect("[");
    space();
    if (peek() == ']') { expect("]"); return; }
    while (true) {
      value.items.push_back(element(depth + 1));
      space();
      if (peek() == ']') { expect("]"); return; }
      expect(",");
    }
  }

  void digits() {
    if (!isdigit(static_cast<unsigned char>(peek())))
      refuse("no JSON at byte " + std::to_string(at_));
    while (isdigit(static_cast<unsigned char>(peek()))) ++at_;
  }

  void number(Json& value) {
    const size_t start = at_;
    if (peek() == '-') ++at_;
    if (peek() == '0') ++at_; else digits();
    if (peek() == '.') { ++at_; digits(); }
    if (peek() == 'e' || peek() == 'E') {
      ++at_;
      if (peek() == '+' || peek() == '-') ++at_;
      digits();
    }
    value.type = Json::number;
    value.string_value = text_.substr(start, at_ - start);
    const char* first = value.string_value.data();
    const auto end = std::from_chars(first, first + value.string_value.size(), value.number_value);
    if (end.ec != std::errc() || !(std::abs(value.number_value) < HUGE_VAL))
      refuse("the number " + value.string_value.substr(0, 40) + ", which no double is near");
  }

  unsigned hex4() {
    unsigned code = 0;
    for (int i = 0; i < 4; ++i, ++at_) {
      const char* place = peek() ? strchr("0123456789abcdef", tolower(peek())) : nullptr;
      if (!place) refuse("a broken escape in a JSON text");
      code = 16 * code + static_cast<unsigned>(place - "0123456789abcdef");
    }
    return code;
  }

  void utf8(string& out, unsigned code) {
    if (code < 0x80) {
      out += static_cast<char>(code);
    } else if (code < 0x800) {
      out += static_cast<char>(0xC0 | code >> 6);
      out += static_cast<char>(0x80 | (code & 63));
    } else if (code < 0x10000) {
      out += static_cast<char>(0xE0 | code >> 12);
      out += static_cast<char>(0x80 | (code >> 6 & 63));
      out += static_cast<char>(0x80 | (code & 63));
    } else {
      out += static_cast<char>(0xF0 | code >> 18);
      out += static_cast<char>(0x80 | (code >> 12 & 63));
      out += static_cast<char>(0x80 | (code >> 6 & 63));
      out += static_cast<char>(0x80 | (code & 63));
    }
  }

  string quoted() {
    expect("\"");
    string out;
    while (true) {
      if (at_ >= text_.size()) refuse("a JSON text without an end");
      const char c = text_[at_++];
      if (c == '"') {
        refuse_control_characters(out);
        return out;
      }
      if (static_cast<unsigned char>(c) < 0x20) refuse("a control character in a JSON text");
      if (c != '\\') { out += c; continue; }
      const char e = peek();
      ++at_;
      switch (e) {
        case '"': case '\\': case '/': out += e; break;
        case 'b': out += '\b'; break;
        case 'f': out += '\f'; break;
        case 'n': out += '\n'; break;
        case 'r': out += '\r'; break;
        case 't': out += '\t'; break;
        case 'u': {
          unsigned code = hex4();
          if (code >= 0xD800 && code < 0xDC00) {
            expect("\\u");
            const unsigned second = hex4();
            if (second < 0xDC00 || second > 0xDFFF) refuse("half a character in a JSON text");
            code = 0x10000 + ((code - 0xD800) << 10) + (second - 0xDC00);
          } else if (code >= 0xDC00 && code < 0xE000) {
            refuse("half a character in a JSON text");
          }
          utf8(out, code);
          break;
        }
        default: refuse("a broken escape in a JSON text");
      }
    }
  }
};

// An object with exactly these fields.
void only(const Json& table, const string& what, const vector<string>& names) {
  if (table.type != Json::object) refuse(what + " that is no JSON object");
  for (const string& name : names)
    if (!table.find(name)) refuse("no field '" + name + "' in " + what);
  for (const string& name : table.names)
    if (std::find(names.begin(), names.end(), name) == names.end())
      refuse("unknown field '" + name + "' in " + what);
}

const Json& field(const Json& table, const string& what, const string& name) {
  const Json* value = table.type == Json::object ? table.find(name) : nullptr;
  if (!value) refuse("no field '" + name + "' in " + what);
  return *value;
}

string text_of(const Json& value, const string& what) {
  if (value.type != Json::text) refuse(what + " that is no text");
  return value.string_value;
}

const vector<Json>& list_of(const Json& value, const string& what) {
  if (value.type != Json::list) refuse(what + " that is no list");
  return value.items;
}

// A list of different names.
vector<string> names_of(const Json& value, const string& what) {
  vector<string> names;
  for (const Json& item : list_of(value, what)) {
    names.push_back(text_of(item, "one of the " + what));
    if (std::count(names.begin(), names.end(), names.back()) > 1)
      refuse(names.back() + " twice among the " + what);
  }
  return names;
}

// A slash marks the premises of theorems: no condition and no region has one in its name.
void only_a_name(const string& name, const string& what) {
  if (name.empty() || name.front() == ' ' || name.back() == ' ')
    refuse("the name '" + name + "' of " + what + ", which is empty or ends in a space");
  if (name.size() > 200 || name.find("  ") != string::npos)
    refuse("the name '" + name.substr(0, 60) + "' of " + what + ", too long or with blanks in a row");
  if (name.find(',') != string::npos)
    refuse("the name '" + name + "' of " + what + ", which has a comma");
  if (name.find('/') != string::npos)
    refuse("the name '" + name + "' of " + what + ", which has a slash like a premise's");
}

double number_of(const Json& value, const string& what) {
  if (value.type != Json::number) refuse(what + " that is no number");
  return value.number_value;
}

int integer_of(const Json& value, const string& what) {
  const string& digits = value.string_value;
  if (value.type != Json::number || digits.size() > 9 ||
      digits.find_first_not_of("-0123456789") != string::npos)
    refuse(what + " that is no whole number");
  return static_cast<int>(value.number_value);
}

// [-]0x1.8p+3 and the like: at most 53 bits, so the double is exact.
double hexadecimal(const Json& value, const string& what) {
  const string text = text_of(value, what);
  const string wrong = what + " '" + text.substr(0, 40) + "' instead of a hexadecimal number";
  size_t at = 0;
  const bool negative = at < text.size() && text[at] == '-';
  if (negative) ++at;
  if (text.compare(at, 2, "0x") != 0) refuse(wrong);
  at += 2;
  if (at >= text.size() || (text[at] != '0' && text[at] != '1')) refuse(wrong);
  std::uint64_t bits = text[at++] == '1';
  int exponent = 0, count = 0;
  if (at < text.size() && text[at] == '.') {
    for (++at; at < text.size() && text[at] != 'p'; ++at, ++count, exponent -= 4) {
      const char c = text[at];
      const bool known = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
      if (!known || count == 13) refuse(wrong);
      bits = bits << 4 | static_cast<std::uint64_t>(c <= '9' ? c - '0' : c - 'a' + 10);
    }
    if (count == 0) refuse(wrong);
  }
  if (at >= text.size() || text[at] != 'p') refuse(wrong);
  ++at;
  int sign = 1, power = 0;
  if (at < text.size() && (text[at] == '+' || text[at] == '-')) sign = text[at++] == '-' ? -1 : 1;
  if (at >= text.size() || text.size() - at > 4) refuse(wrong);
  for (; at < text.size(); ++at) {
    if (text[at] < '0' || text[at] > '9') refuse(wrong);
    power = 10 * power + (text[at] - '0');
  }
  exponent += sign * power;
  const double mantissa = static_cast<double>(bits), found = std::ldexp(mantissa, exponent);
  if (!(found < HUGE_VAL) || std::ldexp(found, -exponent) != mantissa) refuse(wrong);
  return negative ? -found : found;
}

vector<unsigned char> base64(const string& text, const string& what) {
  static const string alphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const string wrong = what + " whose data are no base64";
  if (text.size() % 4 != 0) refuse(wrong);
  vector<unsigned char> out;
  for (size_t start = 0; start < text.size(); start += 4) {
    std::uint32_t bits = 0;
    int padding = 0;
    for (size_t i = 0; i < 4; ++i) {
      const char c = text[start + i];
      const size_t place = alphabet.find(c);
      const bool last = start + 4 == text.size();
      if (c == '=' && last && i >= 2) ++padding;
      else if (place == string::npos || padding) refuse(wrong);
      bits = bits << 6 | static_cast<std::uint32_t>(c == '=' ? 0 : place);
    }
    if (padding && (bits & (padding == 1 ? 0xFFu : 0xFFFFu))) refuse(wrong);
    for (int i = 0; i < 3 - padding; ++i)
      out.push_back(static_cast<unsigned char>(bits >> (16 - 8 * i)));
  }
  return out;
}

// FIPS 180-4.
string sha256(const string& message) {
  static const std::uint32_t k[64] = {
      0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4,
      0xab1c5ed5, 0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe,
      0x9bdc06a7, 0xc19bf174, 0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f,
      0x4a7484aa, 0x5cb0a9dc, 0x76f988da, 0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7,
      0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967, 0x27b70a85, 0x2e1b2138, 0x4d2c6dfc,
      0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85, 0xa2bfe8a1, 0xa81a664b,
      0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070, 0x19a4c116,
      0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
      0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7,
      0xc67178f2};
  std::uint32_t h[8] = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                        0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  const auto turn = [](std::uint32_t x, int n) { return x >> n | x << (32 - n); };
  string data = message + '\x80';
  while (data.size() % 64 != 56) data += '\0';
  for (int i = 7; i >= 0; --i)
    data += static_cast<char>(static_cast<std::uint64_t>(message.size()) * 8 >> (8 * i) & 255);
  for (size_t start = 0; start < data.size(); start += 64) {
    std::uint32_t w[64];
    for (size_t i = 0; i < 16; ++i) {
      w[i] = 0;
      for (size_t b = 0; b < 4; ++b)
        w[i] = w[i] << 8 | static_cast<unsigned char>(data[start + 4 * i + b]);
    }
    for (int i = 16; i < 64; ++i)
      w[i] = w[i - 16] + (turn(w[i - 15], 7) ^ turn(w[i - 15], 18) ^ w[i - 15] >> 3) + w[i - 7] +
             (turn(w[i - 2], 17) ^ turn(w[i - 2], 19) ^ w[i - 2] >> 10);
    std::uint32_t v[8];
    std::copy(h, h + 8, v);
    for (int i = 0; i < 64; ++i) {
      const std::uint32_t a = v[7] + (turn(v[4], 6) ^ turn(v[4], 11) ^ turn(v[4], 25)) +
                              ((v[4] & v[5]) ^ (~v[4] & v[6])) + k[i] + w[i];
      const std::uint32_t b = (turn(v[0], 2) ^ turn(v[0], 13) ^ turn(v[0], 22)) +
                              ((v[0] & v[1]) ^ (v[0] & v[2]) ^ (v[1] & v[2]));
      for (int j = 7; j > 0; --j) v[j] = v[j - 1];
      v[4] += a;
      v[0] = a + b;
    }
    for (int i = 0; i < 8; ++i) h[i] += v[i];
  }
  char out[65];
  for (int i = 0; i < 8; ++i) snprintf(out + 8 * i, 9, "%08x", h[i]);
  return out;
}

// A JSON text in ASCII: everything else as \uXXXX.
void ascii(const string& text, string& out) {
  out += '"';
  for (size_t at = 0; at < text.size();) {
    const unsigned char c = static_cast<unsigned char>(text[at++]);
    const int more = c < 0xC0 ? 0 : c < 0xE0 ? 1 : c < 0xF0 ? 2 : 3;
    unsigned code = more ? c & (63u >> more) : c;
    for (int i = 0; i < more; ++i) {
      if (at >= text.size()) refuse("a text that is no UTF-8");
      code = code << 6 | (static_cast<unsigned char>(text[at++]) & 63u);
    }
    static const std::map<unsigned, string> known = {{'"', "\\\""}, {'\\', "\\\\"}, {8, "\\b"},
        {9, "\\t"}, {10, "\\n"}, {12, "\\f"}, {13, "\\r"}};
    char escape[16];
    if (const auto found = known.find(code); found != known.end()) out += found->second;
    else if (code >= 0x20 && code < 0x7F) out += static_cast<char>(code);
    else if (code < 0x10000) { snprintf(escape, sizeof escape, "\\u%04x", code); out += escape; }
    else {
      snprintf(escape, sizeof escape, "\\u%04x\\u%04x", 0xD800 + ((code - 0x10000) >> 10 & 0x3FF),
               0xDC00 + ((code - 0x10000) & 0x3FF));
      out += escape;
    }
  }
  out += '"';
}

// The text that the Program's hash is of: names sorted, no spaces, ASCII.
void canonical(const Json& value, string& out) {
  switch (value.type) {
    case Json::null: out += "null"; break;
    case Json::boolean: out += value.number_value != 0.0 ? "true" : "false"; break;
    case Json::number:
      integer_of(value, "a number of the Program");
      out += value.string_value;
      break;
    case Json::text:
      ascii(value.string_value, out);
      break;
    case Json::list:
      out += '[';
      for (size_t i = 0; i < value.items.size(); ++i) {
        if (i) out += ',';
        canonical(value.items[i], out);
      }
      out += ']';
      break;
    case Json::object: {
      std::map<string, const Json*> sorted;
      for (size_t i = 0; i < value.names.size(); ++i) sorted[value.names[i]] = &value.items[i];
      out += '{';
      for (const auto& [name, item] : sorted) {
        if (out.back() != '{') out += ',';
        ascii(name, out);
        out += ':';
        canonical(*item, out);
      }
      out += '}';
    }
  }
}

// The shortest decimal that is this double.
string brief(double x) {
  char text[40];
  return string(text, std::to_chars(text, text + sizeof text, x).ptr);
}

// ------------------------------------------------------------------------------ 6 the model

struct Array {
  vector<int> shape;
  vector<double> values;
};

using Constants = std::map<string, Array>;  // The Program's named constants.

size_t elements(const vector<int>& shape) {
  size_t count = 1;
  for (const int size : shape) count *= static_cast<size_t>(size);
  return count;
}

vector<int> shape_of(const Json& value, const string& what) {
  vector<int> shape;
  for (const Json& size : list_of(value, "the shape of " + what)) {
    shape.push_back(integer_of(size, "the shape of " + what));
    if (shape.back() < 1 || shape.back() > 1'000'000 || elements(shape) > 100'000'000)
      refuse("the shape of " + what + " with a size that no array here has");
  }
  return shape;
}

// Arrays of one owner, "policy" or "tube": given as numbers, or as constants of the Program.
std::map<string, Array> arrays_of(const Json& table, const string& owner, const Constants& known) {
  std::map<string, Array> found;
  for (size_t i = 0; i < table.names.size(); ++i) {
    const string name = owner + "." + table.names[i];
    const Json& entry = table.items[i];
    if (entry.type == Json::null) continue;
    Array array;
    const auto constant = known.find(name);
    if (entry.find("constant")) {
      only(entry, name, {"constant"});
      if (text_of(entry.items[0], name) != name || constant == known.end())
        throw Inconsistent{"the model's " + name + " is no constant of the Program"};
      array = constant->second;
    } else {
      only(entry, name, {"shape", "values"});
      array.shape = shape_of(field(entry, name, "shape"), name);
      for (const Json& value : list_of(field(entry, name, "values"), name))
        array.values.push_back(hexadecimal(value, name));
      if (array.values.size() != elements(array.shape)) refuse(name + " of another size");
      if (constant != known.end() && (constant->second.shape != array.shape ||
                                      constant->second.values != array.values))
        throw Inconsistent{"the model's " + name + " is not that of the Program"};
    }
    found[table.names[i]] = array;
  }
  return found;
}

const Array& array(const std::map<string, Array>& table, const string& name, vector<int> shape) {
  const auto found = table.find(name);
  if (found == table.end()) refuse("no array '" + name + "' in the model");
  if (found->second.shape != shape) refuse("the model's array '" + name + "' in another shape");
  return found->second;
}

// along e + across (e turned a quarter counter-clockwise), e a link's direction.
struct Complex {
  I along, across;
  bool zero() const { return magnitude(along) == 0.0 && magnitude(across) == 0.0; }
};
using Row = vector<Complex>;  // A point of the robot: sum over links of a Complex times e.

struct Robot {
  int links = 0;  // n: stance leg upwards, torso if there is one, swing leg downwards.
  int leg = 0;    // Links of a leg.
  bool torso = false;
  vector<I> mass, inertia;       // Of the links.
  vector<Row> centre;            // Centres of mass.
  Row hip, foot, moment;         // Hip, swing foot, and mass times centre of mass of the whole.
  I weight_mass, gravity;        // Total mass, g.
  vector<I> armature, damping;   // Of the n coordinates; the first has none.
  vector<I> torque_limit;        // Of the n - 1 joints.
  vector<I> hip_gradient;        // c: z1 = c q.
  string name;
  vector<string> words;          // Every number of the file about it, a line each part.

  int joints() const { return links - 1; }
  // d theta_k / d q_j: angles add up the stance leg and over its hip, and subtract down the other.
  int turn(int k, int j) const { return j > k ? 0 : j > links / 2 ? -1 : 1; }
};

Complex times(I k, const Complex& c) { return {k * c.along, k * c.across}; }

// A link in words, with the joint at its upper end if it has one.
string link_words(const Json& link) {
  const auto number = [&link](const char* name) {
    return brief(hexadecimal(field(link, "a link", name), string(name) + " of a link"));
  };
  string words = number("mass") + " kg, centre of mass " + number("along") + " m along and " +
                 number("across") + " m across, inertia " + number("inertia") + " kg m^2";
  if (!link.find("length")) return words;
  return number("length") + " m long, " + words + "; joint above it: rotor " + number("armature") +
         " kg m^2, damping " + number("damping") + " N m s/rad, torque limit " +
         number("torque_limit") + " N m, range " + number("lower") + " to " + number("upper") +
         " rad";
}

Robot robot_of(const Json& table) {
  only(table, "the robot", {"name", "leg", "torso", "gravity", "friction", "foot_radius"});
  const vector<Json>& leg = list_of(field(table, "the robot", "leg"), "the leg");
  const Json& trunk = field(table, "the robot", "torso");
  if (leg.empty() || leg.size() > 3) refuse("a leg of " + std::to_string(leg.size()) + " links");
  for (const Json& link : leg)
    only(link, "a link", {"length", "mass", "inertia", "armature", "damping", "torque_limit",
                          "lower", "upper", "along", "across"});
  const auto number = [](const Json& link, const char* name) {
    return I(hexadecimal(field(link, "a link", name), string(name) + " of a link"));
  };
  const auto at_least = [](I value, bool strictly, const char* what) {
    if (!(strictly ? value.low() > 0.0 : value.low() >= 0.0)) refuse(what);
    return value;
  };
  Robot r;
  r.leg = static_cast<int>(leg.size());
  r.torso = trunk.type != Json::null;
  r.links = 2 * r.leg + r.torso;
  r.name = text_of(field(table, "the robot", "name"), "the robot's name");
  r.gravity = at_least(number(table, "gravity"), true, "a gravity that is not positive");
  const I friction = at_least(number(table, "friction"), false, "a friction that is negative");
  const I radius = at_least(number(table, "foot_radius"), false, "a foot of negative radius");
  r.words.push_back("gravity " + brief(r.gravity.low()) + " m/s^2, friction of the feet " +
                    brief(friction.low()) + ", radius of the feet " + brief(radius.low()) + " m");
  const auto n = static_cast<size_t>(r.links);
  r.mass.resize(n);
  r.inertia.resize(n);
  r.centre.assign(n, Row(n));
  r.armature.assign(n, I(0.0));
  r.damping.assign(n, I(0.0));
  r.torque_limit.assign(n - 1, I(0.0));

  // Walk from the stance foot up to the hip and down to the swing foot; `here` is the joint.
  Row here(n);
  const auto fill = [&](size_t k, const Json& link) {
    r.mass[k] = at_least(number(link, "mass"), true, "a link whose mass is not positive");
    r.inertia[k] = at_least(number(link, "inertia"), false, "a link of negative inertia");
    r.centre[k] = here;
    r.centre[k][k].along = r.centre[k][k].along + number(link, "along");
    r.centre[k][k].across = number(link, "across");
  };
  for (size_t k = 0; k < leg.size(); ++k) {
    fill(k, leg[k]);
    if (!(number(leg[k], "lower").low() <= number(leg[k], "upper").low()))
      refuse("a joint whose range ends before it begins");
    r.words.push_back("link " + std::to_string(k + 1) + " of each leg, from the foot up: " +
                      link_words(leg[k]));
    here[k].along = at_least(number(leg[k], "length"), true, "a link without length");
  }
  r.hip = here;
  if (r.torso) {
    only(trunk, "the torso", {"mass", "inertia", "along", "across"});
    fill(leg.size(), trunk);
    r.words.push_back("torso: " + link_words(trunk));
  }
  for (size_t i = leg.size(); i-- > 0;) {
    const size_t k = n - 1 - i;
    here[k].along = -number(leg[i], "length");  // To the link's lower end, where it is seen from.
    fill(k, leg[i]);
  }
  r.foot = here;

  r.moment = Row(n);
  for (size_t i = 0; i < n; ++i) {
    r.weight_mass = r.weight_mass + r.mass[i];
    for (size_t k = 0; k < n; ++k) {
      const Complex part = times(r.mass[i], r.centre[i][k]);
      r.moment[k] = {r.moment[k].along + part.along, r.moment[k].across + part.across};
    }
  }
  // Joint j of a leg is above link j; the hip is its last. Without a torso the hips are one joint.
  for (size_t j = 1; j < n; ++j) {
    const size_t i = j <= leg.size() ? j - 1 : n - 1 - j;
    r.armature[j] = at_least(number(leg[i], "armature"), false, "a negative armature");
    r.damping[j] = at_least(number(leg[i], "damping"), false, "a negative damping");
    r.torque_limit[j - 1] =
        at_least(number(leg[i], "torque_limit"), true, "a torque limit that is not positive");
  }
  // The hip is at -sum l_k sin theta_k: linearised in q.
  r.hip_gradient.assign(n, I(0.0));
  for (int j = 0; j < r.links; ++j)
    for (int k = 0; k < r.leg; ++k)
      if (r.turn(k, j)) r.hip_gradient[j] = r.hip_gradient[j] - I(r.turn(k, j)) * r.hip[k].along;
  return r;
}

struct Layer {
  int rows = 0, columns = 0;
  vector<double> weights, biases;  // [rows, columns], [rows]
};

struct Policy {
  bool hybrid_invariant = false;  // Else the network alone.
  bool softplus = false;          // Else tanh.
  bool z2_dependence = true;
  vector<Layer> layers;
  vector<double> lower, upper, scale, shift;
  double start = 0.0, guard = 0.0;  // z1 after the impact and at the guard.
  vector<double> cubic;             // [4, m]
};

Policy policy_of(const Json& table, int joints, const Constants& constants) {
  only(table, "the policy", {"kind", "activation", "layers", "z2_dependence", "arrays"});
  const auto text = [&](const char* name) {
    return text_of(field(table, "the policy", name), string("the policy's ") + name);
  };
  Policy p;
  if (text("kind") == "HybridInvariantPolicy") p.hybrid_invariant = true;
  else if (text("kind") != "MLPPolicy") throw Unknown{"a policy of the kind " + text("kind")};
  if (text("activation") == "softplus") p.softplus = true;
  else if (text("activation") != "tanh") throw Unknown{"the activation " + text("activation")};
  const Json& dependence = field(table, "the policy", "z2_dependence");
  if (dependence.type != Json::boolean) refuse("z2_dependence that is neither true nor false");
  p.z2_dependence = dependence.number_value != 0.0;
  const auto arrays = arrays_of(field(table, "the policy", "arrays"), "policy", constants);
  size_t used = 6;
  p.lower = array(arrays, "lower", {joints}).values;
  p.upper = array(arrays, "upper", {joints}).values;
  p.scale = array(arrays, "input_scale", {2}).values;
  p.shift = array(arrays, "input_shift", {2}).values;
  if (p.hybrid_invariant) {
    p.guard = array(arrays, "z_guard", {}).values[0];
    p.start = array(arrays, "z_start", {}).values[0];
    p.cubic = array(arrays, "cubic", {4, joints}).values;
    used = 7;
  } else {
    const vector<double>& ends = array(arrays, "start_and_guard", {2}).values;
    p.start = ends[0];
    p.guard = ends[1];
    used = 5;
  }
  const int depth = integer_of(field(table, "the policy", "layers"), "the number of layers");
  if (depth < 1 || depth > 50) refuse("a network of " + std::to_string(depth) + " layers");
  int columns = 2;
  for (int i = 0; i < depth; ++i, used += 2) {
    const string place = "[" + std::to_string(i) + "]";
    const auto found = arrays.find("network.weights" + place);
    if (found == arrays.end() || found->second.shape.size() != 2)
      refuse("no array 'network.weights" + place + "' in the model");
    Layer layer;
    layer.rows = i + 1 == depth ? joints : found->second.shape[0];
    layer.columns = columns;
    layer.weights = array(arrays, "network.weights" + place, {layer.rows, columns}).values;
    layer.biases = array(arrays, "network.biases" + place, {layer.rows}).values;
    columns = layer.rows;
    p.layers.push_back(layer);
  }
  if (used != arrays.size()) refuse("arrays of the policy that its kind does not have");
  return p;
}

struct Tube {
  vector<double> lower, upper;  // Chebyshev coefficients of zeta = z2^2/2 over the phase.
  double unit = 1.0, start = 0.0, guard = 0.0;  // z1 at phase 0 and 1.
};

Tube tube_of(const Json& table, const Policy& policy, const Constants& constants) {
  only(table, "the tube", {"lower", "upper", "unit", "span"});
  const auto arrays = arrays_of(table, "tube", constants);
  Tube t;
  for (const char* side : {"lower", "upper"}) {
    const auto found = arrays.find(side);
    if (found == arrays.end() || found->second.shape.size() != 1)
      refuse(string("no series '") + side + "' in the tube");
    (string(side) == "lower" ? t.lower : t.upper) = found->second.values;
  }
  t.unit = array(arrays, "unit", {}).values[0];
  t.start = policy.start;
  t.guard = policy.guard;
  if (arrays.count("span")) {
    t.start = array(arrays, "span", {2}).values[0];
    t.guard = array(arrays, "span", {2}).values[1];
  }
  return t;
}

struct Model {
  Robot robot;
  Policy policy;
  Tube tube;
};

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

// ------------------------------------------------------------------------------ 8 mechanics
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
Vec<S> quarter(const Vec<S>& a) { return {-a.z, a.x}; }  // Turned counter-clockwise.
template <class S>
S dot(const Vec<S>& a, const Vec<S>& b) { return a.x * b.x + a.z * b.z; }
template <class S>
S cross(const Vec<S>& a, const Vec<S>& b) { return a.x * b.z - a.z * b.x; }

template <class S>
Vec<S> times(const Complex& k, const Vec<S>& a) {
  Vec<S> r{k.along * a.x, k.along * a.z};
  if (magnitude(k.across) == 0.0) return r;
  return r + Vec<S>{-(k.across * a.z), k.across * a.x};
}

// Sum over links of row[k] times directions[k].
template <class S>
Vec<S> point(const Row& row, const vector<Vec<S>>& directions) {
  Vec<S> sum{S(0.0), S(0.0)};
  for (size_t k = 0; k < row.size(); ++k)
    if (!row[k].zero()) sum = sum + times(row[k], directions[k]);
  return sum;
}

// T q: absolute link angles, or their rates, from coordinates.
template <class S>
vector<S> turned(const Robot& robot, const vector<S>& q) {
  vector<S> theta(q.size(), S(0.0));
  theta[0] = q[0];
  for (size_t k = 1; k < q.size(); ++k)
    theta[k] = robot.turn(int(k), int(k)) > 0 ? theta[k - 1] + q[k] : theta[k - 1] - q[k];
  return theta;
}

// The inverse: coordinates from absolute angles.
template <class S>
vector<S> unturned(const Robot& robot, const vector<S>& theta) {
  vector<S> q(theta.size(), S(0.0));
  q[0] = theta[0];
  for (size_t k = 1; k < q.size(); ++k)
    q[k] = robot.turn(int(k), int(k)) > 0 ? theta[k] - theta[k - 1] : theta[k - 1] - theta[k];
  return q;
}

// Generalised forces in q from moments about the links: T' times them.
template <class S>
vector<S> gathered(const Robot& robot, const vector<S>& moments) {
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
  const Robot& robot;
  vector<S> q, theta;
  vector<Vec<S>> e;       // Directions of the links, (-sin, cos).
  vector<Vec<S>> centre;  // Of mass, of each link.

  Pose(const Robot& r, vector<S> coordinates)
      : robot(r), q(std::move(coordinates)), theta(turned(r, q)) {
    for (const S& angle : theta) {
      S sine, cosine;
      sincos(angle, sine, cosine);
      e.push_back({-sine, cosine});
    }
    for (const Row& row : robot.centre) centre.push_back(point(row, e));
  }

  // Rates of the directions, for link rates w.
  vector<Vec<S>> spin(const vector<S>& w) const {
    vector<Vec<S>> out;
    for (size_t k = 0; k < e.size(); ++k) out.push_back(scaled(w[k], quarter(e[k])));
    return out;
  }

  // Angular momentum about `pivot`, counter-clockwise, of links that turn at w while the stance
  // foot stands still.
  S momentum(const vector<S>& w, const Vec<S>* pivot = nullptr) const {
    const auto moving = spin(w);
    S sum(0.0);
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
        const Complex& arm = robot.centre[i][k];
        // (arm e)' . f = quarter(e) . conjugate(arm) f
        if (!arm.zero()) sum = sum + times(Complex{arm.along, -arm.across}, forces[i]);
      }
      out[k] = out[k] + dot(quarter(e[k]), sum);
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
    vector<S> found = gathered(robot, moments(linear, angular));
    const vector<S> rates = unturned(robot, w);
    for (size_t j = 0; j < found.size(); ++j) found[j] = found[j] + robot.armature[j] * rates[j];
    return found;
  }

  vector<Vec<S>> velocities(const vector<S>& w) const {
    const auto moving = spin(w);
    vector<Vec<S>> out;
    for (const Row& row : robot.centre) out.push_back(point(row, moving));
    return out;
  }
};

// y_d and its first derivatives.
template <class S>
struct Outputs {
  vector<S> y, d1, d2;
};

Outputs<TM> first_order(const vector<Jet>& jets) {
  Outputs<TM> out;
  for (const Jet& jet : jets) {
    out.y.push_back(jet.c[0]);
    out.d1.push_back(jet.c[1]);
    out.d2.push_back(jet.c[2]);
  }
  return out;
}

Outputs<TM> outputs_at(const Policy& policy, const TM& z1, const TM& z2) {
  return first_order(desired_outputs(policy, z1, z2, 1));
}

Outputs<Dual> along(const vector<Jet>& jets, const TM& dz1, const TM& dz2) {
  Outputs<Dual> out;
  for (const Jet& jet : jets) {
    out.y.push_back({jet.c[0], jet.c[1] * dz1 + jet.c[2] * dz2});
    out.d1.push_back({jet.c[1], jet.c[3] * dz1 + jet.c[4] * dz2});
    out.d2.push_back({jet.c[2], jet.c[4] * dz1 + jet.c[5] * dz2});
  }
  return out;
}

Outputs<Dual> outputs_at(const Policy& policy, const Dual& z1, const Dual& z2) {
  return along(desired_outputs(policy, z1.v, z2.v, 2), z1.d, z2.d);
}

// Everything is computed when first asked for, and kept only once it is complete: an operation
// without a bound leaves nothing behind.
template <class S>
class Motion {
 public:
  const Model& model;
  const Robot& robot;
  const S z1, z2;

  Motion(const Model& m, S first, S second, std::optional<Outputs<S>> known = {})
      : model(m), robot(m.robot), z1(std::move(first)), z2(std::move(second)),
        outputs_(std::move(known)) {}

  const Outputs<S>& outputs() {
    if (!outputs_) outputs_ = outputs_at(model.policy, z1, z2);
    return *outputs_;
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
    if (!pose_) pose_.emplace(robot, lifted(z1, outputs().y));
    return *pose_;
  }

  // Link rates per unit of dz1 and of dz2.
  const vector<S>& per_dz1() {
    if (!along1_) along1_ = turned(robot, lifted(S(I(1.0)), outputs().d1));
    return *along1_;
  }
  const vector<S>& per_dz2() {
    if (!along2_) along2_ = turned(robot, lifted(S(I(0.0)), outputs().d2));
    return *along2_;
  }

  // dz2: moment of the weight about the stance foot.
  const S& dz2() {
    if (!dz2_) dz2_ = robot.gravity * point(robot.moment, pose().e).x;
    return *dz2_;
  }

  // Angular momentum per dz1: J s, negative in forward walking.
  const S& transversal() {
    if (!transversal_) transversal_ = pose().momentum(per_dz1());
    return *transversal_;
  }

  // dz1: with z2 = -(momentum per dz1) dz1 - (momentum per dz2) dz2.
  const S& dz1() {
    if (!dz1_) dz1_ = -(z2 + pose().momentum(per_dz2()) * dz2()) / transversal();
    return *dz1_;
  }

  // Rates of the links, and of the coordinates.
  const vector<S>& w() {
    if (!w_) {
      vector<S> rates;
      for (size_t k = 0; k < per_dz1().size(); ++k)
        rates.push_back(per_dz1()[k] * dz1() + per_dz2()[k] * dz2());
      w_ = rates;
    }
    return *w_;
  }
  const vector<S>& dq() {
    if (!dq_) dq_ = unturned(robot, w());
    return *dq_;
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
  Vec<S> hip() { return point(robot.hip, pose().e); }
  Vec<S> hip_velocity() { return point(robot.hip, spin()); }

  // ---- after an impact in this state: the legs have swapped roles.
  const vector<S>& theta_after() {
    if (!theta_after_) {
      theta_after_ = pose().theta;
      std::reverse(theta_after_->begin(), theta_after_->end());
    }
    return *theta_after_;
  }

  S hip_after() {
    const vector<S> q = unturned(robot, theta_after());
    S sum(0.0);
    for (size_t j = 0; j < q.size(); ++j)
      if (magnitude(robot.hip_gradient[j]) != 0.0) sum = sum + robot.hip_gradient[j] * q[j];
    return sum;
  }

  // Angular momentum about the new stance foot is kept.
  S z2_after() {
    const Vec<S> pivot = foot();
    return -pose().momentum(w(), &pivot);
  }

  Motion& after() {
    if (!after_) after_ = std::make_unique<Motion>(model, hip_after(), z2_after());
    return *after_;
  }

  struct Impact {
    Pose<S> pose;
    vector<S> w, dq;  // Rates of links and coordinates after it.
    Vec<S> impulse;   // Of the ground on the new stance foot.
  };

  // Plastic impact: the old stance foot is free, the impulse acts at the new one, so momenta
  // conjugate to coordinates about the new foot are kept; the new foot stands still after it.
  const Impact& impact() {
    if (impact_) return *impact_;
    Pose<S> pose_after(robot, unturned(robot, theta_after()));
    vector<Vec<S>> before = pose().velocities(w());
    std::reverse(before.begin(), before.end());
    vector<S> w_before = w();
    std::reverse(w_before.begin(), w_before.end());
    const vector<S> kept = pose_after.momenta(before, w_before);
    // Columns of the mass matrix: momenta for unit rates of the coordinates.
    const size_t n = kept.size();
    vector<vector<S>> mass(n, vector<S>(n, S(0.0)));
    for (size_t j = 0; j < n; ++j) {
      vector<S> unit(n, S(0.0));
      unit[j] = S(I(1.0));
      const vector<S> turning = turned(robot, unit);
      const vector<S> column = pose_after.momenta(pose_after.velocities(turning), turning);
      for (size_t i = 0; i < n; ++i) mass[i][j] = column[i];
    }
    const vector<S> rates = solved(mass, kept);
    const vector<S> turning = turned(robot, rates);
    const vector<Vec<S>> later = pose_after.velocities(turning);
    Vec<S> impulse{S(0.0), S(0.0)};
    for (size_t i = 0; i < n; ++i) {
      const Vec<S> change = later[i] - before[i];
      impulse = impulse + Vec<S>{robot.mass[i] * change.x, robot.mass[i] * change.z};
    }
    impact_ = std::make_unique<Impact>(Impact{pose_after, turning, rates, impulse});
    return *impact_;
  }

  // ---- what needs accelerations: only for S = TM.
  struct Forces {
    vector<S> torque;  // Of the joints.
    Vec<S> ground;     // On the stance foot.
  };
  const Forces& forces();

  // The same state, with derivatives along (dz1, dz2) of direction.
  Motion<Dual> moving(const TM& first, const TM& second);
  // Along the flow.
  Motion<Dual>& flow();
  // Desired outputs with their second derivatives.
  const vector<Jet>& jets();

 private:
  std::optional<Outputs<S>> outputs_;
  std::optional<Pose<S>> pose_;
  std::optional<vector<S>> along1_, along2_, w_, dq_, theta_after_;
  std::optional<S> dz1_, dz2_, transversal_;
  std::optional<vector<Vec<S>>> spin_;
  std::unique_ptr<Motion> after_;
  std::unique_ptr<Impact> impact_;
  std::unique_ptr<Motion<Dual>> flow_;
  std::optional<Forces> forces_;
  std::optional<vector<Jet>> jets_;
};

template <>
const vector<Jet>& Motion<TM>::jets() {
  if (!jets_) {
    jets_ = desired_outputs(model.policy, z1, z2, 2);
    outputs_ = first_order(*jets_);
  }
  return *jets_;
}

template <>
Motion<Dual> Motion<TM>::moving(const TM& first, const TM& second) {
  return {model, Dual(z1, first), Dual(z2, second), along(jets(), first, second)};
}

template <>
Motion<Dual>& Motion<TM>::flow() {
  jets();  // Before the rates ask for the outputs' first derivatives alone.
  if (!flow_) flow_ = std::make_unique<Motion<Dual>>(moving(dz1(), dz2()));
  return *flow_;
}

template <>
const Motion<TM>::Forces& Motion<TM>::forces() {
  if (forces_) return *forces_;
  const vector<Dual>& rates = flow().w();
  // Accelerations of the directions: quarter(e) dw - e w^2.
  const Pose<TM>& p = pose();
  vector<Vec<TM>> turning, push;
  vector<TM> couples;
  for (size_t k = 0; k < rates.size(); ++k) {
    const TM fast = rates[k].v * rates[k].v;
    turning.push_back(scaled(rates[k].d, quarter(p.e[k])) - scaled(fast, p.e[k]));
    couples.push_back(robot.inertia[k] * rates[k].d);
  }
  // Mass times (acceleration plus gravity) of each link: what ground and joints must bring up.
  Vec<TM> ground{TM(0.0), TM(0.0)};
  for (size_t i = 0; i < rates.size(); ++i) {
    Vec<TM> a = point(robot.centre[i], turning);
    a.z = a.z + TM(robot.gravity);
    push.push_back({robot.mass[i] * a.x, robot.mass[i] * a.z});
    ground = ground + push.back();
  }
  const vector<TM> needed = gathered(robot, p.moments(push, couples));
  const vector<Dual>& joint_rates = flow().dq();
  vector<TM> torque;
  for (size_t j = 1; j < needed.size(); ++j)
    torque.push_back(needed[j] + robot.armature[j] * joint_rates[j].d +
                     robot.damping[j] * joint_rates[j].v);
  forces_ = Forces{torque, ground};
  return *forces_;
}

template <>
const Motion<Dual>::Forces& Motion<Dual>::forces() {
  throw Unknown{"a rate of forces"};
}

// ---- the tube's chart: phase and level of a state.

template <class S>
struct Fences {
  S lower, upper;  // zeta = z2^2 / 2
};

// Chebyshev polynomials T_0 to T_(count - 1) of 2 phase - 1. As T_(m+n) = 2 T_m T_n - T_(m-n) with
// m and n near half: one by one, an error would grow with the powers of 1 + sqrt 2.
template <class S>
vector<S> chebyshev(const S& phase, size_t count) {
  vector<S> t = {S(I(1.0)), I(2.0) * phase - S(I(1.0))};
  while (t.size() < count) {
    const size_t m = (t.size() + 1) / 2, n = t.size() / 2;
    t.push_back(I(2.0) * (t[m] * t[n]) - t[m - n]);
  }
  return t;
}

// A series' value.
template <class S>
S sum(const vector<double>& series, const vector<S>& polynomials) {
  S total(0.0);
  for (size_t k = 0; k < series.size(); ++k) total = total + I(series[k]) * polynomials[k];
  return total;
}

template <class S>
Fences<S> fences(const Tube& tube, const S& phase) {
  const auto t = chebyshev(phase, std::max(tube.lower.size(), tube.upper.size()));
  return {I(tube.unit) * sum(tube.lower, t), I(tube.unit) * sum(tube.upper, t)};
}

template <class S>
S phase_of(const Tube& tube, const S& z1) {
  return inverse(I(tube.guard) - I(tube.start)) * (z1 - S(I(tube.start)));
}

template <class S>
S level_of(const Tube& tube, const S& z1, const S& z2) {
  const Fences<S> f = fences(tube, phase_of(tube, z1));
  return (I(0.5) * (z2 * z2) - f.lower) / (f.upper - f.lower);
}

// The state at a phase of the step, zeta given; and at a box of a tube's chart.
Motion<TM> state_of(const Model& model, const TM& phase, const TM& zeta) {
  const Tube& tube = model.tube;
  const TM z1 = TM(tube.start) + (I(tube.guard) - I(tube.start)) * phase;
  return {model, z1, root(I(2.0) * zeta)};
}

Motion<TM> state_at(const Model& model, const Tube& tube, const TM& phase, const TM& level) {
  const Fences<TM> f = fences(tube, phase);
  return state_of(model, phase, f.lower + level * (f.upper - f.lower));
}

// ----------------------------------------------------------------------------- 9 conditions
//
// A quantity is a function of a state, as the model names it; a condition turns it into margins
// that must not be negative. What a user has written is not known here.

struct Quantity {
  string name, side;
  std::map<string, double> numbers;
  vector<double> bound, sides, centre;
  vector<int> joints;
  std::shared_ptr<Quantity> of;

  double number(const char* key) const { return numbers.at(key); }
};

struct Meaning { const char* words; const char* unit; };

// Quantities without numbers.
const std::map<string, Meaning>& plain_quantities() {
  static const std::map<string, Meaning> table = {
      {"torso_angle", {"torso angle, backwards positive", "rad"}},
      {"joint_angles", {"joint angles", "rad"}},
      {"joint_rates", {"joint rates", "rad/s"}},
      {"torques", {"joint torques", "N m"}},
      {"normal_force", {"normal ground force", "N"}},
      {"foot_height", {"swing-foot height", "m"}},
      {"foot_forward", {"swing foot ahead of the stance foot", "m"}},
      {"foot_vertical_velocity", {"vertical swing-foot velocity", "m/s"}},
      {"hip_height", {"hip height", "m"}},
      {"hip_forward", {"hip ahead of the stance foot", "m"}},
      {"hip_speed", {"forward hip velocity", "m/s"}},
      {"forward_rate", {"rate of the linearised hip position z1", "m/s"}},
      {"transversal_inertia", {"transversal inertia -J s", "kg m"}},
      {"hip_state", {"linearised hip position z1", "m"}},
      {"momentum", {"angular momentum z2", "kg m^2/s"}},
      {"reset_hip_sum", {"z1 after the reset plus z1 before", "m"}},
      {"reset_hip", {"z1 after the reset", "m"}},
      {"output_mismatch", {"outputs after the impact", "rad"}},
      {"squared_mismatch", {"minus the squared output mismatch", "rad^2"}},
      {"rate_mismatch", {"output rates after the impact", "rad/s"}},
      {"state_mismatch", {"state after the impact minus that above z+", "rad, rad/s"}},
      {"impulse", {"impulse on the new stance foot", "N s"}},
      {"normal_impulse", {"normal impulse of the impact", "N s"}},
      {"old_foot_lift", {"vertical velocity of the old stance foot after the impact", "m/s"}}};
  return table;
}

// Quantities with numbers, and the names of these.
const std::map<string, vector<string>>& quantities_with_numbers() {
  static const std::map<string, vector<string>> table = {
      {"at_least", {"of", "bound"}},
      {"at_most", {"of", "bound"}},
      {"after_reset", {"of"}},
      {"friction_forward", {"coefficient"}},
      {"friction_backward", {"coefficient"}},
      {"impulse_cone_forward", {"coefficient"}},
      {"impulse_cone_backward", {"coefficient"}},
      {"torque_reserve", {"side", "share"}},
      {"knee_bend", {"joints", "sides", "least"}},
      {"foot_above_arc", {"clearance"}},
      {"foot_on_circle", {"centre", "radius"}},
      {"parabolic_clearance", {"height", "half_width", "slack"}},
      {"orbital_energy", {"height", "tilt"}}};
  return table;
}

vector<double> numbers_of(const Json& value, const string& what) {
  if (value.type == Json::number) return {value.number_value};
  vector<double> out;
  for (const Json& item : list_of(value, what)) out.push_back(number_of(item, what));
  if (out.empty()) refuse(what + " without numbers");
  return out;
}

string side_of(const Json& value) {
  const string side = text_of(value, "a side");
  if (side != "lower" && side != "upper") refuse("the side '" + side + "'");
  return side;
}

Quantity quantity_of(const Json& table, int joints) {
  if (const Json* user = table.find("user"))
    throw Unknown{"a user's function " + text_of(*user, "a name")};
  Quantity q;
  q.name = text_of(field(table, "a quantity", "function"), "the name of a quantity");
  vector<string> names = {"function"};
  if (!plain_quantities().count(q.name)) {
    const auto known = quantities_with_numbers().find(q.name);
    if (known == quantities_with_numbers().end()) throw Unknown{"the quantity " + q.name};
    names.insert(names.end(), known->second.begin(), known->second.end());
  }
  only(table, "the quantity " + q.name, names);
  for (size_t i = 0; i < table.names.size(); ++i) {
    const string& name = table.names[i];
    const Json& value = table.items[i];
    const string what = name + " of the quantity " + q.name;
    if (name == "function") continue;
    if (name == "of") q.of = std::make_shared<Quantity>(quantity_of(value, joints));
    else if (name == "side") q.side = side_of(value);
    else if (name == "bound") q.bound = numbers_of(value, what);
    else if (name == "sides") q.sides = numbers_of(value, what);
    else if (name == "centre") q.centre = numbers_of(value, what);
    else if (name == "joints") {
      for (const Json& joint : list_of(value, what)) {
        q.joints.push_back(integer_of(joint, what));
        if (q.joints.back() < 0 || q.joints.back() >= joints) refuse(what + ", which are none");
      }
    } else q.numbers[name] = number_of(value, what);
  }
  if (q.name == "knee_bend" && (q.joints.empty() || q.joints.size() != q.sides.size()))
    refuse("knees without sides");
  if (q.name == "foot_on_circle" && q.centre.size() != 2) refuse("a circle without a centre");
  return q;
}

template <class S>
vector<S> shifted(const vector<S>& values, const vector<double>& bound, bool at_least) {
  const size_t n = values.size();
  if (bound.size() != 1 && bound.size() != n) refuse("a bound of another size than its quantity");
  vector<S> out;
  for (size_t i = 0; i < n; ++i) {
    const S least(I(bound[bound.size() == 1 ? 0 : i]));
    out.push_back(at_least ? values[i] - least : least - values[i]);
  }
  return out;
}

template <class S>
vector<S> without_first(const vector<S>& values) { return {values.begin() + 1, values.end()}; }

template <class S>
vector<S> output_mismatch(Motion<S>& p) {
  vector<S> joints = without_first(unturned(p.robot, p.theta_after()));
  for (size_t j = 0; j < joints.size(); ++j) joints[j] = joints[j] - p.after().outputs().y[j];
  return joints;
}

template <class S>
vector<S> rate_mismatch(Motion<S>& p) {
  const auto& impact = p.impact();
  const Outputs<S>& desired = p.after().outputs();
  S dz1(0.0);
  for (size_t j = 0; j < impact.dq.size(); ++j)
    if (magnitude(p.robot.hip_gradient[j]) != 0.0)
      dz1 = dz1 + p.robot.hip_gradient[j] * impact.dq[j];
  const S dz2 = p.robot.gravity * point(p.robot.moment, impact.pose.e).x;
  vector<S> out = without_first(impact.dq);
  for (size_t j = 0; j < out.size(); ++j)
    out[j] = out[j] - desired.d1[j] * dz1 - desired.d2[j] * dz2;
  return out;
}

template <class S>
vector<S> state_mismatch(Motion<S>& p) {
  const auto& impact = p.impact();
  vector<S> out;
  for (size_t j = 0; j < impact.dq.size(); ++j)
    out.push_back(impact.pose.q[j] - p.after().pose().q[j]);
  for (size_t j = 0; j < impact.dq.size(); ++j) out.push_back(impact.dq[j] - p.after().dq()[j]);
  return out;
}

template <class S>
vector<S> value(const Quantity& q, Motion<S>& p) {
  const string& n = q.name;
  const Robot& robot = p.robot;
  const auto number = [&q](const char* key) { return I(q.number(key)); };
  if (n == "at_least") return shifted(value(*q.of, p), q.bound, true);
  if (n == "at_most") return shifted(value(*q.of, p), q.bound, false);
  if (n == "after_reset") return value(*q.of, p.after());
  if (n == "torso_angle") {
    if (!robot.torso) refuse("a torso angle of a robot without a torso");
    return {p.pose().theta[static_cast<size_t>(robot.leg)]};
  }
  if (n == "joint_angles") return without_first(p.pose().q);
  if (n == "joint_rates") return without_first(p.dq());
  if (n == "torques") return p.forces().torque;
  if (n == "normal_force") return {p.forces().ground.z};
  if (n == "friction_forward")
    return {number("coefficient") * p.forces().ground.z - p.forces().ground.x};
  if (n == "friction_backward")
    return {number("coefficient") * p.forces().ground.z + p.forces().ground.x};
  if (n == "torque_reserve") {
    vector<S> out;
    for (size_t j = 0; j < robot.torque_limit.size(); ++j) {
      const S used = inverse(number("share") * robot.torque_limit[j]) * p.forces().torque[j];
      out.push_back(q.side == "lower" ? S(I(1.0)) + used : S(I(1.0)) - used);
    }
    return out;
  }
  if (n == "foot_height") return {p.foot().z};
  if (n == "foot_forward") return {p.foot().x};
  if (n == "foot_vertical_velocity") return {p.foot_velocity().z};
  if (n == "foot_above_arc") {
    const Policy& policy = p.model.policy;
    const S t = inverse(I(policy.guard) - I(policy.start)) * (p.z1 - S(I(policy.start)));
    return {p.foot().z - (I(4.0) * number("clearance")) * (t * (S(I(1.0)) - t))};
  }
  if (n == "foot_on_circle") {
    const Vec<S> off = p.foot() - Vec<S>{S(I(q.centre[0])), S(I(q.centre[1]))};
    return {dot(off, off) - S(square(number("radius")))};
  }
  if (n == "parabolic_clearance") {
    const S x = inverse(number("half_width")) * p.z1;
    return {p.foot().z - number("height") * (S(I(1.0)) - x * x) + S(number("slack"))};
  }
  if (n == "knee_bend") {
    vector<S> out;
    for (size_t i = 0; i < q.joints.size(); ++i)
      out.push_back(I(q.sides[i]) * p.pose().q[static_cast<size_t>(q.joints[i]) + 1] -
                    S(number("least")));
    return out;
  }
  if (n == "hip_height") return {p.hip().z};
  if (n == "hip_forward") return {p.hip().x};
  if (n == "hip_speed") return {p.hip_velocity().x};
  if (n == "forward_rate") return {p.dz1()};
  if (n == "transversal_inertia") return {-p.transversal()};
  if (n == "hip_state") return {p.z1};
  if (n == "momentum") return {p.z2};
  if (n == "orbital_energy") {
    const I h = number("height");
    const S speed = inverse(robot.weight_mass * h) * p.z2;
    return {speed * speed - (robot.gravity / h) * (p.z1 * p.z1) - number("tilt") * p.z1};
  }
  if (n == "reset_hip") return {p.hip_after()};
  if (n == "reset_hip_sum") return {p.hip_after() + p.z1};
  if (n == "output_mismatch") return output_mismatch(p);
  if (n == "squared_mismatch") {
    S sum(0.0);
    for (const S& error : output_mismatch(p)) sum = sum - error * error;
    return {sum};
  }
  if (n == "rate_mismatch") return rate_mismatch(p);
  if (n == "state_mismatch") return state_mismatch(p);
  if (n == "impulse") return {p.impact().impulse.x, p.impact().impulse.z};
  if (n == "normal_impulse") return {p.impact().impulse.z};
  if (n == "impulse_cone_forward")
    return {number("coefficient") * p.impact().impulse.z - p.impact().impulse.x};
  if (n == "impulse_cone_backward")
    return {number("coefficient") * p.impact().impulse.z + p.impact().impulse.x};
  if (n == "old_foot_lift")
    return {point(robot.foot, p.impact().pose.spin(p.impact().w)).z};
  throw Unknown{"the quantity " + n};
}

// A decimal that is not smaller: printed in the upward mode that is set.
string at_most(double x, int digits = 6) {
  char text[40];
  snprintf(text, sizeof text, "%.*g", digits, x);
  return text;
}

// A decimal that is not larger.
string at_least(double x, int digits = 6) {
  const string text = at_most(-x, digits);
  return text[0] == '-' ? text.substr(1) : "-" + text;
}

string unit_of(const Quantity& q) {
  if (q.of) return unit_of(*q.of);
  const auto plain = plain_quantities().find(q.name);
  if (plain != plain_quantities().end()) return plain->second.unit;
  if (q.name == "torque_reserve") return "of the torque allowed";
  if (q.name == "knee_bend") return "rad";
  if (q.name == "foot_on_circle") return "m^2";
  if (q.name == "orbital_energy") return "m^2/s^2";
  if (q.name.rfind("friction", 0) == 0) return "N";
  if (q.name.rfind("impulse", 0) == 0) return "N s";
  return "m";
}

string words_for(const Quantity& q) {
  const auto plain = plain_quantities().find(q.name);
  if (plain != plain_quantities().end()) return plain->second.words;
  const auto number = [&q](const char* key) { return brief(q.number(key)); };
  string bounds;
  for (const double bound : q.bound) bounds += (bounds.empty() ? "" : ", ") + brief(bound);
  if (q.name == "at_least") return words_for(*q.of) + " above " + bounds + " " + unit_of(*q.of);
  if (q.name == "at_most") return words_for(*q.of) + " below " + bounds + " " + unit_of(*q.of);
  if (q.name == "after_reset") return words_for(*q.of) + ", at the point after the reset";
  if (q.name == "friction_forward")
    return "slack of the friction cone, coefficient " + number("coefficient") + ", forward";
  if (q.name == "friction_backward")
    return "slack of the friction cone, coefficient " + number("coefficient") + ", backward";
  if (q.name == "impulse_cone_forward")
    return "slack of the impulse's cone, coefficient " + number("coefficient") + ", forward";
  if (q.name == "impulse_cone_backward")
    return "slack of the impulse's cone, coefficient " + number("coefficient") + ", backward";
  if (q.name == "torque_reserve")
    return "what is left of " + number("share") + " of the torque limits, " + q.side + " side";
  if (q.name == "knee_bend") {
    string knees;
    for (size_t i = 0; i < q.joints.size(); ++i)
      knees += (i ? ", " : "") + std::to_string(q.joints[i]) + " times " + brief(q.sides[i]);
    return "bend of the knees (joints " + knees + ") beyond " + number("least") + " rad";
  }
  if (q.name == "foot_above_arc")
    return "swing foot above an arc of height " + number("clearance") + " m";
  if (q.name == "foot_on_circle")
    return "swing foot outside a circle of radius " + number("radius") + " m about (" +
           brief(q.centre[0]) + ", " + brief(q.centre[1]) + ") m";
  if (q.name == "parabolic_clearance")
    return "swing foot above a parabola of height " + number("height") + " m and half width " +
           number("half_width") + " m, lowered by " + number("slack") + " m";
  return "orbital energy of a pendulum of " + number("height") + " m, less " + number("tilt") +
         " m/s^2 z1";
}

// Whether accelerations are needed.
bool of_forces(const Quantity& q) {
  static const std::set<string> names = {"torques", "normal_force", "friction_forward",
                                         "friction_backward", "torque_reserve"};
  return q.of ? of_forces(*q.of) : names.count(q.name) > 0;
}

struct Condition {
  string kind, region, side;
  double scale = 1.0, gamma = 0.0, tolerance = 0.0, least = 0.0;
  vector<double> alpha;
  Quantity quantity;
  string unknown;  // Why it cannot be checked here; empty if it can.
};

Condition condition_of(const Json& table, int joints) {
  Condition c;
  c.region = text_of(field(table, "a condition", "region"), "a region's name");
  c.scale = number_of(field(table, "a condition", "scale"), "a scale");
  if (!(c.scale > 0.0)) refuse("a scale that is not positive");
  if (const Json* user = table.find("user")) {
    c.unknown = "a user's kind of condition, " + text_of(*user, "a name");
    return c;
  }
  c.kind = text_of(field(table, "a condition", "kind"), "a kind");
  static const std::map<string, vector<string>> kinds = {
      {"Pointwise", {"quantity"}},
      {"Barrier", {"quantity", "alpha"}},
      {"DiscreteBarrier", {"quantity", "gamma"}},
      {"Equality", {"quantity", "tolerance", "loss"}},
      {"Fence", {"side"}},
      {"Inlet", {"side"}},
      {"TubeWidth", {"least"}}};
  const auto known = kinds.find(c.kind);
  if (known == kinds.end()) {
    c.unknown = "the kind of condition " + c.kind;
    return c;
  }
  vector<string> names = {"kind", "region", "scale"};
  names.insert(names.end(), known->second.begin(), known->second.end());
  only(table, "a condition of the kind " + c.kind, names);
  if (const Json* side = table.find("side")) c.side = side_of(*side);
  if (const Json* gamma = table.find("gamma")) c.gamma = number_of(*gamma, "gamma");
  if (const Json* least = table.find("least")) c.least = number_of(*least, "a least width");
  if (const Json* t = table.find("tolerance")) c.tolerance = number_of(*t, "a tolerance");
  if (const Json* alpha = table.find("alpha")) c.alpha = numbers_of(*alpha, "alpha");
  // Only gains that make dh/dt >= -alpha(h) keep h >= 0 are conditions of this kind.
  for (const double slope : c.alpha)
    if (!(slope > 0.0)) refuse("a barrier's gain that is not positive");
  if (c.alpha.size() > 2 || !std::is_sorted(c.alpha.begin(), c.alpha.end()))
    refuse("a barrier's gains that are not bent upwards");
  if (table.find("gamma") && !(c.gamma > 0.0 && c.gamma <= 1.0)) refuse("gamma outside (0, 1]");
  try {
    if (const Json* quantity = table.find("quantity")) c.quantity = quantity_of(*quantity, joints);
    if (c.kind == "Barrier" && of_forces(c.quantity))
      c.unknown = "a rate of forces, which needs third derivatives of the policy";
  } catch (const Unknown& unknown) {
    c.unknown = unknown.what;
  }
  return c;
}

// F = d zeta / d phase along the flow, where dz is as given.
template <class S>
S flow_slope(Motion<S>& p, const S& dz1, const S& dz2) {
  const Tube& tube = p.model.tube;
  return (I(tube.guard) - I(tube.start)) * (p.z2 * dz2 / dz1);
}
template <class S>
S flow_slope(Motion<S>& p) { return flow_slope(p, p.dz1(), p.dz2()); }

// Fences and their slopes over the phase, by a dual in the phase.
Fences<Dual> sloping_fences(const Tube& tube, const TM& phase) {
  return fences(tube, Dual(phase, ONE));
}

using Rates = vector<std::pair<TM, TM>>;  // Values of (dz1, dz2).

// Flow inward over a fence of a tube, in its widths per step, for each dz given.
vector<TM> inward(const Tube& tube, const TM& phase, Motion<TM>& p, bool upper,
                  const Rates& rates) {
  const Fences<Dual> f = sloping_fences(tube, phase);
  const TM width = f.upper.v - f.lower.v;
  vector<TM> out;
  for (const auto& [dz1, dz2] : rates) {
    const TM along = flow_slope(p, dz1, dz2);
    out.push_back((upper ? f.upper.d - along : along - f.lower.d) / width);
  }
  return out;
}

TM reset_level(const Tube& tube, Motion<TM>& p) {
  return level_of(tube, p.hip_after(), p.z2_after());
}

// 2 (z2 of the upper fence - z2 of the lower) / their sum.
TM relative_width(const Tube& tube, const TM& phase) {
  const Fences<TM> f = fences(tube, phase);
  const TM low = root(I(2.0) * f.lower), high = root(I(2.0) * f.upper);
  return I(2.0) * (high - low) / (high + low);
}

// dh/dt + alpha(h) in a state that moves.
vector<TM> barrier_margins(const Condition& c, Motion<Dual>& p) {
  vector<TM> out;
  const vector<Dual> h = value(c.quantity, p);
  for (const double slope : c.alpha)
    for (const Dual& one : h) out.push_back(one.d + I(slope) * one.v);
  return out;
}

vector<TM> margins(const Condition& c, Motion<TM>& p, const TM& phase) {
  if (c.kind == "Pointwise") return value(c.quantity, p);
  if (c.kind == "Barrier") return barrier_margins(c, p.flow());
  if (c.kind == "DiscreteBarrier") {
    vector<TM> now = value(c.quantity, p), later = value(c.quantity, p.after());
    for (size_t i = 0; i < now.size(); ++i)
      later[i] = later[i] - (I(1.0) - I(c.gamma)) * now[i];
    return later;
  }
  if (c.kind == "Equality") {
    vector<TM> out;
    for (const double sign : {-1.0, 1.0})
      for (const TM& error : value(c.quantity, p))
        out.push_back(TM(c.tolerance) + I(sign) * error);
    return out;
  }
  if (c.kind == "Fence")
    return inward(p.model.tube, phase, p, c.side == "upper", {{p.dz1(), p.dz2()}});
  if (c.kind == "Inlet") {
    const TM level = reset_level(p.model.tube, p);
    return {c.side == "lower" ? level : ONE - level};
  }
  if (c.kind == "TubeWidth") return {relative_width(p.model.tube, phase) - TM(c.least)};
  throw Unknown{"the kind of condition " + c.kind};
}

// "margin of what >= number unit".
string words_for(const Condition& c, double bound) {
  const string number = at_least(bound), least = " >= " + number + " ";
  if (c.kind == "Fence")
    return "flow inward over the " + c.side + " fence" + least + "tube widths a step";
  if (c.kind == "Inlet")
    return "reset inside the " + c.side + " fence" + least + "tube widths";
  if (c.kind == "TubeWidth")
    return "relative width of the tube in z2 beyond " + brief(c.least) + " >= " + number;
  const string unit = unit_of(c.quantity), what = words_for(c.quantity);
  if (c.kind == "Barrier") {
    string gain = brief(c.alpha[0]);
    if (c.alpha.size() == 2) gain += " or " + brief(c.alpha[1]);
    return "dh/dt + " + gain + "/s h" + least + unit + "/s, h: " + what;
  }
  if (c.kind == "DiscreteBarrier")
    return "h after the reset - " + brief(1.0 - c.gamma) + " h" + least + unit + ", h: " + what;
  if (c.kind == "Equality")
    return what + " within " + brief(c.tolerance) + least + unit;
  return what + least + unit;
}

// ------------------------------------------------------------------------ 10 set and orbit
//
// Level 2 is about the set T, phases -start_strip to 1 + guard_strip between the fences; level 3
// about a thin tube in it around the periodic orbit. Their premises are margins like those of
// conditions, over boxes of the chart of either. What follows from them is in section 12.

// A box of the chart: corners in (phase, level).
struct Box {
  double low[2], high[2];
};

struct WalkingSet {
  double start_strip = 0.0, guard_strip = 0.0, risen = 0.0, falling = 0.0;
  // Phases -start_strip, 1 - guard_strip and 1 + guard_strip, as doubles.
  double first = 0.0, before = 0.0, last = 0.0;
  double push[2] = {0.0, 0.0};       // Bound on what may be added to dz.
  vector<string> barriers, carried;  // Names of conditions.
  bool claimed = false;

  bool disturbed() const { return push[0] != 0.0 || push[1] != 0.0; }
  // T, its two fences, and the strip around the guard.
  Box whole() const { return {{first, 0.0}, {last, 1.0}}; }
  Box lower() const { return {{first, 0.0}, {last, 0.0}}; }
  Box upper() const { return {{first, 1.0}, {last, 1.0}}; }
  Box strip() const { return {{before, 0.0}, {last, 1.0}}; }
};

struct Orbit {
  Tube thin;
  bool nested = false;  // Attraction by nested tubes, not by contraction.
  double guard_from = 0.0, guard_to = 0.0;
  vector<double> expansion, slowest, fastest;  // Chebyshev series of bounds on dF/dzeta.
  bool claimed = false;
};

struct Theorems {
  std::optional<WalkingSet> walking;
  std::optional<Orbit> orbit;
};

// A box of the chart, and the states that it stands for in either tube.
class Place {
 public:
  const Model& model;
  const Theorems& theorems;
  const TM phase, level;

  Place(const Model& m, const Theorems& t, const Box& box)
      : model(m), theorems(t), phase(coordinate(box.low[0], box.high[0], 0)),
        level(coordinate(box.low[1], box.high[1], 1)) {}

  Motion<TM>& wide() {
    if (!wide_) wide_.emplace(state_at(model, model.tube, phase, level));
    return *wide_;
  }
  Motion<TM>& thin() {
    if (!thin_) thin_.emplace(state_at(model, theorems.orbit->thin, phase, level));
    return *thin_;
  }

 private:
  std::optional<Motion<TM>> wide_, thin_;
};

// dz at the corners of the disturbance's box. Every margin that is asked there is linear in dz, or
// a quotient of linear functions whose denominator has one sign: no point inside is worse.
Rates pushed(const WalkingSet& set, Motion<TM>& p) {
  if (!set.disturbed()) return {{p.dz1(), p.dz2()}};
  Rates corners;
  for (const double first : {-set.push[0], set.push[0]})
    for (const double second : {-set.push[1], set.push[1]})
      corners.push_back({p.dz1() + TM(first), p.dz2() + TM(second)});
  return corners;
}

// dF/dzeta at a phase: zeta moves by 1 where z2 moves by 1 / z2.
TM expansion(Motion<TM>& p) {
  Motion<Dual> across = p.moving(TM(0.0), inverse(p.z2));
  return flow_slope(across).d;
}

// rho, how far a neighbour is off after guard and reset, per zeta it was off before. With p the
// height of the foot, the level of p through this state runs along t = (-p_z2, p_z1) in z. A
// neighbour that is off by 1 in zeta is off by 1 / z2 in z2; it equals a t plus a multiple of the
// flow for a = dz1 / (z2 dp/dt). The reset carries a t to a Dz(t), which is off by
// z2 (z2' - (dz2 / dz1) z1') in zeta along the flow after the reset.
TM reset_gain(Motion<TM>& p) {
  const TM p1 = p.foot_per_dz1().z, p2 = p.foot_per_dz2().z;
  Motion<Dual> along_ground = p.moving(-p2, p1);
  const Dual hip = along_ground.hip_after(), momentum = along_ground.z2_after();
  Motion<TM>& after = p.after();
  const TM off = after.z2 * (momentum.d - after.dz2() / after.dz1() * hip.d);
  return off * p.dz1() / (p.z2 * (p1 * p.dz1() + p2 * p.dz2()));
}

// Rate at which |r| falls outside the thin tube, r being the distance from its middle in its half
// widths; level runs from the thin tube's fence of one side to the set's.
TM narrowing(Place& at, bool upper) {
  const Fences<Dual> thin = sloping_fences(at.theorems.orbit->thin, at.phase);
  const Fences<TM> wide = fences(at.model.tube, at.phase);
  const TM from = upper ? thin.upper.v : thin.lower.v, to = upper ? wide.upper : wide.lower;
  const TM zeta = from + at.level * (to - from);
  const Dual middle = I(0.5) * (thin.lower + thin.upper), width = thin.upper - thin.lower;
  Motion<TM> state = state_of(at.model, at.phase, zeta);
  return width.d / width.v - (flow_slope(state) - middle.d) / (zeta - middle.v);
}

// What the outputs of the theorems say that concern no single condition.
const std::map<string, Meaning>& theorem_outputs() {
  static const std::map<string, Meaning> table = {
      {"set/forward", {"rate of the phase", "1/s"}},
      {"set/inertia", {"transversal inertia -J s", "kg m"}},
      {"set/width", {"width of the set in z2, of its middle", ""}},
      {"set/fence-lower", {"flow inward over the lower fence", "tube widths a step"}},
      {"set/fence-upper", {"flow inward over the upper fence", "tube widths a step"}},
      {"set/foot-above", {"height of the swing foot", "m"}},
      {"set/foot-below", {"depth of the swing foot", "m"}},
      {"set/foot-rises", {"rise of the swing foot", "m/s"}},
      {"set/foot-falls", {"fall of the swing foot", "m/s"}},
      {"set/reset-phase", {"minus the size of the phase after the reset", ""}},
      {"set/reset-level", {"reset inside the fences and forward", "tube widths, or of z2"}},
      {"orbit/expansion", {"a series less dF/dzeta on the set", "per step"}},
      {"orbit/gain", {"minus the size of the gain rho on the set's guard", ""}},
      {"orbit/fence-lower", {"flow inward over the thin tube's lower fence", "widths a step"}},
      {"orbit/fence-upper", {"flow inward over the thin tube's upper fence", "widths a step"}},
      {"orbit/foot-above", {"height of the swing foot in the thin tube", "m"}},
      {"orbit/foot-below", {"depth of the swing foot in the thin tube", "m"}},
      {"orbit/reset-level", {"reset inside the thin tube", "widths"}},
      {"orbit/inside", {"thin tube inside the set", "tube widths"}},
      {"orbit/width", {"minus the thin tube's width in z2", "kg m^2/s"}},
      {"orbit/slowest", {"dF/dzeta in the thin tube less a series", "per step"}},
      {"orbit/fastest", {"a series less dF/dzeta in the thin tube", "per step"}},
      {"orbit/reset-gain-low", {"gain rho on the thin tube's guard", ""}},
      {"orbit/reset-gain-high", {"minus the gain rho on the thin tube's guard", ""}},
      {"orbit/nested-above", {"approach to the thin tube from above", "per step"}},
      {"orbit/nested-below", {"approach to the thin tube from below", "per step"}}};
  return table;
}

vector<TM> inside(const TM& level) { return {level, ONE - level}; }

vector<TM> set_margins(const string& n, Place& at) {
  const Tube& tube = at.model.tube;
  const WalkingSet& set = *at.theorems.walking;
  Motion<TM>& p = at.wide();
  if (n == "set/inertia") return {-p.transversal()};
  if (n == "set/width") return {relative_width(tube, at.phase)};
  if (n == "set/fence-lower" || n == "set/fence-upper")
    return inward(tube, at.phase, p, n == "set/fence-upper", pushed(set, p));
  if (n == "set/foot-above") return {p.foot().z};
  if (n == "set/foot-below") return {-p.foot().z};
  if (n == "set/reset-phase") {
    const TM phase = phase_of(tube, p.hip_after());
    return {phase, -phase};
  }
  if (n == "set/reset-level") {
    // Levels do not tell forward from backward, so z2 must keep its sign as well.
    vector<TM> margins = inside(reset_level(tube, p));
    margins.push_back(p.z2_after() / p.z2);
    return margins;
  }
  vector<TM> out;
  for (const auto& [dz1, dz2] : pushed(set, p)) {
    const TM rise = p.foot_per_dz1().z * dz1 + p.foot_per_dz2().z * dz2;
    if (n == "set/forward") out.push_back(inverse(I(tube.guard) - I(tube.start)) * dz1);
    else if (n == "set/foot-rises") out.push_back(rise);
    else if (n == "set/foot-falls") out.push_back(-rise);
    else throw Unknown{"the output " + n};
  }
  return out;
}

vector<TM> orbit_margins(const string& n, Place& at) {
  const Orbit& orbit = *at.theorems.orbit;
  const auto series = [&at](const vector<double>& coefficients) {
    return sum(coefficients, chebyshev(at.phase, coefficients.size()));
  };
  if (n == "orbit/expansion") return {series(orbit.expansion) - expansion(at.wide())};
  if (n == "orbit/gain") {
    const TM gain = reset_gain(at.wide());
    return {gain, -gain};
  }
  if (n == "orbit/nested-above") return {narrowing(at, true)};
  if (n == "orbit/nested-below") return {narrowing(at, false)};
  // In the chart of the thin tube.
  Motion<TM>& p = at.thin();
  if (n == "orbit/fence-lower" || n == "orbit/fence-upper")
    return inward(orbit.thin, at.phase, p, n == "orbit/fence-upper", {{p.dz1(), p.dz2()}});
  if (n == "orbit/foot-above") return {p.foot().z};
  if (n == "orbit/foot-below") return {-p.foot().z};
  if (n == "orbit/reset-level") return inside(reset_level(orbit.thin, p));
  if (n == "orbit/inside") return inside(level_of(at.model.tube, p.z1, p.z2));
  if (n == "orbit/width") {
    const Fences<TM> f = fences(orbit.thin, at.phase);
    return {root(I(2.0) * f.lower) - root(I(2.0) * f.upper)};
  }
  if (n == "orbit/slowest") return {expansion(p) - series(orbit.slowest)};
  if (n == "orbit/fastest") return {series(orbit.fastest) - expansion(p)};
  if (n == "orbit/reset-gain-low") return {reset_gain(p)};
  if (n == "orbit/reset-gain-high") return {-reset_gain(p)};
  throw Unknown{"the output " + n};
}

// dh/dt + alpha(h) of a barrier h at the corners of the disturbance's box. Whatever h reads is that
// of the undisturbed surface, so that h is a function of z and its rate is linear in dz.
vector<TM> pushed_rates(const Condition& c, Place& at) {
  Motion<TM>& p = at.wide();
  vector<TM> out;
  p.jets();
  for (const auto& [dz1, dz2] : pushed(*at.theorems.walking, p)) {
    Motion<Dual> moved = p.moving(dz1, dz2);
    const vector<TM> one = barrier_margins(c, moved);
    out.insert(out.end(), one.begin(), one.end());
  }
  return out;
}

// An output of the Program: a condition of the spec, or a premise of a theorem.
struct Output {
  size_t elements = 0;  // In the Program.
  string unknown;       // Why it cannot be checked here; empty if it can.
  std::function<vector<TM>(Place&)> margins;
  std::function<string(double)> words;  // That the margin is at least this.
};

Output output_of(const Condition& c) {
  return {0, c.unknown, [&c](Place& at) { return margins(c, at.wide(), at.phase); },
          [&c](double least) { return words_for(c, least); }};
}

Output output_of(const string& name, const Meaning& meaning) {
  const bool set = name.rfind("set/", 0) == 0;
  return {0, "",
          [name, set](Place& at) { return set ? set_margins(name, at) : orbit_margins(name, at); },
          [&meaning](double least) {
            return string(meaning.words) + " >= " + at_least(least) + (*meaning.unit ? " " : "") +
                   meaning.unit;
          }};
}

// set/after NAME, set/value NAME, set/rate NAME, of a barrier condition.
Output output_of(const string& what, const Condition& c) {
  if (!c.unknown.empty()) return {0, c.unknown, {}, {}};
  const string h = words_for(c.quantity) + " >= ", unit = " " + unit_of(c.quantity);
  if (what == "set/value")
    return {0, "", [&c](Place& at) { return value(c.quantity, at.wide()); },
            [h, unit](double least) { return h + at_least(least) + unit; }};
  if (what == "set/after")
    return {0, "", [&c](Place& at) { return value(c.quantity, at.wide().after()); },
            [h, unit](double least) { return "after the reset, " + h + at_least(least) + unit; }};
  return {0, "", [&c](Place& at) { return pushed_rates(c, at); },
          [&c](double least) { return "disturbed, " + words_for(c, least); }};
}

// ------------------------------------------------------------------------------ 11 the check
//
// A statement: on a box of the chart, each output has at least its bound, in its scale. The tree
// says how the box was halved. Every leaf is bounded anew, and split further if that is not enough.

// LEVEL/NAME: an output of a theorem. Others are conditions, whose bounds are not negative.
bool of_theorem(const string& output) { return output.find('/') != string::npos; }

string interval_words(double low, double high) {
  return low == high ? brief(low) : "[" + brief(low) + ", " + brief(high) + "]";
}

string words_for(const Box& box) {
  return " for phase in " + interval_words(box.low[0], box.high[0]) + " and level in " +
         interval_words(box.low[1], box.high[1]);
}

struct Claim {
  string name;
  double scale = 1.0, bound = 0.0;
  const Output* output = nullptr;

  I least() const { return I(bound) * I(scale); }
};

struct Statement {
  vector<Claim> claims;
  string region, tree;
  Box root_box{};
};


// Halves along every axis that has a width, the first axis fastest. Both halves end at the same
// double, so they cover the box whatever that is.
vector<Box> halves(const Box& box) {
  vector<Box> parts = {box};
  for (int axis = 0; axis < 2; ++axis) {
    if (!(box.low[axis] < box.high[axis])) continue;
    const double centre = box.low[axis] + (box.high[axis] - box.low[axis]) * 0.5;
    const size_t count = parts.size();
    for (size_t i = 0; i < count; ++i) {
      parts.push_back(parts[i]);
      parts[i].high[axis] = centre;
      parts.back().low[axis] = centre;
    }
  }
  if (parts.size() == 1) parts.clear();
  return parts;
}

// The boxes at which a statement's tree ends: 1 is a split, 0 a leaf, depth first.
vector<Box> leaves(const Statement& statement) {
  constexpr int kDeepest = 48;  // Further halving would exhaust a double's digits.
  const string &tree = statement.tree, name = "the tree of " + statement.region;
  struct Node { Box box; int depth; };
  vector<Node> stack = {{statement.root_box, 0}};
  vector<Box> found;
  size_t at = 0;
  while (!stack.empty()) {
    const Node node = stack.back();
    stack.pop_back();
    if (at == tree.size()) throw Inconsistent{name + " ends before its last leaf"};
    if (tree[at++] == '0') {
      found.push_back(node.box);
      continue;
    }
    const vector<Box> parts = halves(node.box);
    if (parts.empty() || node.depth == kDeepest)
      throw Inconsistent{name + " splits what has no width"};
    for (size_t i = parts.size(); i-- > 0;) stack.push_back({parts[i], node.depth + 1});
  }
  if (at != tree.size()) throw Inconsistent{name + " goes on after its last leaf"};
  return found;
}

enum Verdict { proved, undecided, rejected };

struct Finding {
  Verdict verdict = proved;
  string reason;
  long boxes = 0;
};

class Checker {
 public:
  Checker(const Model& model, const Theorems& theorems, const Statement& statement)
      : model_(model), theorems_(theorems), statement_(statement) {}

  // A leaf that is undecided does not end the search for a point that breaks the statement.
  Finding run() {
    vector<const Claim*> known;
    for (const Claim& claim : statement_.claims) {
      const string& unknown = claim.output->unknown;
      if (unknown.empty()) known.push_back(&claim);
      else note(undecided, claim.name + " cannot be checked here: " + unknown);
    }
    if (!known.empty())
      for (const Box& leaf : leaves(statement_))
        if (prove(leaf, known, 0) == rejected) break;
    return found_;
  }

 private:
  static constexpr int kMoreSplits = 6;  // How often a leaf may be split again.
  const Model& model_;
  const Theorems& theorems_;
  const Statement& statement_;
  Finding found_;

  Verdict note(Verdict verdict, const string& reason) {
    if (verdict > found_.verdict) {
      found_.verdict = verdict;
      found_.reason = reason;
    }
    return verdict;
  }

  vector<TM> evaluate(const Claim& claim, Place& at) {
    vector<TM> found = claim.output->margins(at);
    if (found.size() != claim.output->elements)
      throw Inconsistent{claim.name + " has " + std::to_string(found.size()) +
                         " elements in the model, " + std::to_string(claim.output->elements) +
                         " in the Program"};
    return found;
  }

  static bool reached(const vector<TM>& margins, I least) {
    for (const TM& margin : margins)
      if (!(range(margin).low() >= least.high())) return false;
    return !margins.empty();
  }

  // Claims that are not proved on a box.
  vector<const Claim*> failing(const Box& box, const vector<const Claim*>& claims) {
    vector<const Claim*> left;
    ++found_.boxes;
    Place at(model_, theorems_, box);
    for (const Claim* claim : claims) {
      try {
        if (!reached(evaluate(*claim, at), claim->least())) left.push_back(claim);
      } catch (const NoBound&) {
        left.push_back(claim);
      }
    }
    return left;
  }

  Verdict prove(const Box& box, const vector<const Claim*>& claims, int depth) {
    const vector<const Claim*> left = failing(box, claims);
    if (left.empty()) return proved;
    for (const Claim* claim : left)
      if (refuted(box, *claim)) return rejected;
    const vector<Box> parts = halves(box);
    if (depth == kMoreSplits || parts.empty())
      return note(undecided, left[0]->name + " does not reach its bound" + words_for(box) +
                                 " of region " + statement_.region + " after " +
                                 std::to_string(depth) +
                                 " more splits, and no point of it breaks it");
    for (const Box& part : parts) {
      const Verdict verdict = prove(part, left, depth + 1);
      if (verdict != proved) return verdict;
    }
    return proved;
  }

  // Whether the claim certainly fails at the centre or a corner of a box.
  bool refuted(const Box& box, const Claim& claim) {
    const double centre[2] = {box.low[0] + (box.high[0] - box.low[0]) * 0.5,
                              box.low[1] + (box.high[1] - box.low[1]) * 0.5};
    const double points[5][2] = {{centre[0], centre[1]}, {box.low[0], box.low[1]},
                                 {box.high[0], box.low[1]}, {box.low[0], box.high[1]},
                                 {box.high[0], box.high[1]}};
    const I least = claim.least();
    for (const auto& at : points) {
      try {
        Place here(model_, theorems_, {{at[0], at[1]}, {at[0], at[1]}});
        for (const TM& margin : evaluate(claim, here)) {
          if (!(range(margin).high() < least.low())) continue;
          note(rejected, claim.name + " is " + at_least(range(margin).low()) + " at phase " +
                             brief(at[0]) + ", level " + brief(at[1]) + " of region " +
                             statement_.region + ", less than " + at_least(least.low()));
          return true;
        }
      } catch (const NoBound&) {  // Nothing is certain at this point.
      }
    }
    return false;
  }
};

// --------------------------------------------------------------------------- 12 what follows
//
// The statements are inequalities on boxes. Levels 2 and 3 put them together: each method draws one
// conclusion, or says which premise is missing. docs/guarantees.md has the same in prose.

using Regions = std::map<string, vector<Box>>;

struct ProofFile {
  string robot, spec, weights_sha256;
  Model model;
  Regions regions;
  std::map<string, Condition> conditions;
  Theorems theorems;
  std::map<string, Output> outputs;  // Of the Program.
  vector<Statement> statements;
};

bool same(const Box& a, const Box& b) {
  return std::equal(a.low, a.low + 2, b.low) && std::equal(a.high, a.high + 2, b.high);
}

struct DoesNotFollow { string why; };

string listed(const vector<string>& names) {
  string all;
  for (const string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

I exp(I x) { return {exp_at(x.low()).n, exp_at(x.high()).h}; }

// Integral of a series over the step: that of T_k over [-1, 1] is 2 / (1 - k^2) for even k, or 0.
I over_step(const vector<double>& series) {
  I total(0.0);
  for (size_t k = 0; k < series.size(); k += 2) {
    const double square = static_cast<double>(k) * static_cast<double>(k);
    total = total + I(series[k]) / (I(1.0) - I(square));
  }
  return total;
}

// What |series| is at most wherever |2 phase - 1| is not larger than at this phase beyond the step:
// there no Chebyshev polynomial is larger.
I largest(const vector<double>& series, I phase) {
  vector<double> sizes;
  for (const double c : series) sizes.push_back(std::abs(c));
  return sum(sizes, chebyshev(phase, series.size()));
}

// Whether boxes together are all of the chart: each cell between their edges lies in one of them.
bool covers(const vector<Box>& boxes) {
  std::set<double> cuts[2];
  for (int axis = 0; axis < 2; ++axis) {
    cuts[axis] = {0.0, 1.0};
    for (const Box& box : boxes) cuts[axis].insert({box.low[axis], box.high[axis]});
  }
  for (auto x = cuts[0].begin(), x2 = std::next(x); x2 != cuts[0].end(); ++x, ++x2)
    for (auto y = cuts[1].begin(), y2 = std::next(y); y2 != cuts[1].end(); ++y, ++y2)
      if (std::none_of(boxes.begin(), boxes.end(), [&](const Box& box) {
            return box.low[0] <= *x && *x2 <= box.high[0] && box.low[1] <= *y && *y2 <= box.high[1];
          }))
        return false;
  return true;
}

class Conclusions {
 public:
  explicit Conclusions(const ProofFile& file) : file_(file) {}

  // Level 2. A trajectory that starts in T before the ground moves forward at `pace` or more,
  // crosses no fence, and can meet the ground only falling: not while the foot rises, not while it
  // is above the ground, and it falls from then on, being above the ground at phase `before` and
  // below at `last`. From the strip in between, the reset lands between the fences, less than
  // start_strip from phase 0: in T again.
  vector<string> walking() const {
    const WalkingSet& t = *file_.theorems.walking;
    if (!(0.0 < t.start_strip && t.start_strip < 0.1 && 0.0 < t.guard_strip &&
          t.guard_strip < 0.1))
      throw DoesNotFollow{"strips that are not between 0 and 0.1"};
    if (!(0.0 < t.risen && t.risen <= t.falling && t.falling < t.before))
      throw DoesNotFollow{"phases of rise and fall that are not in order"};
    const double pace = positive("set/forward", t.whole());
    positive("set/inertia", t.whole());
    const double width = positive("set/width", t.lower());
    positive("set/fence-lower", t.lower());
    positive("set/fence-upper", t.upper());
    positive("set/foot-rises", {{t.first, 0.0}, {t.risen, 1.0}});
    positive("set/foot-above", {{t.risen, 0.0}, {t.falling, 1.0}});
    positive("set/foot-falls", {{t.falling, 0.0}, {t.last, 1.0}});
    positive("set/foot-above", {{t.before, 0.0}, {t.before, 1.0}});
    positive("set/foot-below", {{t.last, 0.0}, {t.last, 1.0}});
    positive("set/reset-level", t.strip());
    if (!(bound("set/reset-phase", t.strip()) > -t.start_strip))
      throw DoesNotFollow{"a reset may land outside the strip around the start of a step"};
    string start = "T is every state with z2 > 0 and phase in " + interval_words(t.first, t.last) +
                   " between the fences";
    const vector<string> safe = barriers(t, start);
    carried(t);

    const I longest = (I(t.last) - I(t.first)) / I(pace);
    string push;
    if (t.disturbed())
      push = ", whatever d(t) with |d| <= (" + brief(t.push[0]) + " m/s, " + brief(t.push[1]) +
             " N m) is added to dz,";
    vector<string> words = {
        start + ", up to where the swing foot meets the ground; its width in z2 is everywhere " +
            at_least(width) + " of its middle or more",
        "every trajectory of the projected hybrid zero dynamics that starts in T" + push +
            " stays between the fences, meets the ground once and transversally within " +
            at_most(longest.high()) + " s, and is reset into T: it walks for ever"};
    const string meant =
        t.disturbed() ? ", with rates and forces of the undisturbed flow at each state" : "";
    vector<string> whole, part;
    for (const string& name : t.carried)
      (covers(file_.regions.at(file_.conditions.at(name).region)) ? whole : part).push_back(name);
    if (!whole.empty()) words.push_back("along it hold" + meant + ": " + listed(whole));
    if (!part.empty())
      words.push_back("and, while it is in their regions, which are not all of T: " + listed(part));
    if (t.barriers.empty())
      words.push_back("no barrier function is part of this level: nothing is said of one that stays "
                      "non-negative");
    if (!safe.empty()) words.push_back("and h >= 0 along it, from the start, for: " + listed(safe));
    return words;
  }

  // Level 3, which rests on level 2. With zeta = z2^2 / 2 the flow on T is d zeta / d phase = F.
  // The return map P of the section at mid-step has the slope rho exp(integral of dF/dzeta), from
  // the phase after the reset to that of the guard: the step, less or more what is in the strips.
  vector<string> attraction() const {
    const WalkingSet& t = *file_.theorems.walking;
    const Orbit& o = *file_.theorems.orbit;
    if (!(t.falling < o.guard_from && o.guard_from < o.guard_to && o.guard_to <= t.last))
      throw DoesNotFollow{"the thin tube's guard is not where the foot falls"};
    const double behind = (I(t.last) - I(1.0)).high(), before = (I(1.0) - I(t.before)).high();
    const I ends = I(t.start_strip) + I(larger(behind, before));
    const I edge = I(1.0) + I(larger(t.start_strip, larger(behind, before)));
    not_negative("orbit/expansion", t.whole());
    const I gain = I(-bound("orbit/gain", t.strip()));
    const I steepest = largest(o.expansion, edge);
    const I slope = gain * exp(over_step(o.expansion) + ends * steepest);

    const I multiplier = thin_tube(t, o, ends, edge);
    if (!(multiplier.low() > 0.0 && multiplier.high() < 1.0))
      throw DoesNotFollow{"the multiplier is known to be in " +
                          interval_words(multiplier.low(), multiplier.high()) + " only"};
    string why;
    if (o.nested) {
      why = nested(t, o, gain * exp(I(2.0) * ends * steepest), multiplier);
    } else if (slope.high() < 1.0) {
      why = "the return map of the section at mid-step contracts to " + at_most(slope.high()) +
            " or less on all of T";
    } else {
      throw DoesNotFollow{"the return map is not shown to contract: |P'| <= " +
                          at_most(slope.high())};
    }
    const I low = root(I(2.0) * sum(o.thin.lower, chebyshev(I(0.5), o.thin.lower.size())));
    const I high = root(I(2.0) * sum(o.thin.upper, chebyshev(I(0.5), o.thin.upper.size())));
    // The widths have one sign all along, for margins that are shares of them are bounded.
    if (!(low.high() < high.low())) throw DoesNotFollow{"a thin tube that is upside down"};
    return {why + ": there is one periodic orbit, and every trajectory of the undisturbed system "
                  "in T converges to it",
            "at mid-step the orbit has z2 in [" + at_least(low.low(), 9) + ", " +
                at_most(high.high(), 9) + "] kg m^2/s, and is known to " +
                at_most(-bound("orbit/width", t.lower())) + " everywhere",
            "its multiplier is in [" + at_least(multiplier.low()) + ", " +
                at_most(multiplier.high()) + "]"};
  }

 private:
  const ProofFile& file_;

  // The bound that a statement has for an output on a box, rounded down.
  double bound(const string& output, const Box& box) const {
    for (const Statement& s : file_.statements)
      for (const Claim& claim : s.claims)
        if (claim.name == output && same(s.root_box, box)) return claim.least().low();
    throw DoesNotFollow{"no statement about " + output + words_for(box)};
  }
  double positive(const string& output, const Box& box) const {
    const double least = bound(output, box);
    if (!(least > 0.0)) throw DoesNotFollow{output + words_for(box) + " is not above 0"};
    return least;
  }
  void not_negative(const string& output, const Box& box) const {
    if (!(bound(output, box) >= 0.0))
      throw DoesNotFollow{output + words_for(box) + " may be negative"};
  }
  bool stated(const string& output, const Box& box) const {
    try {
      not_negative(output, box);
      return true;
    } catch (const DoesNotFollow&) {
      return false;
    }
  }

  // Barriers whose h stays >= 0 along every trajectory: T lies in h >= 0; or h >= 0 at the start and
  // dh/dt >= -alpha(h) on all of T, which carried() proves. `start` is told what is asked then.
  vector<string> barriers(const WalkingSet& t, string& start) const {
    vector<string> safe;
    string asked;
    for (const string& name : t.barriers) {
      const auto condition = file_.conditions.find(name);
      if (condition == file_.conditions.end() ||
          (condition->second.unknown.empty() && condition->second.kind != "Barrier"))
        throw DoesNotFollow{name + " is no barrier condition of the spec"};
      not_negative("set/after " + name, t.strip());
      if (t.disturbed()) not_negative("set/rate " + name, t.whole());
      const bool inside = stated("set/value " + name, t.whole());
      const bool everywhere = std::count(t.carried.begin(), t.carried.end(), name) > 0 &&
                              covers(file_.regions.at(condition->second.region));
      if (inside || everywhere || t.disturbed()) safe.push_back(name);
      if (!inside) asked += (asked.empty() ? "" : ", ") + name;
    }
    if (!asked.empty()) start += " and h >= 0 for: " + asked;
    return safe;
  }

  // The conditions that hold along a trajectory have statements on the strips as well.
  void carried(const WalkingSet& t) const {
    for (const string& name : t.carried) {
      const auto condition = file_.conditions.find(name);
      if (condition == file_.conditions.end())
        throw DoesNotFollow{name + " is no condition of the spec"};
      for (const Box& box : file_.regions.at(condition->second.region)) {
        not_negative(name, box);
        Box around = box;
        if (box.low[0] == 1.0) {  // The guard.
          around.low[0] = t.before;
          around.high[0] = t.last;
          not_negative(name, around);
          continue;
        }
        if (box.low[0] == 0.0) {
          around.low[0] = t.first;
          around.high[0] = box.high[0] == 0.0 ? t.start_strip : 0.0;
          not_negative(name, around);
        }
        if (box.high[0] == 1.0) {
          around.low[0] = 1.0;
          around.high[0] = t.last;
          not_negative(name, around);
        }
      }
    }
  }

  // The thin tube is invariant like T: the return map takes its section into itself, so that a
  // periodic orbit runs in it. Returns what encloses the slope of P there.
  I thin_tube(const WalkingSet& t, const Orbit& o, I ends, I edge) const {
    const Box guard = {{o.guard_from, 0.0}, {o.guard_to, 1.0}};
    positive("orbit/fence-lower", t.lower());
    positive("orbit/fence-upper", t.upper());
    positive("orbit/inside", t.lower());
    positive("orbit/inside", t.upper());
    positive("orbit/foot-above", {{o.guard_from, 0.0}, {o.guard_from, 1.0}});
    positive("orbit/foot-below", {{o.guard_to, 0.0}, {o.guard_to, 1.0}});
    positive("orbit/reset-level", guard);
    not_negative("orbit/slowest", t.whole());
    not_negative("orbit/fastest", t.whole());
    const I least = I(positive("orbit/reset-gain-low", guard));
    const I most = I(-bound("orbit/reset-gain-high", guard));
    const I low = least * exp(over_step(o.slowest) - ends * largest(o.slowest, edge));
    const I high = most * exp(over_step(o.fastest) + ends * largest(o.fastest, edge));
    return {low.n, high.h};
  }

  // Nested tubes. r is the distance from the thin tube's middle in its half widths. Outside it |r|
  // falls along the flow from phase start_strip to `before`. Across ground and reset, a trajectory
  // and the thin tube's fence next to it part by at most `growth`, and the fence's lands in the
  // thin tube: |r| - 1 grows by at most growth times the ratio of the half widths.
  string nested(const WalkingSet& t, const Orbit& o, I growth, I multiplier) const {
    const Box step = {{t.start_strip, 0.0}, {t.before, 1.0}};
    positive("orbit/nested-above", step);
    positive("orbit/nested-below", step);
    const auto width = [&o](double phase) {
      const Fences<I> f = fences(o.thin, I(phase));
      return f.upper - f.lower;
    };
    const I factor = growth * (width(t.before) / width(t.start_strip));
    if (!(factor.high() < 1.0))
      throw DoesNotFollow{"tubes around the orbit may widen by " + at_most(factor.high()) +
                          " at the impact"};
    return "outside a thin tube around the orbit every trajectory gets nearer to it along the "
           "step, and across the impact to " + at_most(factor.high()) +
           " of its distance or less; inside it the return map contracts to " +
           at_most(multiplier.high()) + " or less";
  }
};

// ------------------------------------------------------------------------------- 13 the file

struct Named { string name, sha256; };

Named named(const Json& table, const string& what) {
  only(table, what, {"name", "sha256"});
  const string& name = text_of(field(table, what, "name"), "a name");
  if (name.size() > 200 || name.find("  ") != string::npos)
    refuse("the " + what + " name, too long or with blanks in a row");
  return {text_of(field(table, what, "name"), "a name"),
          text_of(field(table, what, "sha256"), "a sha256")};
}

struct ProgramFacts {
  Constants constants;               // Those that have a name.
  std::map<string, size_t> outputs;  // Name to number of elements.
};

ProgramFacts program_facts(const Json& table) {
  only(table, "the Program", {"format", "version", "inputs", "constants", "operations", "outputs"});
  if (text_of(field(table, "the Program", "format"), "a format") != "neuralgaits-program" ||
      integer_of(field(table, "the Program", "version"), "a version") != 1)
    refuse("a Program of another version");
  const vector<Json>& inputs = list_of(field(table, "the Program", "inputs"), "inputs");
  if (inputs.size() != 1 || list_of(inputs[0], "an input").size() != 2 ||
      text_of(inputs[0].items[0], "an input's name") != "u" ||
      shape_of(inputs[0].items[1], "u") != vector<int>{2})
    refuse("a Program that is no function of u alone");
  ProgramFacts facts;
  for (const Json& row : list_of(field(table, "the Program", "constants"), "constants")) {
    const vector<Json>& parts = list_of(row, "a constant");
    if (parts.size() != 3) refuse("a constant that is not name, shape and data");
    if (parts[0].type == Json::null) continue;
    const string name = text_of(parts[0], "a constant's name");
    Array array;
    array.shape = shape_of(parts[1], name);
    const auto bytes = base64(text_of(parts[2], name), name);
    if (bytes.size() != 8 * elements(array.shape)) refuse(name + " of another size");
    for (size_t i = 0; i < bytes.size(); i += 8) {
      std::uint64_t bits = 0;
      for (size_t b = 8; b-- > 0;) bits = bits << 8 | bytes[i + b];
      double number;
      memcpy(&number, &bits, 8);
      if (!(std::abs(number) < HUGE_VAL)) refuse("a constant of " + name + " that is not finite");
      array.values.push_back(number);
    }
    if (!facts.constants.emplace(name, array).second) refuse("two constants named " + name);
  }
  for (const Json& row : list_of(field(table, "the Program", "outputs"), "outputs")) {
    const vector<Json>& parts = list_of(row, "an output");
    if (parts.size() != 3) refuse("an output that is not name, shape and value");
    const string name = text_of(parts[0], "an output's name");
    if (!facts.outputs.emplace(name, elements(shape_of(parts[1], name))).second)
      refuse("two outputs named " + name);
  }
  return facts;
}

Box box_of(const Json& table, const string& what) {
  only(table, what, {"low", "high"});
  Box box{};
  for (const char* end : {"low", "high"}) {
    const vector<Json>& corner = list_of(field(table, what, end), "a corner");
    if (corner.size() != 2) refuse("a corner that is not two numbers");
    for (size_t axis = 0; axis < 2; ++axis)
      (end[0] == 'l' ? box.low : box.high)[axis] = hexadecimal(corner[axis], "a corner");
  }
  const double first[2] = {-0.05, 0.0}, last[2] = {1.05, 1.0};
  for (int axis = 0; axis < 2; ++axis)
    if (!(first[axis] <= box.low[axis] && box.low[axis] <= box.high[axis] &&
          box.high[axis] <= last[axis]))
      refuse(what + " that is no box of the chart");
  return box;
}

Statement statement_of(const Json& table, const std::map<string, Output>& outputs) {
  only(table, "a statement",
       {"conditions", "region", "scales", "bounds", "degree", "root", "tree"});
  Statement s;
  s.region = text_of(field(table, "a statement", "region"), "a region's name");
  s.tree = text_of(field(table, "a statement", "tree"), "a tree");
  if (s.tree.empty() || s.tree.find_first_not_of("01") != string::npos)
    refuse("a tree that is no string of 0 and 1");
  s.root_box = box_of(field(table, "a statement", "root"), "a root box");
  const int degree = integer_of(field(table, "a statement", "degree"), "a degree");
  if (degree != 1 && degree != 2) refuse("a degree other than 1 and 2");
  const vector<string> names = names_of(field(table, "a statement", "conditions"), "conditions");
  if (names.empty()) refuse("a statement about nothing");
  const Json& scales = field(table, "a statement", "scales");
  const Json& bounds = field(table, "a statement", "bounds");
  only(scales, "the scales", names);
  only(bounds, "the bounds", names);
  for (const string& name : names) {
    const auto output = outputs.find(name);
    if (output == outputs.end()) refuse(name + ", which is no output of the Program");
    Claim claim;
    claim.name = name;
    claim.scale = number_of(field(scales, "the scales", name), "a scale");
    claim.bound = number_of(field(bounds, "the bounds", name), "a bound");
    claim.output = &output->second;
    if (!(claim.scale > 0.0)) refuse("a scale that is not positive, for " + name);
    if (!of_theorem(name) && !(claim.bound >= 0.0)) refuse("a negative bound, for " + name);
    s.claims.push_back(claim);
  }
  return s;
}

// What a statement about a premise stands under, where one about a condition has its region.
string label_of(const string& premise) {
  if (premise.rfind("set/", 0) == 0) return "walking set";
  return premise == "orbit/expansion" || premise == "orbit/gain" ? "return map" : "orbit";
}

// A statement about a condition is one about its region, in its scale; beyond the ends of a step a
// theorem needs it on the strips. Outputs of theorems have no scale.
void match(const Statement& s, const ProofFile& file) {
  for (const Claim& claim : s.claims) {
    const auto found = of_theorem(claim.name) ? file.conditions.end()
                                              : file.conditions.find(claim.name);
    const double scale = found == file.conditions.end() ? 1.0 : found->second.scale;
    if (scale != claim.scale)
      throw Inconsistent{claim.name + " has the scale " + brief(scale) + ", " +
                         brief(claim.scale) + " in a statement"};
    const bool beyond = s.root_box.low[0] < 0.0 || s.root_box.high[0] > 1.0;
    const bool premise = found == file.conditions.end();
    const string region = premise ? label_of(claim.name) : beyond ? "strips" : found->second.region;
    if (region != s.region)
      throw Inconsistent{claim.name + " has the region " + region + ", " + s.region +
                         " in a statement"};
    if (premise || beyond) continue;
    const vector<Box>& boxes = file.regions.at(found->second.region);
    if (std::none_of(boxes.begin(), boxes.end(),
                     [&](const Box& box) { return same(box, s.root_box); }))
      throw Inconsistent{"a statement about " + claim.name +
                         " whose root is no box of the region " + region};
  }
}

vector<double> series_of(const Json& value, const string& what) {
  vector<double> series;
  for (const Json& item : list_of(value, what)) series.push_back(hexadecimal(item, what));
  if (series.empty() || series.size() > 1000) refuse(what + " without numbers, or with too many");
  return series;
}

// 1 + x to the nearest double, as whoever wrote the boxes of T has it.
double one_and(double x) {
  std::fesetround(FE_TONEAREST);
  volatile double one = 1.0, other = x, sum = one + other;
  std::fesetround(FE_UPWARD);
  return sum;
}

WalkingSet walking_set_of(const Json& table) {
  const string what = "level 2";
  only(table, what, {"start_strip", "guard_strip", "risen", "falling", "disturbance", "barriers",
                     "carried"});
  const auto number = [&](const char* name) { return hexadecimal(field(table, what, name), name); };
  WalkingSet t;
  t.start_strip = number("start_strip");
  t.guard_strip = number("guard_strip");
  t.risen = number("risen");
  t.falling = number("falling");
  t.first = -t.start_strip;
  t.before = one_and(-t.guard_strip);
  t.last = one_and(t.guard_strip);
  const vector<double> push = series_of(field(table, what, "disturbance"), "a disturbance");
  if (push.size() != 2 || !(push[0] >= 0.0 && push[1] >= 0.0))
    refuse("a disturbance that is not two numbers from 0 up");
  std::copy(push.begin(), push.end(), t.push);
  t.barriers = names_of(field(table, what, "barriers"), "barriers");
  t.carried = names_of(field(table, what, "carried"), "carried conditions");
  return t;
}

Orbit orbit_of(const Json& table, const Tube& tube) {
  const string what = "level 3";
  only(table, what, {"attraction", "guard_from", "guard_to", "lower", "upper", "expansion",
                     "slowest", "fastest"});
  const auto series = [&](const char* name) { return series_of(field(table, what, name), name); };
  const string attraction = text_of(field(table, what, "attraction"), "attraction");
  if (attraction != "contraction" && attraction != "nested tubes")
    refuse("attraction by " + attraction);
  Orbit o;
  o.nested = attraction == "nested tubes";
  o.thin.lower = series("lower");
  o.thin.upper = series("upper");
  o.thin.start = tube.start;
  o.thin.guard = tube.guard;
  o.expansion = series("expansion");
  o.slowest = series("slowest");
  o.fastest = series("fastest");
  o.guard_from = hexadecimal(field(table, what, "guard_from"), "guard_from");
  o.guard_to = hexadecimal(field(table, what, "guard_to"), "guard_to");
  return o;
}

// Levels 2 and 3, in this order, and whether anything is claimed of them.
Theorems theorems_of(const Json& list, const Tube& tube) {
  Theorems found;
  for (const Json& table : list_of(list, "the theorems")) {
    only(table, "a theorem", {"level", "claimed", "parameters"});
    const int level = integer_of(field(table, "a theorem", "level"), "a level");
    const Json& claimed = field(table, "a theorem", "claimed");
    const Json& parameters = field(table, "a theorem", "parameters");
    if (claimed.type != Json::boolean) refuse("a theorem that is neither claimed nor not");
    if (level == 2 && !found.walking) {
      found.walking = walking_set_of(parameters);
      found.walking->claimed = claimed.number_value != 0.0;
    } else if (level == 3 && found.walking && !found.orbit) {
      found.orbit = orbit_of(parameters, tube);
      found.orbit->claimed = claimed.number_value != 0.0;
    } else {
      refuse("theorems that are not of level 2, then 3");
    }
  }
  return found;
}

// Parameters of policy, tube and theorems that the Program has by name are those of the file.
void match(const Constants& constants, const Json& model, const Theorems& theorems) {
  std::map<string, vector<double>> lists;
  if (const auto& t = theorems.walking; t) lists["walking.disturbance"] = {t->push, t->push + 2};
  if (const auto& o = theorems.orbit; o) {
    lists["orbit.lower"] = o->thin.lower;
    lists["orbit.upper"] = o->thin.upper;
    lists["orbit.expansion"] = o->expansion;
    lists["orbit.slowest"] = o->slowest;
    lists["orbit.fastest"] = o->fastest;
  }
  for (const auto& [name, constant] : constants) {
    if (const auto list = lists.find(name); list != lists.end()) {
      if (constant.values != list->second)
        throw Inconsistent{"the theorem's " + name + " is not that of the Program"};
      continue;
    }
    // Those of policy and tube were compared when they were read.
    const size_t dot = name.find('.');
    const string owner = name.substr(0, dot);
    const Json& arrays =
        owner == "tube" ? *model.find("tube") : *model.find("policy")->find("arrays");
    if ((owner != "tube" && owner != "policy") || !arrays.find(name.substr(dot + 1)))
      throw Inconsistent{"the Program has the parameter " + name + ", which the file has not"};
  }
}

// Every output of the Program with its meaning.
std::map<string, Output> outputs_of(const ProgramFacts& program, const ProofFile& file) {
  const Theorems& theorems = file.theorems;
  std::map<string, Output> found;
  for (const auto& [name, elements] : program.outputs) {
    Output& output = found[name];
    // Premises have a slash in their names and conditions have none, so neither hides the other.
    if (!of_theorem(name)) {
      const auto condition = file.conditions.find(name);
      if (condition == file.conditions.end())
        throw Inconsistent{"the Program's output " + name + " is no condition of the spec"};
      output = output_of(condition->second);
      output.elements = elements;
      continue;
    }
    const auto known = theorem_outputs().find(name);
    const bool of_set = name.rfind("set/", 0) == 0 && theorems.walking;
    const bool of_orbit = name.rfind("orbit/", 0) == 0 && theorems.orbit;
    const size_t space = name.find(' ');
    if (known != theorem_outputs().end() && (of_set || of_orbit)) {
      output = output_of(name, known->second);
    } else if (of_set && space != string::npos) {
      const string what = name.substr(0, space), barrier = name.substr(space + 1);
      if (what != "set/after" && what != "set/value" && what != "set/rate")
        throw Inconsistent{"the Program's output " + name + " is no theorem's"};
      const auto about = file.conditions.find(barrier);
      if (about == file.conditions.end())
        throw Inconsistent{"the Program's output " + name + " is about no condition of the spec"};
      output = output_of(what, about->second);
    } else {
      throw Inconsistent{"the Program's output " + name + " is no premise of the file's theorems"};
    }
    output.elements = elements;
  }
  return found;
}

void read_regions(const Json& table, Regions& regions) {
  if (table.type != Json::object) refuse("regions that are no JSON object");
  for (size_t i = 0; i < table.names.size(); ++i) {
    only_a_name(table.names[i], "a region");
    for (const Json& row : list_of(table.items[i], "a region")) {
      const Box box = box_of(row, "a box of a region");
      if (box.low[0] < 0.0 || box.high[0] > 1.0) refuse("a region beyond the ends of a step");
      regions[table.names[i]].push_back(box);
    }
    if (regions[table.names[i]].empty()) refuse("the region " + table.names[i] + " without boxes");
  }
}

void read_conditions(const Json& table, const ProgramFacts& program, ProofFile& file) {
  if (table.type != Json::object) refuse("conditions that are no JSON object");
  for (size_t i = 0; i < table.names.size(); ++i) {
    const string& name = table.names[i];
    only_a_name(name, "a condition");
    const Condition condition = condition_of(table.items[i], file.model.robot.joints());
    if (!program.outputs.count(name))
      throw Inconsistent{"the spec's condition " + name + " is no output of the Program"};
    if (!file.regions.count(condition.region))
      throw Inconsistent{name + " is about the region " + condition.region + ", which is none"};
    file.conditions[name] = condition;
  }
}

// The file, filled in place: its outputs refer to its conditions.
void read_proof(const Json& table, ProofFile& file) {
  if (table.type == Json::object && table.find("format") &&
      integer_of(*table.find("format"), "a format") != 2)
    refuse("the format " + table.find("format")->string_value);
  only(table, "the file", {"format", "kind", "robot", "weights_sha256", "spec", "program",
                           "program_hash", "chart", "statements", "theorems", "model"});
  const auto text = [&](const char* name) { return text_of(*table.find(name), name); };
  if (text("kind") != "neuralgaits certificate") refuse("the kind '" + text("kind") + "'");
  if (text("chart") != "u = (phase, level)") refuse("the chart '" + text("chart") + "'");
  file.robot = named(*table.find("robot"), "robot").name;
  file.spec = named(*table.find("spec"), "spec").name;
  file.weights_sha256 = text("weights_sha256");
  const vector<Json>& theorems = list_of(*table.find("theorems"), "the theorems");
  if (theorems.size() == 1 &&
      integer_of(field(theorems[0], "a theorem", "level"), "a level") == 4)
    throw Unknown{"the full-order theorem (level 4)"};

  const ProgramFacts program = program_facts(*table.find("program"));
  string written;
  canonical(*table.find("program"), written);
  const string hash = sha256(written);
  if (hash != text("program_hash"))
    throw Inconsistent{"the Program's hash is " + hash + ", not " + text("program_hash")};

  const Json& model = *table.find("model");
  if (model.type == Json::null)
    throw Unknown{"a policy of the user's own, or one with learned residuals,"};
  only(model, "the model", {"robot", "policy", "tube", "regions", "conditions"});
  file.model.robot = robot_of(*model.find("robot"));
  if (file.model.robot.name != file.robot)
    throw Inconsistent{"the file is about " + file.robot + ", its model is that of " +
                       file.model.robot.name};
  file.model.policy =
      policy_of(*model.find("policy"), file.model.robot.joints(), program.constants);
  file.model.tube = tube_of(*model.find("tube"), file.model.policy, program.constants);
  read_regions(*model.find("regions"), file.regions);
  read_conditions(*model.find("conditions"), program, file);
  file.theorems = theorems_of(*table.find("theorems"), file.model.tube);
  match(program.constants, model, file.theorems);
  file.outputs = outputs_of(program, file);
  for (const Json& row : list_of(*table.find("statements"), "the statements"))
    file.statements.push_back(statement_of(row, file.outputs));
  if (file.statements.empty()) refuse("no statements");
  for (const Statement& statement : file.statements) match(statement, file);
}

// ---------------------------------------------------------------------------- 14 the command

string read_file(const string& path) {
  string text;
  FILE* file = std::fopen(path.c_str(), "rb");
  if (!file) refuse("nothing to read");
  char block[65536];
  size_t count = 0;
  while ((count = std::fread(block, 1, sizeof block, file)) > 0) text.append(block, count);
  const bool failed = std::ferror(file) != 0;  // A folder, for one.
  std::fclose(file);
  if (failed) refuse("nothing to read");
  return text;
}

// Boxes of conditions without a statement.
vector<string> unclaimed(const ProofFile& file) {
  vector<string> found;
  for (const auto& [name, condition] : file.conditions)
    for (const Box& box : file.regions.at(condition.region)) {
      const auto about = [&, &name = name](const Statement& s) {
        return same(s.root_box, box) &&
               std::any_of(s.claims.begin(), s.claims.end(),
                           [&](const Claim& claim) { return claim.name == name; });
      };
      if (std::none_of(file.statements.begin(), file.statements.end(), about))
        found.push_back(name + words_for(box));
    }
  return found;
}

// What the claimed levels say, in words, if it follows from the statements.
std::map<int, vector<string>> concluded(const ProofFile& file) {
  std::map<int, vector<string>> found;
  const auto& [walking, orbit] = file.theorems;
  int level = 2;
  try {
    const bool third = orbit && orbit->claimed;
    if ((walking && walking->claimed) || third) found[2] = Conclusions(file).walking();
    level = 3;
    if (third) found[3] = Conclusions(file).attraction();
  } catch (const DoesNotFollow& missing) {
    throw Inconsistent{"level " + std::to_string(level) + " does not follow: " + missing.why};
  } catch (const NoBound&) {
    throw Inconsistent{"level " + std::to_string(level) + " does not follow: numbers too large"};
  }
  return found;
}

// "12 boxes, 0.34 s"
string effort(long boxes, std::chrono::steady_clock::time_point start) {
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  char text[40];
  snprintf(text, sizeof text, "%ld boxes, %.2f s", boxes, taken.count());
  return text;
}

// Checks one statement and prints it.
Finding check(const ProofFile& file, const Statement& s) {
  const auto start = std::chrono::steady_clock::now();
  const Finding found = Checker(file.model, file.theorems, s).run();
  static const char* const words[] = {"proved", "undecided", "rejected"};
  say(s.region + "," + words_for(s.root_box) + "; " + effort(found.boxes, start) + ": " +
      words[found.verdict]);
  for (const Claim& claim : s.claims) {
    const Output& output = *claim.output;
    say("  " + claim.name + ": " +
        (output.unknown.empty() ? output.words(claim.least().low())
                                : "not known here: " + output.unknown));
  }
  fflush(stdout);
  return found;
}

// Every number of robot, policy and tube that the statements depend on; weights by their hash.
void say_model(const ProofFile& file) {
  const Robot& robot = file.model.robot;
  const Policy& policy = file.model.policy;
  const Tube& tube = file.model.tube;
  say("robot " + file.robot + ": " + std::to_string(robot.links) + " links, " +
      at_least(robot.weight_mass.low()) + " kg");
  for (const string& line : robot.words) say("  " + line);
  string layers = "2";
  for (const Layer& layer : policy.layers) layers += "-" + std::to_string(layer.rows);
  say("policy " + layers + (policy.softplus ? ", softplus" : ", tanh") +
      (policy.hybrid_invariant ? ", between postures before and after the impact" : "") +
      (policy.z2_dependence ? "" : ", of z1 alone") + "; the file says that its weights have the sha256 " + file.weights_sha256 +
      ", which is not checked here");
  for (size_t j = 0; j < policy.lower.size(); ++j)
    say("  joint " + std::to_string(j) + ": outputs between " + brief(policy.lower[j]) + " and " +
        brief(policy.upper[j]) + " rad");
  say("  z1 from " + brief(policy.start) + " m after the impact to " + brief(policy.guard) +
      " m at the guard");
  say("tube, z1 from " + brief(tube.start) + " m at phase 0 to " + brief(tube.guard) +
      " m at phase 1");
  for (const double phase : {0.0, 0.5, 1.0}) {
    const Fences<I> f = fences(tube, I(phase));
    say("  at phase " + brief(phase) + ": z2 between " + at_least(root(I(2.0) * f.lower).low()) +
        " and " + at_most(root(I(2.0) * f.upper).high()) + " kg m^2/s");
  }
  say("spec " + file.spec + ": " + std::to_string(file.conditions.size()) + " conditions");
}

int check(const ProofFile& file) {
  say_model(file);
  // What is quickly seen to be wrong comes first.
  for (const Statement& s : file.statements) leaves(s);
  const auto levels = concluded(file);
  const auto start = std::chrono::steady_clock::now();
  Finding worst;
  long boxes = 0;
  size_t claims = 0;
  for (const Statement& s : file.statements) {
    const Finding found = check(file, s);
    boxes += found.boxes;
    claims += s.claims.size();
    if (found.verdict > worst.verdict) worst = found;
    if (worst.verdict == rejected) break;
  }
  const vector<string> missing = unclaimed(file);
  for (const string& box : missing) say("no statement about " + box);
  string answer = "proved of the robot, policy and spec above: " + std::to_string(claims) +
                  " claims of " + std::to_string(file.conditions.size()) + " conditions";
  if (worst.verdict == proved)
    for (const auto& [level, words] : levels) {
      say("level " + std::to_string(level) + " proved");
      for (const string& line : words) say("  " + line);
      answer += ", level " + std::to_string(level);
    }
  if (worst.verdict == proved && !missing.empty())
    worst = {undecided, "every statement holds, but conditions have none on " +
                            std::to_string(missing.size()) + " boxes of their regions", 0};
  if (worst.verdict != proved)
    answer = (worst.verdict == rejected ? "rejected: " : "undecided: ") + worst.reason;
  say(answer + "; " + effort(boxes, start));
  return worst.verdict == proved ? 0 : worst.verdict == rejected ? 1 : 3;
}

// One double of the tests' questions, written in hexadecimal.
double asked(std::istream& in) {
  Json word;
  word.type = Json::text;
  in >> word.string_value;
  return hexadecimal(word, "a number");
}

// For tests: enclosures of all outputs over boxes "low low high high" of (phase, level).
int answer_bounds(const ProofFile& file, std::istream& in) {
  while (in >> std::ws, in.good()) {
    Box box{};
    for (double& x : box.low) x = asked(in);
    for (double& x : box.high) x = asked(in);
    Place at(file.model, file.theorems, box);
    for (const auto& [name, output] : file.outputs) {
      if (!output.unknown.empty()) continue;
      try {
        size_t element = 0;
        for (const TM& margin : output.margins(at)) {
          const I r = range(margin);
          printf("%s\t%zu\t%a\t%a\n", name.c_str(), element++, r.low(), r.high());
        }
      } catch (const NoBound&) {  // The box is too wide.
        printf("%s\tno bound\n", name.c_str());
      }
    }
    printf("\n");
  }
  return 0;
}

// For tests: enclosures of elementary functions at doubles, "name number" a line.
int answer_functions(std::istream& in) {
  string name;
  while (in >> name) {
    const double x = asked(in);
    I r;
    if (name == "exp") r = exp_at(x);
    else if (name == "tanh") r = tanh_at(x);
    else if (name == "logistic") r = logistic_at(x);
    else if (name == "softplus") r = softplus_at(x);
    else if (name == "log1p") r = log1p_of(I(x));
    else if (name == "sin") r = sincos_at(x).sine;
    else if (name == "cos") r = sincos_at(x).cosine;
    else if (name == "sqrt") r = root(I(x));
    else if (name == "inverse") r = inverse(I(x));
    else refuse("the function " + name);
    printf("%a %a\n", r.low(), r.high());
  }
  return 0;
}

int run(const vector<string>& arguments) {
  const bool functions = arguments.size() == 1 && arguments[0] == "--functions";
  const bool bounds = arguments.size() == 2 && arguments[0] == "--bounds";
  if (!functions && !bounds && arguments.size() != 1) {
    fprintf(stderr, "expected one proof file: proofcheck FILE\n");
    return 2;
  }
  const string path = arguments.back();
  try {
    // Decimals are read in the default rounding mode; everything after that rounds upward.
    Json table;
    if (!functions) {
      const string text = read_file(path);
      table = JsonReader(text).document();
    }
    if (!rounding_works()) {
      fprintf(stderr, "this processor or compiler does not round as proofcheck needs it\n");
      return 70;
    }
    if (functions) return answer_functions(std::cin);
    ProofFile file;
    read_proof(table, file);
    return bounds ? answer_bounds(file, std::cin) : check(file);
  } catch (const NotAProof& problem) {
    say("expected a proof file of format 2, found in " + path + ": " + problem.why +
            "; certify its run again",
        stderr);
    return 2;
  } catch (const Inconsistent& problem) {
    say("rejected: " + problem.why);
    return 1;
  } catch (const Unknown& problem) {
    say("undecided: " + problem.what + " cannot be checked here");
    return 3;
  } catch (const NoBound&) {
    printf("undecided: a number of the model is too large or a denominator zero\n");
    return 3;
  } catch (const std::exception& problem) {  // Out of memory.
    say("expected to read " + path + ", found the machine at its end: " + problem.what(), stderr);
    return 3;
  }
}

}  // namespace

int main(int count, char** values) { return run(vector<string>(values + 1, values + count)); }
