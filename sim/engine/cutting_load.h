/// The force of the cut along a programmed path, and what it does to a machine that follows it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "plant/kinematics/chain.h"
#include "plant/structure/structural_deflection.h"
#include "sim/model/run_settings.h"

namespace servomill::sim::engine {

class EngagedTeeth;
struct DisplacedCut;
class ChipRegeneration;
struct ForcesNearby;

/// Average force of the work on the cutter over the arc length s of the original program. Linear
/// between rows; rows of equal s are a jump.
class CuttingTable {
 public:
  struct Row {
    double s = 0.0;     // m
    double chip = 0.0;  // s, feed per tooth over ds/dt: |dp_WT/ds| / (spindle speed * teeth)
    Eigen::Vector3d shear = Eigen::Vector3d::Zero();  // N per m of feed per tooth, in W
    Eigen::Vector3d edge = Eigen::Vector3d::Zero();   // N of a new edge, in W
    double cut = 0.0;                                 // m, cut by feed moves until here
    double turns = 0.0;           // 1/s, of the spindle, > 0 clockwise, towards this row
    std::int32_t teeth = -1;      // engagement (engaged_teeth.h); -1: none, or none is needed
    std::int32_t displaced = -1;  // displaced cut (depth_of_cut.h); likewise
    double torque_shear = 0.0,
           torque_edge = 0.0;  // N m per m of feed per tooth, N m; of a new edge
  };
  /// Place of the last force; makes forward reading O(1).
  struct Cursor {
    std::size_t row = 0;
  };

  CuttingTable() = default;
  /// @pre s does not fall from row to row
  explicit CuttingTable(std::vector<Row> rows);

  const std::vector<Row>& rows() const { return rows_; }

  /// F = c shear + wear edge (3; N, in W) with the feed per tooth c = chip ds/dt and the wear
  /// `wear` + `wear_per_m` times what has been cut; the term of the edge fades towards standstill
  /// (plant/cutting/cutting_force.h). Neither allocates nor throws.
  /// @param speed  ds/dt, m/s
  Eigen::Vector3d force(double s, double speed, double wear, double wear_per_m,
                        Cursor& cursor) const;

  /// Average power (W) by which the spindle cuts; wear and standstill as above.
  double power(double s, double speed, double wear, double wear_per_m, Cursor& cursor) const;

  /// The rows around s and how far s is from the first to the second, 0 to 1.
  /// @pre s is within the rows
  struct Place {
    const Row *before, *after;
    double share;
    double number(double Row::*member) const {
      return before->*member + share * (after->*member - before->*member);
    }
  };
  bool reaches(double s) const;
  Place place(double s, Cursor& cursor) const;

 private:
  std::vector<Row> rows_;
};

/// Cutting force on one run: the average one position period by position period, that of single
/// teeth step by step of their rotation.
class CuttingLoad {
 public:
  /// All arguments must outlive this.
  /// @param compliance  m/N, of the structure in each linear axis
  /// @param teeth       engagements of the table; nullptr: the average force acts
  /// @param displaced   cuts beside the path; nullptr: the depth of cut is the nominal one
  /// @param modes       of the structure, in addition to its compliance
  /// @param regeneration  of the chips of `teeth`; nullptr: chips are those of the feed
  CuttingLoad(const CuttingTable& table, const model::CuttingWear& wear,
              const plant::MachineChain& chain, const Eigen::Vector3d& compliance,
              const EngagedTeeth* teeth = nullptr,
              const std::vector<DisplacedCut>* displaced = nullptr,
              const std::vector<plant::StructuralMode>& modes = {},
              ChipRegeneration* regeneration = nullptr);

  /// Stands at s.
  void start(double s) { s_ = s; }
  /// The tool is off its nominal path by this (3; m, in W), deflection by cutting left out, from
  /// here on.
  void deviate(const Eigen::Vector3d& deviation) { deviation_ = deviation; }
  /// The path has gone on to s within `dt` (s) and the joints are at Q (5; m, rad).
  /// @param p_ST  m, tip of the tool in the spindle
  void advance(double s, double dt, const Joints& Q, const Eigen::Vector3d& p_ST);
  /// The spindle turns for `dt` (s) from here on: the mean force of the teeth meanwhile. Along the
  /// path the position period goes on at the speed of the last one. @pre there are teeth
  void turn(double dt);
  /// Angle of the spindle (rad, clockwise) a time (s) after the last turn() began, counted from the
  /// start of the run (plant::spindle_directions).
  double spindle_angle(double after) const { return angle_ + rate_ * after; }

  /// On the cutter, 3; N, in W.
  const Eigen::Vector3d& force() const { return force_; }
  /// On each joint (5; N, N m), towards +: J_pQ^T F by virtual work, of F acting at the tip.
  const Joints& load() const { return load_; }
  /// Average power (W) by which the spindle cuts: at the nominal depth of cut, teeth or not.
  double power();
  /// By which the structure gives way in each linear axis (3; m), a time (s) after advance() or, of
  /// single teeth, after turn(): compliance times load, the modes and, with regeneration, the
  /// vibration of the tool point.
  Eigen::Vector3d deflection(double after) const;
  /// Largest distance of the cutter from its nominal path across the feed while it cut (m), where
  /// the depth of cut is the actual one.
  double off_path() const { return off_path_; }
  /// True once the cut has drawn the tool in faster than the structure resists.
  bool digs_in() const { return digs_in_; }

 private:
  const CuttingTable& table_;
  const model::CuttingWear& wear_;
  const plant::MachineChain& chain_;
  const Eigen::Vector3d& compliance_;
  const EngagedTeeth* teeth_;
  const std::vector<DisplacedCut>* displaced_;
  ChipRegeneration* regeneration_;
  void set_force(const Eigen::Vector3d& force);
  // The structure goes on by dt (s) under the force that has been held.
  void swing(double dt) {
    if (!modes_.is_rigid()) modes_.advance(dt, load_.head<kLinearJoints>());
  }
  Eigen::Vector3d regenerated_force(const CuttingTable::Place& at, double rotation);
  Eigen::Vector3d force_at(const CuttingTable::Place& at, double speed, double rotation);
  ForcesNearby forces_at(const CuttingTable::Row& row, double share, double c, double edges,
                         double rotation) const;

  CuttingTable::Cursor cursor_;
  double off_path_ = 0.0;  // m
  bool digs_in_ = false;
  Eigen::Vector3d deviation_ = Eigen::Vector3d::Zero();
  double s_ = 0.0, speed_ = 0.0;
  double elapsed_ = 0.0;                            // s, of the position period
  double angle_ = 0.0, rate_ = 0.0, turned_ = 0.0;  // rad, rad/s, s; of the step in progress
  Eigen::Matrix<double, 3, kJoints> J_pQ_ = Eigen::Matrix<double, 3, kJoints>::Zero();
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero(), deflection_ = Eigen::Vector3d::Zero();
  Joints load_ = Joints::Zero();
  plant::StructuralDeflection modes_;
};

}  // namespace servomill::sim::engine
