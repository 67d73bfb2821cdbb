/// Parts that the observations of all kinds of readings are made of.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/calibration/observations.h"

namespace servomill::sim::calibration {

using Point = std::array<std::size_t, 3>;  ///< unknowns along X, Y, Z

/// Unknowns that the calibration of an artefact leaves open, common to all groups.
struct ArtefactUnknowns {
  std::optional<std::size_t> scale;  // none: exact
  std::vector<Point> balls;          // along the axes of the artefact; empty: exact
};

/// Adds observations and unknowns of set-ups, group by group.
class ObservationBuilder {
 public:
  ObservationBuilder(const readings::Readings& readings, const plant::MachineChain& chain);

  void begin(std::size_t group) { group_ = group; }
  Observations take() { return std::move(out_); }

  std::size_t index() const { return group_; }  ///< of the group at hand
  const readings::Readings& readings() const { return readings_; }
  const readings::Group& group() const { return readings_.groups[group_]; }
  const plant::MachineChain& chain() const { return chain_; }
  int joint(Axis axis) const { return *chain_.layout.joint_of(axis); }
  std::vector<Observation>& observations() { return out_.all; }

  std::size_t add_unknown(SetUpUnknown unknown);
  /// An unknown of the group at hand.
  std::size_t add_own(std::string name, double unit = 1e-6, std::string unit_name = "um",
                      std::optional<double> prior = std::nullopt);
  Point add_point(const std::string& name);
  /// Radius or length: unknown, or known to a stated uncertainty.
  std::size_t add_size(const std::string& name);
  /// The unknown scale of the group's instrument; none: exact.
  std::optional<std::size_t> scale() const;
  const ArtefactUnknowns& calibration_of(std::size_t artefact);

  /// One number of a row, of the tool along (or about) the direction of `pose`.
  Observation& add(std::size_t row, int number, Pose pose);
  static void correct(Observation& one, double by);
  /// The same for a group that drifts, once all its numbers are there: linear in time from the
  /// first row on; without times from row to row.
  void add_drift();
  /// The same where linear axes turn round: how much of the lost motion is behind them there is an
  /// unknown of each row.
  void add_turning_points();
  /// 0 at the first row, 1 at the last one.
  double share_of_time(std::size_t row) const;

  Eigen::Vector3d tip(const Joints& Q) const;
  /// Direction in W of a deviation along or about an axis of the machine, at these joints.
  Eigen::Vector3d direction_of(Axis axis, const Joints& Q) const;
  /// The axis about which a rotary axis turns, seen from W.
  Eigen::Vector3d turn_of(Axis axis, const Joints& Q) const;

 private:
  const readings::Readings& readings_;
  const plant::MachineChain& chain_;
  std::size_t group_ = 0;
  std::vector<std::optional<std::size_t>> scales_;  // of instruments
  std::map<std::size_t, ArtefactUnknowns> artefacts_;
  Observations out_;
};

}  // namespace servomill::sim::calibration
