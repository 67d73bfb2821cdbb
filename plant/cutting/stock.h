/// The stock: a union of simple solids in work coordinates.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <variant>
#include <vector>

namespace servomill::plant {

/// A box turned about Z about its own centre.
struct StockBox {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(),
                  to = Eigen::Vector3d::Zero();  // m, before turning
  double turned = 0.0;                           // rad
  bool operator==(const StockBox&) const = default;
};

/// A cylinder along Z.
struct StockCylinder {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // m
  double radius = 0.0;                               // m
  double from = 0.0, to = 0.0;                       // m, in Z
  bool operator==(const StockCylinder&) const = default;
};

using StockSolid = std::variant<StockBox, StockCylinder>;

bool contains(const StockSolid& solid, const Eigen::Vector3d& p);
Eigen::AlignedBox3d bounds(const StockSolid& solid);

/// Union of solids; contains its surface.
class Stock {
 public:
  Stock() = default;
  explicit Stock(std::vector<StockSolid> solids);

  bool empty() const { return solids_.empty(); }
  const std::vector<StockSolid>& solids() const { return solids_; }
  bool contains(const Eigen::Vector3d& p) const;
  /// Smallest box along X, Y, Z that holds everything; empty if there is nothing.
  const Eigen::AlignedBox3d& bounds() const { return bounds_; }

 private:
  std::vector<StockSolid> solids_;
  Eigen::AlignedBox3d bounds_;
};

}  // namespace servomill::plant
