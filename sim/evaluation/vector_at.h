/// Three neighbouring columns of a recording.
#pragma once

#include <Eigen/Core>

#include "sim/records/series.h"

namespace servomill::sim::evaluation {

inline Eigen::Vector3d vector_at(const records::Series& series, std::size_t row,
                                 std::size_t first) {
  return {series.at(row, first), series.at(row, first + 1), series.at(row, first + 2)};
}

}  // namespace servomill::sim::evaluation
