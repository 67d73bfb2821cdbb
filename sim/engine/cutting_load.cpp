#include "sim/engine/cutting_load.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "plant/cutting/cutting_force.h"

namespace servomill::sim::engine {

CuttingTable::CuttingTable(std::vector<Row> rows) : rows_(std::move(rows)) {
  assert(std::is_sorted(rows_.begin(), rows_.end(),
                        [](const Row& a, const Row& b) { return a.s < b.s; }));
}

Eigen::Vector3d CuttingTable::force(double s, double speed, double wear, double wear_per_m,
                                    Cursor& cursor) const {
  if (rows_.size() < 2 || s < rows_.front().s || s > rows_.back().s) return Eigen::Vector3d::Zero();
  std::size_t& row = cursor.row;
  while (row + 2 < rows_.size() && s > rows_[row + 1].s) ++row;
  while (row > 0 && s < rows_[row].s) --row;
  const Row &a = rows_[row], &b = rows_[row + 1];
  const double length = b.s - a.s;
  const double share = length > 0.0 ? (s - a.s) / length : 1.0;
  const auto between = [share](const auto& from, const auto& to) {
    return (from + share * (to - from)).eval();
  };
  const auto number = [share](double from, double to) { return from + share * (to - from); };
  const double c = number(a.chip, b.chip) * speed;
  const double edges = wear + wear_per_m * number(a.cut, b.cut);
  return c * between(a.shear, b.shear) + plant::bearing_share(c) * edges * between(a.edge, b.edge);
}

CuttingLoad::CuttingLoad(const CuttingTable& table, const model::CuttingWear& wear,
                         const plant::MachineChain& chain, const Eigen::Vector3d& compliance)
    : table_(table), wear_(wear), chain_(chain), compliance_(compliance) {}

void CuttingLoad::advance(double s, double dt, const Joints& Q, const Eigen::Vector3d& p_ST) {
  const double speed = std::max(0.0, (s - s_) / dt);
  s_ = s;
  force_ = table_.force(s, speed, wear_.initial, wear_.per_m, cursor_);
  if (force_.isZero(0.0)) {
    load_.setZero();
    deflection_.setZero();
    return;
  }
  load_ = plant::jacobian(chain_, Q, p_ST).J_pQ.transpose() * force_;
  deflection_ = compliance_.cwiseProduct(load_.head<kLinearJoints>());
}

}  // namespace servomill::sim::engine
