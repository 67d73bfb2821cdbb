#include "strategies/learning.h"

#include <array>
#include <cmath>

#include "strategies/axis_displacement.h"
#include "strategies/iterative_learning.h"

namespace servomill::strategies {
namespace {

constexpr std::array<std::string_view, 2> kSeen = {"tip", "scales"};
constexpr std::array<std::string_view, 3> kRecordedInstead = {"updates", "sees", "noise_um"};

const std::array<ParameterSpec, 10>& specs() {
  static const std::array<ParameterSpec, 10> kSpecs = {{
      {.name = "updates",
       .help = "number of runs of the program to learn from",
       .default_text = "5",
       .min = 1,
       .max = 100},
      {.name = "sees",
       .help = "tip: TCP positions read by a grid encoder; scales: scale readings of the axes",
       .default_text = "tip",
       .is_number = false,
       .words = kSeen,
       .shortcoming = Shortcoming::measurement,
       .ideal = "tip"},
      {.name = "noise_um",
       .help = "standard deviation of the observed position of each linear axis, in addition to "
               "encoder noise",
       .unit = "um",
       .default_text = "0",
       .min = 0.0,
       .shortcoming = Shortcoming::measurement,
       .ideal = "0"},
      {.name = "gain",
       .help = "fraction of the error that an update corrects if the axis responds as known",
       .default_text = "1",
       .min = 0.01,
       .max = 2.0},
      {.name = "forgetting",
       .help = "fraction of the offset that each update forgets",
       .default_text = "0",
       .min = 0.0,
       .max = 0.99},
      {.name = "feed_share",
       .help = "feed of the runs to learn from, as a fraction of that of the case",
       .default_text = "1",
       .min = 0.1,
       .max = 10.0},
      kCutoffSpec,
      kLimitsSpec,
      kAxesSpec,
      kSingularSpec,
  }};
  return kSpecs;
}

std::unique_ptr<Strategy> make(const Parameters& p, Action, const IdentifiedMachine& identified) {
  LearningPlan plan = learning_plan_of(p);
  plan.setup.on_actual = true;
  plan.setup.feed = p.number("feed_share");
  plan.setup.sees_tip = p.word("sees") == "tip";
  plan.setup.noise = p.number("noise_um");
  plan.filter.gain = p.number("gain");
  plan.filter.remembering = 1.0 - p.number("forgetting");
  plan.setup.runs = static_cast<int>(std::lround(p.number("updates")));
  plan.takes_best = false;
  return iterative_learning(plan, identified);
}

}  // namespace

Entry learning_entry() {
  Entry entry = {
      "learning",
      "offsets the setpoints against the deviations observed in earlier runs of the program",
      specs(), make};
  entry.once = true;
  entry.corrects_following = true;
  entry.reads_errors = false;
  entry.runs_program = true;
  entry.recorded_instead = kRecordedInstead;
  return entry;
}

}  // namespace servomill::strategies
