#include "sim/preparation/chatter_check.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/structure/structural_deflection.h"
#include "plant/vocabulary/units.h"
#include "sim/frequency/lobes.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"

namespace servomill::sim::preparation {

double highest_mode(const model::MachineSettings& machine) {
  double highest = 0.0;
  for (const plant::StructuralMode& mode : machine.structural_modes) {
    highest = std::max(highest, mode.mode.w / (2.0 * std::numbers::pi));
  }
  return highest;
}

namespace {

std::vector<plant::StructuralMode> in_workpiece(std::vector<plant::StructuralMode> modes,
                                                const plant::MachineChain& chain, const Joints& Q) {
  const Eigen::Matrix3d J = plant::linear_jacobian(chain, Q);
  for (plant::StructuralMode& mode : modes) mode.direction = J * mode.direction;
  return modes;
}

}  // namespace

void refuse_regeneration(const model::Scenario& scenario, const model::CaseSpec& spec,
                         const Joints& start) {
  if (!spec.cutting || !scenario.cutting->regeneration) return;
  const auto refuse = [&](std::string_view why) {
    throw InputError(
        scenario.cutting->place,
        fmt::format("case {}: regeneration = true needs a tool point that is compliant across the "
                    "tool axis ([[structural_mode]] or structural_stiffness of the machine); {}",
                    spec.name, why));
  };
  const model::MachineSettings& machine = scenario.machine_of(spec);
  const Eigen::Vector3d k = plant::forward(machine.chain, start, Eigen::Vector3d::Zero()).k_W;
  const Eigen::Vector3d across = k.unitOrthogonal();
  if (highest_mode(machine) == 0.0) {
    const Eigen::Matrix3d C =
        plant::static_compliance(machine.structural_modes, machine.structural_compliance);
    const Eigen::Matrix3d J = plant::linear_jacobian(machine.chain, start);
    Eigen::Matrix<double, 3, 2> axes;
    axes << across, k.cross(across);
    if (C.isZero(0.0)) refuse("it is rigid");
    if ((axes.transpose() * J * C * J.transpose() * axes).norm() <= 1e-9 * C.norm()) {
      refuse("it is compliant along the tool axis only");
    }
    return;
  }
  const auto modes = in_workpiece(machine.structural_modes, machine.chain, start);
  if (frequency::modes_across(modes, across, k.cross(across)).empty()) {
    refuse("all of its modes are along the tool");
  }
}

namespace {

constexpr std::size_t kNamedLines = 5;

// Numbers that are equal for engagements that are as good as the same.
std::vector<int> rounded(const std::vector<plant::EdgeSlice>& slices,
                         std::span<const plant::ChatterMode> modes) {
  const auto whole = [](double value) { return static_cast<int>(std::lround(value)); };
  std::vector<int> out;
  for (const plant::ChatterMode& mode : modes) {
    out.push_back(whole(std::atan2(mode.direction.y(), mode.direction.x()) / deg));
    for (const double value : {mode.stiffness, mode.frequency, mode.damping}) {
      out.push_back(whole(100.0 * std::log(value)));
    }
  }
  for (const plant::EdgeSlice& slice : slices) {
    for (const double angle : {slice.from, slice.to, slice.lag, slice.lag_span}) {
      out.push_back(whole(angle / deg));
    }
    out.push_back(whole(100.0 * std::log(std::max(slice.width * slice.sine, 1 * nm))));
  }
  return out;
}

// From tooth to tooth, of the fastest mode: effort and memory of the analysis grow with it.
constexpr double kMaxPeriods = 50.0;

double periods_in(double passage, std::span<const plant::ChatterMode> modes) {
  double fastest = 0.0;
  for (const plant::ChatterMode& mode : modes) fastest = std::max(fastest, mode.frequency);
  return fastest / (2.0 * std::numbers::pi) * passage;
}

}  // namespace

ChatterCheck::Unstable ChatterCheck::stability_of(const plant::PeriodicCut& cut,
                                                  std::span<const plant::ChatterMode> modes) const {
  // The limit of the width to half a percent, far within what cutting coefficients are known to;
  // below a thousandth the cut counts as unstable at any width.
  constexpr double kShareTol = 5e-3, kLowestShare = 1e-3;
  plant::ChatterAnalysis analysis(modes);
  const plant::ChatterStability full = analysis.of(cut);
  if (full.is_stable()) return {};
  Unstable out{.turns = cut.turns,
               .frequency = full.frequency,
               .is_flip = full.kind() == plant::Chatter::flip};
  double low = 0.0, high = 1.0;  // of the width of all edges: the limit
  while (high - low > kShareTol * high && high > kLowestShare) {
    const double middle = 0.5 * (low + high);
    plant::PeriodicCut part = cut;
    for (plant::EdgeSlice& slice : part.slices) {
      slice.width *= middle;
      slice.lag *= middle;
      slice.lag_span *= middle;
    }
    (analysis.of(part).is_stable() ? low : high) = middle;
  }
  out.excess = 1.0 / high;
  return out;
}

void ChatterCheck::add(int line, int tool, const plant::Cutter& cutter,
                       const plant::CutterFrame& frame, std::span<const plant::EngagedArc> arcs,
                       double turns, const Joints& Q) {
  if (modes_.empty()) return;
  const auto modes = frequency::modes_across(in_workpiece(modes_, chain_, Q), frame.axes.col(0),
                                             frame.axes.col(1));
  const plant::PeriodicCut cut{K_, cutter.teeth, turns,
                               plant::edge_slices(cutter, frame.feed, arcs)};
  if (modes.empty() || cut.slices.empty()) return;
  if (periods_in(cut.passage(), modes) > kMaxPeriods) {
    fastest_left_out_ = std::max(fastest_left_out_, turns);
    return;
  }
  const auto [known, is_new] = known_.try_emplace({tool, turns, rounded(cut.slices, modes)});
  if (is_new) known->second = stability_of(cut, modes);
  Unstable& worst = lines_[line];
  if (known->second.excess <= worst.excess) return;
  worst = known->second;
  worst.tool = tool;
}

std::vector<Fault> ChatterCheck::warnings(const std::string& file) const {
  std::vector<Fault> out;
  std::size_t others = 0;
  for (const auto& [line, worst] : lines_) {
    if (worst.excess <= 0.0) continue;
    if (out.size() == kNamedLines) {
      ++others;
      continue;
    }
    out.push_back({{file, line},
                   fmt::format("tool {} at {:.0f} 1/min cuts {:.2f} times as deep as its limit of "
                               "stability: it chatters at {:.0f} Hz{}",
                               worst.tool, 60.0 * worst.turns, worst.excess, worst.frequency,
                               worst.is_flip ? " (flip)" : "")});
  }
  if (fastest_left_out_ > 0.0) {
    out.push_back(
        {{file},
         fmt::format("cuts at {:.0f} 1/min and slower were not examined for chatter: more "
                     "than {:g} periods of a mode from tooth to tooth",
                     60.0 * fastest_left_out_, kMaxPeriods)});
  }
  if (others > 0) {
    out.push_back({{file}, fmt::format("{} more lines with cuts that chatter", others)});
  }
  return out;
}

}  // namespace servomill::sim::preparation
