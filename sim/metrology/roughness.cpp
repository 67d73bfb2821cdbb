#include "sim/metrology/roughness.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"

namespace servomill::sim::metrology {
namespace {

constexpr int kSections = 5;

// Less the least-squares line over the number of the point.
std::vector<double> levelled(std::span<const double> heights) {
  const auto count = static_cast<double>(heights.size());
  const double middle = 0.5 * (count - 1.0);
  double mean = 0.0, moment = 0.0, spread = 0.0;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const double u = static_cast<double>(i) - middle;
    mean += heights[i] / count;
    moment += u * heights[i];
    spread += u * u;
  }
  std::vector<double> out;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    out.push_back(heights[i] - mean - moment / spread * (static_cast<double>(i) - middle));
  }
  return out;
}

// Weights of (1) for 0, 1, 2 ... points to a side, out to half a cut-off, where they end in common
// instruments; their sum over both sides is 1.
std::vector<double> weights(double cutoff, double spacing) {
  const double alpha = std::sqrt(std::numbers::ln2 / std::numbers::pi);
  std::vector<double> out;
  double sum = 0.0;
  for (double x = 0.0; x <= 0.5 * cutoff; x = spacing * static_cast<double>(out.size())) {
    const double share = x / (alpha * cutoff);
    out.push_back(std::exp(-std::numbers::pi * share * share));
    sum += out.size() == 1 ? out.back() : 2.0 * out.back();
  }
  for (double& one : out) one /= sum;
  return out;
}

}  // namespace

std::optional<double> cutoff_for(double length) {
  constexpr double kEnds = 1.0, kRounding = 1e-9;  // of a cut-off
  std::optional<double> out;
  for (const double cutoff : kCutoffs) {
    if ((kSections + kEnds - kRounding) * cutoff <= length) out = cutoff;
  }
  return out;
}

std::optional<Roughness> roughness_of(std::span<const double> heights, double spacing,
                                      std::string& why_not) {
  const double length = spacing * (static_cast<double>(heights.size()) - 1.0);
  const auto cutoff = cutoff_for(length);
  if (!cutoff) {
    why_not = fmt::format("a line of {:g} mm is shorter than 6 cut-offs of {:g} mm", length / mm,
                          kCutoffs[0] / mm);
    return std::nullopt;
  }
  if (spacing * kMinPointsOfCutoff > *cutoff) {
    why_not = fmt::format("points {:.3g} um apart; a cut-off of {:g} mm requires at most {:g} um",
                          spacing / um, *cutoff / mm, *cutoff / kMinPointsOfCutoff / um);
    return std::nullopt;
  }
  const std::vector<double> primary = levelled(heights), w = weights(*cutoff, spacing);
  const auto of_section = static_cast<std::size_t>(std::lround(*cutoff / spacing));
  Roughness out{.cutoff = *cutoff, .evaluation_length = kSections * *cutoff};
  const std::size_t evaluated =
      std::min(kSections * of_section, primary.size() - 2 * (w.size() - 1));
  out.first = (primary.size() - evaluated) / 2;
  for (std::size_t i = out.first; i < out.first + evaluated; ++i) {
    double mean = w[0] * primary[i];
    for (std::size_t k = 1; k < w.size(); ++k) mean += w[k] * (primary[i - k] + primary[i + k]);
    out.profile.push_back(primary[i] - mean);
    out.Ra += std::abs(out.profile.back()) / static_cast<double>(evaluated);
  }
  for (int section = 0; section < kSections; ++section) {
    const auto at = [&](int n) {
      return out.profile.begin() +
             static_cast<std::ptrdiff_t>(evaluated * static_cast<std::size_t>(n) / kSections);
    };
    const auto [low, high] = std::minmax_element(at(section), at(section + 1));
    out.Rz += (*high - *low) / kSections;
  }
  return out;
}

}  // namespace servomill::sim::metrology
