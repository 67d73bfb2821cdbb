#include "sim/metrology/cmm.h"

#include <cmath>

#include "plant/sensing/noise.h"

namespace servomill::sim::metrology {
namespace {

// Uncertainties of data sheets and certificates are expanded ones, k = 2.
constexpr double kCoverage = 2.0;

// FNV-1a, 32 bits.
std::uint32_t hash(std::string_view text, std::uint32_t start = 0x811C9DC5) {
  for (const char c : text) start = (start ^ static_cast<unsigned char>(c)) * 0x01000193;
  return start;
}

std::uint32_t stream_of(std::string_view case_name, std::string_view feature) {
  return hash(feature, hash("/", hash(case_name)));
}

}  // namespace

std::vector<double> probe_once(const Cmm& cmm, std::string_view case_name, std::string_view feature,
                               std::span<const double> deviation, int repetition) {
  const plant::NoiseKey key{cmm.seed, stream_of(case_name, feature)};
  const auto channel = static_cast<std::uint32_t>(repetition);
  const double sigma = cmm.uncertainty / kCoverage;
  std::vector<double> out(deviation.begin(), deviation.end());
  for (std::size_t i = 0; sigma > 0.0 && i < out.size(); ++i) {
    out[i] += sigma * plant::white_noise(key, channel, static_cast<Tick>(i))[0];
  }
  return out;
}

std::vector<std::vector<double>> probe_all(const Cmm& cmm, std::string_view case_name,
                                           std::string_view feature,
                                           std::span<const double> deviation) {
  std::vector<std::vector<double>> out;
  for (int r = 0; r < cmm.repetitions; ++r) {
    out.push_back(probe_once(cmm, case_name, feature, deviation, r));
  }
  return out;
}

std::vector<double> mean_of(std::span<const std::vector<double>> measured) {
  std::vector<double> mean(measured.front().size(), 0.0);
  for (const std::vector<double>& once : measured) {
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += once[i];
  }
  for (double& value : mean) value /= static_cast<double>(measured.size());
  return mean;
}

std::vector<double> standard_deviation_of(std::span<const std::vector<double>> measured) {
  const std::vector<double> mean = mean_of(measured);
  std::vector<double> out(mean.size(), 0.0);
  if (measured.size() < 2) return out;
  for (const std::vector<double>& once : measured) {
    for (std::size_t i = 0; i < mean.size(); ++i) {
      out[i] += (once[i] - mean[i]) * (once[i] - mean[i]);
    }
  }
  for (double& value : out) value = std::sqrt(value / static_cast<double>(measured.size() - 1));
  return out;
}

}  // namespace servomill::sim::metrology
