#include "sim/engine/recording_windows.h"

#include <algorithm>

#include "sim/engine/program_path.h"

namespace servomill::sim::engine {
namespace {

constexpr double kSameTime = 1e-9;  // s; times of rows are rounded

}  // namespace

RecordingWindows::RecordingWindows(const model::RecordWindows& windows, const ProgramPath& path)
    : limited_(windows.limited()), times_(windows.times) {
  if (windows.sections.empty()) return;
  std::vector<bool> wanted;
  for (const std::string& name : path.sections()) {
    wanted.push_back(std::find(windows.sections.begin(), windows.sections.end(), name) !=
                     windows.sections.end());
  }
  pieces_.resize(path.size());
  std::vector<int> passes(wanted.size(), 0);
  auto begin = path.section_begins().begin();
  const auto last = path.section_begins().end();
  for (std::size_t piece = 0; piece < path.size(); ++piece) {
    const auto section = static_cast<std::size_t>(path.section(piece));
    const bool begins = begin != last && *begin == piece;
    if (begins) ++passes[section];
    while (begin != last && *begin == piece) ++begin;
    pieces_[piece] = wanted[section] && (passes[section] - 1) % windows.every == 0;
  }
}

bool RecordingWindows::contains(std::size_t piece, double time) const {
  if (!limited_ || (!pieces_.empty() && pieces_[piece])) return true;
  return std::any_of(times_.begin(), times_.end(), [&](const std::array<double, 2>& window) {
    return time >= window[0] - kSameTime && time <= window[1] + kSameTime;
  });
}

}  // namespace servomill::sim::engine
