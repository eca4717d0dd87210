#pragma once

#include "check.hpp"
#include "symbols.hpp"

namespace {

// ------------------------------------------------------------------------------ 17 listings
//
// Formulas are bounded on many boxes: those that this program derived of a gait that is told commands,
// or, on request, the Program: the list of operations in the file, as the finder worked with it. Of
// what that computes this section knows nothing, and shows nothing about the robot. Every value of it
// is a flat vector; an element for which there is no bound over a box is left out, and so is what
// needs it.

struct Operation {
  string kind;
  vector<size_t> operands;  // Numbers of earlier values: inputs, constants, operations.
  size_t size = 0;
  vector<size_t> index;     // Of a move: places in the joined operands.
  size_t columns = 1;       // Of an affine: of its right-hand matrix.
};

struct Program {
  size_t axes = 0, fibres = 0;       // Elements of u, and of xi if there is one.
  bool ball = false;                 // Whether there is.
  vector<vector<double>> constants;
  vector<Operation> operations;
  std::map<string, size_t> outputs;  // Numbers of values.
  vector<size_t> sizes;              // Of all values.
  vector<bool> varies;               // Whether they depend on an input.

  size_t inputs() const { return ball ? 2 : 1; }
  size_t first_operation() const { return inputs() + constants.size(); }
};

constexpr size_t kMostElements = size_t{1} << 20, kMostProducts = size_t{1} << 24,
                 kMostWork = size_t{1} << 23;

size_t counted(const Json& value, const string& what) {
  const int count = integer_of(value, what);
  if (count < 0) refuse(what + " that is negative");
  return static_cast<size_t>(count);
}

vector<size_t> counted_all(const Json& value, const string& what) {
  vector<size_t> found;
  for (const Json& item : list_of(value, what)) found.push_back(counted(item, what));
  return found;
}

bool is_elementwise(const string& kind, size_t operands) {
  static const std::set<string> unary = {"neg", "square", "sqrt", "exp",  "log1p",
                                         "sin", "cos",    "tanh", "logistic"};
  static const std::set<string> binary = {"add", "sub", "mul", "div"};
  return operands == 1 ? unary.count(kind) > 0 : operands == 2 && binary.count(kind) > 0;
}

// Whether sizes of operands and result fit the operation.
bool fits(const Program& program, const Operation& op) {
  const size_t count = op.operands.size();
  if (count == 0 || op.size == 0 || op.size > kMostElements) return false;
  const auto size = [&](size_t k) { return program.sizes[op.operands[k]]; };
  if (op.kind == "move") {
    size_t joined = 0;
    for (size_t k = 0; k < count; ++k) joined += size(k);
    return op.index.size() == op.size &&
           *std::max_element(op.index.begin(), op.index.end()) < joined;
  }
  if (op.kind == "affine") {
    if (count < 2 || count > 3 || op.columns == 0 || op.size % op.columns || size(1) % op.columns)
      return false;
    for (size_t k = 0; k < count; k += 2)
      if (program.varies[op.operands[k]]) return false;
    const size_t rows = op.size / op.columns, inner = size(1) / op.columns;
    return size(0) == rows * inner && (count == 2 || size(2) == rows) &&
           op.size * inner <= kMostProducts;
  }
  if ((op.kind == "sum" && count == 1) || (op.kind == "inner" && count == 2))
    return size(0) % op.size == 0 && size(0) == size(count - 1);
  if (!is_elementwise(op.kind, count)) return false;
  size_t widest = 1;
  for (size_t k = 0; k < count; ++k) {
    if (size(k) != 1 && size(k) != op.size) return false;
    widest = std::max(widest, size(k));
  }
  return widest == op.size;
}

// How many numbers an operation reads, multiplies and writes: a few lines can ask for any number.
size_t work_of(const Program& program, const Operation& op) {
  size_t work = op.size;
  for (const size_t operand : op.operands) work += program.sizes[operand];
  return op.kind == "affine" ? work + op.size * (program.sizes[op.operands[1]] / op.columns) : work;
}

Operation operation_of(const Json& row, size_t number) {
  const vector<Json>& parts = list_of(row, "an operation");
  if (parts.size() < 3) refuse("an operation that is not kind, operands and size");
  Operation op;
  op.kind = text_of(parts[0], "an operation's kind");
  op.operands = counted_all(parts[1], "operands");
  op.size = counted(parts[2], "an operation's size");
  const bool move = op.kind == "move", affine = op.kind == "affine";
  if (parts.size() != 3 + size_t(move || affine)) refuse("an operation with fields of another");
  if (move) op.index = counted_all(parts[3], "places of a move");
  if (affine) op.columns = counted(parts[3], "columns");
  for (const size_t operand : op.operands)
    if (operand >= number) refuse("an operation " + std::to_string(number) + " of later values");
  return op;
}

// The whole Program; `table` is known to have its fields, and each constant its size.
Program program_of(const Json& table, const vector<vector<double>>& constants) {
  Program program;
  const vector<Json>& inputs = table.find("inputs")->items;
  for (const Json& input : inputs) {
    program.sizes.push_back(elements(shape_of(input.items[1], "an input")));
    program.varies.push_back(true);
  }
  program.axes = program.sizes[0];
  program.ball = inputs.size() > 1;
  program.fibres = program.ball ? program.sizes[1] : 0;
  program.constants = constants;
  for (const vector<double>& constant : constants) {
    program.sizes.push_back(constant.size());
    program.varies.push_back(false);
  }
  size_t work = 0;
  for (const Json& row : list_of(*table.find("operations"), "operations")) {
    const size_t number = program.sizes.size();
    const Operation op = operation_of(row, number);
    if (!fits(program, op))
      refuse("an operation " + std::to_string(number) + ", " + op.kind + ", that is not well formed");
    limit(work += work_of(program, op), kMostWork, "numbers that the Program reads and makes");
    program.sizes.push_back(op.size);
    program.varies.push_back(std::any_of(op.operands.begin(), op.operands.end(),
                                         [&](size_t k) { return program.varies[k]; }));
    program.operations.push_back(op);
  }
  for (const Json& row : table.find("outputs")->items) {
    const string& name = row.items[0].string_value;
    const size_t value = counted(row.items[2], "an output's value");
    if (value >= program.sizes.size() ||
        program.sizes[value] != elements(shape_of(row.items[1], name)))
      refuse("the output " + name + " of no value of its size");
    program.outputs[name] = value;
  }
  return program;
}

// One number of a value is an element, with how it follows from others. Moves only say which number
// is meant, and sums and inner products are taken apart, so that few kinds are left.

// Outputs as elements, each after what it needs: those of a Program, or of what was recorded.
class Listing {
 public:
  Listing(size_t axis_count, vector<Element> recorded, std::map<string, vector<size_t>> named,
          size_t fibre_count = 0)
      : axes(axis_count), fibres(fibre_count), elements(std::move(recorded)),
        outputs(std::move(named)) {}

