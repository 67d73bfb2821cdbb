#include "tests/strategies/position_loop_example.h"

#include <array>

namespace servomill::strategies {
namespace {

const std::array<ParameterSpec, 1>& specs() {
  static const std::array<ParameterSpec, 1> kSpecs = {{
      {.name = "gain",
       .help = "integral gain of the position loop",
       .unit = "1/s^2",
       .default_text = "100",
       .min = 0.0},
  }};
  return kSpecs;
}

// Integral of the following error e = Q_cmd - Q_fb: v = Ki sum(e) Tp. An axis at constant speed
// then follows without error, whatever its feed-forward.
class Integral final : public PositionLoopPart {
 public:
  Integral(double gain, double period) : gain_(gain), period_(period) {}

  void settle(const Reading&) override { sum_.setZero(); }

  Joints velocity(const Reading& now) override {
    sum_ += (now.Q_cmd - now.Q_fb) * period_;
    return gain_ * sum_;
  }

 private:
  double gain_, period_;         // 1/s^2, s
  Joints sum_ = Joints::Zero();  // m s, rad s
};

class IntegralStrategy final : public Strategy {
 public:
  explicit IntegralStrategy(double gain) : gain_(gain) {}
  std::unique_ptr<PositionLoopPart> position_loop(double period) const override {
    return std::make_unique<Integral>(gain_, period);
  }

 private:
  double gain_;
};

}  // namespace

Entry integral_entry() {
  const auto make = [](const Parameters& p, Action, const IdentifiedMachine&) {
    return std::make_unique<IntegralStrategy>(p.number("gain"));
  };
  Entry entry{"integral", "integrates the following error", specs(), make};
  entry.reads_errors = false;
  return entry;
}

}  // namespace servomill::strategies
