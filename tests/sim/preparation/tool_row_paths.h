/// Paths of tools in rows for tests, in mm.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/preparation/cut_places.h"

namespace servomill::sim::preparation {

inline plant::Cutter cutter(double radius, double corner_radius = 0.0, double length = 30.0) {
  return {.radius = radius * mm, .corner_radius = corner_radius * mm, .length = length * mm};
}

/// Straight from tip to tip, a row every mm, as one run.
class ToolPath {
 public:
  explicit ToolPath(const plant::Cutter& cutter) { now_.cutter = &cutter; }

  ToolPath& axis(const Eigen::Vector3d& k) {
    now_.axis = k.normalized();
    return *this;
  }
  ToolPath& from(double x, double y, double z) {
    now_.run = ++run_;
    now_.tip = Eigen::Vector3d(x, y, z) * mm;
    rows.push_back(now_);
    return *this;
  }
  ToolPath& to(double x, double y, double z) {
    ++now_.line;
    const Eigen::Vector3d begin = now_.tip, end = Eigen::Vector3d(x, y, z) * mm;
    const double steps = std::ceil((end - begin).norm() / mm - 1e-9);
    for (double n = 1.0; n <= steps; ++n) {
      now_.tip = begin + n / steps * (end - begin);
      rows.push_back(now_);
    }
    return *this;
  }
  ToolPath& rapid(double x, double y, double z) {
    now_.run = -1;
    to(x, y, z);
    now_.run = ++run_;
    return *this;
  }
  /// A whole turn about Z, counter-clockwise, a row every degree.
  ToolPath& circle(double radius, double z) {
    now_.run = ++run_;
    for (int n = 0; n <= 360; ++n) {
      const double a = n * deg;
      now_.tip = Eigen::Vector3d(radius * std::cos(a), radius * std::sin(a), z) * mm;
      rows.push_back(now_);
    }
    return *this;
  }

  std::vector<ToolRow> rows;

 private:
  ToolRow now_;
  int run_ = 0;
};

}  // namespace servomill::sim::preparation
