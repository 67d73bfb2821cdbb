/// Comparison of cases along the programmed path: what a scenario asks of its recorded signals.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plant/kinematics/chain.h"
#include "sim/evaluation/comparison_row.h"
#include "sim/records/series.h"

namespace servomill::sim::model {
struct QuantitySpec;
struct UncertainErrors;
}  // namespace servomill::sim::model

namespace servomill::sim::evaluation {

struct ProbedFeature;
struct SpindleMotion;

/// Errors by heat of the parts of a day.
struct DayFigures {
  double rms = 0.0, largest = 0.0;  // m, displacement of the tip along the path of every cycle
  double measuring = 0.0;           // s, spent on datums in between
};

/// Largest value of a run, until it stopped.
struct DemandedValue {
  double size = 0.0;   // SI; lengths in m, angles in rad
  double limit = 0.0;  // of the axis
  double time = 0.0;   // s
  int line = 0;        // of the program
  double share() const { return size / limit; }
};

/// Motion that one axis of a case was asked for, and the limits of the machine.
struct AxisDemand {
  char axis = '-';
  bool is_linear = true;
  double offset = 0.0;  // m, rad; largest that all strategies together add to the path
  std::array<DemandedValue, 3> motion;  // velocity, acceleration, jerk of path and offset together
};

/// Data of one case that ran.
struct CaseData {
  std::string name;
  const records::Series* servo = nullptr;
  std::vector<std::string> sections;  // of the original program
  double duration = 0.0;              // s, of the program that the NC ran
  double blocks = 0.0;                // motion blocks of that program
  bool finished = true;
  plant::MachineChain chain = {};                      // the ideal machine
  const std::vector<ProbedFeature>* probes = nullptr;  // of the part; nullptr: none
  // s, of the feedback hardware, 0 where none is connected; none of an ideal servo
  std::optional<double> signal_delay = {};
  std::shared_ptr<const model::UncertainErrors> uncertain = {};  // of the machine; none: not known
  // rows of feed motion outside the windows of the recording, by section; empty: none
  std::vector<std::size_t> left_out = {};
  std::shared_ptr<const SpindleMotion> spindle = {};  // as the program turns it
  std::optional<DayFigures> day = {};                 // none: no day, or one without parts
  std::vector<AxisDemand> demands = {};               // of the axes
};

/// Evaluates all quantities, in the order of the scenario. Cases are compared at equal arc length
/// on the original path, samples of rapid moves left out.
std::vector<ComparisonRow> compare(std::span<const model::QuantitySpec> specs,
                                   std::span<const CaseData> cases);

}  // namespace servomill::sim::evaluation
