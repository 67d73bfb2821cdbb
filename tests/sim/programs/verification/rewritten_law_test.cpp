// The law of compensated programs for those that the strategy gcode rewrites: their text, read
// back, goes along the corrected path of the original, and does everything else that it does.
#include <cstdlib>

#include "sim/input/read_machine.h"
#include "sim/preparation/rewritten_text.h"
#include "sim/programs/verification/linuxcnc_replay.h"
#include "sim/programs/verification/replay_comparison.h"
#include "strategies/gcode.h"
#include "tests/sim/programs/compensate/trial.h"
#include "tests/sim/programs/verification/random_program.h"
#include "tests/strategies/beliefs.h"

namespace servomill::sim {
namespace {

using strategies::Belief;

// One length: a strategy displaces for the tool that it is given.
const std::string kEqualTools = "T1 P1 Z+40 D+6\nT2 P2 Z+40 D+8\n";
constexpr double kTolerance = 0.1e-6;  // m, of chords: the default of the strategy
constexpr double kBeside = 0.02e-6;    // m: chords are looked at in three places

int program_count() {
  const char* text = std::getenv("SERVOMILL_REPLAY_PROGRAMS");
  return text == nullptr ? 200 : std::atoi(text);
}

struct RewrittenTrial {
  MachineDescription described = read_machine_description(kRouter);
  const plant::MachineChain& chain = described.machine.chain;
  const plant::ErrorModel& errors = described.errors.begin()->second;
  controllers::ProgramSetup setup;
  OriginalOptions options;
  Eigen::Vector3d p_ST{0.0, 0.0, -40.0 * mm};

  RewrittenTrial() {
    ProgramInputs inputs;
    inputs.tool_table = written("equal_tools.tbl", kEqualTools);
    setup = program_setup(inputs, "random.ngc");
    for (AxisWords& offset : setup.work_offset) offset.head<3>() << 0.2, 0.25, -0.09;
    setup.start.head<3>() << 0.1, 0.1, -0.01;
    options.is_start_known.fill(true);
    options.layout = chain.layout;
  }

  std::vector<Move> rewrite(const std::vector<Move>& moves) const {
    const strategies::Entry entry = strategies::gcode_entry();
    Parameters parameters = strategies::default_parameters(entry);
    parameters.set("iterations", "converged");
    const NcSettings& nc = described.machine.nc;
    const Belief belief{
        chain.layout, plant::VolumetricModel(chain, errors), p_ST,           nc.lower,
        nc.upper,     chain.layout.joints(setup.start),      Joints::Zero(), Joints::Zero()};
    return entry.make(parameters, strategies::Sign::correct, belief)->rewrite(moves);
  }

  void compare(const std::string& program, const std::string& text) const {
    Correction correction(chain, errors, strategies::DisplacedAxes::linear);
    ComparisonLimits limits;
    limits.tolerance = kTolerance + kBeside;
    limits.grid = 1.0 * nm;  // two solutions for the same displacement, printed to 0.1 nm
    limits.grid_turn = 1e-7 * deg;
    limits.is_linuxcnc = true;
    limits.strategy_tip = p_ST;
    const auto actions = replay_linuxcnc(text, "rewritten", setup, options);
    ReplayComparison comparison(actions, limits, correction);
    controllers::KnownPosition start;
    for (std::size_t i = 0; i < start.size(); ++i) start[i] = setup.start[static_cast<int>(i)];
    comparison.start_at(start);
    Original original(controllers::ProgramText::of_text(program, "random.ngc"), setup, options);
    while (const OriginalAction* action = original.next()) comparison.match(*action);
    comparison.finish();
  }
};

// Refusals are of programs that cannot be printed: shifted work systems, G43.1.
TEST(RewrittenLaw, HoldsForRandomPrograms) {
  const RewrittenTrial trial;
  int verified = 0, refused = 0;
  const int programs = program_count();
  for (int seed = 0; seed < programs; ++seed) {
    const RandomProgram program(static_cast<std::uint32_t>(seed), {});
    std::string text;
    try {
      const auto moves = controllers::interpret(program.text(), "random.ngc", trial.setup);
      text = through_text(trial.rewrite(moves),
                          {"random.ngc", "random", "", trial.options.layout, trial.setup})
                 .text;
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.find("something else"), std::string::npos) << seed << ": " << message;
      ++refused;
      continue;
    }
    try {
      trial.compare(program.text(), text);
      ++verified;
    } catch (const ReplayDifference& difference) {
      ADD_FAILURE() << "seed " << seed << ", line " << difference.written_line << ": "
                    << difference.why << "\n"
                    << program.text();
    }
  }
  fmt::print("gcode: {} verified, {} refused\n", verified, refused);
  EXPECT_GT(verified, programs / 2);
}

}  // namespace
}  // namespace servomill::sim
