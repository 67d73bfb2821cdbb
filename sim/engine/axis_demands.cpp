#include "sim/engine/axis_demands.h"

#include <algorithm>
#include <cmath>

namespace servomill::sim::engine {
namespace {

// Takes the joints whose value is larger than all before it.
template <class Note>
void take_larger(const Joints& values, Joints& largest, Note note) {
  const Joints sizes = values.cwiseAbs();
  if ((sizes.array() <= largest.array()).all()) return;
  for (int j = 0; j < kJoints; ++j) {
    if (!(sizes[j] > largest[j])) continue;
    largest[j] = sizes[j];
    note(static_cast<std::size_t>(j), sizes[j]);
  }
}

}  // namespace

DemandMeter::DemandMeter(double period, std::size_t periods)
    : step_(period * static_cast<double>(periods)),
      periods_(periods),
      places_(AxisDemands::kOrders * periods + 1, Joints::Zero()) {}

void DemandMeter::start(const Joints& path, const Joints& offset) {
  std::fill(places_.begin(), places_.end(), path + offset);
  take_larger(offset, offset_, [&](std::size_t joint, double size) {
    demands_.offset[joint] = {size, 0.0};
  });
}

const Joints& DemandMeter::ago(std::size_t steps) const {
  const std::size_t back = steps * periods_;
  return places_[newest_ >= back ? newest_ - back : newest_ + places_.size() - back];
}

void DemandMeter::add(double time, const Joints& path, const Joints& offset) {
  take_larger(offset, offset_, [&](std::size_t joint, double size) {
    demands_.offset[joint] = {size, time};
  });
  newest_ = newest_ + 1 == places_.size() ? 0 : newest_ + 1;
  places_[newest_] = path + offset;
  const Joints &x0 = ago(0), &x1 = ago(1), &x2 = ago(2), &x3 = ago(3);
  const std::array<Joints, AxisDemands::kOrders> differences = {x0 - x1, x0 - 2.0 * x1 + x2,
                                                                x0 - 3.0 * (x1 - x2) - x3};
  double per_step = 1.0;
  for (std::size_t order = 0; order < AxisDemands::kOrders; ++order) {
    per_step /= step_;
    take_larger(differences[order], largest_[order], [&](std::size_t joint, double size) {
      const double middle = time - 0.5 * static_cast<double>(order + 1) * step_;
      demands_.motion[order][joint] = {size * per_step, middle};
    });
  }
}

LoopDisplacement::LoopDisplacement(const Joints& Kv, double period) {
  for (int j = 0; j < kJoints; ++j) {
    if (!(Kv[j] > 0.0)) continue;
    share_[j] = -std::expm1(-Kv[j] * period);
    per_Kv_[j] = 1.0 / Kv[j];
  }
}

std::size_t periods_of_readings(const Joints& Kv, double period) {
  // Four readings in 1/Kv follow the position loop; more would repeat what its lag lets pass.
  constexpr double kPerTimeConstant = 4.0;
  const double fastest = Kv.maxCoeff();
  if (!(fastest > 0.0)) return 1;
  return static_cast<std::size_t>(
      std::max(1.0, std::round(1.0 / (kPerTimeConstant * fastest * period))));
}

}  // namespace servomill::sim::engine
