#include "strategies/gcode.h"

#include <array>
#include <cmath>

#include "strategies/displaced_blocks.h"
#include "strategies/pose_compensation.h"
#include "strategies/reversal_correction.h"

namespace servomill::strategies {
namespace {

constexpr std::array<std::string_view, 2> kOrigins = {"case", "program"};

const std::array<ParameterSpec, 8>& specs() {
  static const std::array<ParameterSpec, 8> kSpecs = {{
      kBlockSpecs[0],
      kBlockSpecs[1],
      kBlockSpecs[2],
      kBlockSpecs[3],
      {.name = "rewrite_origin",
       .help = "work origin for which the errors are evaluated: that of the case, or that of "
               "program.work_offset without the offset of the case",
       .default_text = "case",
       .is_number = false,
       .words = kOrigins,
       .shortcoming = Shortcoming::identification,
       .ideal = "case"},
      kIterationsSpec,
      kAxesSpec,
      kSingularSpec,
  }};
  return kSpecs;
}

struct RewriteParams {
  Action action = Action::compensate;
  Iterations iterations = Iterations::one;
  double sigma_0 = 0.0;
  BlockLimits limits;
  Joints shift = Joints::Zero();  // m, rad; of the part since the program was rewritten
};

// Displacement by the identified errors.
class ErrorDisplacement final : public PointDisplacement {
 public:
  ErrorDisplacement(const IdentifiedMachine& identified, const RewriteParams& params)
      : identified_(identified),
        params_(params),
        all_(identified, params.iterations, params.sigma_0),
        reversal_(identified, params.action, identified.reference - params.shift) {}

  At at(const Joints& Q, double) const override {
    const Joints Q_then = Q - params_.shift;
    At out{mean(Q_then)};
    if (reversal_.is_needed()) {
      out.step = reversal_.displacement(Q_then, identified_.layout.joints(out.d));
      out.d.head<3>() += out.step;
    }
    return out;
  }

  std::span<const plant::Play> plays() const override { return identified_.model.plays(); }

  // The hysteresis of a compensated program follows its displaced positions.
  double travelled(const Joints& Q, int joint) const override {
    const Joints Q_then = Q - params_.shift;
    if (params_.action == Action::impose) return Q_then[joint];
    return Q_then[joint] + identified_.layout.joints(mean(Q_then))[joint];
  }

  void travel(const Joints& Q, const At& there) override {
    if (!reversal_.is_needed()) return;
    reversal_.travel(Q - params_.shift, identified_.layout.joints(there.d), there.step);
  }

 private:
  // By the mean of both directions of travel.
  AxisWords mean(const Joints& Q) const {
    if (params_.limits.turns) return identified_.layout.words(all_.of_setpoint(params_.action, Q));
    AxisWords d = AxisWords::Zero();
    d.head<3>() = setpoint_displacement(identified_, params_.action, params_.iterations, Q);
    return d;
  }

  const IdentifiedMachine& identified_;
  const RewriteParams& params_;
  PoseCompensation all_;
  ReversalCorrection reversal_;
};

class RewrittenProgram final : public Strategy {
 public:
  RewrittenProgram(const IdentifiedMachine& identified, const RewriteParams& params)
      : identified_(identified), params_(params) {}

  bool rewrites() const override { return true; }
  bool rewrites_tip_moves() const override { return true; }
  bool displaces_rotary() const override { return params_.limits.turns; }
  std::optional<Residual> uncorrectable(const Joints& Q) const override {
    return strategies::uncorrectable(
        identified_, params_.action,
        params_.limits.turns ? DisplacedAxes::all : DisplacedAxes::linear, params_.sigma_0,
        Joints(Q - params_.shift));
  }

  void rewrite(const MoveRange& moves, const PutMove& put) const override {
    ErrorDisplacement displacement(identified_, params_);
    put_displaced_blocks(moves, identified_, params_.limits, displacement, put);
  }

 private:
  IdentifiedMachine identified_;
  RewriteParams params_;
};

std::unique_ptr<Strategy> make(const Parameters& p, Action action,
                               const IdentifiedMachine& identified) {
  RewriteParams params;
  params.action = action;
  params.iterations = iterations_of(p);
  params.limits = block_limits_of(p);
  params.limits.turns = displaced_axes_of(p) == DisplacedAxes::all;
  params.sigma_0 = std::sin(p.number("singular_deg"));
  if (p.word("rewrite_origin") == "program") params.shift = identified.part_shift;
  return std::make_unique<RewrittenProgram>(identified, params);
}

}  // namespace

Entry gcode_entry() {
  return {"gcode", "rewrites the program as short displaced blocks", specs(), make};
}

}  // namespace servomill::strategies
