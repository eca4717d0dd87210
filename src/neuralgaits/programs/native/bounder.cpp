// Taylor models of degree 2 of a Program's outputs over many boxes: the rules of
// programs/algebras/taylor_algebra.py, as many boxes at a time as a register holds, on all cores.
//
// A value is a run of elements. An element is its coefficients, in the order 1, e_1 .. e_n, e_i e_j for
// i <= j, then of the symbols that stand for remainders (programs/remainder_symbols.py), then of the
// elements of xi in the unit ball, and the radius of the remainder, each a vector over these boxes. What is added to the remainder for rounding is what the Python rules add: it exceeds the rounding of an operation many
// times over, whatever order its sums are in. Nothing here is trusted: the checkers decide.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <thread>
#include <vector>

namespace {

// As many as the processor's registers hold: longer vectors are taken apart into single numbers.
#ifdef __AVX512F__
constexpr int kLanes = 8;
#else
constexpr int kLanes = 4;
#endif
typedef double V __attribute__((vector_size(kLanes * sizeof(double))));
typedef int64_t M __attribute__((vector_size(kLanes * sizeof(int64_t))));

constexpr double kSlack = 0x1p-44, kTiny = 1e-250, kLeast = 1e-50, kMost = 1e50;
constexpr double kTanhThird = 2.0, kTanhFourth = 4.1;
const double kNaN = std::numeric_limits<double>::quiet_NaN();

inline V all(double x) { return V{} + x; }
inline V size(V x) { return (V)((M)x & INT64_MAX); }
inline V least(V a, V b) { return a < b ? a : b; }
template <class F>
inline V each(V x, F f) {
  V y;
  for (int lane = 0; lane < kLanes; ++lane) y[lane] = f(x[lane]);
  return y;
}

enum Kind : int64_t {
  kMove, kAdd, kSub, kMul, kDiv, kNeg, kSquare, kSum, kAffine, kInner, kSqrt, kExp, kLog1p, kSin,
  kCos, kTanh, kLogistic
};

// An operand: elements of the workspace from `at` on, or of the constants from -1 - `at` on.
struct Operand {
  int64_t at, size;
};
// Its results get the symbols from `symbol` on, if that is not negative. `reads` says whether an
// operand may depend on symbols or on xi.
struct Operation {
  int64_t kind, out, size, columns, index, operands, symbol, reads;
  Operand operand[3];
};
constexpr int64_t kFields = 14;

// Of so many axes, symbols and elements of xi: compiled for each number, since each takes seconds.
constexpr int kAxes = NG_AXES, kSymbols = NG_SYMBOLS, kBall = NG_BALL;
constexpr int kLinear = 1 + kAxes, kTerms = kLinear + kAxes * (kAxes + 1) / 2;
constexpr int kNamed = kTerms + kSymbols, kAll = kNamed + kBall;

struct Element {
  V c[kAll];
  V r;
};

inline V root(V x) {
  return each(x, [](double y) { return std::sqrt(y); });
}

// The most that symbols and xi add: magnitudes of the former, the Euclidean length of the latter.
inline V length(const Element& a) {
  V sum = all(0.0), squares = all(0.0);
  for (int i = kTerms; i < kNamed; ++i) sum += size(a.c[i]);
  for (int i = kNamed; i < kAll; ++i) squares += a.c[i] * a.c[i];
  return kBall == 0 ? sum : sum + root(squares) * (1.0 + kSlack) + kTiny;
}

// The parts of an element that functions below need; All: whether it may depend on symbols or xi.
// If not, their coefficients are zero, and nobody reads them.
template <bool All>
struct Parts {
  static constexpr int kUsed = All ? kAll : kTerms;
  V linear, rest, spread, bound;

