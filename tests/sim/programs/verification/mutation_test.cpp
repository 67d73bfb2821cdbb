// Faults of writers, made in written programs on purpose: verification finds each that changes what
// the control does.
#include <random>

#include "sim/input/machine_description.h"
#include "sim/input/read_machine.h"
#include "sim/programs/verification/verification.h"
#include "tests/number_of.h"
#include "tests/sim/programs/compensate/trial.h"
#include "tests/sim/programs/verification/each_dialect.h"
#include "tests/sim/programs/verification/effect.h"
#include "tests/sim/programs/verification/mutations.h"

namespace servomill::sim::programs::mutation_test {
namespace {

const std::string kProgram =
    "(two tools)\n"
    "G21 G90 G17 G54\n"
    "T1 M6\n"
    "S1000 M3\n"
    "G0 X10 Y10\n"
    "G43 H1 Z5\n"
    "M8\n"
    "G1 Z-1 F200\n"
    "G1 X50 Y-12.5\n"
    "G2 X60 Y-2.5 I0 J10 F350\n"
    "G4 P1.5\n"
    "G1 X55 Y-30\n"
    "G0 Z20\n"
    "G0 X80 Y30\n"
    "G0 Z2\n"
    "G1 Z-2 F150\n"
    "G3 X80 Y30 I-8 J0 F400\n"
    "G1 X75 Y20\n"
    "G0 Z20\n"
    "M9\n"
    "M5\n"
    "G53 G0 Z0\n"
    "T2 M6\n"
    "S2500 M4\n"
    "G0 X-20 Y25\n"
    "G43 H2 Z4\n"
    "M8\n"
    "G1 Z-3 F120\n"
    "G1 X-40 Y-35 F600\n"
    "M0\n"
    "S2500 M4\n"
    "M8\n"
    "G0 X-40 Y-35\n"
    "G0 Z4\n"
    "G1 Z-2.5 F100\n"
    "G1 X-60.5 Y-30\n"
    "G0 X-70 Y-40 Z30\n"
    "M9\n"
    "G53 G0 Z0\n"
    "M5\n"
    "M30\n";

constexpr int kOperations = 20;

// For kinds of faults that a program has place for once an operation: two tools in turn, on a
// machine without errors, where blocks stay as they are.
std::string many_operations() {
  std::string out = "(many operations)\nG21 G90 G17 G54\n";
  for (int i = 0; i < kOperations; ++i) {
    const double x = -60.5 + 6.3 * i, y = 30.25 - 3.1 * i;
    const int tool = i % 2 + 1, feed = 100 + 13 * i;
    out += fmt::format("T{} M6\nS{} M{}\nG90 G54\nG94 G0 X{:.3f} Y{:.3f}\n", tool, 1000 + 50 * i,
                       i % 3 == 0 ? 4 : 3, x, y);
    out += fmt::format("G43 H{} Z5\nM8\nG1 Z-{:.2f} F{}\n", tool, 1.0 + 0.05 * i, feed);
    out += fmt::format("G{} X{:.3f} Y{:.3f} I5 J0 F{}\nG1 X{:.3f} F{}\n", i % 2 + 2, x + 10.0, y,
                       2 * feed, x + 2.5, 3 * feed);
    out +=
        fmt::format("G0 Z20\nG0 X{:.3f} Y{:.3f}\nG0 Z4.5\nM9\nM5\nG53 G0 Z0\n", x + 1.5, y - 7.5);
  }
  return out + "M30\n";
}

// Mutants of a kind.
int places_of_a_kind() { return number_of("SERVOMILL_MUTANTS", 20); }
// Two paths within 1 um of the corrected one, each rounded to 1 um.
constexpr double kTolerance = 2.0 * 1.87e-6;  // m
constexpr double kRetract = -2.0 * mm;
constexpr const char* kNoErrors = "[errors.none]\nEXX = { constant_um = 0.0 }\n";

CompensateRequest request_for(const std::string& program, bool has_errors, Dialect dialect) {
  Trial trial(program, has_errors ? "mutant.ngc" : "many_mutants.ngc");
  CompensateRequest request = trial.request;
  request.dialect = dialect;
  request.inputs.parameter_file.clear();
  request.work_offsets = {"X=400,Y=350,Z=-90"};
  request.program_name = "MUTANT";
  request.program_number = 7;
  request.retract_Z = kRetract;
  if (!has_errors) request.error_file = written("none.toml", kNoErrors);
  return request;
}

std::vector<Effect> linuxcnc_effects(const std::string& text, const CompensateRequest& request) {
  controllers::ProgramSetup setup = program_setup(request.inputs, "mutant");
  setup.work_offset[0].head<3>() << 0.4, 0.35, -0.09;
  return linuxcnc_effects_of(text, setup,
                             input::read_machine_description(kRouter).machine->chain.layout);
}

std::vector<Effect> effects(const std::string& text, const CompensateRequest& request) {
  if (request.dialect == Dialect::linuxcnc) return linuxcnc_effects(text, request);
  controllers::ControlSetup setup;
  setup.work_offset[0] = (AxisWords() << 0.4, 0.35, -0.09, 0.0, 0.0, 0.0).finished();
  setup.tool_length = {{1, 40.0 * mm}, {2, 55.5 * mm}};
  return effects_of(text, request.dialect, setup);
}

bool is_found(const CompensateRequest& request, const std::string& mutant) {
  try {
    verify_compensated(request, mutant);
    return false;
  } catch (const InputError&) {
    return true;
  }
}

struct Tally {
  int mutants = 0, found = 0, equivalent = 0, within_tolerance = 0;
  std::vector<std::string> missed, same;  // by kind, line and text
};

/// A program as it is written, and what a control makes of it.
struct Written {
  CompensateRequest request;
  std::string text;
  std::vector<Effect> effect;

