#include "strategies/feedback.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <iterator>
#include <numbers>

#include "plant/vocabulary/input_error.h"
#include "strategies/displacement_limits.h"
#include "strategies/pose_compensation.h"
#include "strategies/prediction_limits.h"
#include "strategies/predictive_encoder.h"

namespace servomill::strategies {
namespace {

constexpr std::array<std::string_view, 1> kAuto = {"auto"};
constexpr std::array<std::string_view, 3> kPredictions = {"lag", "loop", "observer"};

constexpr ParameterSpec kPredictionSpec = {
    .name = "prediction",
    .help =
        "lag: extrapolation_time_ms and velocity_window_ms; loop: inverse of the whole position "
        "loop along the observed motion; observer: as loop, and friction of the displaced axes",
    .default_text = "lag",
    .is_number = false,
    .words = kPredictions};

constexpr ParameterSpec kBandwidthSpec = {.name = "observer_bandwidth_Hz",
                                          .help =
                                              "bandwidth of the observer of position, velocity and "
                                              "acceleration, for prediction = loop and observer",
                                          .unit = "Hz",
                                          .default_text = "50",
                                          .min = 1.0,
                                          .max = 1e3};

const std::array<ParameterSpec, 11>& specs() {
  static const std::array<ParameterSpec, 11> kSpecs = {{
      {.name = "max_um",
       .help = "limit of the virtual displacement of a linear axis",
       .unit = "um",
       .default_text = "500",
       .min = 0.0,
       .shortcoming = Shortcoming::saturation,
       .ideal = "1e9"},
      {.name = "max_rate_mm_per_s",
       .help = "limit of the rate of change of the virtual displacement of a linear axis",
       .unit = "mm/s",
       .default_text = "10",
       .min = 0.0,
       .shortcoming = Shortcoming::saturation,
       .ideal = "1e6"},
      {.name = "max_mrad",
       .help = "limit of the virtual displacement of a rotary axis",
       .unit = "mrad",
       .default_text = "10",
       .min = 0.0,
       .shortcoming = Shortcoming::saturation,
       .ideal = "1e6"},
      {.name = "max_rate_mrad_per_s",
       .help = "limit of the rate of change of the virtual displacement of a rotary axis",
       .unit = "mrad/s",
       .default_text = "100",
       .min = 0.0,
       .shortcoming = Shortcoming::saturation,
       .ideal = "1e6"},
      {.name = "extrapolation_time_ms",
       .help = "evaluates the model at the position extrapolated by this time; auto: 1/Kv",
       .unit = "ms",
       .default_text = "0",
       .min = 0.0,
       .max = 1e4,
       .words = kAuto},
      {.name = "velocity_window_ms",
       .help = "time over which the extrapolation averages the encoder velocity",
       .unit = "ms",
       .default_text = "3",
       .min = 0.0,
       .max = 1e4},
      kPredictionSpec,
      kBandwidthSpec,
      kIterationsSpec,
      kAxesSpec,
      kSingularSpec,
  }};
  return kSpecs;
}

struct FeedbackParams : VirtualEncoderParams {
  Joints lead = Joints::Zero();  // s, of each displaced axis
  double window = 0.0;           // s
};

// Velocity of the first joints as the difference of readings over a window.
class VelocityWindow {
 public:
  VelocityWindow(double window, double period, std::size_t joints)
      : joints_(joints),
        length_(std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(window / period)))),
        readings_(length_ * joints),
        inverse_length_(1.0 / (static_cast<double>(length_) * period)) {}

  void settle(const Joints& reading, std::size_t run) {
    for (std::size_t n = 0; n < readings_.size(); ++n) {
      readings_[n][run] = reading[static_cast<int>(n % joints_)];
    }
  }
  // To be asked of all joints and runs, then followed by `next`.
  double velocity(std::size_t joint, std::size_t run, double reading) {
    double& before = readings_[oldest_ + joint][run];
    const double v = (reading - before) * inverse_length_;
    before = reading;
    return v;
  }
  void next() { oldest_ = oldest_ + joints_ == readings_.size() ? 0 : oldest_ + joints_; }

 private:
  std::size_t joints_, length_;
  std::vector<LaneArray> readings_;
  double inverse_length_;
  std::size_t oldest_ = 0;
};

// Displaces the first joints: the linear ones, or all.
template <int kDisplaced>
class VirtualEncoder final : public FeedbackPart {
  using Shifts = Eigen::Matrix<double, kDisplaced, 1>;
  using ShiftLanes = LaneArray[kDisplaced];

 public:
  VirtualEncoder(const IdentifiedMachine& identified, const FeedbackParams& params, double period)
      : identified_(identified),
        params_(params),
        all_(identified, params.iterations, params.sigma_0),
        leads_(!params.lead.isZero(0.0)),
        max_change_(params.max_rate * period),
        held_(period),
        velocity_(params.window, period, kDisplaced) {}

