/// Measured points aligned with a nominal part by a rigid motion.
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "sim/metrology/points.h"

namespace servomill::sim::metrology {

class TriangleMesh;  // sim/metrology/triangle_mesh.h

struct BestFit {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();  // measured -> nominal
  std::vector<double> distances;  // m, of each moved point from the part; positive outside
  double rms = 0.0;               // m, of them
  int steps = 0;
};

/// Continues "best fit: ...".
struct NoFit {
  std::string why;
};

/// The motion with the smallest sum of squared distances between moved points and their partners,
/// in one step from the singular values of their covariance. Distances are >= 0 here.
/// NoFit: fewer than three points, or all on a line
/// Source: W. Kabsch, A solution for the best rotation to relate two sets of vectors, Acta Cryst.
/// A32 (1976); with the sign of S. Umeyama, IEEE Trans. Pattern Anal. Mach. Intell. 13 (1991).
std::variant<BestFit, NoFit> best_fit(Points3 measured, Points3 nominal);

/// The same for distances from planes: each moved point from the plane through its own nominal
/// point across its normal (unit), as where a part is probed along normals.
/// NoFit: a motion exists that no point would notice; it is said which
std::variant<BestFit, NoFit> best_fit(Points3 measured, Points3 nominal, Points3 normals);

/// The same for distances from the surface of a part, whatever points are nearest (iterative
/// closest point). A step is Gauss-Newton on the distances (Y. Chen, G. Medioni, 1992: point to
/// plane); where that would not lower their sum of squares, the step is the closed-form one to the
/// nearest points (P. J. Besl, N. D. McKay, 1992: point to point), which never raises it. Ends
/// when neither lowers the sum, and with NoFit after 200 steps.
/// @param start  where the search begins, measured -> nominal. On a part like M1 of ISO 10791-7
///               (160 mm) starts up to 10 deg and 10 mm away find the way back from points all over
///               it (tested); from farther, or from few points, the nearest minimum may be another
///               one
/// NoFit: as above; also where the distances hardly notice a motion (by less than 1 % of it), as of
/// a cylinder of facets about its axis
std::variant<BestFit, NoFit> best_fit(
    Points3 measured, const TriangleMesh& nominal,
    const Eigen::Isometry3d& start = Eigen::Isometry3d::Identity());

/// For a quiver plot: a nominal place and how far the measured one lies from it.
struct Arrow {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();      // m
  Eigen::Vector3d deviation = Eigen::Vector3d::Zero();  // m, along the normal
};

/// Deviations of moved points from the surface, at the nearest points of it.
std::vector<Arrow> quiver(Points3 measured, const Eigen::Isometry3d& motion,
                          const TriangleMesh& nominal);
/// Deviations of moved points along the normals (unit) of their nominal points.
std::vector<Arrow> quiver(Points3 measured, const Eigen::Isometry3d& motion, Points3 nominal,
                          Points3 normals);

}  // namespace servomill::sim::metrology
