#include "sim/engine/case_run.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "sim/engine/recorded_signals.h"

namespace servomill::sim::engine {
namespace {

std::optional<plant::InertialDeflection> structure_of(const model::MachineSettings& machine,
                                                      const std::vector<model::Instant>& schedule) {
  if (machine.inertial_compliances.empty()) return std::nullopt;
  std::vector<Tick> steps;
  for (const model::Instant& instant : schedule) steps.push_back(instant.step);
  return plant::InertialDeflection(machine.inertial_compliances, machine.nc.periods.base, steps);
}

Joints position_gains(const model::NcSettings& nc) {
  Joints Kv;
  for (int j = 0; j < kJoints; ++j) Kv[j] = nc.cascade[static_cast<std::size_t>(j)].Kv;
  return Kv;
}

DemandMeter demand_meter(const CaseInputs& in) {
  const model::NcSettings& nc = in.machine.nc;
  const double period = nc.periods.seconds(nc.periods.position);
  const bool from_readings = in.feedback != nullptr || !in.position_loop_terms.empty();
  return DemandMeter(period, from_readings ? periods_of_readings(position_gains(nc), period) : 1);
}

}  // namespace

CaseRun::CaseRun(CaseInputs& in, ServoAxes& axes, FeedbackLanes& feedback, std::size_t run,
                 References& references, const std::vector<model::Instant>& schedule)
    : in_(in),
      nc_(in.machine.nc),
      axes_(axes),
      feedback_(feedback),
      run_(run),
      setpoint_(nc_, in.reference, std::move(in.setpoints)),
      reference_(references.of(in.reference, 0.0)),
      recorded_(references.of(in.reference, setpoint_.delay())),
      recorder_(in.machine, in.machine_errors, in.imposed, in.path, in.tips, in.format,
                in.program_displaces_rotary, in.recorded_corrections, in.cutting != nullptr,
                in.keeping, in.teeth != nullptr, in.records_orientation, in.windows, in.outputs),
      travel_(in.machine_errors, Joints::Zero()),
      structure_(structure_of(in.machine, schedule)),
      on_bed_(stands_on_bed(in.machine)),
      demands_(demand_meter(in)),
      by_loops_(position_gains(nc_), nc_.periods.seconds(nc_.periods.position)) {
  end_ =
      static_cast<Tick>(std::ceil((in.reference.duration() + in.settle_time) / nc_.periods.base));
  if (in.outputs.last_ticks) last_ticks_.emplace(in.machine.joints());
  recorder_.expect(static_cast<std::size_t>(end_ / in.record_period + 1));
  if (in.machine.heat) {
    heat_ = std::make_unique<HeatRun>(in.machine, *in.component_errors, in.known_heat);
    setpoint_.read_temperatures(heat_->reading());
    recorder_.use(heat_->errors(), heat_->temperatures());
  }
  initialise_at_rest();
  if (in.stops_with.empty()) return;
  result_.outcome = stopped_at_begin(in.stops_with);
  record(0);
}

bool CaseRun::command_axes(Tick n) {
  const double t = nc_.periods.seconds(n);
  const auto& reference = reference_.at(t);
  setpoint_.advance(reference, t, setpoint_.corrects() ? axes_.Q_fb(run_) : Joints::Zero());
  if (in_.feedback) feedback_.set_reference(run_, set_, reference.s);
  if (last_ticks_) {
    last_ticks_->keep(t, set_.Q_cmd, axes_.Q_fb(run_), axes_.Q_true(run_), axes_.current(run_));
  }
  axes_.follow(set_, run_);
  if (in_.outputs.demands) note_demands(t);
  if (cut_) apply_cutting_force(n);
  if (cut_ && !cut_->fault().empty()) return stop_with(cut_->fault(), t);
  if (heat_ && n > 0 && !heat(n)) return false;
  std::string_view failure = setpoint_.failure();
  if (failure.empty() && in_.feedback) failure = feedback_.failure(run_);
  return failure.empty() || stop_with(failure, t);
}

// Offset that the position loops are to follow without feed-forward; an axis moves against its
// virtual displacement.
Joints CaseRun::lagging_offset() const {
  const Joints offset = set_.Q_cmd - set_.Q_ref - setpoint_.fed_forward();
  return in_.feedback ? Joints(offset - axes_.virtual_displacement(run_)) : offset;
}

void CaseRun::note_demands(double t) {
  const Joints& lagging = by_loops_.advance(lagging_offset(), added_velocity_);
  demands_.add(t, set_.Q_ref, setpoint_.fed_forward() + lagging);
}

bool CaseRun::add_velocity(Tick n) {
  if (!adds_velocity() || !result_.outcome.finished) return result_.outcome.finished;
  const double t = nc_.periods.seconds(n);
  const strategies::Reading now = reading_at(t);
  Joints sum = Joints::Zero();
  for (const PositionLoopTerm& term : in_.position_loop_terms) {
    const Joints velocity = term.part->velocity(now);
    if (const auto failure = term.part->failure(); !failure.empty()) return stop_with(failure, t);
    const std::string why = why_implausible(term, velocity, in_.machine);
    if (!why.empty()) return stop_with(why, t);
    sum += velocity;
  }
  axes_.add_velocity(sum, run_);
  added_velocity_ = sum;
  return true;
}

bool CaseRun::supervise(Tick n) {
  const auto fault = axes_.supervise(run_);
  if (!fault || !result_.outcome.finished) return result_.outcome.finished;
  Outcome& outcome = result_.outcome;
  outcome.finished = false;
  outcome.axis = in_.machine.chain.layout.letter_of(fault->joint);
  outcome.time = nc_.periods.seconds(n);
  outcome.reason =
      fmt::format("axis {}: {} at {:.4f} s", outcome.axis, fault->reason, outcome.time);
  return false;
}

void CaseRun::record(Tick n) {
  // The reference of this very instant: between position periods the held one is older than
  // Q_true.
  const auto& reference = recorded_.at(nc_.periods.seconds(n));
  Snapshot& now = snapshot_;
  now.time = nc_.periods.seconds(n);
  now.s = reference.s;
  now.piece = in_.pieces[reference.move];
  now.Q_ref = reference.Q_ref;
  now.Q_true = axes_.Q_true(run_);
  if (recorder_.wants_axes()) note_axes(now);
  if (cut_) cut_->note(now);
  if (structure_) {
    now.inertial_deflection = inertial_deflection();
  }
  if (on_bed_) now.bed = axes_.bed(run_).head<kLinearJoints>();
  recorder_.record(now, travel_.at(now.Q_true));
}

// Notes what is recorded of the axes and their loops.
void CaseRun::note_axes(Snapshot& now) const {
  now.Q_cmd = set_.Q_cmd;
  now.Q_fb = axes_.Q_fb(run_);
  now.Q_meas = axes_.Q_meas(run_);
  now.dQ_true = axes_.dQ_true(run_);
  now.current = axes_.current(run_);
  for (const int j : axes_.joints()) {
    now.torque[j] = in_.machine.drives[static_cast<std::size_t>(j)].Kt * now.current[j];
  }
}

// Deflection of the structure under acceleration of the axes (3; m).
Eigen::Vector3d CaseRun::inertial_deflection() const {
  if (!structure_) return Eigen::Vector3d::Zero();
  return structure_->at(structure_->needs_acceleration() ? axes_.ddQ_true(run_)
                                                         : Joints::Zero().eval());
}

void CaseRun::interrupt(Tick n) { result_.outcome = interrupted(nc_.periods.seconds(n)); }

// Reading of a position period, for strategies.
strategies::Reading CaseRun::reading_at(double t) {
  return {t, reference_.at(t).s, set_.Q_ref, set_.dQ_ff, set_.ddQ_ff, axes_.Q_fb(run_), set_.Q_cmd};
}

bool CaseRun::stop_with(std::string_view why, double t) {
  const int line = in_.path.line(in_.pieces[reference_.at(t).move]);
  result_.outcome = failed(why, t, line);
  return false;
}

CaseResult CaseRun::finish(Tick n) {
  if (in_.feedback) result_.saturations = feedback_.drop(run_);
  axes_.end(run_);
  result_.simulated_time = nc_.periods.seconds(n);
  result_.servo = recorder_.take();
  result_.left_out = recorder_.left_out();
  result_.demands = demands_.demands();
  if (heat_) std::move(*heat_).take_courses(result_);
  if (cut_) result_.off_path = cut_->off_path();
  if (last_ticks_ && !result_.outcome.finished) {
    result_.last_ticks = last_ticks_->series(in_.machine.chain.layout);
  }
  return std::move(result_);
}

void CaseRun::apply_cutting_force(Tick n) {
  if (in_.displaced_cuts != nullptr) {
    cut_->deviate(recorded_.at(nc_.periods.seconds(n)), axes_.Q_true(run_), inertial_deflection());
  }
  cut_->advance(recorded_.at(nc_.periods.seconds(n)), nc_.periods.seconds(n));
  if (!has_teeth()) axes_.load(cut_->load(), run_);
}

void CaseRun::turn_teeth(Tick n) {
  cut_->turn(n);
  axes_.load(cut_->load(), run_);
}

// False if the machine has become too hot or too cold.
bool CaseRun::heat(Tick n) {
  const auto& reference = recorded_.at(nc_.periods.seconds(n));
  HeatInputs now;
  now.current = axes_.current(run_);
  for (const int j : axes_.joints()) {
    now.torque[j] = in_.machine.drives[static_cast<std::size_t>(j)].Kt * now.current[j];
  }
  now.dQ = axes_.dQ_true(run_);
  if (cut_) {
    now.load = cut_->load();
    now.cut = cut_->power(now.dQ);
  }
  now.spindle = in_.spindle_speeds[reference.move];
  if (!heat_->advance(now)) return true;
  setpoint_.read_temperatures(heat_->reading());
  recorder_.use(heat_->errors(), heat_->temperatures());
  const std::string fault = heat_->fault();
  return fault.empty() || stop_with(fault, nc_.periods.seconds(n));
}

// In steady state at the start: position feedback agrees with the setpoint.
void CaseRun::initialise_at_rest() {
  setpoint_.settle();
  Standstill rest{set_.Q_cmd};
  if (in_.feedback) {
    feedback_.add(run_, *in_.feedback, model_period_of(in_));
    feedback_.set_reference(run_, set_, reference_.at(0.0).s);
    rest = at_standstill(set_.Q_cmd, [&](const Joints& Q) { return feedback_.settle(run_, Q); });
  }
  axes_.settle(rest.Q, rest.d, run_);
  by_loops_.start(lagging_offset());
  demands_.start(set_.Q_ref, rest.Q - set_.Q_ref);
  for (const PositionLoopTerm& term : in_.position_loop_terms) term.part->settle(reading_at(0.0));
  if (in_.cutting != nullptr) cut_.emplace(in_).start(recorded_.at(0.0));
  if (structure_) structure_->start(axes_.Q_true(run_));
  travel_ = {in_.machine_errors, axes_.Q_true(run_)};
}

}  // namespace servomill::sim::engine
