/// A touch probe in the spindle and the bodies that it meets.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/metrology/probed_bodies.h"

namespace servomill::sim::model {

/// The probe switches where the ball of its stylus has gone beyond the first contact by
///
///     pretravel + lobing |n_xy| cos(lobes a - phase) + noise                                  (1)
///
/// along n, the outward normal of the surface in the frame of the spindle, and a its angle about
/// the spindle axis. Source of the lobes: Estler et al., Error compensation for CMM touch trigger
/// probes, Precision Engineering 19 (1996): three contacts that carry the stylus make three lobes.
struct TouchProbe {
  double radius = 0.0;                               // m, of the ball of the stylus
  Eigen::Vector3d stylus = Eigen::Vector3d::Zero();  // m, in S: from the TCP to the ball's centre
  double pretravel = 0.0;                            // m
  double lobing = 0.0;                               // m, amplitude
  int lobes = 3;                                     // about the spindle
  double lobing_phase = 0.0;                         // rad
  double repeatability = 0.0;                        // m, standard deviation
  double delay = 0.0;                                // s, from switching to latching
  std::uint64_t seed = 1;
  std::vector<metrology::ProbedBody> bodies;  // in work coordinates of the program
  Place place;
};

}  // namespace servomill::sim::model
