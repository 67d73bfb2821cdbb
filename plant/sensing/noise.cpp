#include "plant/sensing/noise.h"

#include <cmath>
#include <numbers>

namespace servomill::plant {
namespace {

// Constants of Philox 4x32-10: J. K. Salmon et al., Parallel random numbers: as easy as 1, 2, 3, SC
// 2011, table 2. The number of a sample is the counter, so that every reading has its noise
// whatever was read before.
constexpr std::uint64_t kMultiplier0 = 0xD2511F53, kMultiplier1 = 0xCD9E8D57;
constexpr std::uint32_t kWeyl0 = 0x9E3779B9, kWeyl1 = 0xBB67AE85;
constexpr int kRounds = 10;

constexpr std::uint32_t low(std::uint64_t bits) { return static_cast<std::uint32_t>(bits); }
constexpr std::uint32_t high(std::uint64_t bits) { return static_cast<std::uint32_t>(bits >> 32); }

// In (0, 1]: 53 bits, so that the logarithm is finite.
double uniform(std::uint32_t upper, std::uint32_t lower) {
  const std::uint64_t bits = (std::uint64_t{upper} << 32 | lower) >> 11;
  return static_cast<double>(bits + 1) * 0x1p-53;
}

}  // namespace

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                    std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < kRounds; ++round) {
    const std::uint64_t product0 = kMultiplier0 * counter[0];
    const std::uint64_t product1 = kMultiplier1 * counter[2];
    counter = {high(product1) ^ counter[1] ^ key[0], low(product1),
               high(product0) ^ counter[3] ^ key[1], low(product0)};
    key[0] += kWeyl0;
    key[1] += kWeyl1;
  }
  return counter;
}

std::array<double, 2> white_noise(const NoiseKey& key, std::uint32_t channel, Tick tick) {
  const auto time = static_cast<std::uint64_t>(tick);
  const auto bits =
      philox({low(time), high(time), key.stream, channel}, {low(key.seed), high(key.seed)});
  const double radius = std::sqrt(-2.0 * std::log(uniform(bits[0], bits[1])));
  const double angle = 2.0 * std::numbers::pi * uniform(bits[2], bits[3]);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace servomill::plant
