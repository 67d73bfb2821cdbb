// Quadrant glitch compensation by the setpoint: after each reversal of an axis its setpoint is
// moved on by a pulse that decays.
#include <cmath>

#include "strategies/plugin.h"

namespace {

using servomill::plugin::Joints;

constexpr auto kHeight =
    servomill::plugin::parameter("height_um", "of the pulse after a reversal", "um", "5", 0.0, 1e3);
constexpr auto kDecay =
    servomill::plugin::parameter("decay_ms", "time constant of the pulse", "ms", "20", 0.1, 1e4);
constexpr const servomill_parameter* kParameters[] = {&kHeight, &kDecay};

class Quadrant {
 public:
  explicit Quadrant(const servomill_setup& setup)
      : height_(setup.parameters[0]), decay_(setup.parameters[1]) {}

  Joints offset(const servomill_reading& now) {
    const double kept = std::exp(-(now.t - t_) / decay_);
    t_ = now.t;
    for (std::size_t j = 0; j < 3; ++j) {
      const double direction = now.dQ_ref[j] > 0.0 ? 1.0 : now.dQ_ref[j] < 0.0 ? -1.0 : 0.0;
      pulse_[j] *= kept;
      if (direction * direction_[j] < 0.0) pulse_[j] = direction * height_;
      if (direction != 0.0) direction_[j] = direction;
    }
    return pulse_;
  }

 private:
  double height_, decay_;  // m, s
  double t_ = 0.0;         // s
  Joints direction_ = {}, pulse_ = {};
};

constexpr auto kQuadrant = servomill::plugin::strategy<Quadrant>(
    "quadrant", "pulses at the reversals of X, Y and Z", kParameters);

}  // namespace

SERVOMILL_PLUGIN("quadrant", "0.1", kQuadrant)
