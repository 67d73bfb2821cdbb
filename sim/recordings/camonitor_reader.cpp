#include "sim/recordings/camonitor_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "plant/vocabulary/progress.h"
#include "sim/recordings/checked_rows.h"
#include "sim/system/counted.h"

namespace servomill::sim::recordings {
namespace {

constexpr std::string_view kMessage = "***";
constexpr std::string_view kUndefined = "<undefined>";

// Digits of a text as a whole number.
std::optional<int> digits(std::string_view text) {
  int out = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), out);
  if (fault != std::errc() || end != text.data() + text.size() || text.front() == '-') return {};
  return out;
}

// Nanoseconds from 1970 of "2024-03-01" and "10:00:00.250000"; nothing if these are none.
std::optional<std::int64_t> instant(std::string_view date, std::string_view time) {
  if (date.starts_with('(')) date.remove_prefix(1);
  if (time.ends_with(')')) time.remove_suffix(1);
  if (date.size() != 10 || time.size() < 8 || time.size() > 18) return {};
  if (date[4] != '-' || date[7] != '-' || time[2] != ':' || time[5] != ':') return {};
  const auto year = digits(date.substr(0, 4)), month = digits(date.substr(5, 2)),
             day = digits(date.substr(8, 2));
  const auto hours = digits(time.substr(0, 2)), minutes = digits(time.substr(3, 2)),
             seconds = digits(time.substr(6, 2));
  if (!year || !month || !day || !hours || !minutes || !seconds) return {};
  namespace ch = std::chrono;
  const ch::year_month_day all{ch::year{*year}, ch::month{static_cast<unsigned>(*month)},
                               ch::day{static_cast<unsigned>(*day)}};
  if (!all.ok() || *year < 1970 || *year > 2200 || *hours > 23 || *minutes > 59 || *seconds > 60) {
    return {};
  }
  std::int64_t fraction = 0;
  if (time.size() > 8) {
    if (time[8] != '.') return {};
    std::string nine(time.substr(9));
    nine.resize(9, '0');
    const auto value = digits(nine);
    if (!value) return {};
    fraction = *value;
  }
  const std::int64_t days = ch::sys_days{all}.time_since_epoch().count();
  return ((days * 24 + *hours) * 60 + *minutes) * 60'000'000'000 +
         *seconds * std::int64_t{1'000'000'000} + fraction;
}

bool is_update(const std::vector<Field>& fields) {
  return fields.size() >= 4 && instant(fields[1].text, fields[2].text).has_value();
}

bool is_severity(std::string_view word) {
  constexpr std::array<std::string_view, 4> kSeverities = {"NO_ALARM", "MINOR", "MAJOR", "INVALID"};
  return std::find(kSeverities.begin(), kSeverities.end(), word) != kSeverities.end();
}

// A process variable while it is read.
struct Variable {
  std::string name;
  std::vector<double> samples;
  Base base;
  std::size_t alarms = 0, repeated = 0, undefined = 0;
  bool is_scalar = true;
};

class Monitor {
 public:
  explicit Monitor(const std::string& file) { out_.file = file; }

  void read(const TextLine& line) {
    if (line.text.find(kMessage) != std::string_view::npos) {
      ++messages_;
      return;
    }
    const auto fields = split_fields(line.text, ' ');
    const Place place{out_.file, line.number};
    if (fields.size() >= 2 && fields[1].text == kUndefined) {
      ++variable(as_utf8(fields[0].text)).undefined;
      return;
    }
    if (fields.size() < 4)
      throw InputError(place, "is not a line of variable, date, time and value");
    const auto now = instant(fields[1].text, fields[2].text);
    if (!now) {
      throw InputError({out_.file, line.number, fields[1].column},
                       fmt::format("'{} {}' is not a date and time", as_utf8(fields[1].text),
                                   as_utf8(fields[2].text)));
    }
    if (!zero_) {
      zero_ = *now;
      zero_text_ = as_utf8(fields[1].text) + " " + as_utf8(fields[2].text);
    }
    take(fields, static_cast<double>(*now - *zero_) / 1e9, place);
  }

  Recording finished() {
    out_.format = "camonitor of EPICS";
    for (Variable& one : variables_) {
      if (one.undefined > 0) {
        note(one, system::counted(one.undefined, "line") + " without a time: skipped");
      }
      if (!one.is_scalar) {
        note(one, "a text or an array: skipped");
        continue;
      }
      if (one.alarms > 0) note(one, system::counted(one.alarms, "sample") + " with an alarm");
      if (one.repeated > 0) note(one, system::counted(one.repeated, "line") + " repeated");
      if (one.samples.empty()) continue;
      const std::size_t base = shared_base(out_, std::move(one.base));
      out_.channels.push_back({std::move(one.name), "", std::move(one.samples), base});
    }
    if (messages_ > 0) {
      out_.notes.push_back(system::counted(messages_, "message") +
                           " of lost or missing connections (***): values may be missing there");
    }
    if (zero_) out_.notes.push_back("time 0 is " + zero_text_);
    return std::move(out_);
  }

 private:
  Variable& variable(const std::string& name) {
    const auto [found, is_new] = index_.try_emplace(name, variables_.size());
    if (is_new) {
      variables_.emplace_back();
      variables_.back().name = name;
    }
    return variables_[found->second];
  }

  void note(const Variable& one, const std::string& text) {
    out_.notes.push_back(fmt::format("'{}': {}", one.name, text));
  }

  void take(const std::vector<Field>& fields, double seconds, const Place& place) {
    Variable& one = variable(as_utf8(fields[0].text));
    const bool has_alarm = fields.size() == 6 && is_severity(fields[5].text);
    const char decimal = decimal_of(fields[3].text);
    const bool is_number = parse_number(fields[3].text, decimal).has_value();
    if (one.samples.empty() && (!is_number || (fields.size() > 4 && !has_alarm))) {
      one.is_scalar = false;
    }
    if (!one.is_scalar) return;
    const double value = checked_number(fields[3], decimal, place);
    if (fields.size() > 4 && !has_alarm) {
      throw InputError({place.file, place.line, fields[4].column},
                       fmt::format("'{}' after the value is not a status with severity",
                                   as_utf8(fields[4].text)));
    }
    if (!one.samples.empty() && seconds == one.base.values.back() && value == one.samples.back()) {
      ++one.repeated;
      return;
    }
    append_time(one.base, seconds, place);
    one.samples.push_back(value);
    if (has_alarm) ++one.alarms;
  }

  Recording out_;
  std::vector<Variable> variables_;
  std::map<std::string, std::size_t> index_;
  std::optional<std::int64_t> zero_;
  std::string zero_text_;
  std::size_t messages_ = 0;
};

}  // namespace

bool is_camonitor(std::string_view text) {
  constexpr std::size_t kExamined = 20;  // lines; more of them may be messages
  const std::vector<TextLine> lines = text_lines(text.substr(0, 8192));
  std::size_t updates = 0;
  for (std::size_t i = 0; i < std::min(lines.size(), kExamined); ++i) {
    const auto fields = split_fields(lines[i].text, ' ');
    if (is_update(fields)) {
      ++updates;
    } else if (updates == 0 && lines[i].text.find(kMessage) == std::string_view::npos &&
               lines[i].text.find(kUndefined) == std::string_view::npos) {
      return false;
    }
  }
  return updates > 0;
}

Recording parse_camonitor(std::string_view text, const std::string& file) {
  const std::vector<TextLine> lines = text_lines(text);
  if (!lines.empty() && !text.ends_with('\n')) {
    throw InputError({file, lines.back().number}, "the file ends within a line: it is truncated");
  }
  Monitor monitor(file);
  Stage stage("lines", static_cast<double>(lines.size()));
  for (const TextLine& line : lines) {
    monitor.read(line);
    stage.advance();
  }
  Recording out = monitor.finished();
  check(out);
  return out;
}

}  // namespace servomill::sim::recordings
