#include "plant/vocabulary/input_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace servomill {
namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replace, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

}  // namespace

std::string to_string(const Place& place) {
  std::string text = place.file.empty() ? std::string("<input>") : place.file;
  if (place.line > 0) text += fmt::format(":{}", place.line);
  if (place.line > 0 && place.column > 0) text += fmt::format(":{}", place.column);
  return text;
}

std::string to_string(const Fault& fault) {
  return fmt::format("{}: error: {}", to_string(fault.place), fault.message);
}

InputError::InputError(std::vector<Fault> faults) : faults_(std::move(faults)) {
  std::stable_sort(faults_.begin(), faults_.end(), [](const Fault& a, const Fault& b) {
    if (a.place.file != b.place.file) return false;  // files stay in the order they were read
    return std::pair(a.place.line, a.place.column) < std::pair(b.place.line, b.place.column);
  });
  for (const Fault& fault : faults_) {
    if (!text_.empty()) text_ += '\n';
    text_ += to_string(fault);
  }
}

InputError::InputError(Place place, std::string message)
    : InputError(std::vector<Fault>{{std::move(place), std::move(message)}}) {}

std::string_view nearest_name(std::string_view word, std::span<const std::string_view> candidates) {
  const std::size_t limit = (word.size() + 2) / 3;
  std::string_view best;
  std::size_t best_distance = limit + 1;
  for (const std::string_view candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::string did_you_mean(std::string_view word, std::span<const std::string_view> candidates) {
  const std::string_view name = nearest_name(word, candidates);
  return name.empty() ? std::string() : fmt::format("; did you mean '{}'?", name);
}

}  // namespace servomill
