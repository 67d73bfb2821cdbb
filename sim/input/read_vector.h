/// Points and vectors of scenarios: lists of three numbers.
#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "sim/config/reader.h"

namespace servomill::sim::input {

/// A list [x, y, z]; zero, with a fault, if it is not.
inline Eigen::Vector3d read_vector(config::Reader& table, std::string_view key,
                                   config::Quantity quantity) {
  const std::size_t before = table.faults();
  const std::vector<double> v = table.reals(key, quantity);
  if (table.faults() > before) return Eigen::Vector3d::Zero();
  if (v.size() == 3) return Eigen::Vector3d(v.data());
  table.fault(key, "must be [x, y, z]");
  return Eigen::Vector3d::Zero();
}

}  // namespace servomill::sim::input
