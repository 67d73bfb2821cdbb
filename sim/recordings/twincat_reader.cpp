#include "sim/recordings/twincat_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "plant/vocabulary/progress.h"
#include "sim/recordings/checked_rows.h"
#include "sim/recordings/survey.h"
#include "sim/system/counted.h"

namespace servomill::sim::recordings {
namespace {

constexpr std::size_t kHead = 1 << 20;  // bytes, and
constexpr std::size_t kExamined = 400;  // lines that the head may have
constexpr std::string_view kEnd = "EOF";

// The key that opens a line and its separator, as in "Name;X;Name;Y".
std::optional<char> separator_behind(std::string_view line, std::string_view key) {
  if (!line.starts_with(key) || line.size() <= key.size()) return {};
  const char sign = line[key.size()];
  if (sign == '\t' || sign == ';' || sign == ',') return sign;
  return {};
}

// Head of an export: where columns of time lie, and where rows begin.
struct Head {
  char separator = ';', decimal = '.';
  std::vector<std::size_t> times;                    // columns
  std::map<std::string, std::vector<Field>> values;  // of a key, all columns
  std::size_t columns = 0;
  std::size_t first = 0;  // index of the first row in the lines
};

// True for a row: numbers or empty fields, one number at least.
bool is_row(const std::vector<Field>& fields) {
  bool any = false;
  for (const Field& field : fields) {
    if (!parse_number(field.text, '.') && !parse_number(field.text, ',')) return false;
    any = any || !field.text.empty();
  }
  return any && fields.size() >= 2;
}

void drop_empty_end(std::vector<Field>& fields) {
  while (!fields.empty() && fields.back().text.empty()) fields.pop_back();
}

// Columns of time: wherever the key of the line is repeated.
std::vector<std::size_t> times_of(const std::vector<Field>& fields, std::string_view key) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (fields[i].text == key) out.push_back(i);
  }
  return out;
}

std::optional<Head> head_of(const std::vector<TextLine>& lines) {
  Head out;
  std::optional<char> separator;
  for (std::size_t i = 0; i < std::min(lines.size(), kExamined); ++i) {
    for (const std::string_view key : {"Name", "SymbolName"}) {
      if (const auto sign = separator_behind(lines[i].text, key)) separator = sign;
    }
    if (!separator) continue;
    auto fields = split_fields(lines[i].text, *separator);
    if (is_row(fields)) {
      out.first = i;
      break;
    }
    drop_empty_end(fields);
    if (!fields.empty()) out.values[std::string(fields[0].text)] = fields;
  }
  if (out.first == 0) return {};
  out.separator = *separator;
  for (const char* key : {"Name", "SymbolName"}) {
    const auto found = out.values.find(key);
    if (found == out.values.end() || found->second.size() < 2) continue;
    out.times = times_of(found->second, key);
    out.columns = found->second.size();
  }
  // the separator is no decimal sign; in rows of numbers the comma is otherwise
  for (std::size_t i = out.first; i < std::min(lines.size(), out.first + kExamined); ++i) {
    for (const Field& field : split_fields(lines[i].text, out.separator)) {
      if (out.separator != ',' && out.decimal == '.') out.decimal = decimal_of(field.text);
    }
  }
  // "Name;Project" alone above a table is no head of columns
  if (split_fields(lines[out.first].text, out.separator).size() < out.columns) return {};
  return out.columns < 2 ? std::nullopt : std::optional(out);
}

// A group of columns: its time and channels.
struct Group {
  std::size_t time = 0, end = 0;  // columns
  Base base;
  std::vector<Channel> channels;
  std::size_t repeated = 0;
};

class ScopeExport {
 public:
  ScopeExport(const std::vector<TextLine>& lines, Head head, const std::string& file)
      : lines_(lines), head_(std::move(head)) {
    out_.file = file;
    out_.format = "TwinCAT Scope";
  }

  Recording read() {
    for (std::size_t g = 0; g < head_.times.size(); ++g) {
      Group group;
      group.time = head_.times[g];
      group.end = g + 1 < head_.times.size() ? head_.times[g + 1] : head_.columns;
      for (std::size_t c = group.time + 1; c < group.end; ++c) {
        group.channels.push_back({name_of(c), unit_of(c), {}, 0});
      }
      groups_.push_back(std::move(group));
    }
    Stage stage("lines", static_cast<double>(lines_.size()));
    for (std::size_t i = head_.first; i < lines_.size(); ++i) {
      stage.reach(static_cast<double>(i));
      if (lines_[i].text.starts_with(kEnd)) break;
      read_row(lines_[i]);
    }
    return finished();
  }

