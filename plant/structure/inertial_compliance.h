/// How the structure between scales and tool tip gives way to the acceleration of one axis and to
/// a force at the tip.
#pragma once

#include <Eigen/Core>

#include "plant/vocabulary/axes.h"

namespace servomill::plant {

/// Mode of unit static gain, excited by the acceleration a of a slide:
///   eta'' + 2 zeta w eta' + w^2 eta = -w^2 a          eta / a = -G(s), G(s) = w^2 / (s^2 + 2 zeta
///   w s + w^2)
struct Mode {
  double w = 0.0;     // rad/s, undamped natural frequency
  double zeta = 0.0;  // damping ratio, below 1
  bool operator==(const Mode&) const = default;
};

/// Displacement of the tip along one linear axis by the acceleration of one joint. With k > 0 the
/// tip lags behind:
///   e_i = -k_ij(Q) G_ij(s) a_j,   k_ij(Q) = gain + gain_slope Q[along],   G_ij = 1 or that of a
///   mode
/// Source: Heidenhain, Technical Manual iTNC 530 HSCI (2013), pp. 688-689 (cross talk compensation:
/// static, k linear in one position).
struct InertialCompliance {
  int direction = 0;        // 0 to 2: X, Y, Z; towards + of the joint
  int joint = 0;            // that accelerates
  double gain = 0.0;        // m per m/s^2 (m per rad/s^2 of a rotary joint)
  double gain_slope = 0.0;  // the same per m
  int along = 0;            // linear joint on whose position k depends
  Mode mode = {};           // w = 0: static

  bool operator==(const InertialCompliance&) const = default;
  bool is_static() const { return mode.w == 0.0; }
  double gain_at(const Joints& Q) const { return gain + gain_slope * Q[along]; }
};

/// One mode of the structure. With the force F (3; N, towards + of the linear axes) that acts at
/// the tip it moves along u by q,
///
///   q = c G(s) (u . F),   d = u q,   G = 1 or that of a mode
///
/// so that modes add up to the compliance C = sum c u u^T, which is symmetric (Maxwell and Betti: a
/// force along Y moves the tip along X as much as the same force along X moves it along Y) and
/// positive.
/// Source: D. J. Ewins, Modal Testing, 2000, eq. (2.60): receptance of one mode.
struct StructuralMode {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  // u, unit, along the linear axes
  double compliance = 0.0;                               // c, m/N
  Mode mode = {};                                        // w = 0: static

  bool operator==(const StructuralMode&) const = default;
  bool is_static() const { return mode.w == 0.0; }
};

}  // namespace servomill::plant
