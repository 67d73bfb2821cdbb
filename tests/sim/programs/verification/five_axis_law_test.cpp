// The law of compensated programs on five-axis machines of every kind, with errors of all axes:
// tables, heads and both, axes A and B, rotations that carry corrections and such that do not.
#include "tests/number_of.h"
#include "tests/pattern.h"
#include "tests/sim/programs/compensate/trial.h"
#include "tests/sim/programs/verification/random_program.h"
#include "tests/sim/programs/verification/replay_count.h"

namespace servomill::sim::programs::five_axis_law_test {
namespace {

constexpr int kShown = 2;  // programs that differ, in full

int program_count() { return number_of("SERVOMILL_REPLAY_PROGRAMS", 200) / 4; }
int first_seed() { return number_of("SERVOMILL_REPLAY_SEED", 0); }

struct FiveAxisMachine {
  const char* file;
  char tilt;  // the axis beside C
};

constexpr std::array<FiveAxisMachine, 6> kMachines = {{{"generic_trunnion_ac", 'A'},
                                                       {"generic_head_head_ca", 'A'},
                                                       {"generic_head_table_bc", 'B'},
                                                       {"generic_nutating_head_bc", 'B'},
                                                       {"generic_nutating_table_bc", 'B'},
                                                       {"hsm600u", 'B'}}};

// Some 10 um and urad of every component error.
std::string errors_of(char tilt) {
  std::string out = "[errors.all]\n";
  int n = 0;
  for (const char axis : std::string("XYZC") + tilt) {
    const char* period = axis < 'X' ? "period_deg = 180" : "period_mm = 160";
    for (const char direction : std::string("XYZABC")) {
      const char* unit = direction >= 'X' ? "um" : "urad";
      out +=
          fmt::format("E{}{} = {{ harmonic = {{ amplitude_{} = {:.1f}, {}, phase_deg = {} }} }}\n",
                      direction, axis, unit, 9.0 + 5.0 * std::sin(1.0 + n), period, 37 * n);
      ++n;
    }
  }
  return out;
}

CompensateRequest request_for(const std::string& program, std::uint32_t seed, Dialect dialect) {
  const FiveAxisMachine& machine = kMachines[seed % kMachines.size()];
  const std::string text =
      Pattern(" A(-?[0-9])").replaced(program, std::string(" ") + machine.tilt + "$1");
  Trial trial(text, "five_axes.ngc");
  CompensateRequest request = trial.request;
  request.machine_file =
      fmt::format("{}/scenarios/machines/{}.toml", SERVOMILL_SOURCE_DIR, machine.file);
  request.error_file = written("all.toml", errors_of(machine.tilt));
  request.dialect = dialect;
  request.program_name = "FIVE";
  request.program_number = 7;
  request.retract_Z = 0.0;
  request.inputs.parameter_file.clear();
  request.axes = seed % 3 == 0 ? strategies::DisplacedAxes::all : strategies::DisplacedAxes::linear;
  request.corrects_rapids = seed % 7 == 0;
  for (const char* place : {"X=0,Y=0,Z=-90,{}=0,C=0", "G55:X=30,Y=-20,Z=-95,{}=0,C=0",
                            "G56:X=-20,Y=40,Z=-80,{}=2,C=30", "G57:X=10,Y=10,Z=-90,{}=0,C=-20",
                            "G58:X=0,Y=0,Z=-90,{}=0,C=0", "G59:X=0,Y=0,Z=-90,{}=0,C=0"}) {
    request.work_offsets.push_back(fmt::format(fmt::runtime(place), machine.tilt));
  }
  return request;
}

class FiveAxisLaw : public testing::TestWithParam<Dialect> {};

TEST_P(FiveAxisLaw, HoldsForRandomPrograms) {
  ReplayCount count;
  const int programs = program_count(), first = first_seed();
  for (int i = 0; i < programs; ++i) {
    const auto seed = static_cast<std::uint32_t>(first + i);
    const RandomProgram program(seed, {.has_rotary_axes = true});
    const std::string message = count.add(request_for(program.text(), seed, GetParam()));
    if (message.empty()) continue;
    ADD_FAILURE() << "seed " << seed << ": " << message << "\n"
                  << (count.differing <= kShown ? program.text() : "");
  }
  count.print(GetParam());
  EXPECT_EQ(count.differing, 0);
  EXPECT_GT(count.verified, programs / 8);
}

INSTANTIATE_TEST_SUITE_P(Dialects, FiveAxisLaw,
                         testing::Values(Dialect::linuxcnc, Dialect::heidenhain, Dialect::fanuc,
                                         Dialect::siemens),
                         [](const auto& one) {
                           return std::string(kDialects[static_cast<std::size_t>(one.param)]);
                         });

}  // namespace
}  // namespace servomill::sim::programs::five_axis_law_test
