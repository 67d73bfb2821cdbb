/// Statistics of values that come one by one.
#pragma once

#include <cmath>
#include <cstddef>
#include <string_view>

namespace servomill::sim::evaluation {

/// "max" (by magnitude), "range", "mean" or "rms".
class Statistic {
 public:
  explicit Statistic(std::string_view name);

  void add(double value) {
    ++count_;
    has_none_ |= std::isnan(value);
    sum_ += value;
    squares_ += value * value;
    spread(value, value);
  }

  /// Adds values of which only this is known.
  /// @param count  how many they are
  void add(double least, double greatest, double mean, double rms, double count);

  /// NaN without values, or if one of them is.
  double value() const;

 private:
  void spread(double least, double greatest) {
    if (least < least_) least_ = least;
    if (greatest > greatest_) greatest_ = greatest;
  }

  enum class Kind { max, range, mean, rms } kind_;
  double count_ = 0.0;
  bool has_none_ = false;
  double sum_ = 0.0, squares_ = 0.0;
  double least_ = HUGE_VAL, greatest_ = -HUGE_VAL;
};

}  // namespace servomill::sim::evaluation
