#include "plant/vocabulary/simd.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <xsimd/xsimd.hpp>

#include "plant/vocabulary/input_error.h"

namespace servomill {
namespace {

constexpr std::array<std::string_view, 3> kNames = {"baseline", "avx2", "avx512"};

}  // namespace

std::vector<SimdLevel> simd_levels() {
  std::vector<SimdLevel> levels = {SimdLevel::baseline};
#ifdef SERVOMILL_X86
  const auto has = xsimd::available_architectures();
  if (has.avx2 && has.fma3_avx2) levels.push_back(SimdLevel::avx2);
  if (levels.back() == SimdLevel::avx2 && has.avx512bw) levels.push_back(SimdLevel::avx512);
#endif
  return levels;
}

std::string_view name_of(SimdLevel level) { return kNames.at(static_cast<std::size_t>(level)); }

SimdLevel simd_level_named(std::string_view name) {
  const std::vector<SimdLevel> levels = simd_levels();
  if (name.empty()) return levels.back();
  std::vector<std::string_view> names;
  for (const SimdLevel level : levels) {
    if (name_of(level) == name) return level;
    names.push_back(name_of(level));
  }
  const Place place{"SERVOMILL_SIMD"};
  if (std::find(kNames.begin(), kNames.end(), name) != kNames.end()) {
    throw InputError(
        place, fmt::format("{} is not supported by this processor or binary; supported are: {}",
                           name, fmt::join(names, ", ")));
  }
  throw InputError(place, fmt::format("'{}' is not a SIMD level; must be one of {}{}", name,
                                      fmt::join(kNames, ", "), did_you_mean(name, kNames)));
}

SimdLevel simd_level() {
  static const SimdLevel kLevel = [] {
    const char* wanted = std::getenv("SERVOMILL_SIMD");
    return simd_level_named(wanted == nullptr ? "" : wanted);
  }();
  return kLevel;
}

}  // namespace servomill
