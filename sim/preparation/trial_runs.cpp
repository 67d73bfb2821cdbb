#include "sim/preparation/trial_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "plant/vocabulary/units.h"
#include "sim/engine/setpoint.h"
#include "sim/engine/simulate.h"

namespace servomill::sim::preparation {
namespace {

constexpr double kMaxRows = 1e6;  // some 0.5 GB

}  // namespace

CaseTrials::CaseTrials(const TrialSetting& setting, std::vector<RecordedRun> recordings)
    : setting_(setting), recordings_(std::move(recordings)) {
  for (const int j : actual().joints()) {
    if (j < kLinearJoints || setting.setup.turns) joints_.push_back(j);
  }
  find_times();
  if (!recordings_.empty()) take_recorded_joints();
  const model::NcSettings& nc = actual().nc;
  find_wanted(engine::Setpoint(nc, setting.motion.trajectory, {}).delay());
  if (sees_part()) take_parts();
  limits_.emplace(followed_path(), times_->row_period(),
                  controllers::JointLimits{nc.v_max, nc.a_max, nc.j_max});
  if (setting.spec.servo == model::ServoModel::ideal) return;
  const Tick reading_delay = setting.scenario.reading_delay_of(setting.spec);
  std::optional<Joints> tip_at;
  if (sees_tip()) tip_at = mean_position();
  known_ = {setting.known, joints_, reading_delay, tip_at};
  // of the machine that was recorded nothing else is known
  running_ = &machine() == &setting.known || !recordings_.empty()
                 ? known_
                 : OffsetResponses(machine(), joints_, reading_delay, tip_at);
}

CaseTrials::~CaseTrials() = default;

void CaseTrials::find_times() {
  const controllers::Trajectory& trajectory = setting_.motion.trajectory;
  const model::LoopPeriods& periods = actual().nc.periods;
  const double whole = trajectory.duration() + setting_.scenario.settle_time;
  constexpr double kRowsPerSwing = 16.0, kFewestRows = 100.0;
  const double interval =
      std::min(1.0 / (kRowsPerSwing * setting_.setup.cutoff), whole / kFewestRows);
  if (whole > kMaxRows * interval) {
    throw InputError({},
                     fmt::format("cutoff_Hz: a program of {:.4g} s is too long to learn from "
                                 "with {:g} Hz; must be <= {:.2g} Hz",
                                 whole, setting_.setup.cutoff, kMaxRows / (kRowsPerSwing * whole)));
  }
  times_ = std::make_shared<strategies::PathTimes>();
  times_->h = periods.seconds(periods.position);
  times_->every = static_cast<std::size_t>(std::max(1.0, std::floor(interval / times_->h + 1e-9)));
  row_period_ = periods.position * static_cast<Tick>(times_->every);
  controllers::Trajectory::Cursor cursor{};
  for (std::size_t n = 0; static_cast<double>(n) * times_->h <= whole; ++n) {
    times_->s.push_back(trajectory.at(static_cast<double>(n) * times_->h, cursor).s);
  }
}

// Finds the joints on the interpolated path of the original program, row by row: at the same
// instant or, where another program runs, at the same place.
void CaseTrials::find_wanted(double delay) {
  const controllers::Trajectory& trajectory = setting_.motion.trajectory;
  const PlannedMotion& wanted = setting_.original != nullptr ? *setting_.original : setting_.motion;
  const engine::ProgramPath& path = setting_.program.path;
  const engine::ProgramPath::Indices pieces = path.pieces_of(*wanted.moves);
  strategies::PathTimes of_wanted{times_->h, {}, 1};
  controllers::Trajectory::Cursor cursor{}, found{}, sampled{};
  if (setting_.original != nullptr) {
    for (double t = 0.0; t <= wanted.trajectory.duration() + times_->h; t += times_->h) {
      of_wanted.s.push_back(wanted.trajectory.at(t, sampled).s);
    }
  }
  std::optional<strategies::PathPlace> place;
  if (setting_.original != nullptr) place.emplace(of_wanted);
  for (std::size_t n = 0; n < times_->s.size(); n += times_->every) {
    const double t = static_cast<double>(n) * times_->h;
    const auto now = trajectory.at(t - delay, cursor);
    const double then = place ? place->advance(t, now.s) * times_->h : t - delay;
    const auto at = wanted.trajectory.at(then, found);
    const std::size_t piece = pieces[at.move];
    wanted_.push_back({at.Q_ref, setting_.program.tips.at(path.tool_offset(piece)), piece,
                       at.rapid && !at.dQ_ref.isZero(0.0)});
    in_feed_.push_back(!now.rapid && !now.dQ_ref.isZero(0.0));
  }
}

// Derivatives of the path behind the nominal-position filter, which the axes follow.
std::vector<PathRange> CaseTrials::followed_path() const {
  const controllers::Trajectory& path = setting_.motion.trajectory;
  const model::NcSettings& nc = actual().nc;
  if (nc.filter.length == 0) return derivatives_of(path, *times_);
  engine::Setpoint setpoint(nc, path, {});
  setpoint.settle();
  PathRanges out(times_->every);
  controllers::Trajectory::Cursor cursor{};
  Joints ddQ = Joints::Zero();
  for (std::size_t n = 0; n < times_->s.size(); ++n) {
    const engine::AxisSetpoint& now =
        setpoint.advance(path.at(static_cast<double>(n) * times_->h, cursor));
    out.add({now.dQ_ff, now.ddQ_ff, (now.ddQ_ff - ddQ) / times_->h});
    ddQ = now.ddQ_ff;
  }
  return out.rows();
}

Joints CaseTrials::mean_position() const {
  Joints sum = Joints::Zero();
  double count = 0.0;
  for (std::size_t n = 0; n < wanted_.size(); ++n) {
    if (!in_feed_[n]) continue;
    sum += wanted_[n].Q;
    count += 1.0;
  }
  return count > 0.0 ? Joints(sum / count) : wanted_.front().Q;
}

std::complex<double> CaseTrials::known_response(int joint, double f) const {
  return between_rows_at(f) * known_.at(joint, f);
}

std::complex<double> CaseTrials::response(int joint, double f) const {
  return between_rows_at(f) * running_.at(joint, f);
}

// Share of a frequency in the rows that the spline through them has.
double CaseTrials::between_rows_at(double f) const {
  const double x = std::numbers::pi * f * times_->row_period();
  const double sinc = x > 0.0 ? std::sin(x) / x : 1.0;
  return sinc * sinc * sinc * sinc;
}

std::vector<Joints> CaseTrials::admissible(std::vector<Joints> offset) const {
  if (setting_.setup.as_program) {
    strategies::rest_at_standstills(*times_, offset);
    return offset;
  }
  // where the machine stands before and behind the program, no slower path helps
  constexpr double kSoon = 0.006, kSoftly = 0.03, kEnds = 0.3;  // s
  switch (setting_.setup.limit) {
    case strategies::OffsetLimit::smooth:
      limits_->rest_at_ends(offset, kSoon);
      return limits_->nearest_within(std::move(offset));
    case strategies::OffsetLimit::slow:
      limits_->rest_at_ends(offset, kSoon);
      return limits_->nearest_within(std::move(offset), kEnds);
    case strategies::OffsetLimit::ignore:
      break;
  }
  limits_->rest_at_ends(offset, kSoftly);
  return offset;
}

strategies::TrialRun CaseTrials::run(const std::shared_ptr<const strategies::PathOffset>& offset) {
  ++runs_;
  const auto number = static_cast<std::size_t>(runs_ - 1);
  if (sees_part()) return {of_parts_[number], {}};
  if (!recordings_.empty()) return recorded_run(recordings_[number]);
  model::MachineSettings machine = this->machine();
  for (std::size_t j = 0; j < kJoints; ++j) {
    machine.scale[j] = machine.scale[j].in_run(static_cast<std::uint64_t>(runs_));
    machine.motor[j] = machine.motor[j].in_run(static_cast<std::uint64_t>(runs_));
  }
  engine::CaseInputs inputs = setting_.inputs(machine, offset);
  inputs.record_period = row_period_;
  inputs.windows = {};
  inputs.keeping.thinning.reset();
  inputs.format = {};
  std::atomic<float> progress{};
  const Stage stage(progress);
  const engine::CaseResult result = engine::simulate(inputs, interrupt_wanted, progress);
  throw_if_interrupted();
  if (!result.outcome.finished) return {{}, result.outcome.reason};
  const std::vector<double> places = places_of(inputs.reference, result.servo.rows());
  strategies::TrialRun out{setting_.setup.sees_tip ? seen_at_tip(result.servo, places)
                                                   : seen_by_scales(result.servo, places),
                           {}};
  add_noise(out.deviation);
  return out;
}

// Finds each row of the offset in the recording of a run, as a number with a fraction. A run of
// another plan is at the same place at another time.
std::vector<double> CaseTrials::places_of(const controllers::Trajectory& run,
                                          std::size_t rows) const {
  std::vector<double> out(wanted_.size());
  if (&run == &setting_.motion.trajectory) {
    for (std::size_t n = 0; n < out.size(); ++n) {
      out[n] = static_cast<double>(std::min(n, rows - 1));
    }
    return out;
  }
  strategies::PathPlace place(*times_);
  controllers::Trajectory::Cursor cursor{};
  const double h = times_->row_period();
  const auto row_of_plan = [&](double row) {
    const double t = row * h;
    return place.advance(t, run.at(t, cursor).s) / static_cast<double>(times_->every);
  };
  double before = 0.0, after = row_of_plan(0.0), r = 0.0;
  for (std::size_t n = 0; n < out.size(); ++n) {
    const auto wanted = static_cast<double>(n);
    while (after < wanted && r + 1.0 < static_cast<double>(rows)) {
      before = after;
      after = row_of_plan(++r);
    }
    const bool between = after > wanted && after > before && r > 0.0;
    out[n] = between ? r - (after - wanted) / (after - before) : r;
  }
  return out;
}

}  // namespace servomill::sim::preparation
