#include "sim/config/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

#include "sim/config/parse_toml.h"
#include "sim/system/read_file.h"

namespace servomill::sim::config {
namespace {

// One step of a path: a name, or an item in brackets. A bare number may be either.
struct Step {
  std::string name;
  bool in_brackets = false;
};

std::optional<std::size_t> as_index(std::string_view digits) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
  if (error != std::errc{} || end != digits.data() + digits.size()) return std::nullopt;
  return index;
}

// Reads KEY up to the '=' that ends it.
class PathParser {
 public:
  PathParser(std::string_view text, const Place& place) : rest_(text), place_(place) {}

  std::vector<Step> parse() {
    std::vector<Step> steps = {name()};
    while (!rest_.empty() && rest_.front() != '=') {
      if (rest_.front() == '[') {
        steps.push_back(index());
      } else if (rest_.front() == '.') {
        rest_.remove_prefix(1);
        steps.push_back(name());
      } else {
        fail(fmt::format("unexpected '{}' after '{}'", rest_.front(), steps.back().name));
      }
    }
    if (rest_.empty()) fail("no '='; write KEY=VALUE");
    rest_.remove_prefix(1);
    return steps;
  }
  std::string_view rest() const { return rest_; }

 private:
  [[noreturn]] void fail(std::string message) const {
    throw InputError(place_, std::move(message));
  }

  std::string_view take(std::size_t count) {
    const std::string_view taken = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return taken;
  }

  Step name() {
    if (!rest_.empty() && (rest_.front() == '"' || rest_.front() == '\'')) {
      const std::size_t end = rest_.find(rest_.front(), 1);
      if (end == std::string_view::npos) fail("a quote in the key is not closed");
      const std::string_view quoted = take(end + 1);
      return {std::string(quoted.substr(1, quoted.size() - 2))};
    }
    const std::string_view word = take(std::min(rest_.find_first_of(".[=\"' "), rest_.size()));
    if (word.empty()) fail("a name is missing in the key");
    return {std::string(word)};
  }

  Step index() {
    const std::size_t end = rest_.find(']');
    if (end == std::string_view::npos) fail("']' is missing in the key");
    const std::string_view bracket = take(end + 1);
    const std::string_view digits = bracket.substr(1, bracket.size() - 2);
    if (!as_index(digits)) fail(fmt::format("'{}' is not a list index; use a number", bracket));
    return {std::string(digits), true};
  }

