#include "sim/engine/ideal_run.h"

#include <algorithm>
#include <utility>

namespace servomill::sim::engine {

IdealRun::IdealRun(CaseInputs& in)
    : in_(in),
      periods_(in.machine.nc.periods),
      setpoint_(in.machine.nc, in.reference, std::move(in.setpoints)),
      feedback_(in.feedback ? in.feedback->feedback(model_period_of(in)) : nullptr),
      recorder_(in.machine, in.machine_errors, in.imposed, in.path, in.tips, in.format,
                in.program_displaces_rotary, in.recorded_corrections, in.cutting != nullptr,
                in.keeping, in.teeth != nullptr, in.records_orientation, in.windows, in.outputs),
      travel_(in.machine_errors, Joints::Zero()),
      motion_(periods_.seconds(periods_.position)),
      demands_(periods_.seconds(periods_.position)) {
  if (in.machine.heat) {
    heat_ = std::make_unique<HeatRun>(in.machine, *in.component_errors, in.known_heat);
    setpoint_.read_temperatures(heat_->reading());
    recorder_.use(heat_->errors(), heat_->temperatures());
  }
  if (in.machine.inertial_compliances.empty()) return;
  structure_.emplace(in.machine.inertial_compliances, periods_.base,
                     std::vector{periods_.position});
}

CaseResult IdealRun::run(const StopFlag& stop, std::atomic<float>& progress) {
  CaseResult result;
  const double end = in_.reference.duration() + in_.settle_time;
  recorder_.expect(static_cast<std::size_t>(end / periods_.seconds(in_.record_period) + 1.0));
  Tick n = 0;
  AxisSetpoint set = setpoint_.settle();
  const Joints rest = Q_true_of(set);
  demands_.start(set.Q_ref, rest - set.Q_ref);
  travel_ = {in_.machine_errors, rest};
  if (in_.cutting != nullptr) cut_.emplace(in_).start(reference_at(0));
  if (structure_) {
    motion_.start(rest);
    structure_->start(motion_.Q());
  }
  if (!in_.stops_with.empty()) {
    result.outcome = stopped_at_begin(in_.stops_with);
    record(0, set, Q_true_of(set));
    result.servo = recorder_.take();
    result.left_out = recorder_.left_out();
    return result;
  }
  for (; periods_.seconds(n) <= end; n += periods_.position) {
    progress.store(static_cast<float>(periods_.seconds(n) / end), std::memory_order_relaxed);
    if (stop.load(std::memory_order_relaxed)) {
      result.outcome = interrupted(periods_.seconds(n));
      break;
    }
    const double t = periods_.seconds(n);
    const auto sample = in_.reference.at(t, cursor_);
    set = setpoint_.advance(sample, t, set.Q_cmd);
    now_ = {t, sample.s, set.Q_ref, set.dQ_ff, set.ddQ_ff, Joints::Zero(), set.Q_cmd};
    if (!goes_on(in_.path.line(in_.pieces[sample.move]), result.outcome)) break;
    if (cut_ && !cut(n, set, in_.path.line(in_.pieces[sample.move]), result.outcome)) break;
    if (heat_ && n > 0 && !heat(sample, result.outcome)) break;
    const Joints Q_true = Q_true_of(set);
    if (in_.outputs.demands) demands_.add(t, set.Q_ref, Q_true - set.Q_ref);
    travel_.go_to(Q_true);
    if (structure_ && n > 0) bend(Q_true);
    if (n % in_.record_period == 0) record(n, set, Q_true);
  }
  result.simulated_time = periods_.seconds(n);
  result.servo = recorder_.take();
  result.left_out = recorder_.left_out();
  result.saturations = std::move(saturations_);
  result.demands = demands_.demands();
  if (heat_) std::move(*heat_).take_courses(result);
  if (cut_) result.off_path = cut_->off_path();
  return result;
}

controllers::Trajectory::Sample IdealRun::reference_at(Tick n) {
  return in_.reference.at(periods_.seconds(n) - setpoint_.delay(), record_cursor_);
}

// False if a strategy cannot go on.
bool IdealRun::goes_on(int line, Outcome& outcome) const {
  std::string_view failure = setpoint_.failure();
  if (failure.empty() && feedback_) failure = feedback_->failure(0);
  if (!failure.empty()) outcome = failed(failure, now_.t, line);
  return failure.empty();
}

// Adds the saturations of a recorded instant.
void IdealRun::add_saturations(double time) {
  if (!feedback_) return;
  for (const strategies::Saturation& now : feedback_->saturations(0)) {
    auto known = std::find_if(saturations_.begin(), saturations_.end(),
                              [&](const auto& one) { return one.joint == now.joint; });
    if (known == saturations_.end()) {
      known = saturations_.insert(known, now);
      known->first = time;
      known->time = 0.0;
    }
    known->time += periods_.seconds(in_.record_period);
  }
}

void IdealRun::record(Tick n, const AxisSetpoint& set, const Joints& Q_true) {
  Snapshot now;
  now.time = periods_.seconds(n);
  const auto reference = reference_at(n);
  now.s = reference.s;
  now.piece = in_.pieces[reference.move];
  now.Q_ref = set.Q_ref;
  now.Q_cmd = now.Q_fb = set.Q_cmd;
  now.Q_meas = now.Q_true = Q_true;
  now.dQ_true = set.dQ_ff;
  if (cut_) cut_->note(now);
  if (structure_) now.inertial_deflection = structure_->at(motion_.ddQ());
  recorder_.record(now, travel_.at(now.Q_true));
  add_saturations(now.time);
}

// False if the tool cannot go on.
bool IdealRun::cut(Tick n, const AxisSetpoint& set, int line, Outcome& outcome) {
  if (in_.displaced_cuts != nullptr) {
    cut_->deviate(reference_at(n), Q_true_of(set),
                  structure_ ? structure_->at(motion_.ddQ()) : Eigen::Vector3d::Zero().eval());
  }
  cut_->advance(reference_at(n), periods_.seconds(n));
  if (in_.teeth != nullptr) cut_->turn(n);
  const std::string_view fault = cut_->fault();
  if (!fault.empty()) outcome = failed(fault, now_.t, line);
  return fault.empty();
}

// Ideal axes need no current: the spindle, the cut and constant sources heat. False if the machine
// has become too hot or too cold.
bool IdealRun::heat(const controllers::Trajectory::Sample& sample, Outcome& outcome) {
  HeatInputs now;
  now.spindle = in_.spindle_speeds[sample.move];
  if (cut_) now.cut = cut_->power(now_.dQ_ref);
  if (!heat_->advance(now)) return true;
  setpoint_.read_temperatures(heat_->reading());
  recorder_.use(heat_->errors(), heat_->temperatures());
  const std::string fault = heat_->fault();
  if (!fault.empty()) outcome = failed(fault, now_.t, in_.path.line(in_.pieces[sample.move]));
  return fault.empty();
}

// Moves the structure by one position period, to Q_true.
void IdealRun::bend(const Joints& Q_true) {
  motion_.add(Q_true);
  structure_->advance(motion_.Q(), motion_.dQ(), periods_.position);
}

Joints IdealRun::Q_true_of(const AxisSetpoint& set) {
  if (!feedback_) return set.Q_cmd;
  return at_standstill(set.Q_cmd,
                       [&](const Joints& Q) {
                         if (feedback_->observes()) {
                           now_.Q_fb = Q;
                           feedback_->observe(now_, 0);
                         }
                         return feedback_->settle(Q);
                       })
      .Q;
}

}  // namespace servomill::sim::engine
