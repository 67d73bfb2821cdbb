#include "sim/config/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <limits>
#include <optional>
#include <utility>

#include "sim/config/key_log.h"
#include "sim/config/reading_record.h"

namespace servomill::sim::config {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();  // a default that is none

}  // namespace

Reader::Reader(const Document& document)
    : record_(std::make_shared<ReadingRecord>(document)), table_(&document.root()), silent_(false) {
  record_->open(*table_, "");
}

Reader::Reader(std::shared_ptr<ReadingRecord> record, const Value* table, std::string path,
               bool silent)
    : record_(std::move(record)), table_(table), path_(std::move(path)), silent_(silent) {
  if (!silent_) record_->open(*table_, path_);
}

bool Reader::logs() const { return !silent_ && record_->document().key_log() != nullptr; }

void Reader::log(std::string_view key, KeyUse use) const {
  use.table = without_items(path_);
  use.key = key;
  record_->document().key_log()->add(std::move(use));
}

const Value* Reader::find(std::string_view key) {
  if (silent_) return nullptr;
  record_->know(*table_, key);
  const Value* value = table_->find(key);
  if (value != nullptr) record_->read(*table_, key);
  return value;
}

void Reader::missing(std::string_view key) {
  if (silent_) return;
  record_->fault(own_place(), joined_key(path_, key) + " is missing");
}

void Reader::note(const Value& value, const std::string& name, std::string_view rule) {
  record_->fault(value, name, rule);
}

void Reader::check_type(const Value*& value, std::string_view key, Value::Type type) {
  if (value == nullptr || value->type == type) return;
  const std::string name = joined_key(path_, key);
  std::string rule = fmt::format("must be {}", type_name(type));
  if (type == Value::Type::list && value->type == Value::Type::table) {
    rule += fmt::format("; write [[{}]] for each table", without_items(name));
  }
  note(*value, name, rule);
  value = nullptr;
}

const Value* Reader::optional(std::string_view key, Value::Type type) {
  const Value* value = find(key);
  check_type(value, key, type);
  return value;
}

const Value* Reader::require(std::string_view key, Value::Type type) {
  const Value* value = find(key);
  if (value == nullptr) missing(key);
  check_type(value, key, type);
  return value;
}

// "path.key" or, for an item of its list, "path.key[2]"
std::string Reader::name_of(std::string_view key, std::optional<std::size_t> item) const {
  const std::string name = joined_key(path_, key);
  return item ? fmt::format("{}[{}]", name, *item) : name;
}

double Reader::number(const Value& value, std::string_view key, std::optional<std::size_t> item,
                      Quantity quantity, Rules rules) {
  ScaledText scaled;
  const bool from_text = value.type == Value::Type::text && quantity != kNumber;
  const std::optional<Unit> from_key = unit_of_key(key, quantity);
  if (from_text) {
    scaled = scale_text(value.text, quantity);
  } else if (value.type == Value::Type::real || value.type == Value::Type::integer) {
    scaled.unit = from_key.value_or(Unit{si_unit(quantity), quantity, 1.0});
    scaled.si = scaled.unit.factor *
                (value.type == Value::Type::real ? value.real : static_cast<double>(value.integer));
  } else {
    const std::string example = example_unit(quantity);
    scaled.complaint = "must be a number";
    if (!example.empty()) scaled.complaint += fmt::format(" or a string such as \"3 {}\"", example);
  }

  if (scaled.complaint.empty() && !all_hold(rules, scaled.si)) {
    const bool name_unit = !scaled.unit.symbol.empty() && (from_text || !from_key);
    scaled.complaint = requirement(rules, scaled.si, scaled.unit, name_unit);
  }
  if (scaled.complaint.empty()) return scaled.si;
  note(value, name_of(key, item), scaled.complaint);
  return 0.0;
}

double Reader::real(std::string_view key, Quantity quantity, Rules rules) {
  if (logs()) log(key, number_request(KeyType::number, key, quantity, rules, {}));
  const Value* value = find(key);
  if (value != nullptr) return number(*value, key, {}, quantity, rules);
  missing(key);
  return 0.0;
}

double Reader::real_or(std::string_view key, double fallback, Quantity quantity, Rules rules) {
  if (logs()) log(key, number_request(KeyType::number, key, quantity, rules, fallback));
  const Value* value = find(key);
  return value == nullptr ? fallback : number(*value, key, {}, quantity, rules);
}

std::int64_t Reader::whole(const Value& value, std::string_view key, Rules rules) {
  if (all_hold(rules, static_cast<double>(value.integer))) return value.integer;
  note(value, joined_key(path_, key), requirement(rules, 0.0, Unit{}, false));
  return 0;
}

std::int64_t Reader::integer(std::string_view key, Rules rules) {
  if (logs()) log(key, integer_request(rules, {}));
  const Value* value = require(key, Value::Type::integer);
  return value == nullptr ? 0 : whole(*value, key, rules);
}

