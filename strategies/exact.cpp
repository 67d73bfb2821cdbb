#include "strategies/exact.h"

#include <fmt/format.h>

#include <array>

#include "strategies/linearisation.h"

namespace servomill::strategies {
namespace {

const std::array<ParameterSpec, 2>& specs() {
  static const std::array<ParameterSpec, 2> kSpecs = {{
      {.name = "tolerance_um",
       .help = "maximum deviation of the TCP from the chord",
       .unit = "um",
       .default_text = "0.1",
       .min = 1e-3,
       .shortcoming = Shortcoming::chord_tolerance},
      {.name = "axis_tolerance_urad",
       .help = "maximum deviation of the tool axis from its great circle",
       .unit = "urad",
       .default_text = "100",
       .min = 1e-2,
       .shortcoming = Shortcoming::chord_tolerance},
  }};
  return kSpecs;
}

// Joints that differ by less are the same.
constexpr double kSameJoints = 1e-9;  // m, rad

class ExactStrategy final : public Strategy {
 public:
  ExactStrategy(const IdentifiedMachine& identified, const plant::ToolTolerance& tolerance)
      : identified_(identified), tolerance_(tolerance), inverse_(nominal_inverse(identified)) {}

  bool rewrites() const override { return true; }

  void rewrite(const MoveRange& moves, const PutMove& put) const override {
    put_with_points(
        moves, identified_,
        [this](const Joints& Q_0, const Joints& Q_1) { return points_of(Q_0, Q_1); }, put);
  }

 private:
  std::vector<plant::PathPoint> points_of(const Joints& Q_0, const Joints& Q_1) const {
    const ToolPose P_0 = plant::forward(inverse_.chain(), Q_0, identified_.p_ST);
    const ToolPose P_1 = plant::forward(inverse_.chain(), Q_1, identified_.p_ST);
    if (angle_between(P_0.k_W, P_1.k_W) >= plant::kRoundTurn) {
      throw InputError(
          Place{},
          "the tool axis is reversed (180 deg): the direction of rotation is undetermined");
    }
    plant::LinearisedPath way = plant::linearise(
        inverse_, identified_.p_ST, plant::StraightToolPath(P_0, P_1), Q_0, tolerance_);
    // the axes of the program may turn more than straight motion needs
    if (!way.is_complete || (way.points.back().Q - Q_1).norm() > kSameJoints) {
      throw InputError(Place{}, fmt::format("the TCP cannot follow a straight line between these "
                                            "axis positions; it stops after {:.1f} %",
                                            100.0 * (way.is_complete ? 1.0 : way.t)));
    }
    return std::move(way.points);
  }

  IdentifiedMachine identified_;
  plant::ToolTolerance tolerance_;
  plant::InverseKinematics inverse_;
};

std::unique_ptr<Strategy> make(const Parameters& p, Action, const IdentifiedMachine& identified) {
  return std::make_unique<ExactStrategy>(
      identified, plant::ToolTolerance{p.number("tolerance_um"), p.number("axis_tolerance_urad")});
}

}  // namespace

Entry exact_entry() {
  Entry entry = {"exact", "linearises moves with rotary axes to within a tolerance", specs(), make};
  entry.reads_errors = false;
  return entry;
}

}  // namespace servomill::strategies
