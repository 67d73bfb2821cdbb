#include "sim/input/drawn_errors.h"

#include <algorithm>

#include "plant/vocabulary/input_error.h"
#include "sim/input/machine_document.h"
#include "sim/input/scenario_document.h"

namespace servomill::sim::input {
namespace {

using config::Value;

constexpr std::string_view kErrors = "errors.";

// Value behind several names; nullptr where one of them is missing.
const Value* at_path(const Value& root, std::initializer_list<std::string_view> names) {
  const Value* value = &root;
  for (const std::string_view name : names) {
    if (value->type != Value::Type::table) return nullptr;
    value = value->find(name);
    if (value == nullptr) return nullptr;
  }
  return value;
}

std::vector<std::string> texts_of(const Value* value) {
  std::vector<std::string> out;
  if (value == nullptr) return out;
  if (value->type == Value::Type::text) return {value->text};
  for (const Value& one : value->children) out.push_back(one.text);
  return out;
}

// Keys that samples are drawn of, of the files or of the table in a complete document.
std::vector<std::string> identified_keys(const Value& samples, InputFiles& files) {
  std::vector<std::string> out;
  const auto add = [&out](const std::vector<std::string>& keys) {
    out.insert(out.end(), keys.begin(), keys.end());
  };
  if (const Value* tables = samples.find("identified")) {
    for (const Value& one : tables->children) add(texts_of(one.find("keys")));
    return out;
  }
  const Value* from = samples.find("from");
  for (const std::string& name : texts_of(from)) {
    try {
      const auto machine = machine_document(beside(from->place, name), files, from->place);
      if (machine.identified) add(machine.identified->keys);
    } catch (const InputError&) {
      return {};
    }
  }
  return out;
}

// { errors = { MODEL = copy } }
Value as_errors(Value copy, const std::string& model) {
  copy.key = model;
  Value errors;
  errors.key = "errors";
  errors.place = copy.place;
  errors.children.push_back(std::move(copy));
  Value machine;
  machine.place = errors.place;
  machine.children.push_back(std::move(errors));
  return machine;
}

}  // namespace

std::vector<std::string> models_of_keys(const std::vector<std::string>& keys) {
  std::vector<std::string> out;
  for (const std::string& key : keys) {
    if (!key.starts_with(kErrors)) continue;
    const std::size_t end = std::min(key.find('.', kErrors.size()), key.size());
    const std::string model = key.substr(kErrors.size(), end - kErrors.size());
    if (std::find(out.begin(), out.end(), model) == out.end()) out.push_back(model);
  }
  return out;
}

std::string key_in_model(const std::string& key, const std::string& model) {
  if (!key.starts_with(kErrors)) return key;
  const std::size_t end = std::min(key.find('.', kErrors.size()), key.size());
  return std::string(kErrors) + model + key.substr(end);
}

void add_drawn_errors(config::Document& document, InputFiles& files) {
  const Value* samples = at_path(document.root(), {"sweep", "samples"});
  if (samples == nullptr || samples->type != Value::Type::table) return;
  const Value* into = samples->find("into");
  if (into == nullptr || into->type != Value::Type::text || into->text.empty()) return;
  const std::string name = into->text;
  if (at_path(document.root(), {"machine", "errors", name}) != nullptr) return;
  const std::vector<std::string> models = models_of_keys(identified_keys(*samples, files));
  if (models.size() != 1) return;
  const Value* model = at_path(document.root(), {"machine", "errors", models.front()});
  if (model != nullptr) document.merge(as_machine(as_errors(*model, name)));
}

}  // namespace servomill::sim::input
