// Which remainders get symbols: the rules of programs/remainder_symbols.py and programs/sensitivity.py
// on the compiled code's own models. Included by bounder.cpp, whose namespace this is in.
//
// The code must have been written with a place of its own for every result: nothing is overwritten.
// Nothing here is trusted, either: whatever is chosen, bounds are true.

// Sensitivities of as many elements of outputs as a register holds to one element of a value.
struct Reached {
  V derivative, paths;
};

class SymbolChoice : public Bounder {
 public:
  using Bounder::Bounder;

  // Fills `chosen` with the numbers of operations, `most` at most.
  // Returns how many; -1 where an output has no bound on the box.
  int64_t choose(const double* low, const double* high, double least_gain, int64_t* chosen) {
    const std::unique_ptr<E[]> space(new (std::align_val_t(64)) E[static_cast<size_t>(workspace_)]);
    evaluate(space.get(), low, high);
    const std::vector<int64_t> columns = seeds();
    std::vector<double> whole;
    for (const int64_t place : columns) whole.push_back(space[static_cast<size_t>(place)].r[0]);
    for (const int64_t place : columns)
      if (!std::isfinite(space[static_cast<size_t>(place)].r[0])) return -1;
    int64_t count = 0, left = kSymbols;
    for (;;) {
      const int64_t best = worth_most(space.get(), columns, whole, left, least_gain);
      if (best < 0) break;
      operations_[static_cast<size_t>(best)].symbol = 0;
      chosen[count++] = best;
      left -= operations_[static_cast<size_t>(best)].size;
      evaluate(space.get(), low, high);
    }
    return count;
  }

 private:
  // All models over one box, with the symbols so far.
  void evaluate(E* space, const double* low, const double* high) {
    enter(space, low, high, 0, 1);
    int64_t symbol = 0;
    for (Operation& op : operations_) {
      apply<true>(op, space);
      if (op.symbol < 0) continue;
      op.symbol = symbol;
      symbol += op.size;
      name(op, space);
    }
  }

  // Places of all elements of outputs, each once; constants have none.
  std::vector<int64_t> seeds() const {
    std::vector<int64_t> found;
    for (const Operand& output : outputs_)
      for (int64_t i = 0; output.at >= 0 && i < output.size; ++i)
        if (std::find(found.begin(), found.end(), output.at + i) == found.end())
          found.push_back(output.at + i);
    return found;
  }

  // The operation whose symbols would take most from the remainders of the outputs; -1 for none.
  int64_t worth_most(const E* space, const std::vector<int64_t>& columns,
                     const std::vector<double>& whole, int64_t left, double least_gain) const {
    std::vector<double> sums(operations_.size(), 0.0), largest(operations_.size(), 0.0);
    std::vector<Reached> reached(static_cast<size_t>(workspace_));
    for (size_t first = 0; first < columns.size(); first += kLanes) {
      std::fill(reached.begin(), reached.end(), Reached{all(0.0), all(0.0)});
      const size_t lanes = std::min<size_t>(kLanes, columns.size() - first);
      for (size_t lane = 0; lane < lanes; ++lane) {
        Reached& seed = reached[static_cast<size_t>(columns[first + lane])];
        seed.derivative[static_cast<int>(lane)] = seed.paths[static_cast<int>(lane)] = 1.0;
      }
      for (size_t k = operations_.size(); k-- > 0;) {
        const Operation& op = operations_[k];
        Reached* out = reached.data() + op.out;
        V gain = all(0.0);
        for (int64_t i = 0; i < op.size; ++i) {
          if (op.symbol >= 0) out[i].paths = size(out[i].derivative);
          gain += space[op.out + i].r * (out[i].paths - size(out[i].derivative));
        }
        for (size_t lane = 0; lane < lanes; ++lane) {
          const double part = gain[static_cast<int>(lane)] / whole[first + lane];
          if (!std::isfinite(part)) continue;
          sums[k] += part;
          largest[k] = std::max(largest[k], part);
        }
        pull(op, space, reached.data());
      }
    }
    int64_t best = -1;
    double most = 0.0;
    for (size_t k = 0; k < operations_.size(); ++k) {
      const int64_t size = operations_[k].size;
      // Off zero the gain of one symbol: a large value would leave room for nothing else.
      const double worth = kBall == 0 ? sums[k] : sums[k] / static_cast<double>(size);
      if (size > left || (kBall > 0 && !(largest[k] >= least_gain))) continue;
      if (best >= 0 && !(worth > most)) continue;
      best = static_cast<int64_t>(k);
      most = worth;
    }
    return best >= 0 && largest[static_cast<size_t>(best)] >= least_gain ? best : -1;
  }

