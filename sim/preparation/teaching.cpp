#include "sim/preparation/teaching.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/engine/simulate.h"
#include "sim/preparation/offset_limits.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/preparation/refusals.h"
#include "sim/preparation/stability_check.h"
#include "sim/preparation/trial_runs.h"
#include "strategies/displaced_blocks.h"

namespace servomill::sim::preparation {
namespace {

constexpr int kPlans = 5;  // of a path whose limits an offset shares

// One strategy while it learns.
class Lessons {
 public:
  Lessons(LearningCase& one, std::size_t number)
      : one_(one),
        number_(number),
        spec_(one.spec.strategies[number]),
        untaught_(one.strategies[number]),
        learner_(*untaught_->learning()),
        setup_(learner_.trials()),
        is_rewritten_(one.rewritten != nullptr),
        planned_(one.motion) {}

  void refuse() const {
    if (!spec_.recordings.empty()) {
      if (setup_.limit == strategies::OffsetLimit::slow) {
        throw InputError({}, "limits = \"slow\" plans a path different from the recorded one");
      }
      recordings();
    }
    if (setup_.as_program) {
      refuse_rewritten_probing(spec_, *one_.program, one_.spec.name);
      refuse_tip_moves(spec_, *untaught_, *one_.program, one_.scenario.program.file,
                       one_.spec.name);
    }
    refuse_others();
    check_known_machine();
  }

  strategies::Lesson take() {
    const SharedMotion unhindered = one_.motion;
    controllers::JointLimits limits = one_.prepare.limits();
    strategies::Lesson lesson;
    if (setup_.feed != 1.0) plan(limits);
    for (int plans = 1; learn(lesson, limits, plans == kPlans); ++plans) plan(limits);
    if (setup_.feed != 1.0) {
      const bool lowers = setup_.limit == strategies::OffsetLimit::slow;
      one_.motion =
          lowers ? one_.prepare.motion(planned_->moves, *one_.program, limits) : unhindered;
    }
    if (one_.motion != unhindered) one_.warnings.push_back(other_duration(*unhindered));
    return lesson;
  }

 private:
  const model::MachineSettings& machine() const { return one_.scenario.machine_of(one_.spec); }

  // Plans the path of the runs.
  void plan(const controllers::JointLimits& limits) {
    planned_ = one_.motion =
        one_.prepare.motion(planned_->moves, *one_.program, limits, setup_.feed);
  }

  // Learns on the path as it is planned.
  // @param limits  with which; takes those with which to plan it anew
  // @return true if it is to be planned anew
  bool learn(strategies::Lesson& lesson, controllers::JointLimits& limits, bool is_last) {
    const model::MachineSettings& known = spec_.machine ? *spec_.machine : machine();
    const SharedModel errors =
        setup_.on_actual ? one_.machine_errors : one_.prepare.model(spec_.model, known.chain);
    const plant::ErrorModel* components =
        setup_.on_actual ? one_.component_errors : &one_.prepare.errors(spec_.model);
    const TrialSetting setting{setup_,
                               one_.scenario,
                               one_.spec,
                               known,
                               *one_.program,
                               *planned_,
                               original(),
                               [&](const auto& runs_on, const auto& offset) {
                                 act_with(offset);
                                 return one_.inputs(runs_on, *errors, components);
                               }};
    CaseTrials runs(setting, recordings());
    note_unrecorded(runs);
    lesson = learner_.learn(runs);
    act_with(lesson.offset);
    if (setup_.as_program) return false;  // its plan keeps the limits
    refuse_beyond_travel(*lesson.offset);
    const controllers::JointLimits demands = runs.limits().demands(lesson.offset->offset);
    if (keeps(demands, one_.prepare.limits())) return false;
    if (setup_.limit != strategies::OffsetLimit::slow || is_last) return false;
    limits = lowered(limits, demands, one_.prepare.limits());
    return true;
  }

  bool is_recorded() const { return !spec_.recordings.empty(); }

  std::vector<RecordedRun> recordings() const {
    std::vector<RecordedRun> out;
    for (const model::RecordedRunSpec& one : spec_.recordings) {
      out.push_back(read_recorded_run(one, machine().chain.layout));
    }
    return out;
  }

  void note_unrecorded(const CaseTrials& runs) const {
    if (!is_recorded()) return;
    for (const std::string& text : runs.notes()) one_.warnings.push_back(note(text));
    for (const int j : machine().joints()) {
      const auto& joints = runs.joints();
      if (std::find(joints.begin(), joints.end(), j) != joints.end()) continue;
      if (j >= kLinearJoints && !setup_.turns) continue;
      one_.warnings.push_back(note(fmt::format("axis {} is not recorded and gets no offset",
                                               machine().chain.layout.letter_of(j))));
    }
  }

  // The plan of the original program, where another strategy has rewritten it; else nullptr.
  const PlannedMotion* original() {
    if (!is_rewritten_) return nullptr;
    original_ = one_.prepare.motion({one_.program, &one_.program->moves}, *one_.program);
    return original_.get();
  }

