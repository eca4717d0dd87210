// proofcheck: an independent check of a gait certificate.
//
// A proof file says: at every state of a region, this condition of the gait holds with this margin;
// and, at levels 2 to 5, what that means for trajectories: they walk for ever, converge to one
// periodic orbit, and do so with outputs that are off zero. It contains link data of a robot, the
// numbers of a policy, of a tube in the plane of the zero dynamics and of the orbit, and for each
// statement a tree of boxes. This program derives everything else from those numbers: positions,
// momenta, the zero dynamics, accelerations, torques, ground forces, the impact, the return map. It
// does not evaluate the list of operations ("Program") that the file also contains and that the
// finder worked with, unless it is told to, and shares no formula file, derivative rule or library
// with it.
//
// The story, in sections; each file includes the one before it:
//    1  intervals            numbers.hpp      numbers enclosed by directed rounding
//    2  elementary functions                  exp, log, tanh, sin ... at a point, with remainders
//    3  Taylor models        taylor.hpp       functions of a box: quadratic polynomials with
//                                             interval coefficients
//    4  duals                                 a value and its derivative along a direction
//    5  formulas             recorded_formulas.hpp     the same operations, written down to be carried out later
//    6  reading              reading.hpp      JSON, hexadecimal floats, base64, sha256
//    7  the model            robot.hpp        robot from link data, policy, tube, residuals
//    8  steps                steps.hpp        one step of a gait: its ends, its tube
//    9  the policy           policy.hpp       desired outputs and derivatives up to second order
//   10  mechanics            mechanics.hpp    from a state to forces and impact, link by link
//   11  told commands        commanded.hpp    the step between two commands: footholds, impacts, path
//   12  conditions           conditions.hpp   what is claimed of single states, also in words
//   13  set and orbit        premises.hpp     what levels 2 and 3 rest on
//       held torques         jerk.hpp         accelerations, torques, and the jerk of torques that stay
//   14  full order           full_order.hpp   what level 4 rests on
//       scheduled PD         scheduled.hpp    a law by polynomials of the file: its errors, their growth
//       torques that are off disturbed.hpp    what level 5 rests on
//       all outputs          outputs.hpp      and their words
//   15  the check            check.hpp        trees of boxes, on several threads
//   16  lanes                lanes.hpp        Taylor models of several boxes at once, in doubles
//   17  listings             program.hpp      formulas, or the file's own Program on request, bounded so
//   18  other families       families.hpp     systems that do not walk: what their files share
//   19  cart-poles           cartpole.hpp     equations, conditions and levels of a pole on a cart
//   20  hoppers              hopper.hpp       the same of one leg that hops
//   21  what follows         conclusions.hpp  from statements about boxes to trajectories
//   22  the file             file.hpp         consistency of what it says
//   23  the command          this file
//
// proofcheck FILE prints the robot and every statement in words, with all numbers that they depend
// on, and answers with its exit code: 0 proved of what is printed, 1 rejected (false, with a point;
// or the file contradicts itself, or claims what does not follow), 2 not a proof file, 3 undecided (a
// user's own condition, policy or residual, a chart with axes beside phase, level and commands, boxes
// that do not reach their bounds, a condition that is not claimed on all of its region, or a chart that
// is a part of the gait's commands), 70 the
// rounding does not work. Boxes are bounded with models of second degree whatever degree the finder
// used.
//
// proofcheck --program FILE bounds the Program in the file instead, whatever it computes. Then 0
// means only that every statement follows from it ("consistent"): nothing is derived from the robot's
// numbers, and nothing says that the Program is about them.
//
// Boxes are shared out among the machine's threads, at most eight; proofcheck --one-thread bounds all
// of them in one. Answers do not depend on it. How far a long statement is goes to standard error.
//
// It is compiled in one line:
// g++ -std=c++17 -O1 -frounding-math -ffp-contract=off -pthread proofcheck.cpp
//
// Add -march=native for a processor with wider registers: more boxes are bounded at once. Nothing
// else changes; multiplications and additions are not fused, whatever the processor has.
//
// Trusted: the C++ compiler, IEEE 754 + - * / sqrt in the rounding mode that is set and tested at
// the start and in each thread, and the standard library's strings, containers and threads. Signs and
// symbols are those of docs/notation.md: x forward, z up, angles counter-clockwise, z2 forward
// positive.

