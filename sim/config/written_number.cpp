#include "sim/config/written_number.h"

#include <cmath>
#include <cstdlib>
#include <limits>

#include "sim/config/quantity.h"

namespace servomill::sim::config {

std::optional<WrittenNumber> written_number(const std::string& toml) {
  const bool quoted = !toml.empty() && (toml.front() == '"' || toml.front() == '\'');
  const char* begin = toml.c_str() + (quoted ? 1 : 0);
  char* end = nullptr;
  const double value = std::strtod(begin, &end);
  if (end == begin || !std::isfinite(value)) return std::nullopt;
  if (!quoted) {
    if (*end != '\0') return {};
    return WrittenNumber{value, ""};
  }
  std::string unit(end);
  if (unit.empty() || unit.back() != toml.front()) return {};
  unit.pop_back();
  unit.erase(0, unit.find_first_not_of(' '));
  if (unit.empty() || !parse_unit(unit).unit) return {};
  return WrittenNumber{value, unit};
}

double number_of(const std::string& toml) {
  const std::size_t begin = toml.find_first_not_of("\"'");
  if (begin == std::string::npos) return std::numeric_limits<double>::quiet_NaN();
  char* end = nullptr;
  const double value = std::strtod(toml.c_str() + begin, &end);
  return end == toml.c_str() + begin ? std::numeric_limits<double>::quiet_NaN() : value;
}

}  // namespace servomill::sim::config
