#include "tests/strategies/feedback_example.h"

#include <array>
#include <cmath>
#include <utility>

#include "strategies/axis_displacement.h"
#include "strategies/single_run_feedback.h"

namespace servomill::strategies {
namespace {

constexpr std::array<ParameterSpec, 1> kSpecs = {{
    {.name = "time_constant_ms",
     .help = "of the low-pass filter behind the error model",
     .unit = "ms",
     .default_text = "1",
     .min = 0.001},
}};

// y' = (d(Q_fb) - y) / T, exact for a displacement that stands during the period.
struct Smoothed {
  using State = Joints;  // y (5; m, rad)

  Joints found(const Reading& now) const {
    Eigen::Vector3d d;
    feedback_displacement(identified, action, Iterations::one, now.Q_fb, d);
    Joints out = Joints::Zero();
    out.head<3>() = d;
    return out;
  }
  Joints settle(const Reading& now, State& y) const { return y = found(now); }
  Joints displacement(const Reading& now, State& y) const { return y += share * (found(now) - y); }

  IdentifiedMachine identified;
  Action action;
  double share;  // of the difference that a period closes
};

struct SmoothedStrategy final : Strategy {
  SmoothedStrategy(Smoothed of_any_period, double time_constant)
      : law(std::move(of_any_period)), T(time_constant) {}
  bool displaces_feedback() const override { return true; }
  std::unique_ptr<FeedbackPart> feedback(double period) const override {
    Smoothed one = law;
    one.share = -std::expm1(-period / T);
    return std::make_unique<SingleRunFeedback<Smoothed>>("smoothed", one, period);
  }
  Smoothed law;
  double T;  // s
};

}  // namespace

Entry smoothed_entry() {
  const auto make = [](const Parameters& p, Action action, const auto& identified) {
    return std::make_unique<SmoothedStrategy>(Smoothed{identified, action, 1.0},
                                              p.number("time_constant_ms"));
  };
  Entry entry = {"smoothed", "virtual encoder with a low-pass filter", kSpecs, make};
  entry.uses_feedback_hardware = true;
  return entry;
}

}  // namespace servomill::strategies
