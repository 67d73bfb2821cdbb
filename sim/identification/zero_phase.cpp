#include "sim/identification/zero_phase.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace servomill::sim::identification {
namespace {

// One pair of poles: b (1, 2, 1) over (1, a1, a2).
struct Section {
  double b, a1, a2;
};

std::vector<Section> butterworth(double corner, int order) {
  const double K = std::tan(std::numbers::pi * corner);  // prewarped
  std::vector<Section> sections;
  for (int k = 0; k < order / 2; ++k) {
    const double angle = std::numbers::pi * (2.0 * k + 1.0) / (2.0 * order);
    const double damping = 2.0 * std::sin(angle);
    const double norm = 1.0 / (1.0 + damping * K + K * K);
    sections.push_back(
        {K * K * norm, 2.0 * (K * K - 1.0) * norm, (1.0 - damping * K + K * K) * norm});
  }
  return sections;
}

// In place, as if the first sample had stood for ever.
void run(std::vector<double>& y, const Section& s) {
  const double x0 = y.front();
  double x1 = x0, x2 = x0, y1 = x0, y2 = x0;  // gain 1 at frequency 0
  for (double& sample : y) {
    const double out = s.b * (sample + 2.0 * x1 + x2) - s.a1 * y1 - s.a2 * y2;
    x2 = x1;
    x1 = sample;
    y2 = y1;
    y1 = sample = out;
  }
}

}  // namespace

std::vector<double> zero_phase(std::span<const double> signal, double corner, int order) {
  assert(corner > 0.0 && corner < 0.5 && order > 0 && order % 2 == 0);
  if (signal.empty()) return {};
  const auto wanted = static_cast<std::size_t>(std::ceil(3.0 * order / corner));
  const std::size_t ends = std::min(wanted, signal.size() - 1);
  std::vector<double> y;
  y.reserve(signal.size() + 2 * ends);
  for (std::size_t k = ends; k > 0; --k) y.push_back(2.0 * signal.front() - signal[k]);
  y.insert(y.end(), signal.begin(), signal.end());
  for (std::size_t k = 1; k <= ends; ++k) {
    y.push_back(2.0 * signal.back() - signal[signal.size() - 1 - k]);
  }
  for (const Section& section : butterworth(corner, order)) {
    run(y, section);
    std::reverse(y.begin(), y.end());
    run(y, section);
    std::reverse(y.begin(), y.end());
  }
  const auto begin = y.begin() + static_cast<std::ptrdiff_t>(ends);
  return {begin, begin + static_cast<std::ptrdiff_t>(signal.size())};
}

std::vector<double> derivative(std::span<const double> signal, double period) {
  std::vector<double> out(signal.size(), 0.0);
  for (std::size_t k = 0; k < signal.size(); ++k) {
    const std::size_t before = k == 0 ? 0 : k - 1, after = std::min(k + 1, signal.size() - 1);
    if (after == before) continue;
    out[k] = (signal[after] - signal[before]) / (period * static_cast<double>(after - before));
  }
  return out;
}

}  // namespace servomill::sim::identification