  explicit Parts(const Element& a) : linear(size(a.c[1])), rest(size(a.c[kLinear])) {
    for (int i = 2; i < kLinear; ++i) linear += size(a.c[i]);
    for (int i = kLinear + 1; i < kTerms; ++i) rest += size(a.c[i]);
    if (All) rest += length(a);
    spread = linear + rest;
    bound = size(a.c[0]) + spread;
  }
};

// The remainder grown by what the operation may have rounded; what is not used, zero.
template <bool All>
inline void rounded(Element& a, V more) {
  a.r += kSlack * (Parts<All>(a).bound + a.r + more) + kTiny;
  for (int i = Parts<All>::kUsed; i < kAll; ++i) a.c[i] = all(0.0);
}

inline void clear(Element& a) {
  for (V& c : a.c) c = all(0.0);
  a.r = all(0.0);
}

struct Expansion {
  V value, first, second, error, remainder;
};

inline Expansion relative(V value, V first, V second, V r, V remainder) {
  return {value, first, second, size(value) + size(first) * r + size(second) * r * r, remainder};
}
inline V within(V nearest, V farthest) {
  return (nearest >= kLeast) & (farthest <= kMost) ? nearest : all(kNaN);
}
inline V cube(V x) { return x * x * x; }
inline V up_to(double limit, V derivative, double slope, V r) {
  return least(all(limit), size(derivative) + slope * r * (1.0 + kSlack) + 1e-12);
}

inline Expansion reciprocal(V c, V r) {
  const V near = within(size(c) - r - kSlack * (size(c) + r), size(c) + r);
  const V v = 1.0 / c;
  return relative(v, -v * v, 2.0 * v * v * v, r, cube(r / near) / near);
}
inline Expansion expanded_tanh(V c, V r) {
  const V t = each(c, [](double x) { return std::tanh(x); }), slope = 1.0 - t * t;
  const V most = up_to(kTanhThird, slope * (6.0 * t * t - 2.0), kTanhFourth, r);
  return {t, slope, -2.0 * t * slope, size(t) + r + r * r, most * cube(r) / 6.0};
}
inline Expansion expanded(int64_t kind, V c, V r) {
  switch (kind) {
    case kSqrt: {
      const V near = within(c - r - kSlack * (size(c) + r), size(c) + r);
      const V v = root(c);
      const V edge = root(near);
      return relative(v, 0.5 / v, -0.25 / (v * v * v), r, 0.0625 * edge * cube(r / near));
    }
    case kLog1p: {
      const V far = 1.0 + size(c) + r, near = within(1.0 + c - r - kSlack * far, far);
      const V slope = 1.0 / (1.0 + c);
      const V v = each(c, [](double x) { return std::log1p(x); });
      return relative(v, slope, -slope * slope, r, cube(r / near) / 3.0);
    }
    case kExp: {
      const V v = each(c, [](double x) { return std::exp(x); });
      const V most = each(c + r + kSlack * (size(c) + r), [](double x) { return std::exp(x); });
      return relative(v, v, v, r, most * cube(r) / 6.0);
    }
    case kSin:
    case kCos: {
      const V s = each(c, [](double x) { return std::sin(x); });
      const V k = each(c, [](double x) { return std::cos(x); });
      const V most = up_to(1.0, kind == kSin ? k : s, 1.0, r);
      return kind == kSin ? relative(s, k, -s, r, most * cube(r) / 6.0)
                          : relative(k, -s, -k, r, most * cube(r) / 6.0);
    }
    case kTanh: return expanded_tanh(c, r);
    default: {
      const Expansion t = expanded_tanh(0.5 * c, 0.5 * r);
      return {0.5 + 0.5 * t.value, 0.25 * t.first, 0.125 * t.second, 0.5 + t.error,
              0.5 * t.remainder};
    }
  }
}

template <bool All>
void multiply(const Element& a, const Element& b, Element& y) {
  const Parts<All> pa(a), pb(b);
  Element out;
  out.c[0] = a.c[0] * b.c[0];
  for (int i = 1; i < Parts<All>::kUsed; ++i) out.c[i] = a.c[0] * b.c[i] + a.c[i] * b.c[0];
  for (int i = 0, pair = kLinear; i < kAxes; ++i) {
    out.c[pair++] += a.c[1 + i] * b.c[1 + i];
    for (int j = i + 1; j < kAxes; ++j)
      out.c[pair++] += a.c[1 + i] * b.c[1 + j] + a.c[1 + j] * b.c[1 + i];
  }
  out.r = a.r * (pb.bound + b.r) + b.r * pa.bound + pa.rest * pb.spread + pa.linear * pb.rest;
  rounded<All>(out, pa.bound * pb.bound);
  y = out;
}

template <bool All>
void unary(const Element& a, const Expansion& f, Element& y) {
  const Parts<All> p(a);
  const V half = 0.5 * f.second;
  Element out;
  out.c[0] = f.value;
  for (int i = 1; i < Parts<All>::kUsed; ++i) out.c[i] = f.first * a.c[i];
  for (int i = 0, pair = kLinear; i < kAxes; ++i) {
    out.c[pair++] += half * a.c[1 + i] * a.c[1 + i];
    for (int j = i + 1; j < kAxes; ++j) out.c[pair++] += f.second * a.c[1 + i] * a.c[1 + j];
  }
  out.r = size(f.first) * a.r + f.remainder +
          size(half) * (a.r * (2.0 * p.spread + a.r) + p.rest * p.spread + p.linear * p.rest);
  rounded<All>(out, f.error);
  y = out;
}

template <bool All>
V reach(const Element& a) {
  const V found = (Parts<All>(a).spread + a.r) * (1.0 + kSlack);
  return size(a.c[0]) < std::numeric_limits<double>::infinity() ? found : all(kNaN);
}

// Plus or minus the elements of another.
template <bool All>
void add(const Element& a, const Element& b, double sign, Element& y) {
  Element out;
  for (int i = 0; i < Parts<All>::kUsed; ++i) out.c[i] = a.c[i] + sign * b.c[i];
  out.r = a.r + b.r;
  rounded<All>(out, all(0.0));
  y = out;
}

class Bounder {
 public:
  using E = Element;

