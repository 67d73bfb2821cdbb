#include "plant/vocabulary/simd.h"

#include <algorithm>
#include <cstdlib>
#include <xsimd/xsimd.hpp>

namespace servomill {

std::vector<SimdLevel> simd_levels() {
  std::vector<SimdLevel> levels = {SimdLevel::baseline};
#ifdef SERVOMILL_X86
  const auto has = xsimd::available_architectures();
  if (has.avx2 && has.fma3_avx2) levels.push_back(SimdLevel::avx2);
  if (levels.back() == SimdLevel::avx2 && has.avx512bw) levels.push_back(SimdLevel::avx512);
#endif
  return levels;
}

std::string_view name_of(SimdLevel level) {
  switch (level) {
    case SimdLevel::baseline:
      return "baseline";
    case SimdLevel::avx2:
      return "avx2";
    case SimdLevel::avx512:
      return "avx512";
  }
  return "";
}

SimdLevel simd_level() {
  static const SimdLevel kLevel = [] {
    const std::vector<SimdLevel> levels = simd_levels();
    const char* wanted = std::getenv("SERVOMILL_SIMD");
    const auto named = std::find_if(levels.begin(), levels.end(), [&](SimdLevel level) {
      return wanted != nullptr && name_of(level) == wanted;
    });
    return named != levels.end() ? *named : levels.back();
  }();
  return kLevel;
}

}  // namespace servomill
