#include "tests/strategies/setpoint_example.h"

#include <array>

#include "strategies/axis_displacement.h"

namespace servomill::strategies {
namespace {

const std::array<ParameterSpec, 2>& specs() {
  static const std::array<ParameterSpec, 2> kSpecs = {{
      {.name = "max_um",
       .help = "saturation of the setpoint offset of an axis",
       .unit = "um",
       .default_text = "500",
       .min = 0.0,
       .shortcoming = Shortcoming::saturation,
       .ideal = "1e9"},
      kIterationsSpec,  // shared by all strategies that evaluate errors at a displaced position
  }};
  return kSpecs;
}

// State of one run: none. The offset depends on the setpoint alone.
class LimitedOffset final : public SetpointPart {
 public:
  LimitedOffset(const IdentifiedMachine& identified, Action action, Iterations iterations,
                double max)
      : identified_(identified), action_(action), iterations_(iterations), max_(max) {}

  SetpointEntry entry() const override { return {}; }  // after the feed-forward tap, no lag

  Joints offset(const Joints& Q_ref) const override {
    const Eigen::Vector3d d = setpoint_displacement(identified_, action_, iterations_, Q_ref);
    Joints out = Joints::Zero();
    out.head<3>() = d.cwiseMax(-max_).cwiseMin(max_);
    return out;
  }

 private:
  IdentifiedMachine identified_;
  Action action_;
  Iterations iterations_;
  double max_;  // m
};

// Constant parameters, shared by all runs of the case.
class Setpoint final : public Strategy {
 public:
  Setpoint(const IdentifiedMachine& identified, Action action, Iterations iterations, double max)
      : identified_(identified), action_(action), iterations_(iterations), max_(max) {}

  std::unique_ptr<SetpointPart> setpoint() const override {
    return std::make_unique<LimitedOffset>(identified_, action_, iterations_, max_);
  }

 private:
  IdentifiedMachine identified_;
  Action action_;
  Iterations iterations_;
  double max_;  // m
};

// Numbers arrive in SI, checked against the table above.
std::unique_ptr<Strategy> make(const Parameters& p, Action action,
                               const IdentifiedMachine& identified) {
  return std::make_unique<Setpoint>(identified, action, iterations_of(p), p.number("max_um"));
}

}  // namespace

Entry setpoint_entry() {
  return {"setpoint", "offsets the setpoint, without lag and within a limit", specs(), make};
}

}  // namespace servomill::strategies
