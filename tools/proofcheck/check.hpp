#pragma once

#include "outputs.hpp"

#include <atomic>
#include <exception>
#include <system_error>
#include <thread>

namespace {

// ------------------------------------------------------------------------------ 15 the check
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

// The boxes at which a statement's tree ends, one after the other: a digit is a split along that
// axis, the lower half first; - is a leaf.
class Leaves {
 public:
  explicit Leaves(const Statement& statement)
      : tree_(statement.tree), name_("the tree of " + statement.region),
        box_(statement.root_box) {}

  const Box& box() const { return box_; }

  // Goes to the next leaf, the first one at first. Whether there is one.
  bool next() {
    if (at_ > 0 && !to_an_upper_half()) {
      if (at_ != tree_.size()) throw Inconsistent{name_ + " goes on after its last leaf"};
      return false;
    }
    while (true) {
      if (at_ == tree_.size()) throw Inconsistent{name_ + " ends before its last leaf"};
      const char sign = tree_[at_++];
      if (sign == '-') return true;
      split(static_cast<size_t>(std::find(kAxisSigns, kAxisSigns + kMostAxes, sign) - kAxisSigns));
    }
  }

 private:
  static constexpr int kMostHalvings = 48;  // Of one axis: more would exhaust a double's digits.
  // A box that was split: its ends along that axis, and whether its lower half is done.
  struct Split {
    size_t axis;
    double low, high;
    bool upper;
  };
  const string& tree_;
  const string name_;
  Box box_;
  size_t at_ = 0;
  vector<Split> path_;  // Those around box_, the root first.
  std::array<int, kMostAxes> halvings_{};

  void split(size_t axis) {
    if (axis >= box_.low.size()) throw Inconsistent{name_ + " splits an axis that is none"};
    if (!(box_.low[axis] < box_.high[axis]) || halvings_[axis]++ == kMostHalvings)
      throw Inconsistent{name_ + " splits what has no width"};
    path_.push_back({axis, box_.low[axis], box_.high[axis], false});
    box_.high[axis] = halfway(box_, axis);
  }

  // From the last leaf of a lower half to the upper one.
  bool to_an_upper_half() {
    while (!path_.empty()) {
      Split& last = path_.back();
      if (!last.upper) {
        box_.low[last.axis] = box_.high[last.axis];
        box_.high[last.axis] = last.high;
        return last.upper = true;
      }
      box_.low[last.axis] = last.low;
      --halvings_[last.axis];
      path_.pop_back();
    }
    return false;
  }
};

// Throws if a statement's tree is none.
void read_tree(const Statement& statement) {
  for (Leaves leaves(statement); leaves.next();) {}
}

// What bounds claims on boxes, several at once. Each thread has one of its own.
class Bounder {
 public:
  virtual ~Bounder() = default;
  virtual size_t most_boxes() const = 0;
  // Says that boxes will lie in this one.
  virtual void within(const Box&) {}
  // Takes these boxes up: what follows is about them. Other claims need no bound.
  virtual void over(const vector<const Box*>& boxes, const vector<const Claim*>& claims) = 0;
  // Margins of a claim on one of the boxes.
  virtual vector<Estimate> margins(size_t box, const Claim& claim) = 0;
  // A lower bound of the least of them.
  virtual double least(size_t box, const Claim& claim) {
    double found = HUGE_VAL;
    for (const Estimate& margin : margins(box, claim)) found = std::min(found, margin.range.low());
    return found;
  }
};
using Bounding = std::function<std::unique_ptr<Bounder>()>;

// By the formulas of this program.
class ModelBounder : public Bounder {
 public:
  ModelBounder(const Model& model, const Theorems& theorems) : model_(model), theorems_(theorems) {}
  size_t most_boxes() const override { return 1; }
  void over(const vector<const Box*>& boxes, const vector<const Claim*>&) override {
    const Box& box = *boxes[0];
    place_.emplace(model_, model_.step, theorems_, coordinate<TM>(box.low[0], box.high[0], 0),
                   coordinate<TM>(box.low[1], box.high[1], 1));
  }
  vector<Estimate> margins(size_t, const Claim& claim) override {
    vector<Estimate> found = claim.output->margins(*place_);
    if (found.size() != claim.output->elements)
      throw Inconsistent{claim.name + " has " + std::to_string(found.size()) +
                         " elements in the model, " + std::to_string(claim.output->elements) +
                         " in the Program"};
    return found;
  }