  explicit Listing(const Program& program) : axes(program.axes), fibres(program.fibres) {
    vector<vector<size_t>> values(1);
    for (size_t k = 0; k < program.axes; ++k)
      values[0].push_back(add({Element::axis, {}, k, I(0.0), nullptr, std::uint32_t{1} << k}));
    if (program.ball) values.emplace_back();
    for (size_t k = 0; k < program.fibres; ++k)
      values[1].push_back(add({Element::fibre, {}, k, I(0.0), nullptr, kXi}));
    for (const vector<double>& constant : program.constants) {
      values.emplace_back();
      for (const double x : constant)
        values.back().push_back(add({Element::number, {}, 0, I(x), nullptr, 0}));
    }
    for (const Operation& op : program.operations) {
      vector<const vector<size_t>*> operands;
      for (const size_t operand : op.operands) operands.push_back(&values[operand]);
      vector<size_t> found = result(op, operands);
      values.push_back(std::move(found));
    }
    for (const auto& [name, value] : program.outputs) outputs[name] = values[value];
  }

  const size_t axes, fibres = 0;
  vector<Element> elements;
  std::map<string, vector<size_t>> outputs;

 private:
  size_t add(Element element) { return added(elements, std::move(element)); }
  size_t add(Element::Kind kind, vector<size_t> operands) {
    return add({kind, std::move(operands), 0, I(0.0), nullptr, 0});
  }
  size_t of(Expansion (*near)(double, double), size_t a) {
    return add({Element::expanded, {a}, 0, I(0.0), near, 0});
  }
  size_t product(size_t a, size_t b) {
    if (elements[a].needs == 0) return add(Element::scaled, {a, b});
    if (elements[b].needs == 0) return add(Element::scaled, {b, a});
    return add(Element::times, {a, b});
  }

