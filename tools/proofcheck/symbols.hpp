#pragma once

#include "lanes.hpp"
#include "recorded_formulas.hpp"

namespace {

// ------------------------------------------------------------------ 18 remainders with symbols
//
// A remainder counts wherever its element is read, though it is one number everywhere: an output that
// depends on the element with derivative d gets not |d| r of it but p r, p the sum of the magnitudes of
// all paths from one to the other. As an element of f (section 16) it counts with |d| r. So the element
// with the largest r (p - |d|), in units of the outputs' own remainders, is named first; and then p and
// r are found again. Which are named decides how near bounds come, not whether they are true.

// How many may be named; and of an output's remainder, the least part for which one is worth its time.
// Off zero more are: terms of second order in xi do not shrink with boxes, and many share what is lost.
struct SymbolLimits { size_t most; double least_gain; };
constexpr SymbolLimits kSymbols = {16, 0.005}, kSymbolsOffZero = {32, 0.002};
// Of a region, the part on which remainders are compared: the next one where some are infinite.
constexpr double kShares[] = {0.05, 0.005, 5e-4, 5e-5};

// About the middle of a region.
Box middle_of(const Box& region, double share) {
  Box box = region;
  for (size_t axis = 0; axis < box.low.size(); ++axis) {
    const double centre = 0.5 * (region.low[axis] + region.high[axis]);
    const double half = 0.5 * share * (region.high[axis] - region.low[axis]);
    box.low[axis] = std::max(region.low[axis], centre - half);
    box.high[axis] = std::min(region.high[axis], centre + half);
  }
  return box;
}

// An element on a box: its constant coefficient and its remainder.
struct Found {
  double centre = 0.0, remainder = 0.0;
};

class SymbolChoice {
 public:
  SymbolChoice(const vector<Element>& elements, vector<size_t> outputs, double least_gain)
      : elements_(elements), outputs_(std::move(outputs)), least_gain_(least_gain),
        named_(elements.size()) {}

  // The element whose remainder is named next; none if none is worth it.
  std::optional<size_t> next(const vector<Found>& found) {
    if (whole_.empty())
      for (const size_t output : outputs_) whole_.push_back(found[output].remainder);
    vector<double> gains(elements_.size());
    double most = 0.0;
    for (size_t m = 0; m < outputs_.size(); ++m) {
      if (!(whole_[m] > 0.0 && whole_[m] < HUGE_VAL)) continue;
      reach(found, outputs_[m]);
      for (size_t k = 0; k <= outputs_[m]; ++k) {
        const double gain = found[k].remainder * (paths_[k] - std::abs(slopes_[k])) / whole_[m];
        if (!(gain > 0.0 && gain < HUGE_VAL) || named_[k]) continue;
        gains[k] += gain;
        most = std::max(most, gain);
      }
    }
    if (most < least_gain_) return {};
    const auto best = std::max_element(gains.begin(), gains.end());
    const auto number = static_cast<size_t>(best - gains.begin());
    named_[number] = true;
    return number;
  }

 private:
  const vector<Element>& elements_;
  const vector<size_t> outputs_;
  const double least_gain_;
  vector<bool> named_;
  vector<double> whole_;          // Remainders of the outputs, before any was named.
  vector<double> slopes_, paths_;  // Of an output, by each element: d and p.

  // Goes back from an output to all that it is made of.
  void reach(const vector<Found>& found, size_t output) {
    slopes_.assign(elements_.size(), 0.0);
    paths_.assign(elements_.size(), 0.0);
    slopes_[output] = paths_[output] = 1.0;
    for (size_t k = output + 1; k-- > 0;) {
      if (paths_[k] == 0.0) continue;
      if (named_[k]) paths_[k] = std::abs(slopes_[k]);
      const vector<size_t>& from = elements_[k].operands;
      const auto carry = [&](size_t operand, double slope) {
        slopes_[operand] += slope * slopes_[k];
        paths_[operand] += std::abs(slope) * paths_[k];
      };
      switch (elements_[k].kind) {
        case Element::axis:
        case Element::fibre:
        case Element::number: break;
        case Element::negative: carry(from[0], -1.0); break;
        case Element::plus:
          carry(from[0], 1.0);
          carry(from[1], 1.0);
          break;
        case Element::minus:
          carry(from[0], 1.0);
          carry(from[1], -1.0);
          break;
        case Element::times:
          carry(from[0], found[from[1]].centre);
          carry(from[1], found[from[0]].centre);
          break;
        case Element::scaled: carry(from[1], found[from[0]].centre); break;
        case Element::row:
          for (size_t m = 0; m + 1 < from.size(); m += 2)
            carry(from[m + 1], elements_[from[m]].value.high());
          if (from.size() % 2) carry(from.back(), 1.0);
          break;
        case Element::expanded:
          try {
            carry(from[0], middle(elements_[k].near(found[from[0]].centre, 0.0).slope));
          } catch (const NoBound&) {  // Nothing is known of what is behind it.
          }
      }
    }
  }
};

}  // namespace
