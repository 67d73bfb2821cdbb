#include "strategies/feedback.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "strategies/approach_kernel.h"
#include "strategies/compensation.h"

namespace servomill::strategies {
namespace {

constexpr std::array<std::string_view, 1> kAuto = {"auto"};

const std::array<ParameterSpec, 5>& specs() {
  static const std::array<ParameterSpec, 5> kSpecs = {{
      {.name = "max_um",
       .help = "saturation of the virtual displacement of an axis",
       .unit = "um",
       .default_text = "500",
       .min = 0.0},
      {.name = "max_rate_mm_per_s",
       .help = "saturation of its rate of change",
       .unit = "mm/s",
       .default_text = "10",
       .min = 0.0},
      {.name = "lead_ms",
       .help = "evaluates the model where the axis will be after this time; auto: 1/Kv",
       .unit = "ms",
       .default_text = "0",
       .min = 0.0,
       .max = 1e4,
       .words = kAuto},
      {.name = "velocity_window_ms",
       .help = "time over which the lead takes the velocity from the encoder",
       .unit = "ms",
       .default_text = "3",
       .min = 0.0,
       .max = 1e4},
      kIterationsSpec,
  }};
  return kSpecs;
}

struct FeedbackParams {
  Sign sign = Sign::correct;
  Iterations iterations = Iterations::one;
  double max = 0.0;                                // m
  double max_rate = 0.0;                           // m/s
  Eigen::Vector3d lead = Eigen::Vector3d::Zero();  // s, of each displaced axis
  double window = 0.0;                             // s
};

// Velocity of the linear joints as the difference of readings over a window.
class VelocityWindow {
 public:
  VelocityWindow(double window, double period)
      : readings_(std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(window / period)))),
        inverse_length_(1.0 / (static_cast<double>(readings_.size()) * period)) {}

  void settle(const Joints& reading, std::size_t run) {
    for (Readings& one : readings_) {
      for (int j = 0; j < kLinearJoints; ++j) one.Q[j][run] = reading[j];
    }
  }
  // Of one run, or of eight from the first on.
  template <class Poses, class Shifts>
  void advance(const Poses& reading, std::size_t first, Shifts& velocity) {
    for (int j = 0; j < kLinearJoints; ++j) {
      double* before = readings_[oldest_].Q[j].data() + first;
      for (std::size_t k = 0; k < kLanesOf<Shifts>; ++k) {
        lane(velocity[j], k) = (lane(reading[j], k) - before[k]) * inverse_length_;
        before[k] = lane(reading[j], k);
      }
    }
    oldest_ = oldest_ + 1 == readings_.size() ? 0 : oldest_ + 1;
  }

 private:
  struct Readings {
    LinearJointLanes Q{};
  };
  std::vector<Readings> readings_;
  double inverse_length_;
  std::size_t oldest_ = 0;
};

class VirtualEncoder final : public FeedbackPart {
 public:
  VirtualEncoder(const Belief& belief, const FeedbackParams& params, double period)
      : belief_(belief),
        params_(params),
        leads_(!params.lead.isZero(0.0)),
        max_change_(params.max_rate * period),
        velocity_(params.window, period) {}

  Eigen::Vector3d settle(const Joints& Q_meas, std::size_t run) override {
    velocity_.settle(Q_meas, run);
    Eigen::Vector3d d;
    find_displacement(Q_meas, {}, d);
    for (int j = 0; j < kLinearJoints; ++j) out_[j][run] = d[j] = limited(d[j], params_.max);
    return d;
  }
  Eigen::Vector3d evaluate(const Joints& Q_meas, std::size_t run) override {
    Eigen::Vector3d d;
    find(Q_meas, {}, run, d);
    for (int j = 0; j < kLinearJoints; ++j) {
      double& out = out_[j][run];
      d[j] = out = approached(d[j], params_.max, max_change_, out);
    }
    return d;
  }
  void evaluate(const JointLanes& Q_meas, const LaneFlags& lanes, LinearJointLanes& d) override {
    find(Q_meas, lanes, 0, d);
    approach_(params_.max, max_change_, kLinearJoints, out_, d);
  }

