#include "sim/config/option_value.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace servomill::sim::config {

std::optional<double> plain_number(std::string_view text) {
  double value = 0.0;
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_whole = error == std::errc() && end == text.data() + text.size();
  return is_whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

ScaledText scale_option(std::string_view text, Quantity quantity, std::string_view bare_unit) {
  ScaledText scaled = plain_number(text)
                          ? scale_text(fmt::format("{} {}", text, bare_unit), quantity)
                          : scale_text(text, quantity);
  if (scaled.complaint.empty() && !std::isfinite(scaled.si)) scaled.complaint = "is not finite";
  return scaled;
}

}  // namespace servomill::sim::config
