/// Component errors of an axis that counts as carrying the tool, from poses of the machine.
///
/// Independent of the conversion in sim/tables/tool_side_errors.h, which it verifies: with all
/// other axes at zero and no other error the machine with errors stands at H = J(q) E'(q), J the
/// ideal machine, so that E' = J^-1 H.
#pragma once

#include "plant/geometry/volumetric.h"

namespace servomill::sim::tables {

class ToolSidePoses {
 public:
  ToolSidePoses(const plant::MachineChain& chain, const plant::ErrorModel& errors, Axis axis);

  /// One component error of E' (m, rad), the mean of both directions of travel.
  /// @param q  position of the axis (m, rad)
  double value(Axis direction, double q) const;

 private:
  plant::MachineChain chain_;
  plant::ChainAxis axis_;
  plant::VolumetricModel model_;
};

}  // namespace servomill::sim::tables
