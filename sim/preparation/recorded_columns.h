/// Signals of a recording as vectors, row by row and between rows.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/units.h"
#include "sim/engine/case_result.h"

namespace servomill::sim::preparation {

// Columns of a recorded signal of all axes, joint by joint.
class JointColumns {
 public:
  JointColumns(const records::Series& rows, const JointLayout& layout, const std::string& name)
      : rows_(rows) {
    for (int j = 0; j < kJoints; ++j) {
      if (!layout.has(j)) continue;
      columns_[static_cast<std::size_t>(j)] =
          rows.column(name + (j < kLinearJoints ? "_linear" : "_rotary"), layout.letter_of(j));
    }
  }
  Joints at(std::size_t row) const {
    Joints out = Joints::Zero();
    for (int j = 0; j < kJoints; ++j) {
      const auto& column = columns_[static_cast<std::size_t>(j)];
      if (column) out[j] = rows_.at(row, *column) * (j < kLinearJoints ? mm : deg);
    }
    return out;
  }

 private:
  const records::Series& rows_;
  std::array<std::optional<std::size_t>, kJoints> columns_;
};

// Three columns of a recorded signal.
class VectorColumns {
 public:
  VectorColumns(const records::Series& rows, const char* name, const char* labels) : rows_(rows) {
    for (std::size_t k = 0; k < 3; ++k) columns_[k] = *rows.column(name, labels[k]);
  }
  Eigen::Vector3d at(std::size_t row) const {
    return {rows_.at(row, columns_[0]), rows_.at(row, columns_[1]), rows_.at(row, columns_[2])};
  }

 private:
  const records::Series& rows_;
  std::array<std::size_t, 3> columns_{};
};

// Value between two rows.
template <class At>
auto between_rows(double row, const At& at) {
  const auto n = static_cast<std::size_t>(row);
  const double f = row - static_cast<double>(n);
  auto value = at(n);
  if (f > 0.0) value += f * (at(n + 1) - value);
  return value;
}

}  // namespace servomill::sim::preparation
