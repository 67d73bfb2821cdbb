#include "sim/run/day_course.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "plant/sensing/noise.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "sim/engine/heat_run.h"
#include "sim/evaluation/quantity.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/model/working_day.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/preparation/prepared_case.h"
#include "sim/run/cycle_powers.h"
#include "sim/run/day_correction.h"

namespace servomill::sim::run {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kLongStep = 60.0;           // s, of the network while powers are constant
constexpr std::uint32_t kNoiseOfDay = 1000;  // first stream; those of runs come before
constexpr double kHour = 3600.0;             // s
constexpr int kPathPlaces = 200;             // at which a cycle is judged

struct PathPlace {
  Joints Q;
  Vector3d p_ST;
};

// Places along the programmed path, equally spaced.
std::vector<PathPlace> places_along(const preparation::PreparedParts& parts,
                                    const JointLayout& layout) {
  const engine::ProgramPath& path = parts.program.path;
  std::vector<PathPlace> out;
  std::size_t piece = 0;
  Joints near = Joints::Zero();
  for (int n = 0; n < kPathPlaces; ++n) {
    const double s = path.length() * (n + 0.5) / kPathPlaces;
    while (piece + 1 < path.size() && path.s_end(piece) < s) ++piece;
    near = path.joints(piece, s, layout, near);
    const auto tip = parts.program.tips.find(path.tool_offset(piece));
    out.push_back({near, tip == parts.program.tips.end() ? Vector3d::Zero() : tip->second});
  }
  return out;
}

// Surroundings are linear within a step: a hundredth of their period at most.
double long_step(const model::HeatSettings& heat) {
  double step = kLongStep;
  for (const plant::Surroundings& one : heat.network.surroundings) {
    if (one.amplitude > 0.0) step = std::min(step, 0.01 * one.period);
  }
  return step;
}

class Day {
 public:
  Day(const preparation::PreparedParts& parts, const engine::CaseResult& cycle, double duration)
      : day_(*parts.scenario.day),
        machine_(parts.scenario.machine_of(parts.spec)),
        heat_(*machine_.heat),
        sources_(machine_),
        network_(engine::network_at_start(machine_)),
        path_(places_along(parts, machine_.chain.layout)),
        cycle_(averaged(cycle.heat)),
        duration_(duration),
        long_step_(long_step(heat_)),
        power_(VectorXd::Zero(static_cast<Index>(heat_.network.bodies.size()))),
        correction_(parts, averaged(cycle.known_heat)),
        now_(errors_now()),
        at_start_(errors_now()) {
    for (const auto& body : heat_.network.bodies) out_.bodies.push_back(body.name);
    for (const auto& place : day_.places) out_.places.push_back(place.name);
    for (const auto& sensor : heat_.sensors) out_.sensors.push_back(sensor.name);
    out_.temperatures.resize(out_.bodies.size());
    out_.readings.resize(out_.sensors.size());
    out_.drift.resize(out_.places.size());
    correction_.begin(network_.temperatures());
    for (const auto& place : day_.places) place_at_start_.push_back(displaced(place.Q, place.p_ST));
    for (const auto& place : path_) path_at_start_.push_back(displaced(place.Q, place.p_ST));
  }

  DayCourse run() {
    read();
    for (const model::DayPhase& phase : day_.phases) {
      if (!out_.stopped.empty()) break;
      run(phase);
      if (out_.time.back() < t_) read();
    }
    for (std::size_t k = 0; k < day_.places.size(); ++k) out_.ranges.push_back(range_of(k));
    return std::move(out_);
  }

 private:
  void run(const model::DayPhase& phase) {
    switch (phase.activity) {
      case model::Activity::idle:
        rest(phase.duration, 0.0);
        return;
      case model::Activity::spindle:
        rest(phase.duration, phase.spindle);
        return;
      case model::Activity::program:
        for (int n = 0; n < phase.cycles && out_.stopped.empty(); ++n) {
          remeasure();
          if (out_.stopped.empty()) run_cycle();
        }
        return;
      case model::Activity::probe:
        take_datum(phase.place);
        return;
    }
  }

