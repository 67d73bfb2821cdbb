/// Comparison of cases along the programmed path: what a scenario asks of its recorded signals.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plant/kinematics/chain.h"
#include "sim/records/series.h"

namespace servomill::sim {

struct ProbedFeature;
struct QuantitySpec;

/// A quantity that a scenario may ask for.
struct QuantityInfo {
  std::string_view name;
  std::string_view unit;
  std::string_view help;
  bool needs_axis = false;
  std::string_view axes = {};  // letters allowed
  bool has_statistic = false;
  bool needs_base = false;     // another case to compare with
  bool needs_imposed = false;  // the scenario's imposed error model
  int circles = 0;             // sections evaluated together, each one turn of a circle; 0: any
  bool is_of_ball = false;     // in the spindle, seen by sensors on the table: ball_quantities.h
  int probes = 0;              // features of the part evaluated together: probe_quantities.h; a
                               // base case is then optional unless needs_base
  bool has_fit = false;        // minimum zone or least squares
};

std::span<const QuantityInfo> quantities();
std::vector<std::string_view> quantity_names();
const QuantityInfo& quantity_info(std::string_view name);

/// Data of one case that ran.
struct CaseData {
  std::string name;
  const Series* servo = nullptr;
  std::vector<std::string> sections;  // of the original program
  double duration = 0.0;              // s, of the program that the NC ran
  double blocks = 0.0;                // motion blocks of that program
  bool finished = true;
  plant::MachineChain chain = {};                      // the ideal machine
  const std::vector<ProbedFeature>* probes = nullptr;  // of the part; nullptr: none
  // s, of the feedback hardware, 0 where none is connected; none of an ideal servo
  std::optional<double> signal_delay = {};
};

/// One line of the printed comparison.
struct ComparisonRow {
  std::string case_name, quantity, axis, statistic, unit, reference, kind;
  std::string sections;
  double value = 0.0;     // NaN where the case stopped or the samples are missing
  std::string note = {};  // why there is no value, where that is known, or what is not alike
};

/// Evaluates all quantities, in the order of the scenario. Cases are compared at equal arc length
/// on the original path, samples of rapid moves left out.
std::vector<ComparisonRow> compare(std::span<const QuantitySpec> specs,
                                   std::span<const CaseData> cases);

/// The table as text, aligned.
std::string format_table(std::span<const ComparisonRow> rows);

/// One JSON object with the keys case, quantity, axis, statistic, sections, value, unit, reference,
/// kind, null where there is none; and note where there is one.
std::string to_json(const ComparisonRow& row);

}  // namespace servomill::sim