  Joints settle(const Joints& Q_meas, std::size_t run) override {
    held_.settle(run);
    if (leads_) velocity_.settle(Q_meas, run);
    Shifts wanted;
    find_displacement(Q_meas, LaneFlags{}, wanted);
    Joints d = Joints::Zero();
    for (int j = 0; j < kDisplaced; ++j) {
      wanted_[j][run] = wanted[j];
      d[j] = out_[j][run] = limited(wanted[j], params_.max[j]);
      held_.look(j, run, 0, wanted[j], d[j], params_.max[j]);
    }
    return d;
  }

  Joints advance(const JointLanes& Q_meas, std::size_t periods, std::size_t run) override {
    assert(0 < periods && periods <= kLaneWidth);
    ShiftLanes next;
    find_in_turn(Q_meas, periods, run, next);
    Joints d = Joints::Zero();
    for (int j = 0; j < kDisplaced; ++j) {
      d[j] = approach_in_turn(next[j], periods, params_.max[j], max_change_[j], wanted_[j][run],
                              out_[j][run], [&](std::size_t n, double wanted, double value) {
                                held_.look(j, run, n, wanted, value, params_.max[j]);
                              });
    }
    held_.pass(run, periods);
    return d;
  }

  const JointLanes& advance(const JointLanes& Q_meas, const LaneFlags& lanes) override {
    approach_(params_.max.data(), max_change_.data(), kDisplaced, wanted_, out_);
    look_at_limits(lanes);
    if (leads_) {
      ShiftLanes velocity;
      for (std::size_t j = 0; j < kDisplaced; ++j) {
        for (std::size_t run = 0; run < kLaneWidth; ++run) {
          velocity[j][run] = velocity_.velocity(j, run, Q_meas[j][run]);
        }
      }
      velocity_.next();
      find_ahead(Q_meas, velocity, lanes, wanted_);
    } else {
      find_displacement(Q_meas, lanes, wanted_);
    }
    return out_;
  }

  std::vector<Saturation> saturations(std::size_t run) const override {
    return held_.all(run, params_.max, params_.max_rate);
  }

 private:
  void look_at_limits(const LaneFlags& lanes) {
    for (int j = 0; j < kDisplaced; ++j) {
      bool all_free = true;
      for (std::size_t k = 0; k < kLaneWidth; ++k) all_free &= out_[j][k] == wanted_[j][k];
      if (all_free) continue;
      for (std::size_t k = 0; k < kLaneWidth; ++k) {
        if (lanes[k]) held_.look(j, k, 0, wanted_[j][k], out_[j][k], params_.max[j]);
      }
    }
    for (std::size_t k = 0; k < kLaneWidth; ++k) held_.pass(k, 1);
  }

  // Evaluates successive periods of one run side by side.
  void find_in_turn(const JointLanes& Q_meas, std::size_t periods, std::size_t run,
                    ShiftLanes& next) {
    LaneFlags lanes = {};
    std::fill_n(lanes.begin(), periods, true);
    if (leads_) {
      ShiftLanes velocity = {};
      for (std::size_t n = 0; n < periods; ++n) {
        for (std::size_t j = 0; j < kDisplaced; ++j) {
          velocity[j][n] = velocity_.velocity(j, run, Q_meas[j][n]);
        }
        velocity_.next();
      }
      find_ahead(Q_meas, velocity, lanes, next);
    } else {
      find_displacement(Q_meas, lanes, next);
    }
  }

  // Displacement where the machine will be when an axis has followed it: each displaced axis has
  // its own lag, hence its own lead. Rotary axes that are not displaced are taken to stand still.
  void find_ahead(const JointLanes& Q_meas, const ShiftLanes& velocity, const LaneFlags& lanes,
                  ShiftLanes& d) const {
    const Joints& lead = params_.lead;
    JointLanes Q;
    ShiftLanes other;
    std::copy(std::begin(Q_meas), std::end(Q_meas), std::begin(Q));
    const auto find_after = [&](double time, ShiftLanes& out) {
      for (int j = 0; j < kDisplaced; ++j) {
        for (std::size_t k = 0; k < kLaneWidth; ++k) Q[j][k] = Q_meas[j][k] + time * velocity[j][k];
      }
      find_displacement(Q, lanes, out);
    };
    find_after(lead[0], d);
    for (int j = 1; j < kDisplaced; ++j) {
      if (lead[j] == lead[0]) continue;
      find_after(lead[j], other);
      d[j] = other[j];
    }
  }

  void find_displacement(const Joints& Q, const LaneFlags&, Eigen::Vector3d& d) const {
    feedback_displacement(identified_, params_.action, params_.iterations, Q, d);
  }
  void find_displacement(const JointLanes& Q, const LaneFlags& lanes, LinearJointLanes& d) const {
    feedback_displacement(identified_, params_.action, params_.iterations, Q, lanes, d);
  }
  void find_displacement(const Joints& Q, const LaneFlags&, Joints& d) const {
    d = all_.of_feedback(params_.action, Q);
  }
  void find_displacement(const JointLanes& Q, const LaneFlags& lanes, JointLanes& d) const {
    Joints one;
    for (std::size_t k = 0; k < kLaneWidth; ++k) {
      for (int j = 0; j < kJoints; ++j) one[j] = lanes[k] ? Q[j][k] : 0.0;
      if (lanes[k]) one = all_.of_feedback(params_.action, one);
      for (int j = 0; j < kJoints; ++j) d[j][k] = one[j];
    }
  }

