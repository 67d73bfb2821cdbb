/// Rows of a recording during a test of the machine, and the standstills at its stops.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "sim/model/machine_test.h"

namespace servomill::sim::records {
class Series;
}  // namespace servomill::sim::records
namespace servomill::sim::evaluation {
struct CaseData;
}  // namespace servomill::sim::evaluation

namespace servomill::sim::run {

/// Rows during which the interpolated position stays the same. A rewritten program has its own; its
/// nominal position, of the original program at equal s, would drift along the path.
struct Standstill {
  Eigen::Vector3d ref = Eigen::Vector3d::Zero();  // m; of X, Y and Z
  std::size_t begin = 0, end = 0;
};

/// Positions of the TCP during one section of the program.
class TestRows {
 public:
  /// @param one  must outlive this
  /// @throws InputError if the recording lacks a signal
  TestRows(const model::MachineTest& test, const evaluation::CaseData& one);

  /// A standstill at each stop that is measured, in their order.
  /// @throws InputError if the recording does not hold all
  std::vector<Standstill> at_stops() const;

  Eigen::Vector3d nominal(const Standstill& one) const { return position(one.begin, nominal_); }
  double end_of(const Standstill& one) const { return time(one.end - 1); }
  double time(std::size_t row) const;          // s
  Eigen::Vector3d ref(std::size_t row) const;  // m
  Eigen::Vector3d actual(std::size_t row) const { return position(row, actual_); }
  /// Mean of the true position in a part of the time, from 0 to 1, m.
  Eigen::Vector3d mean(const Standstill& one, double from, double to) const;

 private:
  using Columns = std::array<std::size_t, 3>;

  Eigen::Vector3d position(std::size_t row, const Columns& of) const;
  void add(std::size_t row);
  std::vector<Standstill> found_from(std::size_t first, const std::vector<Standstill>& all,
                                     const std::vector<Eigen::Vector3d>& stops) const;

  const model::MachineTest& test_;
  const evaluation::CaseData& case_;
  const records::Series& series_;
  std::size_t time_ = 0;
  std::array<std::size_t, 3> ref_{};  // kNone of an axis that the machine does not have
  Columns nominal_{}, actual_{};
  std::vector<Standstill> all_;
};

}  // namespace servomill::sim::run
