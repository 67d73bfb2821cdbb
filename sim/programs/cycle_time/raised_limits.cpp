#include "sim/programs/cycle_time/raised_limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "controllers/path/tcp_motion.h"
#include "sim/model/machine.h"
#include "sim/system/worker_thread.h"

namespace servomill::sim::programs {

RaisedLimits::Variant& RaisedLimits::add_variant(std::string what) {
  return variants_.emplace_back(Variant{std::move(what), limits_, options_});
}

RaisedLimits::RaisedLimits(const model::MachineSettings& machine, const ProgramDuration& planned,
                           const DurationSettings& settings, double share, unsigned threads)
    : layout_(machine.chain.layout),
      settings_(settings),
      limits_(planned.limits()),
      options_(planned.options()),
      threads_(threads) {
  const double factor = 1.0 + share;
  add_variant("programmed feed").options.feed_override *= factor;
  controllers::PathOptions& tolerance = add_variant("path tolerance").options;
  tolerance.tolerance *= factor;
  tolerance.tolerance_share *= factor;
  const std::vector<int> joints = machine.joints();
  const bool has_rotary =
      std::any_of(joints.begin(), joints.end(), [](int j) { return j >= kLinearJoints; });
  if (has_rotary) add_variant("rotary tolerance").options.rotary_tolerance *= factor;
  if (options_.block_time > 0.0) {
    add_variant("blocks per second of the NC").options.block_time /= factor;
  }
  constexpr std::array<std::pair<const char*, Joints controllers::JointLimits::*>, 3> kLimits = {{
      {"velocity", &controllers::JointLimits::v},
      {"acceleration", &controllers::JointLimits::a},
      {"jerk", &controllers::JointLimits::j},
  }};
  for (const auto& [name, member] : kLimits) {
    if (joints.size() > 1) {
      add_variant(fmt::format("{} of all axes", name)).limits.*member *= factor;
    }
    for (const int j : joints) {
      Variant& one = add_variant(fmt::format("{} of {}", name, layout_.letter_of(j)));
      (one.limits.*member)[j] *= factor;
    }
  }
}

void RaisedLimits::add(const PlannedPart& part) {
  system::for_each_index(variants_.size(), threads_, [&](std::size_t k) {
    Variant& one = variants_[k];
    const auto tip = tip_motions_of(part.moves, part.start, settings_, one.limits, one.options);
    const auto faster =
        controllers::plan(part.moves, layout_, part.start, one.limits, one.options, tip);
    one.saved += part.trajectory.duration() - faster.duration();
  });
}

std::vector<RaisedLimit> RaisedLimits::result() const {
  std::vector<RaisedLimit> out;
  for (const Variant& one : variants_) out.push_back({one.what, one.saved});
  constexpr double kHardly = 0.005;  // s; less keeps the order of the limits
  const auto weight = [](const RaisedLimit& one) {
    return std::abs(one.saved) < kHardly ? 0.0 : one.saved;
  };
  std::stable_sort(out.begin(), out.end(),
                   [&](const auto& a, const auto& b) { return weight(a) > weight(b); });
  return out;
}

}  // namespace servomill::sim::programs
