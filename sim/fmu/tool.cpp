#include "sim/fmu/tool.h"

namespace servomill::sim::fmu {
namespace {

constexpr Variable tip(std::uint32_t n, std::string_view name, std::string_view description) {
  return {kToolReference + n, name,           Causality::parameter,
          Variability::fixed, Kind::position, description};
}

constexpr Variable output(std::uint32_t n, std::string_view name, Kind kind,
                          std::string_view description) {
  return {kToolReference + n, name, Causality::output, Variability::continuous, kind, description};
}

constexpr std::array<Variable, kToolVariables> kVariableTable = {{
    tip(0, "tool.tip_x", "tool centre point in the spindle nose, X"),
    tip(1, "tool.tip_y", "tool centre point in the spindle nose, Y"),
    tip(2, "tool.tip_z", "tool centre point in the spindle nose, Z: minus the tool length"),
    output(3, "tool.position_x", Kind::position, "tool centre point in the workpiece, X"),
    output(4, "tool.position_y", Kind::position, "tool centre point in the workpiece, Y"),
    output(5, "tool.position_z", Kind::position, "tool centre point in the workpiece, Z"),
    output(6, "tool.axis_i", Kind::ratio, "unit tool axis in the workpiece, X"),
    output(7, "tool.axis_j", Kind::ratio, "unit tool axis in the workpiece, Y"),
    output(8, "tool.axis_k", Kind::ratio, "unit tool axis in the workpiece, Z"),
    output(9, "tool.deviation_x", Kind::position,
           "tool centre point minus that of the ideal machine at the same axis positions, X"),
    output(10, "tool.deviation_y", Kind::position,
           "tool centre point minus that of the ideal machine at the same axis positions, Y"),
    output(11, "tool.deviation_z", Kind::position,
           "tool centre point minus that of the ideal machine at the same axis positions, Z"),
}};

}  // namespace

std::span<const Variable> tool_variables() { return kVariableTable; }

ToolValues Tool::values(const Joints& Q, const Eigen::Vector3d& p_ST) const {
  const ToolPose pose = model_.forward(Q, p_ST);
  const Eigen::Vector3d deviation = pose.p_WT - plant::forward(model_.chain(), Q, p_ST).p_WT;
  ToolValues out{};
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    out[k] = p_ST[i];
    out[3 + k] = pose.p_WT[i];
    out[6 + k] = pose.k_W[i];
    out[9 + k] = deviation[i];
  }
  return out;
}

}  // namespace servomill::sim::fmu
