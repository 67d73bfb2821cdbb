#include "strategies/iterative_learning.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/progress.h"
#include "strategies/axis_displacement.h"

namespace servomill::strategies {
namespace {

constexpr std::array<std::string_view, 3> kLimits = {"smooth", "slow", "ignore"};

constexpr double kHardlyBetter = 0.98;  // rms of the run before

class LearntOffset final : public Strategy {
 public:
  explicit LearntOffset(std::shared_ptr<const PathOffset> offset) : offset_(std::move(offset)) {}
  std::unique_ptr<SetpointPart> setpoint() const override { return path_offset_part(offset_); }

 private:
  std::shared_ptr<const PathOffset> offset_;
};

// The program with the offset in it.
class LearntProgram final : public Strategy {
 public:
  LearntProgram(const IdentifiedMachine& identified, const BlockLimits& limits,
                std::shared_ptr<const PathOffset> offset)
      : identified_(identified), limits_(limits), offset_(std::move(offset)) {}
  bool rewrites() const override { return true; }
  bool rewrites_tip_moves() const override { return true; }
  bool displaces_rotary() const override { return limits_.turns; }
  void rewrite(const MoveRange& moves, const PutMove& put) const override {
    AlongPath displacement(identified_.layout, *offset_);
    put_displaced_blocks(moves, identified_, limits_, displacement, put);
  }

 private:
  class AlongPath final : public PointDisplacement {
   public:
    AlongPath(const JointLayout& layout, const PathOffset& offset)
        : layout_(layout), offset_(offset) {}
    At at(const Joints&, double s) const override { return {layout_.words(offset_.at_place(s))}; }

   private:
    const JointLayout& layout_;
    const PathOffset& offset_;
  };

  IdentifiedMachine identified_;
  BlockLimits limits_;
  std::shared_ptr<const PathOffset> offset_;
};

class IterativeLearning final : public LearningStrategy {
 public:
  IterativeLearning(const LearningPlan& plan, const IdentifiedMachine& identified)
      : plan_(plan), identified_(identified) {}

  bool rewrites_tip_moves() const override { return true; }
  TrialSetup trials() const override { return plan_.setup; }
  Lesson learn(TrialRuns& runs) const override {
    return strategies::learn(plan_, identified_.layout, runs);
  }
  std::shared_ptr<const Strategy> with_offset(
      std::shared_ptr<const PathOffset> offset) const override {
    if (!plan_.setup.as_program) return std::make_shared<LearntOffset>(std::move(offset));
    return std::make_shared<LearntProgram>(identified_, plan_.blocks, std::move(offset));
  }

