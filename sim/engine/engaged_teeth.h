/// Teeth of the cutters of a program in the material that they meet along its path.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "plant/cutting/engagement.h"
#include "plant/cutting/material.h"
#include "plant/cutting/tooth_force.h"
#include "sim/engine/chip_regeneration.h"

namespace servomill::sim::engine {

/// Engagements of a cutting table (cutting_load.h): edges of all teeth at the places of its rows.
class EngagedTeeth {
 public:
  /// @param regeneration  forces of teeth that vibrate are asked for
  explicit EngagedTeeth(const plant::CuttingCoefficients& coefficients, bool regeneration = false)
      : K_(coefficients), regeneration_(regeneration) {}

  /// Adds an engagement. Returns its number.
  /// @param number  of the tool
  /// @param frame   of the cutter, in W
  /// @param turns   1/s, of the spindle, counter-clockwise < 0
  int add(int number, const plant::Cutter& cutter, const plant::CutterFrame& frame,
          std::span<const plant::EngagedArc> arcs, double turns);

  /// Largest number of teeth that pass in a second (1/s) where anything is cut.
  double passing_frequency() const { return passing_frequency_; }
  /// Largest time from tooth to tooth (s) where anything is cut.
  double longest_passage() const { return longest_passage_; }

  /// Mean force on all teeth (3; N, in W) while the spindle turns. Neither allocates nor throws.
  /// @param engagement  its number
  /// @param angle       rad, of tooth 0, as plant::spindle_directions() count it; any
  /// @param rotation    rad, by which the spindle turns; > 0 clockwise, at most a turn
  /// @param c           m, feed per tooth
  Eigen::Vector3d force(int engagement, double angle, double rotation, double c, double wear) const;
  /// The same of teeth that meet the surface of the displacements before.
  Eigen::Vector3d force(int engagement, double angle, double rotation, double c, double wear,
                        const DisplacementsBefore& before) const;
  /// Number of slices of all edges that a force of an engagement is summed over.
  double edges(int engagement) const;
  /// Number of teeth of an engagement.
  int teeth(int engagement) const;

 private:
  struct Engagement {
    Eigen::Matrix3d axes;  // e1, e2, k in W
    plant::ToothAngle phi;
    std::size_t tool = 0;        // in chips_
    std::size_t first, end = 0;  // in slices_
  };

  plant::CuttingCoefficients K_;
  bool regeneration_;
  std::vector<Engagement> engagements_;
  std::vector<plant::EdgeSlice> slices_;
  std::vector<plant::ToothChips> chips_;      // of the tools
  std::vector<std::vector<double>> offsets_;  // of their teeth, m
  std::map<int, std::size_t> tools_;          // by number, in chips_
  double passing_frequency_ = 0.0, longest_passage_ = 0.0;
};

}  // namespace servomill::sim::engine
