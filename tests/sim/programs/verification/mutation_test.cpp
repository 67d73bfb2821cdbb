// Faults of writers, made in written programs on purpose: verification finds each that changes what
// the control does.
#include <random>

#include "sim/input/read_machine.h"
#include "sim/programs/verification/verification.h"
#include "tests/sim/programs/compensate/trial.h"
#include "tests/sim/programs/verification/each_dialect.h"
#include "tests/sim/programs/verification/effect.h"
#include "tests/sim/programs/verification/mutations.h"

namespace servomill::sim::mutation_test {
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

constexpr int kPlaces = 20;
// Two paths within 1 um of the corrected one, each rounded to 1 um.
constexpr double kTolerance = 2.0 * 1.87e-6;  // m
constexpr double kRetract = -2.0 * mm;

CompensateRequest request_for(Dialect dialect) {
  Trial trial(kProgram, "mutant.ngc");
  CompensateRequest request = trial.request;
  request.dialect = dialect;
  request.inputs.parameter_file.clear();
  request.work_offsets = {"X=400,Y=350,Z=-90"};
  request.program_name = "MUTANT";
  request.program_number = 7;
  request.retract_Z = kRetract;
  return request;
}

std::vector<Effect> linuxcnc_effects(const std::string& text) {
  const CompensateRequest request = request_for(Dialect::linuxcnc);
  controllers::ProgramSetup setup = program_setup(request.inputs, "mutant");
  setup.work_offset[0].head<3>() << 0.4, 0.35, -0.09;
  return linuxcnc_effects_of(text, setup, read_machine_description(kRouter).machine.chain.layout);
}

std::vector<Effect> effects(const std::string& text, Dialect dialect) {
  if (dialect == Dialect::linuxcnc) return linuxcnc_effects(text);
  controllers::ControlSetup setup;
  setup.work_offset[0] = (AxisWords() << 0.4, 0.35, -0.09, 0.0, 0.0, 0.0).finished();
  setup.tool_length = {{1, 40.0 * mm}, {2, 55.5 * mm}};
  return effects_of(text, dialect, setup);
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

void try_kind(const MutationKind& kind, const CompensateRequest& request,
              const std::string& written, Tally& tally) {
  const Lines lines = lines_of(written);
  const std::vector<Effect> effect = effects(written, request.dialect);
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!is_comment(lines[i])) places.push_back(i);
  }
  std::shuffle(places.begin(), places.end(), std::mt19937(7));
  int done = 0;
  for (const std::size_t i : places) {
    Lines mutant = lines;
    if (done == kPlaces) break;
    if (!kind.apply(mutant, i) || mutant == lines) continue;
    ++done;
    ++tally.mutants;
    const std::string text = text_of(mutant, request.dialect);
    const std::vector<Effect> changed = effects(text, request.dialect);
    const std::string said = fmt::format("{}, line {}: \"{}\"", kind.name, i + 1, lines[i]);
    if (changed == effect) {
      ++tally.equivalent;
      tally.same.push_back(said);
    } else if (is_found(request, text)) {
      ++tally.found;
    } else if (is_within(changed, effect, kTolerance)) {
      ++tally.within_tolerance;
    } else {
      tally.missed.push_back(said);
    }
  }
}

class Mutations : public testing::TestWithParam<Dialect> {};

TEST_P(Mutations, ThatChangeWhatTheControlDoesAreFound) {
  const CompensateRequest request = request_for(GetParam());
  const std::string written = compensate(request).program;
  EXPECT_FALSE(is_found(request, written));
  Tally all;
  for (const MutationKind& kind : mutation_kinds()) {
    Tally tally;
    try_kind(kind, request, written, tally);
    fmt::print(
        "{:11} {:30} {:3} mutants, {:3} found, {:3} equivalent, {:3} within "
        "the tolerance\n",
        kDialects[static_cast<std::size_t>(GetParam())], kind.name, tally.mutants, tally.found,
        tally.equivalent, tally.within_tolerance);
    for (const std::string& one : tally.same) fmt::print("  equivalent: {}\n", one);
    all.mutants += tally.mutants;
    all.found += tally.found;
    for (const std::string& one : tally.missed) ADD_FAILURE() << one;
  }
  EXPECT_GT(all.found, 150);
}

INSTANTIATE_TEST_SUITE_P(Dialects, Mutations, each_dialect(), name_of_dialect);

}  // namespace
}  // namespace servomill::sim::mutation_test
