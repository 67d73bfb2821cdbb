/// Places of a planned path at which a tool has cut probed points of its part.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "plant/cutting/cutter.h"

namespace servomill::sim::preparation {

/// The tool in one row of a path, in any frame that is fixed to the part.
struct ToolRow {
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();    // m
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  // from the tip to the spindle
  const plant::Cutter* cutter = nullptr;            // or none is known
  int run = -1;  // of feed motion of one tool without rapid moves in between; -1: in a rapid move
  int line = 0;  // of the program
};

/// Part of the cutter that makes a surface.
enum class CutBy : std::uint8_t { flank, tip, corner };

/// A place between a row and the next one.
struct CutPlace {
  std::size_t row = 0;
  double share = 0.0;
  CutBy by = CutBy::tip;
};

struct SurfacePoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // m, nominal
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // out of the part; unit
  double deviation = 0.0;                             // m
};

/// Distance (m) of the swept surface from a point, beyond its deviation, at which a path is no
/// longer taken for the one that has cut it.
inline constexpr double kFarthestCut = 0.1e-3;

struct CutSearch {
  std::vector<CutPlace> places;  // in the order of the path
  // if there are none: how near the surface of a cutter comes, and where
  double nearest = std::numeric_limits<double>::infinity();  // m
  std::size_t nearest_row = 0;
  bool is_along = false;  // near enough, but where the tool moves along the normal or its own axis
};

/// Finds where a point p with normal n was cut by a tool of radius R and corner radius r with its
/// tip at c and the axis k. With m, the direction of n across k:
///
///     n across k (within 2 deg)   flank    p + R n is on the axis, and p within the flute length
///     n along k (within 2 deg)    tip      p lies at the height of c, within R - r of the axis
///     else; ball ends: n along k  corner   p + r n + (R - r) m = c + r k
///
/// Between rows tip and axis are straight. Of all places that one counts at which the surface comes
/// nearest to p; of a tip, where the axis is then nearest. Places as near (within 2 um) count, too:
/// passes at several depths, spring passes, the end of a closed contour. An earlier pass that went
/// too deep would leave nothing for the last one to correct.
CutSearch find_cut(const std::vector<ToolRow>& rows, const SurfacePoint& point);

}  // namespace servomill::sim::preparation