std::int64_t Reader::integer_or(std::string_view key, std::int64_t fallback, Rules rules) {
  if (logs()) log(key, integer_request(rules, fallback));
  const Value* value = optional(key, Value::Type::integer);
  return value == nullptr ? fallback : whole(*value, key, rules);
}

bool Reader::boolean(std::string_view key) {
  if (logs()) log(key, required_request(KeyType::boolean));
  const Value* value = require(key, Value::Type::boolean);
  return value != nullptr && value->boolean;
}

bool Reader::boolean_or(std::string_view key, bool fallback) {
  if (logs()) log(key, optional_request(KeyType::boolean, fallback ? "true" : "false"));
  const Value* value = optional(key, Value::Type::boolean);
  return value == nullptr ? fallback : value->boolean;
}

std::string Reader::text(std::string_view key) {
  if (logs()) log(key, required_request(KeyType::text));
  const Value* value = require(key, Value::Type::text);
  return value == nullptr ? std::string() : value->text;
}

std::string Reader::text_or(std::string_view key, std::string_view fallback) {
  if (logs()) log(key, optional_request(KeyType::text, fallback));
  const Value* value = optional(key, Value::Type::text);
  return value == nullptr ? std::string(fallback) : value->text;
}

std::size_t Reader::named(const Value& value, std::string_view key,
                          std::span<const std::string_view> names) {
  const auto at = std::find(names.begin(), names.end(), value.text);
  if (at != names.end()) return static_cast<std::size_t>(at - names.begin());
  note(value, joined_key(path_, key),
       fmt::format("must be one of {}{}", fmt::join(names, ", "), did_you_mean(value.text, names)));
  return 0;
}

std::size_t Reader::choice(std::string_view key, std::span<const std::string_view> names) {
  if (logs()) log(key, choice_request(names, {}));
  const Value* value = require(key, Value::Type::text);
  return value == nullptr ? 0 : named(*value, key, names);
}

std::size_t Reader::choice_or(std::string_view key, std::size_t fallback,
                              std::span<const std::string_view> names) {
  if (logs()) log(key, choice_request(names, fallback));
  const Value* value = optional(key, Value::Type::text);
  return value == nullptr ? fallback : named(*value, key, names);
}

std::vector<double> Reader::numbers(const Value& list, std::string_view key, Quantity quantity,
                                    Rules rules) {
  std::vector<double> out;
  for (const Value& item : list.children) {
    out.push_back(number(item, key, out.size(), quantity, rules));
  }
  return out;
}

std::vector<double> Reader::reals(std::string_view key, Quantity quantity, Rules rules) {
  if (logs()) log(key, number_request(KeyType::numbers, key, quantity, rules, {}));
  const Value* list = require(key, Value::Type::list);
  return list == nullptr ? std::vector<double>{} : numbers(*list, key, quantity, rules);
}

std::vector<double> Reader::reals_or(std::string_view key, std::vector<double> fallback,
                                     Quantity quantity, Rules rules) {
  if (logs()) log(key, number_request(KeyType::numbers, key, quantity, rules, kNone));
  const Value* list = optional(key, Value::Type::list);
  return list == nullptr ? std::move(fallback) : numbers(*list, key, quantity, rules);
}

std::vector<std::string> Reader::strings(const Value& list, std::string_view key) {
  std::vector<std::string> out;
  for (const Value& item : list.children) {
    if (item.type != Value::Type::text) {
      note(item, name_of(key, out.size()), "must be a string");
    }
    out.push_back(item.text);
  }
  return out;
}

std::vector<std::vector<double>> Reader::rows(std::string_view key) {
  if (logs()) log(key, required_request(KeyType::rows));
  const Value* list = require(key, Value::Type::list);
  std::vector<std::vector<double>> out;
  if (list == nullptr) return out;
  for (std::size_t i = 0; i < list->children.size(); ++i) {
    const Value& row = list->children[i];
    if (row.type != Value::Type::list) note(row, name_of(key, i), "must be a list of numbers");
    std::vector<double>& numbers = out.emplace_back();
    for (const Value& item : row.children) {
      numbers.push_back(item.type == Value::Type::integer ? static_cast<double>(item.integer)
                                                          : item.real);
      const bool is_number = item.type == Value::Type::integer || item.type == Value::Type::real;
      if (is_number && std::isfinite(numbers.back())) continue;
      note(item, fmt::format("{}[{}]", name_of(key, i), numbers.size() - 1),
           "must be a finite number");
    }
  }
  return out;
}

namespace {

bool append_nested(const Value& value, std::span<const std::size_t> shape,
                   std::vector<double>& out) {
  if (shape.empty()) {
    const bool is_integer = value.type == Value::Type::integer;
    out.push_back(is_integer ? static_cast<double>(value.integer) : value.real);
    return (is_integer || value.type == Value::Type::real) && std::isfinite(out.back());
  }
  return value.type == Value::Type::list && value.children.size() == shape.front() &&
         std::all_of(value.children.begin(), value.children.end(), [&](const Value& child) {
           return append_nested(child, shape.subspan(1), out);
         });
}

// "3 lists of 4 lists of 2 numbers"
std::string shape_text(std::span<const std::size_t> shape) {
  std::string text;
  for (std::size_t k = 0; k < shape.size(); ++k) {
    text += fmt::format("{}{} {}", k == 0 ? "" : " of ", shape[k],
                        k + 1 == shape.size() ? "finite numbers" : "lists");
  }
  return text;
}

}  // namespace

