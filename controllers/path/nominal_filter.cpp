#include "controllers/path/nominal_filter.h"

#include <cassert>
#include <cstddef>

namespace servomill::controllers {

NominalFilter::NominalFilter(FilterShape shape, int length, const Joints& start) {
  assert(length >= 1 && (shape == FilterShape::mean || length % 2 == 0));
  const int stages = shape == FilterShape::mean ? 1 : 2;
  const auto n = static_cast<std::size_t>(length / stages);
  const Mean mean{std::vector<Joints>(n, start), 0, start * static_cast<double>(n)};
  stages_.assign(static_cast<std::size_t>(stages), mean);
}

Joints NominalFilter::step(Mean& mean, const Joints& x) {
  mean.sum += x - mean.last[mean.oldest];
  mean.last[mean.oldest] = x;
  if (++mean.oldest == mean.last.size()) {
    // add anew once a round, so that rounding does not pile up
    mean.oldest = 0;
    mean.sum.setZero();
    for (const Joints& value : mean.last) mean.sum += value;
  }
  return mean.sum / static_cast<double>(mean.last.size());
}

Joints NominalFilter::operator()(const Joints& Q_ref) {
  Joints Q = Q_ref;
  for (Mean& stage : stages_) Q = step(stage, Q);
  return Q;
}

double NominalFilter::delay() const {
  double cycles = 0.0;
  for (const Mean& stage : stages_) cycles += 0.5 * (static_cast<double>(stage.last.size()) - 1.0);
  return cycles;
}

}  // namespace servomill::controllers