 private:
  const Model& model_;
  const Theorems& theorems_;
  std::optional<Place<TM>> place_;
};

Bounding by_the_model(const Model& model, const Theorems& theorems) {
  return [&model, &theorems] { return std::make_unique<ModelBounder>(model, theorems); };
}

enum Verdict { proved, undecided, rejected };

struct Finding {
  Verdict verdict = proved;
  string reason;
  long boxes = 0;
};

// Whether a leaf, or what it is split into, has its claims; or a point of it breaks one. Leaves know
// nothing of each other.
class LeafChecker {
 public:
  LeafChecker(Bounder& bounder, const Chart& chart, const Statement& statement)
      : bounder_(bounder), chart_(chart), statement_(statement) {}

  // Whether each of a few boxes has all claims, at the first look.
  void look(const vector<const Box*>& boxes, const vector<const Claim*>& claims,
            vector<bool>& reached) {
    bounder_.over(boxes, claims);
    for (size_t k = 0; k < boxes.size(); ++k)
      reached[k] = std::all_of(claims.begin(), claims.end(), [&](const Claim* claim) {
        try {
          return bounder_.least(k, *claim) >= claim->least().high();
        } catch (const NoBound&) {
          return false;
        }
      });
  }

  // Ends early, with nothing found, once nobody waits for the answer.
  Finding check(const Box& leaf, const vector<const Claim*>& claims,
                const std::function<bool()>& awaited) {
    found_ = {};
    more_ = 0;
    awaited_ = &awaited;
    leaf_ = &leaf;
    prove(leaf, claims, 0);
    // The part that ended it need not be the one with a point that breaks it.
    if (found_.verdict == undecided && awaited())
      for (const Failing& one : failing(leaf, claims))
        if (refuted(leaf, one)) break;
    return found_;
  }

 private:
  static constexpr int kMoreSplits = 6;   // How often a leaf may be split again, times its axes.
  static constexpr size_t kMostMore = 1 << 18;  // Boxes for one leaf: in many axes it would not end.
  static constexpr double kMostlyTold = 4.0;  // Twice what coefficients make a range wide.
  static constexpr size_t kCorners = 3;   // With more axes, corners are too many to be tried.
  Bounder& bounder_;
  const Chart& chart_;
  const Statement& statement_;
  Finding found_;
  size_t more_ = 0;
  const Box* leaf_ = nullptr;
  const std::function<bool()>* awaited_ = nullptr;

  Verdict note(Verdict verdict, const string& reason) {
    if (verdict > found_.verdict) {
      found_.verdict = verdict;
      found_.reason = reason;
    }
    return verdict;
  }

  // A claim that is not proved on a box, and its worst margin if that has a bound.
  struct Failing {
    const Claim* claim;
    std::optional<Estimate> worst;
  };

