/// Probed points along a run of feed motion that belong to one face of the part.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "sim/preparation/cut_places.h"

namespace servomill::sim::preparation {

/// Directions at a place of a path: t along it, l = k x t / |k x t| to its left, m = t x l.
struct PathFrame {
  Eigen::Vector3d t = Eigen::Vector3d::Zero(), l = Eigen::Vector3d::Zero(),
                  m = Eigen::Vector3d::Zero();
};

struct FacePoint {
  double s = 0.0;  // m, along the run
  double deviation = 0.0;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // as seen from the part
  Eigen::Vector2d on_path = Eigen::Vector2d::Zero();  // along l and m of its place; unit
};

/// A point that a part of the cutter has made, with its normal as seen from the path: that of a
/// flank is to the left or to the right.
FacePoint face_point(CutBy by, double s, double deviation, const Eigen::Vector3d& normal,
                     const PathFrame& at);

/// One face. Points come in rising order of s.
class ProbedFace {
 public:
  explicit ProbedFace(CutBy by) : by_(by) {}

  /// Cosine of the angle between the normal of a point and that of the last one, the smaller one
  /// of part and path; 1 for the first point.
  double likeness(const FacePoint& point) const;
  void add(const FacePoint& point);

  struct At {
    Eigen::Vector3d normal;
    double deviation;
  };
  /// Between two points the normal turns with the path or stays with the part, as it turns less;
  /// beyond them it is that of the first or last point.
  /// @param axis  of the tool there
  At at(double s, const PathFrame& frame, const Eigen::Vector3d& axis) const;

 private:
  CutBy by_;
  std::vector<FacePoint> points_;
  double merged_ = 1.0;  // points in the last one
};

}  // namespace servomill::sim::preparation
