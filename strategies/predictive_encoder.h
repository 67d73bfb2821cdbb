/// Virtual encoder that knows the position loops: it evaluates the errors at poses ahead on the
/// observed motion, feeds them back through the inverse of each loop, and takes away what the
/// friction of the displaced axes would hold back.
///
/// Once per model period, with y = Q_fb + d0, the scales without the displacement that is wanted
/// (d0 the displacement for this pose, w = -d0 the wanted motion of the axis):
///
///     p, v, a    observed from y (motion_observer.h): the motion that the NC commands
///     Q(t_k)   = p + v t_k + a t_k^2/2 - d0(t_k)       of all axes, displaced or not
///     d        = H [d0(Q(t_k))] - C (F(v - d0') - F(v))                      (loop_inverse.h)
///
/// F is the identified friction (bristle_model.h), once for the whole motion of the axis and once
/// for the commanded motion alone: the difference is what displacing it costs, while friction of
/// the commanded motion is left to the NC and its friction compensation. d0' comes from the
/// identified model along the motion of the other axes, not from differences of readings.
///
/// A disturbance observer in the usual sense, without a friction model, cannot do this: it would
/// estimate the sum of force and setpoint, and the setpoint is unknown to a virtual encoder.
/// Source of friction compensation by a modelled force: Armstrong-Helouvry, Dupont, Canudas de Wit,
/// A survey of models, analysis tools and compensation methods for the control of machines with
/// friction, Automatica 30 (1994) 1083-1138, section 5.
#pragma once

#include <memory>

#include "strategies/axis_displacement.h"
#include "strategies/loop_inverse.h"
#include "strategies/strategy.h"

namespace servomill::strategies {

/// Choices that all virtual encoders share.
struct VirtualEncoderParams {
  Action action = Action::compensate;
  Iterations iterations = Iterations::one;
  DisplacedAxes axes = DisplacedAxes::linear;
  double sigma_0 = 0.0;
  Joints max = Joints::Zero();       // m, rad
  Joints max_rate = Joints::Zero();  // m/s, rad/s

  int displaced() const { return axes == DisplacedAxes::all ? kJoints : kLinearJoints; }
};

/// Constants of the prediction.
struct Prediction {
  double bandwidth = 0.0;  // rad/s, of the observer
  PreviewTimes times{};    // s; 0: the loops are not known
  std::array<LoopInverse, kJoints> inverse{};
  bool knows_friction = false;
  std::array<ForceInverse, kJoints> force_inverse{};
  std::array<BristleFriction, kJoints> friction{};
};

/// @param identified  with its loops; without them displacements are fed back as they are
/// @param friction    true: the friction of displaced axes is compensated
Prediction prediction_of(const IdentifiedMachine& identified, const VirtualEncoderParams& params,
                         double bandwidth, bool friction);

/// @param identified  must outlive the part
std::unique_ptr<FeedbackPart> predictive_encoder(const IdentifiedMachine& identified,
                                                 const VirtualEncoderParams& params,
                                                 const Prediction& prediction, double model_period);

}  // namespace servomill::strategies
