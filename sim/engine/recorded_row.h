/// One recorded row: its values in their order, rounded to what is kept of them.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "sim/records/series.h"

namespace servomill::sim::engine {

/// Writes values one after the other, in the order of recorded_signals().
class RowWriter {
 public:
  explicit RowWriter(double* row) : next_(row) {}
  void put(double value) { *next_++ = value; }
  void skip(std::size_t values) { next_ += values; }
  void put(const Joints& Q, const std::vector<int>& joints, double unit) {
    for (const int joint : joints) put(Q[joint] / unit);
  }
  void put(const Eigen::Vector3d& v, double unit) {
    for (int i = 0; i < 3; ++i) put(v[i] / unit);
  }

 private:
  double* next_;
};

/// Rounds rows to what is kept of them.
class Rounding {
 public:
  explicit Rounding(const records::Series& series) {
    for (const records::Signal& signal : series.signals()) {
      for (std::size_t c = 0; c < signal.columns(); ++c) {
        // in the binade of the shift, the last bit of a double is one quantum
        shift_.push_back(1.5 * 0x1p52 * signal.quantum);
        largest_.push_back(signal.quantum > 0.0 ? 0x1p51 * signal.quantum : -1.0);
        any_single_ |= signal.storage == records::Storage::float32;
        single_.push_back(signal.storage == records::Storage::float32);
      }
    }
  }
  void apply(double* row) const {
    for (std::size_t c = 0; c < shift_.size(); ++c) {
      const double rounded = (row[c] + shift_[c]) - shift_[c];
      row[c] = std::abs(row[c]) <= largest_[c] ? rounded : row[c];
    }
    for (std::size_t c = 0; any_single_ && c < single_.size(); ++c) {
      if (single_[c]) row[c] = static_cast<double>(static_cast<float>(row[c]));
    }
  }

 private:
  std::vector<double> shift_, largest_;
  std::vector<bool> single_;
  bool any_single_ = false;
};

}  // namespace servomill::sim::engine