  const IdentifiedMachine& identified_;
  FeedbackParams params_;
  PoseCompensation all_;
  bool leads_;
  Joints max_change_;  // m, rad per model period
  HeldPeriods<kDisplaced> held_;
  VelocityWindow velocity_;
  Approach approach_ = approach_in_lanes();
  ShiftLanes wanted_{};  // found, acts a period later
  JointLanes out_{};     // acts
};

class ModifiedFeedback final : public Strategy {
 public:
  ModifiedFeedback(const IdentifiedMachine& identified, const FeedbackParams& params)
      : identified_(identified), params_(params) {}
  bool displaces_feedback() const override { return true; }
  bool displaces_rotary() const override { return params_.axes == DisplacedAxes::all; }
  std::optional<Residual> uncorrectable(const Joints& Q) const override {
    return strategies::uncorrectable(identified_, params_.action, params_.axes, params_.sigma_0, Q);
  }
  std::unique_ptr<FeedbackPart> feedback(double model_period) const override {
    if (displaces_rotary()) {
      return std::make_unique<VirtualEncoder<kJoints>>(identified_, params_, model_period);
    }
    return std::make_unique<VirtualEncoder<kLinearJoints>>(identified_, params_, model_period);
  }

 private:
  IdentifiedMachine identified_;
  FeedbackParams params_;
};

// The same with an inverse of the position loops.
class PredictiveFeedback final : public Strategy {
 public:
  PredictiveFeedback(const IdentifiedMachine& identified, const VirtualEncoderParams& params,
                     double bandwidth, bool friction)
      : identified_(identified),
        params_(params),
        prediction_(prediction_of(identified_, params, bandwidth, friction)),
        notes_(check_prediction(identified_, params, prediction_)) {}
  bool displaces_feedback() const override { return true; }
  bool displaces_rotary() const override { return params_.axes == DisplacedAxes::all; }
  std::optional<Residual> uncorrectable(const Joints& Q) const override {
    return strategies::uncorrectable(identified_, params_.action, params_.axes, params_.sigma_0, Q);
  }
  std::unique_ptr<FeedbackPart> feedback(double model_period) const override {
    return predictive_encoder(identified_, params_, prediction_, model_period);
  }
  std::vector<std::string> notes() const override { return notes_; }

 private:
  IdentifiedMachine identified_;
  VirtualEncoderParams params_;
  Prediction prediction_;
  std::vector<std::string> notes_;
};

bool knows_loops(const Parameters& p) { return p.word("prediction") != "lag"; }

void refuse_second_lag(const Parameters& p) {
  if (!p.is_word("extrapolation_time_ms") && p.number("extrapolation_time_ms") == 0.0) return;
  throw InputError({}, "extrapolation_time_ms and prediction = \"" + p.word("prediction") +
                           "\" would both compensate the lag; remove one of them");
}

std::unique_ptr<Strategy> make(const Parameters& p, Action action,
                               const IdentifiedMachine& identified) {
  FeedbackParams params;
  params.action = action;
  params.iterations = iterations_of(p);
  params.axes = displaced_axes_of(p);
  params.max.head<3>().setConstant(p.number("max_um"));
  params.max_rate.head<3>().setConstant(p.number("max_rate_mm_per_s"));
  if (params.axes == DisplacedAxes::all) {
    params.sigma_0 = std::sin(p.number("singular_deg"));
    params.max.tail<2>().setConstant(p.number("max_mrad"));
    params.max_rate.tail<2>().setConstant(p.number("max_rate_mrad_per_s"));
  }
  if (knows_loops(p)) {
    refuse_second_lag(p);
    return std::make_unique<PredictiveFeedback>(
        identified, params, 2.0 * std::numbers::pi * p.number("observer_bandwidth_Hz"),
        p.word("prediction") == "observer");
  }
  if (p.is_word("extrapolation_time_ms")) {
    for (int j = 0; j < kJoints; ++j) {
      if (identified.layout.has(j)) params.lead[j] = 1.0 / identified.Kv[j];
    }
  } else {
    params.lead.setConstant(p.number("extrapolation_time_ms"));
  }
  params.window = p.number("velocity_window_ms");
  return std::make_unique<ModifiedFeedback>(identified, params);
}

}  // namespace

Approach approach_in_lanes() {
  static const Approach kApproach =
      at_simd_level(simd_level(), []<SimdLevel level>() { return make_approach<level>(); });
  return kApproach;
}

Entry feedback_entry() {
  Entry entry = {"feedback", "modifies the position feedback (virtual encoder)", specs(), make};
  entry.reads_gains = true;
  entry.uses_feedback_hardware = true;
  entry.reads_loops = knows_loops;
  return entry;
}

}  // namespace servomill::strategies
