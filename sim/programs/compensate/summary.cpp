#include "sim/programs/compensate/summary.h"

#include <fmt/format.h>

#include <cmath>

#include "plant/vocabulary/units.h"
#include "sim/system/counted.h"
#include "sim/system/json.h"

namespace servomill::sim::programs {
namespace {

std::string position(const AxisWords& words, const JointLayout& layout) {
  std::string out;
  for (const Axis axis : kAllAxes) {
    if (!layout.joint_of(axis)) continue;
    out += fmt::format("{}{}{:.3f}", out.empty() ? "" : " ", letter(axis),
                       words[index_of(axis)] / (is_linear(axis) ? mm : deg));
  }
  return out;
}

double share(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

}  // namespace

std::vector<std::string> Summary::report(const JointLayout& layout) const {
  std::vector<std::string> out;
  out.push_back(fmt::format("{} of motion became {}: {} added",
                            system::counted(blocks_before, "block"), blocks_after,
                            system::counted(points_added, "point")));
  if (arcs_before > 0) {
    out.push_back(fmt::format("{}: {} kept as one arc, {} split into several, {} replaced by lines",
                              system::counted(arcs_before, "arc"), arcs_kept, arcs_split,
                              arcs_to_lines));
  }
  const double most = largest.correction.head<3>().norm();
  if (most > 0.0) {
    out.push_back(fmt::format(
        "largest correction {:.1f} um (X {:+.1f}, Y {:+.1f}, Z {:+.1f}) in line {}, at {} of the "
        "machine",
        most / um, largest.correction[0] / um, largest.correction[1] / um,
        largest.correction[2] / um, largest.line, position(largest.machine, layout)));
  } else {
    out.emplace_back("nothing to correct");
  }
  if (reversals > 0) {
    out.push_back(fmt::format(
        "{} compensated; while each develops, over {:g} mm at most, up to {:.1f} um remain",
        system::counted(reversals, "reversal"), reversal_distance / mm, reversal_width / um));
  }
  if (undirected) {
    out.push_back(
        fmt::format("the direction of travel is not known from line {} on until each axis has "
                    "moved: the mean of both is used there, up to {:.1f} um remain",
                    undirected->line, undirected_width / um));
  }
  if (!smoothing.empty()) out.push_back(smoothing);
  if (largest_turn > 0.0) {
    out.push_back(
        fmt::format("largest rotation of a rotary axis {:.1f} urad", largest_turn / urad));
  }
  out.push_back(fmt::format(
      "path at feed {:.1f} mm, corrected {:+.4f} %; time at feed {:.1f} s, corrected {:+.4f} %",
      length / mm, 100.0 * share(corrected_length - length, length), time,
      100.0 * share(corrected_time - time, time)));
  if (!servo) return out;
  for (std::string& line : servo->report()) out.push_back(std::move(line));
  return out;
}

std::string Summary::json(const JointLayout& layout, std::string_view uncertainty) const {
  const auto object = [] { return system::JsonObject(system::JsonSpacing::none); };
  constexpr int kSmall = 4, kPath = 6;  // decimals of um and urad, of mm and s
  std::vector<std::string> xyz;
  for (int i = 0; i < 3; ++i) {
    xyz.push_back(fmt::format("{:.{}f}", largest.correction[i] / um, kSmall));
  }
  return object()
      .integer("blocks_before", blocks_before)
      .integer("blocks_after", blocks_after)
      .integer("points_added", points_added)
      .integer("arcs", arcs_before)
      .integer("arcs_kept", arcs_kept)
      .integer("arcs_split", arcs_split)
      .integer("arcs_to_lines", arcs_to_lines)
      .fixed("largest_um", largest.correction.head<3>().norm() / um, kSmall)
      .raw("largest_xyz_um", system::json_list(xyz, system::JsonSpacing::none))
      .raw("largest_at", object()
                             .integer("line", largest.line)
                             .text("machine", position(largest.machine, layout))
                             .line())
      .fixed("largest_turn_urad", largest_turn / urad, kSmall)
      .fixed("length_mm", length / mm, kPath)
      .fixed("corrected_length_mm", corrected_length / mm, kPath)
      .fixed("time_s", time, kPath)
      .fixed("corrected_time_s", corrected_time, kPath)
      .fixed("left_tip_um", left.tip / um, kSmall)
      .fixed("left_axis_urad", left.axis / urad, kSmall)
      .raw("left_line", most_left ? std::to_string(most_left->line) : "null")
      .integer("reversals", reversals)
      .fixed("reversal_um", reversal_width / um, kSmall)
      .fixed("undirected_um", undirected_width / um, kSmall)
      .integer("ends_outside_travel", outside_count)
      .raw("uncertainty", uncertainty)
      .raw("servo", servo ? servo->json() : "null")
      .boolean("unrolled", unrolled)
      .raw("assumed", system::json_texts(assumed, system::JsonSpacing::none))
      .line();
}

}  // namespace servomill::sim::programs
