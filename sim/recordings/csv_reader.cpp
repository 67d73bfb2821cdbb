#include "sim/recordings/csv_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/progress.h"
#include "sim/recordings/delimited_text.h"
#include "sim/system/counted.h"

namespace servomill::sim::recordings {
namespace {

constexpr std::size_t kExamined = 200;  // lines that the layout is recognised from
constexpr std::size_t kMaxColumns = 4096;

// Reading of a text as a table, and where its rows begin.
struct Layout {
  char separator = ',', decimal = '.';
  std::size_t columns = 0;
  std::size_t first = 0;  // index of the first row in the lines
  std::size_t rows = 0;   // among the lines examined
  bool names_fit = false;
};

bool is_comment(std::string_view line) {
  const auto at = line.find_first_not_of(" \t");
  const std::string_view text = line.substr(at == std::string_view::npos ? line.size() : at);
  return text.starts_with('#') || text.starts_with('%') || text.starts_with("//");
}

std::string_view without_comment_sign(std::string_view line) {
  const auto at = line.find_first_not_of("#%/ \t");
  return at == std::string_view::npos ? std::string_view() : line.substr(at);
}

// True for a row of which every field is a number or empty, and one is a number.
bool is_row(const std::vector<Field>& fields, char decimal) {
  bool any = false;
  for (const Field& field : fields) {
    const auto number = parse_number(field.text, decimal);
    if (!number) return false;
    any = any || !field.text.empty();
  }
  return any;
}

// True where a field is no number.
bool has_word(const std::vector<Field>& fields, char decimal) {
  return std::any_of(fields.begin(), fields.end(),
                     [&](const Field& field) { return !parse_number(field.text, decimal); });
}

// The layout of the lines under the assumption of these signs.
Layout assumed(const std::vector<TextLine>& lines, char separator, char decimal) {
  Layout out;
  out.separator = separator;
  out.decimal = decimal;
  const std::size_t end = std::min(lines.size(), kExamined);
  for (std::size_t i = 0; i < end; ++i) {
    if (is_comment(lines[i].text)) continue;
    const auto fields = split_fields(lines[i].text, separator);
    if (!is_row(fields, decimal)) continue;
    if (out.rows == 0) {
      out.first = i;
      out.columns = fields.size();
    }
    if (fields.size() == out.columns) ++out.rows;
  }
  if (out.rows == 0 || out.first == 0) return out;
  const auto names = split_fields(without_comment_sign(lines[out.first - 1].text), separator);
  out.names_fit = names.size() == out.columns && has_word(names, decimal);
  return out;
}

std::optional<Layout> recognised(const std::vector<TextLine>& lines) {
  constexpr std::array<std::pair<char, char>, 7> kSigns = {
      {{';', '.'}, {';', ','}, {'\t', '.'}, {'\t', ','}, {',', '.'}, {' ', '.'}, {' ', ','}}};
  Layout best;
  const auto rank = [](const Layout& one) {
    return std::tuple(one.rows, one.names_fit, one.columns);
  };
  for (const auto& [separator, decimal] : kSigns) {
    const Layout one = assumed(lines, separator, decimal);
    if (rank(one) > rank(best)) best = one;
  }
  if (best.rows == 0) return {};
  return best;
}

std::string sign_name(char sign) {
  if (sign == '\t') return "tab";
  if (sign == ' ') return "blank";
  return fmt::format("'{}'", sign);
}

// A table while it is read.
class Table {
 public:
  Table(std::string file, const std::vector<TextLine>& lines, const Layout& layout)
      : file_(std::move(file)), lines_(lines), layout_(layout) {}

  Recording read(bool ends_with_line_end) {
    if (layout_.columns > kMaxColumns) {
      fail(lines_[layout_.first], 0, fmt::format("more than {} columns", kMaxColumns));
    }
    read_headings();
    refuse_same_names();
    columns_.resize(layout_.columns);
    Stage stage("lines", static_cast<double>(lines_.size()));
    for (std::size_t i = layout_.first; i < lines_.size(); ++i) {
      stage.reach(static_cast<double>(i));
      if (is_comment(lines_[i].text)) continue;
      read_row(lines_[i], i + 1 == lines_.size() && !ends_with_line_end);
    }
    return finished();
  }

 private:
  [[noreturn]] void fail(const TextLine& line, int column, const std::string& message) const {
    throw InputError({file_, line.number, column}, message);
  }

  std::vector<Field> fields_of(const TextLine& line) const {
    const std::string_view text =
        is_comment(line.text) ? without_comment_sign(line.text) : line.text;
    std::vector<Field> out = split_fields(text, layout_.separator);
    for (Field& field : out) field.column += static_cast<int>(text.data() - line.text.data());
    return out;
  }

  // Names and units from the line above the first row, or from the two lines above it.
  void read_headings() {
    for (std::size_t i = 0; i < layout_.columns; ++i) {
      headings_.push_back({fmt::format("column {}", i + 1), ""});
    }
    if (layout_.first == 0) return;
    const TextLine& above = lines_[layout_.first - 1];
    const auto fields = fields_of(above);
    if (fields.size() != layout_.columns) return;
    refuse_broken_row(above, fields);
    heading_line_ = &above;
    if (layout_.first >= 2 && are_units(fields)) {
      const TextLine& higher = lines_[layout_.first - 2];
      const auto names = fields_of(higher);
      if (names.size() == layout_.columns && has_word(names, layout_.decimal)) {
        heading_line_ = &higher;
        take_names(names);
        for (std::size_t i = 0; i < fields.size(); ++i) headings_[i].unit = unit_of(fields[i].text);
        return;
      }
    }
    take_names(fields);
  }

