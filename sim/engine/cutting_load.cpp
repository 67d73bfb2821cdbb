#include "sim/engine/cutting_load.h"

#include <algorithm>
#include <cassert>
#include <numbers>
#include <utility>

#include "plant/cutting/cutting_force.h"
#include "sim/engine/engaged_teeth.h"

namespace servomill::sim::engine {

CuttingTable::CuttingTable(std::vector<Row> rows) : rows_(std::move(rows)) {
  assert(std::is_sorted(rows_.begin(), rows_.end(),
                        [](const Row& a, const Row& b) { return a.s < b.s; }));
}

bool CuttingTable::reaches(double s) const {
  return rows_.size() >= 2 && s >= rows_.front().s && s <= rows_.back().s;
}

CuttingTable::Place CuttingTable::place(double s, Cursor& cursor) const {
  std::size_t& row = cursor.row;
  while (row + 2 < rows_.size() && s > rows_[row + 1].s) ++row;
  while (row > 0 && s < rows_[row].s) --row;
  const Row &a = rows_[row], &b = rows_[row + 1];
  const double length = b.s - a.s;
  return {&a, &b, length > 0.0 ? (s - a.s) / length : 1.0};
}

Eigen::Vector3d CuttingTable::force(double s, double speed, double wear, double wear_per_m,
                                    Cursor& cursor) const {
  if (!reaches(s)) return Eigen::Vector3d::Zero();
  const Place at = place(s, cursor);
  const auto between = [&](Eigen::Vector3d Row::*member) {
    const Eigen::Vector3d &from = at.before->*member, &to = at.after->*member;
    return (from + at.share * (to - from)).eval();
  };
  const double c = at.number(&Row::chip) * speed;
  const double edges = wear + wear_per_m * at.number(&Row::cut);
  return c * between(&Row::shear) + plant::bearing_share(c) * edges * between(&Row::edge);
}

CuttingLoad::CuttingLoad(const CuttingTable& table, const model::CuttingWear& wear,
                         const plant::MachineChain& chain, const Eigen::Vector3d& compliance,
                         const EngagedTeeth* teeth)
    : table_(table), wear_(wear), chain_(chain), compliance_(compliance), teeth_(teeth) {}

void CuttingLoad::advance(double s, double dt, const Joints& Q, const Eigen::Vector3d& p_ST) {
  const double speed = std::max(0.0, (s - s_) / dt);
  s_ = s;
  if (teeth_ != nullptr) {
    speed_ = speed;
    elapsed_ = 0.0;
    J_pQ_ = plant::jacobian(chain_, Q, p_ST).J_pQ;
    return;
  }
  const Eigen::Vector3d force = table_.force(s, speed, wear_.initial, wear_.per_m, cursor_);
  if (!force.isZero(0.0)) J_pQ_ = plant::jacobian(chain_, Q, p_ST).J_pQ;
  set_force(force);
}

void CuttingLoad::turn(double dt) {
  angle_ += rate_ * turned_;
  turned_ = dt;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  const double s = s_ + speed_ * elapsed_;
  elapsed_ += dt;
  if (!table_.reaches(s)) return set_force(force);
  const CuttingTable::Place at = table_.place(s, cursor_);
  rate_ = 2.0 * std::numbers::pi * at.after->turns;
  const double c = at.number(&CuttingTable::Row::chip) * speed_;
  if (c <= 0.0 || rate_ == 0.0) return set_force(force);
  const double edges = wear_.initial + wear_.per_m * at.number(&CuttingTable::Row::cut);
  const auto add = [&](const CuttingTable::Row& row, double share) {
    if (share <= 0.0 || row.teeth < 0) return;
    force +=
        share * teeth_->force(row.teeth, angle_, rate_ * dt, c, plant::bearing_share(c) * edges);
  };
  add(*at.before, 1.0 - at.share);
  add(*at.after, at.share);
  set_force(force);
}

void CuttingLoad::set_force(const Eigen::Vector3d& force) {
  force_ = force;
  if (force_.isZero(0.0)) {
    load_.setZero();
    deflection_.setZero();
    return;
  }
  load_ = J_pQ_.transpose() * force_;
  deflection_ = compliance_.cwiseProduct(load_.head<kLinearJoints>());
}

}  // namespace servomill::sim::engine