  // Constant powers, from reading to reading.
  // @param spindle  rad/s
  void rest(double duration, double spindle) {
    engine::HeatInputs inputs;
    inputs.spindle = spindle;
    sources_.powers(inputs, power_);
    correction_.use(inputs);
    const double end = t_ + duration;
    while (t_ < end && out_.stopped.empty()) {
      advance(std::min({end, next_reading_, t_ + long_step_}) - t_);
    }
  }

  // A datum, if the last one is too old.
  void remeasure() {
    if (!day_.remeasuring) return;
    const double last = out_.datums.empty() ? 0.0 : out_.datums.back();
    if (t_ - last < day_.remeasuring->every) return;
    rest(day_.remeasuring->duration, 0.0);
    out_.measuring += day_.remeasuring->duration;
    take_datum(day_.remeasuring->place);
  }

  void take_datum(int number) {
    const auto k = static_cast<std::size_t>(number);
    const model::DayPlace& place = day_.places[k];
    now_ = errors_now();
    datum_ = displaced(place.Q, place.p_ST) - place_at_start_[k] + probe_noise();
    out_.datums.push_back(t_);
  }

  // Along X, Y, Z of the workpiece (m).
  Vector3d probe_noise() const {
    const auto channel = [&](std::uint32_t n) {
      return plant::white_noise({day_.noise_seed}, n, static_cast<Tick>(out_.datums.size()));
    };
    const auto xy = channel(0), z = channel(1);
    return day_.probe_noise * Vector3d(xy[0], xy[1], z[0]);
  }

  void run_cycle() {
    throw_if_interrupted();
    judge_cycle();
    const double end = t_ + duration_;
    for (std::size_t n = 0; n < cycle_.size(); ++n) {
      power_ = cycle_[n].power;
      correction_.use(n);
      advance_to(std::min(end, t_ + cycle_[n].length));
    }
    advance_to(end);  // less than a step of the recorded powers
  }

  void advance_to(double end) {
    if (next_reading_ < end) advance(next_reading_ - t_);
    if (out_.stopped.empty()) advance(end - t_);
  }

  void advance(double h) {
    if (!(h > 0.0)) return;
    network_.advance(heat_.clock + t_, h, power_);
    correction_.advance(heat_.clock + t_, h, network_.temperatures());
    t_ += h;
    if (t_ >= next_reading_) read();
    out_.stopped = engine::fault_of(heat_, network_.temperatures());
    if (out_.stopped.empty()) out_.stopped = correction_.failure();
    if (!out_.stopped.empty()) {
      out_.stopped += fmt::format(", {:.2f} h after the start", t_ / kHour);
    }
  }

  // Temperatures, and drift at all places.
  void read() {
    out_.time.push_back(t_);
    next_reading_ = day_.sample * (std::floor(t_ / day_.sample + 1e-9) + 1.0);
    if (t_ < kHour) next_reading_ = std::min(next_reading_, kHour);  // a range of ISO 230-3
    for (std::size_t i = 0; i < out_.bodies.size(); ++i) {
      out_.temperatures[i].push_back(network_.temperatures()[static_cast<Index>(i)]);
    }
    const auto reading = static_cast<Tick>(out_.time.size());
    const auto sensed = engine::readings_of(heat_, network_.temperatures(), reading, kNoiseOfDay);
    for (std::size_t i = 0; i < sensed.size(); ++i) out_.readings[i].push_back(sensed[i]);
    now_ = errors_now();
    for (std::size_t k = 0; k < day_.places.size(); ++k) {
      out_.drift[k].push_back(in_machine_axes(k));
    }
  }

