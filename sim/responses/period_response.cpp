#include "sim/responses/period_response.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/FFT>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/progress.h"

namespace servomill::sim::responses {
namespace {

using Spectrum = std::vector<Complex>;

std::vector<Spectrum> transforms(std::span<const double> signal, const PeriodSettings& s,
                                 std::size_t periods) {
  Eigen::FFT<double> fft;
  std::vector<Spectrum> out(periods);
  Stage stage("periods", static_cast<double>(periods));
  for (std::size_t p = 0; p < periods; ++p) {
    stage.reach(static_cast<double>(p));
    const auto one = signal.subspan((s.skip + p) * s.samples, s.samples);
    fft.fwd(out[p], std::vector<double>(one.begin(), one.end()));
    out[p].resize(s.samples / 2);
  }
  return out;
}

Spectrum mean_of(const std::vector<Spectrum>& periods) {
  Spectrum mean(periods.front().size());
  for (const Spectrum& one : periods) {
    for (std::size_t k = 0; k < mean.size(); ++k) mean[k] += one[k];
  }
  for (Complex& line : mean) line /= static_cast<double>(periods.size());
  return mean;
}

// Covariance of the means of x and y at a line: E (x - X) conj(y - Y), over the number of periods.
Complex covariance(const std::vector<Spectrum>& x, const std::vector<Spectrum>& y,
                   const Spectrum& X, const Spectrum& Y, std::size_t k) {
  Complex sum = 0.0;
  for (std::size_t p = 0; p < x.size(); ++p) sum += (x[p][k] - X[k]) * std::conj(y[p][k] - Y[k]);
  const auto n = static_cast<double>(x.size());
  return sum / (n * (n - 1.0));
}

std::vector<std::size_t> excited_lines(const std::vector<Spectrum>& periods, const Spectrum& input,
                                       double share) {
  double greatest = 0.0;
  for (std::size_t k = 1; k < input.size(); ++k) greatest = std::max(greatest, std::abs(input[k]));
  std::vector<std::size_t> out;
  for (std::size_t k = 1; k < input.size(); ++k) {
    const double noise = std::sqrt(covariance(periods, periods, input, input, k).real());
    if (std::abs(input[k]) > std::max(share * greatest, 10.0 * noise)) out.push_back(k);
  }
  return out;
}

// Lowest point on the way from a maximum to something higher, on the side where it is higher up.
double saddle_of(const std::vector<double>& level, std::size_t at) {
  double saddle = -std::numeric_limits<double>::infinity();
  for (const int way : {-1, 1}) {
    double lowest = level[at];
    for (auto j = static_cast<std::ptrdiff_t>(at);
         j >= 0 && j < static_cast<std::ptrdiff_t>(level.size()); j += way) {
      const double there = level[static_cast<std::size_t>(j)];
      if (there > level[at]) break;
      lowest = std::min(lowest, there);
    }
    saddle = std::max(saddle, lowest);
  }
  return saddle;
}

// Maxima of a level, each with the parabola through its neighbours.
void add_maxima(const std::vector<double>& level, const MeasuredResponse& response, bool is_maximum,
                std::vector<Extreme>& out) {
  for (std::size_t k = 1; k + 1 < level.size(); ++k) {
    const double here = level[k], before = level[k - 1], after = level[k + 1];
    if (!(here > before && here >= after)) continue;
    const double bend = before - 2.0 * here + after;
    const double shift = bend < 0.0 ? 0.5 * (before - after) / bend : 0.0;
    const double step = response.lines[k + 1].frequency - response.lines[k].frequency;
    out.push_back({response.lines[k].frequency + shift * step, std::exp(here - saddle_of(level, k)),
                   is_maximum});
  }
}

}  // namespace

double fisher_95(double n) { return n * (std::pow(0.05, -1.0 / n) - 1.0); }

MeasuredResponse maximum_likelihood(std::span<const double> input, std::span<const double> output,
                                    const PeriodSettings& s, const std::string& name) {
  const std::size_t all = s.samples > 0 ? input.size() / s.samples : 0;
  if (all < s.skip + 2) {
    throw InputError({name}, fmt::format("has {} full periods of {} samples; at least {} are "
                                         "required: two after the {} skipped for the transient",
                                         all, s.samples, s.skip + 2, s.skip));
  }
  const std::size_t periods = all - s.skip;
  const auto u = transforms(input, s, periods), y = transforms(output, s, periods);
  const Spectrum U = mean_of(u), Y = mean_of(y);
  const std::vector<std::size_t> lines = excited_lines(u, U, s.excited);
  if (lines.empty()) throw InputError({name}, "has an input without excitation");
  MeasuredResponse out;
  out.periods = periods;
  out.unexcited = lines.back() - lines.front() + 1 - lines.size();
  const double step = s.rate / static_cast<double>(s.samples);
  Stage stage("lines", static_cast<double>(lines.size()));
  for (const std::size_t k : lines) {
    stage.advance();
    ResponseLine line;
    line.frequency = step * static_cast<double>(k);
    line.input = U[k];
    line.output = Y[k];
    line.value = Y[k] / U[k];
    const double own = covariance(y, y, Y, Y, k).real(),
                 of_input = covariance(u, u, U, U, k).real();
    const Complex cross = covariance(y, u, Y, U, k);
    // var(Y - G U) / |U|^2: the same as the formula of the header, defined where Y is 0, too
    const double variance =
        own + std::norm(line.value) * of_input - 2.0 * (std::conj(line.value) * cross).real();
    line.variance = std::max(variance, 0.0) / std::norm(U[k]);
    line.radius_95 = std::sqrt(fisher_95(static_cast<double>(periods - 1)) * line.variance);
    out.lines.push_back(line);
  }
  return out;
}

std::vector<Extreme> extremes(const MeasuredResponse& response) {
  std::vector<double> level, turned;
  for (const ResponseLine& line : response.lines) {
    level.push_back(std::log(std::abs(line.value)));
    turned.push_back(-level.back());
  }
  std::vector<Extreme> out;
  add_maxima(level, response, true, out);
  add_maxima(turned, response, false, out);
  std::sort(out.begin(), out.end(),
            [](const Extreme& a, const Extreme& b) { return a.prominence > b.prominence; });
  return out;
}

}  // namespace servomill::sim::responses
