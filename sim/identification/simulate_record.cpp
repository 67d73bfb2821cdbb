#include "sim/identification/simulate_record.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "plant/drives/drive_bank.h"
#include "plant/sensing/quantise.h"
#include "sim/identification/nc_loop.h"
#include "sim/system/worker_thread.h"

namespace servomill::sim::identification {
namespace {

constexpr Tick kTicksPerPart = 16;  // the ladder of sub-steps reaches that far down
// Parts of a period within which the force is the mean of what acts there: the moment of an
// impulse is off by no more than h^2 / 8 dF / M, some 1e-9 m.
constexpr int kPartsWithDeadTime = 2;

bool has_dead_time(std::span<const AxisModel> models) {
  return std::any_of(models.begin(), models.end(),
                     [](const AxisModel& m) { return m.loop.dead_time > 0.0; });
}

// Bristles of a slide that moves are deflected as they are at that speed.
double settled_bristles(const plant::FrictionParams& f, double speed) {
  if (f.kind != plant::FrictionKind::lugre || speed == 0.0) return 0.0;
  const double g = plant::sliding_force(f, speed > 0.0, speed);
  return (speed > 0.0 ? g : -g) / f.sigma0;
}

plant::LaneState state_at_start(const AxisModel& model, double force) {
  plant::LaneState s = plant::at_rest(model.drive, model.position);
  const plant::FeedDriveParams& d = model.drive;
  s.v = model.speed;
  s.w = model.speed / d.r;
  if (!std::isnan(force)) s.i = force * d.r / d.Kt;
  s.z = settled_bristles(d.friction, model.speed);
  if (model.speed != 0.0) {
    s.slide = model.speed > 0.0 ? plant::SlideMode::positive : plant::SlideMode::negative;
  }
  return s;
}

// Derivatives of the command at a sample, by differences.
struct Command {
  double q, dq, ddq;
};
Command command_at(const Record& record, std::size_t k) {
  const std::vector<double>& q = record.command;
  const std::size_t before = k == 0 ? 0 : k - 1, after = std::min(k + 1, q.size() - 1);
  const double T = record.period;
  const double dq =
      (q[after] - q[before]) / (T * static_cast<double>(std::max<std::size_t>(after - before, 1)));
  const bool inside = after == k + 1 && before + 1 == k;
  return {q[k], dq, inside ? (q[after] - 2.0 * q[k] + q[before]) / (T * T) : 0.0};
}

double quantised(double x, double step) { return step > 0.0 ? step * std::round(x / step) : x; }

// Up to eight models.
class EightModels {
 public:
  EightModels(const Record& record, std::span<const AxisModel> models)
      : record_(record),
        models_(models),
        parts_(has_dead_time(models) ? kPartsWithDeadTime : 1),
        bank_(drives_of(models), record.period / (kTicksPerPart * parts_),
              std::vector<Tick>{kTicksPerPart}),
        state_(models.size()),
        input_(models.size()),
        loop_(loops_of(models)) {
    loop_.set_parts(parts_);
  }

  void run(std::span<Simulated> out) {
    start(out);
    const PossiblePositions possible = possible_positions(record_, !is_open());
    for (std::size_t k = 0; k < record_.size(); ++k) {
      look(k, out);
      if (std::none_of(out.begin(), out.end(),
                       [&](const Simulated& one) { return possible.contain(one.feedback[k]); })) {
        break;
      }
      close_loop(k);
      for (std::size_t l = 0; l < models_.size(); ++l) out[l].force[k] = loop_.force()[l];
      move(k);
    }
    for (std::size_t l = 0; l < models_.size(); ++l) {
      out[l].resolved = plant::DriveBank::unresolved(state_, l) == 0;
    }
  }

 private:
  static std::vector<plant::FeedDriveParams> drives_of(std::span<const AxisModel> models) {
    std::vector<plant::FeedDriveParams> drives;
    for (const AxisModel& model : models) drives.push_back(model.drive);
    return drives;
  }
  static std::vector<LoopSettings> loops_of(std::span<const AxisModel> models) {
    std::vector<LoopSettings> loops;
    for (const AxisModel& model : models) loops.push_back(model.loop);
    return loops;
  }
  bool is_open() const { return models_.front().loop.kind == LoopKind::open; }

