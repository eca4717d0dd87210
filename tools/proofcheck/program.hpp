#pragma once

#include "check.hpp"

namespace {

// --------------------------------------------------------------------------- 13 the Program
//
// The list of operations in the file, as the finder worked with it. It is read only on request: of
// what it computes this section knows nothing, and shows nothing about the robot. Every value is a
// flat vector; an element for which there is no bound over a box is left out, and so is what needs
// it.

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

constexpr size_t kMostElements = size_t{1} << 20, kMostProducts = size_t{1} << 24;

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
  for (const Json& row : list_of(*table.find("operations"), "operations")) {
    const size_t number = program.sizes.size();
    const Operation op = operation_of(row, number);
    if (!fits(program, op))
      refuse("an operation " + std::to_string(number) + ", " + op.kind + ", that is not well formed");
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

// Evaluates a Program over boxes of up to N axes.
template <int N>
class Evaluator {
 public:
  explicit Evaluator(const Program& program) : program_(program), folded_(program.sizes.size()) {
    for (size_t k = 0; k < program.constants.size(); ++k) {
      Value value;
      for (const double number : program.constants[k]) value.push_back(T(number));
      folded_[program.inputs() + k] = std::make_shared<Value>(std::move(value));
    }
    evaluate(folded_, [&](size_t number) { return !program.varies[number]; });
  }

  // Margins of some outputs over a box.
  Margins over(const Box& box, const vector<const Claim*>& claims) const {
    vector<bool> needed(program_.sizes.size());
    for (const Claim* claim : claims) needed[program_.outputs.at(claim->name)] = true;
    for (size_t k = program_.operations.size(); k-- > 0;)
      if (needed[program_.first_operation() + k])
        for (const size_t operand : program_.operations[k].operands) needed[operand] = true;
    Values values = folded_;
    Value u, xi;
    for (size_t axis = 0; axis < program_.axes; ++axis)
      u.push_back(coordinate<T>(box.low[axis], box.high[axis], static_cast<int>(axis)));
    for (size_t k = 0; k < program_.fibres; ++k)
      xi.push_back(ball_coordinate<T>(k, program_.fibres));
    values[0] = std::make_shared<Value>(std::move(u));
    if (program_.ball) values[1] = std::make_shared<Value>(std::move(xi));
    evaluate(values, [&](size_t number) { return program_.varies[number] && needed[number]; });
    std::map<string, std::shared_ptr<const Value>> found;
    for (const Claim* claim : claims)
      found[claim->name] = values[program_.outputs.at(claim->name)];
    return [found](const Claim& claim) {
      vector<Estimate> margins;
      for (const std::optional<T>& element : *found.at(claim.name)) {
        if (!element) throw NoBound();
        margins.push_back(estimate(*element));
      }
      return margins;
    };
  }

 private:
  using T = Taylor<N, true>;
  using Value = vector<std::optional<T>>;
  using Values = vector<std::shared_ptr<const Value>>;
  const Program& program_;
  Values folded_;  // Those that do not depend on an input.

  template <class Chosen>
  void evaluate(Values& values, Chosen chosen) const {
    size_t number = program_.first_operation();
    for (const Operation& op : program_.operations) {
      if (chosen(number)) values[number] = std::make_shared<Value>(result(op, values));
      ++number;
    }
  }

  Value result(const Operation& op, const Values& values) const {
    vector<const Value*> operands;
    for (const size_t operand : op.operands) operands.push_back(values[operand].get());
    if (op.kind == "move") return moved(op, operands);
    Value found(op.size);
    for (size_t i = 0; i < op.size; ++i) {
      try {
        found[i] = element(op, operands, i);
      } catch (const NoBound&) {  // Left out.
      }
    }
    return found;
  }

  static Value moved(const Operation& op, const vector<const Value*>& operands) {
    vector<const std::optional<T>*> joined;
    for (const Value* operand : operands)
      for (const std::optional<T>& item : *operand) joined.push_back(&item);
    Value found;
    for (const size_t place : op.index) found.push_back(*joined[place]);
    return found;
  }

  static const T& at(const Value& value, size_t i) {
    const std::optional<T>& item = value[value.size() == 1 ? 0 : i];
    if (!item) throw NoBound();
    return *item;
  }

  static T element(const Operation& op, const vector<const Value*>& operands, size_t i) {
    const Value& a = *operands[0];
    if (op.kind == "affine") return row(op, operands, i / op.columns, i % op.columns);
    if (op.kind == "sum" || op.kind == "inner") {
      const size_t count = a.size() / op.size;
      T total(0.0);
      for (size_t j = i * count; j < (i + 1) * count; ++j)
        total = total + (op.kind == "sum" ? at(a, j) : at(a, j) * at(*operands[1], j));
      return total;
    }
    return operands.size() == 1 ? unary(op.kind, at(a, i))
                                : binary(op.kind, at(a, i), at(*operands[1], i));
  }

  // sum_k a_ik b_kj + c_i
  static T row(const Operation& op, const vector<const Value*>& operands, size_t i, size_t j) {
    const Value& matrix = *operands[0];
    const size_t inner = operands[1]->size() / op.columns;
    T total = operands.size() == 3 ? at(*operands[2], i) : T(0.0);
    for (size_t k = 0; k < inner; ++k) {
      const I factor = at(matrix, i * inner + k).c[0];
      const T& term = at(*operands[1], k * op.columns + j);
      if (magnitude(factor) != 0.0) total = total + factor * term;
    }
    return total;
  }

  static T unary(const string& kind, const T& a) {
    if (kind == "neg") return -a;
    if (kind == "square") return a * a;
    if (kind == "sqrt") return root(a);
    if (kind == "exp") return exp(a);
    if (kind == "log1p") return log1p(a);
    if (kind == "tanh") return tanh(a);
    if (kind == "logistic") return logistic(a);
    T sine, cosine;
    sincos(a, sine, cosine);
    return kind == "sin" ? sine : cosine;
  }

  static T binary(const string& kind, const T& a, const T& b) {
    if (kind == "add") return a + b;
    if (kind == "sub") return a - b;
    if (kind == "mul") return a * b;
    return a / b;
  }
};

template <int N>
Bounding bounding_in(const Program& program) {
  const auto evaluator = std::make_shared<const Evaluator<N>>(program);
  return [evaluator](const Box& box, const vector<const Claim*>& claims) {
    return evaluator->over(box, claims);
  };
}

// Bounds of a Program's outputs. Each number of axes is compiled for itself: only some are.
Bounding by_the_program(const Program& program) {
  if (program.axes <= 2) return bounding_in<2>(program);
  if (program.axes <= 4) return bounding_in<4>(program);
  if (program.axes <= 8) return bounding_in<8>(program);
  if (program.axes <= 12) return bounding_in<12>(program);
  return bounding_in<kMostAxes>(program);
}

}  // namespace
