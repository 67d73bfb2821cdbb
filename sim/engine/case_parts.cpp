#include "sim/engine/case_parts.h"

#include <fmt/format.h>

#include <cmath>

#include "sim/engine/engaged_teeth.h"
#include "sim/model/machine.h"

namespace servomill::sim::engine {

double model_period_of(const CaseInputs& in) {
  return in.machine.nc.periods.seconds(in.hardware.model_period);
}

Outcome interrupted(double time) {
  return {false, true, fmt::format("interrupted at {:.4f} s", time), '-', time};
}

Outcome failed(std::string_view why, double time, int line) {
  return {false, false, fmt::format("{} at {:.4f} s, line {} of the program", why, time, line), '-',
          time};
}

std::string why_implausible(const PositionLoopTerm& term, const Joints& velocity,
                            const model::MachineSettings& machine) {
  constexpr double kMaxFactor = 10.0;
  const JointLayout& layout = machine.chain.layout;
  for (int j = 0; j < kJoints; ++j) {
    const double most = kMaxFactor * machine.nc.v_max[j];
    if (!layout.has(j) || std::abs(velocity[j]) <= most) continue;
    if (!std::isfinite(velocity[j])) {
      return fmt::format("strategy {}: position_loop returned a value that is not finite",
                         term.strategy);
    }
    return fmt::format(
        "strategy {}: position_loop adds {:.4g} {} to axis {}, beyond {:g} times its v_max",
        term.strategy, velocity[j], j < kLinearJoints ? "m/s" : "rad/s", layout.letter_of(j),
        kMaxFactor);
  }
  return {};
}

Outcome stopped_at_begin(const std::string& why) { return {false, false, why, '-', 0.0}; }

namespace {

// Static compliance of the tool point, which regenerates where nothing vibrates.
Eigen::Matrix3d regenerating_compliance(const model::MachineSettings& machine) {
  if (plant::StructuralDeflection(machine.structural_modes).vibrates()) {
    return Eigen::Matrix3d::Zero();
  }
  return plant::static_compliance(machine.structural_modes, machine.structural_compliance);
}

}  // namespace

CutAlongPath::CutAlongPath(const CaseInputs& in)
    : in_(in),
      regeneration_(in.regeneration
                        ? std::make_unique<ChipRegeneration>(
                              in.machine.structural_modes,
                              in.machine.nc.periods.seconds(in.tooth_step),
                              in.teeth->longest_passage(), regenerating_compliance(in.machine))
                        : nullptr),
      load_(*in.cutting, in.wear, in.machine.chain, in.machine.structural_compliance, in.teeth,
            in.displaced_cuts, in.machine.structural_modes, regeneration_.get()) {}

std::string_view CutAlongPath::fault() const {
  return load_.digs_in() ? "the tool digs in: the cut draws it in faster than the structure resists"
                         : "";
}

void CutAlongPath::deviate(const controllers::Trajectory::Sample& reference, const Joints& Q_true,
                           const Eigen::Vector3d& bend) {
  const plant::MachineChain& chain = in_.machine.chain;
  const std::size_t piece = in_.pieces[reference.move];
  const Eigen::Vector3d& p_ST = in_.tips.at(in_.path.tool_offset(piece));
  const Joints Q_prog = in_.path.joints(piece, reference.s, chain.layout, reference.Q_ref);
  const Eigen::Vector3d p_true =
      in_.machine_errors.forward(Q_true, p_ST).p_WT + plant::linear_jacobian(chain, Q_true) * bend;
  load_.deviate(p_true - plant::forward(chain, Q_prog, p_ST).p_WT);
}

}  // namespace servomill::sim::engine
