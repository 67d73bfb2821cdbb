/// The reference problem of reference_problem/README.txt, built from the blocks of the rooms.
#pragma once

#include <array>
#include <cmath>
#include <fstream>
#include <memory>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "plant/geometry/volumetric.h"
#include "plant/kinematics/structure.h"
#include "sim/engine/feedback_lanes.h"
#include "sim/engine/servo_axes.h"
#include "strategies/registry.h"

namespace servomill::reference_problem {

inline constexpr double kTick = 10e-6;
inline constexpr Tick kVolumetric = 6, kCurrent = 10, kVelocity = 20, kPosition = 120,
                      kRecord = 100;
inline constexpr Tick kEnd = 1'000'000;

inline std::string file_of(const std::string& name) {
  return SERVOMILL_SOURCE_DIR "/tests/known_answers/reference_problem/" + name;
}

// Rows "name,number,number,..." behind the comment and the heading.
inline std::vector<std::vector<double>> read_rows(const std::string& name) {
  std::ifstream file(file_of(name));
  std::vector<std::vector<double>> rows;
  std::string line, field;
  for (int n = 0; std::getline(file, line); ++n) {
    if (n < 2) continue;
    std::istringstream fields(line);
    std::getline(fields, field, ',');
    auto& row = rows.emplace_back();
    while (std::getline(fields, field, ',')) row.push_back(std::stod(field));
  }
  return rows;
}

inline std::vector<Joints> read_reference(const std::string& name) {
  std::ifstream file(file_of(name), std::ios::binary);
  std::vector<Joints> rows(kEnd / kRecord + 1);
  file.read(reinterpret_cast<char*>(rows.data()),
            static_cast<std::streamsize>(rows.size() * sizeof(Joints)));
  if (!file) throw std::runtime_error(name + " is too short");
  return rows;
}

// The machine of a file: drives, loops and limits; encoders are ideal.
inline sim::model::MachineSettings read_machine(const std::string& name, bool with_friction) {
  const auto rows = read_rows(name);
  sim::model::MachineSettings machine;
  machine.nc.periods = {kTick, kPosition, kVelocity, kCurrent};
  for (std::size_t j = 0; j < kJoints; ++j) {
    std::size_t next = 0;
    const auto take = [&] { return rows.at(next++).at(j); };
    plant::FeedDriveParams& d = machine.drives[j];
    controllers::CascadeParams& c = machine.nc.cascade[j];
    controllers::CurrentLoopParams& u = machine.nc.functions[j].current_loop;
    d.L = take();
    d.R = take();
    d.Kt = c.Kt = take();
    d.Ke = take();
    d.J = take();
    d.b_motor = take();
    d.r = c.r = take() / (2.0 * std::numbers::pi);
    d.M = take();
    d.k = take();
    d.c = take();
    d.b_load = take();
    plant::FrictionParams& f = d.friction;
    f.kind = with_friction ? plant::FrictionKind::regularised : plant::FrictionKind::none;
    f.Fc_positive = f.Fc_negative = take();
    f.Fs_positive = f.Fs_negative = take();
    f.vs = take();
    f.v0 = take();
    c.Kv = take();
    c.kvf = take();
    c.kaf = take();
    c.J = d.J_total();
    c.Tv = kVelocity * kTick;
    c.Kp = c.J * take();
    c.Ki = c.Kp / take();
    u.Ti = kCurrent * kTick;
    u.Kp = d.L * take();
    u.Ki = u.Kp / take();
    c.i_max = d.i_max = with_friction ? take() : controllers::kNoLimit;
    u.u_max = with_friction ? take() : controllers::kNoLimit;
  }
  return machine;
}

// The 21 functions as an error model: squareness is part of the straightness of Y and Z.
inline plant::VolumetricModel read_volumetric() {
  const auto rows = read_rows("vol.csv");
  const auto chain = plant::make_chain(plant::parse_structure("[w b X Y Z t]"));
  plant::ErrorModel errors;
  std::size_t next = 0;
  for (const Axis axis : {Axis::X, Axis::Y, Axis::Z}) {
    for (const Axis direction : kAllAxes) {
      errors.component({direction, axis, false}) = plant::polynomial(rows.at(next++));
    }
  }
  const auto add_shear = [&](Axis direction, Axis axis, double sign, std::vector<double> S) {
    S.insert(S.begin(), 0.0);  // times the coordinate
    auto& f = errors.component({direction, axis, false});
    f = f + plant::scaled(plant::polynomial(S), sign);
  };
  add_shear(Axis::X, Axis::Y, -1.0, rows.at(18));
  add_shear(Axis::X, Axis::Z, 1.0, rows.at(19));
  add_shear(Axis::Y, Axis::Z, -1.0, rows.at(20));
  return {chain, errors};
}

inline Joints reference_trajectory(double t) {
  constexpr double kPi = std::numbers::pi;
  const double tau = t < 1.0 ? 0.5 * t - std::sin(kPi * t) / (2.0 * kPi) : t - 0.5;
  const double s = 2.0 * kPi * tau;
  const auto cycloid = [](double q) { return q - std::sin(2.0 * kPi * q) / (2.0 * kPi); };
  const double p = t - 2.0 * std::floor(t / 2.0);
  const double up_and_down = p < 0.6   ? cycloid(p / 0.6)
                             : p < 1.0 ? 1.0
                             : p < 1.6 ? 1.0 - cycloid((p - 1.0) / 0.6)
                                       : 0.0;
  Joints Q;
  Q << 0.05 * (1.0 - std::cos(0.5 * s)), 0.05 * std::sin(0.5 * s), 0.12 * up_and_down,
      0.03 * std::sin(0.8 * s), 0.02 * std::sin(s) + 0.001 * std::sin(7.0 * s);
  return Q;
}

// The virtual encoder of these errors, the limits of which are never reached.
inline std::unique_ptr<strategies::Strategy> make_virtual_encoder() {
  strategies::IdentifiedMachine identified{{}, read_volumetric()};
  identified.p_ST << 0.0, 0.0, -0.15;
  Parameters parameters;
  parameters.set("max_um", 1.0);             // m
  parameters.set("max_rate_mm_per_s", 1e6);  // m/s
  parameters.set("extrapolation_time_ms", 0.0);
  parameters.set("velocity_window_ms", 0.0);
  parameters.set("prediction", "lag");
  parameters.set("iterations", "converged");  // one step is exact when errors are corrected
  parameters.set("axes", "linear");
  return strategies::find("feedback")->make(parameters, strategies::Action::compensate, identified);
}

// Backward differences of the setpoint over the position period.
class Setpoint {
 public:
  void take(const Joints& Q) {
    Q2_ = Q1_;
    Q1_ = Q_;
    Q_ = Q;
  }
  const Joints& Q() const { return Q_; }
  Joints dQ() const { return (Q_ - Q1_) / kTp; }
  Joints ddQ() const { return (Q_ - 2.0 * Q1_ + Q2_) / (kTp * kTp); }

