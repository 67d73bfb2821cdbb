#include "strategies/predictive_encoder.h"

#include <algorithm>
#include <cassert>

#include "strategies/bristle_model.h"
#include "strategies/displacement_limits.h"
#include "strategies/motion_observer.h"
#include "strategies/pose_compensation.h"

namespace servomill::strategies {
namespace {

using Previews = std::array<Joints, kPreviews>;

// Displacements of the reading at some poses.
class Displacements {
 public:
  Displacements(const IdentifiedMachine& identified, const VirtualEncoderParams& params)
      : identified_(identified),
        params_(params),
        all_(identified, params.iterations, params.sigma_0) {}

  Joints at(const Joints& Q) const {
    if (params_.axes == DisplacedAxes::all) return all_.of_feedback(params_.action, Q);
    Eigen::Vector3d linear;
    feedback_displacement(identified_, params_.action, params_.iterations, Q, linear);
    Joints d = Joints::Zero();
    d.head<kLinearJoints>() = linear;
    return d;
  }

  // Linear axes alone are evaluated side by side.
  void at(const Previews& Q, Previews& d) const {
    if (params_.axes == DisplacedAxes::all) {
      for (std::size_t k = 0; k < kPreviews; ++k) d[k] = at(Q[k]);
      return;
    }
    JointLanes poses{};
    LinearJointLanes linear{};
    LaneFlags lanes{};
    for (std::size_t k = 0; k < kPreviews; ++k) {
      lanes[k] = true;
      for (int j = 0; j < kJoints; ++j) poses[j][k] = Q[k][j];
    }
    feedback_displacement(identified_, params_.action, params_.iterations, poses, lanes, linear);
    for (std::size_t k = 0; k < kPreviews; ++k) {
      d[k].setZero();
      for (int j = 0; j < kLinearJoints; ++j) d[k][j] = linear[j][k];
    }
  }

 private:
  const IdentifiedMachine& identified_;
  VirtualEncoderParams params_;
  PoseCompensation all_;
};

// Friction of one axis: of its whole motion and of the commanded one, and what takes away the
// difference.
struct FrictionState {
  double whole = 0.0, commanded = 0.0;  // m, deflections of the bristles
  ForceInverseState inverse;
};

struct Run {
  ObservedMotion motion;             // without the wanted displacement
  Joints d0 = Joints::Zero();        // of the pose read last
  Joints d0_rate = Joints::Zero();   // per s
  Joints fed_back = Joints::Zero();  // behind the pole of the inverse
  Joints wanted = Joints::Zero();    // found, acts a period later
  Joints out = Joints::Zero();       // acts
  std::array<FrictionState, kJoints> friction{};
};

class PredictiveEncoder final : public FeedbackPart {
 public:
  PredictiveEncoder(const IdentifiedMachine& identified, const VirtualEncoderParams& params,
                    const Prediction& prediction, double period)
      : params_(params),
        prediction_(prediction),
        displacements_(identified, params),
        observer_(observer_gains(prediction.bandwidth, period)),
        period_(period),
        max_change_(params.max_rate * period),
        held_(period) {}

  Joints settle(const Joints& Q_meas, std::size_t lane) override {
    Run& run = runs_[lane];
    run = Run{};
    held_.settle(lane);
    run.d0 = run.fed_back = run.wanted = displacements_.at(Q_meas);
    run.motion.settle(Q_meas + run.d0);
    for (int j = 0; j < params_.displaced(); ++j) {
      run.out[j] = limited(run.wanted[j], params_.max[j]);
      held_.look(j, lane, 0, run.wanted[j], run.out[j], params_.max[j]);
    }
    return run.out;
  }

  Joints advance(const JointLanes& Q_meas, std::size_t periods, std::size_t lane) override {
    assert(0 < periods && periods <= kLaneWidth);
    for (std::size_t n = 0; n < periods; ++n) step(Q_meas, n, lane);
    return runs_[lane].out;
  }

  const JointLanes& advance(const JointLanes& Q_meas, const LaneFlags& lanes) override {
    for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
      if (!lanes[lane]) continue;
      step(Q_meas, lane, lane);
      for (int j = 0; j < kJoints; ++j) out_[j][lane] = runs_[lane].out[j];
    }
    return out_;
  }

