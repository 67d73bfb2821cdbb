/// Eight numbers at once: how they are stored (everywhere), and how they are computed with (in the
/// kernels, sources that are compiled once for each instruction set; simd.h chooses among them).
///
/// A lane is one axis of one run. Lanes never mix: what a lane computes depends on its own numbers
/// only, whatever its neighbours hold. So a run gives the same bits alone and among others.
#pragma once

#include <array>
#include <cstddef>

namespace servomill {

inline constexpr std::size_t kLaneWidth = 8;

/// One number for each of eight lanes.
struct alignas(64) LaneArray : std::array<double, kLaneWidth> {};

/// One flag for each of eight lanes.
using LaneFlags = std::array<bool, kLaneWidth>;

/// Blocks of eight that hold this many lanes.
constexpr std::size_t blocks_of(std::size_t lanes) { return (lanes + kLaneWidth - 1) / kLaneWidth; }

}  // namespace servomill
