#include "sim/config/reading_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <exception>
#include <iterator>
#include <utility>

namespace servomill::sim::config {
namespace {

constexpr std::size_t kLongestShown = 60;  // characters of a value in a message

std::string shown(const Value& value) {
  if (value.type == Value::Type::table) return "{...}";
  std::string text = inline_toml(value);
  if (text.size() <= kLongestShown && text.find('\n') == std::string::npos) return text;
  return value.type == Value::Type::list ? "[...]" : "\"...\"";
}

// "; did you mean ..." for an unknown key of a table, or nothing.
// @param known  the names that the table may have
std::string nearest_of(std::string_view word, const Value& table,
                       const std::vector<std::string>& known) {
  // "length" for "length_mm"
  const std::string with_unit = std::string(word) + "_";
  for (const std::string& name : known) {
    if (name.starts_with(with_unit) && table.find(name) == nullptr) {
      return fmt::format("; did you mean '{}'?", name);
    }
  }
  std::vector<std::string_view> absent, given;
  for (const std::string& name : known) {
    (table.find(name) == nullptr ? absent : given).emplace_back(name);
  }
  std::string missing = did_you_mean(word, absent);
  if (!missing.empty()) return missing;
  const std::string_view near = nearest_name(word, given);
  const bool is_a_letter = near.size() == 1;  // of another axis
  return near.empty() || is_a_letter
             ? std::string()
             : fmt::format("; did you mean '{}', which is also given?", near);
}

}  // namespace

ReadingRecord::~ReadingRecord() { assert(finished_ || std::uncaught_exceptions() > 0); }

void ReadingRecord::know(const Value& table, std::string_view key) {
  auto& known = tables_[&table].known;
  if (std::find(known.begin(), known.end(), key) == known.end()) known.emplace_back(key);
}

void ReadingRecord::fault(Place place, std::string message) {
  faults_.push_back({std::move(place), std::move(message)});
}

void ReadingRecord::fault(const Value& value, const std::string& name, std::string_view rule) {
  fault(value.place, fmt::format("{} = {}; {}", name, shown(value), rule));
}

void ReadingRecord::report_unread(const Value& value) {
  if (value.type == Value::Type::list) {
    for (const Value& item : value.children) report_unread(item);
  }
  const auto at = tables_.find(&value);
  if (at == tables_.end()) return;
  const Table& table = at->second;
  for (const Value& entry : value.children) {
    const bool known =
        std::find(table.known.begin(), table.known.end(), entry.key) != table.known.end();
    if (table.read.contains(entry.key)) {
      report_unread(entry);
    } else if (!table.rest_is_skipped) {
      fault(entry.key_place,
            fmt::format("{} {}", joined_key(table.path, entry.key),
                        known ? "is not used here"
                              : "is not known" + nearest_of(entry.key, value, table.known)));
    }
  }
}

// Files stay in the order of their first fault; within a file lines ascend.
std::vector<Fault> ReadingRecord::faults_by_file() {
  std::vector<Fault> sorted;
  while (!faults_.empty()) {
    const std::string file = faults_.front().place.file;
    const auto rest = std::stable_partition(
        faults_.begin(), faults_.end(), [&file](const Fault& f) { return f.place.file == file; });
    std::move(faults_.begin(), rest, std::back_inserter(sorted));
    faults_.erase(faults_.begin(), rest);
  }
  return sorted;
}

void ReadingRecord::finish() {
  finished_ = true;
  report_unread(document_.root());
  if (!faults_.empty()) throw InputError(faults_by_file());
}

}  // namespace servomill::sim::config
