/// Tables of errors, looked up fast.
#pragma once

#include <cstdint>
#include <vector>

#include "plant/geometry/error_function.h"

namespace servomill::plant {

/// Linear between points as LinearTable, with the same values, found in a time that does not depend
/// on the number of points unless they are very unevenly spaced.
class TableLookup {
 public:
  explicit TableLookup(const LinearTable& table);
  double value(double at) const;

 private:
  struct Interval {
    double s, error, slope;
  };
  std::vector<Interval> intervals_;  // [i]: from point i
  double first_, last_, last_error_;
  double buckets_per_s_;
  std::vector<std::uint32_t> interval_of_bucket_;  // in which the bucket begins
};

}  // namespace servomill::plant
