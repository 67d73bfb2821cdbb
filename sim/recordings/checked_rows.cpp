#include "sim/recordings/checked_rows.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace servomill::sim::recordings {

double checked_number(const Field& field, char decimal, const Place& line) {
  const auto value = parse_number(field.text, decimal);
  const Place place{line.file, line.line, field.column};
  if (!value) throw InputError(place, fmt::format("'{}' is not a number", as_utf8(field.text)));
  if (std::isinf(*value)) {
    throw InputError(place, fmt::format("'{}' is infinite", as_utf8(field.text)));
  }
  return *value;
}

char decimal_of(std::string_view number) {
  return !parse_number(number, '.') && parse_number(number, ',') ? ',' : '.';
}

void append_time(Base& base, double seconds, const Place& place) {
  if (!std::isfinite(seconds)) throw InputError(place, "has no time");
  if (!base.values.empty()) {
    const double last = base.values.back();
    if (seconds < last) {
      throw InputError(place, fmt::format("time runs backwards: {} s after {} s", seconds, last));
    }
    if (seconds == last) throw InputError(place, fmt::format("time {} s appears twice", seconds));
  }
  base.values.push_back(seconds);
}

std::size_t shared_base(Recording& recording, Base base) {
  for (std::size_t i = 0; i < recording.bases.size(); ++i) {
    if (recording.bases[i].values == base.values) return i;
  }
  const std::size_t count = recording.bases.size();
  base.name = count == 0 ? "time" : fmt::format("time {}", count + 1);
  recording.bases.push_back(std::move(base));
  return count;
}

}  // namespace servomill::sim::recordings