  vector<size_t> result(const Operation& op, const vector<const vector<size_t>*>& operands) {
    vector<size_t> found;
    if (op.kind == "move") {
      vector<size_t> joined;
      for (const vector<size_t>* one : operands) joined.insert(joined.end(), one->begin(), one->end());
      for (const size_t place : op.index) found.push_back(joined[place]);
      return found;
    }
    const vector<size_t>&a = *operands[0], &b = *operands[operands.size() > 1];
    for (size_t i = 0; i < op.size; ++i) {
      if (op.kind == "affine") found.push_back(row(op, operands, i / op.columns, i % op.columns));
      else if (op.kind == "sum" || op.kind == "inner") found.push_back(total(op, a, b, i));
      else found.push_back(elementwise(op.kind, a[a.size() == 1 ? 0 : i], b[b.size() == 1 ? 0 : i]));
    }
    return found;
  }

  // sum_k a_ik b_kj + c_i: a row if the a_ik are numbers, else its products and sums.
  size_t row(const Operation& op, const vector<const vector<size_t>*>& operands, size_t i, size_t j) {
    const size_t inner = operands[1]->size() / op.columns;
    vector<size_t> factors, terms, all;
    bool numbers = true;
    for (size_t k = 0; k < inner; ++k) {
      factors.push_back((*operands[0])[i * inner + k]);
      terms.push_back((*operands[1])[k * op.columns + j]);
      all.insert(all.end(), {factors[k], terms[k]});
      numbers = numbers && elements[factors[k]].is_double();
    }
    std::optional<size_t> sum;
    if (operands.size() == 3) sum = (*operands[2])[operands[2]->size() == 1 ? 0 : i];
    if (numbers) {
      if (sum) all.push_back(*sum);
      return add(Element::row, std::move(all));
    }
    for (size_t k = 0; k < inner; ++k) {
      const size_t term = product(factors[k], terms[k]);
      sum = sum ? add(Element::plus, {*sum, term}) : term;
    }
    return *sum;
  }

  // The sum of a_j, or of a_j b_j, over the i-th part of them.
  size_t total(const Operation& op, const vector<size_t>& a, const vector<size_t>& b, size_t i) {
    const size_t count = a.size() / op.size;
    std::optional<size_t> sum;
    for (size_t j = i * count; j < (i + 1) * count; ++j) {
      const size_t term = op.kind == "sum" ? a[j] : product(a[j], b[j]);
      sum = sum ? add(Element::plus, {*sum, term}) : term;
    }
    return *sum;
  }

  // Of one operand, b is a.
  size_t elementwise(const string& kind, size_t a, size_t b) {
    if (kind == "neg") return add(Element::negative, {a});
    if (kind == "add") return add(Element::plus, {a, b});
    if (kind == "sub") return add(Element::minus, {a, b});
    if (kind == "mul" || kind == "square") return product(a, b);
    if (kind == "div") return product(a, of(inverse_near, b));
    if (kind == "sqrt") return of(root_near, a);
    if (kind == "exp") return of(exp_near, a);
    if (kind == "log1p") return of(log1p_near, a);
    if (kind == "tanh") return of(tanh_near, a);
    if (kind == "logistic") return of(logistic_near, a);
    return of(kind == "sin" ? sin_near : cos_near, a);
  }
};

// The elements that some outputs need, as instructions, and their values on the boxes last looked at.
template <int N>
class Evaluation {
 public:
  // Boxes will lie in `region`, if one is given.
  Evaluation(const Listing& listing, const vector<const Claim*>& claims, const Box* region)
      : Evaluation(listing, elements_of(listing, claims),
                   region ? chosen(listing, elements_of(listing, claims), *region)
                          : vector<size_t>()) {}

