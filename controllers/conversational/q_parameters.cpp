#include "controllers/conversational/q_parameters.h"

#include <fmt/format.h>

#include <charconv>

namespace servomill::controllers::conversational {

std::string to_string(const QName& name) {
  return name.kind == 'Q' ? fmt::format("Q{}", name.number)
                          : fmt::format("Q{}{}", name.kind, name.number);
}

// Numbers 0 to 1999: TNC 640 (34059x-05) p. 631; QL and QR 0 to 499.
std::optional<QName> q_name_at(std::string_view text, std::size_t& length) {
  if (text.empty() || text.front() != 'Q') return std::nullopt;
  QName name;
  std::size_t at = 1;
  if (at < text.size() && (text[at] == 'L' || text[at] == 'R')) name.kind = text[at++];
  const char* begin = text.data() + at;
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), name.number);
  if (error != std::errc() || *begin == '-') return std::nullopt;
  if (name.number > (name.kind == 'Q' ? 1999 : 499)) return std::nullopt;
  length = static_cast<std::size_t>(end - text.data());
  return name;
}

std::optional<double> QParameters::find(const QName& name) const {
  const auto found = values_.find({name.kind, name.number});
  if (found == values_.end()) return std::nullopt;
  return found->second;
}

double QParameters::get(const QName& name, const Place& place) const {
  if (const auto value = find(name)) return *value;
  const auto unknown = unknown_.find({name.kind, name.number});
  if (unknown != unknown_.end()) {
    throw InputError(place, fmt::format("{} {} and is unknown here; assign it in the program",
                                        to_string(name), unknown->second));
  }
  throw InputError(place, fmt::format("{0} is not defined: the control would use the value from an "
                                      "earlier program; assign it, or pass --parameter {0}=NUMBER",
                                      to_string(name)));
}

}  // namespace servomill::controllers::conversational
