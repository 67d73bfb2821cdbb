#include "plant/geometry/table_lookup.h"

#include <algorithm>
#include <cstddef>

namespace servomill::plant {

TableLookup::TableLookup(const LinearTable& table)
    : first_(table.s.front()), last_(table.s.back()), last_error_(table.error.back()) {
  const std::size_t points = table.s.size();
  for (std::size_t i = 0; i + 1 < points; ++i) {
    const double slope = (table.error[i + 1] - table.error[i]) / (table.s[i + 1] - table.s[i]);
    intervals_.push_back({table.s[i], table.error[i], slope});
  }
  if (points == 1) intervals_.push_back({first_, last_error_, 0.0});
  const std::size_t buckets = 2 * points;
  const double width = (last_ - first_) / static_cast<double>(buckets);
  buckets_per_s_ = width > 0.0 ? 1.0 / width : 0.0;
  for (std::size_t b = 0; b <= buckets; ++b) {
    // one bucket early, so that rounding of the bucket's number does no harm
    const double begin = first_ + width * (static_cast<double>(b) - 1.0);
    const auto above = std::upper_bound(table.s.begin(), table.s.end() - 1, begin);
    const auto interval = std::max<std::ptrdiff_t>(above - table.s.begin() - 1, 0);
    interval_of_bucket_.push_back(static_cast<std::uint32_t>(interval));
  }
}

double TableLookup::value(double at) const {
  if (!(at >= first_)) return intervals_.front().error;
  if (at >= last_) return last_error_;
  const auto bucket = static_cast<std::size_t>((at - first_) * buckets_per_s_);
  std::size_t i = interval_of_bucket_[std::min(bucket, interval_of_bucket_.size() - 1)];
  while (i + 1 < intervals_.size() && intervals_[i + 1].s <= at) ++i;
  return intervals_[i].error + intervals_[i].slope * (at - intervals_[i].s);
}

}  // namespace servomill::plant
