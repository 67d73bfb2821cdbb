/// Numbers of a program that is being printed.
#pragma once

#include <cmath>
#include <limits>
#include <string>

#include "controllers/gcode/number_text.h"

namespace servomill::controllers {

/// A coordinate on the grid of the printed decimals, counted in its smallest step.
class PrintedGrid {
 public:
  explicit PrintedGrid(int decimals) : decimals_(decimals), scale_(std::pow(10.0, decimals)) {}
  double step_count(double x) const { return std::round(x * scale_); }
  double value(double steps) const { return steps / scale_; }
  bool is_zero(double x) const { return step_count(x) == 0.0; }
  std::string text(double steps) const { return fixed_text(steps / scale_, decimals_); }

 private:
  int decimals_;
  double scale_;
};

/// significant_text() of a number that mostly is the one before.
class RepeatedNumber {
 public:
  const std::string& text(double x) {
    if (!(x == x_)) text_ = significant_text(x);
    x_ = x;
    return text_;
  }

 private:
  double x_ = std::numeric_limits<double>::quiet_NaN();
  std::string text_;
};

}  // namespace servomill::controllers
