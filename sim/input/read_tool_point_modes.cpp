#include "sim/input/read_tool_point_modes.h"

#include <numbers>

#include "sim/input/read_vector.h"

namespace servomill::sim::input {
namespace {

// Lengths whose square is a number.
constexpr double kShortest = 1e-100, kLongest = 1e100;

plant::ToolPointMode read_tool_point_mode(config::Reader& table) {
  plant::ToolPointMode out;
  const std::size_t before = table.faults();
  const Eigen::Vector3d d = read_vector(table, "direction", config::kNumber);
  if (table.faults() == before) {
    if (d.norm() >= kShortest && d.norm() <= kLongest) {
      out.direction = d.normalized();
    } else {
      table.fault("direction", "must be [x, y, z], not all 0; the length is irrelevant");
    }
  }
  out.stiffness = table.real("stiffness", config::kStiffness, {config::above(0.0)});
  out.mode.w =
      2.0 * std::numbers::pi * table.real("frequency_Hz", config::kRate, {config::above(0.0)});
  out.mode.zeta = table.real("damping", config::kNumber, {config::above(0.0), config::below(1.0)});
  return out;
}

}  // namespace

std::vector<plant::ToolPointMode> read_tool_point_modes(config::Reader& machine_table) {
  std::vector<plant::ToolPointMode> out;
  for (config::Reader& table : machine_table.tables_or_none("tool_point_mode")) {
    out.push_back(read_tool_point_mode(table));
  }
  return out;
}

}  // namespace servomill::sim::input