  std::string_view rest_;
  const Place& place_;
};

std::string shown(const std::string& path, const Step& step) {
  return step.in_brackets ? fmt::format("{}[{}]", path, step.name) : joined_key(path, step.name);
}

void replace(Value& old, Value by) {
  by.key = std::move(old.key);
  old = std::move(by);
}

// Name of an item in a list of tables; its type if it has none.
std::string_view name_of(const Value& item) {
  if (item.type != Value::Type::table) return {};
  for (const std::string_view key : {"name", "type"}) {
    const Value* value = item.find(key);
    if (value != nullptr && value->type == Value::Type::text) return value->text;
  }
  return {};
}

Value& entry_of(Value& table, const Step& step, const Place& place) {
  if (Value* known = table.find(step.name)) return *known;
  Value entry;
  entry.key = step.name;
  entry.key_place = entry.place = place;
  return table.children.emplace_back(std::move(entry));
}

// An item of a list of tables by its name; of a list of one, what the item has under that name.
Value& named_item(Value& list, const Step& step, const std::string& path, const Place& place) {
  const auto is_called = [&](const Value& item) { return name_of(item) == step.name; };
  auto& items = list.children;
  const auto item = std::find_if(items.begin(), items.end(), is_called);
  if (item != items.end()) {
    if (std::find_if(item + 1, items.end(), is_called) == items.end()) return *item;
    throw InputError(
        place, fmt::format("{} has several items called '{}'; use an index, such as {}[{}]", path,
                           step.name, path, item - items.begin()));
  }
  if (items.size() == 1 && items[0].type == Value::Type::table) {
    return entry_of(items[0], step, place);
  }
  std::vector<std::string_view> names;
  for (const Value& one : items) {
    if (!name_of(one).empty()) names.push_back(name_of(one));
  }
  throw InputError(place, fmt::format("{} is a list without an item '{}'{}", path, step.name,
                                      did_you_mean(step.name, names)));
}

Value& item_of(Value& list, const Step& step, const std::string& path, const Place& place) {
  const std::optional<std::size_t> index = as_index(step.name);
  if (!index) return named_item(list, step, path, place);
  if (*index >= list.children.size()) {
    throw InputError(place, fmt::format("{} is out of range; the list has {} items, counted from 0",
                                        shown(path, step), list.children.size()));
  }
  return list.children[*index];
}

Value& descend(Value& from, const Step& step, const std::string& path, const Place& place) {
  if (from.type == Value::Type::list) return item_of(from, step, path, place);
  if (from.type == Value::Type::table && !step.in_brackets) return entry_of(from, step, place);
  throw InputError(place, fmt::format("{} is {}; it has no '{}'", path, type_name(from.type),
                                      step.in_brackets ? "[" + step.name + "]" : step.name));
}

void move_to(Value& value, const Place& place) {
  value.place = place;
  if (!value.key.empty()) value.key_place = place;
  for (Value& child : value.children) move_to(child, place);
}

Value text_value(std::string_view text) {
  Value value;
  value.type = Value::Type::text;
  value.text = text;
  value.written = quoted_text(text);
  return value;
}

// A TOML value if `text` is exactly one, or a text. What follows the value on its line makes sure
// that a comment or a comma behind it is not dropped without a word.
Value value_of(std::string_view text, const Place& place) {
  Value value = text_value(text);
  if (text.find_first_of("\n\r") == std::string_view::npos) {
    try {
      Value parsed = parse_toml(fmt::format("value = [{}, true]", text), "");
      Value& list = parsed.children.at(0);
      if (list.children.size() == 2) value = std::move(list.children[0]);
    } catch (const InputError&) {
      // then it is a text
    }
  }
  move_to(value, place);
  return value;
}

void merge_table(Value& base, const Value& overriding) {
  for (const Value& entry : overriding.children) {
    Value* old = base.find(entry.key);
    if (old == nullptr) {
      base.children.push_back(entry);
    } else if (old->type == Value::Type::table && entry.type == Value::Type::table) {
      merge_table(*old, entry);
    } else {
      *old = entry;
    }
  }
}

}  // namespace

Document::Document(std::string name, Value root) : name_(std::move(name)), root_(std::move(root)) {}

Document Document::from_file(const std::string& path) {
  return from_text(system::read_file(path, {}, "scenario", kMaxBytesOfDocument), path);
}

Document Document::from_text(std::string_view text, const std::string& name) {
  return {name, parse_toml(text, name)};
}

void Document::set(std::string_view assignment) {
  const Place place{fmt::format("--set {}", assignment)};
  PathParser parser(assignment, place);
  const std::vector<Step> steps = parser.parse();
  if (parser.rest().empty()) throw InputError(place, "no value after '='; an empty string is \"\"");
  Value value = value_of(parser.rest(), place);

  // A fault leaves the document as it was: what is missing on the way is made after all that can
  // be wrong but an index into something new.
  std::optional<Value> before;
  if (std::any_of(steps.begin(), steps.end(), [](const Step& one) { return one.in_brackets; })) {
    before = root_;
  }
  Value* at = &root_;
  std::string path;
  try {
    for (const Step& step : steps) {
      at = &descend(*at, step, path, place);
      path = at->key.empty() ? fmt::format("{}[{}]", path, step.name) : shown(path, step);
    }
  } catch (const InputError&) {
    if (before) root_ = std::move(*before);
    throw;
  }
  value.key_place = place;
  replace(*at, std::move(value));
}

void Document::merge(const Value& overriding) { merge_table(root_, overriding); }

std::string Document::to_toml() const { return config::to_toml(root_); }

}  // namespace servomill::sim::config