  // Of these elements; the remainders of some are named, and there is room for more.
  Evaluation(const Listing& listing, const vector<size_t>& outputs, const vector<size_t>& named,
             size_t more = 0)
      : axes_(listing.axes),
        layout_{depend_on_xi(listing, outputs) ? listing.fibres : 0, named.size() + more},
        arithmetic_(layout_), polynomials_(layout_, true), place_(listing.elements.size(), kNone) {
    for (const size_t element : outputs) place_[element] = 0;
    for (size_t k = place_.size(); k-- > 0;)
      if (place_[k] != kNone)
        for (const size_t operand : listing.elements[k].operands) place_[operand] = 0;
    size_t numbers = 0;
    for (size_t& place : place_) {
      if (place == kNone) continue;
      place = numbers;
      numbers += layout_.numbers();
    }
    values_.resize(numbers);
    for (size_t k = 0; k < place_.size(); ++k)
      if (place_[k] != kNone) write_down(listing.elements, k);
    for (const size_t element : named) name(listing.elements, element);
  }

  // What depends on axes only along which no lane has another box than before still holds.
  void over(const vector<const Box*>& boxes) {
    const bool first = ends_.empty();
    ends_.resize(axes_);
    std::uint32_t changed = 0;
    for (size_t axis = 0; axis < ends_.size(); ++axis)
      for (size_t lane = 0; lane < kLanes; ++lane) {
        const Box& box = *boxes[std::min(lane, boxes.size() - 1)];
        I& ends = ends_[axis][lane];
        if (ends.low() == box.low[axis] && ends.high() == box.high[axis]) continue;
        ends = {-box.low[axis], box.high[axis]};
        changed |= std::uint32_t{1} << axis;
      }
    for (const Instruction& one : instructions_)
      if (first || (one.needs & changed)) {
        carry_out(one);
        if (one.symbol != kNone) arithmetic_.named(one.y, one.symbol);
      }
  }

  // An element on one of the boxes.
  Taylor<N> value(size_t element, size_t box) const {
    return arithmetic_.on_lane(&values_[place_[element]], static_cast<int>(box));
  }

 private:
  static constexpr size_t kNone = SIZE_MAX;
  struct Instruction {
    Element::Kind kind = Element::number;
    std::uint32_t needs = 0;
    V* y = nullptr;
    const V *a = nullptr, *b = nullptr;  // Of a row, a is what is added, if anything is.
    size_t which = 0;                    // Of a row, where its terms begin;
    size_t count = 0;                    // and how many there are.
    I value;
    Expansion (*near)(double, double) = nullptr;
    size_t element = 0, symbol = kNone;  // What it is, and what its remainder is an element of f.
    bool wide = false;                   // Whether it depends on f or xi.
  };
  const size_t axes_;
  const Layout<N> layout_;
  const Arithmetic<N> arithmetic_, polynomials_;
  vector<size_t> place_;  // Of each element's numbers among values_; kNone if it is not needed.
  vector<V> values_;
  vector<Instruction> instructions_;
  vector<double> weights_;  // Of rows.
  vector<const V*> terms_;
  vector<std::array<I, kLanes>> ends_;  // Of each axis, on each lane.
  size_t symbols_ = 0;                  // How many are given.

