#include "sim/engine/engaged_teeth.h"

#include <algorithm>
#include <cmath>

namespace servomill::sim::engine {

int EngagedTeeth::add(int number, const plant::Cutter& cutter, const plant::CutterFrame& frame,
                      std::span<const plant::EngagedArc> arcs, double turns) {
  const auto [tool, is_new] = tools_.try_emplace(number, chips_.size());
  if (is_new) chips_.emplace_back(cutter);
  const std::size_t first = slices_.size();
  const std::vector<plant::EdgeSlice> slices = plant::edge_slices(cutter, frame.feed, arcs);
  slices_.insert(slices_.end(), slices.begin(), slices.end());
  engagements_.push_back(
      {frame.axes, plant::tooth_angle(frame), tool->second, first, slices_.size()});
  passing_frequency_ = std::max(passing_frequency_, std::abs(turns) * cutter.teeth);
  return static_cast<int>(engagements_.size()) - 1;
}

Eigen::Vector3d EngagedTeeth::force(int engagement, double angle, double rotation, double c,
                                    double wear) const {
  const Engagement& at = engagements_[static_cast<std::size_t>(engagement)];
  const std::span<const plant::EdgeSlice> slices(slices_.data() + at.first, at.end - at.first);
  return at.axes * plant::mean_tooth_force(K_, chips_[at.tool], slices, at.phi.at(angle),
                                           at.phi.sense * rotation, c, wear);
}

}  // namespace servomill::sim::engine