 private:
  static constexpr double kTp = kPosition * kTick;
  Joints Q_ = Joints::Zero(), Q1_ = Joints::Zero(), Q2_ = Joints::Zero();
};

/// The problem as one or more machines in lockstep.
class Problem {
 public:
  /// @param machines  one a run; must outlive this
  explicit Problem(const std::vector<const sim::model::MachineSettings*>& machines)
      : schedule_(sim::model::make_schedule({{sim::model::kErrorModel, kVolumetric, 0},
                                             {sim::model::kFeedbackSample, kPosition, 0},
                                             {sim::model::kPositionLoop, kPosition, 0},
                                             {sim::model::kVelocityLoop, kVelocity, 0},
                                             {sim::model::kCurrentLoop, kCurrent, 0},
                                             {sim::model::kRecord, kRecord, 0}})),
        axes_(machines, {0, 1, 2, 3, 4}, schedule_) {
    for (std::size_t run = 0; run < machines.size(); ++run) {
      if (run % kLaneWidth == 0) feedbacks_.emplace_back(axes_, run);
      feedbacks_.back().add(run, *virtual_encoder_, kVolumetric * kTick);
      axes_.settle(Joints::Zero(), Joints::Zero(), run);
    }
  }

  /// @param record  record(run, setpoint, axes), called each millisecond up to and with `end`
  template <class Record>
  void until(Tick end, const Record& record) {
    for (Tick n = 0;;) {
      for (const sim::model::Instant& instant : schedule_) {
        visit(instant.due, n);
        if (instant.due & sim::model::kRecord) {
          for (std::size_t run = 0; run < axes_.runs(); ++run) record(run, set_, axes_);
        }
        if (n == end) return;
        axes_.advance(instant.step, [&] { advance_feedback(); });
        n += instant.step;
      }
    }
  }

 private:
  void advance_feedback() {
    for (sim::engine::FeedbackLanes& feedback : feedbacks_) feedback.evaluate_error_models();
  }

  // The velocity loop before the current loop, which uses its result at once.
  void visit(std::uint8_t due, Tick n) {
    if (due & sim::model::kErrorModel) {
      axes_.read_scales();
      advance_feedback();
    }
    if (due & sim::model::kPositionLoop) {
      setpoint_.take(reference_trajectory(static_cast<double>(n) * kTick));
      set_.Q_ref = set_.Q_cmd = setpoint_.Q();
      set_.dQ_ff = setpoint_.dQ();
      set_.ddQ_ff = setpoint_.ddQ();
      for (std::size_t run = 0; run < axes_.runs(); ++run) axes_.follow(set_, run);
      for (sim::engine::FeedbackLanes& feedback : feedbacks_)
        feedback.apply_virtual_displacements();
      axes_.sample_position_feedback();
      axes_.compensate_backlash();
      axes_.close_position_loops();
    }
    if (due & sim::model::kVelocityLoop) axes_.close_velocity_loops();
    if (due & sim::model::kCurrentLoop) axes_.latch_current_commands();
  }

  std::vector<sim::model::Instant> schedule_;
  sim::engine::ServoAxes axes_;
  std::unique_ptr<strategies::Strategy> virtual_encoder_ = make_virtual_encoder();
  std::vector<sim::engine::FeedbackLanes> feedbacks_;  // of eight runs each
  Setpoint setpoint_;
  sim::engine::AxisSetpoint set_;
};

}  // namespace servomill::reference_problem
