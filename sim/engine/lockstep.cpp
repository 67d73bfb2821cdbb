#include "sim/engine/lockstep.h"

namespace servomill::sim::engine {
namespace {

std::vector<const model::MachineSettings*> machines_of(std::span<CaseInputs* const> together) {
  std::vector<const model::MachineSettings*> machines;
  for (const CaseInputs* in : together) machines.push_back(&in->machine);
  return machines;
}

}  // namespace

std::vector<model::Rate> rates_of(const CaseInputs& in) {
  const Tick delay =
      in.machine.scale_delay + (in.hardware.connected ? in.hardware.signal_delay : 0);
  std::vector<model::Rate> rates = loop_rates(in.machine.nc.periods, delay);
  rates.push_back({model::kRecord, in.record_period, 0});
  if (in.teeth != nullptr) rates.push_back({model::kToothStep, in.tooth_step, 0});
  if (in.feedback) rates.push_back({model::kErrorModel, in.hardware.model_period, 0});
  return rates;
}

Lockstep::Lockstep(std::span<CaseInputs* const> together, plant::PreparedDrives* kept)
    : schedule_(model::make_schedule(rates_of(*together.front()))),
      axes_(machines_of(together), together.front()->machine.joints(), schedule_, kept) {
  for (std::size_t first = 0; first < together.size(); first += kLaneWidth) {
    feedbacks_.emplace_back(axes_, first);
  }
  for (std::size_t run = 0; run < together.size(); ++run) {
    CaseInputs& in = *together[run];
    runs_.push_back(std::make_unique<CaseRun>(in, axes_, feedbacks_[run / kLaneWidth], run,
                                              references_, schedule_));
    longest_ = std::max(longest_, runs_.back()->end());
    any_remembers_travel_ |= runs_.back()->remembers_travel();
    any_adds_velocity_ |= runs_.back()->adds_velocity();
    any_bends_ |= runs_.back()->bends();
  }
}

std::vector<CaseResult> Lockstep::run(const StopFlag& stop, std::atomic<float>& progress) {
  std::vector<CaseResult> results(runs_.size());
  for (Tick n = 0;;) {  // until the last has ended
    progress.store(static_cast<float>(n) / static_cast<float>(longest_), std::memory_order_relaxed);
    if (stop.load(std::memory_order_relaxed)) {
      each([&](CaseRun& run) { run.interrupt(n); });
      next_end_ = n;
    }
    for (const model::Instant& instant : schedule_) {
      if (take_out_those_done(n, results)) return results;
      tick(instant.due, n);
      axes_.advance(instant.step, [&] { evaluate_error_models(); });
      if (any_bends_) bend_structures(instant.step);
      n += instant.step;
    }
  }
}

// One instant: encoders, virtual encoder, NC loops (each sees the one before), recorder; then the
// drives move on.
void Lockstep::tick(std::uint8_t due, Tick n) {
  if (due & (model::kErrorModel | model::kRecord)) axes_.read_scales();
  if (due & model::kErrorModel) evaluate_error_models();  // acts one model period later
  if (due & model::kFeedbackSample) {                     // scale + virtual displacement
    apply_virtual_displacements();
    axes_.sample_position_feedback();
  }
  if (due & model::kPositionLoop) {  // interpolator, setpoint corrections, position loop
    command_axes(n);
    axes_.compensate_backlash();
    add_velocities(n);  // of strategies, to the velocity commands
    axes_.close_position_loops();
    if (!axes_.within_limits()) stop_faulty_axes(n);
  }
  if (due & model::kToothStep) turn_teeth(n);
  if (due & model::kCurrentLoop) axes_.latch_current_commands();  // of the velocity period before
  if (due & model::kVelocityLoop) {
    axes_.close_velocity_loops();
    track_axis_reversals();
  }
  if (due & model::kRecord) record(n);
}

void Lockstep::evaluate_error_models() {
  for (FeedbackLanes& feedback : feedbacks_) feedback.evaluate_error_models();
}

void Lockstep::apply_virtual_displacements() {
  for (FeedbackLanes& feedback : feedbacks_) feedback.apply_virtual_displacements();
}

void Lockstep::command_axes(Tick n) {
  each([&](CaseRun& run) {
    if (!run.command_axes(n)) next_end_ = n;
  });
}

void Lockstep::add_velocities(Tick n) {
  if (!any_adds_velocity_) return;
  each([&](CaseRun& run) {
    if (!run.add_velocity(n)) next_end_ = n;
  });
}

void Lockstep::stop_faulty_axes(Tick n) {
  each([&](CaseRun& run) {
    if (!run.supervise(n)) next_end_ = n;
  });
}

void Lockstep::turn_teeth(Tick n) {
  each([&](CaseRun& run) { run.turn_teeth(n); });
}

void Lockstep::track_axis_reversals() {
  if (any_remembers_travel_) each([](CaseRun& run) { run.track_axis_reversals(); });
}

void Lockstep::record(Tick n) {
  each([&](CaseRun& run) { run.record(n); });
}

void Lockstep::bend_structures(Tick step) {
  each([&](CaseRun& run) {
    if (run.bends()) run.bend(step);
  });
}

// Takes out the runs that end before n; true if none is left.
bool Lockstep::take_out_those_done(Tick n, std::vector<CaseResult>& results) {
  if (n < next_end_) return false;
  next_end_ = std::numeric_limits<Tick>::max();
  bool none_left = true;
  for (std::size_t run = 0; run < runs_.size(); ++run) {
    if (!runs_[run]) continue;
    if (runs_[run]->goes_on_at(n)) {
      next_end_ = std::min(next_end_, runs_[run]->end() + 1);
      none_left = false;
      continue;
    }
    results[run] = runs_[run]->finish(n);
    runs_[run].reset();
  }
  return none_left;
}

}  // namespace servomill::sim::engine