  // Along and about the axes of the machine: the linear axes have the directions J in W, and a tool
  // axis k that changes by dk turns by k x dk.
  std::array<double, kDrifts> in_machine_axes(std::size_t k) {
    const model::DayPlace& place = day_.places[k];
    const Eigen::Matrix3d J = plant::linear_jacobian(machine_.chain, place.Q);
    const Vector3d axis = plant::forward(machine_.chain, place.Q, place.p_ST).k_W;
    const Vector3d tilt =
        now_.error(place.Q, place.p_ST).dk_W - at_start_.error(place.Q, place.p_ST).dk_W;
    const Vector3d shift = J.transpose() * (displaced(place.Q, place.p_ST) - place_at_start_[k]);
    const Vector3d turn = J.transpose() * axis.cross(tilt);
    return {shift.x(), shift.y(), shift.z(), turn.x(), turn.y(), turn.z()};
  }

  // Displacement of the tip (3; m) by errors `now_` and what the strategies make of it.
  Vector3d displaced(const Joints& Q, const Vector3d& p_ST) {
    return now_.error(Q, p_ST).dp_W +
           plant::linear_jacobian(machine_.chain, Q) * correction_.offset(Q).head<kLinearJoints>();
  }

  void judge_cycle() {
    now_ = errors_now();
    DayCycle cycle{t_, 0.0, 0.0};
    for (std::size_t n = 0; n < path_.size(); ++n) {
      const Vector3d d = displaced(path_[n].Q, path_[n].p_ST) - path_at_start_[n] - datum_;
      cycle.rms += d.squaredNorm() / kPathPlaces;
      cycle.most = std::max(cycle.most, d.norm());
    }
    cycle.rms = std::sqrt(cycle.rms);
    out_.cycles.push_back(cycle);
  }

  plant::VolumetricModel errors_now() const {
    return {machine_.chain,
            plant::at_temperatures({}, heat_.errors, network_.temperatures(), heat_.reference)};
  }

  DriftRange range_of(std::size_t place) const {
    constexpr double kRounding = 1e-13;  // m, rad
    DriftRange out{out_.places[place], {}, {}, {}};
    for (std::size_t c = 0; c < kDrifts; ++c) {
      double least = 0.0, most = 0.0;
      for (std::size_t n = 0; n < out_.time.size(); ++n) {
        const double d = out_.drift[place][n][c];
        if (d < least - kRounding || d > most + kRounding) out.reached[c] = out_.time[n];
        least = std::min(least, d);
        most = std::max(most, d);
        if (out_.time[n] <= kHour) out.first_hour[c] = most - least;
      }
      out.whole[c] = most - least;
    }
    return out;
  }

  const model::WorkingDay& day_;
  const model::MachineSettings& machine_;
  const model::HeatSettings& heat_;
  engine::HeatSources sources_;
  plant::ThermalNetwork network_;
  std::vector<PathPlace> path_;
  std::vector<PowerStep> cycle_;
  double duration_, long_step_;
  VectorXd power_;
  DayCorrection correction_;
  plant::VolumetricModel now_;  // errors at the temperatures of the last look
  plant::VolumetricModel at_start_;
  std::vector<Vector3d> place_at_start_, path_at_start_;  // m, displaced()
  Vector3d datum_ = Vector3d::Zero();
  double t_ = 0.0, next_reading_ = 0.0;
  DayCourse out_;
};

}  // namespace

bool is_day_asked_for(const model::Scenario& scenario) {
  return std::any_of(scenario.quantities.begin(), scenario.quantities.end(), [](const auto& one) {
    return evaluation::quantity_entry(one.name).needs_day;
  });
}

evaluation::DayFigures figures_of(const DayCourse& day) {
  evaluation::DayFigures out;
  out.measuring = day.measuring;
  double squares = 0.0;
  for (const DayCycle& cycle : day.cycles) {
    squares += cycle.rms * cycle.rms;
    out.largest = std::max(out.largest, cycle.most);
  }
  out.rms = std::sqrt(squares / static_cast<double>(day.cycles.size()));
  return out;
}

DayCourse course_of_day(const preparation::PreparedParts& parts, const engine::CaseResult& cycle,
                        double duration) {
  return Day(parts, cycle, duration).run();
}

}  // namespace servomill::sim::run
