#pragma once

#include "program.hpp"

namespace {

// ------------------------------------------------------------------- 18 systems of other families
//
// Systems that do not walk have charts of their own, and specs with the same regions and conditions in
// every file. What their sections make of a file is one object.

struct SpecRegion { const char* name; double low[2], high[2]; };  // Of two axes; whole in the others.
struct SpecCondition { const char *name, *region, *words, *unit; size_t elements; };

// What files of a family have in common.
struct KnownFamily {
  const char *name, *words;  // In files, and for a person.
  vector<const char*> axes;  // Each from 0 to 1.
  vector<const char*> parts;  // Of the model, beside family, robot, regions and conditions.
  vector<SpecRegion> regions;
  vector<SpecCondition> conditions;

  bool has(const Chart& chart) const {
    if (chart.size() != axes.size()) return false;
    for (size_t k = 0; k < axes.size(); ++k)
      if (chart[k].name != axes[k] || chart[k].low != 0.0 || chart[k].high != 1.0) return false;
    return true;
  }
};

// How much of a condition's margin is proved on its region; below 0 if nothing is.
using ProvedMargin = std::function<double(const string&)>;

// A system of a file, derived from its numbers.
struct DerivedSystem {
  vector<string> words;  // A line each; weights by their hash.
  std::shared_ptr<const Listing> recorded;  // Margins of the conditions as formulas of the chart.
  // What follows for trajectories, by level.
  std::function<std::map<int, vector<string>>(const ProvedMargin&)> conclude;
};

bool walks(const Chart& chart) {
  return chart[0].name == "phase" || chart[1].name == "level";
}

// A number of a robot that is above 0, or not below it.
I number_above(const Json& robot, const char* name) {
  const double x = hexadecimal(*robot.find(name), name);
  if (!(x > 0.0)) refuse("a robot whose " + string(name) + " is not above 0");
  return I(x);
}
I number_from(const Json& robot, const char* name) {
  const double x = hexadecimal(*robot.find(name), name);
  if (!(x >= 0.0)) refuse("a robot whose " + string(name) + " is negative");
  return I(x);
}

inline Formula tanh_of(const Formula& a) { return tanh(a); }
inline DualOf<Formula> tanh_of(const DualOf<Formula>& a) {
  const Formula t = tanh(a.v);
  return {t, (Formula(1.0) - t * t) * a.d};
}

// 1 less a share of a limit, and 1 more.
vector<Formula> both_sides(const Formula& value, I limit) {
  const Formula share = inverse(limit) * value;
  return {Formula(1.0) - share, Formula(1.0) + share};
}

// What a recording computes by these names, on a chart of so many axes.
std::shared_ptr<const Listing> listing_of(Recording& recording, size_t axes,
                                          const std::map<string, vector<Formula>>& margins) {
  std::map<string, vector<size_t>> named;
  for (const auto& [name, formulas] : margins)
    for (const Formula& one : formulas) named[name].push_back(one.of(recording));
  return std::make_shared<const Listing>(axes, std::move(recording.elements), std::move(named));
}

// Every parameter of the Program is an array of the file.
void match_constants(const Constants& constants,
                     const std::map<string, std::map<string, Array>>& owners) {
  for (const auto& [name, constant] : constants) {
    const size_t dot = name.rfind('.');
    const auto owner = dot == string::npos ? owners.end() : owners.find(name.substr(0, dot));
    if (owner == owners.end() || !owner->second.count(name.substr(dot + 1)))
      throw Inconsistent{"the Program has the parameter " + name + ", which the file has not"};
  }
}

}  // namespace