std::vector<double> Reader::nested(std::string_view key, std::span<const std::size_t> shape) {
  if (logs()) log(key, required_request(KeyType::rows));
  const Value* list = require(key, Value::Type::list);
  std::vector<double> out;
  // a shape that follows from another key, which has a fault, is not known
  const bool is_known = std::count(shape.begin(), shape.end(), std::size_t{0}) == 0;
  if (shape.empty() || !is_known) return {};
  if (list == nullptr || append_nested(*list, shape, out)) return out;
  note(*list, joined_key(path_, key), fmt::format("must consist of {}", shape_text(shape)));
  return {};
}

std::vector<std::string> Reader::texts(std::string_view key) {
  if (logs()) log(key, required_request(KeyType::texts));
  const Value* list = require(key, Value::Type::list);
  return list == nullptr ? std::vector<std::string>{} : strings(*list, key);
}

std::vector<std::string> Reader::texts_or(std::string_view key, std::vector<std::string> fallback) {
  if (logs()) log(key, optional_request(KeyType::texts, ""));
  const Value* list = optional(key, Value::Type::list);
  return list == nullptr ? std::move(fallback) : strings(*list, key);
}

Reader Reader::silent_reader(std::string_view key) const {
  return {record_, &record_->nothing(), joined_key(path_, key), true};
}

Reader Reader::table(std::string_view key) {
  if (logs()) log(key, required_request(KeyType::table));
  const Value* value = require(key, Value::Type::table);
  return value == nullptr ? silent_reader(key)
                          : Reader(record_, value, joined_key(path_, key), false);
}

Reader Reader::table_or_empty(std::string_view key) {
  if (logs()) log(key, optional_request(KeyType::table, ""));
  const bool absent = !silent_ && !has(key);
  const Value* value = optional(key, Value::Type::table);
  if (absent) return {record_, &record_->nothing(), joined_key(path_, key), false};
  return value == nullptr ? silent_reader(key)
                          : Reader(record_, value, joined_key(path_, key), false);
}

std::vector<Reader> Reader::readers(const Value& list, std::string_view key) {
  std::vector<Reader> out;
  for (const Value& item : list.children) {
    const std::string name = name_of(key, out.size());
    const bool is_table = item.type == Value::Type::table;
    if (!is_table) note(item, name, "must be a table");
    out.push_back({record_, is_table ? &item : &record_->nothing(), name, !is_table});
  }
  return out;
}

std::vector<Reader> Reader::tables(std::string_view key) {
  if (logs()) log(key, required_request(KeyType::tables));
  const Value* list = require(key, Value::Type::list);
  if (list == nullptr) return {};
  if (list->children.empty()) note(*list, joined_key(path_, key), "must have at least one item");
  return readers(*list, key);
}

std::vector<Reader> Reader::tables_or_none(std::string_view key) {
  if (logs()) log(key, optional_request(KeyType::tables, ""));
  const Value* list = optional(key, Value::Type::list);
  return list == nullptr ? std::vector<Reader>{} : readers(*list, key);
}

bool Reader::has(std::string_view key) {
  if (logs()) log(key, optional_request(KeyType::asked, ""));
  if (silent_) return false;
  record_->know(*table_, key);
  return table_->find(key) != nullptr;
}

bool Reader::is(std::string_view key, Value::Type type) {
  return has(key) && table_->find(key)->type == type;
}

std::vector<std::string> Reader::keys() const {
  std::vector<std::string> out;
  for (const Value& entry : table_->children) out.push_back(entry.key);
  return out;
}

const Value* Reader::raw(std::string_view key) {
  if (logs()) log(key, optional_request(KeyType::asked, ""));
  return find(key);
}

void Reader::fault(std::string_view key, std::string_view rule) {
  if (silent_) return;
  const Value* value = table_->find(key);
  assert(value != nullptr);
  note(*value, joined_key(path_, key), rule);
}

void Reader::fault(std::string_view message) {
  if (silent_) return;
  const std::string text =
      path_.empty() ? std::string(message) : fmt::format("{}: {}", path_, message);
  record_->fault(own_place(), text);
}

void Reader::skip_rest() {
  assert(silent_ || faults() > 0);
  if (!silent_) record_->skip_rest(*table_);
}

std::size_t Reader::faults() const { return record_->faults(); }

Place Reader::place(std::string_view key) const {
  const Value* value = table_->find(key);
  return value != nullptr ? value->place : own_place();
}

// The root has no line of its own, and what is absent has no place at all.
Place Reader::own_place() const {
  const bool whole_document = path_.empty() || table_->place.file.empty();
  return whole_document ? Place{record_->document().name()} : table_->place;
}

void Reader::finish() { record_->finish(); }

}  // namespace servomill::sim::config
