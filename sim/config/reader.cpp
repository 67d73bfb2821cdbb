#include "sim/config/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "sim/config/key_log.h"

namespace servomill::sim {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();  // a default that is none
constexpr std::size_t kLongestShown = 60;  // characters of a value in a message

bool holds(const Rule& rule, double value) {
  switch (rule.comparison) {
    case Rule::Comparison::above:
      return value > rule.bound;
    case Rule::Comparison::at_least:
      return value >= rule.bound;
    case Rule::Comparison::below:
      return value < rule.bound;
    case Rule::Comparison::at_most:
      return value <= rule.bound;
  }
  return false;
}

bool all_hold(Rules rules, double value) {
  return std::isfinite(value) && std::all_of(rules.begin(), rules.end(), [value](const Rule& rule) {
           return holds(rule, value);
         });
}

// "must be > 0 and <= 500 um": bounds in the unit that the user wrote the value in
std::string sentence(Rules rules, double value, const Unit& unit, bool name_unit) {
  if (!std::isfinite(value)) return "must be finite";
  std::string out;
  for (const Rule& rule : rules) {
    out += fmt::format("{}{} {:.12g}", out.empty() ? "must be " : " and ",
                       symbol_of(rule.comparison), rule.bound / unit.factor);
    if (name_unit && rule.bound != 0.0) out += " " + unit.symbol;
  }
  return out;
}

std::string shown(const Value& value) {
  if (value.type == Value::Type::table) return "{...}";
  std::string text = inline_toml(value);
  if (text.size() <= kLongestShown && text.find('\n') == std::string::npos) return text;
  return value.type == Value::Type::list ? "[...]" : "\"...\"";
}

}  // namespace

std::string_view symbol_of(Rule::Comparison comparison) {
  switch (comparison) {
    case Rule::Comparison::above:
      return ">";
    case Rule::Comparison::at_least:
      return ">=";
    case Rule::Comparison::below:
      return "<";
    case Rule::Comparison::at_most:
      return "<=";
  }
  return "";
}

// Faults and read keys of one document.
struct Reader::State {
  explicit State(const Document& document_in) : document(document_in) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { assert(finished || std::uncaught_exceptions() > 0); }

  struct Table {
    std::string path;
    std::vector<std::string> known;  // names asked for, in the order of asking
    std::set<std::string, std::less<>> read;
    bool rest_is_skipped = false;
  };

  void know(const Value* table, std::string_view key) {
    auto& known = tables[table].known;
    if (std::find(known.begin(), known.end(), key) == known.end()) known.emplace_back(key);
  }
  void report_unread(const Value& table);
  std::vector<Fault> faults_by_file();

  const Document& document;
  Value nothing;  // an empty table, for those that are absent
  std::vector<Fault> faults;
  std::map<const Value*, Table> tables;
  bool finished = false;
};

void Reader::State::report_unread(const Value& value) {
  if (value.type == Value::Type::list) {
    for (const Value& item : value.children) report_unread(item);
  }
  const auto at = tables.find(&value);
  if (at == tables.end()) return;
  const Table& table = at->second;
  const auto nearest_of = [&](std::string_view word) {
    std::vector<std::string_view> absent, given;
    for (const std::string& name : table.known) {
      (value.find(name) == nullptr ? absent : given).emplace_back(name);
    }
    const std::string missing = did_you_mean(word, absent);
    if (!missing.empty()) return missing;
    const std::string_view near = nearest_name(word, given);
    const bool is_a_letter = near.size() == 1;  // of another axis
    return near.empty() || is_a_letter
               ? std::string()
               : fmt::format("; did you mean '{}', which is given, too?", near);
  };
  for (const Value& entry : value.children) {
    const bool known =
        std::find(table.known.begin(), table.known.end(), entry.key) != table.known.end();
    if (table.read.contains(entry.key)) {
      report_unread(entry);
    } else if (!table.rest_is_skipped) {
      faults.push_back(
          {entry.key_place,
           fmt::format("{} {}", joined_key(table.path, entry.key),
                       known ? "is not used here" : "is not known" + nearest_of(entry.key))});
    }
  }
}

// Files stay in the order of their first fault; within a file lines ascend.
std::vector<Fault> Reader::State::faults_by_file() {
  std::vector<Fault> sorted;
  while (!faults.empty()) {
    const std::string file = faults.front().place.file;
    const auto rest = std::stable_partition(
        faults.begin(), faults.end(), [&file](const Fault& f) { return f.place.file == file; });
    std::move(faults.begin(), rest, std::back_inserter(sorted));
    faults.erase(faults.begin(), rest);
  }
  return sorted;
}

