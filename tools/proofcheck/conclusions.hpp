#pragma once

#include "hold_map.hpp"
#include "hopper.hpp"

namespace {

// --------------------------------------------------------------------------- 21 what follows
//
// The statements are inequalities on boxes. Levels 2 and 3 put them together: each method draws one
// conclusion, or says which premise is missing. docs/walking_set.md has the same in prose.

using Regions = std::map<string, vector<Box>>;
// An output and a box of phase and level: both corners. Roots are whole in every further axis.
using About = std::pair<string, std::array<double, 4>>;

About about(const string& output, const Box& box) {
  return {output, {box.low[0], box.low[1], box.high[0], box.high[1]}};
}

struct ProofFile {
  string robot, spec, weights_sha256;
  Chart chart;
  Model model;
  string part;                     // Why it is about a part of what its gait is told; empty if not.
  string underivable;              // Why nothing follows from `model` here; empty if it does.
  const KnownFamily* family = nullptr;   // Of a system that does not walk, if it is known here,
  std::optional<DerivedSystem> system;   // and what follows from its numbers.
  std::optional<Program> program;  // If statements are to be bounded by it.
  std::shared_ptr<const Listing> recorded;  // Outputs that are bounded by what was written down.
  Regions regions;
  std::map<string, Condition> conditions;
  Theorems theorems;
  std::map<string, Output> outputs;  // Of the Program.
  vector<Statement> statements;
  std::map<About, const Claim*> stated;  // What they say, by output and box.
};

// The first claim about an output on a box; none if there is none.
const Claim* stated_about(const ProofFile& file, const string& output, const Box& box) {
  const auto found = file.stated.find(about(output, box));
  return found == file.stated.end() ? nullptr : found->second;
}

struct DoesNotFollow { string why; };

string listed(const vector<string>& names) {
  string all;
  for (const string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

I exp(I x) { return {exp_at(x.low()).n, exp_at(x.high()).h}; }

// Integral of a series over the step: that of T_k over [-1, 1] is 2 / (1 - k^2) for even k, or 0.
I over_step(const vector<double>& series) {
  I total(0.0);
  for (size_t k = 0; k < series.size(); k += 2) {
    const double square = static_cast<double>(k) * static_cast<double>(k);
    total = total + I(series[k]) / (I(1.0) - I(square));
  }
  return total;
}

// What |series| is at most wherever |2 phase - 1| is not larger than at this phase beyond the step:
// there no Chebyshev polynomial is larger.
I largest(const vector<double>& series, I phase) {
  vector<double> sizes;
  for (const double c : series) sizes.push_back(std::abs(c));
  return sum(sizes, chebyshev(phase, series.size()));
}

// Whether boxes together are all of the chart: each cell between their edges lies in one of them.
bool covers(const vector<Box>& boxes) {
  std::set<double> cuts[2];
  for (int axis = 0; axis < 2; ++axis) {
    cuts[axis] = {0.0, 1.0};
    for (const Box& box : boxes) cuts[axis].insert({box.low[axis], box.high[axis]});
  }
  for (auto x = cuts[0].begin(), x2 = std::next(x); x2 != cuts[0].end(); ++x, ++x2)
    for (auto y = cuts[1].begin(), y2 = std::next(y); y2 != cuts[1].end(); ++y, ++y2)
      if (std::none_of(boxes.begin(), boxes.end(), [&](const Box& box) {
            return box.low[0] <= *x && *x2 <= box.high[0] && box.low[1] <= *y && *y2 <= box.high[1];
          }))
        return false;
  return true;
}

class Conclusions {
 public:
  explicit Conclusions(const ProofFile& file) : file_(file) {}

  // Level 2. A trajectory that starts in T before the ground moves forward at `pace` or more,
  // crosses no fence, and can meet the ground only falling: not while the foot rises, not while it
  // is above the ground, and it falls from then on, being above the ground at phase `before` and
  // below at `last`. From the strip in between, the reset lands between the fences, less than
  // start_strip from phase 0: in T again.
  vector<string> walking() const {
    const WalkingSet& t = *file_.theorems.walking;
    if (!(0.0 < t.start_strip && t.start_strip < 0.1 && 0.0 < t.guard_strip &&
          t.guard_strip < 0.1))
      throw DoesNotFollow{"strips that are not between 0 and 0.1"};
    if (!(0.0 < t.risen && t.risen <= t.falling && t.falling < t.before))
      throw DoesNotFollow{"phases of rise and fall that are not in order"};
    const double pace = positive("set/forward", t.whole());
    positive("set/inertia", t.whole());
    match_beliefs(t);
    const double width = positive("set/width", t.lower());
    positive("set/fence-lower", t.lower());
    positive("set/fence-upper", t.upper());
    positive("set/foot-rises", {{t.first, 0.0}, {t.risen, 1.0}});
    off_the_line("set/foot-above", {{t.risen, 0.0}, {t.falling, 1.0}});
    positive("set/foot-falls", {{t.falling, 0.0}, {t.last, 1.0}});
    off_the_line("set/foot-above", {{t.before, 0.0}, {t.before, 1.0}});
    off_the_line("set/foot-below", {{t.last, 0.0}, {t.last, 1.0}});
    if (t.told.empty()) {
      positive("set/reset-level", t.strip());
      if (!(bound("set/reset-phase", t.strip()) > -t.start_strip))
        throw DoesNotFollow{"a reset may land outside the strip around the start of a step"};
    } else {
      inlet(t);
    }
    string start = string("T") +
                   (t.told.empty() ? "" : " of a step with its commands before and after") +
                   " is every state with z2 > 0 and phase in " + interval_words(t.first, t.last) +
                   " between the fences";
    const vector<string> safe = barriers(t, start);
    carried(t);

    const I longest = (I(t.last) - I(t.first)) / I(pace);
    string push;
    if (t.disturbed())
      push = ", whatever d(t) with |d| <= (" + brief(t.push[0]) + " m/s, " + brief(t.push[1]) +
             " N m) is added to dz,";
    if (t.floor > 0.0 && !t.told.empty())
      throw DoesNotFollow{"a floor of unknown height and commands together"};
    if (!t.told.empty()) push += ", whatever admissible commands follow each other,";
    if (t.floor > 0.0)
      push += (push.empty() ? ", each foothold up to " : " each foothold up to ") + brief(t.floor) +
              " m higher or lower than meant,";
    vector<string> words = {
        start + ", up to where the swing foot meets the ground; its width in z2 is everywhere " +
            at_least(width) + " of its middle or more",
        "every trajectory of the projected hybrid zero dynamics that starts in T" + push +
            " stays between the fences, meets the ground once and transversally within " +
            at_most(longest.high()) + " s, and is reset into T" +
            (t.told.empty() ? "" : " of the next step, whatever that is told") +
            ": it walks for ever"};
    if (!t.told.empty()) words.push_back(admissible(t));
    const string meant =
        t.disturbed() ? ", with rates and forces of the undisturbed flow at each state" : "";
    vector<string> whole, part;
    for (const string& name : t.carried)
      (covers(boxes(name)) ? whole : part).push_back(name);
    if (!whole.empty()) words.push_back("along it hold" + meant + ": " + listed(whole));
    if (!part.empty())
      words.push_back("and, while it is in their regions, which are not all of T: " + listed(part));
    if (t.barriers.empty())
      words.push_back("no barrier function is part of this level: nothing is said of one that stays "
                      "non-negative");
    if (!safe.empty()) words.push_back("and h >= 0 along it, from the start, for: " + listed(safe));
    return words;
  }

  // Level 3, which rests on level 2. With zeta = z2^2 / 2 the flow on T is d zeta / d phase = F.
  // The return map P of the section at mid-step has the slope rho exp(integral of dF/dzeta), from
  // the phase after the reset to that of the guard: the step, less or more what is in the strips.
  vector<string> attraction() const {
    const WalkingSet& t = *file_.theorems.walking;
    const Orbit& o = *file_.theorems.orbit;
    if (t.told.empty() == o.walks)
      throw DoesNotFollow{"its parameters are not those of a gait with commands, or of one without"};
    if (o.walks) return any_two_walks(t, o);
    if (o.alone) return contraction_alone(t, o);
    if (t.floor > 0.0) throw DoesNotFollow{"an orbit is enclosed for footholds as meant only"};
    if (!(t.falling < o.guard_from && o.guard_from < o.guard_to && o.guard_to <= t.last))
      throw DoesNotFollow{"the thin tube's guard is not where the foot falls"};
    const double behind = (I(t.last) - I(1.0)).high(), before = (I(1.0) - I(t.before)).high();
    const I ends = I(t.start_strip) + I(larger(behind, before));
    const I edge = I(1.0) + I(larger(t.start_strip, larger(behind, before)));
    not_negative("orbit/expansion", t.whole());
    const I gain = I(-bound("orbit/gain", t.strip()));
    const I steepest = largest(o.expansion, edge);
    const I slope = gain * exp(over_step(o.expansion) + ends * steepest);

    const I multiplier = thin_tube(t, o, ends, edge);
    if (!(multiplier.low() > 0.0 && multiplier.high() < 1.0))
      throw DoesNotFollow{"the multiplier is known to be in " +
                          interval_words(multiplier.low(), multiplier.high()) + " only"};
    string why;
    if (o.nested) {
      why = nested(t, o, gain * exp(I(2.0) * ends * steepest), multiplier);
    } else if (slope.high() < 1.0) {
      why = "the return map of the section at mid-step contracts to " + at_most(slope.high()) +
            " or less on all of T";
    } else {
      throw DoesNotFollow{"the return map is not shown to contract: |P'| <= " +
                          at_most(slope.high())};
    }
    const I low = root(I(2.0) * sum(o.thin.lower, chebyshev(I(0.5), o.thin.lower.size())));
    const I high = root(I(2.0) * sum(o.thin.upper, chebyshev(I(0.5), o.thin.upper.size())));
    // The widths have one sign all along, for margins that are shares of them are bounded.
    if (!(low.high() < high.low())) throw DoesNotFollow{"a thin tube that is upside down"};
    return {why + ": there is one periodic orbit, and every trajectory of the undisturbed system "
                  "in T converges to it",
            "at mid-step the orbit has z2 in [" + at_least(low.low(), 9) + ", " +
                at_most(high.high(), 9) + "] kg m^2/s, and is known to " +
                at_most(-bound("orbit/width", t.lower())) + " kg m^2/s everywhere",
            "its multiplier is in [" + at_least(multiplier.low()) + ", " +
                at_most(multiplier.high()) + "]"};
  }

  // Level 4: the premises of docs/full_order.md, and inequalities (1) to (7) there. V falls at the
  // rate gamma = 3 w / 2 at least: with the matrices of one joint, -(A' P + P A + gamma P) has the
  // entries 2 w, 3 and 9 / (2 w), whose determinant is 0, for every w > 0.
  vector<string> full_order() const {
    const FullOrder& f = *file_.theorems.full;
    full_order_premises(f);
    const I w(f.bandwidth), gamma = I(1.5) * w, radius(f.radius), shrink(f.shrink),
        guard_radius(f.guard_radius), start(f.start_strip), zero(0.0);
    const I floor(f.floor);
    const auto falls_to = [&](I phase) {
      return floor + (radius - floor) * exp(-(shrink * square(phase)));
    };
    const I mismatch = size(f.mismatch) +
                       size(f.drift) * I(larger((I(1.0) - I(f.near)).high(),
                                                (I(f.far) - I(1.0)).high()));
    const I after = mismatch + size(f.gain) * guard_radius;  // r_bar
    need("0 < bandwidth", zero, w);
    need("0 < least pace", zero, I(f.slowest));
    need("0 < inertia", zero, I(f.inertia));
    need("0 < radius", zero, radius);
    if (f.floor != 0.0) {
      need("0 < least radius", zero, floor);
      need("least radius < radius", floor, radius);
    }
    if (!f.weights.empty()) {
      const size_t joints = joints_of(f);
      for (size_t i = 0, at = 0; i < joints; at += joints - i++)
        if (f.weights[at] == 0.0) throw DoesNotFollow{"weights without an inverse"};
    }
    need("0 < start_strip", zero, start);
    need("start_strip < 0.05", start, I(0.05));
    need("guard_strip < 0.05", I(f.guard_strip), I(0.05));
    need("0 < crossing", zero, I(f.crossing));
    need("1 - guard_strip < 1 - crossing", I(f.before), I(f.near));
    need("1 + crossing < 1 + guard_strip", I(f.far), I(f.last));
    need("0 < risen", zero, I(f.risen));
    need("risen < 1 - guard_strip", I(f.risen), I(f.before));
    need("0 < shrink", zero, shrink);
    need("4 shrink (1 + guard_strip) most pace < gamma",
         I(4.0) * shrink * I(f.last) * I(f.fastest), gamma);
    need("the radius at the guard < guard_radius", falls_to(I(f.before)), guard_radius);
    need("|phase+| < start_strip", I(f.landing) + size(f.landing_slope) * guard_radius, start);
    need("sqrt(V+) < the radius at the start", after, falls_to(start));
    string steps, names;
    for (const BarrierConstants& b : f.barriers) {
      need(b.name + ": 0 < alpha", zero, I(b.alpha));
      need(b.name + ": alpha < gamma", I(b.alpha), gamma);
      need(b.name + ": 0 < sigma", zero, I(b.sigma));
      const bool fence = names.empty() || &b == &f.barriers[1];
      const I four = I(4.0) * I(b.sigma);
      const I tightening = fence ? zero : square(I(b.reading)) / four;
      if (fence && b.reading != 0.0) throw DoesNotFollow{b.name + " reads outputs"};
      need(b.name + ": c^2/(4 sigma (gamma - alpha)) + alpha t < epsilon",
           square(I(b.coupling)) / (four * (gamma - I(b.alpha))) + I(b.alpha) * tightening,
           I(b.epsilon));
      need(b.name + ": sigma r_bar^2 < h+ - L_h R_g - t", I(b.sigma) * square(after),
           I(b.reset) - size(b.reset_slope) * guard_radius - tightening);
      steps += (names.empty() ? "" : "; ") + b.name;
      if (!fence) steps += " - " + brief(b.reading) + "^2/(4 * " + brief(b.sigma) + ")";
      steps += " >= " + brief(b.sigma) + " V";
      names += (names.empty() ? "" : ", ") + b.name;
    }
    const I time = (I(f.before) - start) / I(f.fastest);
    return {"D is every full state with z2 > 0, phase from " + brief(f.first) + " to " +
                brief(f.last) + ", swing foot on or above the ground, sqrt(V) <= " +
                (f.floor == 0.0 ? brief(f.radius)
                                : brief(f.floor) + " + (" + brief(f.radius) + " - " +
                                      brief(f.floor) + ")") +
                " exp(-" + brief(f.shrink) + " phase^2), and " + steps +
                "; V is the sum of (dy/w)^2 + 4 (y + dy/w)^2 over " +
                (f.weights.empty() ? "the outputs"
                                   : "the elements of S times the outputs, S the upper triangle " +
                                         numbers(f.weights) + " by rows") + ", w = " +
                brief(f.bandwidth) + " rad/s",
            "under exact input-output linearisation, ddy = -w^2 y - 2 w dy, in continuous time, "
            "every trajectory that starts in D stays in D between impacts, meets the ground once "
            "and transversally in each step, and is in D after the impact: it walks for ever, "
            "every step takes " + at_least(time.low()) + " s or more, and sqrt(V) after an impact is " +
                at_most(after.high()) + " rad or less",
            "all along, " + names + " are not negative on the robot itself, outputs included; the "
            "contact force stays in the friction cone, so does every impulse, and torques stay "
            "within the robot's limits"};
  }

  // Level 5, which rests on level 4: docs/level5.md. With b = sqrt(5) / w, V' <= -gamma V + 2 b
  // sqrt(V) |S e|, and while torques are held |S e| grows as the outputs' jerk says. Under scheduled PD
  // V falls at a rate of its own, and has the law's own error beside S e: docs/level5_law.md.
  vector<string> disturbed() const {
    const FullOrder& f = *file_.theorems.full;
    const Disturbed& d = *file_.theorems.disturbed;
    const I w(f.bandwidth), gamma = d.scheduled() ? I(d.decay) : I(1.5) * w, rest = rest_of(d);
    const I push(d.push[0]), zero(0.0);
    const I factor = root(I(5.0)) / w;
    positive("disturbed/contact", f.tube());
    positive("disturbed/torque", f.tube());
    if (d.scheduled()) {
      need("0 < decay", zero, gamma);
      positive("disturbed/decay", f.tube());
      not_negative("disturbed/rest", f.tube());
    }
    need(d.scheduled() ? "rest < push" : "0 < push", rest, push);
    const I slope(d.push[1]), left = gamma - I(2.0) * factor * slope;
    if (!(d.push[1] >= 0.0 && d.push[0] <= d.peak[0] && d.push[1] <= d.peak[1]))
      throw DoesNotFollow{"push has a falling slope, or is above peak"};
    I most = push + slope * I(f.radius), always = push + slope * I(f.floor) - rest;
    if (d.scheduled()) {
      need("4 shrink (1 + guard_strip) most pace < gamma - 2 b slope of push",
           I(4.0) * I(f.shrink) * I(f.last) * I(f.fastest), left);
      need("2 b push < (gamma - 2 b slope) least radius", I(2.0) * factor * push,
           left * I(f.floor));
    } else {
      need("0 < least radius", zero, I(f.floor));
      // Errors of any kind are borne by the least radius, by forces there, and by barriers.
      const I forces = I(d.peak[0]) + I(d.peak[1]) * I(f.floor);
      const I radius = I(0.4999995) * square(w) * I(f.floor);
      const double low = std::min({most.low(), forces.low(), radius.low()});
      always = I(low);
      if (d.hold != 0.0) fall_in_holds(f, d);
    }
    if (d.hold != 0.0) held(f, d, gamma);
    if (d.measured()) of_measured_states(f, d);
    if (d.free_clock()) {
      const I while_held = I(0.5) * gamma * I(d.hold) * kicked(f, d, gamma);
      most = I(larger(most.high(), while_held.high()));
    }
    string names;
    for (size_t i = 0; i < d.barriers.size(); ++i) {
      const DisturbedBarrier& its = d.barriers[i];
      const BarrierConstants& of = f.barriers[i];
      not_negative("disturbed/decrease " + its.name, f.tube());
      const I alpha(its.alpha), sigma(of.sigma);
      need(its.name + ": 0 < alpha, disturbed", zero, alpha);
      need(its.name + ": alpha < gamma, disturbed", alpha, gamma);
      need(its.name + ": 0 < sigma", zero, sigma);
      const I slower = I(4.0) * sigma * (gamma - alpha), spare = I(its.weight) * slower - I(1.0);
      need(its.name + ": 1 < 4 sigma (gamma - alpha) weight", zero, spare);
      const I tightening = square(I(of.reading)) / (I(4.0) * sigma);
      const I moved = I(2.0) * sigma * factor * most;
      need(its.name + ": alpha t and what the push takes < lost",
           alpha * tightening + (I(1.0) + I(1.0) / spare) * square(moved) / slower, I(its.lost));
      names += (names.empty() ? "" : ", ") + its.name;
    }
    const string size = f.weights.empty() ? "|e|" : "|S e|";
    const string own = d.scheduled() ? " beyond that law" : "";
    const string torques =
        d.scheduled()
            ? "that give the outputs e more of ddy than u = u0 - M (w^2 y + 2 w dy) does, the torque of "
              "scheduled PD, u0 and M being the file's polynomials of phase and level, of " +
                  std::to_string(d.torque_gains.size()) + " and " +
                  std::to_string(d.inertia_gains.size()) + " coefficients, "
            : "that give the outputs ddy = -w^2 y - 2 w dy + e, ";
    vector<string> words = {
        "the same set D, whatever measurable e(t) with " + size + " <= " + at_least(always.low()) +
                " rad/s^2 is added: under torques " + torques +
                "every trajectory that starts in D stays in D between impacts, meets the ground "
                "once and transversally in each step, and is in D after the impact: it walks for "
                "ever"};
    if (d.hold != 0.0)
      words.push_back(
          "the same set D, whatever ticks there are at most " + brief(d.hold) + " s apart, " +
          (d.free_clock() ? "wherever touchdowns lie between them (each motor keeps its torque "
                            "through a touchdown, until the first tick after it, which is of the "
                            "new step)"
                          : "one of them at each touchdown") + ": if torques are set at each tick with " + size + " <= " +
          brief(d.error) + " rad/s^2" + own + " and held until the next, every trajectory that "
          "starts in D at a tick stays in D, meets the ground once and transversally in each step, "
          "and is in D after the impact: it walks for ever");
    words.push_back("all along, " + names + " are not negative on the robot itself, the contact force and "
            "every impulse stay in the friction cone, and the torques that are applied stay within "
            "the robot's limits: none saturates");
    if (d.measured()) words.push_back(words_of_measured_states(d, size));
    words.push_back(string("which e a wrong model") + (d.measured() ? "" : " or a measurement") +
                    " makes is not part of this theorem");
    return words;
  }

 private:
  // Bound on |S e| of the law's own torque where nothing is off.
  static I rest_of(const Disturbed& d) { return d.scheduled() ? size(d.rest) : I(0.0); }

  // How much larger the bound on sqrt(V) is at phase 0 than where the tube begins.
  static I beside_start(const FullOrder& f) {
    const I floor(f.floor), radius(f.radius);
    return radius / (floor + (radius - floor) * exp(-I(f.shrink) * square(I(f.start_strip))));
  }

  // The slope of S de/dt in xi: where the premise is about the jerk, outputs add w^3 (xi_1 + xi_2).
  static I growth_slope(const FullOrder& f, const Disturbed& d) {
    const I w(f.bandwidth), own = d.scheduled() ? I(0.0) : root(I(2.0)) * w * square(w);
    return size(d.growth_slope) + own;
  }

  // Under exact linearisation sqrt(V) stays in its bound while torques are held: inequality 1.
  void fall_in_holds(const FullOrder& f, const Disturbed& d) const {
    if (!(d.hold > 0.0 && d.error >= 0.0)) throw DoesNotFollow{"a hold or an error below zero"};
    const I w(f.bandwidth), floor(f.floor), half = I(0.5) * I(d.hold), push = size(d.jerk_push);
    const I over = inverse(square(w));
    const I still = half * (size(d.jerk) + push * I(d.peak[0]));
    const I slope = half * (size(d.growth_slope) + push * I(d.peak[1])) * beside_start(f);
    const I shrink = I(2.0) * I(f.shrink) * I(f.last) * I(f.fastest) / w;
    const I last = w * I(d.hold), none(0.0);
    if (!outputs_fall(last, floor, {(still + slope * floor) * over, I(d.error) * over}, none))
      throw DoesNotFollow{"the least radius is not above what holds keep outputs at"};
    if (!outputs_fall(last, I(1.0), {slope * over, none}, shrink))
      throw DoesNotFollow{"outputs in holds do not fall faster than their bound shrinks"};
  }

  // What a hold makes of an error fits under peak and, in the mean over it, under push.
  void held(const FullOrder& f, const Disturbed& d, const I& gamma) const {
    not_negative("disturbed/jerk", f.tube());
    positive(d.scheduled() ? "disturbed/growth-slope" : "disturbed/jerk-slope", f.tube());
    not_negative("disturbed/jerk-push", f.tube());
    if (!(d.hold > 0.0 && d.error >= 0.0)) throw DoesNotFollow{"a hold or an error below zero"};
    const I hold(d.hold), error(d.error), floor(f.floor), radius(f.radius);
    const I rate = I(2.0) * I(f.bandwidth) + size(d.jerk_push), grown = exp(rate * hold);
    const I end = (grown - I(1.0)) / rate;
    const I mean = (end - hold) / (rate * hold) + I(0.0625) * gamma * square(hold) * grown;
    const I earlier = exp(I(0.5) * gamma * hold) * beside_start(f);
    for (const I& bound : {floor, radius}) {
      const I most = size(d.jerk) + rate * error + earlier * growth_slope(f, d) * bound;
      need("error + growth in a hold < peak", error + end * most,
           I(d.peak[0]) + I(d.peak[1]) * bound);
      need("error + mean growth in a hold < push", rest_of(d) + error + mean * most,
           I(d.push[0]) + I(d.push[1]) * bound);
    }
  }

  // Torques of a measured state: docs/level5_sensing.md.
  void of_measured_states(const FullOrder& f, const Disturbed& d) const {
    positive("disturbed/state-moves", f.tube());
    not_negative("disturbed/state-error", f.tube());
    not_negative("disturbed/state-growth", f.tube());
    const size_t angles = d.state_axes.size() / 2;
    if (d.scheduled() || f.weights.empty() ||
        f.weights.size() != angles * (angles - 1) / 2 || d.state_axes.size() % 2 != 0)
      throw DoesNotFollow{"a measured state has no axis for each angle and rate"};
    I share(0.0);
    for (size_t i = 0; i < d.state_axes.size(); ++i) {
      const double error = d.state_error[i / angles], axis = d.state_axes[i];
      if (!(error > 0.0 && axis > 0.0))
        throw DoesNotFollow{"errors of a measured state that are not positive"};
      share = share + square(I(error) / I(axis));
    }
    for (const double moved : d.state_moves)
      if (!(moved > 0.0)) throw DoesNotFollow{"a measured state that moves nothing"};
    for (const double slope : d.state_slopes)
      if (!(slope >= 0.0)) throw DoesNotFollow{"slopes in a measured state below zero"};
    const I steepest = (I(f.radius) - I(f.floor)) * root(I(2.0) * I(f.shrink) / exp(I(1.0)));
    need("errors of a measured state are in their ellipsoid", share, I(1.0));
    need("what a measured state moves xi by, beside its bound, < state radius",
         I(d.state_moves[2]) + steepest * I(d.state_moves[0]), I(d.state_radius));
    need("|S e| of torques of measured states < error", sensed_error(d), I(d.error));
    need("torques of measured states are held: 0 < hold", I(0.0), I(d.hold));
  }

  static I sensed_error(const Disturbed& d) {
    return I(d.state_slopes[0]) * exp(I(d.state_slopes[1]));
  }

  static string words_of_measured_states(const Disturbed& d, const string& size) {
    return "torques of exact linearisation that are computed from a measured state, with each joint "
           "angle and the pitch off by at most " + brief(d.state_error[0]) + " rad and each of their "
           "rates by at most " + brief(d.state_error[1]) + " rad/s, have " + size + " <= " +
           at_most(sensed_error(d).high()) + " rad/s^2 when they are set; which foot stands is known";
  }

  // Torques held through an impact, until the next tick: docs/level5_clock.md, inequality 4. Returns a
  // bound on the mean of |S e| until then; the bound itself is convex in time.
  I kicked(const FullOrder& f, const Disturbed& d, const I& gamma) const {
    not_negative("disturbed/kick", f.strip());
    not_negative("disturbed/kick-slope", f.strip());
    not_negative("disturbed/kick-push", f.strip());
    positive("disturbed/kick-contact", {{f.first, 0.0}, {d.kick_end, 1.0}});
    const I hold(d.hold), end(d.kick_end), radius(f.radius), floor(f.floor), guard(f.guard_radius);
    const I rate = I(2.0) * I(f.bandwidth) + size(d.jerk_push), grown = exp(rate * hold);
    const I first = size(d.kick) + size(d.kick_slope) * guard +
                    size(d.kick_push) * (I(d.peak[0]) + I(d.peak[1]) * guard);
    const I more = (size(d.jerk) + growth_slope(f, d) * radius) * (grown - I(1.0)) / rate;
    const I mean = I(0.5) * (first + I(d.kick_peak)) + rest_of(d);
    need("free clock: 0 < hold", I(0.0), hold);
    need("free clock: start_strip + most pace hold < kick_end",
         I(f.start_strip) + I(f.fastest) * hold, end);
    need("free clock: kick_end < 1 - guard_strip", end, I(f.before));
    need("free clock: errors from an impact to the next tick < kick_peak", first * grown + more,
         I(d.kick_peak));
    const I mismatch = size(f.mismatch) +
                       size(f.drift) * I(larger((I(1.0) - I(f.near)).high(),
                                                (I(f.far) - I(1.0)).high()));
    const I after = mismatch + size(f.gain) * guard;
    const I added = root(I(5.0)) / I(f.bandwidth) * hold * mean;
    // The bound on sqrt(V) is convex in the time since the impact: its ends suffice.
    const I decayed = exp(-(I(0.5) * gamma * hold)) * after + added;
    for (const I& at_tick : {after, decayed})
      for (const I& phase : {I(f.start_strip), end})
        need("free clock: sqrt(V+) exp(-gamma hold / 2) + b hold mean kick < bound on sqrt(V) at "
             "the next tick",
             at_tick, floor + (radius - floor) * exp(-(I(f.shrink) * square(phase))));
    for (size_t i = 0; i < f.barriers.size(); ++i) {
      const BarrierConstants& b = f.barriers[i];
      const I tightening = i < 2 ? I(0.0) : square(I(b.reading)) / (I(4.0) * I(b.sigma));
      need(b.name + ": free clock: sigma (sqrt(V+) + b hold mean kick)^2 < h(z+) - t",
           I(b.sigma) * square(after + added),
           I(b.reset) - size(b.reset_slope) * guard - tightening);
    }
    return mean;
  }

  const ProofFile& file_;
  mutable std::map<string, bool> covered_;  // Whether the boxes of a region are all of the chart.

  // Of a triangle of weights.
  static size_t joints_of(const FullOrder& f) {
    size_t joints = 0;
    while (joints * (joints + 1) / 2 < f.weights.size()) ++joints;
    if (joints * (joints + 1) / 2 != f.weights.size()) throw DoesNotFollow{"weights of no triangle"};
    return joints;
  }

  static string numbers(const vector<double>& all) {
    string words;
    for (const double one : all) words += (words.empty() ? "" : ", ") + brief(one);
    return words;
  }

  // A constant of which the premises speak by its square: its sign is free there.
  static I size(double bound) { return I(std::abs(bound)); }

  static void need(const string& claim, I left, I right) {
    if (!(left.high() < right.low()))
      throw DoesNotFollow{claim + ": " + at_least(left.low()) + " against " +
                          at_most(right.high())};
  }

  void full_order_premises(const FullOrder& f) const {
    const Box tube = f.tube(), strip = f.strip(), around = f.around();
    for (const char* name : {"full/pace", "full/inertia", "full/contact", "full/torque"})
      positive(name, tube);
    positive("full/foot-rises", {{f.first, 0.0}, {f.risen, 1.0}});
    positive("full/foot-above", {{f.risen, 0.0}, {f.before, 1.0}});
    positive("full/foot-below", {{f.last, 0.0}, {f.last, 1.0}});
    positive("full/crossing-before", {{f.near, 0.0}, {f.near, 1.0}});
    positive("full/crossing-behind", {{f.far, 0.0}, {f.far, 1.0}});
    for (const char* name :
         {"full/guard-slope", "full/foot-falls", "full/impulse", "full/momentum-after"})
      positive(name, strip);
    not_negative("full/gain", strip);
    not_negative("full/landing-slope", strip);
    not_negative("full/mismatch", {{1.0, 0.0}, {1.0, 1.0}});
    not_negative("full/drift", around);
    not_negative("full/landing", around);
    for (size_t i = 0; i < f.barriers.size(); ++i) {
      const string& name = f.barriers[i].name;
      not_negative("full/rate " + name, tube);
      not_negative("full/coupling " + name, tube);
      not_negative("full/reset " + name, around);
      not_negative("full/reset-slope " + name, strip);
      if (i > 1) not_negative("full/reading " + name, tube);
    }
  }

  // The bound that a statement has for an output on a box, rounded down.
  double bound(const string& output, const Box& box) const {
    if (const Claim* claim = stated_about(file_, output, box)) return claim->least().low();
    throw DoesNotFollow{"no statement about " + output + words_for(box, file_.chart)};
  }
  double positive(const string& output, const Box& box) const {
    const double least = bound(output, box);
    if (!(least > 0.0)) throw DoesNotFollow{output + words_for(box, file_.chart) + " is not above 0"};
    return least;
  }
  void not_negative(const string& output, const Box& box) const {
    if (!(bound(output, box) >= 0.0))
      throw DoesNotFollow{output + words_for(box, file_.chart) + " may be negative"};
  }
  // Of a condition's region.
  const vector<Box>& boxes(const string& name) const {
    const auto found = file_.regions.find(file_.conditions.at(name).region);
    if (found == file_.regions.end()) throw DoesNotFollow{"no statement about " + name};
    return found->second;
  }
  bool covered(const string& name) const {
    const string& region = file_.conditions.at(name).region;
    const auto known = covered_.find(region);
    if (known != covered_.end()) return known->second;
    return covered_[region] = covers(boxes(name));
  }
  bool stated(const string& output, const Box& box) const {
    try {
      not_negative(output, box);
      return true;
    } catch (const DoesNotFollow&) {
      return false;
    }
  }

  // How far the foot is from the line between footholds, where the next one may be off that line.
  void off_the_line(const string& output, const Box& box) const {
    if (!(positive(output, box) > file_.theorems.walking->floor))
      throw DoesNotFollow{output + words_for(box, file_.chart) + " is not above " +
                          brief(file_.theorems.walking->floor) + " m"};
  }

  // A reset lands in T of the next step, whatever that is told. The start of a step and its fences
  // at phase 0 depend on the command before alone, which is known; so the reset's place is told in
  // metres from there, and its zeta against those fences. Phases are at most 1 / stride of the
  // metres, and within start_strip of phase 0 fences are off by start_strip * steepness at most.
  void inlet(const WalkingSet& t) const {
    const double share = positive("set/inlet", t.strip());
    const I place(-bound("set/reset-place", t.strip()));
    const I stride(positive("set/stride", t.origin()));
    not_negative("set/within-bounds", t.origin());
    const I steepness(-bound("set/steepness", t.edge()));
    if (!(place.high() < (I(t.start_strip) * stride).low()))
      throw DoesNotFollow{"a reset may land outside the strip around the start of a step"};
    if (!(share > (steepness * I(t.start_strip)).high()))
      throw DoesNotFollow{"a reset may land outside the fences of a step told another command"};
  }

  // One orbit of which nothing is said but that it attracts: the section at mid-step is an interval
  // that the return map carries into itself.
  vector<string> contraction_alone(const WalkingSet& t, const Orbit& o) const {
    const double behind = (I(t.last) - I(1.0)).high(), before = (I(1.0) - I(t.before)).high();
    const I ends = I(t.start_strip) + I(larger(behind, before));
    const I edge = I(1.0) + I(larger(t.start_strip, larger(behind, before)));
    not_negative("orbit/expansion", t.whole());
    const I gain = I(-bound("orbit/gain", t.strip()));
    const I slope = gain * exp(over_step(o.expansion) + ends * largest(o.expansion, edge));
    if (!(slope.high() < 1.0))
      throw DoesNotFollow{"the return map is not shown to contract: |P'| <= " +
                          at_most(slope.high())};
    const string shrinks = "the return map of the section at mid-step contracts to " +
                           at_most(slope.high()) + " or less on all of T: ";
    if (t.floor > 0.0)
      return {shrinks + "any two trajectories of the undisturbed system in T whose footholds lie "
                        "equally high, step by step, converge; where all lie as meant, to one "
                        "periodic orbit"};
    return {shrinks + "there is one periodic orbit, and every trajectory of the undisturbed system "
                      "in T converges to it"};
  }

  // Two walks under the same commands. Along a step the zeta of neighbours part as dF/dzeta says;
  // a reset makes of 1 a distance of `gain` in zeta, `moved` metres ahead, where the flow of
  // whatever step comes next changes zeta by `along` a metre at most.
  vector<string> any_two_walks(const WalkingSet& t, const Orbit& o) const {
    not_negative("orbit/expansion", t.whole());
    const I gain(-bound("orbit/gain", t.strip())), moved(-bound("orbit/moved", t.strip())),
        along(-bound("orbit/along", t.start()));
    const double behind = (I(t.last) - I(1.0)).high(), before = (I(1.0) - I(t.before)).high();
    const I ends = I(t.start_strip) + I(larger(behind, before));
    const I edge = I(1.0) + I(larger(t.start_strip, larger(behind, before)));
    const I left = (gain + moved * along) *
                   exp(over_step(o.expansion) + ends * largest(o.expansion, edge));
    if (!(left.high() < 1.0))
      throw DoesNotFollow{"walks are not shown to converge: a step makes " + at_most(left.high()) +
                          " of 1"};
    return {"any two trajectories of the undisturbed system in T under the same admissible commands "
            "converge: from step to step their distance in zeta = z2^2 / 2 at a phase shrinks to " +
                at_most(left.high()) + " of it or less, whatever the commands are",
            admissible(t)};
  }

  // A robot is never exactly where it believes to be; and without a belief there is nothing to be near.
  void match_beliefs(const WalkingSet& t) const {
    const auto behind = file_.chart.begin() + std::min(2 + 2 * t.told.size(), file_.chart.size());
    const auto near = std::count_if(behind, file_.chart.end(),
                                    [](const Axis& axis) { return axis.ends_in(kNearBelief); });
    const bool told = std::count(t.told.begin(), t.told.end(), kLean) > 0;
    if (told ? near != 1 || file_.chart.end() - behind != 1 : near > 0)
      throw DoesNotFollow{"the distance from a belief is an axis where one is told, alone, and only "
                          "there"};
  }

  // Which commands may follow each other: all pairs on a command's two axes, which are the commands
  // before and after.
  string admissible(const WalkingSet& t) const {
    const Chart& chart = file_.chart;
    const DoesNotFollow none{"the chart has no axes of the commands " + listed(t.told)};
    if (chart.size() < 2 + 2 * t.told.size()) throw none;
    // Behind them are none but errors, which are constant, and of no command that is not told.
    for (size_t k = 2 + 2 * t.told.size(); k < chart.size(); ++k)
      if (chart[k].low != -chart[k].high || chart[k].near() || chart[k].ends_in(" before") ||
          chart[k].ends_in(" after"))
        throw none;
    string words;
    for (size_t k = 0; k < t.told.size(); ++k) {
      const Axis &first = chart[2 + 2 * k], &second = chart[3 + 2 * k];
      const string& name = t.told[k];
      words += (k ? " and " : "") + name + " in " + interval_words(first.low, first.high);
      if (first.name != name + " before" || second.name != name + " after" || first.near() ||
          first.low != second.low || first.high != second.high)
        throw none;
      words += second.near() ? ", by at most " + brief(second.change) +
                                   " more or less than in the step before"
                             : ", any after any";
    }
    return "admissible are commands of " + words;
  }

  // Barriers whose h stays >= 0 along every trajectory: T lies in h >= 0; or h >= 0 at the start and
  // dh/dt >= -alpha(h) on all of T, which carried() proves. `start` is told what is asked then.
  vector<string> barriers(const WalkingSet& t, string& start) const {
    vector<string> safe;
    string asked;
    for (const string& name : t.barriers) {
      const auto condition = file_.conditions.find(name);
      if (condition == file_.conditions.end() ||
          (condition->second.unknown.empty() && condition->second.kind != "Barrier"))
        throw DoesNotFollow{name + " is no barrier condition of the spec"};
      // What comes next may be told anything: h is asked wherever a reset lands.
      if (t.told.empty()) not_negative("set/after " + name, t.strip());
      else not_negative("set/value " + name, t.start());
      if (t.disturbed()) not_negative("set/rate " + name, t.whole());
      const bool inside = stated("set/value " + name, t.whole());
      const bool everywhere = std::count(t.carried.begin(), t.carried.end(), name) > 0 &&
                              covered(name);
      if (inside || everywhere || t.disturbed()) safe.push_back(name);
      if (!inside) asked += (asked.empty() ? "" : ", ") + name;
    }
    if (!asked.empty()) start += " and h >= 0 for: " + asked;
    return safe;
  }

  // The conditions that hold along a trajectory have statements on the strips as well.
  void carried(const WalkingSet& t) const {
    for (const string& name : t.carried) {
      const auto condition = file_.conditions.find(name);
      if (condition == file_.conditions.end())
        throw DoesNotFollow{name + " is no condition of the spec"};
      for (const Box& box : boxes(name)) {
        not_negative(name, box);
        Box around = box;
        if (box.low[0] == 1.0) {  // The guard.
          around.low[0] = t.before;
          around.high[0] = t.last;
          not_negative(name, around);
          continue;
        }
        if (box.low[0] == 0.0) {
          around.low[0] = t.first;
          around.high[0] = box.high[0] == 0.0 ? t.start_strip : 0.0;
          not_negative(name, around);
        }
        if (box.high[0] == 1.0) {
          around.low[0] = 1.0;
          around.high[0] = t.last;
          not_negative(name, around);
        }
      }
    }
  }

  // The thin tube is invariant like T: the return map takes its section into itself, so that a
  // periodic orbit runs in it. Returns what encloses the slope of P there.
  I thin_tube(const WalkingSet& t, const Orbit& o, I ends, I edge) const {
    const Box guard = {{o.guard_from, 0.0}, {o.guard_to, 1.0}};
    positive("orbit/fence-lower", t.lower());
    positive("orbit/fence-upper", t.upper());
    positive("orbit/inside", t.lower());
    positive("orbit/inside", t.upper());
    positive("orbit/foot-above", {{o.guard_from, 0.0}, {o.guard_from, 1.0}});
    positive("orbit/foot-below", {{o.guard_to, 0.0}, {o.guard_to, 1.0}});
    positive("orbit/reset-level", guard);
    not_negative("orbit/slowest", t.whole());
    not_negative("orbit/fastest", t.whole());
    const I least = I(positive("orbit/reset-gain-low", guard));
    const I most = I(-bound("orbit/reset-gain-high", guard));
    const I low = least * exp(over_step(o.slowest) - ends * largest(o.slowest, edge));
    const I high = most * exp(over_step(o.fastest) + ends * largest(o.fastest, edge));
    return {low.n, high.h};
  }

  // Nested tubes. r is the distance from the thin tube's middle in its half widths. Outside it |r|
  // falls along the flow from phase start_strip to `before`. Across ground and reset, a trajectory
  // and the thin tube's fence next to it part by at most `growth`, and the fence's lands in the
  // thin tube: |r| - 1 grows by at most growth times the ratio of the half widths.
  string nested(const WalkingSet& t, const Orbit& o, I growth, I multiplier) const {
    const Box step = {{t.start_strip, 0.0}, {t.before, 1.0}};
    positive("orbit/nested-above", step);
    positive("orbit/nested-below", step);
    const auto width = [&o](double phase) {
      const Fences<I> f = fences(o.thin, I(phase));
      return f.upper - f.lower;
    };
    const I factor = growth * (width(t.before) / width(t.start_strip));
    if (!(factor.high() < 1.0))
      throw DoesNotFollow{"tubes around the orbit may widen by " + at_most(factor.high()) +
                          " at the impact"};
    return "outside a thin tube around the orbit every trajectory gets nearer to it along the "
           "step, and across the impact to " + at_most(factor.high()) +
           " of its distance or less; inside it the return map contracts to " +
           at_most(multiplier.high()) + " or less";
  }
};

}  // namespace
