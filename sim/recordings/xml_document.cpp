#include "sim/recordings/xml_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/input_error.h"
#include "sim/recordings/delimited_text.h"

namespace servomill::sim::recordings {

bool is_xml(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text.substr(first, 1) == "<";
}

XmlDocument::XmlDocument(std::string_view text, const std::string& file)
    : text_(text), file_(file) {
  const pugi::xml_parse_result result = document_.load_buffer(text_.data(), text_.size());
  if (result.status != pugi::status_ok) {
    fail_at(result.offset, fmt::format("is not complete XML: {}", result.description()));
  }
}

std::vector<pugi::xml_node> XmlDocument::all(const char* name) const {
  std::vector<pugi::xml_node> out;
  for (const pugi::xml_node node : document_.children(name)) out.push_back(node);
  for (const pugi::xml_node root : document_.children()) {
    for (const pugi::xml_node node : root.children(name)) out.push_back(node);
  }
  return out;
}

void XmlDocument::fail_at(std::ptrdiff_t offset, const std::string& message) const {
  const auto end = text_.begin() +
                   std::clamp<std::ptrdiff_t>(offset, 0, static_cast<std::ptrdiff_t>(text_.size()));
  throw InputError({file_, 1 + static_cast<int>(std::count(text_.begin(), end, '\n'))}, message);
}

void XmlDocument::fail(pugi::xml_node node, const std::string& message) const {
  fail_at(node.offset_debug(), fmt::format("<{}>: {}", node.name(), message));
}

double XmlDocument::number(pugi::xml_node node, const std::string& what) const {
  if (!node) throw InputError({file_}, fmt::format("has no element '{}'", what));
  const auto value = parse_number(node.child_value(), '.');
  if (value && std::isfinite(*value)) return *value;
  fail(node, fmt::format("'{}' is '{}', which is not a number", what, as_utf8(node.child_value())));
}

}  // namespace servomill::sim::recordings
