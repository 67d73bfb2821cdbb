#include "sim/run/store_chain.h"

#include <string>
#include <vector>

#include "plant/vocabulary/units.h"

namespace servomill::sim::run {

void write_chain(records::Hdf5Group& group, const plant::MachineChain& chain) {
  if (chain.axes.empty()) return;
  std::string letters;
  std::vector<std::int32_t> carries_workpiece;
  std::vector<double> directions, points;
  for (const plant::ChainAxis& axis : chain.axes) {
    letters += letter(axis.axis);
    carries_workpiece.push_back(axis.side == plant::Side::workpiece);
    const double sign = axis.sense == plant::Sense::table ? -1.0 : 1.0;
    const Eigen::Vector3d direction = sign * plant::direction_of(axis);
    directions.insert(directions.end(), direction.begin(), direction.end());
    for (int i = 0; i < 3; ++i) points.push_back(axis.centre[i] / mm);
  }
  group.attribute("chain_axes", letters);
  group.attribute("chain_carries_workpiece", std::span<const std::int32_t>(carries_workpiece));
  group.attribute("chain_directions", std::span<const double>(directions));
  group.attribute("chain_points_mm", std::span<const double>(points));
}

}  // namespace servomill::sim::run