  std::vector<Saturation> saturations(std::size_t lane) const override {
    return held_.all(lane, params_.max, params_.max_rate);
  }

 private:
  // Lets the displacement found last act within the limits, and finds the next.
  void step(const JointLanes& Q_meas, std::size_t from, std::size_t lane) {
    Run& run = runs_[lane];
    for (int j = 0; j < params_.displaced(); ++j) {
      run.out[j] = approached(run.wanted[j], params_.max[j], max_change_[j], run.out[j]);
      held_.look(j, lane, 0, run.wanted[j], run.out[j], params_.max[j]);
    }
    held_.pass(lane, 1);
    Joints Q;
    for (int j = 0; j < kJoints; ++j) Q[j] = Q_meas[j][from];
    find(run, Q);
  }

  void find(Run& run, const Joints& Q) const {
    const Joints d0 = run.d0 + period_ * run.d0_rate;
    run.motion.advance(observer_, Q + d0);
    Previews poses, d;
    for (std::size_t k = 0; k < kPreviews; ++k) {
      const double t = prediction_.times[k];
      poses[k] = run.motion.ahead(t) - d0 - t * run.d0_rate;
    }
    displacements_.at(poses, d);
    run.d0 = d[0];
    const double apart = prediction_.times[1];
    if (apart > 0.0) run.d0_rate = (4.0 * d[1] - 3.0 * d[0] - d[2]) / (2.0 * apart);
    for (int j = 0; j < params_.displaced(); ++j) {
      const LoopInverse& H = prediction_.inverse[static_cast<std::size_t>(j)];
      double sum = 0.0;
      for (std::size_t k = 0; k < kPreviews; ++k) sum += H.weight[k] * d[k][j];
      run.fed_back[j] += H.share * (sum - run.fed_back[j]);
      run.wanted[j] = run.fed_back[j];
      if (prediction_.knows_friction) run.wanted[j] -= friction_displacement(run, j);
    }
  }

  double friction_displacement(Run& run, int joint) const {
    const auto j = static_cast<std::size_t>(joint);
    const BristleFriction& friction = prediction_.friction[j];
    if (friction.sigma0 <= 0.0) return 0.0;
    FrictionState& state = run.friction[j];
    const double v = run.motion.velocity[joint];
    const double F = advance_bristles(friction, v - run.d0_rate[joint], period_, state.whole) -
                     advance_bristles(friction, v, period_, state.commanded);
    return state.inverse.advance(prediction_.force_inverse[j], F);
  }

  VirtualEncoderParams params_;
  Prediction prediction_;
  Displacements displacements_;
  ObserverGains observer_;
  double period_;      // s
  Joints max_change_;  // m, rad per model period
  HeldPeriods<kJoints> held_;
  std::array<Run, kLaneWidth> runs_{};
  JointLanes out_{};
};

}  // namespace

Prediction prediction_of(const IdentifiedMachine& identified, const VirtualEncoderParams& params,
                         double bandwidth, bool friction) {
  Prediction out;
  out.bandwidth = bandwidth;
  if (identified.loops == nullptr) return out;
  const IdentifiedLoops& loops = *identified.loops;
  double lag = 0.0;
  for (int j = 0; j < params.displaced(); ++j) {
    const auto& loop = loops.responses[static_cast<std::size_t>(j)];
    if (loop != nullptr) lag = std::max(lag, lag_of(*loop));
  }
  for (std::size_t k = 0; k < kPreviews; ++k) {
    out.times[k] = kReach * lag * static_cast<double>(k) / (kPreviews - 1);
  }
  out.knows_friction = friction;
  for (std::size_t j = 0; j < static_cast<std::size_t>(params.displaced()); ++j) {
    const auto& loop = loops.responses[j];
    if (loop == nullptr) continue;
    out.inverse[j] = inverse_of(*loop, out.times, loops.model_period);
    out.force_inverse[j] = force_inverse_of(*loop, loops.model_period);
    out.friction[j] = loops.friction[j];
  }
  return out;
}

std::unique_ptr<FeedbackPart> predictive_encoder(const IdentifiedMachine& identified,
                                                 const VirtualEncoderParams& params,
                                                 const Prediction& prediction,
                                                 double model_period) {
  return std::make_unique<PredictiveEncoder>(identified, params, prediction, model_period);
}

}  // namespace servomill::strategies
