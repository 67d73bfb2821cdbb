#include "sim/run/case_warnings.h"

#include <fmt/format.h>

#include <algorithm>

#include "controllers/path/feed_reduction.h"
#include "plant/geometry/grid_overshoot.h"
#include "plant/kinematics/inverse.h"
#include "plant/vocabulary/units.h"
#include "sim/engine/depth_of_cut.h"
#include "sim/evaluation/nominal_part.h"
#include "sim/evaluation/probed_part.h"
#include "sim/input/implausible.h"
#include "sim/model/heat.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/run/residual_errors.h"

namespace servomill::sim::run {
namespace {

// Nominal points this far from the mesh are reported: its facets stand in for curved faces.
constexpr double kFacets = 1e-6;  // m

const plant::MachineChain& chain_of(const preparation::PreparedParts& one) {
  return one.scenario.machine_of(one.spec).chain;
}

std::string note_of(const Fault& warning) {
  return fmt::format("{}: warning: {}", to_string(warning.place), warning.message);
}

// The strategy of a case that displaces its feedback.
std::string_view displacing_strategy(const preparation::PreparedParts& one) {
  for (std::size_t k = 0; k < one.strategies.size(); ++k) {
    if (one.strategies[k]->displaces_feedback()) return one.spec.strategies[k].entry->name;
  }
  return {};
}

// "case 'a'", "cases 'a', 'b'"
std::string quoted_cases(const std::vector<std::string>& names) {
  return fmt::format("{} '{}'", names.size() == 1 ? "case" : "cases", fmt::join(names, "', '"));
}

// The largest feed along the path (m/s) with its override; 0: the program feeds no linear axis.
double largest_feed(const preparation::PreparedParts& one) {
  double largest = 0.0;
  for (const Move& move : one.program.moves) {
    const bool moves_xyz = move.kind == MoveKind::arc || move.s_end > move.s_begin;
    if (is_feed(move.kind) && moves_xyz) largest = std::max(largest, move.feed);
  }
  return largest * one.scenario.program.feed_override;
}

// G33 and G33.1 with a spindle of which nothing is known.
std::optional<std::string> unknown_spindle(const preparation::PreparedParts& one) {
  if (one.scenario.machine_of(one.spec).nc.spindle) return std::nullopt;
  const auto first = first_move(
      one.program.moves, [](const Move& move) { return move.synchronised != Synchronised::no; });
  if (!first) return std::nullopt;
  return fmt::format(
      "{}:{}: warning: the acceleration of the spindle is unknown: synchronised motion is planned "
      "with the limits of the axes only; set nc.spindle.acceleration_rpm_per_s of the machine",
      one.scenario.program.file, first->line);
}

// Cases that the feedback hardware delays beside others that it does not.
std::optional<std::string> uneven_hardware(const preparation::PreparedParts& noted) {
  std::vector<std::string> with, without;
  double delay = 0.0;
  for (const model::CaseSpec& one : noted.scenario.cases) {
    const auto its = noted.scenario.signal_delay_of(one);
    if (!its) continue;
    delay = std::max(delay, *its);
    (*its > 0.0 ? with : without).push_back(one.name);
  }
  if (with.empty() || without.empty()) return std::nullopt;
  const double feed = largest_feed(noted);
  const std::string displaced =
      feed > 0.0 ? fmt::format(", which is {:.2g} um at the largest feed of {:.3g} m/min",
                               delay * feed / um, feed * 60.0)
                 : "";
  return fmt::format(
      "warning: the feedback hardware is connected in {} but not in {}: readings of the latter "
      "lack its delay of {:g} us{}; set feedback_hardware.connected = true to connect it in all "
      "cases",
      quoted_cases(with), quoted_cases(without), delay / us, displaced);
}

// "part.ngc:12: warning: case one: strategy feedback: virtual displacement of Y saturated ..."
std::string note_of(const preparation::PreparedParts& one, const strategies::Saturation& held) {
  controllers::Trajectory::Cursor cursor{};
  const int line = one.motion.trajectory.at(held.first, cursor).line;
  const bool linear = held.joint < kLinearJoints;
  return fmt::format(
      "{}:{}: warning: case {}: strategy {}: {} of {} saturated at {:g} {}{}, first here, "
      "{:.2f} s in all",
      one.scenario.program.file, line, one.spec.name, displacing_strategy(one),
      held.of_rate ? "rate of the virtual displacement" : "virtual displacement",
      one.scenario.machine.chain.layout.letter_of(held.joint),
      held.limit / (linear ? held.of_rate ? mm : um : 1e-3),
      linear ? held.of_rate ? "mm" : "um" : "mrad", held.of_rate ? "/s" : "", held.time);
}

// Deviations in the runs that a strategy has learnt from.
std::string note_of_trials(const preparation::PreparedParts& one, std::size_t number) {
  const std::vector<strategies::TrialFigures>& trials = one.lessons[number].trials;
  std::vector<std::string> rms;
  for (const strategies::TrialFigures& run : trials)
    rms.push_back(fmt::format("{:.3g}", run.rms / um));
  const auto best = std::min_element(trials.begin(), trials.end(),
                                     [](const auto& a, const auto& b) { return a.rms < b.rms; });
  const bool gets_better = trials.size() < 2 || trials.back().rms < trials.front().rms;
  return fmt::format(
      "case {}: strategy {}: deviation from the interpolated path in {} run{} before the case: rms "
      "{} um{}; largest {:.3g} um at first, {:.3g} um in the best",
      one.spec.name, one.spec.strategies[number].entry->name, trials.size(),
      trials.size() == 1 ? "" : "s", fmt::join(rms, ", "),
      gets_better ? "" : ", which does not get better", trials.front().largest / um,
      best->largest / um);
}

// "Z = 100 mm, X = 50 mm"
std::string position_text(const std::vector<Axis>& axes, const std::vector<double>& at) {
  std::string text;
  for (std::size_t k = 0; k < axes.size(); ++k) {
    text += fmt::format("{}{} = {:.5g} {}", k == 0 ? "" : ", ", letter(axes[k]),
                        at[k] / (is_linear(axes[k]) ? mm : deg), is_linear(axes[k]) ? "mm" : "deg");
  }
  return text;
}

// Cubic grids that leave the range of their values; of the errors of all cases, with the first.
void add_overshoots(const preparation::PreparedParts& one, std::vector<std::string>& out) {
  if (one.spec.name != one.scenario.cases.front().name) return;
  const auto add = [&](const std::string& model, const plant::ErrorName& name,
                       const plant::GridFunction& grid) {
    const auto found = plant::overshoot_of(grid);
    if (!found) return;
    const Axis along = grid.axes()[found->argument];
    const double unit = is_linear(along) ? mm : deg;
    out.push_back(fmt::format(
        "warning: errors.{}.{}: at {} the cubic grid is {:.3g} {} beyond its values at {} = {:.5g} "
        "and {:.5g} {}; add positions there, or use interpolation = \"linear\"",
        model, to_string(name), position_text(grid.axes(), found->at), found->beyond / um,
        is_linear(name.direction) ? "um" : "urad", letter(along), found->from / unit,
        found->to / unit, is_linear(along) ? "mm" : "deg"));
  };
  for (const auto& [model, errors] : one.scenario.errors) {
    for (const Axis axis : kAllAxes) {
      for (const Axis direction : kAllAxes) {
        const plant::ErrorName name{direction, axis, false};
        for (const plant::GridFunction& grid : errors.component(name).grids) add(model, name, grid);
      }
    }
  }
}

// Probes and stock stay where the work_offset has them, whatever the program does to its zero.
std::optional<Fault> shifted_program(const preparation::PreparedParts& one) {
  const std::optional<Move> move = one.program.first_shifted_feed();
  std::vector<std::string_view> unshifted;
  if (!one.scenario.probes.empty()) unshifted.push_back("[[probe]]");
  if (!one.scenario.stock.empty()) unshifted.push_back("[[part.stock]]");
  if (!move || unshifted.empty()) return std::nullopt;
  return Fault{{one.scenario.program.file, move->line},
               fmt::format("feeds in coordinates shifted by G52, G92, G10 or another work system "
                           "than G54, which does not shift {}",
                           fmt::join(unshifted, " and "))};
}

// Ideal axes move without current.
std::optional<std::string> cold_drives(const preparation::PreparedParts& one) {
  const auto& heat = one.scenario.machine_of(one.spec).heat;
  if (heat == nullptr || one.spec.servo != model::ServoModel::ideal) return std::nullopt;
  const bool has_drives =
      std::any_of(heat->sources.begin(), heat->sources.end(), [](const model::HeatSource& source) {
        return source.kind == model::HeatKind::motor || source.kind == model::HeatKind::friction;
      });
  if (!has_drives) return std::nullopt;
  return fmt::format("case {}: an ideal servo has no current: motors and friction generate no heat",
                     one.spec.name);
}

// Forces at the actual depth of cut are known next to the path alone.
std::optional<std::string> cut_off_path(const preparation::PreparedParts& one, double off_path) {
  if (off_path <= engine::DisplacedCut::kLargest) return std::nullopt;
  return fmt::format(
      "warning: case {}: the tool was up to {:.3g} mm off its nominal path while it cut: forces at "
      "the actual depth of cut are extrapolated linearly from {:g} mm to {:g} mm, and constant "
      "beyond",
      one.spec.name, off_path / mm, engine::DisplacedCut::kStep / mm,
      engine::DisplacedCut::kLargest / mm);
}

}  // namespace

std::vector<std::string> notes_of_run(const preparation::PreparedParts& one,
                                      const engine::CaseResult& result) {
  std::vector<std::string> out;
  for (const Fault& warning : one.program.warnings) out.push_back(note_of(warning));
  out.insert(out.end(), one.warnings.begin(), one.warnings.end());
  for (std::size_t k = 0; k < one.lessons.size(); ++k) {
    if (!one.lessons[k].trials.empty()) out.push_back(note_of_trials(one, k));
  }
  if (const auto shifted = shifted_program(one)) out.push_back(note_of(*shifted));
  if (one.cutting != nullptr) {
    for (const auto& [place, message] : one.cutting->warnings) {
      out.push_back(note_of({place, fmt::format("case {}: {}", one.spec.name, message)}));
    }
  }
  for (const auto& slowed : one.motion.slowed) {
    out.push_back(note_of(
        {{one.scenario.program.file, slowed.line}, to_string(slowed, chain_of(one).layout)}));
  }
  for (const std::string& value : input::implausible_values(one.scenario.machine_of(one.spec))) {
    out.push_back("warning: " + value);
  }
  add_overshoots(one, out);
  if (auto cold = cold_drives(one)) out.push_back(std::move(*cold));
  if (auto spindle = unknown_spindle(one)) out.push_back(std::move(*spindle));
  if (auto uneven = uneven_hardware(one)) out.push_back(std::move(*uneven));
  if (auto off_path = cut_off_path(one, result.off_path)) out.push_back(std::move(*off_path));
  for (const strategies::Saturation& saturation : result.saturations)
    out.push_back(note_of(one, saturation));
  return out;
}

std::vector<std::string> notes_of_uncorrectable(const preparation::PreparedParts& one) {
  const plant::InverseKinematics inverse(chain_of(one));
  std::vector<std::string> out;
  for (std::size_t k = 0; k < one.strategies.size(); ++k) {
    const strategies::Strategy& strategy = *one.strategies[k];
    const auto found = residual_errors(one.program.path, strategy, inverse, one.program.first_tip);
    if (!found) continue;
    std::vector<std::string> left;
    if (found->left.tip > kUncorrected.tip) {
      left.push_back(fmt::format("{:.2f} um at the TCP", found->left.tip / um));
    }
    if (found->left.axis > kUncorrected.axis) {
      left.push_back(fmt::format("{:.1f} urad of the tool axis", found->left.axis / urad));
    }
    const bool is_near =
        strategy.displaces_rotary() && found->singular_angle < controllers::kNearSingular;
    out.push_back(fmt::format(
        "{}:{}: warning: case {}: strategy {} cannot correct {} here{}, the largest found",
        one.scenario.program.file, found->line, one.spec.name, one.spec.strategies[k].entry->name,
        fmt::join(left, " and "),
        is_near ? fmt::format(", {:.2f} deg from a singular direction", found->singular_angle / deg)
                : ""));
  }
  return out;
}

std::vector<std::string> notes_of_left_tables(const preparation::PreparedParts& one) {
  const JointLayout& layout = chain_of(one).layout;
  std::vector<std::string> out;
  for (std::size_t k = 0; k < one.strategies.size(); ++k) {
    for (const LeftTable& left : left_tables(one.program.path, *one.strategies[k], layout)) {
      const char axis = layout.letter_of(left.table.joint);
      out.push_back(fmt::format(
          "{}:{}: warning: case {}: strategy {}: the table over {} ends at {:.4f} mm, the program "
          "continues to {:.4f} mm; beyond the end the last value is used",
          one.scenario.program.file, left.line, one.spec.name, one.spec.strategies[k].entry->name,
          axis, left.table.end / mm, left.farthest / mm));
    }
  }
  return out;
}

std::optional<evaluation::PartFit> lay_on_nominal(const std::string& case_name,
                                                  const evaluation::NominalPart& part,
                                                  double distance,
                                                  std::span<const evaluation::ProbedFeature> probes,
                                                  std::vector<std::string>& notes) {
  auto found = evaluation::fit_part(probes, *part.mesh);
  if (const metrology::NoFit* none = std::get_if<metrology::NoFit>(&found)) {
    notes.push_back(
        fmt::format("warning: case {}: best fit to '{}': {}", case_name, part.file, none->why));
    return std::nullopt;
  }
  if (distance > kFacets) {
    notes.push_back(fmt::format(
        "warning: case {}: nominal points of the probes are up to {:.3g} um off '{}' (facets in "
        "place of curved faces, or another part); distances after best fit include this",
        case_name, distance / um, part.file));
  }
  return std::get<evaluation::PartFit>(std::move(found));
}

}  // namespace servomill::sim::run