  Bounder(const int64_t* code, int64_t operations, const int64_t* index, int64_t indices,
            const double* constants, int64_t count, const int64_t* outputs, int64_t output_count,
            int64_t workspace)
      : index_(index, index + indices), centres_(constants, constants + count),
        radii_(constants + count, constants + 2 * count), workspace_(workspace) {
    for (int64_t k = 0; k < operations; ++k) {
      const int64_t* f = code + k * kFields;
      Operation op = {f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7], {}};
      for (int64_t j = 0; j < 3; ++j) op.operand[j] = {f[8 + 2 * j], f[9 + 2 * j]};
      operations_.push_back(op);
    }
    for (int64_t k = 0; k < output_count; ++k)
      outputs_.push_back({outputs[2 * k], outputs[2 * k + 1]});
  }

  void bounds(const double* low, const double* high, int64_t boxes, int threads, double* lower,
              double* upper) const {
    std::atomic<int64_t> next{0};
    const auto work = [&] {
      const std::unique_ptr<E[]> space(new (std::align_val_t(64)) E[static_cast<size_t>(workspace_)]);
      for (int64_t first; (first = next.fetch_add(kLanes)) < boxes;)
        over(space.get(), low, high, first, std::min<int64_t>(kLanes, boxes - first), lower, upper);
    };
    std::vector<std::thread> others;
    for (int k = 1; k < threads && k * kLanes < boxes; ++k) others.emplace_back(work);
    work();
    for (std::thread& one : others) one.join();
  }

 protected:
  std::vector<Operation> operations_;
  std::vector<int64_t> index_;
  std::vector<double> centres_, radii_;
  std::vector<Operand> outputs_;
  int64_t workspace_;

  void enter(E* space, const double* low, const double* high, int64_t first, int64_t lanes) const {
    for (int axis = 0; axis < kAxes; ++axis) {
      E& u = space[axis];
      clear(u);
      for (int lane = 0; lane < kLanes; ++lane) {
        const int64_t box = first + std::min<int64_t>(lane, lanes - 1);
        const double a = low[box * kAxes + axis], b = high[box * kAxes + axis];
        const double centre = a + (b - a) * 0.5;
        u.c[0][lane] = centre;
        u.c[1 + axis][lane] = std::max(b - centre, centre - a) * (1.0 + 0x1p-51);
      }
    }
    for (int i = 0; i < kBall; ++i) {
      clear(space[kAxes + i]);
      space[kAxes + i].c[kNamed + i] = all(1.0);
    }
  }

