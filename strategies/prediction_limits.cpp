#include "strategies/prediction_limits.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "strategies/motion_observer.h"
#include "strategies/pose_compensation.h"

namespace servomill::strategies {
namespace {

using Complex = std::complex<double>;
using Gains = Eigen::Matrix<double, kJoints, kJoints>;

double angular(double f) { return 2.0 * std::numbers::pi * f; }

bool has_friction(const Prediction& prediction, std::size_t joint) {
  return prediction.knows_friction && prediction.friction[joint].sigma0 > 0.0;
}

// From a position error to the virtual displacement of a joint at slope 1, at w (rad/s).
Complex reading_to_displacement(const Prediction& prediction, std::size_t joint, double period,
                                double w) {
  const LoopInverse& H = prediction.inverse[joint];
  const auto [p, v, a] = observer_response(observer_gains(prediction.bandwidth, period), w);
  Complex sum = 0.0;
  for (std::size_t k = 0; k < kPreviews; ++k) {
    const double t = prediction.times[k];
    sum += H.weight[k] * (p + t * v + 0.5 * t * t * a);
  }
  return sum * response(LoopInverse{{1.0, 0.0, 0.0}, H.share}, prediction.times, period, w);
}

// The same through the friction, which is on its bristles.
Complex reading_to_friction(const Prediction& prediction, std::size_t joint, double period,
                            double w) {
  if (!has_friction(prediction, joint)) return 0.0;
  const BristleFriction& friction = prediction.friction[joint];
  const Complex v = observer_response(observer_gains(prediction.bandwidth, period), w)[1];
  const Complex force =
      v * (friction.sigma0 * period / (1.0 - std::polar(1.0, -w * period)) + friction.sigma1);
  return response(prediction.force_inverse[joint], period, w) * force;
}

// Travel of an axis over which slopes are sampled; one turn of an endless axis.
std::array<double, 2> travel(const IdentifiedMachine& identified, int joint) {
  const double low = identified.lower[joint], high = identified.upper[joint];
  if (std::isfinite(low) && std::isfinite(high)) return {low, high};
  return {-std::numbers::pi, std::numbers::pi};
}

// Standard deviation of the current (A) that the displacement of one axis causes: white noise of
// slope times reading, over the frequencies of the identified response.
double current_noise(const LoopResponse& loop, const Prediction& prediction, std::size_t joint,
                     double period, double noise) {
  const auto density = [&](std::size_t k) {  // A^2/Hz
    const double w = angular(loop.f[k]);
    const Complex gain = reading_to_displacement(prediction, joint, period, w) +
                         reading_to_friction(prediction, joint, period, w);
    return std::norm(loop.current[k] * gain) * 2.0 * noise * noise * period;
  };
  double square = loop.f.front() * density(0);
  for (std::size_t k = 1; k < loop.f.size(); ++k) {
    square += 0.5 * (loop.f[k] - loop.f[k - 1]) * (density(k) + density(k - 1));
  }
  return std::sqrt(square);
}

}  // namespace

Gains largest_slopes(const IdentifiedMachine& identified, const VirtualEncoderParams& params) {
  const PoseCompensation all(identified, params.iterations, params.sigma_0);
  const auto displacement = [&](const Joints& Q) {
    if (params.axes == DisplacedAxes::all) return all.of_feedback(params.action, Q);
    Eigen::Vector3d linear;
    feedback_displacement(identified, params.action, params.iterations, Q, linear);
    Joints d = Joints::Zero();
    d.head<kLinearJoints>() = linear;
    return d;
  };
  constexpr double kStep = 10e-6;  // m, rad
  Gains largest = Gains::Zero();
  for (int j = 0; j < kJoints; ++j) {
    if (!identified.layout.has(j)) continue;
    const auto [low, high] = travel(identified, j);
    for (const double others : {0.0, 0.5, 1.0}) {
      Joints Q;
      for (int i = 0; i < kJoints; ++i) {
        const auto [from, to] = travel(identified, i);
        Q[i] = identified.layout.has(i) ? from + others * (to - from) : 0.0;
      }
      for (int n = 0; n < kSlopePlaces; ++n) {
        Q[j] = low + (n + 0.5) / kSlopePlaces * (high - low);
        Joints below = Q, above = Q;
        below[j] -= kStep;
        above[j] += kStep;
        const Joints slope = (displacement(above) - displacement(below)) / (2.0 * kStep);
        largest.col(j) = largest.col(j).cwiseMax(slope.cwiseAbs());
      }
    }
  }
  return largest;
}

double loop_gain(const LoopResponse& loop, const Prediction& prediction, int joint,
                 double model_period) {
  double largest = 0.0;
  for (std::size_t k = 0; k < loop.f.size(); ++k) {
    const Complex K = reading_to_displacement(prediction, static_cast<std::size_t>(joint),
                                              model_period, angular(loop.f[k]));
    largest = std::max(largest, std::abs(loop.displacement[k] * K));
  }
  return largest;
}

double spectral_radius(const Gains& gains) { return gains.eigenvalues().cwiseAbs().maxCoeff(); }

double noise_factor(const Prediction& prediction, int joint, double model_period) {
  const auto j = static_cast<std::size_t>(joint);
  const LoopInverse& H = prediction.inverse[j];
  const BristleFriction& friction = prediction.friction[j];
  const ObserverGains gains = observer_gains(prediction.bandwidth, model_period);
  ObservedMotion motion;
  ForceInverseState force;
  double fed_back = 0.0, way = 0.0, square = 0.0, largest = 0.0;
  constexpr int kMaxPeriods = 1'000'000;
  constexpr double kEnd = 1e-9;  // of the largest
  for (int n = 0; n < kMaxPeriods; ++n) {
    motion.advance(gains, Joints::Constant(n == 0 ? 1.0 : 0.0));
    double sum = 0.0;
    for (std::size_t k = 0; k < kPreviews; ++k) {
      sum += H.weight[k] * motion.ahead(prediction.times[k])[0];
    }
    fed_back += H.share * (sum - fed_back);
    double d = fed_back;
    way += model_period * motion.velocity[0];
    if (has_friction(prediction, j)) {
      const double F = -(friction.sigma0 * way + friction.sigma1 * motion.velocity[0]);
      d -= force.advance(prediction.force_inverse[j], F);
    }
    square += d * d;
    largest = std::max(largest, std::abs(d));
    if (std::abs(d) < kEnd * largest && n * model_period * prediction.bandwidth > 20.0) break;
  }
  return std::sqrt(square);
}

std::vector<std::string> check_prediction(const IdentifiedMachine& identified,
                                          const VirtualEncoderParams& params,
                                          const Prediction& prediction) {
  if (identified.loops == nullptr) return {};
  const IdentifiedLoops& loops = *identified.loops;
  const double period = loops.model_period;
  const Gains slopes = largest_slopes(identified, params);
  Gains gains = Gains::Zero();
  std::string noise;
  bool knows_any = false;
  for (int i = 0; i < params.displaced(); ++i) {
    const auto joint = static_cast<std::size_t>(i);
    const auto& loop = loops.responses[joint];
    if (loop == nullptr) continue;
    knows_any |= has_friction(prediction, joint);
    const double M = loop_gain(*loop, prediction, i, period);
    double reading = 0.0;  // slope times noise of all axes
    for (int j = 0; j < kJoints; ++j) {
      if (j < params.displaced()) gains(i, j) = M * slopes(i, j);
      reading =
          std::hypot(reading, slopes(i, j) * loops.reading_noise[static_cast<std::size_t>(j)]);
    }
    if (reading == 0.0) continue;
    const double factor = noise_factor(prediction, i, period);
    noise += fmt::format("{}{} {:.2g} {} (factor {:.2g}), {:.2g} mA", noise.empty() ? "" : "; ",
                         identified.layout.letter_of(i), factor * reading / nm,
                         i < kLinearJoints ? "nm" : "nrad", factor,
                         current_noise(*loop, prediction, joint, period, reading) / 1e-3);
  }
  const double radius = spectral_radius(gains);
  if (radius >= 1.0) {
    throw InputError({},
                     fmt::format("the loop through the identified errors may be unstable: slope "
                                 "of the errors times response is {:.3g}, must be < 1; lower "
                                 "observer_bandwidth_Hz, or use prediction = \"lag\"",
                                 radius));
  }
  std::vector<std::string> notes = {fmt::format(
      "the loop through the identified errors has a gain of {:.2g} (stable below 1)", radius)};
  if (prediction.knows_friction && !knows_any) {
    notes.emplace_back("the machine that it knows has no friction to compensate");
  }
  if (!noise.empty())
    notes.push_back(
        "noise of the scales adds at most, rms (factor to noise times slope of the errors): " +
        noise);
  return notes;
}

}  // namespace servomill::strategies