 private:
  template <class Poses, class Shifts>
  void find(const Poses& Q_meas, const LaneFlags& lanes, std::size_t first, Shifts& d) {
    if (leads_) {
      find_ahead(Q_meas, lanes, first, d);
    } else {
      find_displacement(Q_meas, lanes, d);
    }
  }

  // Displacement where the machine will be when an axis has followed it: each displaced axis has
  // its own lag, hence its own lead.
  template <class Poses, class Shifts>
  void find_ahead(const Poses& Q_meas, const LaneFlags& lanes, std::size_t first, Shifts& d) {
    const Eigen::Vector3d& lead = params_.lead;
    Poses Q;
    Shifts velocity, other;
    std::copy(std::begin(Q_meas), std::end(Q_meas), std::begin(Q));
    velocity_.advance(Q_meas, first, velocity);
    const auto find_after = [&](double time, Shifts& out) {
      for (int j = 0; j < kLinearJoints; ++j) {
        for (std::size_t k = 0; k < kLanesOf<Shifts>; ++k) {
          lane(Q[j], k) = lane(Q_meas[j], k) + time * lane(velocity[j], k);
        }
      }
      find_displacement(Q, lanes, out);
    };
    find_after(lead[0], d);
    for (int j = 1; j < kLinearJoints; ++j) {
      if (lead[j] == lead[0]) continue;
      find_after(lead[j], other);
      d[j] = other[j];
    }
  }

  void find_displacement(const Joints& Q, const LaneFlags&, Eigen::Vector3d& d) const {
    feedback_displacement(belief_, params_.sign, params_.iterations, Q, d);
  }
  void find_displacement(const JointLanes& Q, const LaneFlags& lanes, LinearJointLanes& d) const {
    feedback_displacement(belief_, params_.sign, params_.iterations, Q, lanes, d);
  }

  const Belief& belief_;
  FeedbackParams params_;
  bool leads_;
  double max_change_;  // m per model period
  VelocityWindow velocity_;
  Approach approach_ = approach_in_lanes();
  LinearJointLanes out_{};
};

class ModifiedFeedback final : public Strategy {
 public:
  ModifiedFeedback(const Belief& belief, const FeedbackParams& params)
      : belief_(belief), params_(params) {}
  bool displaces_feedback() const override { return true; }
  std::unique_ptr<FeedbackPart> feedback(double model_period) const override {
    return std::make_unique<VirtualEncoder>(belief_, params_, model_period);
  }

 private:
  Belief belief_;
  FeedbackParams params_;
};

std::unique_ptr<Strategy> make(const Parameters& p, Sign sign, const Belief& belief) {
  FeedbackParams params;
  params.sign = sign;
  params.iterations = iterations_of(p);
  params.max = p.number("max_um");
  params.max_rate = p.number("max_rate_mm_per_s");
  if (p.is_word("lead_ms")) {
    for (int j = 0; j < kLinearJoints; ++j) {
      if (belief.layout.has(j)) params.lead[j] = 1.0 / belief.Kv[j];
    }
  } else {
    params.lead.setConstant(p.number("lead_ms"));
  }
  params.window = p.number("velocity_window_ms");
  return std::make_unique<ModifiedFeedback>(belief, params);
}

}  // namespace

Approach approach_in_lanes() {
  static const Approach kApproach =
      at_simd_level(simd_level(), []<SimdLevel level>() { return make_approach<level>(); });
  return kApproach;
}

Entry feedback_entry() {
  return {"feedback", "modifies the position feedback (virtual encoder)", specs(), make,
          /*reads_gains=*/true};
}

}  // namespace servomill::strategies
