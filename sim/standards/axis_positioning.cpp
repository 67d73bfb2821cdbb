#include "sim/standards/axis_positioning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/numerics/dense_solver.h"
#include "sim/standards/test_cycle.h"

namespace servomill::sim::standards {
namespace {

constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();
constexpr double kLongAxis = 2.0;  // m; beyond it one run in each direction is enough
constexpr int kRuns = 5;
constexpr double kPi = std::numbers::pi;

Approach approach_of(const Eigen::ArrayXXd& deviations, Eigen::Index target) {
  const auto row = deviations.row(target);
  Approach out;
  out.mean = row.mean();
  const auto n = static_cast<double>(row.size());
  out.s = n < 2.0 ? kNotGiven : std::sqrt((row - out.mean).square().sum() / (n - 1.0));
  return out;
}

// Range of the values that a band about each mean covers; NaN where one is not known.
struct Band {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double middle, double half_width) {
    if (std::isnan(middle) || std::isnan(half_width)) {
      low = kNotGiven;
    } else if (!std::isnan(low)) {
      low = std::min(low, middle - half_width);
      high = std::max(high, middle + half_width);
    }
  }
  double width() const { return high - low; }
  void add(const Band& other) {
    low = std::isnan(low) || std::isnan(other.low) ? kNotGiven : std::min(low, other.low);
    high = std::max(high, other.high);
  }
};

// The larger of two; NaN as soon as one is.
double larger(double a, double b) {
  if (std::isnan(a) || std::isnan(b)) return kNotGiven;
  return std::max(a, b);
}

double bidirectional_repeatability(const Approach& up, const Approach& down) {
  const double B = std::abs(up.mean - down.mean);
  return larger(2.0 * up.s + 2.0 * down.s + B, larger(up.R(), down.R()));
}

// Everything that the parameters take from the targets, gathered one target at a time.
class Gathering {
 public:
  void add(const std::optional<Approach>& up, const std::optional<Approach>& down) {
    ++targets_;
    if (up) add_one(*up, 0);
    if (down) add_one(*down, 1);
    if (!up || !down) return;
    const double B = up->mean - down->mean;
    B_ = std::max(B_, std::abs(B));
    B_sum_ += B;
    R_ = larger(R_, bidirectional_repeatability(*up, *down));
    mean_.add(0.5 * (up->mean + down->mean), 0.0);
  }

  PositioningValues values() const {
    PositioningValues out;
    out.fill(kNotGiven);
    constexpr std::array kR = {Positioning::R_up, Positioning::R_down};
    constexpr std::array kE = {Positioning::E_up, Positioning::E_down};
    constexpr std::array kA = {Positioning::A_up, Positioning::A_down};
    Band both_means, both_bands;
    for (std::size_t k = 0; k < 2; ++k) {
      if (!measured_[k]) continue;
      at(out, kR[k]) = R_one_[k];
      at(out, kE[k]) = means_[k].width();
      at(out, kA[k]) = bands_[k].width();
      both_means.add(means_[k]);
      both_bands.add(bands_[k]);
    }
    if (!measured_[0] || !measured_[1]) return out;
    at(out, Positioning::B) = B_;
    at(out, Positioning::B_mean) = B_sum_ / targets_;
    at(out, Positioning::R) = R_;
    at(out, Positioning::E) = both_means.width();
    at(out, Positioning::M) = mean_.width();
    at(out, Positioning::A) = both_bands.width();
    return out;
  }

 private:
  void add_one(const Approach& one, std::size_t direction) {
    measured_[direction] = true;
    means_[direction].add(one.mean, 0.0);
    bands_[direction].add(one.mean, 2.0 * one.s);
    R_one_[direction] = larger(R_one_[direction], one.R());
  }

  double targets_ = 0.0;
  std::array<bool, 2> measured_{};
  std::array<Band, 2> means_, bands_;
  std::array<double, 2> R_one_{};
  double B_ = 0.0, B_sum_ = 0.0, R_ = 0.0;
  Band mean_;
};

std::optional<Approach> approach_or_none(const Eigen::ArrayXXd& deviations, Eigen::Index target) {
  if (deviations.cols() == 0) return std::nullopt;
  return approach_of(deviations, target);
}

// Targets that a travel needs: ISO 230-2:2014, 5.3.2 and table 1.
Eigen::Index targets_needed(const PositioningTest& test) {
  constexpr double kSlack = 1e-9;
  if (test.angular) return usual_rotary_target_count(test.travel());
  if (test.travel() <= kLongAxis) {
    return std::max<Eigen::Index>(5, static_cast<Eigen::Index>(std::ceil(5.0 * test.travel())));
  }
  constexpr double kInterval = 0.25;  // m, mean
  return static_cast<Eigen::Index>(std::ceil(test.travel() / kInterval - kSlack)) + 1;
}

}  // namespace

