#include "controllers/siemens/variables.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "controllers/siemens/scanner.h"

namespace servomill::controllers::siemens {
namespace {

constexpr std::size_t kMaxElements = 100'000;

[[noreturn]] void refuse(const Place& place, std::string message) {
  throw InputError(place, std::move(message));
}

constexpr auto kTypes = std::to_array<std::pair<std::string_view, Type>>({
    {"REAL", Type::real},
    {"INT", Type::integer},
    {"BOOL", Type::boolean},
    {"CHAR", Type::character},
    {"STRING", Type::text},
    {"AXIS", Type::axis},
});

// Names of the kinds of machining of CYCLE832: [C] "High Speed Settings"; values from memory.
constexpr auto kConstants = std::to_array<std::pair<std::string_view, double>>({
    {"_OFF", 0.0},
    {"_FINISH", 1.0},
    {"_SEMIFIN", 2.0},
    {"_ROUGH", 3.0},
    {"_PRECISION", 4.0},
    {"_ORI_FINISH", 11.0},
    {"_ORI_SEMIFIN", 12.0},
    {"_ORI_ROUGH", 13.0},
    {"_ORI_PRECISION", 14.0},
});

// INT takes the nearest integer of a REAL: Job Planning, "Type conversion".
Value converted(Type type, const Value& value, const Reference& reference) {
  const bool wants_text = type == Type::text || type == Type::axis;
  if (wants_text != value.text.has_value()) {
    refuse(reference.place,
           fmt::format("{} must be a {}", to_string(reference),
                       wants_text ? "string, not a number" : "number, not a string"));
  }
  if (type == Type::integer || type == Type::character) return {std::round(value.number)};
  if (type == Type::boolean) return {value.number != 0.0 ? 1.0 : 0.0};
  return value;
}

}  // namespace

std::optional<Type> type_named(std::string_view name) {
  for (const auto& [known, type] : kTypes) {
    if (known == name) return type;
  }
  return std::nullopt;
}

std::string to_string(const Reference& reference) {
  if (reference.indices.empty()) return reference.name;
  if (reference.name == "R") return fmt::format("R{}", reference.indices.front());
  return fmt::format("{}[{}]", reference.name, fmt::join(reference.indices, ","));
}

Variables::Variables(const std::map<std::string, double>& given) : local_(1) {
  for (const auto& [name, value] : given) {
    const std::string key = capitals(name);
    int number = 0;
    const char* end = key.data() + key.size();
    const bool is_R = key.size() > 1 && key.front() == 'R' &&
                      std::from_chars(key.data() + 1, end, number).ptr == end;
    if (is_R) {
      R_[number] = {value};
    } else {
      given_[key] = value;
    }
  }
}

std::optional<double> Variables::given(const std::string& name) const {
  const auto found = given_.find(name);
  return found == given_.end() ? std::nullopt : std::optional(found->second);
}

const Variables::Variable* Variables::find(std::string_view name) const {
  const auto found = local_.back().find(name);
  return found == local_.back().end() ? nullptr : &found->second;
}

bool Variables::is_known(std::string_view name) const {
  return name == "R" || name.starts_with('$') || find(name) != nullptr;
}

void Variables::define(const std::string& name, Type type, const std::vector<int>& sizes,
                       const Place& place) {
  if (find(name) != nullptr) refuse(place, fmt::format("{} is defined twice", name));
  std::size_t elements = 1;
  for (const int size : sizes) {
    if (size < 1) refuse(place, fmt::format("{}: the array size must be at least 1", name));
    elements *= static_cast<std::size_t>(size);
    if (elements > kMaxElements) {
      refuse(place, fmt::format("{}: an array may have at most {} elements", name, kMaxElements));
    }
  }
  Value initial;
  if (type == Type::text || type == Type::axis) initial.text = "";
  local_.back()[name] = {type, sizes, std::vector<Value>(elements, initial)};
}

std::size_t Variables::element(const Variable& variable, const Reference& reference) const {
  if (variable.sizes.size() != reference.indices.size()) {
    refuse(reference.place,
           fmt::format("{} requires {} indices", reference.name, variable.sizes.size()));
  }
  std::size_t at = 0;
  for (std::size_t i = 0; i < variable.sizes.size(); ++i) {
    const int index = reference.indices[i];
    if (index < 0 || index >= variable.sizes[i]) {
      refuse(reference.place, fmt::format("{}: the index must be from 0 to {}",
                                          to_string(reference), variable.sizes[i] - 1));
    }
    at = at * static_cast<std::size_t>(variable.sizes[i]) + static_cast<std::size_t>(index);
  }
  return at;
}

Value Variables::get(const Reference& reference) const {
  if (reference.name == "R") {
    const int number = reference.indices.empty() ? 0 : reference.indices.front();
    if (const auto found = R_.find(number); found != R_.end()) {
      return known(reference, found->second);
    }
    refuse(reference.place,
           fmt::format("R{0} is not defined: the control would use the value from an earlier "
                       "program; assign it, or pass --parameter R{0}=NUMBER",
                       number));
  }
  if (const Variable* variable = find(reference.name)) {
    return known(reference, variable->values[element(*variable, reference)]);
  }
  const std::string name = to_string(reference);
  if (const auto value = given(name)) return {*value};
  for (const auto& [constant, value] : kConstants) {
    if (constant == name) return {value};
  }
  if (name.starts_with('$')) {
    refuse(reference.place,
           fmt::format(
               "{0} is a control variable with an unknown value; pass --parameter '{0}=NUMBER'",
               name));
  }
  refuse(reference.place,
         fmt::format(
             "{} is not defined: DEF is missing, or it is a machine variable with an unknown value",
             reference.name));
}

double Variables::number(const Reference& reference) const {
  const Value value = get(reference);
  if (value.text)
    refuse(reference.place, fmt::format("{} is a string, not a number", to_string(reference)));
  return value.number;
}

void Variables::set(const Reference& reference, const Value& value) {
  if (reference.name == "R") {
    if (value.text) refuse(reference.place, "an R parameter must be a number, not a string");
    R_[reference.indices.empty() ? 0 : reference.indices.front()] = {value.number};
    return;
  }
  const Variable* variable = find(reference.name);
  if (variable == nullptr) {
    refuse(reference.place, fmt::format("{} is not defined", reference.name));
  }
  set_element(reference, element(*variable, reference), value);
}

const Value& Variables::known(const Reference& reference, const Value& value) {
  if (value.unknown_because == nullptr) return value;
  refuse(reference.place, fmt::format("{} {}; assign it before reading it", to_string(reference),
                                      value.unknown_because));
}

void Variables::forget(const Reference& reference, const char* why) {
  Value value = get(reference);
  value.unknown_because = why;
  if (reference.name == "R") {
    R_[reference.indices.front()] = value;
  } else {
    Variable& variable = local_.back().find(reference.name)->second;
    variable.values[element(variable, reference)] = value;
  }
}

std::size_t Variables::size(const Reference& reference) const {
  const Variable* variable = find(reference.name);
  return variable != nullptr ? variable->values.size() : 1;
}

void Variables::set_element(const Reference& reference, std::size_t at, const Value& value) {
  Variable& variable = local_.back().find(reference.name)->second;
  if (at >= variable.values.size()) {
    refuse(reference.place, fmt::format("{} has {} elements, but more values are assigned",
                                        reference.name, variable.values.size()));
  }
  variable.values[at] = converted(variable.type, value, reference);
}

}  // namespace servomill::controllers::siemens
