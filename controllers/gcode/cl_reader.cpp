#include "controllers/gcode/cl_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "plant/vocabulary/tool_axis.h"

namespace servomill::controllers {
namespace {

constexpr double kNoDirection = 1e-9;  // a shorter tool axis is taken as zero

char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

}  // namespace

PlacedText PlacedText::trimmed(std::size_t from, std::size_t to) const {
  while (from < to && is_blank(text[from])) ++from;
  while (to > from && is_blank(text[to - 1])) --to;
  const auto a = static_cast<std::ptrdiff_t>(from), b = static_cast<std::ptrdiff_t>(to);
  PlacedText out{text.substr(from, to - from), {spots.begin() + a, spots.begin() + b}};
  // an empty part stands where it would begin
  if (out.spots.empty() && !spots.empty()) {
    out.spots.push_back(spots[std::min(from, spots.size() - 1)]);
  }
  return out;
}
std::vector<PlacedText> split(const PlacedText& whole, std::size_t from, char at) {
  std::vector<PlacedText> parts;
  while (true) {
    const std::size_t end = std::min(whole.text.find(at, from), whole.text.size());
    parts.push_back(whole.trimmed(from, end));
    if (end == whole.text.size()) return parts;
    from = end + 1;
  }
}

std::string in_capitals(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), upper);
  return text;
}

std::optional<double> signed_number_in(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double x = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), x);
  if (text.empty() || status != std::errc() || end != text.data() + text.size()) return {};
  return std::isfinite(x) ? std::optional(x) : std::nullopt;
}

double ClReader::number(const PlacedText& word) const {
  if (const auto x = signed_number_in(word.text)) return *x;
  if (word.text.empty()) fail(word.spot(), "a number is missing");
  fail(word.spot(), fmt::format("'{}' is not a number", word.text));
}

Eigen::Vector3d ClReader::unit_axis(const Eigen::Vector3d& k, Spot spot) {
  const double length = k.norm();
  if (!(length > kNoDirection)) {
    fail(spot, fmt::format("tool axis ({:g}, {:g}, {:g}) has zero length", k[0], k[1], k[2]));
  }
  if (!std::isfinite(length)) fail(spot, "tool axis is too long");
  if (std::abs(length - 1.0) > kAxisLengthTolerance) {
    warn(spot, fmt::format("tool axis has length {:.6g}; normalised to a unit vector", length));
  }
  return k / length;
}

ClData ClReader::finish() {
  if (faults_.empty() && out_.locations() == 0) {
    faults_.push_back({{file_}, "contains no cutter location"});
  }
  std::stable_sort(
      out_.warnings.begin(), out_.warnings.end(), [](const Warning& a, const Warning& b) {
        return std::pair(a.place.line, a.place.column) < std::pair(b.place.line, b.place.column);
      });
  if (faults_.empty()) return std::move(out_);
  if (of_refused_ != nullptr) {
    of_refused_->insert(of_refused_->end(), out_.warnings.begin(), out_.warnings.end());
  }
  throw InputError(std::move(faults_));
}

}  // namespace servomill::controllers