std::vector<PositioningTarget> evaluate_targets(const PositioningTest& test) {
  std::vector<PositioningTarget> out;
  for (Eigen::Index i = 0; i < test.targets.size(); ++i) {
    PositioningTarget one{test.targets[i],
                          approach_or_none(test.up, i),
                          approach_or_none(test.down, i),
                          kNotGiven,
                          kNotGiven,
                          kNotGiven};
    if (one.up && one.down) {
      one.mean = 0.5 * (one.up->mean + one.down->mean);
      one.B = one.up->mean - one.down->mean;
      one.R = bidirectional_repeatability(*one.up, *one.down);
    }
    out.push_back(one);
  }
  return out;
}

PositioningValues positioning_parameters(const std::vector<PositioningTarget>& targets) {
  Gathering gathering;
  for (const PositioningTarget& one : targets) gathering.add(one.up, one.down);
  return gathering.values();
}

PositioningValues positioning_parameters(const Eigen::ArrayXXd& up, const Eigen::ArrayXXd& down) {
  Gathering gathering;
  for (Eigen::Index i = 0; i < std::max(up.rows(), down.rows()); ++i) {
    gathering.add(approach_or_none(up, i), approach_or_none(down, i));
  }
  return gathering.values();
}

std::vector<std::string> departures(const PositioningTest& test) {
  std::vector<std::string> out;
  if (!test.bidirectional()) {
    out.push_back(fmt::format(
        "readings are {} only: bi-directional parameters (B, R, M, E, A) need both directions",
        test.up.cols() > 0 ? "upwards" : "downwards"));
  }
  const bool long_axis = !test.angular && test.travel() > kLongAxis;
  for (const auto& [deviations, name] :
       {std::pair(&test.up, "upwards"), std::pair(&test.down, "downwards")}) {
    const auto runs = deviations->cols();
    if (runs == 0) continue;
    if (runs == 1) {
      out.push_back(fmt::format("one run {}: s, R and A need at least two{}", name,
                                long_axis ? " (ISO 230-2 requires one beyond 2 m)" : ""));
    } else if (runs < kRuns && !long_axis) {
      out.push_back(fmt::format("{} runs {}; ISO 230-2 requires {}{}", runs, name, kRuns,
                                test.angular ? "" : " up to 2 m"));
    }
  }
  const auto needed = targets_needed(test);
  if (test.targets.size() < needed) {
    const std::string travel = test.angular ? fmt::format("{:.4g} deg", test.travel() / deg)
                                            : fmt::format("{:.4g} mm", test.travel() / mm);
    out.push_back(fmt::format("{} targets over {}; ISO 230-2 requires {}", test.targets.size(),
                              travel, needed));
  }
  return out;
}

std::optional<std::string> why_no_period(const PositioningTest& test, double period) {
  constexpr double kSlack = 1e-6;  // of a period
  constexpr double kPerPeriod = 10.0;
  const double unit = test.angular ? deg : mm;
  const char* const symbol = test.angular ? "deg" : "mm";
  if (test.travel() < (2.0 - kSlack) * period) {
    return fmt::format("targets cover {:.4g} {}, which is less than two periods of {:.4g} {}",
                       test.travel() / unit, symbol, period / unit, symbol);
  }
  const Eigen::Index count = test.targets.size();
  const double widest = (test.targets.tail(count - 1) - test.targets.head(count - 1)).maxCoeff();
  if (widest > (1.0 + kSlack) * period / kPerPeriod) {
    return fmt::format(
        "targets are up to {:.4g} {} apart; a period of {:.4g} {} needs ten targets per period: at "
        "most {:.4g} {}",
        widest / unit, symbol, period / unit, symbol, period / kPerPeriod / unit, symbol);
  }
  return std::nullopt;
}

PeriodicError periodic_error(const PositioningTest& test, const Eigen::ArrayXXd& deviations,
                             double period) {
  const Eigen::VectorXd mean = deviations.rowwise().mean();
  const Eigen::VectorXd x = test.targets;
  Eigen::MatrixXd line(x.size(), 2), wave(x.size(), 4);
  line << Eigen::VectorXd::Ones(x.size()), x;
  const Eigen::ArrayXd angle = 2.0 * kPi / period * x.array();
  wave << line, angle.sin().matrix(), angle.cos().matrix();
  const Eigen::VectorXd rest = mean - line * numerics::least_squares(line, mean);
  const Eigen::VectorXd harmonic = numerics::least_squares(wave, mean).tail(2);
  return {rest.maxCoeff() - rest.minCoeff(), harmonic.norm(), std::atan2(harmonic[1], harmonic[0])};
}

}  // namespace servomill::sim::standards
