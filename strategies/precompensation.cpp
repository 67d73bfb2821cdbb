#include "strategies/precompensation.h"

#include <array>
#include <cmath>

#include "strategies/axis_displacement.h"
#include "strategies/iterative_learning.h"

namespace servomill::strategies {
namespace {

constexpr std::array<std::string_view, 2> kForms = {"setpoint", "program"};

const std::array<ParameterSpec, 11>& specs() {
  static const std::array<ParameterSpec, 11> kSpecs = {{
      {.name = "residual_um",
       .help = "the iteration ends when the maximum predicted deviation of the tip in feed motion "
               "is below this value",
       .unit = "um",
       .default_text = "0.1",
       .min = 0.0},
      {.name = "max_runs",
       .help = "maximum number of runs of the model",
       .default_text = "8",
       .min = 2,
       .max = 100},
      kCutoffSpec,
      {.name = "as",
       .help = "setpoint: the NC adds the offset; program: the offset is written into the program, "
               "as short blocks that any NC can read",
       .default_text = "setpoint",
       .is_number = false,
       .words = kForms},
      kLimitsSpec,
      kBlockSpecs[0],
      kBlockSpecs[1],
      kBlockSpecs[2],
      kBlockSpecs[3],
      kAxesSpec,
      kSingularSpec,
  }};
  return kSpecs;
}

std::unique_ptr<Strategy> make(const Parameters& p, Action, const IdentifiedMachine& identified) {
  LearningPlan plan = learning_plan_of(p);
  plan.setup.as_program = p.word("as") == "program";
  plan.blocks = block_limits_of(p);
  plan.blocks.turns = plan.setup.turns;
  plan.setup.runs = static_cast<int>(std::lround(p.number("max_runs")));
  plan.tolerance = p.number("residual_um");
  return iterative_learning(plan, identified);
}

}  // namespace

Entry precompensation_entry() {
  Entry entry = {"precompensation",
                 "offsets the setpoints against the deviations that an identified model of the "
                 "machine predicts",
                 specs(), make};
  entry.once = true;
  entry.corrects_following = true;
  entry.imposes = false;
  entry.runs_program = true;
  return entry;
}

}  // namespace servomill::strategies
