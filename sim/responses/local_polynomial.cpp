#include "sim/responses/local_polynomial.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/FFT>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/progress.h"
#include "sim/numerics/complex_solver.h"

namespace servomill::sim::responses {
namespace {

using Spectrum = std::vector<Complex>;

Spectrum transform(std::span<const double> signal) {
  double mean = 0.0;
  for (const double sample : signal) mean += sample / static_cast<double>(signal.size());
  std::vector<double> rest(signal.begin(), signal.end());
  for (double& sample : rest) sample -= mean;
  Eigen::FFT<double> fft;
  Spectrum out;
  fft.fwd(out, rest);
  out.resize(signal.size() / 2);
  return out;
}

// Root mean square of the lines around each.
std::vector<double> level_around(const Spectrum& spectrum, std::size_t half_width) {
  std::vector<double> sums(spectrum.size() + 1, 0.0), out(spectrum.size());
  for (std::size_t k = 0; k < spectrum.size(); ++k) sums[k + 1] = sums[k] + std::norm(spectrum[k]);
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    const std::size_t begin = k > half_width ? k - half_width : 0;
    const std::size_t end = std::min(k + half_width + 1, spectrum.size());
    out[k] = std::sqrt((sums[end] - sums[begin]) / static_cast<double>(end - begin));
  }
  return out;
}

// Share of the lines in excited neighbourhoods that are excited themselves.
double share_excited(const Spectrum& U, const std::vector<double>& level, double least) {
  std::size_t neighbourhoods = 0, lines = 0;
  for (std::size_t k = 1; k < U.size(); ++k) {
    if (level[k] < least) continue;
    ++neighbourhoods;
    lines += std::abs(U[k]) > 0.05 * level[k] ? 1 : 0;
  }
  return neighbourhoods == 0 ? 1.0
                             : static_cast<double>(lines) / static_cast<double>(neighbourhoods);
}

struct LocalFit {
  Complex response;
  double variance = 0.0;  // of the response
  double share = 0.0;     // of one line's weight in it: 1 over the lines that it takes
};

LocalFit fit_around(const Spectrum& U, const Spectrum& Y, std::size_t k,
                    const LocalPolynomialSettings& s) {
  const auto rows = static_cast<Eigen::Index>(2 * s.half_width + 1);
  // at the ends the window is moved inwards; line 0 is the mean
  const std::size_t first = std::clamp(k > s.half_width ? k - s.half_width : 0, std::size_t{1},
                                       U.size() - static_cast<std::size_t>(rows));
  const Eigen::Index terms = s.order + 1;
  Eigen::MatrixXcd K(rows, 2 * terms);
  Eigen::VectorXcd y(rows);
  double level = 0.0;
  for (Eigen::Index n = 0; n < rows; ++n) {
    const std::size_t at = first + static_cast<std::size_t>(n);
    const double r =
        (static_cast<double>(at) - static_cast<double>(k)) / static_cast<double>(s.half_width);
    double power = 1.0;
    for (Eigen::Index t = 0; t < terms; ++t) {
      K(n, t) = power * U[at];
      K(n, terms + t) = power;
      power *= r;
    }
    y[n] = Y[at];
    level += std::norm(U[at]) / static_cast<double>(rows);
  }
  // columns of like size: speed and torque differ by many powers of ten
  const double unit = std::sqrt(level);
  K.leftCols(terms) /= unit;
  const numerics::ComplexLeastSquares fit = numerics::complex_least_squares(K, y);
  const double left = (y - K * fit.x).squaredNorm();
  const double freedom = static_cast<double>(rows - 2 * terms);
  const double weight = fit.weights.squaredNorm();
  return {fit.x[0] / unit, left / freedom * weight / level, weight};
}

}  // namespace

MeasuredResponse local_polynomial(std::span<const double> input, std::span<const double> output,
                                  const LocalPolynomialSettings& s, const std::string& name) {
  const std::size_t window = 2 * s.half_width + 1;
  if (input.size() < 4 * window) {
    throw InputError(
        {name}, fmt::format("contains {} samples; the local polynomial method requires at least {}",
                            input.size(), 4 * window));
  }
  const Spectrum U = transform(input), Y = transform(output);
  const std::vector<double> level = level_around(U, s.half_width);
  const double greatest = *std::max_element(level.begin(), level.end());
  double size = 0.0;
  for (const double sample : input) size = std::max(size, std::abs(sample));
  constexpr double kRounding = 1e-12;
  if (!(greatest > kRounding * size * static_cast<double>(input.size()))) {
    throw InputError({name}, "has an input without excitation");
  }
  constexpr double kEveryOther = 0.4;
  if (const double share = share_excited(U, level, s.excited * greatest); share < kEveryOther) {
    throw InputError({name}, fmt::format("has an input of which one line in {:.0f} is excited: it "
                                         "is periodic; give its period",
                                         1.0 / share));
  }
  MeasuredResponse out;
  out.periods = 1;
  const double freedom = static_cast<double>(window) - 2.0 * (s.order + 1);
  double shares = 0.0;
  Stage stage("lines", static_cast<double>(U.size()));
  for (std::size_t k = 1; k < U.size(); ++k) {
    stage.reach(static_cast<double>(k));
    ResponseLine line;
    line.frequency = s.rate * static_cast<double>(k) / static_cast<double>(input.size());
    if (level[k] < s.excited * greatest || line.frequency < s.from || line.frequency > s.to) {
      continue;
    }
    const LocalFit fit = fit_around(U, Y, k, s);
    line.value = fit.response;
    line.variance = fit.variance;
    line.input = U[k];
    line.output = Y[k];
    line.radius_95 = std::sqrt(fisher_95(freedom) * fit.variance);
    shares += fit.share;
    out.lines.push_back(line);
  }
  if (out.lines.empty()) throw InputError({name}, "contains no excited line");
  out.lines_per_estimate = std::max(static_cast<double>(out.lines.size()) / shares, 1.0);
  return out;
}

}  // namespace servomill::sim::responses
