/// Everything a scenario says about a machine: plant, NC, encoders. SI, complete, checked.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "controllers/gcode/decimal_point.h"
#include "controllers/gcode/reader.h"
#include "controllers/servo/backlash_compensation.h"
#include "controllers/servo/cascade.h"
#include "controllers/servo/current_loop.h"
#include "controllers/servo/friction_compensation.h"
#include "controllers/servo/position_feedback.h"
#include "controllers/servo/supervision.h"
#include "plant/drives/feed_drive.h"
#include "plant/drives/screw_error.h"
#include "plant/kinematics/chain.h"
#include "plant/sensing/encoder.h"
#include "plant/sensing/reference_marks.h"
#include "plant/structure/inertial_compliance.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/ticks.h"

namespace servomill::sim::model {

/// Periods of the loops in base ticks; every one is a whole multiple of the base period.
struct LoopPeriods {
  double base = 10e-6;  // s
  Tick position = 20;
  Tick velocity = 20;
  Tick current = 10;
  double seconds(Tick ticks) const { return static_cast<double>(ticks) * base; }
  bool operator==(const LoopPeriods&) const = default;
};

/// True if all these periods (ticks) fit into one static schedule: sim/model/schedule.h bounds its
/// length.
bool can_be_scheduled(const std::vector<Tick>& periods);

/// Nominal-position filter of the NC: length in position periods; 0: none.
struct NominalFilter {
  bool triangle = false;
  Tick length = 0;
};

/// Functions of the NC for one axis beside its cascade.
struct AxisFunctions {
  controllers::CurrentLoopParams current_loop;  // of a drive with a winding
  controllers::PositionFeedbackParams position_feedback;
  controllers::FrictionCompensationParams friction;
  controllers::BacklashCompensationParams backlash;
  controllers::SupervisionParams supervision;
};

/// Places of the gains of an axis in the input, for messages.
struct GainPlaces {
  Place Kv, velocity_bandwidth, winding_bandwidth;
};

/// Position control of the spindle, for motion that it turns with (G33, G33.1).
struct SpindleDrive {
  double acceleration = 0.0;           // rad/s2
  std::optional<double> Kv;            // 1/s, position gain; none: unknown
  double velocity_feed_forward = 0.0;  // share
};

struct NcSettings {
  LoopPeriods periods;
  std::array<controllers::CascadeParams, kJoints> cascade;
  std::array<AxisFunctions, kJoints> functions;
  Joints v_max = Joints::Zero(), a_max = Joints::Zero(), j_max = Joints::Zero();  // SI per joint
  Joints rapid = Joints::Zero();                                                  // m/s, rad/s
  Joints lower = Joints::Zero(), upper = Joints::Zero();                          // m, rad; travel
  controllers::Reader program_reader = controllers::Reader::any;  // of programs that name none
  controllers::DecimalPoint decimal_point = controllers::DecimalPoint::unset;
  std::set<int> ignored_codes;     // M codes without effect, of programs that name none
  double path_tolerance = 10e-6;   // m, for G64 without P
  double rotary_tolerance = 1e-4;  // rad
  double block_time = 0.0;         // s, least time of a block; 0: none
  double tolerance_share = 1.0;    // factor on tolerances of the program (G64 P)
  // s, for cycle times; a simulation does not wait; none: unknown
  std::optional<double> tool_change_time;
  std::optional<double> spindle_time;  // of each start, stop and change of speed
  std::optional<SpindleDrive> spindle;
  NominalFilter filter;
  std::array<GainPlaces, kJoints> gain_place;
  bool check_stability = true;  // refuse gains with which the linear loop diverges

  /// A rotary joint without ends of travel.
  bool is_endless(int joint) const {
    return joint >= kLinearJoints && (std::isinf(lower[joint]) || std::isinf(upper[joint]));
  }
};

/// Integrator that moves the drives between two instants.
enum class Integrator : std::uint8_t {
  exact,  // plant/drives/drive_bank.h
  cvode,  // plant/drives/cvode_bank.h: SUNDIALS at tight tolerance, the reference
};

/// Reference marks of a scale that the NC watches.
struct MarkSettings {
  plant::MarkParams params;
  int allowed = 0;  // signal periods by which a count may be wrong
};

struct HeatSettings;  // sim/model/heat.h

struct MachineSettings {
  std::string name;
  plant::MachineChain chain;
  std::array<plant::FeedDriveParams, kJoints> drives;
  Integrator integrator = Integrator::exact;
  std::array<plant::Encoder, kJoints> scale;  // position encoder of the slide or table
  std::array<plant::Encoder, kJoints> motor;  // rad
  std::array<std::optional<MarkSettings>, kJoints> marks;
  std::array<plant::ScrewError, kJoints> screw;
  // m/N, of what lies between the scales of linear axes and the tip: 0: rigid
  Eigen::Vector3d structural_compliance = Eigen::Vector3d::Zero();
  std::vector<plant::StructuralMode> structural_modes;          // in addition to it
  std::vector<plant::InertialCompliance> inertial_compliances;  // none: rigid under acceleration
  std::shared_ptr<const HeatSettings> heat;  // nullptr: at its reference temperature, always
  Tick scale_delay = 0;
  NcSettings nc;

  std::array<bool, kJoints> present() const {
    std::array<bool, kJoints> out{};
    for (int j = 0; j < kJoints; ++j) out[static_cast<std::size_t>(j)] = chain.layout.has(j);
    return out;
  }
  /// Joints that the machine has.
  std::vector<int> joints() const {
    std::vector<int> out;
    for (int j = 0; j < kJoints; ++j) {
      if (chain.layout.has(j)) out.push_back(j);
    }
    return out;
  }
};

}  // namespace servomill::sim::model
