#pragma once

#include "robot.hpp"

namespace {

// ---------------------------------------------------------------------------- 8 steps
//
// One step of a gait: where it begins and ends, the path of its outputs in between, and the fences of
// its tube. Without commands all steps are one, and its numbers are known. Told commands, they are
// formulas of those before and after; what makes them stands in section 11.

template <class S>
struct Fences {
  S lower, upper;  // zeta = z2^2 / 2
};

// The ground of a step: the line between its two footholds, and the slopes under them.
template <class K>
struct Ground {
  K rise, level;                // Of the line: metres a metre, and its height at the stance foot.
  K stance_sine, stance_cosine; // Of the slope under the stance foot,
  K landing_sine, landing_cosine;  // and of that under the next foothold.
};

template <class K>
struct Step {
  K start, guard;   // z1 after the impact and at the guard.
  vector<K> cubic;  // [4, m], in powers of the phase;
  vector<K> ends;   // or [4, m]: value and slope in the phase at its start, and at its end.
  vector<K> first;  // Biases of the network's first layer; none: those that it has.
  K from, to;       // z1 at phase 0 and 1 of the tube.
  // The fences: sum over the monomials of c of series in the phase, c on the line between the commands
  // before and after, as places in the family.
  vector<vector<double>> lower, upper;
  double unit = 1.0;
  vector<K> before, after;
  std::optional<Ground<K>> ground;       // None: level.
  vector<K> start_outputs, guard_outputs;
  std::shared_ptr<const RobotOf<K>> robot;  // That walks it; none: the file's.
  std::shared_ptr<const Step<K>> then;   // If the commands stay; none: the same step again.

  const Step& next() const { return then ? *then : *this; }
  K span() const { return guard - start; }
};

// The step of a gait without commands.
Step<I> only_step(const Policy& policy, const Tube& tube) {
  Step<I> s;
  s.start = I(policy.start);
  s.guard = I(policy.guard);
  for (const double c : policy.cubic) s.cubic.push_back(I(c));
  s.from = I(tube.start);
  s.to = I(tube.guard);
  s.lower = {tube.lower};
  s.upper = {tube.upper};
  s.unit = tube.unit;
  return s;
}

// The same of formulas.
Step<Formula> written(const Step<I>& known) {
  const auto all = [](const vector<I>& numbers) {
    return vector<Formula>(numbers.begin(), numbers.end());
  };
  Step<Formula> s;
  s.start = known.start;
  s.guard = known.guard;
  s.cubic = all(known.cubic);
  s.from = known.from;
  s.to = known.to;
  s.lower = known.lower;
  s.upper = known.upper;
  s.unit = known.unit;
  return s;
}

// Chebyshev polynomials T_0 to T_(count - 1) of 2 phase - 1. As T_(m+n) = 2 T_m T_n - T_(m-n) with
// m and n near half: one by one, an error would grow with the powers of 1 + sqrt 2.
template <class S>
vector<S> chebyshev(const S& phase, size_t count) {
  vector<S> t = {S(I(1.0)), I(2.0) * phase - S(I(1.0))};
  while (t.size() < count) {
    const size_t m = (t.size() + 1) / 2, n = t.size() / 2;
    t.push_back(I(2.0) * (t[m] * t[n]) - t[m - n]);
  }
  return t;
}

// A series' value.
template <class S>
S sum(const vector<double>& series, const vector<S>& polynomials) {
  S total(0.0);
  for (size_t k = 0; k < series.size(); ++k) total = total + I(series[k]) * polynomials[k];
  return total;
}
inline Formula sum(const vector<double>& series, vector<Formula> polynomials) {
  polynomials.resize(series.size());
  return weighted(series.data(), polynomials, Formula(0.0));
}

// Values of the monomials.
template <class S>
vector<S> powers(const vector<S>& c) {
  vector<S> found = {S(I(1.0))};
  found.insert(found.end(), c.begin(), c.end());
  for (size_t i = 0; i < c.size(); ++i)
    for (size_t j = i; j < c.size(); ++j) found.push_back(c[i] * c[j]);
  return found;
}

template <class S>
Fences<S> fences(const Tube& tube, const S& phase) {
  const auto t = chebyshev(phase, std::max(tube.lower.size(), tube.upper.size()));
  return {I(tube.unit) * sum(tube.lower, t), I(tube.unit) * sum(tube.upper, t)};
}

template <class K, class S>
Fences<S> fences(const Step<K>& step, const S& phase) {
  const auto t = chebyshev(phase, std::max(step.lower[0].size(), step.upper[0].size()));
  vector<S> at;
  for (size_t i = 0; i < step.before.size(); ++i)
    at.push_back(S(step.before[i]) + (step.after[i] - step.before[i]) * phase);
  const vector<S> monomial = powers(at);
  const auto value = [&](const vector<vector<double>>& rows) {
    S total = sum(rows[0], t);
    for (size_t k = 1; k < rows.size(); ++k) total = total + monomial[k] * sum(rows[k], t);
    return I(step.unit) * total;
  };
  return {value(step.lower), value(step.upper)};
}

// z1 at both ends of a tube.
inline std::pair<I, I> ends(const Tube& tube) { return {I(tube.start), I(tube.guard)}; }
template <class K>
std::pair<K, K> ends(const Step<K>& step) { return {step.from, step.to}; }

template <class Band, class S>
S phase_of(const Band& band, const S& z1) {
  const auto [from, to] = ends(band);
  return inverse(to - from) * (z1 - S(from));
}

template <class Band, class S>
S level_of(const Band& band, const S& z1, const S& z2) {
  const Fences<S> f = fences(band, phase_of(band, z1));
  return (I(0.5) * (z2 * z2) - f.lower) / (f.upper - f.lower);
}

// The state (z1, z2) at a phase of the step, zeta given; and at a box of a tube's chart.
template <class Band, class S>
std::pair<S, S> z_of(const Band& band, const S& phase, const S& zeta) {
  const auto [from, to] = ends(band);
  return {S(from) + (to - from) * phase, root(I(2.0) * zeta)};
}

template <class Band, class S>
std::pair<S, S> z_at(const Band& band, const S& phase, const S& level) {
  const Fences<S> f = fences(band, phase);
  return z_of(band, phase, f.lower + level * (f.upper - f.lower));
}

struct Model {
  Robot robot;
  Policy policy;
  Tube tube;
  std::optional<Family> family;  // Of a gait that is told commands: instead of a tube.
  std::optional<FlowResidual> flow;
  std::optional<ResetResidual> reset;
  Step<I> step;  // Of a gait that is not.
};

// The step of a gait without commands, as formulas.
Step<Formula> written_step(const Model& model) {
  Step<Formula> step = written(model.step);
  step.robot = std::make_shared<const RobotOf<Formula>>(leaning<Formula>(model.robot, {}));
  return step;
}

// The robot that walks a step.
inline const Robot& walker_of(const Model& m, const Step<I>& s) { return s.robot ? *s.robot : m.robot; }
inline const RobotOf<Formula>& walker_of(const Model&, const Step<Formula>& s) { return *s.robot; }

}  // namespace