 private:
  std::string cell(const char* key, std::size_t column) const {
    const auto found = head_.values.find(key);
    if (found == head_.values.end() || column >= found->second.size()) return "";
    return as_utf8(found->second[column].text);
  }

  std::string name_of(std::size_t column) const {
    for (const char* key : {"SymbolName", "Name"}) {
      if (std::string name = cell(key, column); !name.empty()) return name;
    }
    return fmt::format("column {}", column + 1);
  }

  std::string unit_of(std::size_t column) const {
    const std::string unit = cell("Unit", column);
    return unit == "(None)" || unit == "None" || unit == "-" ? "" : unit;
  }

  void read_row(const TextLine& line) {
    auto fields = split_fields(line.text, head_.separator);
    const Place place{out_.file, line.number};
    if (fields.size() > head_.columns) {
      drop_empty_end(fields);
      if (fields.size() > head_.columns) {
        throw InputError(place,
                         fmt::format("{} in a table of {}", system::counted(fields.size(), "field"),
                                     system::counted(head_.columns, "column")));
      }
    }
    for (Group& group : groups_) read_group(group, fields, place);
  }

  void read_group(Group& group, const std::vector<Field>& fields, const Place& place) {
    if (group.time >= fields.size()) return;  // a slower one has ended
    std::vector<double> values;
    bool any = false;
    for (std::size_t c = group.time; c < std::min(group.end, fields.size()); ++c) {
      values.push_back(checked_number(fields[c], head_.decimal, place));
      any = any || !std::isnan(values.back());
    }
    if (!any) return;
    if (fields.size() < group.end) {
      throw InputError(place, fmt::format("{} in a table of {}: the row is truncated",
                                          system::counted(fields.size(), "field"),
                                          system::counted(head_.columns, "column")));
    }
    const double seconds = values[0] / 1e3;
    if (!group.base.values.empty() && seconds == group.base.values.back() &&
        repeats(group, values)) {
      ++group.repeated;
      return;
    }
    append_time(group.base, seconds, {place.file, place.line, fields[group.time].column});
    for (std::size_t c = 0; c < group.channels.size(); ++c) {
      group.channels[c].samples.push_back(values[c + 1]);
    }
  }

  static bool repeats(const Group& group, const std::vector<double>& values) {
    for (std::size_t c = 0; c < group.channels.size(); ++c) {
      const double last = group.channels[c].samples.back();
      if (last != values[c + 1] && !(std::isnan(last) && std::isnan(values[c + 1]))) return false;
    }
    return true;
  }

  // The declared sampling time against the one of the column.
  void compare_interval(const Group& group) {
    const std::string text = cell("SampleTime[ms]", group.time + 1);
    const auto declared = parse_number(text, decimal_of(text));
    const double step = interval(group.base) * 1e3;
    if (text.empty() || !declared || !(step > 0.0) || std::abs(step - *declared) < 0.01 * step) {
      return;
    }
    out_.notes.push_back(
        fmt::format("the time of '{}' advances by {:.6g} ms per sample, its SampleTime is {} ms",
                    group.channels[0].name, step, text));
  }

  Recording finished() {
    for (Group& group : groups_) {
      if (group.channels.empty()) continue;
      compare_interval(group);
      if (group.repeated > 0) {
        out_.notes.push_back(fmt::format("'{}': {} repeated by the export, taken once",
                                         group.channels[0].name,
                                         system::counted(group.repeated, "row")));
      }
      const std::size_t base = shared_base(out_, std::move(group.base));
      for (Channel& channel : group.channels) {
        channel.base = base;
        out_.channels.push_back(std::move(channel));
      }
    }
    return std::move(out_);
  }

  const std::vector<TextLine>& lines_;
  Head head_;
  std::vector<Group> groups_;
  Recording out_;
};

}  // namespace

bool is_twincat(std::string_view text) {
  const std::vector<TextLine> lines = text_lines(text.substr(0, kHead));
  return head_of(lines).has_value();
}

Recording parse_twincat(std::string_view text, const std::string& file) {
  const std::vector<TextLine> lines = text_lines(text);
  std::optional<Head> head = head_of(lines);
  if (!head) throw InputError({file}, "contains no row of numbers under a line 'Name'");
  Recording out = ScopeExport(lines, std::move(*head), file).read();
  check(out);
  return out;
}

}  // namespace servomill::sim::recordings
