#pragma once

#include "taylor.hpp"

#include <tuple>

namespace {

// ------------------------------------------------------------------------------ 5 formulas
//
// What the sections below compute they compute with numbers of any kind: with Taylor models of one
// box, or with formulas. An operation on formulas is written down instead of carried out, as an
// element behind those of its operands; the same operation on the same operands is one element. What
// was written down once is then bounded on many boxes (sections 16 and 17).

// One number, with how it follows from others.
struct Element {
  enum Kind { axis, fibre, number, negative, plus, minus, times, scaled, row, expanded };
  Kind kind;
  vector<size_t> operands;  // Of a row: k_1, t_1, k_2, t_2, .. and perhaps c; the k_i are doubles.
  size_t which = 0;         // Of an axis or a fibre.
  I value;                  // Of a number.
  Expansion (*near)(double, double) = nullptr;
  std::uint32_t needs = 0;  // A bit for each axis that it depends on, and kXi.

  bool is_double() const { return kind == number && value.low() == value.high(); }
};
constexpr std::uint32_t kXi = std::uint32_t{1} << kMostAxes;

// Adds an element, what it depends on being what its operands do.
size_t added(vector<Element>& elements, Element element) {
  for (const size_t operand : element.operands) element.needs |= elements[operand].needs;
  elements.push_back(std::move(element));
  return elements.size() - 1;
}

class Recording {
 public:
  vector<Element> elements;

  size_t add(const Element& e) {
    const Key key(e.kind, e.operands, e.which, e.value.n, e.value.h,
                  reinterpret_cast<std::uintptr_t>(e.near));
    const auto found = known_.find(key);
    if (found != known_.end()) return found->second;
    return known_[key] = added(elements, e);
  }
  size_t number(I value) { return add({Element::number, {}, 0, value, nullptr, 0}); }

 private:
  using Key = std::tuple<int, vector<size_t>, size_t, double, double, std::uintptr_t>;
  std::map<Key, size_t> known_;
};

// A number that is known, or an element of a recording.
class Formula {
 public:
  Formula(I value = I(0.0)) : value_(value) {}
  Formula(double value) : value_(value) {}
  static Formula axis(Recording& in, size_t which) {
    return {in, {Element::axis, {}, which, I(0.0), nullptr, std::uint32_t{1} << which}};
  }
  // A coefficient of xi.
  static Formula fibre(Recording& in, size_t which) {
    return {in, {Element::fibre, {}, which, I(0.0), nullptr, kXi}};
  }

  bool known() const { return !in_; }
  bool is(double number) const { return known() && value_.n == -number && value_.h == number; }
  // Where it is written down; of one that is not known.
  Recording& recording() const { return *in_; }
  // Its element of a recording.
  size_t of(Recording& in) const { return known() ? in.number(value_) : at_; }

  friend Formula operator-(const Formula& a) {
    return a.known() ? Formula(-a.value_) : Formula(*a.in_, Element::negative, {a.at_});
  }
  friend Formula operator+(const Formula& a, const Formula& b) {
    if (a.known() && b.known()) return a.value_ + b.value_;
    if (a.is(0.0)) return b;
    return b.is(0.0) ? a : both(Element::plus, a, b);
  }
  friend Formula operator-(const Formula& a, const Formula& b) {
    if (a.known() && b.known()) return a.value_ - b.value_;
    if (a.is(0.0)) return -b;
    return b.is(0.0) ? a : both(Element::minus, a, b);
  }
  friend Formula operator*(const Formula& a, const Formula& b) {
    if (a.known() && b.known()) return a.value_ * b.value_;
    if (b.known()) return b * a;
    if (a.is(0.0)) return a;
    if (a.is(1.0)) return b;
    if (a.is(-1.0)) return -b;
    return both(a.known() ? Element::scaled : Element::times, a, b);
  }
  friend Formula operator*(I k, const Formula& a) { return Formula(k) * a; }
  friend Formula inverse(const Formula& a) { return expanded(inverse_near, a); }
  friend Formula operator/(const Formula& a, const Formula& b) { return a * inverse(b); }
  friend Formula root(const Formula& a) { return expanded(root_near, a); }
  friend Formula exp(const Formula& a) { return expanded(exp_near, a); }
  friend Formula tanh(const Formula& a) { return expanded(tanh_near, a); }
  friend Formula logistic(const Formula& a) { return expanded(logistic_near, a); }
  friend Formula softplus(const Formula& a) { return expanded(softplus_near, a); }
  friend Formula logit(const Formula& a) { return expanded(logit_near, a); }
  friend Formula arctan(const Formula& a) { return expanded(arctan_near, a); }
  friend void sincos(const Formula& a, Formula& sine, Formula& cosine) {
    sine = expanded(sin_near, a);
    cosine = expanded(cos_near, a);
  }

  // sum_i weights_i terms_i + offset
  friend Formula weighted(const double* weights, const vector<Formula>& terms,
                          const Formula& offset) {
    I rest = offset.known() ? offset.value_ : I(0.0);
    Recording* in = offset.in_;
    vector<size_t> operands;
    for (size_t i = 0; i < terms.size(); ++i) {
      if (terms[i].known()) {
        rest = rest + I(weights[i]) * terms[i].value_;
      } else if (weights[i] != 0.0) {
        in = terms[i].in_;
        operands.insert(operands.end(), {in->number(I(weights[i])), terms[i].at_});
      }
    }
    if (operands.empty()) return Formula(rest) + (offset.known() ? Formula(0.0) : offset);
    const bool none = rest.n == 0.0 && rest.h == 0.0;
    if (!offset.known()) operands.push_back((none ? offset : offset + Formula(rest)).at_);
    else if (!none) operands.push_back(in->number(rest));
    return {*in, Element::row, std::move(operands)};
  }

 private:
  I value_;
  Recording* in_ = nullptr;
  size_t at_ = 0;

  Formula(Recording& in, const Element& element) : in_(&in), at_(in.add(element)) {}
  Formula(Recording& in, Element::Kind kind, vector<size_t> operands)
      : Formula(in, {kind, std::move(operands), 0, I(0.0), nullptr, 0}) {}

  static Formula both(Element::Kind kind, const Formula& a, const Formula& b) {
    Recording& in = a.known() ? *b.in_ : *a.in_;
    return {in, kind, {a.of(in), b.of(in)}};
  }
  static Formula expanded(Expansion (*near)(double, double), const Formula& a) {
    if (!a.known()) return {*a.in_, {Element::expanded, {a.at_}, 0, I(0.0), near, 0}};
    const double m = middle(a.value_);
    const I d = a.value_ - I(m);
    const double reach = magnitude(d);
    const Expansion f = near(m, reach);
    return f.f + f.slope * d + f.curve * square(d) + symmetric(f.third * reach * reach * reach / 6.0);
  }
};

// What multiplies a number of some kind and is the same in all states of a step: a formula of the
// commands, or an interval where there are none.
template <class S>
struct ScalarOf {
  using type = I;
};
template <>
struct ScalarOf<Formula> {
  using type = Formula;
};
template <class T>
struct ScalarOf<DualOf<T>> : ScalarOf<T> {};
template <class S>
using Scalar = typename ScalarOf<S>::type;

inline DualOf<Formula> operator*(const Formula& k, const DualOf<Formula>& a) {
  return {k * a.v, k * a.d};
}

}  // namespace
