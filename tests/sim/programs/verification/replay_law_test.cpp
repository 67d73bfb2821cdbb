// The law of compensated programs: what a control makes of the written program is what the original
// asks for. Random programs of every class, for every dialect.

#include "tests/number_of.h"
#include "tests/sim/programs/compensate/trial.h"
#include "tests/sim/programs/verification/each_dialect.h"
#include "tests/sim/programs/verification/random_program.h"
#include "tests/sim/programs/verification/replay_count.h"

namespace servomill::sim::programs::replay_law_test {
namespace {

constexpr const char* kNoErrors = "[errors.none]\nEXX = { constant_um = 0.0 }\n";

constexpr int kShown = 3;  // programs that differ, in full

// How many programs a dialect, and the seed of the first.
int program_count() { return number_of("SERVOMILL_REPLAY_PROGRAMS", 200); }
int first_seed() { return number_of("SERVOMILL_REPLAY_SEED", 0); }

CompensateRequest request_for(const std::string& program, Dialect dialect, bool has_rotary_axes,
                              bool has_errors) {
  Trial trial(program, "random.ngc");
  CompensateRequest request = trial.request;
  request.dialect = dialect;
  request.program_name = "RANDOM";
  request.program_number = 7;
  request.retract_Z = 0.0;
  request.inputs.parameter_file.clear();
  request.work_offsets = {"X=200,Y=250,Z=-90", "G55:X=300,Y=200,Z=-95", "G56:X=120,Y=140,Z=-80"};
  for (const char* system : {"G57", "G58", "G59", "G59.1", "G59.2", "G59.3"}) {
    request.work_offsets.push_back(fmt::format("{}:X=210,Y=230,Z=-85", system));
  }
  if (has_rotary_axes) {
    request.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/generic_trunnion_ac.toml";
    request.work_offsets = {"X=0,Y=0,Z=-90,A=0,C=0",        "G55:X=30,Y=-20,Z=-95,A=0,C=0",
                            "G56:X=-20,Y=40,Z=-80,A=0,C=0", "G57:X=10,Y=10,Z=-90,A=0,C=30",
                            "G58:X=0,Y=0,Z=-90,A=0,C=0",    "G59:X=0,Y=0,Z=-90,A=0,C=0"};
  }
  if (!has_errors || has_rotary_axes) request.error_file = written("none.toml", kNoErrors);
  return request;
}

void run(ReplayCount& count, std::uint32_t seed, Dialect dialect, bool is_interrupted) {
  const bool has_rotary_axes = seed % 5 == 4, has_errors = seed % 2 == 1;
  const RandomProgram program(seed, {.has_rotary_axes = has_rotary_axes,
                                     .is_interrupted = is_interrupted,
                                     .steps = is_interrupted ? 12 : 18});
  const std::string message =
      count.add(request_for(program.text(), dialect, has_rotary_axes, has_errors));
  if (message.empty()) return;
  ADD_FAILURE() << "seed " << seed << ": " << message << "\n"
                << (count.differing <= kShown ? program.text() : "");
}

class ReplayLaw : public testing::TestWithParam<Dialect> {};

TEST_P(ReplayLaw, HoldsForRandomPrograms) {
  ReplayCount count;
  const int programs = program_count(), first = first_seed();
  for (int i = 0; i < programs; ++i)
    run(count, static_cast<std::uint32_t>(first + i), GetParam(), false);
  count.print(GetParam());
  EXPECT_EQ(count.differing, 0);
  EXPECT_GT(count.verified, programs / 2);
}

TEST_P(ReplayLaw, HoldsForInterruptedPrograms) {
  ReplayCount count;
  const int programs = program_count(), first = first_seed();
  for (int i = 0; i < programs; ++i)
    run(count, static_cast<std::uint32_t>(first + i), GetParam(), true);
  count.print(GetParam());
  EXPECT_EQ(count.differing, 0);
  EXPECT_GT(count.verified, programs / 10);
}

INSTANTIATE_TEST_SUITE_P(Dialects, ReplayLaw, each_dialect(), name_of_dialect);

}  // namespace
}  // namespace servomill::sim::programs::replay_law_test
