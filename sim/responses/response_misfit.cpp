#include "sim/responses/response_misfit.h"

#include <algorithm>
#include <cmath>

namespace servomill::sim::responses {

double median_misfit(const MeasuredResponse& response, const std::vector<Complex>& model) {
  std::vector<double> misfit;
  for (std::size_t n = 0; n < model.size(); ++n) {
    const Complex& measured = response.lines[n].value;
    misfit.push_back(std::abs(model[n] - measured) / std::abs(measured));
  }
  const auto middle = misfit.begin() + static_cast<std::ptrdiff_t>(misfit.size() / 2);
  std::nth_element(misfit.begin(), middle, misfit.end());
  return *middle;
}

double noise_ratio(const MeasuredResponse& response, const std::vector<Complex>& model,
                   std::size_t parameters) {
  double sum = 0.0;
  for (std::size_t n = 0; n < model.size(); ++n) {
    const ResponseLine& line = response.lines[n];
    sum += 2.0 * std::norm(model[n] - line.value) / std::max(line.variance, 1e-300);
  }
  return std::sqrt(sum / static_cast<double>(2 * model.size() - parameters));
}

std::vector<double> line_weights(const MeasuredResponse& response, double floor) {
  std::vector<double> out;
  for (const ResponseLine& line : response.lines) {
    const double least = std::max(floor, 1e-9) * std::abs(line.value);
    out.push_back(1.0 / std::sqrt(0.5 * line.variance + 0.5 * least * least));
  }
  return out;
}

}  // namespace servomill::sim::responses
