#include "sim/engine/engaged_teeth.h"

#include <algorithm>
#include <cmath>

namespace servomill::sim::engine {

int EngagedTeeth::add(int number, const plant::Cutter& cutter, const plant::CutterFrame& frame,
                      std::span<const plant::EngagedArc> arcs, double turns) {
  const auto [tool, is_new] = tools_.try_emplace(number, chips_.size());
  if (is_new) {
    chips_.emplace_back(cutter);
    offsets_.push_back(plant::radius_offsets(cutter));
  }
  const std::size_t first = slices_.size();
  std::vector<plant::EdgeSlice> slices = plant::edge_slices(cutter, frame.feed, arcs);
  if (regeneration_) slices = plant::short_slices(slices);
  slices_.insert(slices_.end(), slices.begin(), slices.end());
  engagements_.push_back(
      {frame.axes, plant::tooth_angle(frame), tool->second, first, slices_.size()});
  const double frequency = std::abs(turns) * cutter.teeth;
  passing_frequency_ = std::max(passing_frequency_, frequency);
  longest_passage_ = std::max(longest_passage_, 1.0 / frequency);
  return static_cast<int>(engagements_.size()) - 1;
}

Eigen::Vector3d EngagedTeeth::force(int engagement, double angle, double rotation, double c,
                                    double wear) const {
  const Engagement& at = engagements_[static_cast<std::size_t>(engagement)];
  const std::span<const plant::EdgeSlice> slices(slices_.data() + at.first, at.end - at.first);
  return at.axes * plant::mean_tooth_force(K_, chips_[at.tool], slices, at.phi.at(angle),
                                           at.phi.sense * rotation, c, wear);
}

Eigen::Vector3d EngagedTeeth::force(int engagement, double angle, double rotation, double c,
                                    double wear, const DisplacementsBefore& before) const {
  const Engagement& at = engagements_[static_cast<std::size_t>(engagement)];
  const std::span<const plant::EdgeSlice> slices(slices_.data() + at.first, at.end - at.first);
  plant::PassageDifferences between;
  for (std::size_t m = 0; m < between.size(); ++m) {
    between[m] = at.axes.leftCols<2>().transpose() * before[m];
  }
  return at.axes * plant::mean_vibrating_force(K_, offsets_[at.tool], slices,
                                               {at.phi.at(angle), at.phi.sense * rotation}, c, wear,
                                               between);
}

double EngagedTeeth::edges(int engagement) const {
  const Engagement& at = engagements_[static_cast<std::size_t>(engagement)];
  return static_cast<double>(at.end - at.first) * chips_[at.tool].teeth();
}

int EngagedTeeth::teeth(int engagement) const {
  return chips_[engagements_[static_cast<std::size_t>(engagement)].tool].teeth();
}

}  // namespace servomill::sim::engine
