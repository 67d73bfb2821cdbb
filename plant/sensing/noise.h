/// Noise that is a function of its seed and of time, not of who looked at it before.
#pragma once

#include <array>
#include <cstdint>

#include "plant/vocabulary/ticks.h"

namespace servomill::plant {

/// Philox4x32 with 10 rounds: 128 well mixed bits of a 128-bit counter and a 64-bit key. It has no
/// state, so that each value can be had in any order and as often as wanted.
/// Source: Salmon, Moraes, Dror, Shaw, Parallel random numbers: as easy as 1, 2, 3, SC11 (2011),
/// section 3.3; known answers from the authors' Random123.
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                    std::array<std::uint32_t, 2> key);

/// Which noise: one stream for each noisy thing of a run.
struct NoiseKey {
  std::uint64_t seed = 0;
  std::uint32_t stream = 0;  // of the run, such as 2 j for the scale and 2 j + 1 for the motor
};

/// Two independent standard normal numbers (mean 0, variance 1, largest possible 8.6) for a tick:
/// Box-Muller of the bits of philox(tick, stream, channel; seed). Independent for different ticks,
/// channels, streams and seeds, equal for equal ones.
/// @param channel  tells apart several noises of one stream
std::array<double, 2> white_noise(const NoiseKey& key, std::uint32_t channel, Tick tick);

}  // namespace servomill::plant
