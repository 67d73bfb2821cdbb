#include "sim/compensate/parameter_file.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim {
namespace {

// Source: LinuxCNC 2.9, G-code overview, "Numbered Parameters".
constexpr int kWorkSystem = 5220, kWorkOffsets = 5221, kStride = 20, kRotation = 9, kSystems = 9;
constexpr int kShiftActive = 5210, kFirstWritten = 31, kLastWritten = 5390;

template <class Number>
std::optional<Number> number_in(std::string_view& text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return std::nullopt;
  text.remove_prefix(first);
  if (text.front() == '+') text.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

void take(int number, double value, controllers::ProgramSetup& setup) {
  const int place = number - kWorkOffsets;
  const bool is_offset = place >= 0 && place < kSystems * kStride;
  const auto system = static_cast<std::size_t>(is_offset ? place / kStride : 0);
  const int member = place % kStride;
  if (number == kWorkSystem) {
    setup.work_system = static_cast<int>(value);
  } else if (is_offset && member < kAxisWords) {
    setup.work_offset[system][member] = value * (member < kLinearJoints ? mm : deg);
  } else if (is_offset && member == kRotation) {
    setup.work_rotation[system] = value * deg;
  } else if (value != 0.0) {
    setup.parameters[fmt::format("#{}", number)] = value;
  }
}

}  // namespace

void take_parameter_file(std::string_view text, const std::string& file,
                         controllers::ProgramSetup& setup) {
  std::vector<Fault> faults;
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view rest = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (rest.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    const auto number = number_in<int>(rest);
    const auto value = number_in<double>(rest);
    if (!number || !value || !std::isfinite(*value) ||
        rest.find_first_not_of(" \t\r") != std::string_view::npos) {
      faults.push_back({{file, line}, "must be a parameter and its value, such as 5221 10.5"});
    } else if (*number < kFirstWritten || *number > kLastWritten) {
      faults.push_back({{file, line},
                        fmt::format("parameter {}; must be in {} ... {}", *number, kFirstWritten,
                                    kLastWritten)});
    } else if (*number == kShiftActive && *value != 0.0) {
      faults.push_back({{file, line},
                        "a G92 offset is in force at the start, which cannot be compensated; end "
                        "it with G92.1"});
    } else if (*number == kWorkSystem && (*value < 1.0 || *value > kSystems)) {
      faults.push_back({{file, line}, fmt::format("work system {}; must be in 1 ... 9", *value)});
    } else {
      take(*number, *value, setup);
    }
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

}  // namespace servomill::sim