  void write_down(const vector<Element>& elements, size_t k) {
    const Element& e = elements[k];
    const auto at = [&](size_t operand) { return &values_[place_[e.operands[operand]]]; };
    Instruction one;
    one.kind = e.kind;
    one.needs = e.needs;
    one.y = &values_[place_[k]];
    one.which = e.which;
    one.value = e.value;
    one.near = e.near;
    one.element = k;
    one.wide = e.needs & kXi;
    if (e.kind == Element::row) {
      one.which = terms_.size();
      one.count = e.operands.size() / 2;
      for (size_t m = 0; m < one.count; ++m) {
        weights_.push_back(elements[e.operands[2 * m]].value.high());
        terms_.push_back(at(2 * m + 1));
      }
      if (e.operands.size() % 2) one.a = at(2 * one.count);
    } else {
      if (e.operands.size() > 0) one.a = at(0);
      if (e.operands.size() > 1) one.b = at(1);
    }
    instructions_.push_back(one);
  }

  static vector<size_t> elements_of(const Listing& listing, const vector<const Claim*>& claims) {
    vector<size_t> found;
    for (const Claim* claim : claims)
      for (const size_t element : listing.outputs.at(claim->name)) found.push_back(element);
    return found;
  }
  static bool depend_on_xi(const Listing& listing, const vector<size_t>& outputs) {
    return std::any_of(outputs.begin(), outputs.end(),
                       [&](size_t element) { return listing.elements[element].needs & kXi; });
  }

  // The remainders that get symbols, those first that cancel most about the middle of a region.
  static vector<size_t> chosen(const Listing& listing, const vector<size_t>& outputs,
                               const Box& region) {
    const SymbolLimits& limits = depend_on_xi(listing, outputs) ? kSymbolsOffZero : kSymbols;
    Evaluation trial(listing, outputs, {}, limits.most);
    Box box = region;
    for (const double share : kShares) {
      box = middle_of(region, share);
      const vector<Found> found = trial.found_on(box);
      if (std::all_of(outputs.begin(), outputs.end(),
                      [&](size_t k) { return found[k].remainder < HUGE_VAL; }))
        break;
    }
    SymbolChoice choice(listing.elements, outputs, limits.least_gain);
    vector<size_t> named;
    while (named.size() < limits.most) {
      const std::optional<size_t> best = choice.next(trial.found_on(box));
      if (!best) break;
      trial.name(listing.elements, *best);
      named.push_back(*best);
    }
    return named;
  }

  vector<Found> found_on(const Box& box) {
    ends_.clear();
    over({&box});
    ends_.clear();
    vector<Found> found(place_.size());
    for (const Instruction& one : instructions_)
      found[one.element] = {one.y[0][0], one.y[layout_.remainder()][0]};
    return found;
  }

  // Makes the remainder of an element the next symbol.
  void name(const vector<Element>& elements, size_t element) {
    vector<bool> wide(elements.size());
    for (Instruction& one : instructions_) {
      if (one.element == element) one.symbol = symbols_++;
      for (const size_t operand : elements[one.element].operands)
        if (wide[operand]) one.wide = true;
      wide[one.element] = one.wide || one.symbol != kNone;
    }
  }

  void carry_out(const Instruction& one) {
    const Arithmetic<N>& by = one.wide ? arithmetic_ : polynomials_;
    switch (one.kind) {
      case Element::axis: return by.coordinate(one.y, one.which, ends_[one.which]);
      case Element::fibre: return by.fibre(one.y, one.which);
      case Element::number: return by.constant(one.y, one.value);
      case Element::negative: return by.negative(one.a, one.y);
      case Element::plus: return by.plus(one.a, one.b, one.y);
      case Element::minus: return by.minus(one.a, one.b, one.y);
      case Element::times: return by.times(one.a, one.b, one.y);
      case Element::scaled: return by.scaled(one.a, one.b, one.y);
      case Element::expanded: return by.expanded(one.near, one.a, one.y);
      case Element::row:
        return by.row(&weights_[one.which], &terms_[one.which], one.count, one.a, one.y);
    }
  }
};

// Bounds of a listing's outputs over boxes of up to N axes.
template <int N>
class ListingBounder : public Bounder {
 public:
  explicit ListingBounder(std::shared_ptr<const Listing> listing) : listing_(std::move(listing)) {}
  size_t most_boxes() const override { return kLanes; }
  void within(const Box& region) override { region_ = region; }

