#include "sim/engine/cutting_load.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "plant/cutting/cutting_force.h"
#include "sim/engine/depth_of_cut.h"
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

double CuttingTable::power(double s, double speed, double wear, double wear_per_m,
                           Cursor& cursor) const {
  if (!reaches(s)) return 0.0;
  const Place at = place(s, cursor);
  const double c = at.number(&Row::chip) * speed;
  const double edges = plant::bearing_share(c) * (wear + wear_per_m * at.number(&Row::cut));
  const double torque = c * at.number(&Row::torque_shear) + edges * at.number(&Row::torque_edge);
  return 2.0 * std::numbers::pi * std::abs(at.after->turns) * torque;
}

namespace {

// Modes that swing are part of the regeneration where chips regenerate.
std::vector<plant::StructuralMode> modes_not_regenerating(
    const std::vector<plant::StructuralMode>& modes, const ChipRegeneration* regeneration) {
  std::vector<plant::StructuralMode> out = modes;
  if (regeneration != nullptr) {
    std::erase_if(out, [](const plant::StructuralMode& one) { return !one.is_static(); });
  }
  return out;
}

}  // namespace

CuttingLoad::CuttingLoad(const CuttingTable& table, const model::CuttingWear& wear,
                         const plant::MachineChain& chain, const Eigen::Vector3d& compliance,
                         const EngagedTeeth* teeth, const std::vector<DisplacedCut>* displaced,
                         const std::vector<plant::StructuralMode>& modes,
                         ChipRegeneration* regeneration)
    : table_(table),
      wear_(wear),
      chain_(chain),
      compliance_(compliance),
      teeth_(teeth),
      displaced_(displaced),
      regeneration_(regeneration),
      modes_(modes_not_regenerating(modes, regeneration)) {}

void CuttingLoad::advance(double s, double dt, const Joints& Q, const Eigen::Vector3d& p_ST) {
  const double speed = std::max(0.0, (s - s_) / dt);
  s_ = s;
  speed_ = speed;
  if (teeth_ != nullptr) {
    elapsed_ = 0.0;
    J_pQ_ = plant::jacobian(chain_, Q, p_ST).J_pQ;
    return;
  }
  swing(dt);
  Eigen::Vector3d force = table_.force(s, speed, wear_.initial, wear_.per_m, cursor_);
  if (!force.isZero(0.0)) J_pQ_ = plant::jacobian(chain_, Q, p_ST).J_pQ;
  if (displaced_ != nullptr && !force.isZero(0.0)) {
    force = force_at(table_.place(s, cursor_), speed, 0.0);
  }
  set_force(force);
}

double CuttingLoad::power() {
  return table_.power(s_, speed_, wear_.initial, wear_.per_m, cursor_);
}

void CuttingLoad::turn(double dt) {
  angle_ += rate_ * turned_;
  swing(std::exchange(turned_, dt));
  const double s = s_ + speed_ * elapsed_;
  elapsed_ += dt;
  if (!table_.reaches(s)) {
    if (regeneration_ != nullptr) regeneration_->rest(J_pQ_.leftCols<kLinearJoints>());
    return set_force(Eigen::Vector3d::Zero());
  }
  const CuttingTable::Place at = table_.place(s, cursor_);
  rate_ = 2.0 * std::numbers::pi * at.after->turns;
  if (regeneration_ != nullptr) return set_force(regenerated_force(at, rate_ * dt));
  set_force(rate_ == 0.0 ? Eigen::Vector3d::Zero() : force_at(at, speed_, rate_ * dt));
}