  void take_names(const std::vector<Field>& fields) {
    for (std::size_t i = 0; i < fields.size(); ++i) {
      name_columns_.push_back(fields[i].column);
      if (!fields[i].text.empty())
        headings_[i] = heading_with_suffix(parse_heading(fields[i].text));
    }
  }

  static std::string unit_of(std::string_view text) {
    if (text.size() >= 2 && (text.front() == '[' || text.front() == '(')) {
      text = text.substr(1, text.size() - 2);
    }
    return as_utf8(text);
  }

  // A line of units: every field in brackets, or the first one a unit of time.
  static bool are_units(const std::vector<Field>& fields) {
    if (seconds_of(unit_of(fields.front().text))) return true;
    return std::all_of(fields.begin(), fields.end(),
                       [](const Field& field) { return field.text.starts_with('['); });
  }

  // Names and numbers in one line are a row with something wrong in it, not a heading.
  void refuse_broken_row(const TextLine& line, const std::vector<Field>& fields) const {
    const Field* word = nullptr;
    bool number = false;
    for (const Field& field : fields) {
      const auto value = parse_number(field.text, layout_.decimal);
      if (!value && word == nullptr) word = &field;
      number = number || (value && !std::isnan(*value));
    }
    if (word == nullptr || !number) return;
    fail(line, word->column, fmt::format("'{}' is not a number", as_utf8(word->text)));
  }

  void refuse_same_names() const {
    std::map<std::string, std::size_t> seen;
    for (std::size_t i = 0; i < headings_.size(); ++i) {
      const auto [first, is_new] = seen.try_emplace(headings_[i].name, i);
      if (is_new) continue;
      fail(heading_line_ != nullptr ? *heading_line_ : lines_[layout_.first],
           i < name_columns_.size() ? name_columns_[i] : 0,
           fmt::format("columns {} and {} are both called '{}'", first->second + 1, i + 1,
                       headings_[i].name));
    }
  }

  void read_row(const TextLine& line, bool may_be_cut) {
    const auto fields = split_fields(line.text, layout_.separator);
    if (fields.size() != layout_.columns) {
      const std::string count =
          fmt::format("{} in a table of {}", system::counted(fields.size(), "field"),
                      system::counted(layout_.columns, "column"));
      fail(line, 0,
           may_be_cut && fields.size() < layout_.columns
               ? count + ", and the file ends here: it is truncated"
               : count);
    }
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const auto value = parse_number(fields[i].text, layout_.decimal);
      if (!value) {
        fail(line, fields[i].column, fmt::format("'{}' is not a number", as_utf8(fields[i].text)));
      }
      if (std::isinf(*value)) {
        fail(line, fields[i].column, fmt::format("'{}' is infinite", as_utf8(fields[i].text)));
      }
      columns_[i].push_back(*value);
    }
    row_lines_.push_back(line.number);
  }

  Base time_base(std::size_t column) const {
    Base out;
    const std::string& unit = headings_[column].unit;
    const auto seconds = seconds_of(unit);
    if (!unit.empty() && !seconds) {
      throw InputError({file_, heading_line_->number, name_columns_[column]},
                       fmt::format("'{}' is not a unit of time; known are {}", unit, kTimeUnits));
    }
    out.unit_known = !unit.empty();
    double last = -HUGE_VAL;
    for (std::size_t i = 0; i < columns_[column].size(); ++i) {
      const double value = columns_[column][i] * seconds.value_or(1.0);
      const Place place{file_, row_lines_[i]};
      if (std::isnan(value)) throw InputError(place, "has no time");
      if (value < last) {
        throw InputError(place, fmt::format("time runs backwards: {} s after {} s", value, last));
      }
      if (value == last) throw InputError(place, fmt::format("time {} s appears twice", value));
      last = value;
      out.values.push_back(value);
    }
    return out;
  }

  Recording finished() {
    Recording out;
    out.file = file_;
    out.format = fmt::format("CSV, separator {}, decimal '{}'", sign_name(layout_.separator),
                             layout_.decimal);
    const auto time = std::find_if(headings_.begin(), headings_.end(),
                                   [](const Heading& one) { return is_time_name(one.name); });
    const auto time_column = static_cast<std::size_t>(time - headings_.begin());
    if (time == headings_.end()) {
      out.bases.push_back(sample_numbers(row_lines_.size()));
    } else {
      out.bases.push_back(time_base(time_column));
    }
    for (std::size_t i = 0; i < headings_.size(); ++i) {
      if (i == time_column) continue;
      out.channels.push_back({headings_[i].name, headings_[i].unit, std::move(columns_[i]), 0});
    }
    return out;
  }

  std::string file_;
  const std::vector<TextLine>& lines_;
  Layout layout_;
  std::vector<Heading> headings_;
  std::vector<int> name_columns_;
  const TextLine* heading_line_ = nullptr;
  std::vector<std::vector<double>> columns_;
  std::vector<int> row_lines_;
};

}  // namespace

bool is_csv(std::string_view text) { return recognised(text_lines(text)).has_value(); }

Recording parse_csv(std::string_view text, const std::string& file) {
  const std::vector<TextLine> lines = text_lines(text);
  const std::optional<Layout> layout = recognised(lines);
  if (!layout) throw InputError({file}, "contains no row of numbers");
  const bool ends_with_line_end = text.ends_with('\n') || text.ends_with('\r');
  Recording out = Table(file, lines, *layout).read(ends_with_line_end);
  check(out);
  return out;
}

}  // namespace servomill::sim::recordings
