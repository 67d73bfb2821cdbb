/// Choice of the instruction set at run time: one binary for all machines.
#pragma once

#include <array>
#include <string_view>
#include <vector>

namespace servomill {

/// In rising order. `baseline` is what every machine of the processor family has (x86-64: SSE2).
enum class SimdLevel { baseline, avx2, avx512 };
inline constexpr std::array kSimdLevels = {SimdLevel::baseline, SimdLevel::avx2, SimdLevel::avx512};

/// The best level that this machine and this binary have, or the lower one that the environment
/// variable SERVOMILL_SIMD names (baseline, avx2, avx512). Decided once, at the first call. The
/// last bits of results are those of the others, or of baseline: it has no fused multiplication and
/// addition.
/// @throws InputError if the variable names none of them
SimdLevel simd_level();

/// The level of that name; the best one if the name is empty.
/// @throws InputError
SimdLevel simd_level_named(std::string_view name);

/// The levels that this machine and this binary have, in rising order.
std::vector<SimdLevel> simd_levels();

std::string_view name_of(SimdLevel level);

/// make.operator()<level>(), for tables of functions that exist once for each level.
template <class Make>
auto at_simd_level([[maybe_unused]] SimdLevel level, Make make) {
#ifdef SERVOMILL_X86
  if (level == SimdLevel::avx512) return make.template operator()<SimdLevel::avx512>();
  if (level == SimdLevel::avx2) return make.template operator()<SimdLevel::avx2>();
#endif
  return make.template operator()<SimdLevel::baseline>();
}

}  // namespace servomill