Reader::Reader(const Document& document)
    : state_(std::make_shared<State>(document)), table_(&document.root()), silent_(false) {
  state_->tables[table_];
}

Reader::Reader(std::shared_ptr<State> state, const Value* table, std::string path, bool silent)
    : state_(std::move(state)), table_(table), path_(std::move(path)), silent_(silent) {
  if (!silent_) state_->tables[table_].path = path_;
}

bool Reader::logs() const { return !silent_ && state_->document.key_log() != nullptr; }

void Reader::log(std::string_view key, KeyUse use) const {
  use.table = without_items(path_);
  use.key = key;
  state_->document.key_log()->add(std::move(use));
}

const Value* Reader::find(std::string_view key) {
  if (silent_) return nullptr;
  state_->know(table_, key);
  const Value* value = table_->find(key);
  if (value != nullptr) state_->tables[table_].read.emplace(key);
  return value;
}

void Reader::missing(std::string_view key) {
  if (silent_) return;
  state_->faults.push_back({own_place(), joined_key(path_, key) + " is missing"});
}

void Reader::note(const Value& value, const std::string& name, std::string_view rule) {
  state_->faults.push_back({value.place, fmt::format("{} = {}; {}", name, shown(value), rule)});
}

void Reader::check_type(const Value*& value, std::string_view key, Value::Type type) {
  if (value == nullptr || value->type == type) return;
  const std::string name = joined_key(path_, key);
  std::string rule = fmt::format("must be {}", type_name(type));
  if (type == Value::Type::list && value->type == Value::Type::table) {
    rule += fmt::format("; write [[{}]] for an item that is a table", name);
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
    if (!example.empty()) scaled.complaint += fmt::format(" or a text such as \"3 {}\"", example);
  }

  if (scaled.complaint.empty() && !all_hold(rules, scaled.si)) {
    const bool name_unit = !scaled.unit.symbol.empty() && (from_text || !from_key);
    scaled.complaint = sentence(rules, scaled.si, scaled.unit, name_unit);
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
  note(value, joined_key(path_, key), sentence(rules, 0.0, Unit{}, false));
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
      note(item, name_of(key, out.size()), "must be a text");
    }
    out.push_back(item.text);
  }
  return out;
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
  return {state_, &state_->nothing, joined_key(path_, key), true};
}

Reader Reader::table(std::string_view key) {
  if (logs()) log(key, required_request(KeyType::table));
  const Value* value = require(key, Value::Type::table);
  return value == nullptr ? silent_reader(key)
                          : Reader(state_, value, joined_key(path_, key), false);
}

Reader Reader::table_or_empty(std::string_view key) {
  if (logs()) log(key, optional_request(KeyType::table, ""));
  const bool absent = !silent_ && !has(key);
  const Value* value = optional(key, Value::Type::table);
  if (absent) return {state_, &state_->nothing, joined_key(path_, key), false};
  return value == nullptr ? silent_reader(key)
                          : Reader(state_, value, joined_key(path_, key), false);
}

std::vector<Reader> Reader::readers(const Value& list, std::string_view key) {
  std::vector<Reader> out;
  for (const Value& item : list.children) {
    const std::string name = name_of(key, out.size());
    const bool is_table = item.type == Value::Type::table;
    if (!is_table) note(item, name, "must be a table");
    out.push_back({state_, is_table ? &item : &state_->nothing, name, !is_table});
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
  state_->know(table_, key);
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
  state_->faults.push_back({own_place(), text});
}

void Reader::skip_rest() {
  assert(silent_ || faults() > 0);
  if (!silent_) state_->tables[table_].rest_is_skipped = true;
}

std::size_t Reader::faults() const { return state_->faults.size(); }

Place Reader::place(std::string_view key) const {
  const Value* value = table_->find(key);
  return value != nullptr ? value->place : own_place();
}

// The root has no line of its own, and what is absent has no place at all.
Place Reader::own_place() const {
  const bool whole_document = path_.empty() || table_->place.file.empty();
  return whole_document ? Place{state_->document.name()} : table_->place;
}

void Reader::finish() {
  state_->finished = true;
  state_->report_unread(state_->document.root());
  if (!state_->faults.empty()) throw InputError(state_->faults_by_file());
}

}  // namespace servomill::sim
