#include "plant/cutting/stock.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace servomill::plant {
namespace {

Eigen::Vector2d turned(const Eigen::Vector2d& v, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

bool holds(const StockBox& box, const Eigen::Vector3d& p) {
  const Eigen::Vector3d half = 0.5 * (box.to - box.from);
  Eigen::Vector3d d = p - 0.5 * (box.from + box.to);
  if (box.turned != 0.0) d.head<2>() = turned(d.head<2>(), -box.turned);
  return (d.cwiseAbs().array() <= half.array()).all();
}

bool holds(const StockCylinder& cylinder, const Eigen::Vector3d& p) {
  return p.z() >= cylinder.from && p.z() <= cylinder.to &&
         (p.head<2>() - cylinder.centre).squaredNorm() <= cylinder.radius * cylinder.radius;
}

Eigen::AlignedBox3d box_of(const StockBox& box) {
  const Eigen::Vector3d centre = 0.5 * (box.from + box.to);
  Eigen::Vector3d half = 0.5 * (box.to - box.from);
  const double c = std::abs(std::cos(box.turned)), s = std::abs(std::sin(box.turned));
  half.head<2>() = Eigen::Vector2d(c * half.x() + s * half.y(), s * half.x() + c * half.y());
  return {centre - half, centre + half};
}

Eigen::AlignedBox3d box_of(const StockCylinder& cylinder) {
  const Eigen::Vector2d R = Eigen::Vector2d::Constant(cylinder.radius);
  const Eigen::Vector2d low = cylinder.centre - R, high = cylinder.centre + R;
  return {Eigen::Vector3d(low.x(), low.y(), cylinder.from),
          Eigen::Vector3d(high.x(), high.y(), cylinder.to)};
}

}  // namespace

bool contains(const StockSolid& solid, const Eigen::Vector3d& p) {
  return std::visit([&](const auto& one) { return holds(one, p); }, solid);
}

Eigen::AlignedBox3d bounds(const StockSolid& solid) {
  return std::visit([](const auto& one) { return box_of(one); }, solid);
}

Stock::Stock(std::vector<StockSolid> solids) : solids_(std::move(solids)) {
  for (const StockSolid& solid : solids_) bounds_.extend(plant::bounds(solid));
}

bool Stock::contains(const Eigen::Vector3d& p) const {
  return std::any_of(solids_.begin(), solids_.end(),
                     [&](const StockSolid& solid) { return plant::contains(solid, p); });
}

}  // namespace servomill::plant
