#include "sim/config/parse_toml.h"

#define TOML_HEADER_ONLY 0
#include <toml++/toml.h>

#include <algorithm>
#include <utility>

namespace servomill::sim::config {
namespace {

constexpr bool continues_a_character(char c) {
  return (static_cast<unsigned char>(c) & 0xC0) == 0x80;
}

// The text between places of the library, which counts columns in UTF-8 characters.
class Source {
 public:
  Source(std::string_view text, std::string name) : text_(text), name_(std::move(name)) {
    lines_.push_back(0);
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '\n') lines_.push_back(i + 1);
    }
  }

  Place place(const toml::source_region& region) const { return place(region.begin); }
  // If the text ends early, the library reports a position beyond the end of its line.
  Place place(const toml::source_position& position) const {
    if (position.line == 0 || position.line > lines_.size()) return {name_};
    const auto column = std::min<std::size_t>(position.column, characters(position.line) + 1);
    return {name_, static_cast<int>(position.line), static_cast<int>(column)};
  }
  std::string written(const toml::source_region& region) const {
    const std::size_t begin = offset(region.begin);
    return std::string(text_.substr(begin, offset(region.end) - begin));
  }

 private:
  // of a line (counted from 1), without its end
  std::size_t characters(std::size_t line) const {
    const std::string_view rest = text_.substr(lines_[line - 1]);
    const std::string_view text = rest.substr(0, rest.find('\n'));
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return !continues_a_character(c); }));
  }

  std::size_t offset(const toml::source_position& position) const {
    std::size_t at = lines_[position.line - 1];
    for (toml::source_index column = 1; column < position.column; ++column) {
      do ++at;
      while (at < text_.size() && continues_a_character(text_[at]));
    }
    return at;
  }

  std::string_view text_;
  std::string name_;
  std::vector<std::size_t> lines_;  // offset at which each begins
};

Value convert(const toml::node& node, const Source& source);

std::pair<int, int> position(const Place& place) { return {place.line, place.column}; }

void convert_table(Value& out, const toml::table& table, const Source& source) {
  for (const auto& [key, node] : table) {
    Value entry = convert(node, source);
    entry.key = key.str();
    entry.key_place = source.place(key.source());
    out.children.push_back(std::move(entry));
  }
  // the library sorts by name, we keep the order of the document
  std::stable_sort(out.children.begin(), out.children.end(), [](const Value& a, const Value& b) {
    return position(a.key_place) < position(b.key_place);
  });
}

Value convert(const toml::node& node, const Source& source) {
  Value out;
  out.place = source.place(node.source());
  if (const auto* table = node.as_table()) {
    out.type = Value::Type::table;
    convert_table(out, *table, source);
    return out;
  }
  if (const auto* list = node.as_array()) {
    out.type = Value::Type::list;
    for (const toml::node& item : *list) out.children.push_back(convert(item, source));
    return out;
  }
  out.written = source.written(node.source());
  if (const auto* text = node.as_string()) {
    out.type = Value::Type::text;
    out.text = text->get();
  } else if (const auto* integer = node.as_integer()) {
    out.type = Value::Type::integer;
    out.integer = integer->get();
  } else if (const auto* real = node.as_floating_point()) {
    out.type = Value::Type::real;
    out.real = real->get();
  } else if (const auto* boolean = node.as_boolean()) {
    out.type = Value::Type::boolean;
    out.boolean = boolean->get();
  } else {
    out.type = Value::Type::date_time;
  }
  return out;
}

std::string complaint(std::string_view description) {
  constexpr std::string_view kPrefix = "Error while parsing ";
  if (description.starts_with(kPrefix)) description.remove_prefix(kPrefix.size());
  return "not TOML: " + std::string(description);
}

}  // namespace

Value parse_toml(std::string_view text, const std::string& name) {
  const Source source(text, name);
  try {
    return convert(toml::parse(text, std::string_view(name)), source);
  } catch (const toml::parse_error& error) {
    throw InputError(source.place(error.source()), complaint(error.description()));
  }
}

}  // namespace servomill::sim::config
