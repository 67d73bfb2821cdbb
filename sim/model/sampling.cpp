#include "sim/model/sampling.h"

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <boost/random/sobol.hpp>
#include <cassert>
#include <cmath>
#include <numbers>

namespace servomill::sim::model {
namespace {

// Mixes all bits of a word with all others (the finaliser of SplitMix64).
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

// Use of a stream of random numbers: streams of different use are never the same.
enum class Use : std::uint8_t { sample = 1, jitter, permutation, shift };

// SplitMix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014), of one
// seed, one use and one key (a sample or a dimension). The engines of Boost take as long to be
// seeded as for hundreds of numbers, and here a point takes a few.
class Stream {
 public:
  Stream(std::uint64_t seed, Use use, std::uint64_t key)
      : state_(mixed(mixed(mixed(seed + kStep) + static_cast<std::uint64_t>(use) * kStep) + key)) {}
  std::uint64_t operator()() { return mixed(state_ += kStep); }

 private:
  static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15ULL;
  std::uint64_t state_;
};

// The middle of one of 2^53 cells of (0, 1).
double unit_number(std::uint64_t bits) {
  constexpr int kUnused = 64 - 53;
  return (static_cast<double>(bits >> kUnused) + 0.5) * 0x1p-53;
}

std::vector<double> random_sample(std::uint64_t seed, Use use, std::uint64_t index,
                                  std::size_t dimensions) {
  Stream engine(seed, use, index);
  std::vector<double> sample(dimensions);
  for (double& x : sample) x = unit_number(engine());
  return sample;
}

std::vector<double> latin_hypercube_sample(const SampleSettings& settings, std::uint64_t index,
                                           std::size_t dimensions) {
  std::vector<double> sample = random_sample(settings.seed, Use::jitter, index, dimensions);
  const auto count = static_cast<double>(settings.count);
  for (std::size_t d = 0; d < dimensions; ++d) {
    const std::uint64_t key = Stream(settings.seed, Use::permutation, d)();
    const auto interval = static_cast<double>(permuted(index, settings.count, key));
    // the rounding of the sum must not leave the interval
    sample[d] =
        std::min((interval + sample[d]) / count, std::nextafter((interval + 1.0) / count, 0.0));
  }
  return sample;
}

std::vector<double> sobol_sample(std::uint64_t seed, std::uint64_t index, std::size_t dimensions) {
  std::vector<std::uint64_t> bits(dimensions);  // the sequence begins with zeros, which Boost skips
  if (index > 0) {
    boost::random::sobol sequence(dimensions);
    sequence.seed(index - 1);
    sequence.generate(bits.begin(), bits.end());
  }
  Stream shift(seed, Use::shift, 0);
  std::vector<double> sample(dimensions);
  for (std::size_t d = 0; d < dimensions; ++d) sample[d] = unit_number(bits[d] ^ shift());
  return sample;
}

}  // namespace

std::uint64_t permuted(std::uint64_t index, std::uint64_t count, std::uint64_t key) {
  assert(index < count);
  constexpr std::uint64_t kRounds = 6;
  unsigned half = 1;  // bits of one half: 4^half is the least such power >= count
  while (half < 32 && (count - 1) >> (2 * half) != 0) ++half;
  const std::uint64_t mask = (std::uint64_t{1} << half) - 1;
  do {  // at most three of four steps lead out of the count
    std::uint64_t left = index >> half, right = index & mask;
    for (std::uint64_t round = 0; round < kRounds; ++round) {
      const std::uint64_t next = left ^ (mixed(key + (round << 32) * 0x9e37ULL + right) & mask);
      left = right;
      right = next;
    }
    index = (left << half) | right;
  } while (index >= count);
  return index;
}

std::vector<double> unit_sample(const SampleSettings& settings, std::uint64_t index,
                                std::size_t dimensions) {
  assert(index < settings.count && dimensions > 0 && dimensions <= kMaxDimensions);
  switch (settings.sampling) {
    case Sampling::random:
      return random_sample(settings.seed, Use::sample, index, dimensions);
    case Sampling::latin_hypercube:
      return latin_hypercube_sample(settings, index, dimensions);
    case Sampling::sobol:
      return sobol_sample(settings.seed, index, dimensions);
  }
  return {};
}

double normal_quantile(double u) { return -std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * u); }

}  // namespace servomill::sim::model
