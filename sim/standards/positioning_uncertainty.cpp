#include "sim/standards/positioning_uncertainty.h"

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "plant/vocabulary/progress.h"
#include "sim/config/document.h"
#include "sim/config/reader.h"

namespace servomill::sim::standards {
namespace {

using Sources = std::array<bool, kSources>;

bool has(const Sources& sources, Source one) { return sources[static_cast<std::size_t>(one)]; }

// Draws the errors of all readings of one trial after another.
class ErrorTrials {
 public:
  ErrorTrials(const PositioningTest& test, const PositioningContributions& c,
              const Sources& sources, std::uint64_t seed)
      : test_(test), c_(c), sources_(sources), engine_(seed), target_(test.targets.size()) {
    length_ = test.targets - test.targets[0];
  }

  PositioningValues next() {
    draw(-1.0);
    return positioning_parameters(up_, down_);
  }

  // Deviations with the errors of one trial, times a sign.
  void draw(double sign) {
    draw_common();
    up_ = test_.up;
    down_ = test_.down;
    add(sign, up_, test_.time_up);
    add(sign, down_, test_.time_down);
  }
  const Eigen::ArrayXXd& up() const { return up_; }
  const Eigen::ArrayXXd& down() const { return down_; }

 private:
  double normal(const std::optional<double>& standard) {
    return standard ? *standard * normal_(engine_) : 0.0;
  }
  // within +- half
  double rectangular(double half) { return half * uniform_(engine_); }

  // Draws the errors that all runs and directions share.
  void draw_common() {
    double strain = 0.0;
    target_.setZero();
    if (has(sources_, Source::calibration)) {
      strain += normal(c_.scale);
      for (double& one : target_) one = normal(c_.target);
    }
    if (has(sources_, Source::misalignment)) {
      const double limit = c_.misalignment.value_or(0.0);
      const double pitch = rectangular(limit), yaw = rectangular(limit);
      strain -= 0.5 * (pitch * pitch + yaw * yaw);
    }
    if (has(sources_, Source::temperature)) {
      strain += normal(c_.u_expansion) * c_.temperature.value_or(0.0) +
                c_.expansion.value_or(0.0) * normal(c_.u_temperature);
    }
    target_ += strain * length_;
    if (has(sources_, Source::set_up)) target_ += normal(c_.set_up);
    drift_ = has(sources_, Source::drift) ? rectangular(c_.drift.value_or(0.0)) : 0.0;
  }

  void add(double sign, Eigen::ArrayXXd& deviations, const Eigen::ArrayXXd& times) {
    const bool noise = has(sources_, Source::variation) || has(sources_, Source::resolution);
    const double variation =
        has(sources_, Source::variation) ? 0.5 * c_.variation.value_or(0.0) : 0.0;
    const double resolution =
        has(sources_, Source::resolution) ? 0.5 * c_.resolution.value_or(0.0) : 0.0;
    for (Eigen::Index j = 0; j < deviations.cols(); ++j) {
      for (Eigen::Index i = 0; i < deviations.rows(); ++i) {
        double error = target_[i] + drift_ * (times(i, j) - 0.5);
        if (noise) error += rectangular(variation) + rectangular(resolution);
        deviations(i, j) += sign * error;
      }
    }
  }

