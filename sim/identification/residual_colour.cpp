#include "sim/identification/residual_colour.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <unsupported/Eigen/FFT>

namespace servomill::sim::identification {
namespace {

using Spectrum = std::vector<std::complex<double>>;

std::size_t padded(std::size_t n) {
  std::size_t size = 1;
  while (size < n) size *= 2;
  return size;
}

std::vector<double> column(const Eigen::MatrixXd& X, Eigen::Index k, std::size_t size) {
  std::vector<double> out(size, 0.0);
  for (Eigen::Index n = 0; n < X.rows(); ++n) out[static_cast<std::size_t>(n)] = X(n, k);
  return out;
}

// Reflection by reflection (Levinson and Durbin): coefficients and innovation of every order.
struct Order {
  std::vector<double> a;
  double innovation;
};
std::vector<Order> all_orders(const std::vector<double>& c) {
  std::vector<Order> orders = {{{}, c.front()}};
  for (std::size_t p = 1; p < c.size(); ++p) {
    const Order& last = orders.back();
    // Levinson-Durbin recursion: each order from the one before, O(p) a step.
    double sum = c[p];
    for (std::size_t k = 0; k < last.a.size(); ++k) sum += last.a[k] * c[p - 1 - k];
    const double reflection = -sum / last.innovation;
    if (!(std::abs(reflection) < 1.0)) break;  // no process has these autocovariances
    Order next{last.a, last.innovation * (1.0 - reflection * reflection)};
    for (std::size_t k = 0; k < last.a.size(); ++k) {
      next.a[k] += reflection * last.a[last.a.size() - 1 - k];
    }
    next.a.push_back(reflection);
    orders.push_back(std::move(next));
  }
  return orders;
}

// Beyond the lags that were given the process continues them.
std::vector<double> continued(const std::vector<double>& given, const std::vector<double>& a,
                              std::size_t most) {
  // Decayed to 1e-6 of the variance, the rest no longer changes the sums over the lags. The largest
  // of a window of 200 counts, since an oscillating autocovariance passes through 0.
  constexpr double kDecayed = 1e-6;
  std::vector<double> c(given.begin(), given.begin() + static_cast<std::ptrdiff_t>(a.size() + 1));
  double greatest_lately = c.front();
  for (std::size_t lag = c.size(); lag < most; ++lag) {
    double next = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) next -= a[k] * c[lag - 1 - k];
    c.push_back(next);
    constexpr std::size_t kWindow = 200;
    if (lag % kWindow == 0) {
      greatest_lately = 0.0;
      for (std::size_t k = c.size() - std::min(kWindow, c.size()); k < c.size(); ++k) {
        greatest_lately = std::max(greatest_lately, std::abs(c[k]));
      }
      if (greatest_lately < kDecayed * c.front()) break;
    }
  }
  return c;
}

}  // namespace

double AutoregressiveNoise::effective_samples(std::size_t n) const {
  // Samples that would give the variance as exactly, not the mean: its sampling error goes with the
  // squares of the autocovariances (Bartlett).
  double sum = 0.0;
  for (std::size_t lag = 0; lag < autocovariance.size(); ++lag) {
    sum += (lag == 0 ? 1.0 : 2.0) * autocovariance[lag] * autocovariance[lag];
  }
  const double c0 = autocovariance.front();
  return sum > 0.0 ? static_cast<double>(n) * c0 * c0 / sum : static_cast<double>(n);
}

std::size_t most_lags(std::size_t samples) { return std::min<std::size_t>(200, samples / 20 + 1); }

std::vector<double> autocovariance(const Eigen::VectorXd& residual, std::size_t lags) {
  std::vector<double> out;
  const Eigen::Index n = residual.size();
  for (Eigen::Index lag = 0; lag <= static_cast<Eigen::Index>(lags); ++lag) {
    // Divided by n at every lag, not by n - lag: only so is the sequence positive definite, which
    // the recursion needs.
    out.push_back(residual.head(n - lag).dot(residual.tail(n - lag)) / static_cast<double>(n));
  }
  return out;
}

AutoregressiveNoise autoregressive(const std::vector<double>& c, std::size_t samples) {
  const std::vector<Order> orders = all_orders(c);
  const double n = static_cast<double>(samples);
  double best = std::numeric_limits<double>::infinity();
  std::size_t chosen = 0;
  for (std::size_t p = 0; p < orders.size(); ++p) {
    const double k = static_cast<double>(p) + 1.0;
    if (n - k - 1.0 <= 0.0 || !(orders[p].innovation > 0.0)) break;
    // Akaike's criterion with the correction for few samples (Hurvich and Tsai 1989): k = p + 1
    // counts the innovation.
    const double criterion = n * std::log(orders[p].innovation) + 2.0 * k * n / (n - k - 1.0);
    if (criterion < best) {
      best = criterion;
      chosen = p;
    }
  }
  AutoregressiveNoise noise;
  noise.a = orders[chosen].a;
  noise.innovation = orders[chosen].innovation;
  noise.autocovariance = continued(c, noise.a, samples);
  return noise;
}

Eigen::MatrixXd coloured(const AutoregressiveNoise& noise, const Eigen::MatrixXd& X) {
  const auto n = static_cast<std::size_t>(X.rows());
  // A Toeplitz matrix times vectors by FFT: embedded in a circulant one of twice the length, so
  // that nothing wraps around. O(n log n) in place of O(n^2).
  const std::size_t size = padded(2 * n), lags = std::min(noise.autocovariance.size(), n);
  std::vector<double> kernel(size, 0.0);
  for (std::size_t lag = 0; lag < lags; ++lag) {
    kernel[lag] = noise.autocovariance[lag];
    if (lag > 0) kernel[size - lag] = noise.autocovariance[lag];
  }
  Eigen::FFT<double> fft;
  Spectrum K, Y;
  fft.fwd(K, kernel);
  Eigen::MatrixXd out(X.rows(), X.cols());
  for (Eigen::Index k = 0; k < X.cols(); ++k) {
    fft.fwd(Y, column(X, k, size));
    for (std::size_t f = 0; f < size; ++f) Y[f] *= K[f];
    std::vector<double> y;
    fft.inv(y, Y);
    out.col(k) = Eigen::VectorXd::Map(y.data(), X.rows());
  }
  return out;
}

std::vector<double> cross_sums(const Eigen::MatrixXd& U, const Eigen::MatrixXd& V,
                               std::size_t lags) {
  const std::size_t size = padded(2 * static_cast<std::size_t>(U.rows()));
  Eigen::FFT<double> fft;
  Spectrum sum(size), A, B;
  for (Eigen::Index k = 0; k < U.cols(); ++k) {
    fft.fwd(A, column(U, k, size));
    fft.fwd(B, column(V, k, size));
    // Correlation theorem; spectra are summed over the columns, so that one inverse transform
    // serves all.
    for (std::size_t f = 0; f < size; ++f) sum[f] += std::conj(A[f]) * B[f];
  }
  std::vector<double> both;
  fft.inv(both, sum);
  std::vector<double> out;
  for (std::size_t lag = 0; lag <= lags; ++lag) {
    // Positive and negative lags, as the symmetric Sigma meets both.
    out.push_back(both[lag] + both[lag == 0 ? 0 : size - lag]);
  }
  return out;
}

}  // namespace servomill::sim::identification
