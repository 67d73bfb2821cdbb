#include "sim/evaluation/statistic.h"

#include <algorithm>
#include <limits>

namespace servomill::sim::evaluation {

Statistic::Statistic(std::string_view name)
    : kind_(name == "mean"    ? Kind::mean
            : name == "rms"   ? Kind::rms
            : name == "range" ? Kind::range
                              : Kind::max) {}

void Statistic::add(double least, double greatest, double mean, double rms, double count) {
  count_ += count;
  has_none_ |= std::isnan(least) || std::isnan(greatest) || std::isnan(mean) || std::isnan(rms);
  sum_ += count * mean;
  squares_ += count * rms * rms;
  spread(least, greatest);
}

double Statistic::value() const {
  if (count_ == 0.0 || has_none_) return std::numeric_limits<double>::quiet_NaN();
  switch (kind_) {
    case Kind::mean:
      return sum_ / count_;
    case Kind::rms:
      return std::sqrt(squares_ / count_);
    case Kind::range:
      return greatest_ - least_;
    case Kind::max:
      break;
  }
  return std::max(std::abs(least_), std::abs(greatest_));
}

}  // namespace servomill::sim::evaluation
