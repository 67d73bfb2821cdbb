#include "strategies/path_offset.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace servomill::strategies {
namespace {

constexpr double kSame = 1e-12;  // m: rounding of arc lengths

class PathOffsetPart final : public SetpointPart {
 public:
  explicit PathOffsetPart(std::shared_ptr<const PathOffset> offset)
      : offset_(std::move(offset)), place_(*offset_->times) {}

  SetpointEntry entry() const override { return {.entry = EntryPoint::feed_forward}; }
  Joints offset(const Joints&) const override { return offset_->offset.front(); }
  Joints advance(const Reading& now) override { return offset_->at(place_.advance(now.t, now.s)); }

 private:
  std::shared_ptr<const PathOffset> offset_;
  PathPlace place_;
};

// Rows during which the path stands.
struct Standstill {
  std::ptrdiff_t first, last;
};

std::vector<Standstill> standstills(const PathTimes& times, std::size_t rows) {
  std::vector<Standstill> out;
  const auto s = [&](std::size_t row) { return times.s[row * times.every]; };
  for (std::size_t first = 0; first < rows;) {
    std::size_t last = first;
    while (last + 1 < rows && s(last + 1) <= s(first) + kSame) ++last;
    if (last > first) {
      out.push_back({static_cast<std::ptrdiff_t>(first), static_cast<std::ptrdiff_t>(last)});
    }
    first = last + 1;
  }
  return out;
}

}  // namespace

// The first instant at s or after it.
std::size_t PathPlace::arrival(double s) const {
  const auto& all = times_.s;
  std::size_t n = static_cast<std::size_t>(now_);
  while (n + 1 < all.size() && all[n] < s - kSame) ++n;
  return n;
}

// The last instant at s.
std::size_t PathPlace::departure(double s) const {
  const auto& all = times_.s;
  std::size_t n = static_cast<std::size_t>(now_);
  while (n + 1 < all.size() && all[n + 1] <= s + kSame) ++n;
  return n;
}

// Share of the interval behind instant n at which the path is at s. @pre it rises from below s to
// above
double PathPlace::share_of(std::size_t n, double s) const {
  constexpr int kHalvings = 40;
  const auto& all = times_.s;
  const double a = all[n], d = all[n + 1] - a;
  const double slope_a = std::min(3.0 * d, 0.5 * (all[n + 1] - all[n > 0 ? n - 1 : 0]));
  const double slope_b = std::min(3.0 * d, 0.5 * (all[std::min(n + 2, all.size() - 1)] - a));
  double low = 0.0, high = 1.0;
  for (int k = 0; k < kHalvings; ++k) {
    const double f = 0.5 * (low + high);
    const double here =
        f *
        (slope_a + f * ((3.0 * d - 2.0 * slope_a - slope_b) + f * (slope_a + slope_b - 2.0 * d)));
    (a + here < s ? low : high) = f;
  }
  return high;
}

double PathPlace::advance(double t, double s) {
  const auto& all = times_.s;
  if (!s_) {
    now_ = 0.0;
  } else if (s > *s_ && all[static_cast<std::size_t>(now_)] < s - kSame) {
    const std::size_t n = arrival(s);
    const bool between = n > 0 && all[n] > s + kSame && all[n - 1] < s;
    const auto whole = static_cast<double>(n);
    now_ = std::max(now_, between ? whole - 1.0 + share_of(n - 1, s) : whole);
  } else {
    const double last = std::max(now_, static_cast<double>(departure(s)));
    now_ = std::min(now_ + (t - t_) / times_.h, last);
  }
  s_ = s;
  t_ = t;
  return now_;
}

Joints PathOffset::at(double instant) const {
  const double row = instant / static_cast<double>(times->every);
  const auto last = static_cast<std::ptrdiff_t>(offset.size()) - 1;
  const double x = std::clamp(row, 0.0, static_cast<double>(last));
  const auto n = static_cast<std::ptrdiff_t>(x);
  const double f = x - static_cast<double>(n), g = 1.0 - f;
  const auto control = [&](std::ptrdiff_t k) -> const Joints& {
    return offset[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, last))];
  };
  return (g * g * g * control(n - 1) + (3.0 * f * f * f - 6.0 * f * f + 4.0) * control(n) +
          (3.0 * g * g * g - 6.0 * g * g + 4.0) * control(n + 1) + f * f * f * control(n + 2)) /
         6.0;
}

Joints PathOffset::at_place(double s) const {
  const auto& all = times->s;
  const auto found = std::lower_bound(all.begin(), all.end(), s - kSame) - all.begin();
  const auto n = std::min(static_cast<std::size_t>(found), all.size() - 1);
  if (n == 0 || all[n] <= s + kSame) return at(static_cast<double>(n));
  const double share = (s - all[n - 1]) / (all[n] - all[n - 1]);
  return at(static_cast<double>(n) - 1.0 + share);
}

void rest_at_standstills(const PathTimes& times, std::vector<Joints>& offset) {
  constexpr double kWithin = 0.03;  // s
  const auto within = static_cast<std::ptrdiff_t>(kWithin / times.row_period());
  const std::vector<Standstill> all = standstills(times, offset.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    const auto [first, last] = all[k];
    Joints sum = Joints::Zero();
    for (std::ptrdiff_t n = first; n <= last; ++n) sum += offset[static_cast<std::size_t>(n)];
    const Joints mean = sum / static_cast<double>(last - first + 1);
    // two standstills share the rows between them
    const std::ptrdiff_t before = k == 0 ? first : (first - all[k - 1].last) / 2;
    const std::ptrdiff_t behind = k + 1 == all.size()
                                      ? static_cast<std::ptrdiff_t>(offset.size()) - 1 - last
                                      : (all[k + 1].first - last - 1) / 2;
    const std::ptrdiff_t reach_before = std::min(within, before), reach = std::min(within, behind);
    for (std::ptrdiff_t n = first - reach_before; n <= last + reach; ++n) {
      const bool is_before = n < first;
      const auto away =
          static_cast<double>(is_before ? first - n : std::max<std::ptrdiff_t>(0, n - last));
      const double x = away / static_cast<double>((is_before ? reach_before : reach) + 1);
      Joints& one = offset[static_cast<std::size_t>(n)];
      one = mean + smooth_step(x) * (one - mean);
    }
  }
}

std::unique_ptr<SetpointPart> path_offset_part(std::shared_ptr<const PathOffset> offset) {
  return std::make_unique<PathOffsetPart>(std::move(offset));
}

}  // namespace servomill::strategies
