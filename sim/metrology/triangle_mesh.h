/// Closed surfaces of triangles, as CAD systems write them (STL).
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace servomill::sim::metrology {

/// A point of a surface.
struct SurfacePoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, out of the body
  double distance = 0.0;  // of the place that was asked for: positive outside
  bool on_face = true;    // else on an edge or a corner, where the normal is a mean of those around
};

/// Corners of triangles, counter-clockwise seen from outside.
struct Triangles {
  std::vector<Eigen::Vector3d> corners;       // m, each place once
  std::vector<std::array<int, 3>> triangles;  // indices of corners
};

/// A body bounded by triangles: closed, facing outwards, none without area.
class TriangleMesh {
 public:
  /// @throws InputError with `file`, naming triangles by number from 1, if there are no triangles,
  ///   a coordinate is not finite, a triangle has no area, edges are open (how many, and the
  ///   first), two neighbours face different ways, or all face inwards
  explicit TriangleMesh(Triangles triangles, const std::string& file = "mesh");

  /// Reads STL in mm, binary or ASCII, of one or more solids. Corners are one where their
  /// coordinates are equal. Normals in the file are not used: the order of the corners says which
  /// side is out.
  /// @throws InputError as above, with line and column (ASCII) or triangle and byte (binary) also
  ///   for files that break off or hold something else
  static TriangleMesh parse(std::string_view bytes, const std::string& file);

  TriangleMesh(TriangleMesh&&) noexcept;
  TriangleMesh& operator=(TriangleMesh&&) noexcept;
  ~TriangleMesh();

  /// The point of the surface nearest to a place. Exact: every triangle is covered by balls around
  /// sample points, of one radius h; a triangle nearer than one at distance d has a sample within
  /// d + h, and all triangles with such samples are looked at. The sign is that of the
  /// angle-weighted normal. Thread-safe.
  /// Source: J. A. Baerentzen, H. Aanaes, Signed distance computation using the angle weighted
  /// pseudonormal, IEEE Trans. Vis. Comput. Graph. 11 (2005), section 3.
  SurfacePoint closest(const Eigen::Vector3d& place) const;

  const Triangles& triangles() const;
  double volume() const;  // m^3

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// A binary STL file in mm. It holds single precision: coordinates are rounded by up to 6e-8 of
/// themselves, 4 nm at 100 mm.
std::string binary_stl(const Triangles& triangles);

}  // namespace servomill::sim::metrology