  const PositioningTest& test_;
  const PositioningContributions& c_;
  Sources sources_;
  boost::random::mt19937_64 engine_;
  boost::random::normal_distribution<double> normal_;
  boost::random::uniform_real_distribution<double> uniform_{-1.0, 1.0};
  Eigen::ArrayXd length_, target_;
  Eigen::ArrayXXd up_, down_;
  double drift_ = 0.0;
};

struct Moments {
  PositioningValues U{}, shift{};
};

Moments simulate(const PositioningTest& test, const PositioningContributions& contributions,
                 const Sources& sources, std::uint64_t seed, std::size_t trials) {
  const PositioningValues value = positioning_parameters(test.up, test.down);
  ErrorTrials errors(test, contributions, sources, seed);
  PositioningValues sum{}, squares{};
  Stage stage("draws", static_cast<double>(trials));
  for (std::size_t n = 0; n < trials; ++n) {
    stage.advance();
    const PositioningValues trial = errors.next();
    for (std::size_t k = 0; k < kPositioningParameters; ++k) {
      const double off = trial[k] - value[k];
      sum[k] += off;
      squares[k] += off * off;
    }
  }
  Moments out;
  const auto count = static_cast<double>(trials);
  for (std::size_t k = 0; k < kPositioningParameters; ++k) {
    out.U[k] = 2.0 * std::sqrt(squares[k] / count);
    out.shift[k] = sum[k] / count;
  }
  return out;
}

bool same_in_both_directions_and_runs(Positioning which) {
  using enum Positioning;
  return which == B || which == B_mean || which == R || which == R_up || which == R_down;
}

}  // namespace

std::vector<std::string_view> missing_for(const PositioningContributions& c, bool angular,
                                          Positioning which) {
  std::vector<std::string_view> out;
  if (!c.resolution) out.emplace_back("resolution");
  if (!c.variation) out.emplace_back("variation");
  if (same_in_both_directions_and_runs(which)) return out;
  if (!c.target && (angular || !c.scale))
    out.emplace_back(angular ? "target_uncertainty" : "scale_uncertainty or target_uncertainty");
  if (angular) return out;
  if (!c.misalignment) out.emplace_back("misalignment");
  if (!c.expansion) out.emplace_back("coefficient");
  if (!c.u_expansion) out.emplace_back("coefficient_uncertainty");
  if (!c.temperature) out.emplace_back("temperature");
  if (!c.u_temperature) out.emplace_back("temperature_uncertainty");
  return out;
}

PositioningUncertainty positioning_uncertainty(const PositioningTest& test,
                                               const PositioningContributions& contributions,
                                               const MonteCarloSettings& settings) {
  PositioningUncertainty out;
  Sources all;
  all.fill(true);
  const Moments together = simulate(test, contributions, all, settings.seed, settings.trials);
  out.U = together.U;
  out.shift = together.shift;
  for (std::size_t source = 0; source < kSources; ++source) {
    Sources one{};
    one[source] = true;
    out.alone[source] =
        simulate(test, contributions, one, settings.seed + 1 + source, settings.trials_alone).U;
  }
  for (std::size_t k = 0; k < kPositioningParameters; ++k) {
    if (missing_for(contributions, test.angular, static_cast<Positioning>(k)).empty()) continue;
    out.U[k] = std::numeric_limits<double>::quiet_NaN();
  }
  return out;
}

namespace {

PositioningTest with_errors(PositioningTest test, const PositioningContributions& device,
                            const Sources& sources, std::uint64_t seed) {
  ErrorTrials errors(test, device, sources, seed);
  errors.draw(1.0);
  Eigen::ArrayXXd up = errors.up(), down = errors.down();  // it refers to the test
  test.up = std::move(up);
  test.down = std::move(down);
  return test;
}

}  // namespace

PositioningTest read_by_device(PositioningTest test, const PositioningContributions& device,
                               std::uint64_t seed) {
  Sources all;
  all.fill(true);
  return with_errors(std::move(test), device, all, seed);
}

std::vector<PositioningTest> read_by_device(std::vector<PositioningTest> tests,
                                            const PositioningContributions& device,
                                            std::uint64_t seed, const std::vector<Source>& common) {
  Sources shared{}, own;
  own.fill(true);
  for (const Source one : common) {
    shared[static_cast<std::size_t>(one)] = true;
    own[static_cast<std::size_t>(one)] = false;
  }
  boost::random::mt19937_64 seeds(seed);
  for (PositioningTest& test : tests) {
    test = with_errors(std::move(test), device, shared, seed);
    test = with_errors(std::move(test), device, own, seeds());
  }
  return tests;
}

PositioningContributions contributions_of(config::Reader& table, bool takes_angles) {
  using config::at_least;
  const auto read = [&](std::string_view key, config::Quantity quantity) -> std::optional<double> {
    if (!table.has(key)) return std::nullopt;
    return table.real(key, quantity, {at_least(0.0)});
  };
  const auto deviation = [&](std::string_view length, std::string_view angle) {
    return takes_angles && table.has(angle) ? read(angle, config::kAngle)
                                            : read(length, config::kLength);
  };
  PositioningContributions out;
  out.scale = read("scale_uncertainty_um_per_m", config::kNumber);
  out.target = deviation("target_uncertainty_um", "target_uncertainty_urad");
  out.resolution = deviation("resolution_um", "resolution_urad");
  out.misalignment = read("misalignment_mrad", config::kAngle);
  out.expansion = read("coefficient_per_K", config::kExpansion);
  out.u_expansion = read("coefficient_uncertainty_per_K", config::kExpansion);
  if (table.has("temperature_degC")) {
    constexpr double kReference = 20.0;  // degC, ISO 1
    constexpr double kColdest = -10.0, kHottest = 50.0;
    out.temperature = table.real("temperature_degC", config::kNumber,
                                 {at_least(kColdest), config::at_most(kHottest)}) -
                      kReference;
  }
  out.u_temperature = read("temperature_uncertainty_K", config::kTemperature);
  out.variation = deviation("variation_um", "variation_urad");
  out.drift = deviation("drift_um", "drift_urad");
  out.set_up = deviation("set_up_um", "set_up_urad");
  return out;
}

PositioningContributions read_contributions(const std::string& path) {
  const config::Document document = config::Document::from_file(path);
  config::Reader table(document);
  PositioningContributions out = contributions_of(table);
  table.finish();
  return out;
}

}  // namespace servomill::sim::standards
