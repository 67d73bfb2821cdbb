#include "sim/programs/travel_check.h"

#include <fmt/format.h>

#include "controllers/path/travel.h"
#include "sim/model/machine.h"
#include "sim/programs/program_extent.h"

namespace servomill::sim::programs {
namespace {

constexpr std::size_t kMaxShown = 10;

}  // namespace

void TravelCheck::add(const Move& move, const MoveKnowledge& known, const std::string& file) {
  ProgramExtent extent;
  extent.add(move, known);
  const JointLayout& layout = machine_.chain.layout;
  for (const Axis axis : kAllAxes) {
    const auto joint = layout.joint_of(axis);
    const AxisRange& range = extent.machine()[static_cast<std::size_t>(index_of(axis))];
    if (!joint || !range.is_known()) continue;
    const auto message =
        controllers::outside_travel(layout, *joint, range.lower, range.upper,
                                    machine_.nc.lower[*joint], machine_.nc.upper[*joint]);
    if (message.empty()) continue;
    if (first_.size() < kMaxShown) {
      first_.push_back({{file, move.line}, message});
    } else {
      ++others_;
    }
  }
}

std::vector<Fault> TravelCheck::faults(const std::string& program) const {
  std::vector<Fault> out = first_;
  if (others_ > 0)
    out.push_back({{program}, fmt::format("{} more moves leave the travel", others_)});
  return out;
}

}  // namespace servomill::sim::programs