  // Displacements that others make on purpose are no errors of the machine.
  void refuse_others() const {
    for (const model::StrategySpec& other : one_.spec.strategies) {
      if (&other == &spec_ || !other.entry->acts) continue;
      if (other.action == strategies::Action::impose && other.entry->reads_errors) {
        throw InputError(
            {}, fmt::format("would correct the errors that {} imposes", other.entry->name));
      }
      const bool displaces = other.entry->runs_program
                                 ? &other < &spec_  // later ones have not learnt yet
                                 : other.entry->reads_errors || other.entry->corrects_inertia ||
                                       !other.entry->corrects_following;
      const bool sees_tip =
          is_recorded() ? spec_.recordings.front().sees != model::SeenBy::scales : setup_.sees_tip;
      if (sees_tip || !displaces) continue;
      throw InputError({}, fmt::format("sees = \"scales\" would cancel the displacement of {}; use "
                                       "\"tip\", or only one of the two strategies",
                                       other.entry->name));
    }
  }

  void check_known_machine() const {
    if (!spec_.machine || one_.spec.servo == model::ServoModel::ideal) return;
    const model::NominalFilter &known = spec_.machine->nc.filter, &actual = machine().nc.filter;
    if (known.length != actual.length || known.triangle != actual.triangle) {
      throw InputError({},
                       "machine has a different position-setpoint filter from the NC of the case");
    }
    try {
      check_stability(*spec_.machine, one_.scenario.reading_delay_of(one_.spec), nullptr);
    } catch (const InputError& error) {
      throw InputError({}, "its identified machine: " + error.faults().front().message);
    }
  }

  // An offset may leave the travel where the path does not.
  void refuse_beyond_travel(const strategies::PathOffset& offset) const {
    const model::NcSettings& nc = machine().nc;
    controllers::Trajectory::Cursor cursor{};
    for (std::size_t n = 0; n < offset.offset.size(); ++n) {
      const double t = static_cast<double>(n) * offset.times->row_period();
      const auto at = planned_->trajectory.at(t, cursor);
      const Joints Q = at.Q_ref + offset.offset[n];
      for (const int j : machine().joints()) {
        const double beyond = std::max(nc.lower[j] - Q[j], Q[j] - nc.upper[j]);
        if (beyond <= 1e-9 || nc.is_endless(j)) continue;
        throw InputError({}, fmt::format("axis {} would leave its travel by {:.3g} {} at {}:{}",
                                         machine().chain.layout.letter_of(j), beyond / um,
                                         j < kLinearJoints ? "um" : "urad",
                                         one_.scenario.program.file, at.line));
      }
    }
  }

  // Puts the strategy with an offset in place, and the program that it makes.
  void act_with(const std::shared_ptr<const strategies::PathOffset>& offset) {
    SharedStrategy& strategy = one_.strategies[number_];
    strategy = learner_.with_offset(offset);
    if (!strategy->rewrites()) return;
    one_.rewritten = one_.prepare.rewritten(planned_->moves, strategy);
    one_.motion = one_.prepare.motion({one_.rewritten, &one_.rewritten->moves}, *one_.program);
  }

  std::string note(const std::string& text) const {
    return fmt::format("case {}: strategy {}: {}", one_.spec.name, spec_.entry->name, text);
  }

  std::string other_duration(const PlannedMotion& unhindered) const {
    const double before = unhindered.trajectory.duration();
    const double now = one_.motion->trajectory.duration();
    return note(fmt::format("the motion takes {:.4g} s, {:.2g} % {} than without it", now,
                            100.0 * std::abs(now / before - 1.0), now < before ? "less" : "more"));
  }

  LearningCase& one_;
  std::size_t number_;
  const model::StrategySpec& spec_;
  const SharedStrategy untaught_;
  const strategies::LearningStrategy& learner_;
  const strategies::TrialSetup setup_;
  const bool is_rewritten_;  // by a strategy before
  SharedMotion planned_;     // without the offset
  SharedMotion original_;    // of the program before other strategies
};

// Result of `step`; its faults get the place of the strategy.
template <typename Step>
auto with_place(const LearningCase& one, std::size_t number, const Step& step) {
  try {
    return step();
  } catch (const InputError& error) {
    if (error.faults().front().place.file.empty()) {
      throw fault_of(one.spec.strategies[number], one.spec.name, error);
    }
    throw;
  } catch (const strategies::TooManyBlocks& error) {
    throw fault_of(one.spec.strategies[number], one.spec.name, InputError({}, error.what()));
  }
}

}  // namespace

void refuse_lessons(LearningCase& one, std::size_t number) {
  with_place(one, number, [&] { Lessons(one, number).refuse(); });
}

strategies::Lesson teach(LearningCase& one, std::size_t number) {
  return with_place(one, number, [&] { return Lessons(one, number).take(); });
}

}  // namespace servomill::sim::preparation
