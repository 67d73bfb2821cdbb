/// Rows of a recording during a test of the machine, and the standstills at its stops.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "sim/model/machine_test.h"
#include "sim/run/machine_tests.h"

namespace servomill::sim::records {
class Series;
}  // namespace servomill::sim::records

namespace servomill::sim::run {

/// Rows during which the interpolated position stays the same. A rewritten program has its own; its
/// nominal position, of the original program at equal s, would drift along the path.
struct Standstill {
  AxisWords ref = AxisWords::Zero();  // m, rad; of rotary axes 0 in tests of linear ones
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
  double time(std::size_t row) const;    // s
  AxisWords ref(std::size_t row) const;  // m, rad, as of a Standstill
  /// Axes of the spindle in the workpiece, columns X, Y, Z (3x3).
  /// @pre the test needs the orientation
  Eigen::Matrix3d spindle(std::size_t row) const;
  Eigen::Vector3d actual(std::size_t row) const { return position(row, actual_); }
  /// Interpolated feed of the axes of the test over these rows, and that of others.
  FeedRange feeds(std::size_t first, std::size_t last, FeedRange others) const;
  /// Mean of the true position in a part of the time, from 0 to 1, m.
  Eigen::Vector3d mean(const Standstill& one, double from, double to) const {
    return mean_of<Eigen::Vector3d>(one, from, to, [&](std::size_t row) { return actual(row); });
  }
  /// Mean of f(row) over the same rows.
  template <class Value, class F>
  Value mean_of(const Standstill& one, double from, double to, F f) const {
    const double begin = time(one.begin), duration = end_of(one) - begin;
    Value sum = f(one.begin) * 0.0;
    std::size_t count = 0;
    for (std::size_t row = one.begin; row < one.end; ++row) {
      const double part = (time(row) - begin) / duration;
      if (part < from || part > to) continue;
      sum += f(row);
      ++count;
    }
    return sum / static_cast<double>(count);
  }

 private:
  using Columns = std::array<std::size_t, 3>;

  Eigen::Vector3d position(std::size_t row, const Columns& of) const;
  void add(std::size_t row);
  std::vector<Standstill> found_from(std::size_t first, const std::vector<Standstill>& all,
                                     const std::vector<AxisWords>& stops) const;

  const model::MachineTest& test_;
  const evaluation::CaseData& case_;
  const records::Series& series_;
  std::size_t time_ = 0;
  std::array<std::size_t, kAxisWords> ref_{};  // kNone of an axis that is not followed
  Columns nominal_{}, actual_{};
  Columns axis_{}, side_{};  // of the tool, where the test needs the orientation
  std::vector<Standstill> all_;
};

}  // namespace servomill::sim::run
