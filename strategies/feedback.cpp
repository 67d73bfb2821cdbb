#include "strategies/feedback.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "plant/vocabulary/lanes.h"
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
    find_displacements({&Q_meas, 1}, {&out_, 1});
    out_ = limited(out_);
    return out_;
  }

  // One belief belongs to one strategy.
  bool goes_with(const FeedbackPart& other) const override {
    const auto* one = dynamic_cast<const VirtualEncoder*>(&other);
    return one != nullptr && &one->belief_ == &belief_;
  }

  void evaluate_together(std::span<FeedbackPart* const> parts, std::span<const Joints> Q_meas,
                         std::span<Eigen::Vector3d> d) override {
    for (std::size_t first = 0; first < parts.size(); first += kLaneWidth) {
      const std::size_t count = std::min(kLaneWidth, parts.size() - first);
      evaluate_eight(parts.subspan(first, count), Q_meas.subspan(first, count),
                     d.subspan(first, count));
    }
  }

 private:
  using Parts = std::span<FeedbackPart* const>;
  static VirtualEncoder& of(FeedbackPart* part) { return static_cast<VirtualEncoder&>(*part); }

  void evaluate_eight(Parts parts, std::span<const Joints> Q_meas,
                      std::span<Eigen::Vector3d> d) const {
    find_ahead(parts, Q_meas, d);
    for (std::size_t k = 0; k < parts.size(); ++k) d[k] = of(parts[k]).approach(limited(d[k]));
  }

  // Displacement where the machine will be when an axis has followed it: each displaced axis has
  // its own lag, hence its own lead.
  void find_ahead(Parts parts, std::span<const Joints> Q_meas, std::span<Eigen::Vector3d> d) const {
    const Eigen::Vector3d& lead = params_.lead;
    if (lead.isZero(0.0)) return find_displacements(Q_meas, d);
    const std::size_t count = parts.size();
    std::array<Eigen::Vector3d, kLaneWidth> velocity, other;
    for (std::size_t k = 0; k < count; ++k) {
      velocity[k] = of(parts[k]).velocity_.advance(Q_meas[k].head<3>());
    }
    const auto find_after = [&](double time, std::span<Eigen::Vector3d> out) {
      std::array<Joints, kLaneWidth> Q;
      for (std::size_t k = 0; k < count; ++k) {
        Q[k] = Q_meas[k];
        Q[k].head<3>() += time * velocity[k];
      }
      find_displacements({Q.data(), count}, out);
    };
    find_after(lead[0], d);
    for (int j = 1; j < kLinearJoints; ++j) {
      if (lead[j] == lead[0]) continue;
      find_after(lead[j], {other.data(), count});
      for (std::size_t k = 0; k < count; ++k) d[k][j] = other[k][j];
    }
  }

  void find_displacements(std::span<const Joints> Q, std::span<Eigen::Vector3d> d) const {
    feedback_displacements(belief_, params_.sign, params_.iterations, Q, d);
  }
  Eigen::Vector3d limited(const Eigen::Vector3d& d) const {
    return d.cwiseMax(-params_.max).cwiseMin(params_.max);
  }
  const Eigen::Vector3d& approach(const Eigen::Vector3d& wanted) {
    out_ += (wanted - out_).cwiseMax(-max_change_).cwiseMin(max_change_);
    return out_;
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

Entry feedback_entry() {
  return {"feedback", "modifies the position feedback (virtual encoder)", specs(), make,
          /*reads_gains=*/true};
}

}  // namespace servomill::strategies
