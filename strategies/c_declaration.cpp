#include "strategies/c_declaration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <exception>
#include <string_view>

namespace servomill::strategies {
namespace {

std::string_view text(const char* given) { return given != nullptr ? given : ""; }

bool is_name(std::string_view name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return ('a' <= c && c <= 'z') || ('0' <= c && c <= '9') || c == '_';
  });
}

bool is_number(std::string_view text) {
  try {
    std::size_t end = 0;
    std::stod(std::string(text), &end);
    return end == text.size();
  } catch (const std::exception&) {
    return false;
  }
}

// Bytes of the struct as the first headers of this ABI version had it; what follows was appended.
constexpr std::size_t kFirstSize = offsetof(servomill_strategy, rewrite);
constexpr std::size_t kMaxSize = 1024;

bool has_unknown_parts(const servomill_strategy& declared) {
  const char* const bytes = reinterpret_cast<const char*>(&declared);
  return declared.size > sizeof declared &&
         std::any_of(bytes + sizeof declared, bytes + declared.size, [](char c) { return c != 0; });
}

std::string wrong_with(const servomill_parameter* one) {
  if (one == nullptr || one->size < sizeof(servomill_parameter)) return "is not declared";
  if (one->name == nullptr || *one->name == '\0') return "has no name";
  if (!text(one->default_text).empty() && !is_number(text(one->default_text))) {
    return fmt::format("has the default '{}', which is not a number", one->default_text);
  }
  if (!(one->min <= one->max)) return "has a minimum above its maximum";
  if (!text(one->default_text).empty()) {
    const double value = std::stod(one->default_text);
    if (!(one->min <= value && value <= one->max)) {
      return fmt::format("has the default {}, outside of its range {:g} to {:g}", one->default_text,
                         one->min, one->max);
    }
  }
  return "";
}

}  // namespace

servomill_strategy completed(const servomill_strategy& declared) {
  servomill_strategy out{};
  std::memcpy(&out, &declared, std::min(declared.size, sizeof out));
  return out;
}

std::string wrong_with(const servomill_strategy& declared) {
  if (declared.size < kFirstSize || declared.size > kMaxSize) {
    return fmt::format("its struct has {} bytes, expected {} to {}", declared.size, kFirstSize,
                       kMaxSize);
  }
  if (has_unknown_parts(declared)) {
    return "has functions unknown to this program: it was built for a later version";
  }
  const servomill_strategy full = completed(declared);
  if (!is_name(text(declared.name))) {
    return fmt::format("'{}' is not a valid name: use lower case, digits and '_'",
                       text(declared.name));
  }
  if (declared.create == nullptr) return "lacks the function create";
  if (full.displacement == nullptr && full.offset == nullptr && full.rewrite == nullptr &&
      full.position_loop == nullptr) {
    return "has none of the functions displacement, offset, rewrite and position_loop";
  }
  for (std::size_t n = 0; n < declared.parameter_count; ++n) {
    if (const std::string wrong = wrong_with(declared.parameters[n]); !wrong.empty()) {
      return fmt::format("parameter {} {}", n, wrong);
    }
  }
  return "";
}

}  // namespace servomill::strategies