  vector<Failing> failing(const Box& box, const vector<const Claim*>& claims) {
    vector<Failing> left;
    ++found_.boxes;
    bounder_.over({&box}, claims);
    for (const Claim* claim : claims) {
      try {
        const vector<Estimate> found = bounder_.margins(0, *claim);
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

  // The axis along which to halve: the one with most influence on the worst margin. Of a range that
  // is wide mostly by what has a higher degree, which no coefficient tells of, and without a bound,
  // the one halved least since the leaf; among those, the one that the leaf is shortest in, which the
  // finder saw fit to halve most.
  std::optional<size_t> axis_to_halve(const Box& box, const vector<Failing>& left) const {
    const std::optional<Estimate>& worst = left[0].worst;
    bool told = false;
    if (worst) {
      double influence = 0.0;
      for (size_t axis = 0; axis < box.low.size(); ++axis) influence += worst->influence[axis];
      told = worst->range.high() - worst->range.low() < kMostlyTold * influence;
    }
    std::optional<size_t> best;
    double most = 0.0;
    for (size_t axis = 0; axis < box.low.size(); ++axis) {
      if (!(box.low[axis] < box.high[axis])) continue;
      const double whole = leaf_->high[axis] - leaf_->low[axis];
      const double length = whole / (chart_[axis].high - chart_[axis].low);
      const double weight =
          told ? worst->influence[axis]
               : (box.high[axis] - box.low[axis]) / whole * (1.0 + 0.1 / (1.0 + length));
      if (!best || weight > most) {
        best = axis;
        most = weight;
      }
    }
    return best;
  }

  Verdict prove(const Box& box, const vector<const Claim*>& claims, size_t depth) {
    if (!is_asked(box, chart_)) return proved;
    if (!(*awaited_)()) return note(undecided, "a leaf that nobody asked for");
    if (depth > 0) ++more_;
    const vector<Failing> left = failing(box, claims);
    if (left.empty()) return proved;
    vector<const Claim*> again;
    for (const Failing& one : left) again.push_back(one.claim);
    const std::optional<size_t> axis = axis_to_halve(box, left);
    // Points are looked at last: what halving does not prove is small by then, and they are dear.
    if (!axis || depth == kMoreSplits * box.low.size() || more_ > kMostMore) {
      for (const Failing& one : left)
        if (refuted(box, one)) return rejected;
      return note(undecided, left[0].claim->name + " does not reach its bound" +
                                 words_for(box, chart_) + " of region " + statement_.region +
                                 " after " + std::to_string(depth) +
                                 " more splits, and no point of it breaks it");
    }
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
        bounder_.over({&here}, {&claim});
        for (const Estimate& margin : bounder_.margins(0, claim)) {
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

// Threads that bound boxes.
size_t all_threads() {
  return std::clamp<size_t>(std::thread::hardware_concurrency(), 1, 8);
}

class Checker {
 public:
  // `told` hears every now and then which share of the leaves is done.
  using Told = std::function<void(double)>;

  Checker(const Bounding& bounding, const Chart& chart, const Statement& statement, size_t threads,
          Told told)
      : chart_(chart), statement_(statement), told_(std::move(told)),
        count_(static_cast<double>(std::count(statement.tree.begin(), statement.tree.end(), '-'))) {
    for (const Claim& claim : statement_.claims)
      if (claim.output->unknown.empty()) known_.push_back(&claim);
    for (size_t k = 0; k < threads; ++k) {
      bounders_.push_back(bounding());
      bounders_[k]->within(statement_.root_box);
      checkers_.push_back(std::make_unique<LeafChecker>(*bounders_[k], chart_, statement_));
    }
  }

  // A leaf that is undecided does not end the search for a point that breaks the statement. Leaves
  // are bounded by several threads, and answers looked at in the leaves' order, up to the first that
  // is rejected: what is found does not depend on the number of threads.
  Finding run() {
    for (const Claim& claim : statement_.claims)
      if (!claim.output->unknown.empty())
        note({undecided, claim.name + " cannot be checked here: " + claim.output->unknown, 0});
    if (known_.empty()) return found_;
    Leaves leaves(statement_);
    for (bool more = true; more && found_.verdict != rejected;) {
      leaves_.clear();
      const double before = passed_;
      for (; leaves_.size() < kBlock && (more = leaves.next()); ++passed_)
        if (is_asked(leaves.box(), chart_)) leaves_.push_back(leaves.box());
      check_leaves(before);
      for (const Answer& answer : answers_) {
        if (answer.problem) std::rethrow_exception(answer.problem);
        note(answer.finding);
        if (found_.verdict == rejected) break;
      }
    }
    return found_;
  }

 private:
  static constexpr size_t kBlock = 1 << 16, kWorthAThread = 64;
  struct Answer {
    Finding finding = {undecided, "a leaf was not looked at", 0};
    std::exception_ptr problem;  // Instead, if the file contradicts itself.
    bool ends() const { return problem || finding.verdict == rejected; }
  };
  const Chart& chart_;
  const Statement& statement_;
  const Told told_;
  const double count_;   // Leaves of the statement,
  double passed_ = 0.0;  // and of these, those that were gone to.
  vector<const Claim*> known_;
  vector<std::unique_ptr<Bounder>> bounders_;  // One for each thread, as are these:
  vector<std::unique_ptr<LeafChecker>> checkers_;
  vector<Box> leaves_;      // Some of the statement's.
  vector<Answer> answers_;  // What was found of them.
  Finding found_;

  void note(const Finding& finding) {
    found_.boxes += finding.boxes;
    if (finding.verdict <= found_.verdict) return;
    found_.verdict = finding.verdict;
    found_.reason = finding.reason;
  }

  // Leaves over the same commands one after the other, and of these, over the same phases: a bounder
  // keeps what depends on nothing else.
  vector<size_t> neighbours() const {
    vector<size_t> found(leaves_.size()), axes;
    for (size_t k = 0; k < found.size(); ++k) found[k] = k;
    for (size_t axis = 2; axis < chart_.size(); ++axis) axes.push_back(axis);
    for (const size_t axis : {0, 1}) axes.push_back(axis);
    std::sort(found.begin(), found.end(), [&](size_t a, size_t b) {
      for (const size_t axis : axes) {
        if (leaves_[a].low[axis] != leaves_[b].low[axis])
          return leaves_[a].low[axis] < leaves_[b].low[axis];
        if (leaves_[a].high[axis] != leaves_[b].high[axis])
          return leaves_[a].high[axis] < leaves_[b].high[axis];
      }
      return a < b;
    });
    return found;
  }

  // No leaf is left out before the first, by its number, that ends the search.
  void check_leaves(double before) {
    answers_.assign(leaves_.size(), {});
    const vector<size_t> order = neighbours();
    std::atomic<size_t> next{0}, end{leaves_.size()};
    const size_t at_once = bounders_[0]->most_boxes();
    const auto work = [&](size_t thread) {
      for (size_t first; (first = next.fetch_add(at_once)) < order.size();) {
        vector<size_t> some;
        for (size_t k = first; k < std::min(first + at_once, order.size()); ++k)
          if (order[k] < end) some.push_back(order[k]);
        if (!some.empty()) check_some(*checkers_[thread], some, end);
        const double share = static_cast<double>(first) / static_cast<double>(order.size());
        if (thread == 0) told_((before + share * (passed_ - before)) / count_);
      }
    };
    const size_t count = std::min(bounders_.size(), 1 + leaves_.size() / kWorthAThread);
    vector<std::thread> others;
    for (size_t k = 1; k < count; ++k) try {
        others.emplace_back([&work, k] {
          if (!rounding_works()) std::abort();  // It works in the thread that this one is from.
          work(k);
        });
      } catch (const std::system_error&) {  // There are no more threads.
        break;
      }
    work(0);
    for (std::thread& other : others) other.join();
  }

  void check_some(LeafChecker& checker, const vector<size_t>& some, std::atomic<size_t>& end) {
    vector<const Box*> boxes;
    for (const size_t k : some) boxes.push_back(&leaves_[k]);
    vector<bool> reached(boxes.size());
    try {
      checker.look(boxes, known_, reached);
    } catch (...) {  // Whatever it is, it is met again at the leaf that it is due to.
    }
    for (size_t i = 0; i < some.size(); ++i) {
      const size_t k = some[i];
      if (k >= end) continue;
      Answer& answer = answers_[k];
      if (reached[i]) {
        answer.finding = {proved, "", 1};
        continue;
      }
      try {
        answer.finding = checker.check(leaves_[k], known_, [&] { return k < end; });
      } catch (...) {
        answer.problem = std::current_exception();
      }
      for (size_t now = end; answer.ends() && k + 1 < now && !end.compare_exchange_weak(now, k + 1);) {}
    }
  }
};

}  // namespace
