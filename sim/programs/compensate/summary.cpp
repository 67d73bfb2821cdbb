#include "sim/programs/compensate/summary.h"
#include "sim/system/counted.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "plant/vocabulary/units.h"

namespace servomill::sim {
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
  out.push_back(fmt::format("{} of motion became {}: {} added", counted(blocks_before, "block"),
                            blocks_after, counted(points_added, "point")));
  if (arcs_before > 0) {
    out.push_back(fmt::format("{}: {} kept as one arc, {} split into several, {} replaced by lines",
                              counted(arcs_before, "arc"), arcs_kept, arcs_split, arcs_to_lines));
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
        counted(reversals, "reversal"), reversal_distance / mm, reversal_width / um));
  }
  if (undirected) {
    out.push_back(fmt::format(
        "the direction of travel is not known from line {} on until each axis has moved: the mean "
        "of both is taken there, up to {:.1f} um remain",
        undirected->line, undirected_width / um));
  }
  if (!smoothing.empty()) out.push_back(smoothing);
  if (largest_turn > 0.0) {
    out.push_back(fmt::format("largest turn of a rotary axis {:.1f} urad", largest_turn / urad));
  }
  out.push_back(fmt::format(
      "path at feed {:.1f} mm, corrected {:+.4f} %; time at feed {:.1f} s, corrected {:+.4f} %",
      length / mm, 100.0 * share(corrected_length - length, length), time,
      100.0 * share(corrected_time - time, time)));
  return out;
}

std::string Summary::json(const JointLayout& layout) const {
  const auto at = [&](const At& one) {
    return fmt::format("{{\"line\":{},\"machine\":\"{}\"}}", one.line,
                       position(one.machine, layout));
  };
  std::string out = fmt::format(
      "{{\"blocks_before\":{},\"blocks_after\":{},\"points_added\":{},\"arcs\":{},"
      "\"arcs_kept\":{},\"arcs_split\":{},\"arcs_to_lines\":{}",
      blocks_before, blocks_after, points_added, arcs_before, arcs_kept, arcs_split, arcs_to_lines);
  out += fmt::format(
      ",\"largest_um\":{:.4f},\"largest_xyz_um\":[{:.4f},{:.4f},{:.4f}],\"largest_at\":{}",
      largest.correction.head<3>().norm() / um, largest.correction[0] / um,
      largest.correction[1] / um, largest.correction[2] / um, at(largest));
  out += fmt::format(
      ",\"largest_turn_urad\":{:.4f},\"length_mm\":{:.6f},\"corrected_length_mm\":{:.6f},"
      "\"time_s\":{:.6f},\"corrected_time_s\":{:.6f}",
      largest_turn / urad, length / mm, corrected_length / mm, time, corrected_time);
  out += fmt::format(",\"left_tip_um\":{:.4f},\"left_axis_urad\":{:.4f},\"left_line\":{}",
                     left.tip / um, left.axis / urad, most_left ? most_left->line : 0);
  out += fmt::format(",\"reversals\":{},\"reversal_um\":{:.4f},\"undirected_um\":{:.4f}", reversals,
                     reversal_width / um, undirected_width / um);
  out += fmt::format(",\"ends_outside_travel\":{},\"unrolled\":{},\"assumed\":[", outside_count,
                     unrolled);
  for (std::size_t i = 0; i < assumed.size(); ++i) {
    std::string text;
    for (const char c : assumed[i]) {
      if (c == '"' || c == '\\') text += '\\';
      text += c;
    }
    out += fmt::format("{}\"{}\"", i == 0 ? "" : ",", text);
  }
  return out + "]}";
}

}  // namespace servomill::sim
