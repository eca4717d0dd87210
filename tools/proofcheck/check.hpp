#pragma once

#include "full_order.hpp"

namespace {

// ------------------------------------------------------------------------------ 12 the check
//
// A statement: on a box of the chart, each output has at least its bound, in its scale. The tree
// says how the box was halved. Every leaf is bounded anew, and split further if that is not enough.

// LEVEL/NAME: an output of a theorem. Others are conditions, whose bounds are not negative.
bool of_theorem(const string& output) { return output.find('/') != string::npos; }

string interval_words(double low, double high) {
  return low == high ? brief(low) : "[" + brief(low) + ", " + brief(high) + "]";
}

// "phase in [0, 1]", of a part of the axis.
string axis_words(const Axis& axis, double low, double high) {
  const string words = axis.name + " in " + interval_words(low, high);
  return axis.near() ? words + ", at most " + brief(axis.change) + " from the one before" : words;
}

// More axes beside phase and level than this are named once, with the chart.
constexpr size_t kNamedEach = 6;

bool is_all(const Box& box, const Chart& chart, size_t axis) {
  return box.low[axis] == chart[axis].low && box.high[axis] == chart[axis].high;
}

// " for phase in ... and level in ..."
string words_for(const Box& box, const Chart& chart) {
  size_t named = box.low.size();
  if (named > 2 + kNamedEach) {
    named = 2;
    for (size_t axis = 2; axis < box.low.size(); ++axis)
      if (!is_all(box, chart, axis)) named = box.low.size();
  }
  string words = " for ";
  for (size_t axis = 0; axis < named; ++axis) {
    if (axis) words += axis + 1 < box.low.size() ? ", " : " and ";
    words += axis_words(chart[axis], box.low[axis], box.high[axis]);
  }
  if (named < box.low.size())
    words += " and all of the chart's other " + std::to_string(box.low.size() - named) + " axes";
  return words;
}

// " at phase ..., level ..."
string words_for(const vector<double>& point, const Chart& chart) {
  string words = " at ";
  for (size_t axis = 0; axis < point.size(); ++axis)
    words += (axis ? ", " : "") + chart[axis].name + " " + brief(point[axis]);
  return words;
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
  Box root_box;
};

double halfway(const Box& box, size_t axis) {
  return box.low[axis] + (box.high[axis] - box.low[axis]) * 0.5;
}

// Both halves along an axis end at the same double, so they cover the box whatever that is.
std::pair<Box, Box> halves(const Box& box, size_t axis) {
  std::pair<Box, Box> parts = {box, box};
  parts.first.high[axis] = parts.second.low[axis] = halfway(box, axis);
  return parts;
}

// What an axis is written as in a tree.
constexpr char kAxisSigns[] = "0123456789abcdef";
static_assert(sizeof kAxisSigns == kMostAxes + 1);

// The boxes at which a statement's tree ends: a digit is a split along that axis, the lower half
// first; - is a leaf.
vector<Box> leaves(const Statement& statement) {
  constexpr int kMostHalvings = 48;  // Of one axis: more would exhaust a double's digits.
  const string &tree = statement.tree, name = "the tree of " + statement.region;
  struct Node {
    Box box;
    std::array<int, kMostAxes> halvings;
  };
  vector<Node> stack = {{statement.root_box, {}}};
  vector<Box> found;
  size_t at = 0;
  while (!stack.empty()) {
    Node node = std::move(stack.back());
    stack.pop_back();
    if (at == tree.size()) throw Inconsistent{name + " ends before its last leaf"};
    const char sign = tree[at++];
    if (sign == '-') {
      found.push_back(std::move(node.box));
      continue;
    }
    const size_t axis = string(kAxisSigns).find(sign);
    if (axis >= node.box.low.size()) throw Inconsistent{name + " splits an axis that is none"};
    if (!(node.box.low[axis] < node.box.high[axis]) || node.halvings[axis]++ == kMostHalvings)
      throw Inconsistent{name + " splits what has no width"};
    auto [lower, upper] = halves(node.box, axis);
    stack.push_back({std::move(upper), node.halvings});
    stack.push_back({std::move(lower), node.halvings});
  }
  if (at != tree.size()) throw Inconsistent{name + " goes on after its last leaf"};
  return found;
}

// Margins of claims on one box, and what gives them: claims that are not asked for need no bound.
using Margins = std::function<vector<Estimate>(const Claim&)>;
using Bounding = std::function<Margins(const Box&, const vector<const Claim*>&)>;

// By the formulas of this program.
Bounding by_the_model(const Model& model, const Theorems& theorems) {
  return [&model, &theorems](const Box& box, const vector<const Claim*>&) -> Margins {
    const auto place = std::make_shared<Place>(model, theorems, box);
    return [place](const Claim& claim) { return claim.output->margins(*place); };
  };
}

enum Verdict { proved, undecided, rejected };

struct Finding {
  Verdict verdict = proved;
  string reason;
  long boxes = 0;
};

class Checker {
 public:
  Checker(const Bounding& bounding, const Chart& chart, const Statement& statement)
      : bounding_(bounding), chart_(chart), statement_(statement) {}

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
  static constexpr int kMoreSplits = 6;   // How often a leaf may be split again along each axis.
  static constexpr size_t kMostMore = 1 << 18;  // Boxes for one leaf: in many axes it would not end.
  static constexpr size_t kCorners = 3;   // With more axes, corners are too many to be tried.
  const Bounding& bounding_;
  const Chart& chart_;
  const Statement& statement_;
  Finding found_;
  size_t more_ = 0;