// Force at a place of the table.
// @param rotation  rad, of the teeth, where they are resolved
Eigen::Vector3d CuttingLoad::force_at(const CuttingTable::Place& at, double speed,
                                      double rotation) {
  const double c = at.number(&CuttingTable::Row::chip) * speed;
  if (c <= 0.0) return Eigen::Vector3d::Zero();
  const double edges =
      plant::bearing_share(c) * (wear_.initial + wear_.per_m * at.number(&CuttingTable::Row::cut));
  const std::array<ForcesNearby, 2> places = {
      forces_at(*at.before, 1.0 - at.share, c, edges, rotation),
      forces_at(*at.after, at.share, c, edges, rotation)};
  if (displaced_ == nullptr) {
    return places[0].share * places[0].nominal + places[1].share * places[1].nominal;
  }
  const auto J = J_pQ_.leftCols<kLinearJoints>();
  ForceAtDepth found;
  if (modes_.is_rigid()) {
    found = force_at_actual_depth(places, deviation_, J * compliance_.asDiagonal() * J.transpose());
  } else {
    // a mode is where the force until now has taken it
    const Eigen::Matrix3d C =
        Eigen::Matrix3d(compliance_.asDiagonal()) + modes_.static_compliance();
    found =
        force_at_actual_depth(places, deviation_ + J * modes_.of_modes(), J * C * J.transpose());
  }
  off_path_ = std::max(off_path_, found.off_path);
  digs_in_ |= found.digs_in;
  return found.force;
}

// The same of teeth that meet the surface of the teeth before. A step of the vibration.
Eigen::Vector3d CuttingLoad::regenerated_force(const CuttingTable::Place& at, double rotation) {
  const Eigen::Matrix3d J = J_pQ_.leftCols<kLinearJoints>();
  const std::array<std::pair<const CuttingTable::Row*, double>, 2> rows = {
      {{at.before, 1.0 - at.share}, {at.after, at.share}}};
  const double c = at.number(&CuttingTable::Row::chip) * speed_;
  const auto cuts = [](const auto& row) { return row.second > 0.0 && row.first->teeth >= 0; };
  const auto* const cutting = std::find_if(rows.begin(), rows.end(), cuts);
  if (rotation == 0.0 || c <= 0.0 || cutting == rows.end()) {
    regeneration_->rest(J);
    return Eigen::Vector3d::Zero();
  }
  const double edges =
      plant::bearing_share(c) * (wear_.initial + wear_.per_m * at.number(&CuttingTable::Row::cut));
  const double passage =
      2.0 * std::numbers::pi / std::abs(rate_) / teeth_->teeth(cutting->first->teeth);
  const Eigen::Vector3d found =
      regeneration_->step(J, passage, [&](const DisplacementsBefore& before) {
        Eigen::Vector3d force = Eigen::Vector3d::Zero();
        for (const auto& [row, share] : rows) {
          if (share <= 0.0 || row->teeth < 0) continue;
          force += share * teeth_->force(row->teeth, angle_, rotation, c, edges, before);
        }
        return force;
      });
  digs_in_ |= regeneration_->digs_in();
  return found;
}

Eigen::Vector3d CuttingLoad::deflection(double after) const {
  Eigen::Vector3d out = deflection_;
  if (!modes_.is_rigid()) out += modes_.after(after);
  if (regeneration_ != nullptr) out += regeneration_->deflection(after);
  return out;
}

// Forces of one row and of its displaced cuts.
ForcesNearby CuttingLoad::forces_at(const CuttingTable::Row& row, double share, double c,
                                    double edges, double rotation) const {
  ForcesNearby out{.share = share};
  if (share <= 0.0) return out;
  const auto force = [&](const Eigen::Vector3d& shear, const Eigen::Vector3d& edge,
                         std::int32_t teeth) -> Eigen::Vector3d {
    if (teeth_ == nullptr) return c * shear + edges * edge;
    if (teeth < 0) return Eigen::Vector3d::Zero();
    return teeth_->force(teeth, angle_, rotation, c, edges);
  };
  out.nominal = force(row.shear, row.edge, row.teeth);
  if (displaced_ == nullptr || row.displaced < 0) return out;
  out.cut = &(*displaced_)[static_cast<std::size_t>(row.displaced)];
  for (std::size_t i = 0; i < out.displaced.size(); ++i) {
    const DisplacedCut::Force& beside = out.cut->at[i];
    out.displaced[i] = force(beside.shear, beside.edge, beside.teeth);
  }
  return out;
}

void CuttingLoad::set_force(const Eigen::Vector3d& force) {
  force_ = force;
  if (force_.isZero(0.0)) {
    load_.setZero();
    deflection_.setZero();
  } else {
    load_ = J_pQ_.transpose() * force_;
    deflection_ = compliance_.cwiseProduct(load_.head<kLinearJoints>());
  }
  swing(0.0);
}

}  // namespace servomill::sim::engine
