#pragma once

#include "disturbed.hpp"

namespace {

// --------------------------------------------------- 14, outputs of the Program, of all levels

// An output of the Program: a condition of the spec, or a premise of a theorem.
struct Output {
  size_t elements = 0;  // In the Program.
  string unknown;       // Why it cannot be checked here; empty if it can.
  std::function<vector<Estimate>(Place<TM>&)> margins;  // None where levels 4 and 5 are recorded.
  std::function<vector<Formula>(Place<Formula>&)> formulas;
  bool recorded = false;  // Bounded by a listing of the formulas, not by the margins.
  std::function<string(double)> words;  // That the margin is at least this.
};

// Of margins of a place of either kind.
template <class Margins>
Output output_of(Margins margins, std::function<string(double)> words) {
  return {0, "", [margins](Place<TM>& at) { return estimates(margins(at)); },
          [margins](Place<Formula>& at) { return margins(at); }, false, std::move(words)};
}

Output output_of(const Condition& c) {
  Output found = output_of([&c](auto& at) { return margins(c, at.wide(), at.phase); },
                           [&c](double least) { return words_for(c, least); });
  found.unknown = c.unknown;
  return found;
}

string with_unit(const char* words, double least, const char* unit) {
  return string(words) + " >= " + at_least(least) + (*unit ? " " : "") + unit;
}

Output output_of(const string& name, const Meaning& meaning) {
  const auto words = [&meaning](double least) {
    return with_unit(meaning.words, least, meaning.unit);
  };
  if (name.rfind("set/", 0) == 0)
    return output_of([name](auto& at) { return set_margins(name, at); }, words);
  return output_of([name](auto& at) { return orbit_margins(name, at); }, words);
}

// set/after NAME, set/value NAME, set/rate NAME, of a barrier condition.
Output output_of(const string& what, const Condition& c) {
  if (!c.unknown.empty()) return {0, c.unknown, {}, {}, false, {}};
  const string h = words_for(c.quantity) + " >= ", unit = " " + unit_of(c.quantity);
  if (what == "set/value")
    return output_of([&c](auto& at) { return value(c.quantity, at.wide()); },
                     [h, unit](double least) { return h + at_least(least) + unit; });
  if (what == "set/after")
    return output_of([&c](auto& at) { return value(c.quantity, at.wide().after()); },
                     [h, unit](double least) {
                       return "after the reset, " + h + at_least(least) + unit;
                     });
  return output_of([&c](auto& at) { return pushed_rates(c, at); },
                   [&c](double least) { return "disturbed, " + words_for(c, least); });
}

// Of states of the full order: by formulas alone.
Output output_of_full_state(const Meaning& meaning,
                            std::function<vector<Formula>(const Theorems&, FullState&)> margins) {
  return {0, "", {}, [margins](Place<Formula>& at) { return margins(at.theorems, full_state(at)); },
          false, [&meaning](double least) { return with_unit(meaning.words, least, meaning.unit); }};
}

// full/NAME.
Output output_of_full_order(const string& name, const Meaning& meaning) {
  return output_of_full_state(meaning, [name](const Theorems&, FullState& at) {
    return full_margins(name, at);
  });
}

// disturbed/NAME.
const std::map<string, Meaning>& disturbed_outputs() {
  static const std::map<string, Meaning> table = {
      {"disturbed/contact", {"the contact's slacks, less what a push takes", "weights"}},
      {"disturbed/torque", {"the torques' slacks, less what a push takes", "limits"}},
      {"disturbed/decay", {"pivots of the decay of V under a law", ""}},
      {"disturbed/rest", {"its bound^2 - |S e|^2 of a law, nothing off", "rad^2/s^4"}},
      {"disturbed/jerk", {"j^2 - |S d^3y|^2 under held torques, nothing off", "rad^2/s^6"}},
      {"disturbed/growth-slope", {"pivots of 1 - A A' / l^2, A the slope of S de/dt in xi", ""}},
      {"disturbed/jerk-slope", {"pivots of 1 - A A' / l^2, A the slope of S d^3y in xi", ""}},
      {"disturbed/jerk-push", {"its bound^2 - its squared slope in S e", "1/s^2"}},
      {"disturbed/kick", {"its bound^2 - |S e|^2 after an impact, torques held", "rad^2/s^4"}},
      {"disturbed/kick-slope", {"its bound^2 - its squared slope in xi", "1/s^4"}},
      {"disturbed/kick-push", {"its bound^2 - its squared slope in S e from before", ""}},
      {"disturbed/kick-contact", {"the contact's slacks, less what a kick takes", "weights"}}};
  return table;
}

Output output_of_disturbed(const string& name, const Meaning& meaning) {
  return output_of_full_state(meaning, [name](const Theorems& theorems, FullState& at) {
    return disturbed_margins(name, *theorems.disturbed, at);
  });
}

// Premises about a measured state, which are not derived.
Output output_of_measured_state() {
  static const Meaning meaning = {"its bound^2 - the square of what a measured state changes", ""};
  Output output = output_of_full_state(meaning, [](const Theorems&, FullState&) -> vector<Formula> {
    throw Unknown{"the effect of a measured state"};
  });
  output.unknown = "it is about a measured state, whose effect is not derived";
  return output;
}

// disturbed/decrease BARRIER, the barrier of that number.
Output output_of_decrease(size_t number) {
  static const Meaning meaning = {"dh/dt + alpha h - weight |slope of dh/dt in xi|^2 - lost", "/s"};
  return output_of_full_state(meaning, [number](const Theorems& theorems, FullState& at) {
    return decrease(theorems.disturbed->barriers[number], theorems.full->barriers[number],
                    number == 1, at);
  });
}

// full/WHAT BARRIER, the barrier of that number: the first two are the fences.
Output output_of_barrier(const string& what, size_t number, const Meaning& meaning) {
  return output_of_full_state(meaning, [what, number](const Theorems& theorems, FullState& at) {
    return barrier_margins(what, theorems.full->barriers[number], number == 1, at);
  });
}

}  // namespace