  // An element of an operand; a constant is put into `spare`.
  const E& at(const E* space, const Operand& a, int64_t i, E& spare) const {
    const int64_t place = a.size == 1 ? 0 : i;
    return fetch(space, a.at < 0 ? a.at - place : a.at + place, spare);
  }
  const E& fetch(const E* space, int64_t place, E& spare) const {
    if (place >= 0) return space[place];
    clear(spare);
    spare.c[0] = all(centres_[static_cast<size_t>(-1 - place)]);
    spare.r = all(radii_[static_cast<size_t>(-1 - place)]);
    return spare;
  }

  void over(E* space, const double* low, const double* high, int64_t first, int64_t lanes,
            double* lower, double* upper) const {
    enter(space, low, high, first, lanes);
    for (const Operation& op : operations_) {
      op.reads ? apply<true>(op, space) : apply<false>(op, space);
      if (op.symbol >= 0) name(op, space);
    }
    const int64_t count = static_cast<int64_t>(outputs_.size());
    for (int64_t k = 0; k < count; ++k) {
      V least_low = all(HUGE_VAL), least_high = all(HUGE_VAL);
      E spare;
      for (int64_t i = 0; i < outputs_[static_cast<size_t>(k)].size; ++i) {
        V a, b;
        range(at(space, outputs_[static_cast<size_t>(k)], i, spare), a, b);
        // NaN wins: it is no bound.
        least_low = (a < least_low) | (a != a) ? a : least_low;
        least_high = (b < least_high) | (b != b) ? b : least_high;
      }
      for (int64_t lane = 0; lane < lanes; ++lane) {
        lower[(first + lane) * count + k] = least_low[lane];
        upper[(first + lane) * count + k] = least_high[lane];
      }
    }
  }

  // What is left of each result gets a symbol of its own: then it cancels where it meets itself.
  static void name(const Operation& op, E* space) {
    for (int64_t i = 0; i < op.size; ++i) {
      E& result = space[op.out + i];
      result.c[kTerms + op.symbol + i] = result.r;
      result.r = all(0.0);
    }
  }

  static void range(const E& a, V& low, V& high) {
    const Parts<true> parts(a);
    const V straight = parts.linear + length(a) + a.r;
    low = a.c[0] - straight;
    high = a.c[0] + straight;
    for (int i = 0, pair = kLinear; i < kAxes; ++i)
      for (int j = i; j < kAxes; ++j, ++pair) {
        const V q = a.c[pair];
        // A square is between 0 and 1, a mixed product between -1 and 1.
        low += i == j ? least(q, all(0.0)) : -size(q);
        high += i == j ? -least(-q, all(0.0)) : size(q);
      }
    const V slack = kSlack * (parts.bound + a.r) + kTiny;
    low -= slack;
    high += slack;
  }

  template <bool All>
  void apply(const Operation& op, E* space) const {
    E one, two;
    E* out = space + op.out;
    switch (op.kind) {
      case kMove:
        for (int64_t i = 0; i < op.size; ++i) {
          const E& from = fetch(space, index_[static_cast<size_t>(op.index + i)], one);
          out[i] = from;
        }
        return;
      case kAffine: return affine<All>(op, space);
      case kSum:
      case kInner: return sum<All>(op, space);
      default: break;
    }
    for (int64_t i = 0; i < op.size; ++i) {
      const E& a = at(space, op.operand[0], i, one);
      switch (op.kind) {
        case kAdd: add<All>(a, at(space, op.operand[1], i, two), 1.0, out[i]); break;
        case kSub: add<All>(a, at(space, op.operand[1], i, two), -1.0, out[i]); break;
        case kMul: multiply<All>(a, at(space, op.operand[1], i, two), out[i]); break;
        case kSquare: multiply<All>(a, a, out[i]); break;
        case kDiv: {
          const E& b = at(space, op.operand[1], i, two);
          E inverse;
          unary<All>(b, reciprocal(b.c[0], reach<All>(b)), inverse);
          multiply<All>(a, inverse, out[i]);
          break;
        }
        case kNeg:
          for (int k = 0; k < kAll; ++k) out[i].c[k] = -a.c[k];
          out[i].r = a.r;
          break;
        default: unary<All>(a, expanded(op.kind, a.c[0], reach<All>(a)), out[i]);
      }
    }
  }