  Verdict note(Verdict verdict, const string& reason) {
    if (verdict > found_.verdict) {
      found_.verdict = verdict;
      found_.reason = reason;
    }
    return verdict;
  }

  static vector<Estimate> evaluate(const Claim& claim, const Margins& margins) {
    vector<Estimate> found = margins(claim);
    if (found.size() != claim.output->elements)
      throw Inconsistent{claim.name + " has " + std::to_string(found.size()) +
                         " elements in the model, " + std::to_string(claim.output->elements) +
                         " in the Program"};
    return found;
  }

  // A claim that is not proved on a box, and its worst margin if that has a bound.
  struct Failing {
    const Claim* claim;
    std::optional<Estimate> worst;
  };

  vector<Failing> failing(const Box& box, const vector<const Claim*>& claims) {
    vector<Failing> left;
    ++found_.boxes;
    const Margins margins = bounding_(box, claims);
    for (const Claim* claim : claims) {
      try {
        const vector<Estimate> found = evaluate(*claim, margins);
        const auto worst = std::min_element(
            found.begin(), found.end(),
            [](const Estimate& a, const Estimate& b) { return a.range.low() < b.range.low(); });
        if (worst == found.end()) left.push_back({claim, {}});
        else if (!(worst->range.low() >= claim->least().high())) left.push_back({claim, *worst});
      } catch (const NoBound&) {
        left.push_back({claim, {}});
      }
    }
    return left;
  }

  // The axis along which to halve: the one with most influence on the worst margin, or the longest.
  std::optional<size_t> axis_to_halve(const Box& box, const vector<Failing>& left) const {
    std::optional<size_t> best;
    double most = 0.0;
    for (size_t axis = 0; axis < box.low.size(); ++axis) {
      if (!(box.low[axis] < box.high[axis])) continue;
      double weight = (box.high[axis] - box.low[axis]) / (chart_[axis].high - chart_[axis].low);
      for (const Failing& one : left)
        if (one.worst && one.claim == left[0].claim) weight = one.worst->influence[axis];
      if (!best || weight > most) {
        best = axis;
        most = weight;
      }
    }
    return best;
  }

  Verdict prove(const Box& box, const vector<const Claim*>& claims, size_t depth) {
    if (!is_asked(box, chart_)) return proved;
    more_ = depth == 0 ? 0 : more_ + 1;
    const vector<Failing> left = failing(box, claims);
    if (left.empty()) return proved;
    vector<const Claim*> again;
    for (const Failing& one : left) {
      if (refuted(box, one)) return rejected;
      again.push_back(one.claim);
    }
    const std::optional<size_t> axis = axis_to_halve(box, left);
    if (!axis || depth == kMoreSplits * box.low.size() || more_ > kMostMore)
      return note(undecided, left[0].claim->name + " does not reach its bound" +
                                 words_for(box, chart_) + " of region " + statement_.region +
                                 " after " + std::to_string(depth) +
                                 " more splits, and no point of it breaks it");
    const auto [lower, upper] = halves(box, *axis);
    for (const Box* part : {&lower, &upper}) {
      const Verdict verdict = prove(*part, again, depth + 1);
      if (verdict != proved) return verdict;
    }
    return proved;
  }

  // The centre of a box, all corners if they are few, and where the worst margin seems least.
  static vector<vector<double>> points(const Box& box, const std::optional<Estimate>& worst) {
    const size_t axes = box.low.size();
    vector<vector<double>> found(1);
    for (size_t axis = 0; axis < axes; ++axis) found[0].push_back(halfway(box, axis));
    if (worst) {
      found.push_back(found[0]);
      for (size_t axis = 0; axis < axes; ++axis) {
        const double reach = 0.5 * (box.high[axis] - box.low[axis]) * worst->least_at[axis];
        found[1][axis] = std::clamp(found[1][axis] + reach, box.low[axis], box.high[axis]);
      }
    }
    if (axes <= kCorners)
      for (size_t corner = 0; corner < size_t{1} << axes; ++corner) {
        found.push_back(box.low);
        for (size_t axis = 0; axis < axes; ++axis)
          if (corner >> axis & 1) found.back()[axis] = box.high[axis];
      }
    return found;
  }

  // Whether the claim certainly fails at one of these points.
  bool refuted(const Box& box, const Failing& one) {
    const Claim& claim = *one.claim;
    const I least = claim.least();
    for (const vector<double>& at : points(box, one.worst)) {
      if (!is_asked({at, at}, chart_)) continue;
      try {
        const Box here = {at, at};
        for (const Estimate& margin : evaluate(claim, bounding_(here, {&claim}))) {
          if (!(margin.range.high() < least.low())) continue;
          note(rejected, claim.name + " is " + at_least(margin.range.low()) +
                             words_for(at, chart_) + " of region " + statement_.region +
                             ", less than " + at_least(least.low()));
          return true;
        }
      } catch (const NoBound&) {  // Nothing is certain at this point.
      }
    }
    return false;
  }
};

}  // namespace
