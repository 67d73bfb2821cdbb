#include "sim/limits/logged_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "plant/vocabulary/input_error.h"
#include "sim/limits/mean_derivative.h"

namespace servomill::sim::limits {
namespace {

const AxisSignal* position_of(std::span<const AxisSignal> signals, int joint) {
  for (const AxisSignal& signal : signals) {
    if (signal.joint == joint && signal.order == 0) return &signal;
  }
  return nullptr;
}

// Samples of one axis that others have, too: times that one of them lacks are left out of all.
std::vector<double> common_times(const std::vector<const AxisSignal*>& all) {
  std::vector<double> out = all.front()->t;
  for (const AxisSignal* signal : all) {
    std::vector<double> both;
    std::set_intersection(out.begin(), out.end(), signal->t.begin(), signal->t.end(),
                          std::back_inserter(both));
    out = std::move(both);
  }
  return out;
}

}  // namespace

LoggedPath logged_path(const std::string& file, std::span<const AxisSignal> signals,
                       const JointLayout& layout, double resolution) {
  std::vector<const AxisSignal*> all;
  LoggedPath out;
  for (int j = 0; j < kJoints; ++j) {
    if (!layout.has(j)) continue;
    const AxisSignal* signal = position_of(signals, j);
    if (signal != nullptr) all.push_back(signal);
    if (signal != nullptr || j >= kLinearJoints) continue;
    throw InputError({file}, fmt::format("the path needs the positions of X, Y and Z: no channel "
                                         "is a position of {}",
                                         layout.letter_of(j)));
  }
  out.t = common_times(all);
  if (out.t.size() < 2) {
    throw InputError({file}, "the positions of the axes have no two times in common");
  }
  out.at.assign(out.t.size(), AxisWords::Zero());
  for (const AxisSignal* signal : all) {
    const int axis = index_of(*layout.axis[static_cast<std::size_t>(signal->joint)]);
    out.is_recorded[static_cast<std::size_t>(axis)] = true;
    out.quantum[axis] = resolution > 0.0 ? resolution : quantum_of(signal->x) * signal->unit;
    std::size_t from = 0;
    for (std::size_t k = 0; k < out.t.size(); ++k) {
      while (signal->t[from] < out.t[k]) ++from;
      out.at[k][axis] = signal->x[from] * signal->unit;
    }
  }
  return out;
}

}  // namespace servomill::sim::limits
