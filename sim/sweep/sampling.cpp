#include "sim/sweep/sampling.h"

#include <array>
#include <boost/math/special_functions/erf.hpp>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/seed_seq.hpp>
#include <boost/random/sobol.hpp>
#include <cassert>
#include <cmath>
#include <numbers>

namespace servomill::sim {
namespace {

using Engine = boost::random::mt19937_64;

// What a stream of random numbers is for: streams of different use are never the same.
enum class Use : std::uint32_t { sample, jitter, permutation, shift };

// The stream of one use, one key (a sample or a dimension) and one seed.
Engine stream(std::uint64_t seed, Use use, std::uint64_t key) {
  const auto low = [](std::uint64_t x) { return static_cast<std::uint32_t>(x); };
  const auto high = [](std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32); };
  const std::array<std::uint32_t, 5> words = {low(seed), high(seed),
                                              static_cast<std::uint32_t>(use), low(key), high(key)};
  boost::random::seed_seq sequence(words.begin(), words.end());
  return Engine(sequence);
}

// The middle of one of 2^53 cells of (0, 1).
double unit_number(std::uint64_t bits) {
  constexpr int kUnused = 64 - 53;
  return (static_cast<double>(bits >> kUnused) + 0.5) * 0x1p-53;
}

std::vector<double> random_sample(std::uint64_t seed, Use use, std::uint64_t index,
                                  std::size_t dimensions) {
  Engine engine = stream(seed, use, index);
  std::vector<double> sample(dimensions);
  for (double& x : sample) x = unit_number(engine());
  return sample;
}

std::vector<double> latin_hypercube_sample(const SampleSettings& settings, std::uint64_t index,
                                           std::size_t dimensions) {
  std::vector<double> sample = random_sample(settings.seed, Use::jitter, index, dimensions);
  const auto count = static_cast<double>(settings.count);
  for (std::size_t d = 0; d < dimensions; ++d) {
    const std::uint64_t key = stream(settings.seed, Use::permutation, d)();
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
  Engine shift = stream(seed, Use::shift, 0);
  std::vector<double> sample(dimensions);
  for (std::size_t d = 0; d < dimensions; ++d) sample[d] = unit_number(bits[d] ^ shift());
  return sample;
}

// Mixes all bits of a word with all others (the finaliser of SplitMix64).
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
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
  assert(index < settings.count && dimensions > 0 && dimensions <= kMostDimensions);
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

}  // namespace servomill::sim