  template <bool All>
  void sum(const Operation& op, E* space) const {
    const int64_t count = op.operand[0].size / op.size;
    for (int64_t i = 0; i < op.size; ++i) {
      E total, one, two, product;
      clear(total);
      V magnitude = all(0.0);
      for (int64_t j = i * count; j < (i + 1) * count; ++j) {
        const E* term = &at(space, op.operand[0], j, one);
        if (op.kind == kInner) {
          multiply<All>(*term, at(space, op.operand[1], j, two), product);
          term = &product;
        }
        for (int k = 0; k < Parts<All>::kUsed; ++k) total.c[k] += term->c[k];
        total.r += term->r;
        magnitude += Parts<All>(*term).bound;
      }
      total.r += static_cast<double>(count) * kSlack / 16.0 * (magnitude + total.r);
      rounded<All>(total, all(0.0));
      space[op.out + i] = total;
    }
  }

  template <bool All>
  void affine(const Operation& op, E* space) const {
    const int64_t rows = op.size / op.columns, inner = op.operand[1].size / op.columns;
    const int64_t matrix = -1 - op.operand[0].at;
    E one, two;
    std::vector<V> magnitude(static_cast<size_t>(inner));
    for (int64_t column = 0; column < op.columns; ++column) {
      for (int64_t k = 0; k < inner; ++k) {
        const E& x = at(space, op.operand[1], k * op.columns + column, one);
        magnitude[static_cast<size_t>(k)] = Parts<All>(x).bound + x.r;
      }
      for (int64_t row = 0; row < rows; ++row) {
        E total;
        clear(total);
        for (int64_t k = 0; k < inner; ++k) {
          const E& x = at(space, op.operand[1], k * op.columns + column, one);
          const auto place = static_cast<size_t>(matrix + row * inner + k);
          const double w = centres_[place], wide = std::abs(w);
          for (int i = 0; i < Parts<All>::kUsed; ++i) total.c[i] += w * x.c[i];
          const V m = magnitude[static_cast<size_t>(k)];
          total.r += wide * (x.r + static_cast<double>(inner) * kSlack / 16.0 * m) + radii_[place] * m;
        }
        rounded<All>(total, all(0.0));
        if (op.operands == 3) {
          E sum;
          add<All>(total, at(space, op.operand[2], row, two), 1.0, sum);
          total = sum;
        }
        space[op.out + row * op.columns + column] = total;
      }
    }
  }
};

#include "symbol_choice.hpp"

}  // namespace

extern "C" {

// A bounder of a Program in NG_AXES axes with at most NG_SYMBOLS symbols, and xi of NG_BALL elements.
void* ng_bounder(const int64_t* code, int64_t operations, const int64_t* index,
                 int64_t indices, const double* constants, int64_t count, const int64_t* outputs,
                 int64_t output_count, int64_t workspace) {
  return new Bounder(code, operations, index, indices, constants, count, outputs, output_count,
                     workspace);
}

// Bounds on the smallest element of each output over boxes [boxes, axes]: [boxes, outputs] each.
void ng_bounds(const void* bounder, const double* low, const double* high, int64_t boxes,
               int threads, double* lower, double* upper) {
  static_cast<const Bounder*>(bounder)->bounds(low, high, boxes, threads, lower, upper);
}

// Numbers of the operations whose remainders should have symbols, for bounds on the outputs over one
// box, of code that reuses no places. Returns how many; -1 where an output has no bound.
int64_t ng_choose_symbols(const int64_t* code, int64_t operations, const int64_t* index,
                          int64_t indices, const double* constants, int64_t count,
                          const int64_t* outputs, int64_t output_count, int64_t workspace,
                          const double* low, const double* high, double least_gain,
                          int64_t* chosen) {
  return SymbolChoice(code, operations, index, indices, constants, count, outputs, output_count,
                      workspace)
      .choose(low, high, least_gain, chosen);
}

void ng_forget(void* bounder) { delete static_cast<Bounder*>(bounder); }
}
