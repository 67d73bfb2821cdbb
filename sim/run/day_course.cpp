#include "sim/run/day_course.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "plant/heat/temperature.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "sim/engine/heat_run.h"
#include "sim/model/working_day.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/preparation/prepared_case.h"
#include "sim/system/json.h"

namespace servomill::sim::run {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kStep = 1.0;                // s, over which powers of a cycle are averaged
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

// Mean powers of some time of a cycle.
struct PowerStep {
  double length = 0.0;  // s
  VectorXd power;       // W, of each body
};

// Powers of a cycle over steps of about kStep.
std::vector<PowerStep> averaged(const engine::HeatCourse& cycle) {
  const auto rows = cycle.power.size() / std::max<std::size_t>(1, cycle.bodies);
  const auto each = static_cast<std::size_t>(std::max(1L, std::lround(kStep / cycle.step)));
  std::vector<PowerStep> out;
  for (std::size_t first = 0; first < rows; first += each) {
    const std::size_t end = std::min(rows, first + each);
    VectorXd sum = VectorXd::Zero(static_cast<Index>(cycle.bodies));
    for (std::size_t row = first; row < end; ++row) {
      sum += Eigen::Map<const VectorXd>(&cycle.power[row * cycle.bodies],
                                        static_cast<Index>(cycle.bodies));
    }
    const auto steps = static_cast<double>(end - first);
    out.push_back({steps * cycle.step, sum / steps});
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
  Day(const preparation::PreparedParts& parts, const engine::HeatCourse& cycle, double duration)
      : day_(*parts.scenario.day),
        machine_(parts.scenario.machine_of(parts.spec)),
        heat_(*machine_.heat),
        sources_(machine_),
        network_(engine::network_at_start(machine_)),
        path_(places_along(parts, machine_.chain.layout)),
        cycle_(averaged(cycle)),
        duration_(duration),
        long_step_(long_step(heat_)),
        power_(VectorXd::Zero(static_cast<Index>(heat_.network.bodies.size()))),
        at_start_(errors_now()) {
    for (const auto& body : heat_.network.bodies) out_.bodies.push_back(body.name);
    for (const auto& place : day_.places) out_.places.push_back(place.name);
    for (const auto& sensor : heat_.sensors) out_.sensors.push_back(sensor.name);
    out_.temperatures.resize(out_.bodies.size());
    out_.readings.resize(out_.sensors.size());
    out_.drift.resize(out_.places.size());
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
    engine::HeatInputs inputs;
    inputs.spindle = phase.activity == model::Activity::spindle ? phase.spindle : 0.0;
    switch (phase.activity) {
      case model::Activity::idle:
      case model::Activity::spindle:
        sources_.powers(inputs, power_);
        rest(phase.duration);
        return;
      case model::Activity::program:
        for (int n = 0; n < phase.cycles && out_.stopped.empty(); ++n) run_cycle();
        return;
      case model::Activity::probe:
        now_ = std::make_unique<plant::VolumetricModel>(errors_now());
        datum_ = drift_of(day_.places[static_cast<std::size_t>(phase.place)]).dp_W;
        return;
    }
  }

  // Constant powers, from reading to reading.
  void rest(double duration) {
    const double end = t_ + duration;
    while (t_ < end && out_.stopped.empty()) {
      advance(std::min({end, next_reading_, t_ + long_step_}) - t_);
    }
  }

  void run_cycle() {
    throw_if_interrupted();
    judge_cycle();
    const double end = t_ + duration_;
    for (const PowerStep& step : cycle_) {
      power_ = step.power;
      advance_to(std::min(end, t_ + step.length));
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
    t_ += h;
    if (t_ >= next_reading_) read();
    out_.stopped = engine::fault_of(heat_, network_.temperatures());
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
    now_ = std::make_unique<plant::VolumetricModel>(errors_now());
    for (std::size_t k = 0; k < day_.places.size(); ++k) {
      out_.drift[k].push_back(in_machine_axes(day_.places[k]));
    }
  }

  // Along and about the axes of the machine: the linear axes have the directions J in W, and a tool
  // axis k that changes by dk turns by k x dk.
  std::array<double, kDrifts> in_machine_axes(const model::DayPlace& place) const {
    const plant::VolumetricError d = drift_of(place);
    const Eigen::Matrix3d J = plant::linear_jacobian(machine_.chain, place.Q);
    const Vector3d k = plant::forward(machine_.chain, place.Q, place.p_ST).k_W;
    const Vector3d shift = J.transpose() * d.dp_W, turn = J.transpose() * k.cross(d.dk_W);
    return {shift.x(), shift.y(), shift.z(), turn.x(), turn.y(), turn.z()};
  }

  // Errors `now_` against those at the start.
  plant::VolumetricError drift_of(const model::DayPlace& place) const {
    const plant::VolumetricError a = now_->error(place.Q, place.p_ST);
    const plant::VolumetricError b = at_start_.error(place.Q, place.p_ST);
    return {a.dp_W - b.dp_W, a.dk_W - b.dk_W};
  }

  void judge_cycle() {
    const plant::VolumetricModel errors = errors_now();
    DayCycle cycle{t_, 0.0, 0.0};
    for (const PathPlace& place : path_) {
      const Vector3d d = errors.error(place.Q, place.p_ST).dp_W -
                         at_start_.error(place.Q, place.p_ST).dp_W - datum_;
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
  plant::VolumetricModel at_start_;
  std::unique_ptr<plant::VolumetricModel> now_;
  Vector3d datum_ = Vector3d::Zero();
  double t_ = 0.0, next_reading_ = 0.0;
  DayCourse out_;
};

}  // namespace

DayCourse course_of_day(const preparation::PreparedParts& parts, const engine::HeatCourse& cycle,
                        double duration) {
  return Day(parts, cycle, duration).run();
}

std::string day_json(const std::string& case_name, const DayCourse& day) {
  system::JsonObject out;
  out.text("case", case_name);
  for (const DriftRange& range : day.ranges) {
    system::JsonObject place;
    for (std::size_t c = 0; c < kDrifts; ++c) {
      const std::string unit = c < 3 ? "um" : "urad", name = kDriftNames[c];
      place.number(fmt::format("{}_first_60_min_{}", name, unit), range.first_hour[c] / um);
      place.number(fmt::format("{}_{}", name, unit), range.whole[c] / um);
      place.number(name + "_reached_h", range.reached[c] / kHour);
    }
    out.raw(range.place, place.line());
  }
  if (!day.stopped.empty()) out.text("stopped", day.stopped);
  return out.line();
}

std::string day_table(const DayCourse& day) {
  std::string out = fmt::format("{:<12} {:>10} {:>12} {:>12} {:>12}\n", "drift at", "direction",
                                "first 60 min", "whole", "reached");
  for (const DriftRange& range : day.ranges) {
    for (std::size_t c = 0; c < kDrifts; ++c) {
      const char* unit = c < 3 ? "um" : "urad";
      out += fmt::format("{:<12} {:>10} {:>7.2f} {:<4} {:>7.2f} {:<4} {:>10.2f} h\n",
                         c == 0 ? range.place : "", kDriftNames[c], range.first_hour[c] / um, unit,
                         range.whole[c] / um, unit, range.reached[c] / kHour);
    }
  }
  if (!day.cycles.empty()) {
    const auto by_most = [](const DayCycle& a, const DayCycle& b) { return a.most < b.most; };
    const auto [best, worst] = std::minmax_element(day.cycles.begin(), day.cycles.end(), by_most);
    out += fmt::format(
        "{} cycles; heat displaces the tip by {:.2f} um at most in the best, begun after {:.2f} h, "
        "and by {:.2f} um in the worst, begun after {:.2f} h\n",
        day.cycles.size(), best->most / um, best->begin / kHour, worst->most / um,
        worst->begin / kHour);
  }
  if (!day.stopped.empty()) out += "stopped: " + day.stopped + "\n";
  return out;
}

}  // namespace servomill::sim::run
