#include "sim/programs/compensate/compensate_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "controllers/gcode/parameters.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"

namespace servomill::sim::programs {
namespace {

constexpr double kReportedTip = 0.1e-6, kReportedAxis = 1e-6;  // m, rad: of less nothing is said

}  // namespace

std::vector<std::string> assumptions(const CompensateRequest& request, const WorkKnowledge& known,
                                     const Summary& summary, const JointLayout& layout) {
  std::vector<std::string> out;
  for (const int system : known.work_systems) {
    const WorkSystemPlace place = place_of(known.setup, system);
    const bool is_there = !place.offset.isZero(0.0) || place.rotation != 0.0;
    if (!is_there && system != 1) continue;
    out.push_back(fmt::format(
        "{} is at {}{}", kWorkSystems[static_cast<std::size_t>(system - 1)],
        words_text(place.offset, layout, known.given[static_cast<std::size_t>(system - 1)]),
        place.rotation == 0.0 ? "" : fmt::format(", rotated by {:g} deg", place.rotation / deg)));
  }
  for (const auto& [number, length] : summary.tools) {
    out.push_back(number == 0  ? fmt::format("no tool is known: length {:g} mm", length / mm)
                  : number < 0 ? fmt::format("tool offset of G43.1: length {:g} mm", length / mm)
                               : fmt::format("tool {}: length {:g} mm", number, length / mm));
  }
  for (std::size_t i = 0; i < request.left.size(); ++i) {
    if (request.left[i]) out.push_back(fmt::format("{} stays as programmed (--leave)", "XYZ"[i]));
  }
  if (!request.start.empty()) out.push_back(fmt::format("the machine starts at {}", request.start));
  return out;
}

std::vector<std::string> unrolled_parts(const Summary& summary) {
  std::vector<std::string> out;
  if (summary.unrolled) out.emplace_back("loops and subroutines are unrolled");
  if (summary.has_expressions) out.emplace_back("expressions are replaced by numbers");
  if (summary.has_cycles) out.emplace_back("canned cycles are replaced by their moves");
  if (summary.has_cutter_compensation) {
    out.emplace_back(
        "cutter compensation is replaced by its moves, for the diameters of the tool table");
  }
  return out;
}

std::vector<Fault> warnings_of(const CompensateRequest& request, const Summary& summary,
                               const JointLayout& layout) {
  std::vector<Fault> out;
  if (summary.outside) {
    out.push_back(
        {{request.program_file, summary.outside->line},
         fmt::format("ends outside the travel of the machine, at {}{}; check the work offsets",
                     words_text(summary.outside->machine, layout),
                     summary.outside_count == 1
                         ? ""
                         : fmt::format(", as do {} other blocks", summary.outside_count - 1))});
  }
  const bool turns = request.axes == strategies::DisplacedAxes::all;
  std::vector<std::string> left;
  if (summary.left.tip > kReportedTip) {
    left.push_back(fmt::format("{:.2f} um at the TCP", summary.left.tip / um));
  }
  if (summary.left.axis > kReportedAxis) {
    left.push_back(fmt::format("{:.1f} urad of the tool axis", summary.left.axis / urad));
  }
  if (!left.empty() && summary.most_left) {
    out.push_back(
        {{request.program_file, summary.most_left->line},
         fmt::format("cannot correct {} here, the largest found{}", fmt::join(left, " and "),
                     turns ? "" : "; linear axes do not turn the tool")});
  }
  return out;
}

}  // namespace servomill::sim::programs
