#include "sim/input/read_recorded_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "sim/input/scenario_document.h"
#include "sim/model/scenario.h"

namespace servomill::sim::input {
namespace {

constexpr std::string_view kLetters = "XYZABC";
constexpr std::array<std::string_view, 3> kSeen = {"scales", "tip", "part"};  // as model::SeenBy

// { X = "s actual X", Y = "s actual Y" }
std::map<char, std::string> read_channels(config::Reader& run, const char* key) {
  std::map<char, std::string> out;
  config::Reader table = run.table(key);
  for (const std::string& name : table.keys()) {
    if (name.size() != 1 || kLetters.find(name[0]) == std::string_view::npos) continue;  // unread
    out.emplace(name[0], table.text(name));
  }
  return out;
}

// A grid encoder reads along X, Y and Z of the workpiece, whatever axes move.
void check_tip(config::Reader& run, const model::RecordedRunSpec& spec, std::size_t faults_before) {
  if (run.faults() > faults_before) return;
  const bool is_linear = std::all_of(spec.measured.begin(), spec.measured.end(),
                                     [](const auto& one) { return one.first >= 'X'; });
  if (spec.measured.empty() || !is_linear) {
    run.fault("measured", "of a tip must name channels of X, Y or Z");
  }
  if (spec.reference.empty()) {
    run.fault("reference", "must name the channels of the axes that move");
  }
}

// The case of a result file, and which features of its part.
void read_case(config::Reader& run, model::RecordedRunSpec& spec) {
  if (run.has("case")) {
    spec.case_name = run.text("case");
    if (spec.case_name.empty()) run.fault("case", "must name a case of the file");
  }
  spec.probes = run.texts_or("probes", {});
  if (spec.probes.empty() || (spec.sees == model::SeenBy::part && run.has("case"))) return;
  run.fault("probes", "are those of a case: needs sees = \"part\", and case");
}

model::RecordedRunSpec read_run(config::Reader& run) {
  model::RecordedRunSpec out;
  const std::size_t before = run.faults();
  const std::string file = run.text("file");
  out.place = run.place("file");
  if (run.faults() == before && file.empty()) run.fault("file", "must name a recording");
  out.file = beside(out.place, file);
  out.sees = static_cast<model::SeenBy>(run.choice_or("sees", 0, kSeen));
  read_case(run, out);
  if (out.sees == model::SeenBy::part || !out.case_name.empty()) return out;
  out.measured = read_channels(run, "measured");
  out.reference = read_channels(run, "reference");
  if (out.sees == model::SeenBy::tip) {
    check_tip(run, out, before);
    return out;
  }
  const auto same_axis = [](const auto& a, const auto& b) { return a.first == b.first; };
  if (run.faults() == before &&
      (out.measured.empty() ||
       !std::equal(out.measured.begin(), out.measured.end(), out.reference.begin(),
                   out.reference.end(), same_axis))) {
    run.fault("reference", "must name a channel for the axes of 'measured', at least one");
  }
  return out;
}

}  // namespace

void read_recorded_runs(config::Reader& table, model::StrategySpec& strategy) {
  for (config::Reader& run : table.tables_or_none("recording")) {
    strategy.recordings.push_back(read_run(run));
  }
  if (strategy.recordings.empty()) return;
  for (const model::RecordedRunSpec& one : strategy.recordings) {
    if (one.sees == strategy.recordings.front().sees) continue;
    table.fault("recording", "must see the same in all recordings: scales, tip or part");
    break;
  }
  for (const std::string_view key : strategy.entry->recorded_instead) {
    if (!strategy.key_places.contains(key)) continue;
    table.fault(key, "is not used with [[case.strategy.recording]]: the recordings are the runs");
  }
}

}  // namespace servomill::sim::input