 private:
  LearningPlan plan_;
  IdentifiedMachine identified_;
};

TrialFigures figures_of(const TrialRun& run, const std::vector<bool>& in_feed) {
  TrialFigures out;
  double squares = 0.0, count = 0.0;
  for (std::size_t n = 0; n < run.deviation.size(); ++n) {
    if (!in_feed[n]) continue;
    const double size = run.deviation[n].head<kLinearJoints>().norm();
    squares += size * size;
    count += 1.0;
    out.largest = std::max(out.largest, size);
  }
  if (count > 0.0) out.rms = std::sqrt(squares / count);
  return out;
}

// An error at a frequency where the next run has more of it would grow from run to run.
void refuse_growing(const LearningPlan& plan, const JointLayout& layout, const TrialRuns& runs) {
  constexpr int kFrequencies = 4000;
  constexpr double kLowest = 0.5;  // Hz
  const double nyquist = 0.5 / runs.times()->row_period();
  const double ratio = std::pow(nyquist / kLowest, 1.0 / kFrequencies);
  for (const int j : runs.joints()) {
    double worst = 0.0, at = 0.0;
    for (double f = kLowest; f <= nyquist; f *= ratio) {
      const double left =
          share_left(plan.filter, f, runs.known_response(j, f), runs.response(j, f));
      if (left <= worst) continue;
      worst = left;
      at = f;
    }
    // The condition of contraction, |1 - L G| < 1 at every frequency: sufficient for convergence of
    // the error in the iteration domain, and its excess is the growth of a run.
    if (worst < 1.0) continue;
    throw InputError({}, fmt::format("cutoff_Hz: the filter does not contract: at {:.3g} Hz the "
                                     "next run would have {:.2f} times the error of axis {}; "
                                     "lower cutoff_Hz or the gain",
                                     at, worst, layout.letter_of(j)));
  }
}

OffsetLimit offset_limit_of(const Parameters& parameters) {
  const std::string& word = parameters.word("limits");
  if (word == "smooth") return OffsetLimit::smooth;
  return word == "slow" ? OffsetLimit::slow : OffsetLimit::ignore;
}

}  // namespace

const ParameterSpec kLimitsSpec = {
    .name = "limits",
    .help =
        "action where path and offset together exceed the velocity, acceleration or jerk limit of "
        "an axis: smooth the offset, slow the path, or ignore the violation",
    .default_text = "smooth",
    .is_number = false,
    .words = kLimits};

const ParameterSpec kCutoffSpec = {
    .name = "cutoff_Hz",
    .help =
        "cut-off frequency of the zero-phase low-pass of the offset, where its gain is one half",
    .unit = "Hz",
    .default_text = "100",
    .min = 0.1,
    .max = 1000.0};

LearningPlan learning_plan_of(const Parameters& parameters) {
  LearningPlan plan;
  plan.setup.turns = displaced_axes_of(parameters) == DisplacedAxes::all;
  plan.setup.sigma_0 = std::sin(parameters.number("singular_deg"));
  plan.setup.limit = offset_limit_of(parameters);
  plan.setup.cutoff = plan.filter.cutoff = parameters.number("cutoff_Hz");
  return plan;
}

Lesson learn(const LearningPlan& plan, const JointLayout& layout, TrialRuns& runs) {
  refuse_growing(plan, layout, runs);
  const auto times = runs.times();
  auto u = std::make_shared<const PathOffset>(
      PathOffset{times, std::vector<Joints>(times->rows(), Joints::Zero())});
  Lesson out{u, {}};
  double best = 0.0;
  const int count = runs.recorded() > 0 ? runs.recorded() : plan.setup.runs;
  Stage stage(plan.takes_best ? "trial runs at most" : "trial runs", count,
              plan.takes_best ? Steps::unlike : Steps::alike);
  for (int k = 0; k < count; ++k) {
    TrialRun run = runs.run(u);
    stage.advance();
    if (!run.stopped.empty()) {
      throw InputError({}, fmt::format("run {} of the program stops: {}", k + 1, run.stopped));
    }
    const TrialFigures figures = figures_of(run, runs.in_feed());
    out.trials.push_back(figures);
    const bool first = k == 0;
    const bool is_enough = figures.largest <= plan.tolerance;
    if (plan.takes_best && (first || is_enough || figures.rms < best)) out.offset = u;
    // Runs end with the last that was clearly better: noise that does not repeat cannot be learnt.
    const bool better = first || figures.rms < kHardlyBetter * best;
    best = first ? figures.rms : std::min(best, figures.rms);
    if (plan.takes_best && (is_enough || !better)) break;
    // The offset opposes the deviation that it is to cancel.
    for (Joints& one : run.deviation) one = -one;
    std::vector<Joints> next =
        next_offset(u->offset, run.deviation, times->row_period(), plan.filter, runs.joints(),
                    [&](int j, double f) { return runs.known_response(j, f); });
    u = std::make_shared<const PathOffset>(PathOffset{times, runs.admissible(std::move(next))});
  }
  if (!plan.takes_best) out.offset = u;
  return out;
}

std::unique_ptr<LearningStrategy> iterative_learning(const LearningPlan& plan,
                                                     const IdentifiedMachine& identified) {
  return std::make_unique<IterativeLearning>(plan, identified);
}

}  // namespace servomill::strategies
