/// Reference for tests of chatter: milling with a structure of one mode that meets what its last
/// tooth has left, simulated on its own.
///
///     q'' + 2 zeta w q' + w^2 q = w^2 / k  d . F(t),    F = sum over teeth of (1) of
///     cutting_force.h
///
/// d is the direction of the mode across the axis, q d the displacement of the cutter. Teeth are
/// straight and equal. The chip of a tooth is its path minus the surface that is there, so that a
/// tooth that has left the cut leaves its chip to a later one. Small vibrations about the forced
/// motion follow the linear equation, in which every tooth stays in the cut:
///
///     h = r(phi) . d (q(t) - q(t - T)),  T the time from tooth to tooth                        (2)
///
/// A slot with four straight teeth and d = e2 has constant directional factors: sum sin cos = 0,
/// sum cos^2 = 1, so that its limit of stability is  a = -1 / (2 K_rc Re G(i w_c)).
///
/// Sources: J. Tlusty, S. Polacek, The stability of the machine tool against self-excited
/// vibration, Prod. Eng. Res. Conf. ASME (1963); Y. Altintas, Manufacturing Automation, 2nd ed.,
/// 2012, chapter 4.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "plant/cutting/chatter_stability.h"
#include "plant/cutting/material.h"

namespace servomill::plant {

/// A steady cut with the flank.
struct SteadyCut {
  CuttingCoefficients coefficients;
  int teeth = 2;
  double from = 0.0, to = 0.0;  // rad, phi where a tooth enters and leaves, 0 <= from < to <= pi
  double depth = 0.0;           // m, along the axis
  double turns = 0.0;           // 1/s, of the spindle
  double feed = 0.0;            // m, per tooth
};

/// Simulation in steps of which a whole number makes a tooth passage. Second order in the step:
/// the mode is propagated exactly under a force that is linear over the step, and a step in which
/// a tooth enters or leaves counts with the share that is cut.
class RegenerativeCut {
 public:
  enum class Chips {
    real,    // a chip is not negative; forced motion by feed and edges included
    linear,  // (2): small vibrations alone
  };
  /// @param steps  of a tooth passage, at least 10
  RegenerativeCut(const SteadyCut& cut, const ChatterMode& mode, Chips chips, int steps);

  double q() const { return q_; }    // m
  double dq() const { return dq_; }  // m/s
  /// Force on the mode, d . F (N).
  double force() const { return force_; }

  /// Displaces the cutter.
  void start(double q, double dq);
  void step();

  /// Complete state for linear chips: q, dq / w (m) and the surface in the cut (m).
  Eigen::VectorXd state() const;
  /// Multiplies the state. @pre linear chips
  void scale(double factor);

 private:
  double force_at(double q, int place) const;
  void leave(int place);

  SteadyCut cut_;
  ChatterMode mode_;
  Chips chips_;
  int steps_;
  double transition_[2][2], held_[2], rising_[2];  // of (q, dq) over a step, by a force at its
                                                   // begin and by one that rises to its end
  struct Angle {
    double share, along, tangential, advance;  // cut; r . d; t . d; m a tooth passage, along r
  };
  std::vector<Angle> angles_;    // of the places that a tooth passes in a turn
  std::vector<double> surface_;  // m, outward, there
  std::vector<int> cutting_;     // places in the arc
  int place_ = 0;                // of tooth 0
  double q_ = 0.0, dq_ = 0.0, force_ = 0.0;
};

/// Largest magnitude of the multipliers by which small vibrations grow from one tooth to the next,
/// and the multiplier: below 1 the cut is stable, -1 is a flip (two teeth a period of chatter).
struct Multiplier {
  double real = 0.0, imaginary = 0.0;
  double magnitude() const;
};
Multiplier chatter_multiplier(const SteadyCut& cut, const ChatterMode& mode, int steps);

/// Smallest depth (m) at which a cut is not stable, searched upwards in steps of deepest / 20 and
/// then by bisection to 1e-4; deepest if it is stable everywhere.
double stable_depth(SteadyCut cut, const ChatterMode& mode, double deepest, int steps);

}  // namespace servomill::plant
