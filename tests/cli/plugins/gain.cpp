// The example of strategies/README.md, "Act in the position loop": a larger position gain.
#include <stdexcept>

#include "strategies/plugin.h"

namespace {

using servomill::plugin::Joints;

constexpr auto kGain =
    servomill::plugin::parameter("gain", "added to Kv of all axes", "1/s", "10", 0.0, 1e3);
constexpr const servomill_parameter* kParameters[] = {&kGain};

struct Gain {
  explicit Gain(const servomill_setup& setup) : gain(setup.parameters[0]) {}

  Joints position_loop(const servomill_reading& now) const {
    if (!SERVOMILL_HAS(&now, Q_cmd)) throw std::runtime_error("needs a later servomill");
    Joints v{};
    for (std::size_t j = 0; j < v.size(); ++j) v[j] = gain * (now.Q_cmd[j] - now.Q_fb[j]);
    return v;
  }

  double gain;  // 1/s
};

constexpr auto kLargerGain =
    servomill::plugin::strategy<Gain>("larger_gain", "adds to the position gain", kParameters);

}  // namespace

SERVOMILL_PLUGIN("gain", "0.1", kLargerGain)
