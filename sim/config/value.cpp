#include "sim/config/value.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace servomill::sim::config {
namespace {

bool same_entries(const Value& a, const Value& b) {
  return a.children.size() == b.children.size() &&
         std::all_of(a.children.begin(), a.children.end(), [&b](const Value& entry) {
           const Value* other = b.find(entry.key);
           return other != nullptr && same_value(entry, *other);
         });
}

bool is_list_of_tables(const Value& value) {
  return value.type == Value::Type::list && !value.children.empty() &&
         std::all_of(value.children.begin(), value.children.end(),
                     [](const Value& item) { return item.type == Value::Type::table; });
}

bool has_header(const Value& value) {
  return value.type == Value::Type::table || is_list_of_tables(value);
}

bool is_bare(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-';
}

void append_key(std::string& out, std::string_view key) {
  const bool bare = !key.empty() && std::all_of(key.begin(), key.end(), is_bare);
  out += bare ? key : quoted_text(key);
}

void append_inline(std::string& out, const Value& value) {
  if (value.type != Value::Type::list && value.type != Value::Type::table) {
    out += value.written;
    return;
  }
  const bool is_table = value.type == Value::Type::table;
  out += !is_table ? "[" : value.children.empty() ? "{" : "{ ";
  bool first = true;
  for (const Value& child : value.children) {
    if (!first) out += ", ";
    first = false;
    if (is_table) {
      append_key(out, child.key);
      out += " = ";
    }
    append_inline(out, child);
  }
  out += !is_table ? "]" : value.children.empty() ? "}" : " }";
}

void write_table(std::string& out, const Value& table, const std::string& path) {
  // what belongs to the table itself must stand before the first header
  for (const Value& entry : table.children) {
    if (has_header(entry)) continue;
    append_key(out, entry.key);
    out += " = ";
    append_inline(out, entry);
    out += '\n';
  }
  for (const Value& entry : table.children) {
    if (!has_header(entry)) continue;
    const std::string name = joined_key(path, entry.key);
    if (entry.type == Value::Type::table) {
      out += "\n[" + name + "]\n";
      write_table(out, entry, name);
    } else {
      for (const Value& item : entry.children) {
        out += "\n[[" + name + "]]\n";
        write_table(out, item, name);
      }
    }
  }
}

}  // namespace

const Value* Value::find(std::string_view name) const {
  if (type != Type::table) return nullptr;
  const auto at = std::find_if(children.begin(), children.end(),
                               [name](const Value& entry) { return entry.key == name; });
  return at == children.end() ? nullptr : &*at;
}

Value* Value::find(std::string_view name) {
  return const_cast<Value*>(static_cast<const Value*>(this)->find(name));
}

bool same_value(const Value& a, const Value& b) {
  if (a.type != b.type) return false;
  switch (a.type) {
    case Value::Type::text:
      return a.text == b.text;
    case Value::Type::integer:
      return a.integer == b.integer;
    case Value::Type::boolean:
      return a.boolean == b.boolean;
    case Value::Type::date_time:
      return a.written == b.written;
    case Value::Type::table:
      return same_entries(a, b);
    case Value::Type::real:  // by bits: nan is itself, -0.0 is not 0.0
      return std::bit_cast<std::uint64_t>(a.real) == std::bit_cast<std::uint64_t>(b.real);
    case Value::Type::list:
      return std::equal(a.children.begin(), a.children.end(), b.children.begin(), b.children.end(),
                        same_value);
  }
  return false;
}

std::string_view type_name(Value::Type type) {
  switch (type) {
    case Value::Type::text:
      return "a string";
    case Value::Type::integer:
      return "an integer";
    case Value::Type::real:
      return "a number";
    case Value::Type::boolean:
      return "a boolean";
    case Value::Type::date_time:
      return "a date or time";
    case Value::Type::list:
      return "a list";
    case Value::Type::table:
      return "a table";
  }
  return "";
}

std::string inline_toml(const Value& value) {
  std::string out;
  append_inline(out, value);
  return out;
}

std::string to_toml(const Value& table) {
  std::string out;
  write_table(out, table, "");
  return out;
}

std::string quoted_key(std::string_view key) {
  std::string out;
  append_key(out, key);
  return out;
}

std::string quoted_text(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (code < 0x20 || code == 0x7f) {
      out += fmt::format("\\u{:04X}", code);
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string joined_key(std::string_view path, std::string_view key) {
  std::string out(path);
  if (!out.empty()) out += '.';
  append_key(out, key);
  return out;
}

}  // namespace servomill::sim::config
