#include "sim/identification/nc_loop.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "sim/engine/servo_axes.h"

namespace servomill::sim::identification {
namespace {

// The machine as the fit sees it: encoders that quantise at most, and no supervision.
model::MachineSettings bare(const AxisModel& axis) {
  model::MachineSettings machine = *axis.machine;
  const auto j = static_cast<std::size_t>(axis.joint);
  machine.drives[j] = axis.drive;
  machine.scale[j] = plant::Encoder::with_step(axis.step);
  machine.motor[j] = plant::Encoder::with_step(axis.step / axis.drive.r);
  machine.marks[j].reset();
  machine.nc.functions[j].supervision = {};
  return machine;
}

std::vector<const model::MachineSettings*> pointers(
    const std::vector<model::MachineSettings>& machines) {
  std::vector<const model::MachineSettings*> out;
  for (const model::MachineSettings& machine : machines) out.push_back(&machine);
  return out;
}

Tick ticks_of(const Record& record, const model::MachineSettings& machine) {
  return static_cast<Tick>(std::lround(record.period / machine.nc.periods.base));
}

std::vector<model::Instant> schedule_of(const Record& record,
                                        const model::MachineSettings& machine) {
  std::vector<model::Rate> rates = engine::loop_rates(machine.nc.periods, machine.scale_delay);
  rates.push_back({model::kRecord, ticks_of(record, machine), 0});
  return model::make_schedule(rates);
}

// Up to eight models under one NC's schedule.
class NcModels {
 public:
  NcModels(const Record& record, std::span<const AxisModel> models)
      : record_(record),
        models_(models),
        machines_(machines_of(models)),
        joint_(models.front().joint),
        ticks_(ticks_of(record, machines_.front())),
        schedule_(schedule_of(record, machines_.front())),
        axes_(pointers(machines_), {joint_}, schedule_) {}

  void run(std::span<Simulated> out) {
    start(out);
    const Tick end = ticks_ * static_cast<Tick>(record_.size());
    for (Tick n = 0;;) {
      for (const model::Instant& instant : schedule_) {
        if (n >= end) return finish(out);
        tick(instant.due, n, out);
        axes_.advance(instant.step);
        n += instant.step;
      }
    }
  }

 private:
  static std::vector<model::MachineSettings> machines_of(std::span<const AxisModel> models) {
    std::vector<model::MachineSettings> machines;
    for (const AxisModel& axis : models) machines.push_back(bare(axis));
    return machines;
  }

  void start(std::span<Simulated> out) {
    for (std::size_t l = 0; l < models_.size(); ++l) {
      Joints Q = Joints::Zero();
      Q[joint_] = models_[l].position;
      axes_.settle(Q, Joints::Zero(), l);
      out[l].feedback.resize(record_.size());
      out[l].scale.resize(record_.size());
      out[l].force.resize(record_.size());
    }
  }

  // One instant, in the order of the engine (sim/engine/lockstep.cpp).
  void tick(std::uint8_t due, Tick n, std::span<Simulated> out) {
    const auto k = static_cast<std::size_t>(n / ticks_);
    if (due & model::kRecord) load(k);
    if (due & model::kFeedbackSample) axes_.sample_position_feedback();
    if (due & model::kPositionLoop) {
      follow(k, static_cast<double>(n % ticks_) / static_cast<double>(ticks_));
      axes_.compensate_backlash();
      axes_.close_position_loops();
    }
    if (due & model::kCurrentLoop) axes_.latch_current_commands();
    if (due & model::kVelocityLoop) axes_.close_velocity_loops();
    if (due & model::kRecord) look(k, out);
  }

  void load(std::size_t k) {
    if (record_.disturbance.empty()) return;
    Joints force = Joints::Zero();
    force[joint_] = record_.disturbance[k];
    for (std::size_t l = 0; l < models_.size(); ++l) axes_.load(force, l);
  }

  void follow(std::size_t k, double share) {
    const CommandBetween c = command_between(record_, k, share);
    engine::AxisSetpoint set;
    set.Q_ref[joint_] = set.Q_cmd[joint_] = c.q;
    set.dQ_ff[joint_] = c.dq;
    set.ddQ_ff[joint_] = c.ddq;
    for (std::size_t l = 0; l < models_.size(); ++l) axes_.follow(set, l);
  }

  void look(std::size_t k, std::span<Simulated> out) {
    for (std::size_t l = 0; l < models_.size(); ++l) {
      const plant::FeedDriveParams& drive = models_[l].drive;
      const LoopSettings& loop = models_[l].loop;
      const double late = loop.feedback_delay * axes_.dQ_true(l)[joint_];
      const Joints current = drive.current_is_command() ? axes_.command(l) : axes_.current(l);
      out[l].scale[k] = axes_.Q_true(l)[joint_] - late;
      out[l].feedback[k] = axes_.Q_fb(l)[joint_] - late + loop.feedback_offset;
      out[l].force[k] = current[joint_] * drive.Kt / drive.r;
    }
  }

  void finish(std::span<Simulated> out) const {
    for (std::size_t l = 0; l < models_.size(); ++l) {
      out[l].resolved = std::isfinite(out[l].feedback.back());
    }
  }

  const Record& record_;
  std::span<const AxisModel> models_;
  std::vector<model::MachineSettings> machines_;
  int joint_;
  Tick ticks_;
  std::vector<model::Instant> schedule_;
  engine::ServoAxes axes_;
};

}  // namespace

CommandBetween command_between(const Record& record, std::size_t k, double share) {
  const std::vector<double>& q = record.command;
  const auto at = [&](std::ptrdiff_t n) {
    const auto last = static_cast<std::ptrdiff_t>(q.size()) - 1;
    return q[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(n, 0, last))];
  };
  const auto n = static_cast<std::ptrdiff_t>(k);
  const double a = at(n - 1), b = at(n), c = at(n + 1), d = at(n + 2), T = record.period;
  if (share == 0.0) return {b, 0.5 * (c - a) / T, (c - 2.0 * b + a) / (T * T)};
  // Hermite's cubic with the central differences as slopes; the curvature between those of the ends
  const double u = share, slope_b = 0.5 * (c - a), slope_c = 0.5 * (d - b);
  const double p2 = 3.0 * (c - b) - 2.0 * slope_b - slope_c, p3 = 2.0 * (b - c) + slope_b + slope_c;
  const double curvature = (1.0 - u) * (c - 2.0 * b + a) + u * (d - 2.0 * c + b);
  return {b + u * (slope_b + u * (p2 + u * p3)), (slope_b + u * (2.0 * p2 + u * 3.0 * p3)) / T,
          curvature / (T * T)};
}

void simulate_nc(const Record& record, std::span<const AxisModel> models,
                 std::span<Simulated> out) {
  assert(!record.command.empty());
  NcModels(record, models).run(out);
}

}  // namespace servomill::sim::identification
