#include "sim/recordings/fourier.h"

#include <cassert>
#include <cmath>
#include <numbers>

namespace servomill::sim::recordings {

std::vector<std::complex<double>> fourier_lines(std::span<const double> samples,
                                                std::size_t lines) {
  const std::size_t count = samples.size();
  assert(lines <= count);
  std::vector<double> cosine(count), sine(count);
  for (std::size_t i = 0; i < count; ++i) {
    // the smaller angle of the two that lead there
    const double steps =
        static_cast<double>(i) - (2 * i > count ? static_cast<double>(count) : 0.0);
    const double angle = 2.0 * std::numbers::pi * steps / static_cast<double>(count);
    cosine[i] = std::cos(angle);
    sine[i] = std::sin(angle);
  }
  // the mean belongs to line 0 alone
  double mean = 0.0;
  for (const double sample : samples) mean += sample / static_cast<double>(count);
  std::vector<double> rest(samples.begin(), samples.end());
  for (double& sample : rest) sample -= mean;
  std::vector<std::complex<double>> out;
  out.reserve(lines);
  for (std::size_t k = 0; k < lines; ++k) {
    double real = 0.0, imaginary = 0.0;
    std::size_t at = 0;  // k n mod N
    for (const double sample : rest) {
      real += sample * cosine[at];
      imaginary -= sample * sine[at];
      at += k;
      if (at >= count) at -= count;
    }
    if (k == 0) real += mean * static_cast<double>(count);
    out.emplace_back(real, imaginary);
  }
  return out;
}

}  // namespace servomill::sim::recordings
