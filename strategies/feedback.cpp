#include "strategies/feedback.h"

#include <algorithm>
#include <array>
#include <cmath>

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
       .words = kAuto},
      {.name = "velocity_window_ms",
       .help = "time over which the lead takes the velocity from the encoder",
       .unit = "ms",
       .default_text = "3",
       .min = 0.0},
      kIterationsSpec,
  }};
  return kSpecs;
}

struct FeedbackParams {
  Sign sign = Sign::correct;
  Iterations iterations = Iterations::one;
  double max = 0.0;       // m
  double max_rate = 0.0;  // m/s
  double lead = 0.0;      // s
  double window = 0.0;    // s
};

// Velocity of the linear joints as the difference of readings over a window.
class VelocityWindow {
 public:
  VelocityWindow(double window, double period)
      : readings_(std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(window / period)))),
        inverse_length_(1.0 / (static_cast<double>(readings_.size()) * period)) {}

  void settle(const Eigen::Vector3d& reading) {
    std::fill(readings_.begin(), readings_.end(), reading);
  }
  Eigen::Vector3d advance(const Eigen::Vector3d& reading) {
    const Eigen::Vector3d velocity = (reading - readings_[oldest_]) * inverse_length_;
    readings_[oldest_] = reading;
    oldest_ = oldest_ + 1 == readings_.size() ? 0 : oldest_ + 1;
    return velocity;
  }

 private:
  std::vector<Eigen::Vector3d> readings_;
  double inverse_length_;
  std::size_t oldest_ = 0;
};

class VirtualEncoder final : public FeedbackPart {
 public:
  VirtualEncoder(const Belief& belief, const FeedbackParams& params, double period)
      : belief_(belief),
        params_(params),
        max_change_(params.max_rate * period),
        velocity_(params.window, period) {}

  Eigen::Vector3d settle(const Joints& Q_meas) override {
    velocity_.settle(Q_meas.head<3>());
    out_ = limited(displacement(Q_meas));
    return out_;
  }

  Eigen::Vector3d evaluate(const Joints& Q_meas) override {
    Joints Q = Q_meas;
    if (params_.lead > 0.0) Q.head<3>() += params_.lead * velocity_.advance(Q_meas.head<3>());
    const Eigen::Vector3d wanted = limited(displacement(Q));
    out_ += (wanted - out_).cwiseMax(-max_change_).cwiseMin(max_change_);
    return out_;
  }

 private:
  Eigen::Vector3d displacement(const Joints& Q) const {
    return feedback_displacement(belief_, params_.sign, params_.iterations, Q);
  }
  Eigen::Vector3d limited(const Eigen::Vector3d& d) const {
    return d.cwiseMax(-params_.max).cwiseMin(params_.max);
  }

  const Belief& belief_;
  FeedbackParams params_;
  double max_change_;  // m per model period
  VelocityWindow velocity_;
  Eigen::Vector3d out_ = Eigen::Vector3d::Zero();
};

class ModifiedFeedback final : public Strategy {
 public:
  ModifiedFeedback(const Belief& belief, const FeedbackParams& params)
      : belief_(belief), params_(params) {}
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
  params.lead = p.is_word("lead_ms") ? 1.0 / belief.Kv : p.number("lead_ms");
  params.window = p.number("velocity_window_ms");
  return std::make_unique<ModifiedFeedback>(belief, params);
}

}  // namespace

Entry feedback_entry() {
  return {"feedback", "modifies the position feedback (virtual encoder)", specs(), make};
}

}  // namespace servomill::strategies
