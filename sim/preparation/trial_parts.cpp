/// CaseTrials: deviations as probed parts show them.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "plant/kinematics/chain.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "sim/model/work_frame.h"
#include "sim/preparation/trial_runs.h"
#include "sim/system/counted.h"

namespace servomill::sim::preparation {
namespace {

constexpr std::size_t kMaxRanges = 8;  // of lines in a note

std::string lines_text(const std::vector<UnprobedRun>& runs) {
  std::vector<std::string> out;
  for (const UnprobedRun& run : runs) {
    if (out.size() == kMaxRanges) break;
    out.push_back(run.first_line == run.last_line
                      ? std::to_string(run.first_line)
                      : fmt::format("{}-{}", run.first_line, run.last_line));
  }
  const std::size_t left = runs.size() - out.size();
  const std::string more =
      left == 0 ? "" : fmt::format(" and {}", system::counted(left, "other range"));
  const bool is_one = runs.size() == 1 && runs[0].first_line == runs[0].last_line;
  return fmt::format("{} {}{}", is_one ? "line" : "lines", fmt::join(out, ", "), more);
}

// Why no place was found at which a point was cut.
std::string unmatched(const CutSearch& search, int line, const std::string& program) {
  if (search.is_along) {
    return fmt::format(
        "the tool moves there along the normal or its own axis (line {} of {}), but only "
        "deviations normal to the path are learnt; omit the point",
        line, program);
  }
  const std::string where =
      std::isinf(search.nearest)
          ? fmt::format("no feed motion of {} has a cutting edge that faces it", program)
          : fmt::format(
                "line {} of {} passes {:.3g} mm from it, more than {:g} mm beyond its "
                "deviation",
                line, program, search.nearest / mm, kFarthestCut / mm);
  return where +
         "; check work coordinates, diameter of the tool and side to which the normal points";
}

// No feed motion is made by a tool with a diameter.
InputError unknown_cutter(const std::string& file, int tool, const std::string& program) {
  const std::string which = tool == 0 ? fmt::format("{} calls no tool", program)
                                      : fmt::format("tool {} of {} has no diameter", tool, program);
  return {
      {file},
      which + ", so the cut surface is unknown; set diameter_mm of the tool in [[program.tool]]"};
}

}  // namespace

void CaseTrials::take_parts() {
  const std::vector<ToolRow> rows = tool_rows();
  for (const RecordedRun& run : recordings_) {
    const PartDeviations part = part_deviations(rows, probed_cuts(run, rows));
    std::vector<Joints> deviation;
    for (std::size_t n = 0; n < rows.size(); ++n) {
      deviation.push_back(in_linear_joints(wanted_[n], part.tip[n]));
    }
    of_parts_.push_back(std::move(deviation));
    note_unprobed(run, part.unprobed);
  }
}

// The tool in the workpiece, row by row.
std::vector<ToolRow> CaseTrials::tool_rows() const {
  const engine::ProgramPath& path = setting_.program.path;
  const auto& cutters = setting_.scenario.program.cutters;
  std::vector<ToolRow> out;
  std::size_t piece = path.size();
  ToolRow now;
  int tool = 0, run = 0, unknown = 0;
  bool knows_cutter = false;
  for (const Wanted& wanted : wanted_) {
    if (wanted.piece != piece) {
      piece = wanted.piece;
      const int before = tool;
      tool = path.piece(piece).tool;
      const auto cutter = cutters.find(tool);
      now.cutter = cutter == cutters.end() ? nullptr : &cutter->second;
      now.line = path.line(piece);
      if (tool != before) ++run;
    }
    const ToolPose pose = plant::forward(actual().chain, wanted.Q, wanted.p_ST);
    if (wanted.rapid && (out.empty() || out.back().run >= 0)) ++run;
    if (now.cutter == nullptr && !wanted.rapid) unknown = tool;
    knows_cutter = knows_cutter || (now.cutter != nullptr && !wanted.rapid);
    out.push_back({pose.p_WT, pose.k_W, now.cutter, wanted.rapid ? -1 : run, now.line});
  }
  if (!knows_cutter) {
    throw unknown_cutter(recordings_.front().file, unknown, setting_.scenario.program.file);
  }
  return out;
}

std::vector<ProbedCut> CaseTrials::probed_cuts(const RecordedRun& run,
                                               const std::vector<ToolRow>& rows) const {
  const model::PartFrame frame = model::work_frame(
      actual().chain, setting_.scenario.program.work_offset + setting_.spec.work_offset);
  std::vector<ProbedCut> out;
  std::vector<Fault> faults;
  for (const readings::PartPoint& one : run.points) {
    throw_if_interrupted();
    const Eigen::Vector3d normal = frame.R_WG * one.normal;
    const CutSearch search = find_cut(rows, {frame.in_workpiece(one.point), normal, one.deviation});
    for (const CutPlace& place : search.places) out.push_back({place, normal, one.deviation});
    if (!search.places.empty()) continue;
    const std::string name = one.name.empty() ? "point" : one.name;
    faults.push_back({one.place, fmt::format("{} {}: {}", name, model::program_words(one.point),
                                             unmatched(search, rows[search.nearest_row].line,
                                                       setting_.scenario.program.file))});
  }
  if (!faults.empty()) throw InputError(faults);
  return out;
}

void CaseTrials::note_unprobed(const RecordedRun& run, const std::vector<UnprobedRun>& unprobed) {
  if (unprobed.empty()) return;
  notes_.push_back(
      fmt::format("{} has no point of the feed motion in {} of {}, which receives no offset",
                  run.file, lines_text(unprobed), setting_.scenario.program.file));
}

}  // namespace servomill::sim::preparation
