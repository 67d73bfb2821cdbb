#include "sim/identification/bootstrap.h"

#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <cmath>
#include <limits>

#include "plant/vocabulary/progress.h"
#include "sim/identification/identifiable_part.h"

namespace servomill::sim::identification {
namespace {

// One record's residual, where it counts.
struct CountingResidual {
  std::vector<Eigen::Index> rows;  // of the stacked residual
  std::vector<double> centred;     // scaled to the noise before the fit
  std::size_t block = 1;
};

CountingResidual counting(const Eigen::VectorXd& residual, const std::vector<char>& mask,
                          Eigen::Index begin, const AutoregressiveNoise& noise) {
  CountingResidual out;
  double mean = 0.0, square = 0.0;
  for (std::size_t k = 0; k < mask.size(); ++k) {
    if (mask[k] == 0) continue;
    out.rows.push_back(begin + static_cast<Eigen::Index>(k));
    mean += residual[out.rows.back()];
    square += residual[out.rows.back()] * residual[out.rows.back()];
  }
  const auto n = static_cast<double>(out.rows.size());
  if (out.rows.empty()) return out;
  mean /= n;
  const double taken = std::sqrt(std::max(noise.autocovariance.front() * n / square, 1.0));
  for (const Eigen::Index row : out.rows) {
    out.centred.push_back(square > 0.0 ? taken * (residual[row] - mean) : 0.0);
  }
  out.block = block_length(noise.autocovariance, out.rows.size());
  return out;
}

using Generator = boost::random::mt19937_64;

// Blocks after one another until every row has its sample.
void shuffle(const CountingResidual& record, Generator& generator, Eigen::VectorXd& out) {
  const std::size_t n = record.rows.size();
  if (n == 0) return;
  boost::random::uniform_int_distribution<std::size_t> first(0, n - 1);
  for (std::size_t k = 0; k < n;) {
    const std::size_t begin = first(generator);
    for (std::size_t j = 0; j < record.block && k < n; ++j, ++k) {
      out[record.rows[k]] = record.centred[(begin + j) % n];
    }
  }
}

}  // namespace

double Bootstrap::standard(std::size_t parameter) const {
  if (values.rows() < 2) return std::numeric_limits<double>::quiet_NaN();
  const Eigen::VectorXd x = values.col(static_cast<Eigen::Index>(parameter));
  return std::sqrt((x.array() - x.mean()).square().sum() / static_cast<double>(x.size() - 1));
}

std::pair<double, double> Bootstrap::interval_95(std::size_t parameter) const {
  const Eigen::VectorXd column = values.col(static_cast<Eigen::Index>(parameter));
  std::vector<double> x(column.begin(), column.end());
  constexpr std::size_t kFewest = 40;  // one of them is 2.5 %
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  if (x.size() < kFewest) return {unknown, unknown};
  std::sort(x.begin(), x.end());
  const auto quantile = [&](double share) {
    const double at = share * static_cast<double>(x.size() - 1);
    const auto k = std::min(static_cast<std::size_t>(at), x.size() - 2);
    return x[k] + (at - static_cast<double>(k)) * (x[k + 1] - x[k]);
  };
  return {quantile(0.025), quantile(0.975)};
}

std::size_t block_length(const std::vector<double>& autocovariance, std::size_t samples) {
  double G = 0.0, g = std::abs(autocovariance.front());
  for (std::size_t lag = 1; lag < autocovariance.size(); ++lag) {
    G += 2.0 * static_cast<double>(lag) * std::abs(autocovariance[lag]);
    g += 2.0 * std::abs(autocovariance[lag]);
  }
  const double ratio = g > 0.0 ? G / g : 0.0;
  const double length = std::cbrt(1.5 * ratio * ratio * static_cast<double>(samples));
  const double most = std::max(static_cast<double>(samples) / 4.0, 1.0);
  return static_cast<std::size_t>(std::clamp(std::ceil(length), 1.0, most));
}

Bootstrap bootstrap(const Fit& fit, const Uncertainty& uncertainty, const Mask& mask,
                    const BootstrapSettings& settings) {
  const IdentifiablePart part = identifiable_part(fit.jacobian);
  const auto size = static_cast<Eigen::Index>(fit.values.size());
  Bootstrap out;
  std::vector<CountingResidual> records;
  Eigen::Index begin = 0;
  for (std::size_t r = 0; r < mask.size(); ++r) {
    records.push_back(counting(fit.residual, mask[r], begin, uncertainty.noise[r]));
    out.block.push_back(records.back().block);
    begin += static_cast<Eigen::Index>(mask[r].size());
  }
  Generator generator(settings.seed);
  const Eigen::VectorXd found = Eigen::VectorXd::Map(fit.values.data(), size);
  out.values.resize(static_cast<Eigen::Index>(settings.replicas), size);
  Stage stage("replicas", static_cast<double>(settings.replicas));
  for (Eigen::Index n = 0; n < out.values.rows(); ++n) {
    Eigen::VectorXd shuffled = Eigen::VectorXd::Zero(fit.residual.size());
    for (const CountingResidual& one : records) shuffle(one, generator, shuffled);
    out.values.row(n) = found - least_squares(part, shuffled, size);
    stage.advance();
  }
  return out;
}

}  // namespace servomill::sim::identification