  void start(std::span<Simulated> out) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double force = record_.force.empty() ? nan : record_.force.front();
    for (std::size_t l = 0; l < models_.size(); ++l) {
      const AxisModel& m = models_[l];
      state_.set_lane(l, state_at_start(m, force));
      loop_.start(l, m.position, m.speed, force);
      out[l].feedback.resize(record_.size());
      out[l].scale.resize(record_.size());
      out[l].force.resize(record_.size());
    }
    input_.blocks.front().active.fill(false);
    for (std::size_t l = 0; l < models_.size(); ++l) input_.blocks.front().active[l] = true;
  }

  void look(std::size_t k, std::span<Simulated> out) const {
    const plant::DriveBlock& s = state_.blocks.front();
    for (std::size_t l = 0; l < models_.size(); ++l) {
      const LoopSettings& loop = models_[l].loop;
      const bool by_motor = loop.position_feedback == PositionSource::motor;
      const double x = s.x[l] - loop.feedback_delay * s.v[l];
      out[l].scale[k] = quantised(x, models_[l].step);
      out[l].feedback[k] = quantised(by_motor ? x + s.delta[l] : x, models_[l].step);
      out[l].feedback[k] += loop.feedback_offset;
    }
  }

  void close_loop(std::size_t k) {
    if (is_open()) return loop_.force_sample(recorded_force(k));
    const Command c = command_at(record_, k);
    const plant::DriveBlock& s = state_.blocks.front();
    LaneArray feedback{}, motor{};
    for (std::size_t l = 0; l < models_.size(); ++l) {
      const double scale = quantised(s.x[l], models_[l].step);
      motor[l] = quantised(s.x[l] + s.delta[l], models_[l].step);
      const bool by_motor = models_[l].loop.position_feedback == PositionSource::motor;
      feedback[l] = by_motor ? motor[l] : scale;
    }
    loop_.sample(c.q, c.dq, c.ddq, feedback, motor);
  }

  // Force by a recorded current and the torque constant of each model.
  LaneArray recorded_force(std::size_t k) const {
    LaneArray force{};
    for (std::size_t l = 0; l < models_.size(); ++l) {
      const plant::FeedDriveParams& drive = models_[l].drive;
      const double factor =
          record_.force_per_current > 0.0 ? drive.Kt / (drive.r * record_.force_per_current) : 1.0;
      force[l] = factor * (record_.force[k] - models_[l].loop.force_offset);
    }
    return force;
  }

  void move(std::size_t k) {
    plant::DriveInputBlock& in = input_.blocks.front();
    in.F.fill(record_.disturbance.empty() ? 0.0 : -record_.disturbance[k]);
    for (int part = 0; part < parts_; ++part) {
      const LaneArray force = loop_.acting(part);
      for (std::size_t l = 0; l < models_.size(); ++l) {
        in.command[l] = force[l] * models_[l].drive.r / models_[l].drive.Kt;
      }
      bank_.advance(state_, input_, kTicksPerPart);
    }
  }

  const Record& record_;
  std::span<const AxisModel> models_;
  int parts_;
  plant::DriveBank bank_;
  plant::DriveState state_;
  plant::DriveInput input_;
  SampledLoop loop_;
};

}  // namespace

std::vector<Simulated> simulate(const Record& record, std::span<const AxisModel> models,
                                unsigned threads) {
  std::vector<Simulated> out(models.size());
  const std::size_t blocks = blocks_of(models.size());
  const bool has_loop = !models.empty() && models.front().loop.kind != LoopKind::open;
  const PossiblePositions possible = possible_positions(record, has_loop);
  system::for_each_index(blocks, system::thread_count(threads), [&](std::size_t block) {
    const std::size_t first = block * kLaneWidth;
    const std::size_t count = std::min(kLaneWidth, models.size() - first);
    const auto some = models.subspan(first, count);
    const auto into = std::span(out).subspan(first, count);
    if (some.front().loop.kind == LoopKind::nc) {
      simulate_nc(record, some, into);
    } else {
      EightModels(record, some).run(into);
    }
    for (Simulated& one : into) {
      one.diverges = !std::all_of(one.feedback.begin(), one.feedback.end(),
                                  [&](double x) { return possible.contain(x); });
    }
  });
  return out;
}

}  // namespace servomill::sim::identification
