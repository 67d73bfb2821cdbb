#include "plant/geometry/prepared_functions.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace servomill::plant {

void PreparedFunctions::add(std::size_t axis, std::size_t component, std::size_t joint,
                            const ErrorFunction& f) {
  if (f.is_zero()) return;
  for (std::size_t i = 0; i < f.polynomial.size(); ++i) {
    add_coefficient(i, component, axis, f.polynomial[i]);
  }
  for (const Harmonic& h : f.harmonics) {
    all_waves_.push_back({axis, component, h.amplitude, h.omega(), h.phase});
  }
  for (const LinearTable& t : f.tables) tables_.push_back({axis, component, joint, TableLookup(t)});
  for (const GridFunction& g : f.grids) grids_.push_back({axis, component, joints_of(g), g});
  functions_.axes = std::max(functions_.axes, axis + 1);
  functions_.has_angles = functions_.has_angles || component >= 3;
}

std::vector<std::size_t> PreparedFunctions::joints_of(const GridFunction& grid) const {
  std::vector<std::size_t> joints;
  for (const Axis axis : grid.axes()) {
    joints.push_back(static_cast<std::size_t>(layout_.joint_of(axis).value()));
  }
  return joints;
}

void PreparedFunctions::add_reversals(std::size_t axis, std::size_t component, std::size_t joint,
                                      const ErrorFunction& f) {
  for (const Reversal& r : f.reversals) {
    if (r.is_zero()) continue;
    const Play play{static_cast<int>(joint), r.distance};
    const auto place = std::find(plays_.begin(), plays_.end(), play) - plays_.begin();
    if (static_cast<std::size_t>(place) == plays_.size()) plays_.push_back(play);
    Reversal half = r;
    for (double& w : half.width) w *= 0.5;
    reversals_.push_back({axis, component, joint, static_cast<std::size_t>(place), half});
  }
}

void PreparedFunctions::add_coefficient(std::size_t power, std::size_t component, std::size_t axis,
                                        double value) {
  if (value == 0.0) return;  // does not raise the degree
  if (power >= powers_.size()) powers_.resize(power + 1);
  powers_[power].e[component][axis] += value;
}

// Waves that differ in amplitude only share a sine.
void PreparedFunctions::join_waves() {
  const auto same = [](const Wave& a, const Wave& b) {
    return a.axis == b.axis && a.omega == b.omega && a.phase == b.phase;
  };
  std::size_t wave = 0;
  for (std::size_t i = 0; i < all_waves_.size(); ++i) {
    const Wave& first = all_waves_[i];
    const auto begin = all_waves_.begin(), here = begin + static_cast<std::ptrdiff_t>(i);
    if (std::any_of(begin, here, [&](const Wave& w) { return same(w, first); })) continue;
    const std::size_t lane = wave % kLaneWidth;
    if (lane == 0) waves_.emplace_back(VolumetricWaves{});
    waves_.back().omega[lane] = first.omega;
    waves_.back().phase[lane] = first.phase;
    waves_.back().axis[lane] = static_cast<std::uint8_t>(first.axis);
    std::for_each(here, all_waves_.end(), [&](const Wave& w) {
      if (!same(w, first)) return;
      VolumetricHarmonic& h = harmonics_.emplace_back(VolumetricHarmonic{wave, w.component, {}});
      h.amplitude[w.axis] = w.amplitude;
    });
    ++wave;
  }
  functions_.number_of_waves = wave;
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  harmonics_.emplace_back(VolumetricHarmonic{kNone, 0, {}});
}

VolumetricFunctions PreparedFunctions::finish() {
  join_waves();
  constexpr std::size_t kCubic = 4;  // coefficients
  powers_.resize(std::max(powers_.size(), kCubic));
  functions_.polynomial = powers_.data();
  functions_.degree = powers_.size() - 1;
  functions_.waves = waves_.data();
  functions_.harmonics = harmonics_.data();
  functions_.has_terms = !waves_.empty() || has_tables() || !reversals_.empty();
  functions_.is_cubic = powers_.size() == kCubic && !functions_.has_terms;
  return functions_;
}

}  // namespace servomill::plant
