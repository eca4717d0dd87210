#pragma once

#include "conclusions.hpp"

namespace {

// ------------------------------------------------------------------------------- 22 the file

struct Named { string name, sha256; };

Named named(const Json& table, const string& what) {
  only(table, what, {"name", "sha256"});
  const string& name = text_of(field(table, what, "name"), "a name");
  if (name.size() > 200 || name.find("  ") != string::npos)
    refuse("the " + what + " name, too long or with blanks in a row");
  return {text_of(field(table, what, "name"), "a name"),
          text_of(field(table, what, "sha256"), "a sha256")};
}

struct ProgramFacts {
  Constants constants;               // Those that have a name.
  vector<vector<double>> values;     // All of them.
  std::map<string, size_t> outputs;  // Name to number of elements.
  vector<vector<int>> inputs;        // Shapes of u, and of xi if there is one.
  bool ball = false;                 // Whether there is.

  // Whether conditions of the spec are among the outputs.
  bool has_conditions() const {
    return std::any_of(outputs.begin(), outputs.end(),
                       [](const auto& output) { return !of_theorem(output.first); });
  }
};

ProgramFacts program_facts(const Json& table, const Chart& chart) {
  only(table, "the Program", {"format", "version", "inputs", "constants", "operations", "outputs"});
  if (text_of(field(table, "the Program", "format"), "a format") != "neuralgaits-program" ||
      integer_of(field(table, "the Program", "version"), "a version") != 1)
    refuse("a Program of another version");
  ProgramFacts facts;
  vector<string> names;
  for (const Json& input : list_of(field(table, "the Program", "inputs"), "inputs")) {
    if (list_of(input, "an input").size() != 2) refuse("an input that is not name and shape");
    names.push_back(text_of(input.items[0], "an input's name"));
    facts.inputs.push_back(shape_of(input.items[1], names.back()));
  }
  facts.ball = names == vector<string>{"u", "xi"};
  if ((!facts.ball && names != vector<string>{"u"}) ||
      facts.inputs[0] != vector<int>{static_cast<int>(chart.size())} ||
      facts.inputs.back().size() != 1)
    refuse("a Program that is no function of the chart's u, or of u and xi");
  if (facts.ball && facts.inputs[1][0] > 256) refuse("a Program of more than 256 elements of xi");
  for (const Json& row : list_of(field(table, "the Program", "constants"), "constants")) {
    const vector<Json>& parts = list_of(row, "a constant");
    if (parts.size() != 3) refuse("a constant that is not name, shape and data");
    const bool named = parts[0].type != Json::null;
    const string name = named ? text_of(parts[0], "a constant's name") : "a formula";
    Array array;
    array.shape = shape_of(parts[1], name);
    const auto bytes = base64(text_of(parts[2], name), name);
    if (bytes.size() != 8 * elements(array.shape)) refuse(name + " of another size");
    for (size_t i = 0; i < bytes.size(); i += 8) {
      std::uint64_t bits = 0;
      for (size_t b = 8; b-- > 0;) bits = bits << 8 | bytes[i + b];
      double number;
      memcpy(&number, &bits, 8);
      if (!(std::abs(number) < HUGE_VAL)) refuse("a constant of " + name + " that is not finite");
      array.values.push_back(number);
    }
    facts.values.push_back(array.values);
    if (named && !facts.constants.emplace(name, array).second)
      refuse("two constants named " + name);
  }
  const vector<Json>& rows = list_of(field(table, "the Program", "outputs"), "outputs");
  limit(rows.size(), kMostOutputs, "outputs of the Program");
  for (const Json& row : rows) {
    const vector<Json>& parts = list_of(row, "an output");
    if (parts.size() != 3) refuse("an output that is not name, shape and value");
    const string name = text_of(parts[0], "an output's name");
    const size_t count = elements(shape_of(parts[1], name));
    limit(count, kMostOfOutput, "elements of an output of the Program");
    if (!facts.outputs.emplace(name, count).second) refuse("two outputs named " + name);
  }
  return facts;
}

Chart chart_of(const Json& table) {
  Chart chart;
  const size_t axes = list_of(table, "the chart").size();
  if (axes < 2 || axes > kMostAxes) refuse("a chart that is no list of 2 to 16 axes");
  std::set<string> seen;
  for (const Json& row : table.items) {
    vector<string> names = {"name", "low", "high"};
    if (row.find("change")) names.push_back("change");
    only(row, "an axis of the chart", names);
    const string& name = text_of(*row.find("name"), "an axis's name");
    only_a_name(name, "an axis");
    const auto number = [&](const char* end) { return hexadecimal(*row.find(end), name); };
    chart.push_back({name, number("low"), number("high")});
    if (row.find("change")) {
      chart.back().change = number("change");
      if (chart.size() < 4 || !(chart.back().change > 0.0 && chart.back().near()))
        refuse("the axis " + name + " with a change that is none");
    }
    const double width = chart.back().high - chart.back().low;
    if (!(width > 0.0 && width < HUGE_VAL)) refuse("the axis " + name + " without a finite width");
    if (!seen.insert(name).second) refuse("two axes named " + name);
  }
  const auto is = [](const Axis& axis, const char* name, double low, double high) {
    return axis.name == name && axis.low == low && axis.high == high && !axis.near();
  };
  if (!seen.count("phase") && !seen.count("level")) {
    for (const Axis& axis : chart)
      if (axis.near()) refuse("a chart without phase and level whose axes are coupled");
    return chart;
  }
  // Files of earlier versions have the shorter axis.
  if (!(is(chart[0], "phase", -0.1, 1.1) || is(chart[0], "phase", -0.05, 1.05)) ||
      !is(chart[1], "level", 0.0, 1.0))
    refuse("a chart that does not begin with phase from -0.1 to 1.1 and level from 0 to 1");
  return chart;
}

// A box of the first axes of a chart.
Box box_of(const Json& table, const string& what, const Chart& chart, size_t axes) {
  only(table, what, {"low", "high"});
  Box box;
  for (const char* end : {"low", "high"}) {
    const vector<Json>& corner = list_of(field(table, what, end), "a corner");
    if (corner.size() != axes) refuse("a corner that is not " + std::to_string(axes) + " numbers");
    for (const Json& number : corner)
      (end[0] == 'l' ? box.low : box.high).push_back(hexadecimal(number, "a corner"));
  }
  for (size_t axis = 0; axis < axes; ++axis)
    if (!(chart[axis].low <= box.low[axis] && box.low[axis] <= box.high[axis] &&
          box.high[axis] <= chart[axis].high))
      refuse(what + " that is no box of the chart");
  return box;
}

Statement statement_of(const Json& table, const Chart& chart,
                       const std::map<string, Output>& outputs) {
  only(table, "a statement",
       {"conditions", "region", "scales", "bounds", "degree", "root", "tree"});
  Statement s;
  s.region = text_of(field(table, "a statement", "region"), "a region's name");
  s.tree = text_of(field(table, "a statement", "tree"), "a tree");
  if (s.tree.empty() || s.tree.find_first_not_of(string(kAxisSigns) + "-") != string::npos)
    refuse("a tree that is no string of axes from 0 to f and -");
  s.root_box = box_of(field(table, "a statement", "root"), "a root box", chart, chart.size());
  if (!is_whole(s.root_box, state_of(s.root_box, chart), chart))
    refuse("a root box that is no box of the chart");
  const int degree = integer_of(field(table, "a statement", "degree"), "a degree");
  if (degree != 1 && degree != 2) refuse("a degree other than 1 and 2");
  const vector<string> names = names_of(field(table, "a statement", "conditions"), "conditions");
  if (names.empty()) refuse("a statement about nothing");
  const Json& scales = field(table, "a statement", "scales");
  const Json& bounds = field(table, "a statement", "bounds");
  only(scales, "the scales", names);
  only(bounds, "the bounds", names);
  for (const string& name : names) {
    const auto output = outputs.find(name);
    if (output == outputs.end()) refuse(name + ", which is no output of the Program");
    Claim claim;
    claim.name = name;
    claim.scale = number_of(field(scales, "the scales", name), "a scale");
    claim.bound = number_of(field(bounds, "the bounds", name), "a bound");
    claim.output = &output->second;
    if (!(claim.scale > 0.0)) refuse("a scale that is not positive, for " + name);
    if (!of_theorem(name) && !(claim.bound >= 0.0)) refuse("a negative bound, for " + name);
    s.claims.push_back(claim);
  }
  return s;
}

// What a statement about a premise stands under, where one about a condition has its region.
string label_of(const string& premise) {
  if (premise.rfind("set/", 0) == 0) return "walking set";
  if (premise.rfind("full/", 0) == 0) return "full order";
  if (premise.rfind("disturbed/", 0) == 0) return "disturbed";
  static const std::set<string> of_return_map = {"orbit/expansion", "orbit/gain", "orbit/moved",
                                                "orbit/along"};
  return of_return_map.count(premise) ? "return map" : "orbit";
}

// A statement about a condition is one about its region, in its scale; beyond the ends of a step a
// theorem needs it on the strips. Outputs of theorems have no scale.
void match(const Statement& s, const ProofFile& file) {
  for (const Claim& claim : s.claims) {
    const auto found = of_theorem(claim.name) ? file.conditions.end()
                                              : file.conditions.find(claim.name);
    const double scale = found == file.conditions.end() ? 1.0 : found->second.scale;
    if (scale != claim.scale)
      throw Inconsistent{claim.name + " has the scale " + brief(scale) + ", " +
                         brief(claim.scale) + " in a statement"};
    const bool beyond = s.root_box.low[0] < 0.0 || s.root_box.high[0] > 1.0;
    const bool premise = found == file.conditions.end();
    const string region = premise ? label_of(claim.name) : beyond ? "strips" : found->second.region;
    if (region != s.region)
      throw Inconsistent{claim.name + " has the region " + region + ", " + s.region +
                         " in a statement"};
    if (premise || beyond) continue;
    const vector<Box>& boxes = file.regions.at(found->second.region);
    if (std::none_of(boxes.begin(), boxes.end(),
                     [&](const Box& box) { return is_whole(s.root_box, box, file.chart); }))
      throw Inconsistent{"a statement about " + claim.name +
                         " whose root is no box of the region " + region};
  }
}

vector<double> series_of(const Json& value, const string& what) {
  vector<double> series;
  limit(list_of(value, what).size(), kMostSeries, "numbers in " + what);
  for (const Json& item : value.items) series.push_back(hexadecimal(item, what));
  if (series.empty()) refuse(what + " without numbers");
  return series;
}

// 1 + x to the nearest double, as whoever wrote the boxes of T has it.
double one_and(double x) {
  std::fesetround(FE_TONEAREST);
  volatile double one = 1.0, other = x, sum = one + other;
  std::fesetround(FE_UPWARD);
  return sum;
}

WalkingSet walking_set_of(const Json& table) {
  const string what = "level 2";
  vector<string> fields = {"start_strip", "guard_strip", "risen",  "falling",
                           "disturbance", "barriers",    "carried"};
  for (const char* name : {"told", "floor"})
    if (table.find(name)) fields.push_back(name);
  only(table, what, fields);
  const auto number = [&](const char* name) { return hexadecimal(field(table, what, name), name); };
  WalkingSet t;
  t.start_strip = number("start_strip");
  t.guard_strip = number("guard_strip");
  t.risen = number("risen");
  t.falling = number("falling");
  t.first = -t.start_strip;
  t.before = one_and(-t.guard_strip);
  t.last = one_and(t.guard_strip);
  const vector<double> push = series_of(field(table, what, "disturbance"), "a disturbance");
  if (push.size() != 2 || !(push[0] >= 0.0 && push[1] >= 0.0))
    refuse("a disturbance that is not two numbers from 0 up");
  std::copy(push.begin(), push.end(), t.push);
  t.barriers = names_of(field(table, what, "barriers"), "barriers");
  t.carried = names_of(field(table, what, "carried"), "carried");
  if (const Json* told = table.find("told")) t.told = names_of(*told, "told");
  if (table.find("floor")) t.floor = number("floor");
  if (!(t.floor >= 0.0)) refuse("a floor that is not a number from 0 up");
  return t;
}

Orbit orbit_of(const Json& table, const Tube& tube) {
  const string what = "level 3";
  const auto series = [&](const char* name) { return series_of(field(table, what, name), name); };
  const string attraction = text_of(field(table, what, "attraction"), "attraction");
  if (attraction == "any two walks" || attraction == "contraction alone") {
    only(table, what, {"attraction", "expansion"});
    Orbit o;
    o.walks = attraction == "any two walks";
    o.alone = !o.walks;
    o.expansion = series("expansion");
    return o;
  }
  only(table, what, {"attraction", "guard_from", "guard_to", "lower", "upper", "expansion",
                     "slowest", "fastest"});
  if (attraction != "contraction" && attraction != "nested tubes")
    refuse("attraction by " + attraction);
  Orbit o;
  o.nested = attraction == "nested tubes";
  o.thin.lower = series("lower");
  o.thin.upper = series("upper");
  o.thin.start = tube.start;
  o.thin.guard = tube.guard;
  o.expansion = series("expansion");
  o.slowest = series("slowest");
  o.fastest = series("fastest");
  o.guard_from = hexadecimal(field(table, what, "guard_from"), "guard_from");
  o.guard_to = hexadecimal(field(table, what, "guard_to"), "guard_to");
  return o;
}

FullOrder full_order_of(const Json& table) {
  const string what = "level 4";
  vector<string> fields = {"bandwidth",   "radius",   "shrink", "guard_radius", "start_strip",
                           "guard_strip", "crossing", "risen",  "pace",         "inertia",
                           "mismatch",    "drift",    "gain",   "landing",      "landing_slope",
                           "barriers"};
  for (const char* name : {"least_radius", "weights"})
    if (table.find(name)) fields.push_back(name);
  only(table, what, fields);
  const auto number = [](const Json& from, const char* name) {
    return hexadecimal(field(from, "level 4", name), name);
  };
  FullOrder f;
  f.bandwidth = number(table, "bandwidth");
  f.radius = number(table, "radius");
  f.shrink = number(table, "shrink");
  f.guard_radius = number(table, "guard_radius");
  f.start_strip = number(table, "start_strip");
  f.guard_strip = number(table, "guard_strip");
  f.crossing = number(table, "crossing");
  f.risen = number(table, "risen");
  f.inertia = number(table, "inertia");
  f.mismatch = number(table, "mismatch");
  f.drift = number(table, "drift");
  f.gain = number(table, "gain");
  f.landing = number(table, "landing");
  f.landing_slope = number(table, "landing_slope");
  if (table.find("least_radius")) f.floor = number(table, "least_radius");
  if (const Json* weights = table.find("weights")) f.weights = series_of(*weights, "weights");
  const vector<double> pace = series_of(*table.find("pace"), "a pace");
  if (pace.size() != 2) refuse("a pace that is not two numbers");
  f.slowest = pace[0];
  f.fastest = pace[1];
  f.first = -f.start_strip;
  f.last = one_and(f.guard_strip);
  f.before = one_and(-f.guard_strip);
  f.near = one_and(-f.crossing);
  f.far = one_and(f.crossing);
  limit(list_of(*table.find("barriers"), "barriers").size(), kMostNames, "barriers");
  for (const Json& row : table.find("barriers")->items) {
    only(row, "a barrier", {"name", "alpha", "epsilon", "coupling", "reading", "reset",
                            "reset_slope", "sigma"});
    BarrierConstants b;
    b.name = text_of(*row.find("name"), "a barrier's name");
    b.alpha = number(row, "alpha");
    b.epsilon = number(row, "epsilon");
    b.coupling = number(row, "coupling");
    b.reading = number(row, "reading");
    b.reset = number(row, "reset");
    b.reset_slope = number(row, "reset_slope");
    b.sigma = number(row, "sigma");
    f.barriers.push_back(b);
  }
  // The first two are the fences; no two have one name.
  for (size_t i = 0; i < f.barriers.size(); ++i) f.numbers[f.barriers[i].name] = i;
  if (f.numbers.size() != f.barriers.size() || f.numbers.size() < 2 ||
      f.barriers[0].name != "level-lower" || f.barriers[1].name != "level-upper")
    throw Inconsistent{"barriers of level 4 that are not two fences, then others of other names"};
  return f;
}

Disturbed disturbed_of(const Json& table) {
  const string what = "level 5";
  // What other masses do is derived nowhere here, and they stand in many inequalities.
  if (table.find("model_box")) throw Unknown{"level 5 of robots that are not the file's"};
  vector<string> fields = {"push",         "peak",      "hold",    "error", "jerk",
                           "growth_slope", "jerk_push", "barriers"};
  for (const char* name : {"kick", "kick_slope", "kick_push", "kick_peak", "kick_end",
                           "torque_gains", "inertia_gains", "decay", "rest", "state_error",
                           "state_axes", "state_moves", "state_radius", "state_slopes"})
    if (table.find(name)) fields.push_back(name);
  only(table, what, fields);
  const auto number = [&what](const Json& from, const char* name) {
    return hexadecimal(field(from, what, name), name);
  };
  Disturbed d;
  for (const bool most : {false, true}) {
    const char* name = most ? "peak" : "push";
    const vector<double> pair = series_of(field(table, what, name), name);
    if (pair.size() != 2) refuse("a push or peak that is not two numbers");
    std::copy(pair.begin(), pair.end(), most ? d.peak : d.push);
  }
  d.hold = number(table, "hold");
  d.error = number(table, "error");
  d.jerk = number(table, "jerk");
  d.growth_slope = number(table, "growth_slope");
  d.jerk_push = number(table, "jerk_push");
  if (const Json* gains = table.find("torque_gains")) d.torque_gains = series_of(*gains, "gains");
  if (const Json* gains = table.find("inertia_gains")) d.inertia_gains = series_of(*gains, "gains");
  if (table.find("decay")) d.decay = number(table, "decay");
  if (table.find("rest")) d.rest = number(table, "rest");
  if (table.find("kick")) d.kick = number(table, "kick");
  if (table.find("kick_slope")) d.kick_slope = number(table, "kick_slope");
  if (table.find("kick_push")) d.kick_push = number(table, "kick_push");
  if (table.find("kick_peak")) d.kick_peak = number(table, "kick_peak");
  if (table.find("kick_end")) d.kick_end = number(table, "kick_end");
  const auto list = [&table](const char* name) {
    const Json* found = table.find(name);
    return found ? series_of(*found, name) : vector<double>();
  };
  d.state_error = list("state_error");
  d.state_axes = list("state_axes");
  d.state_moves = list("state_moves");
  d.state_slopes = list("state_slopes");
  if (table.find("state_radius")) d.state_radius = number(table, "state_radius");
  const size_t of_state = d.state_axes.empty() ? 0 : 1;
  if (d.state_error.size() != 2 * of_state || d.state_moves.size() != 3 * of_state ||
      d.state_slopes.size() != 2 * of_state)
    refuse("errors of a measured state without two bounds, three moves, two slopes");
  limit(list_of(*table.find("barriers"), "barriers").size(), kMostNames, "barriers");
  for (const Json& row : table.find("barriers")->items) {
    only(row, "a barrier", {"name", "alpha", "weight", "lost"});
    d.barriers.push_back({text_of(*row.find("name"), "a barrier's name"), number(row, "alpha"),
                          number(row, "weight"), number(row, "lost")});
  }
  return d;
}

// Which condition each barrier is of: NAME, or NAME[k] for an element of several.
void find_conditions(FullOrder& f, const std::map<string, Condition>& conditions) {
  for (size_t i = 2; i < f.barriers.size(); ++i) {
    BarrierConstants& b = f.barriers[i];
    string name = b.name;
    const size_t open = name.rfind('[');
    if (!conditions.count(name) && open != string::npos && name.back() == ']') {
      const string digits = name.substr(open + 1, name.size() - open - 2);
      if (digits.empty() || digits.size() > 3 ||
          digits.find_first_not_of("0123456789") != string::npos)
        throw Inconsistent{"level 4 has the barrier " + name + ", which is none"};
      b.element = static_cast<size_t>(std::stoi(digits));
      name = name.substr(0, open);
    }
    const auto found = conditions.find(name);
    if (found == conditions.end() ||
        (found->second.unknown.empty() && found->second.kind != "Barrier"))
      throw Inconsistent{"level 4 has the barrier " + name + ", no barrier condition of the spec"};
    b.condition = &found->second;
  }
}

// Levels 2 to 5, in this order, and whether anything is claimed of them.
Theorems theorems_of(const Json& list, const Tube& tube) {
  Theorems found;
  for (const Json& table : list_of(list, "the theorems")) {
    only(table, "a theorem", {"level", "claimed", "parameters"});
    const int level = integer_of(field(table, "a theorem", "level"), "a level");
    const Json& claimed = field(table, "a theorem", "claimed");
    const Json& parameters = field(table, "a theorem", "parameters");
    if (claimed.type != Json::boolean) refuse("a theorem that is neither claimed nor not");
    if (level == 2 && !found.walking && !found.full) {
      found.walking = walking_set_of(parameters);
      found.walking->claimed = claimed.number_value != 0.0;
    } else if (level == 3 && found.walking && !found.orbit && !found.full) {
      found.orbit = orbit_of(parameters, tube);
      found.orbit->claimed = claimed.number_value != 0.0;
    } else if (level == 4 && !found.full) {
      found.full = full_order_of(parameters);
      found.full->claimed = claimed.number_value != 0.0;
    } else if (level == 5 && found.full && !found.disturbed) {
      found.disturbed = disturbed_of(parameters);
      found.disturbed->claimed = claimed.number_value != 0.0;
      const auto& barriers = found.full->barriers;
      bool same = found.disturbed->barriers.size() == barriers.size();
      for (size_t i = 0; same && i < barriers.size(); ++i)
        same = found.disturbed->barriers[i].name == barriers[i].name;
      if (!same) throw Inconsistent{"barriers of level 5 that are not those of level 4"};
    } else {
      refuse("theorems that are not of level 2, then 3, then 4, then 5");
    }
  }
  return found;
}

// Parameters of the theorems that are lists of numbers, by their names in the Program.
std::map<string, vector<double>> lists_of(const Theorems& theorems) {
  std::map<string, vector<double>> lists;
  if (const auto& t = theorems.walking; t) lists["walking.disturbance"] = {t->push, t->push + 2};
  if (const auto& o = theorems.orbit; o) {
    lists["orbit.lower"] = o->thin.lower;
    lists["orbit.upper"] = o->thin.upper;
    lists["orbit.expansion"] = o->expansion;
    lists["orbit.slowest"] = o->slowest;
    lists["orbit.fastest"] = o->fastest;
  }
  if (const auto& f = theorems.full; f) {
    lists["full.set"] = {f->bandwidth, f->radius,  f->shrink,  f->guard_radius,
                         f->inertia,   f->mismatch, f->drift,  f->gain,
                         f->landing,   f->landing_slope, f->slowest, f->fastest};
    if (f->floor != 0.0) lists["full.set"].push_back(f->floor);
    if (!f->weights.empty()) lists["full.weights"] = f->weights;
    vector<double>& rows = lists["full.barriers"];
    for (const BarrierConstants& b : f->barriers)
      rows.insert(rows.end(), {b.alpha, b.epsilon, b.coupling, b.reading, b.reset, b.reset_slope});
  }
  if (const auto& d = theorems.disturbed; d) {
    lists["disturbed.peak"] = {d->peak, d->peak + 2};
    if (d->hold != 0.0) lists["disturbed.jerk"] = {d->jerk, d->growth_slope, d->jerk_push};
    if (d->scheduled()) {
      lists["disturbed.law"] = {d->decay, d->rest};
      lists["disturbed.torque_gains"] = d->torque_gains;
      lists["disturbed.inertia_gains"] = d->inertia_gains;
    }
    if (d->free_clock()) lists["disturbed.kick"] = {d->kick, d->kick_slope, d->kick_push, d->kick_peak};
    if (d->measured()) {
      lists["disturbed.state_axes"] = d->state_axes;
      lists["disturbed.state_moves"] = d->state_moves;
      lists["disturbed.state_moves"].push_back(d->state_radius);
      lists["disturbed.state_slopes"] = d->state_slopes;
    }
    vector<double>& rows = lists["disturbed.barriers"];
    for (const DisturbedBarrier& b : d->barriers)
      rows.insert(rows.end(), {b.alpha, b.weight, b.lost});
  }
  return lists;
}

// Parameters of theorems that the Program has by name are those of the file. If it is the Program
// that is bounded, it has to have them: its margins are about whatever it computes with.
void match_theorems(const Constants& constants, const Theorems& theorems, bool all) {
  for (const auto& [name, numbers] : lists_of(theorems)) {
    const auto constant = constants.find(name);
    const bool none = numbers.empty() || (name == "walking.disturbance" &&
                                          !theorems.walking->disturbed());
    if (constant == constants.end() ? all && !none : constant->second.values != numbers)
      throw Inconsistent{"the theorem's " + name + " is not that of the Program"};
  }
}

// Whether the model has an array of this name: of the tube, of the policy, or of its ankle's torque.
bool has_array(const Json& model, const string& name) {
  const auto within = [&name](const string& owner, const Json* arrays) {
    return name.rfind(owner, 0) == 0 && arrays && arrays->find(name.substr(owner.size()));
  };
  const Json& policy = *model.find("policy");
  const Json* ankle = policy.find("ankle");
  return within("tube.", model.find("tube")) || within("policy.", policy.find("arrays")) ||
         within("policy.ankle.", ankle ? ankle->find("arrays") : nullptr);
}

// And so are those of policy and tube, which were compared when they were read.
void match_model(const Constants& constants, const Json& model, const Theorems& theorems) {
  const auto lists = lists_of(theorems);
  for (const auto& [name, constant] : constants) {
    if (lists.count(name)) continue;
    if (!has_array(model, name))
      throw Inconsistent{"the Program has the parameter " + name + ", which the file has not"};
  }
}

// full/WHAT BARRIER.
Output barrier_output(const string& what, const string& barrier, const FullOrder& full) {
  const auto known = barrier_outputs().find(what);
  const auto number = full.numbers.find(barrier);
  if (known == barrier_outputs().end() || number == full.numbers.end())
    throw Inconsistent{"the Program's output " + what + " " + barrier + " is no theorem's"};
  Output output = output_of_barrier(what, number->second, known->second);
  if (const Condition* condition = full.barriers[number->second].condition)
    output.unknown = condition->unknown;
  return output;
}

// Every output of the Program with its meaning.
std::map<string, Output> outputs_of(const ProgramFacts& program, const ProofFile& file) {
  const Theorems& theorems = file.theorems;
  std::map<string, Output> found;
  for (const auto& [name, elements] : program.outputs) {
    Output& output = found[name];
    // Premises have a slash in their names and conditions have none, so neither hides the other.
    if (!of_theorem(name)) {
      const auto condition = file.conditions.find(name);
      if (condition == file.conditions.end())
        throw Inconsistent{"the Program's output " + name + " is no condition of the spec"};
      output = output_of(condition->second);
      output.elements = elements;
      continue;
    }
    const auto known = theorem_outputs().find(name);
    const bool of_set = name.rfind("set/", 0) == 0 && theorems.walking;
    const bool of_orbit = name.rfind("orbit/", 0) == 0 && theorems.orbit;
    const bool of_full = name.rfind("full/", 0) == 0 && theorems.full;
    const bool pushed = name.rfind("disturbed/", 0) == 0 && theorems.disturbed;
    const size_t space = name.find(' ');
    if (known != theorem_outputs().end() && (of_set || of_orbit)) {
      output = output_of(name, known->second);
    } else if (of_full && full_outputs().count(name)) {
      output = output_of_full_order(name, full_outputs().at(name));
    } else if (of_full && space != string::npos) {
      output = barrier_output(name.substr(0, space), name.substr(space + 1), *theorems.full);
    } else if (pushed && disturbed_outputs().count(name)) {
      output = output_of_disturbed(name, disturbed_outputs().at(name));
    } else if (pushed && name.rfind("disturbed/state-", 0) == 0 && theorems.disturbed->measured()) {
      output = output_of_measured_state();
    } else if (pushed && name.rfind("disturbed/decrease ", 0) == 0) {
      // Barriers of level 5 are those of level 4, in their order.
      const auto number = theorems.full->numbers.find(name.substr(space + 1));
      if (number == theorems.full->numbers.end())
        throw Inconsistent{"the Program's output " + name + " is about no barrier of level 5"};
      output = output_of_decrease(number->second);
    } else if (of_set && space != string::npos) {
      const string what = name.substr(0, space), barrier = name.substr(space + 1);
      if (what != "set/after" && what != "set/value" && what != "set/rate")
        throw Inconsistent{"the Program's output " + name + " is no theorem's"};
      const auto about = file.conditions.find(barrier);
      if (about == file.conditions.end())
        throw Inconsistent{"the Program's output " + name + " is about no condition of the spec"};
      output = output_of(what, about->second);
    } else {
      throw Inconsistent{"the Program's output " + name + " is no premise of the file's theorems"};
    }
    output.elements = elements;
  }
  return found;
}

void read_regions(const Json& table, const Chart& chart, Regions& regions) {
  if (table.type != Json::object) refuse("regions that are no JSON object");
  for (size_t i = 0; i < table.names.size(); ++i) {
    only_a_name(table.names[i], "a region");
    limit(list_of(table.items[i], "a region").size(), kMostBoxes, "boxes of a region");
    for (const Json& row : table.items[i].items) {
      const Box box = box_of(row, "a box of a region", chart, 2);
      if (box.low[0] < 0.0 || box.high[0] > 1.0) refuse("a region beyond the ends of a step");
      regions[table.names[i]].push_back(box);
    }
    if (regions[table.names[i]].empty()) refuse("the region " + table.names[i] + " without boxes");
  }
}

void read_conditions(const Json& table, const ProgramFacts& program, int joints, ProofFile& file) {
  if (table.type != Json::object) refuse("conditions that are no JSON object");
  for (size_t i = 0; i < table.names.size(); ++i) {
    const string& name = table.names[i];
    only_a_name(name, "a condition");
    const Condition condition = condition_of(table.items[i], joints);
    if (!program.outputs.count(name))
      throw Inconsistent{"the spec's condition " + name + " is no output of the Program"};
    if (!file.regions.count(condition.region))
      throw Inconsistent{name + " is about the region " + condition.region + ", which is none"};
    file.conditions[name] = condition;
  }
}

// Without a model, a spec is what the statements about its outputs say it is.
void conditions_of_statements(const Json& list, const ProgramFacts& program, ProofFile& file) {
  for (const auto& output : program.outputs)
    if (!of_theorem(output.first)) file.conditions[output.first].unknown = "it is not described";
  for (const Json& row : list_of(list, "the statements")) {
    const Json& root = field(row, "a statement", "root");
    const Box box = box_of(root, "a root box", file.chart, file.chart.size());
    const bool strips = box.low[0] < 0.0 || box.high[0] > 1.0;
    for (const string& name : names_of(field(row, "a statement", "conditions"), "conditions")) {
      const auto condition = file.conditions.find(name);
      if (condition == file.conditions.end()) continue;
      Condition& c = condition->second;
      c.scale = number_of(field(field(row, "a statement", "scales"), "the scales", name), "a scale");
      if (strips) continue;
      if (c.region.empty()) c.region = text_of(field(row, "a statement", "region"), "a region");
      vector<Box>& boxes = file.regions[c.region];
      const Box own = state_of(box, file.chart);
      const auto same = [&](const Box& b) { return b.low == own.low && b.high == own.high; };
      if (std::none_of(boxes.begin(), boxes.end(), same)) boxes.push_back(own);
      limit(boxes.size(), kMostBoxes, "boxes of a region");
    }
  }
}

vector<Command> commands_of_policy(const Json& policy) {
  const Json* told = policy.type == Json::object ? policy.find("commands") : nullptr;
  return told ? commands_of(*told) : vector<Command>();
}

// Whether the first axes behind phase and level are those of these commands, before and after.
bool begins_with(const Chart& chart, const vector<Command>& commands) {
  if (chart.size() < 2 + 2 * commands.size()) return false;
  for (size_t i = 0; i < commands.size(); ++i)
    if (chart[2 + 2 * i].name != commands[i].name + " before" ||
        chart[3 + 2 * i].name != commands[i].name + " after")
      return false;
  return true;
}

// Whether an axis with this change allows no more than the command does from step to step. A rounded
// difference is above a double only if the difference is.
bool no_farther(const Axis& axis, const Command& c) {
  return axis.change <= c.change || (!axis.near() && axis.high - axis.low <= c.change);
}

// Every statement is about the chart, and the model about what its gait is told: the chart may be that
// or a part of it, which is then said. Whether its first axes are those of the commands.
bool compare_ranges(const vector<Command>& commands, ProofFile& file) {
  if (!begins_with(file.chart, commands)) {
    file.part = "every statement holds, on a chart without the axes of the gait's commands";
    return false;
  }
  bool part = false;
  string words;
  for (size_t i = 0; i < commands.size(); ++i) {
    const Command& c = commands[i];
    for (const bool after : {false, true}) {
      const Axis& axis = file.chart[2 + 2 * i + after];
      if (axis.low < c.low || axis.high > c.high || (after && !no_farther(axis, c)))
        throw Inconsistent{"the file's chart is not that of its gait's commands"};
      part = part || axis.low != c.low || axis.high != c.high ||
             axis.change != (after ? c.change : HUGE_VAL);
      words += (words.empty() ? "" : " and ") + axis_words(axis, axis.low, axis.high);
    }
  }
  if (part) file.part = "every statement holds, for " + words + " only: part of the gait's commands";
  return true;
}

// Outputs as formulas: of a gait that is told commands, all, of a step between two of them; of another,
// those of levels 4 and 5. What is not known is said of the output.
void record_outputs(ProofFile& file) {
  Recording recording;
  const bool told = file.model.family.has_value();
  const Step<Formula> step =
      told ? told_step(file.model, recording) : written_step(file.model);
  Place<Formula> place(file.model, step, file.theorems, Formula::axis(recording, 0),
                       Formula::axis(recording, 1));
  std::map<string, vector<size_t>> named;
  for (auto& [name, output] : file.outputs) {
    if (!output.unknown.empty() || (!told && output.margins)) continue;
    if (told && !output.margins) {
      output.unknown = "it is not about gaits that are told commands";
      continue;
    }
    output.recorded = true;
    try {
      for (const Formula& one : output.formulas(place)) named[name].push_back(one.of(recording));
    } catch (const Unknown& unknown) {
      output.unknown = unknown.what;
      continue;
    }
    if (named[name].size() != output.elements)
      throw Inconsistent{name + " has " + std::to_string(named[name].size()) +
                         " elements in the model, " + std::to_string(output.elements) +
                         " in the Program"};
  }
  const size_t fibres = file.theorems.full ? 2 * size_t(file.model.robot.joints()) : 0;
  file.recorded = std::make_shared<const Listing>(file.chart.size(), std::move(recording.elements),
                                                  std::move(named), fibres);
}

// Those of levels 4 and 5. What their numbers are may leave them without formulas, so what follows from
// the statements is looked at before.
void record_full_order(ProofFile& file) {
  if (file.theorems.full && !file.program && file.underivable.empty()) record_outputs(file);
}

// Regions and conditions of a family's model, which are no others than those of its spec.
void read_family_spec(const Json& model, const ProgramFacts& program, ProofFile& file) {
  const KnownFamily& family = *file.family;
  const string spec = string("that of ") + family.words + "'s spec";
  if (!family.has(file.chart))
    throw Inconsistent{"the chart is not that of " + string(family.words)};
  const Json &regions = *model.find("regions"), &conditions = *model.find("conditions");
  vector<string> names;
  for (const SpecRegion& one : family.regions) names.push_back(one.name);
  only(regions, "the regions", names);
  for (const SpecRegion& one : family.regions) {
    const vector<Json>& rows = list_of(*regions.find(one.name), "a region");
    if (rows.size() != 1) refuse("a region that is not one box");
    const Box box = box_of(rows[0], "a box of a region", file.chart, file.chart.size());
    if (!is_whole(box, {{one.low[0], one.low[1]}, {one.high[0], one.high[1]}}, file.chart))
      throw Inconsistent{"the region " + string(one.name) + " is not " + spec};
    file.regions[one.name] = {box};
  }
  names.clear();
  for (const SpecCondition& one : family.conditions) names.push_back(one.name);
  only(conditions, "the conditions", names);
  for (const SpecCondition& one : family.conditions) {
    const Json& row = *conditions.find(one.name);
    only(row, "a condition", {"kind", "region", "scale"});
    const auto elements = program.outputs.find(one.name);
    if (text_of(*row.find("region"), "a region") != one.region ||
        number_of(*row.find("scale"), "a scale") != 1.0 || elements == program.outputs.end() ||
        elements->second != one.elements)
      throw Inconsistent{"the condition " + string(one.name) + " is not " + spec};
    file.conditions[one.name].region = one.region;
  }
  if (program.outputs.size() != names.size())
    throw Inconsistent{"the Program has outputs that are no conditions of " + string(family.words)};
}

// A system of a known family.
void read_system(const Json& model, const ProgramFacts& program, bool by_program, ProofFile& file) {
  vector<string> parts = {"family", "robot", "regions", "conditions"};
  parts.insert(parts.end(), file.family->parts.begin(), file.family->parts.end());
  only(model, "the model", parts);
  read_family_spec(model, program, file);
  const string weights = "the file says that their weights have the sha256 " + file.weights_sha256 +
                         ", which is not checked here";
  const bool pole = file.family == &cartpoles();
  file.system = (pole ? derived_cartpole : derived_hopper)(model, program.constants, weights);
  if (by_program) file.underivable = "bounded by its Program";
  else file.recorded = file.system->recorded;
}

// A file about a system that does not walk: of a known family, or known by its Program alone.
void read_other_family(const Json& table, const ProgramFacts& program, bool by_program,
                       ProofFile& file) {
  if (!list_of(*table.find("theorems"), "the theorems").empty())
    refuse("theorems about walks on a chart without phase and level");
  if (program.ball) refuse("a Program of xi without level 4, or level 4 without xi");
  const Json& model = *table.find("model");
  if (model.type == Json::null) {
    file.underivable = "the file describes no system that is known here";
  } else if (model.type != Json::object || !model.find("family")) {
    refuse("a model of another family than the chart's");
  } else {
    const string name = text_of(*model.find("family"), "a family");
    for (const KnownFamily* known : {&cartpoles(), &hoppers()})
      if (name == known->name) file.family = known;
    if (file.family) read_system(model, program, by_program, file);
    else file.underivable = "a family of systems that is not known here";
  }
  if (!file.family) conditions_of_statements(*table.find("statements"), program, file);
  for (const auto& [name, elements] : program.outputs) {
    if (of_theorem(name)) refuse("an output of the Program named " + name);
    Output& output = file.outputs[name];
    output.elements = elements;
    output.recorded = file.recorded != nullptr;
    if (!file.underivable.empty())
      output.unknown = file.underivable + "; --program checks the Program in the file instead";
    if (!file.family) continue;
    for (const SpecCondition& one : file.family->conditions)
      if (name == one.name)
        output.words = [one](double least) { return with_unit(one.words, least, one.unit); };
  }
}

// What the file says of robot, policy, tube and spec, as far as it is needed.
void read_model(const Json& table, const ProgramFacts& program, bool by_program, ProofFile& file) {
  constexpr int kAnyJoint = 1'000'000;  // Where no robot is read, no joint is looked at.
  const Json& model = *table.find("model");
  if (model.type == Json::null) {
    file.underivable = "the file describes no policy and robot that are known here";
    conditions_of_statements(*table.find("statements"), program, file);
    return;
  }
  vector<string> parts = {"robot", "policy", "tube", "regions", "conditions"};
  const Json* residuals = model.find("residuals");
  if (residuals) parts.push_back("residuals");  // Of a run that has learned some.
  only(model, "the model", parts);
  read_regions(*model.find("regions"), file.chart, file.regions);
  const vector<Command> commands = commands_of_policy(*model.find("policy"));
  const bool alike = compare_ranges(commands, file);
  const bool leans = std::any_of(commands.begin(), commands.end(),
                                 [](const Command& c) { return c.name == kLean; });
  const bool known = file.chart.size() == 2 + 2 * commands.size() + leans &&
                     (!leans || file.chart.back().ends_in(kNearBelief));
  if (by_program || !alike || !known) {
    file.underivable = "a chart with the axis " + file.chart.back().name;
    read_conditions(*model.find("conditions"), program, kAnyJoint, file);
    return;
  }
  file.model.robot = robot_of(*model.find("robot"));
  if (file.model.robot.name != file.robot)
    throw Inconsistent{"the file is about " + file.robot + ", its model is that of " +
                       file.model.robot.name};
  const int joints = file.model.robot.joints();
  file.model.policy =
      policy_of(*model.find("policy"), joints, program.constants, file.model.family);
  if (file.model.family) {
    read_fences(*model.find("tube"), program.constants, *file.model.family);
  } else {
    file.model.tube = tube_of(*model.find("tube"), file.model.policy, program.constants);
    file.model.step = only_step(file.model.policy, file.model.tube);
  }
  if (residuals) {
    only(*residuals, "the residuals", {"flow", "reset"});
    const Json &flow = *residuals->find("flow"), &reset = *residuals->find("reset");
    if (flow.type != Json::null) file.model.flow = flow_residual_of(flow, program.constants);
    if (reset.type != Json::null)
      file.model.reset = reset_residual_of(reset, joints, program.constants);
    if (file.model.family && file.model.reset)
      throw Unknown{"a gait that is told commands, on a robot with what was learned of its reset,"};
  }
  read_conditions(*model.find("conditions"), program, joints, file);
}

// A reset lands in the set of the next step. Level 2 without a command that the gait is told would call
// it the set of the same one.
void match_told(const ProofFile& file, const Json& model) {
  if (!file.theorems.walking || model.type != Json::object) return;
  vector<string> names;
  for (const Command& c : commands_of_policy(*model.find("policy"))) names.push_back(c.name);
  if (file.theorems.walking->told != names)
    throw Inconsistent{"level 2 is stated, and it is about other commands than those of the model's "
                       "gait"};
}

// Levels 4 and 5 are about one gait of one robot on point feet, on footholds that lie where they are
// meant to. Flat feet land flat on footholds of that kind, and on no others.
void match_full_order(const ProofFile& file, const Json& model) {
  const Theorems& theorems = file.theorems;
  const Json* robot = model.type == Json::object ? model.find("robot") : nullptr;
  const bool flat = robot && robot->type == Json::object && robot->find("sole");
  if (flat && theorems.walking && theorems.walking->floor > 0.0)
    throw Inconsistent{"a floor of unknown height is stated, and it is about point feet"};
  if (!theorems.full) return;
  if (flat) throw Inconsistent{"level 4 is stated, and it is about point feet"};
  if (file.chart.size() > 2) {
    string others;
    for (size_t i = 2; i < file.chart.size(); ++i)
      others += (i == 2 ? "" : ", ") + file.chart[i].name;
    throw Inconsistent{"level 4 is stated, and it is about one gait of one robot, without axes of " +
                       others};
  }
  if (theorems.walking && theorems.walking->floor > 0.0)
    throw Inconsistent{
        "level 4 is stated, and it is about footholds that lie where they are meant to"};
}


// The file, filled in place: its outputs refer to its conditions.
void read_proof(const Json& table, bool by_program, ProofFile& file) {
  if (table.type == Json::object && table.find("format") &&
      integer_of(*table.find("format"), "a format") != 3)
    refuse("the format " + table.find("format")->string_value);
  only(table, "the file", {"format", "kind", "robot", "weights_sha256", "spec", "program",
                           "program_hash", "chart", "statements", "theorems", "model"});
  const auto text = [&](const char* name) { return text_of(*table.find(name), name); };
  if (text("kind") != "neuralgaits certificate") refuse("the kind '" + text("kind") + "'");
  file.chart = chart_of(*table.find("chart"));
  file.robot = named(*table.find("robot"), "robot").name;
  file.spec = named(*table.find("spec"), "spec").name;
  file.weights_sha256 = text("weights_sha256");
  limit(list_of(*table.find("statements"), "the statements").size(), kMostStatements, "statements");
  if (table.find("statements")->items.empty()) refuse("no statements");
  const ProgramFacts program = program_facts(*table.find("program"), file.chart);
  if (!program.has_conditions())
    refuse("a file of level 4 alone, as earlier versions wrote it beside the others");
  string written;
  canonical(*table.find("program"), written);
  const string hash = sha256(written);
  if (hash != text("program_hash"))
    throw Inconsistent{"the Program's hash is " + hash + ", not " + text("program_hash")};
  if (by_program) file.program = program_of(*table.find("program"), program.values);

  if (!walks(file.chart)) {
    read_other_family(table, program, by_program, file);
  } else {
    read_model(table, program, by_program, file);
    file.theorems = theorems_of(*table.find("theorems"), file.model.tube);
    match_told(file, *table.find("model"));
    match_full_order(file, *table.find("model"));
  }
  if (auto& full = file.theorems.full; full && file.underivable.empty()) {
    find_conditions(*full, file.conditions);
    if (file.model.flow || file.model.reset)
      throw Inconsistent{"level 4 of a robot with residuals: it is about the links alone"};
    if (program.ball && program.inputs[1][0] != 2 * file.model.robot.joints())
      throw Inconsistent{"xi has another size than two for each joint"};
  }
  if (program.ball != file.theorems.full.has_value())
    refuse("a Program of xi without level 4, or level 4 without xi");
  match_theorems(program.constants, file.theorems, by_program);
  if (walks(file.chart)) {
    if (file.underivable.empty())
      match_model(program.constants, *table.find("model"), file.theorems);
    file.outputs = outputs_of(program, file);
  }
  for (auto& [name, output] : file.outputs) {
    if (by_program) {
      output.unknown.clear();
      output.words = [](double least) { return "margin >= " + at_least(least); };
    } else if (!file.underivable.empty()) {
      output.unknown = file.underivable + "; --program checks the Program in the file instead";
    }
  }
  if (file.model.family) record_outputs(file);
  for (const Json& row : table.find("statements")->items)
    file.statements.push_back(statement_of(row, file.chart, file.outputs));
  size_t leaves = 0;
  for (const Statement& s : file.statements)
    leaves += static_cast<size_t>(std::count(s.tree.begin(), s.tree.end(), '-'));
  limit(leaves, kMostLeaves, "leaves of all trees together");
  for (const Statement& statement : file.statements) match(statement, file);
  for (const Statement& s : file.statements)
    for (const Claim& claim : s.claims) file.stated.emplace(about(claim.name, s.root_box), &claim);
}

}  // namespace