  Written(const std::string& program, bool has_errors, Dialect dialect)
      : request(request_for(program, has_errors, dialect)),
        text(compensate(request).program),
        effect(effects(text, request)) {}
};

// Until the kind has had its places.
void try_kind(const MutationKind& kind, const Written& written, Tally& tally) {
  const Lines lines = lines_of(written.text);
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!is_comment(lines[i])) places.push_back(i);
  }
  std::shuffle(places.begin(), places.end(), std::mt19937(7));
  for (const std::size_t i : places) {
    Lines mutant = lines;
    if (tally.mutants == places_of_a_kind()) return;
    if (!kind.apply(mutant, i) || mutant == lines) continue;
    ++tally.mutants;
    const std::string text = text_of(mutant, written.request.dialect);
    const std::vector<Effect> changed = effects(text, written.request);
    const std::string said = fmt::format("{}, line {}: \"{}\"", kind.name, i + 1, lines[i]);
    if (changed == written.effect) {
      ++tally.equivalent;
      tally.same.push_back(said);
    } else if (is_found(written.request, text)) {
      ++tally.found;
    } else if (is_within(changed, written.effect, kTolerance)) {
      ++tally.within_tolerance;
    } else {
      tally.missed.push_back(said);
    }
  }
}

class Mutations : public testing::TestWithParam<Dialect> {};

TEST_P(Mutations, ThatChangeWhatTheControlDoesAreFound) {
  const Written programs[] = {{kProgram, true, GetParam()}, {many_operations(), false, GetParam()}};
  for (const Written& one : programs) EXPECT_FALSE(is_found(one.request, one.text));
  int found = 0;
  for (const MutationKind& kind : mutation_kinds()) {
    Tally tally;
    for (const Written& one : programs) try_kind(kind, one, tally);
    fmt::print(
        "{:11} {:30} {:3} mutants, {:3} found, {:3} equivalent, {:3} within "
        "the tolerance\n",
        kDialects[static_cast<std::size_t>(GetParam())], kind.name, tally.mutants, tally.found,
        tally.equivalent, tally.within_tolerance);
    for (const std::string& one : tally.same) fmt::print("  equivalent: {}\n", one);
    for (const std::string& one : tally.missed) ADD_FAILURE() << one;
    EXPECT_EQ(tally.mutants, places_of_a_kind()) << kind.name << " has too few places";
    found += tally.found;
  }
  EXPECT_GT(2 * found, 25 * places_of_a_kind());
}

INSTANTIATE_TEST_SUITE_P(Dialects, Mutations, each_dialect(), name_of_dialect);

}  // namespace
}  // namespace servomill::sim::programs::mutation_test