  static void carry(Reached* reached, int64_t place, const Reached& from, double slope) {
    if (place < 0) return;  // A constant.
    reached[place].derivative += from.derivative * slope;
    reached[place].paths += from.paths * std::abs(slope);
  }
  static int64_t place(const Operand& a, int64_t i) {
    const int64_t k = a.size == 1 ? 0 : i;
    return a.at < 0 ? a.at - k : a.at + k;
  }
  double value(const E* space, int64_t place) const {
    return place < 0 ? centres_[static_cast<size_t>(-1 - place)] : space[place].c[0][0];
  }

  // Sensitivities to the results of an operation, carried over to its operands.
  void pull(const Operation& op, const E* space, Reached* reached) const {
    const Reached* out = reached + op.out;
    switch (op.kind) {
      case kMove:
        for (int64_t i = 0; i < op.size; ++i)
          carry(reached, index_[static_cast<size_t>(op.index + i)], out[i], 1.0);
        return;
      case kAffine: {
        const int64_t rows = op.size / op.columns, inner = op.operand[1].size / op.columns;
        for (int64_t row = 0; row < rows; ++row)
          for (int64_t column = 0; column < op.columns; ++column)
            for (int64_t k = 0; k < inner; ++k)
              carry(reached, place(op.operand[1], k * op.columns + column),
                    out[row * op.columns + column],
                    value(space, op.operand[0].at - (row * inner + k)));
        return;
      }
      case kSum:
      case kInner: {
        const int64_t count = op.operand[0].size / op.size;
        for (int64_t j = 0; j < op.operand[0].size; ++j) {
          const int64_t a = place(op.operand[0], j);
          if (op.kind == kSum) {
            carry(reached, a, out[j / count], 1.0);
          } else {
            const int64_t b = place(op.operand[1], j);
            carry(reached, a, out[j / count], value(space, b));
            carry(reached, b, out[j / count], value(space, a));
          }
        }
        return;
      }
      default: break;
    }
    for (int64_t i = 0; i < op.size; ++i) {
      const int64_t a = place(op.operand[0], i);
      const double x = value(space, a), y = value(space, op.out + i);
      if (op.kind > kDiv) {
        carry(reached, a, out[i], slope(op.kind, x, y));
        continue;
      }
      const int64_t b = place(op.operand[1], i);
      const double z = value(space, b);
      const bool adds = op.kind == kAdd || op.kind == kSub;
      carry(reached, a, out[i], adds ? 1.0 : op.kind == kMul ? z : 1.0 / z);
      carry(reached, b, out[i],
            adds ? (op.kind == kAdd ? 1.0 : -1.0) : op.kind == kMul ? x : -y / z);
    }
  }

  // The derivative of a function of one element x, whose value is y.
  static double slope(int64_t kind, double x, double y) {
    switch (kind) {
      case kNeg: return -1.0;
      case kSquare: return 2.0 * x;
      case kSqrt: return 0.5 / y;
      case kExp: return y;
      case kLog1p: return 1.0 / (1.0 + x);
      case kSin: return std::cos(x);
      case kCos: return -std::sin(x);
      case kTanh: return 1.0 - y * y;
      default: return y * (1.0 - y);
    }
  }
};