#include "file.hpp"

namespace {

// ---------------------------------------------------------------------------- 23 the command

string read_file(const string& path) {
  string text;
  FILE* file = std::fopen(path.c_str(), "rb");
  if (!file) refuse("nothing to read");
  char block[65536];
  size_t count = 0;
  while ((count = std::fread(block, 1, sizeof block, file)) > 0) text.append(block, count);
  const bool failed = std::ferror(file) != 0;  // A folder, for one.
  std::fclose(file);
  if (failed) refuse("nothing to read");
  return text;
}

// Boxes of conditions without a statement.
vector<string> unclaimed(const ProofFile& file) {
  vector<string> found;
  for (const auto& [name, condition] : file.conditions) {
    if (!file.regions.count(condition.region)) found.push_back(name);
    else for (const Box& box : file.regions.at(condition.region)) {
      if (!stated_about(file, name, box)) found.push_back(name + words_for(box, file.chart));
    }
  }
  return found;
}

// What the claimed levels say, in words, if it follows from the statements.
std::map<int, vector<string>> concluded(const ProofFile& file) {
  if (file.system)
    return file.system->conclude([&file](const string& name) {
      const Box& box = file.regions.at(file.conditions.at(name).region)[0];
      const Claim* claim = stated_about(file, name, box);
      return claim ? claim->least().low() : -1.0;
    });
  std::map<int, vector<string>> found;
  const auto& [walking, orbit, full, disturbed] = file.theorems;
  int level = 2;
  try {
    const bool third = orbit && orbit->claimed;
    if ((walking && walking->claimed) || third) found[2] = Conclusions(file).walking();
    level = 3;
    if (third) found[3] = Conclusions(file).attraction();
    level = 4;
    const bool fifth = disturbed && disturbed->claimed;
    if (full && (full->claimed || fifth)) found[4] = Conclusions(file).full_order();
    level = 5;
    if (fifth) found[5] = Conclusions(file).disturbed();
  } catch (const DoesNotFollow& missing) {
    throw Inconsistent{"level " + std::to_string(level) + " does not follow: " + missing.why};
  } catch (const NoBound&) {
    throw Inconsistent{"level " + std::to_string(level) + " does not follow: numbers too large"};
  }
  return found;
}

// "12 boxes, 0.34 s"
string effort(long boxes, std::chrono::steady_clock::time_point start) {
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  char text[40];
  snprintf(text, sizeof text, "%ld boxes, %.2f s", boxes, taken.count());
  return text;
}

// The verdict on what holds.
const char* good(const ProofFile& file) { return file.program ? "consistent" : "proved"; }

Bounding bounding_of(const ProofFile& file) {
  if (file.program) return by_the_program(*file.program);
  if (!file.recorded) return by_the_model(file.model, file.theorems);
  const Bounding listing = by_the_listing(file.recorded);
  const bool all = std::all_of(file.outputs.begin(), file.outputs.end(), [](const auto& one) {
    return one.second.recorded || !one.second.unknown.empty();
  });
  return all ? listing : by_either(file.model, file.theorems, listing);
}

// How far a statement is, on standard error: a line whenever so many seconds have gone by.
constexpr double kSilence = 10.0;
Checker::Told progress(const ProofFile& file, size_t number) {
  const auto start = std::chrono::steady_clock::now();
  return [&file, number, start, told = 0.0](double share) mutable {
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    if (taken.count() < told + kSilence) return;
    told = taken.count();
    char text[60];
    snprintf(text, sizeof text, ": %.0f %% of its boxes after %.0f s", 100.0 * share, told);
    say("statement " + std::to_string(number + 1) + " of " + std::to_string(file.statements.size()) +
            ", " + file.statements[number].claims[0].name + text,
        stderr);
  };
}

// Checks one statement and prints it.
Finding check(const ProofFile& file, const Bounding& bounding, size_t number, size_t threads) {
  const auto start = std::chrono::steady_clock::now();
  const Statement& s = file.statements[number];
  const Finding found =
      Checker(bounding, file.chart, s, threads, progress(file, number)).run();
  const char* const words[] = {good(file), "undecided", "rejected"};
  say(s.region + "," + words_for(s.root_box, file.chart) + "; " + effort(found.boxes, start) + ": " +
      words[found.verdict]);
  for (const Claim& claim : s.claims) {
    const Output& output = *claim.output;
    say("  " + claim.name + ": " +
        (output.unknown.empty() ? output.words(claim.least().low())
                                : "not known here: " + output.unknown));
  }
  fflush(stdout);
  return found;
}

// What the file names where nothing is derived from it.
void say_names(const ProofFile& file) {
  say("robot " + file.robot + ", spec " + file.spec + ": names in the file, of which nothing is "
      "derived here");
  string axes;
  for (const Axis& axis : file.chart)
    axes += (axes.empty() ? "" : ", ") + axis_words(axis, axis.low, axis.high);
  say("chart: " + axes);
  if (file.program)
    say("Program of " + std::to_string(file.program->operations.size()) + " operations and " +
        std::to_string(file.program->outputs.size()) + " outputs");
}

// z2 on both fences of a step at three phases.
void say_fences(const string& where, const Step<I>& step) {
  for (const double phase : {0.0, 0.5, 1.0}) {
    const Fences<I> f = fences(step, I(phase));
    say("  " + where + "at phase " + brief(phase) + ": z2 between " +
        at_least(root(I(2.0) * f.lower).low()) + " and " + at_most(root(I(2.0) * f.upper).high()) +
        " kg m^2/s");
  }
}

// What a gait is told, and its tubes at commands that stay, at both ends of each range.
void say_family(const Family& family, const Chart& chart, bool part) {
  for (const Command& c : family.commands)
    say("  told at each touchdown: " + c.name + ", " + brief(c.low) + " to " + brief(c.high) +
        (c.change < HUGE_VAL ? ", by at most " + brief(c.change) + " more or less than before"
                             : ", any after any"));
  string words;
  for (size_t k = 2; k < chart.size(); ++k)
    words += (k > 2 ? " and " : "") + axis_words(chart[k], chart[k].low, chart[k].high);
  say("  what is stated is about " + words + (part ? ", which is a part of that" : ", all of that"));
  say("  where a step ends, and with it z1 at phase 0 and 1, follows from the commands: see the text "
      "of this program, section 11");
  if (chart.back().ends_in(kNearBelief))
    say("  the torso's centre of mass is ahead of the one above by the lean after plus its error (m), and "
        "the policy that of a robot without the error");
  say("tubes, at commands that stay:");
  const size_t count = family.commands.size();
  for (size_t corner = 0; corner < size_t{1} << count; ++corner) {
    vector<I> commands;
    string where;
    for (size_t i = 0; i < count; ++i) {
      const Command& c = family.commands[i];
      const double at = corner >> i & 1 ? c.high : c.low;
      commands.push_back(I(at));
      where += c.name + " " + brief(at) + ", ";
    }
    Step<I> step;
    step.before = step.after = places(family, commands);
    step.lower = family.lower;
    step.upper = family.upper;
    step.unit = family.unit;
    say_fences(where, step);
  }
}

// Every number of robot, policy and tube that the statements depend on; weights by their hash.
void say_model(const ProofFile& file) {
  const Robot& robot = file.model.robot;
  const Policy& policy = file.model.policy;
  say("robot " + file.robot + ": " + std::to_string(robot.links) + " links, " +
      at_least(robot.weight_mass.low()) + " kg");
  for (const string& line : robot.words) say("  " + line);
  string layers = std::to_string(
      2 + (file.model.family ? file.model.family->command_weights[0].size() : size_t{0}));
  for (const Layer& layer : policy.layers) layers += "-" + std::to_string(layer.rows);
  say("policy " + layers + (policy.softplus ? ", softplus" : ", tanh") +
      (policy.hybrid_invariant ? ", between postures before and after the impact" : "") +
      (policy.z2_dependence ? "" : ", of z1 alone") + "; the file says that its weights have the sha256 " + file.weights_sha256 +
      ", which is not checked here");
  for (size_t j = 0; j < policy.lower.size(); ++j)
    say("  joint " + std::to_string(j) + ": outputs between " + brief(policy.lower[j]) + " and " +
        brief(policy.upper[j]) + " rad");
  if (file.model.family) {
    say_family(*file.model.family, file.chart, !file.part.empty());
  } else {
    const Tube& tube = file.model.tube;
    say("  z1 from " + brief(policy.start) + " m after the impact to " + brief(policy.guard) +
        " m at the guard");
    say("tube, z1 from " + brief(tube.start) + " m at phase 0 to " + brief(tube.guard) +
        " m at phase 1");
    say_fences("", file.model.step);
  }
  const auto sizes = [](const vector<double>& bounds) {
    string words;
    for (const double bound : bounds) words += (words.empty() ? "" : ", ") + brief(bound);
    return words;
  };
  if (const auto& flow = file.model.flow)
    say("learned of the flow, added to dz: a network of sizes up to " + sizes(flow->bound) +
        " (m/s, N m), on top of the links' own");
  if (const auto& reset = file.model.reset)
    say("learned of the reset, added to z2 and the joints' rates per z2: sizes up to " +
        sizes(reset->bound) + " (1, rad/(kg m^2))");
  say("spec " + file.spec + ": " + std::to_string(file.conditions.size()) + " conditions");
}

// Every number of a system that does not walk that the statements depend on.
void say_system(const ProofFile& file) {
  say("robot " + file.robot + ": " + file.family->words);
  for (const string& line : file.system->words) say("  " + line);
}

int check(ProofFile& file, size_t threads) {
  if (file.underivable.empty() && file.system) say_system(file);
  else if (file.underivable.empty()) say_model(file);
  else say_names(file);
  // What is quickly seen to be wrong comes first.
  for (const Statement& s : file.statements) read_tree(s);
  const auto levels = concluded(file);
  record_full_order(file);
  const Bounding bounding = bounding_of(file);
  const auto start = std::chrono::steady_clock::now();
  Finding worst;
  long boxes = 0;
  size_t claims = 0;
  for (size_t number = 0; number < file.statements.size(); ++number) {
    const Finding found = check(file, bounding, number, threads);
    boxes += found.boxes;
    claims += file.statements[number].claims.size();
    if (found.verdict > worst.verdict) worst = found;
    if (worst.verdict == rejected) break;
  }
  const vector<string> missing = unclaimed(file);
  for (const string& box : missing) say("no statement about " + box);
  string answer = file.program ? "consistent: every statement follows from the Program in the file; "
                                 "nothing was derived from the robot's numbers: "
                               : "proved of the robot, policy and spec above: ";
  answer += std::to_string(claims) + " claims of " + std::to_string(file.conditions.size()) +
            " conditions";
  if (worst.verdict == proved)
    for (const auto& [level, words] : levels) {
      say("level " + std::to_string(level) + " " + good(file) +
          (file.part.empty() ? "" : ", for a part of the gait's commands"));
      for (const string& line : words) say("  " + line);
      // Axes of commands come first, and the theorems speak of them.
      const size_t first = 2 + (file.theorems.walking ? 2 * file.theorems.walking->told.size() : 0);
      if (!file.system && file.chart.size() > first) {
        string given;
        for (size_t k = first; k < file.chart.size(); ++k) {
          const Axis& axis = file.chart[k];
          given += (k > first ? " and " : "") + axis_words(axis, axis.low, axis.high);
        }
        const Axis& last = file.chart.back();
        // The distance of the robot from what it believes changes with each belief.
        if (last.ends_in(kNearBelief))
          say("  this holds for every robot whose lean stays within " + brief(last.high) +
              " m of what it believes at each touchdown, whatever sequence of beliefs it is told; of "
              "a robot further from its belief it says nothing");
        else
          say("  this holds for each fixed " + given + "; of one that changes it says nothing");
      }
      answer += ", level " + std::to_string(level);
    }
  if (worst.verdict == proved && !missing.empty())
    worst = {undecided, "every statement holds, but conditions have none on " +
                            std::to_string(missing.size()) + " boxes of their regions", 0};
  if (worst.verdict == proved && !file.part.empty())
    worst = {undecided, file.part, 0};
  if (worst.verdict != proved)
    answer = (worst.verdict == rejected ? "rejected: " : "undecided: ") + worst.reason;
  say(answer + "; " + effort(boxes, start));
  return worst.verdict == proved ? 0 : worst.verdict == rejected ? 1 : 3;
}

// One double of the tests' questions, written in hexadecimal.
double asked(std::istream& in) {
  Json word;
  word.type = Json::text;
  in >> word.string_value;
  return hexadecimal(word, "a number");
}

// For tests: enclosures of all outputs over boxes of the chart, lower corner then upper.
int answer_bounds(ProofFile& file, std::istream& in) {
  record_full_order(file);
  const Bounding bounding = bounding_of(file);
  const std::unique_ptr<Bounder> bounder = bounding();
  vector<Claim> claims;
  for (const auto& [name, output] : file.outputs)
    if (output.unknown.empty()) claims.push_back({name, 1.0, 0.0, &output});
  vector<const Claim*> all;
  for (const Claim& claim : claims) all.push_back(&claim);
  while (in >> std::ws, in.good()) {
    Box box = {vector<double>(file.chart.size()), vector<double>(file.chart.size())};
    for (double& x : box.low) x = asked(in);
    for (double& x : box.high) x = asked(in);
    bounder->within(box);  // Symbols for remainders are chosen on the first.
    bounder->over({&box}, all);
    for (const Claim* claim : all) {
      const char* name = claim->name.c_str();
      try {
        size_t element = 0;
        for (const Estimate& margin : bounder->margins(0, *claim))
          printf("%s\t%zu\t%a\t%a\n", name, element++, margin.range.low(), margin.range.high());
      } catch (const NoBound&) {  // The box is too wide.
        printf("%s\tno bound\n", name);
      }
    }
    printf("\n");
  }
  return 0;
}

// For tests: enclosures of elementary functions at doubles, "name number" a line.
int answer_functions(std::istream& in) {
  string name;
  while (in >> name) {
    const double x = asked(in);
    I r;
    if (name == "exp") r = exp_at(x);
    else if (name == "tanh") r = tanh_at(x);
    else if (name == "logistic") r = logistic_at(x);
    else if (name == "softplus") r = softplus_at(x);
    else if (name == "log1p") r = log1p_of(I(x));
    else if (name == "logit") r = logit_at(x);
    else if (name == "arctan") r = arctan_at(x);
    else if (name == "sin") r = sincos_at(x).sine;
    else if (name == "cos") r = sincos_at(x).cosine;
    else if (name == "sqrt") r = root(I(x));
    else if (name == "inverse") r = inverse(I(x));
    else refuse("the function " + name);
    printf("%a %a\n", r.low(), r.high());
  }
  return 0;
}

int run(vector<string> arguments) {
  const auto given = [&arguments](const char* option) {
    const bool found = !arguments.empty() && arguments[0] == option;
    if (found) arguments.erase(arguments.begin());
    return found;
  };
  const bool by_program = given("--program"), bounds = given("--bounds");
  const size_t threads = given("--one-thread") ? 1 : all_threads();
  const bool functions = arguments.size() == 1 && arguments[0] == "--functions";
  if (arguments.size() != 1) {
    fprintf(stderr, "expected one proof file: proofcheck [--program] FILE\n");
    return 2;
  }
  const string path = arguments.back();
  try {
    // Decimals are read in the default rounding mode; everything after that rounds upward.
    Json table;
    if (!functions) {
      const string text = read_file(path);
      table = JsonReader(text).document();
    }
    if (!rounding_works()) {
      fprintf(stderr, "this processor or compiler does not round as proofcheck needs it\n");
      return 70;
    }
    if (functions) return answer_functions(std::cin);
    ProofFile file;
    read_proof(table, by_program, file);
    return bounds ? answer_bounds(file, std::cin) : check(file, threads);
  } catch (const NotAProof& problem) {
    say("expected a proof file of format 3, found in " + path + ": " +
            shortened(problem.why) + "; certify its run again",
        stderr);
    return 2;
  } catch (const Inconsistent& problem) {
    say("rejected: " + shortened(problem.why));
    return 1;
  } catch (const Unknown& problem) {
    say("undecided: " + shortened(problem.what) + " cannot be checked here");
    return 3;
  } catch (const NoBound&) {
    printf("undecided: a number of the model is too large or a denominator zero\n");
    return 3;
  } catch (const std::exception& problem) {  // Out of memory.
    say("expected to read " + path + ", found the machine at its end: " + problem.what(), stderr);
    return 3;
  }
}

}  // namespace

int main(int count, char** values) { return run(vector<string>(values + 1, values + count)); }