  void over(const vector<const Box*>& boxes, const vector<const Claim*>& claims) override {
    auto found = known_.find(claims);
    if (found == known_.end()) {
      if (known_.size() == kMostKnown) known_.clear();
      found = known_.emplace(claims, std::make_unique<Evaluation<N>>(*listing_, claims, region_ ? &*region_ : nullptr)).first;
    }
    now_ = found->second.get();
    now_->over(boxes);
  }

  vector<Estimate> margins(size_t box, const Claim& claim) override {
    vector<Estimate> found;
    for (const size_t element : listing_->outputs.at(claim.name))
      found.push_back(estimate(now_->value(element, box)));
    return found;
  }

  double least(size_t box, const Claim& claim) override {
    double found = -HUGE_VAL;  // Minus it.
    for (const size_t element : listing_->outputs.at(claim.name))
      found = larger(found, finite(minus_least(now_->value(element, box)), 0.0).n);
    return -found;
  }

 private:
  static constexpr size_t kMostKnown = 8;
  const std::shared_ptr<const Listing> listing_;
  std::optional<Box> region_;
  std::map<vector<const Claim*>, std::unique_ptr<Evaluation<N>>> known_;
  Evaluation<N>* now_ = nullptr;
};

template <int N>
Bounding bounding_in(std::shared_ptr<const Listing> listing) {
  return [listing] { return std::make_unique<ListingBounder<N>>(listing); };
}

// Bounds of the outputs of a listing. Each number of axes is compiled for itself: only some are.
Bounding by_the_listing(std::shared_ptr<const Listing> listing) {
  const size_t axes = listing->axes;
  if (axes <= 2) return bounding_in<2>(listing);
  if (axes <= 4) return bounding_in<4>(listing);
  if (axes <= 6) return bounding_in<6>(listing);
  if (axes <= 8) return bounding_in<8>(listing);
  if (axes <= 12) return bounding_in<12>(listing);
  return bounding_in<kMostAxes>(listing);
}

// Of two kinds of outputs: those that are recorded, and the others by the formulas themselves.
class EitherBounder : public Bounder {
 public:
  EitherBounder(const Model& model, const Theorems& theorems, const Bounding& listing)
      : by_model_(model, theorems), by_listing_(listing()) {}
  size_t most_boxes() const override { return by_listing_->most_boxes(); }
  void within(const Box& region) override { by_listing_->within(region); }

  void over(const vector<const Box*>& boxes, const vector<const Claim*>& claims) override {
    boxes_ = boxes;
    looked_at_ = nullptr;
    vector<const Claim*> recorded;
    for (const Claim* claim : claims)
      if (claim->output->recorded) recorded.push_back(claim);
    if (!recorded.empty()) by_listing_->over(boxes, recorded);
  }

  vector<Estimate> margins(size_t box, const Claim& claim) override {
    return of(box, claim).margins(claim.output->recorded ? box : 0, claim);
  }
  double least(size_t box, const Claim& claim) override {
    return of(box, claim).least(claim.output->recorded ? box : 0, claim);
  }

 private:
  ModelBounder by_model_;
  const std::unique_ptr<Bounder> by_listing_;
  vector<const Box*> boxes_;
  const Box* looked_at_ = nullptr;  // The one that the model was last asked about.

  Bounder& of(size_t box, const Claim& claim) {
    if (claim.output->recorded) return *by_listing_;
    if (looked_at_ != boxes_[box]) by_model_.over({boxes_[box]}, {});
    looked_at_ = boxes_[box];
    return by_model_;
  }
};

Bounding by_either(const Model& model, const Theorems& theorems, const Bounding& listing) {
  return [&model, &theorems, listing] {
    return std::make_unique<EitherBounder>(model, theorems, listing);
  };
}

Bounding by_the_program(const Program& program) {
  return by_the_listing(std::make_shared<const Listing>(program));
}

}  // namespace
