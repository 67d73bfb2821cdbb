#include "sim/recordings/hal_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "plant/vocabulary/progress.h"
#include "sim/recordings/checked_rows.h"
#include "sim/system/counted.h"

namespace servomill::sim::recordings {
namespace {

constexpr std::string_view kPeriod = "Sampling period is ";
constexpr std::string_view kOverrun = "overrun";
constexpr std::size_t kHead = 1 << 20;  // bytes, and
constexpr std::size_t kExamined = 200;  // lines that the kind is recognised from

// Nanoseconds of "Sampling period is 1000000 nSec".
double period_ns(const TextLine& line, const std::string& file) {
  const auto fields = split_fields(line.text, ' ');
  const Place place{file, line.number};
  if (fields.size() < 5) throw InputError(place, "the sampling period is truncated");
  std::string unit(fields[4].text);
  std::transform(unit.begin(), unit.end(), unit.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto seconds = seconds_of(unit);
  if (!seconds) {
    throw InputError({file, line.number, fields[4].column},
                     fmt::format("'{}' is not a unit of time; known are {}",
                                 as_utf8(fields[4].text), kTimeUnits));
  }
  const double period = checked_number(fields[3], '.', place) * *seconds / 1e-9;
  if (period > 0.0) return period;
  throw InputError({file, line.number, fields[3].column}, "the sampling period must be > 0");
}

void refuse_length(std::size_t fields, std::size_t wanted, bool is_last, const Place& place) {
  if (fields == wanted) return;
  const std::string message =
      fmt::format("{} in a line, the first one has {}", system::counted(fields, "field"), wanted);
  const bool is_cut = is_last && fields < wanted;
  throw InputError(place, is_cut ? message + ", and the file ends here: it is truncated" : message);
}

bool is_overrun(const TextLine& line) { return line.text.starts_with(kOverrun); }

// A whole number that is no less than zero.
bool is_sample_number(const Field& field) {
  return !field.text.empty() && std::all_of(field.text.begin(), field.text.end(), [](char c) {
    return std::isdigit(static_cast<unsigned char>(c)) != 0;
  });
}

// True if the first column counts from row to row; an overrun lets it jump.
bool is_numbered(const std::vector<TextLine>& lines) {
  double last = -1.0;
  std::size_t rows = 0, ones = 0;
  for (std::size_t i = 0; i < std::min(lines.size(), kExamined); ++i) {
    if (is_overrun(lines[i])) continue;
    const auto fields = split_fields(lines[i].text, ' ');
    if (fields.size() < 2 || !is_sample_number(fields[0])) return false;
    const double number = parse_number(fields[0].text, '.').value_or(-1.0);
    if (rows > 0 && number == last + 1.0) ++ones;
    last = number;
    ++rows;
  }
  return rows >= 2 && 2 * ones >= rows - 1;
}

}  // namespace

bool is_halscope(std::string_view text) { return text.starts_with(kPeriod); }

Recording parse_halscope(std::string_view text, const std::string& file) {
  const std::vector<TextLine> lines = text_lines(text);
  if (lines.empty()) throw InputError({file}, "is empty");
  const double period = period_ns(lines.front(), file);
  Recording out{file, "halscope of LinuxCNC", {Base{}}, {}, {}};
  char decimal = '.';
  Stage stage("lines", static_cast<double>(lines.size()));
  for (std::size_t i = 1; i < lines.size(); ++i) {
    stage.reach(static_cast<double>(i));
    const auto fields = split_fields(lines[i].text, ' ');
    const Place place{file, lines[i].number};
    if (i == 1) {
      if (fields.size() % 2 != 0) throw InputError(place, "a pin without its value");
      decimal = decimal_of(fields[1].text);
      for (std::size_t k = 0; k < fields.size(); k += 2) {
        out.channels.push_back({as_utf8(fields[k].text), "", {}, 0});
      }
    }
    refuse_length(fields.size(), 2 * out.channels.size(), i + 1 == lines.size(), place);
    out.bases[0].values.push_back(static_cast<double>(i - 1) * period / 1e9);
    for (std::size_t k = 0; k < out.channels.size(); ++k) {
      const Field& name = fields[2 * k];
      if (as_utf8(name.text) != out.channels[k].name) {
        throw InputError(
            {file, lines[i].number, name.column},
            fmt::format("pin '{}' in place of '{}'", as_utf8(name.text), out.channels[k].name));
      }
      out.channels[k].samples.push_back(checked_number(fields[2 * k + 1], decimal, place));
    }
  }
  check(out);
  return out;
}

bool is_halsampler(std::string_view text) {
  const std::vector<TextLine> lines = text_lines(text.substr(0, kHead));
  if (lines.size() < 2) return false;
  bool has_overrun = false;
  for (std::size_t i = 0; i < std::min(lines.size(), kExamined); ++i) {
    if (is_overrun(lines[i])) {
      has_overrun = true;
      continue;
    }
    const auto fields = split_fields(lines[i].text, ' ');
    // a word in a row behind the first ones is a fault of the row, not another kind
    if (i < 2 && !std::all_of(fields.begin(), fields.end(), [](const Field& field) {
          return parse_number(field.text, decimal_of(field.text)).has_value();
        }))
      return false;
  }
  return has_overrun || is_numbered(lines);
}

Recording parse_halsampler(std::string_view text, const std::string& file) {
  const std::vector<TextLine> lines = text_lines(text);
  const bool numbered = is_numbered(lines);
  const std::size_t first = numbered ? 1 : 0;
  Recording out{file, "halsampler of LinuxCNC", {Base{"sample", "1", {}}}, {}, {}};
  std::vector<double>& numbers = out.bases[0].values;
  std::size_t overruns = 0;
  char decimal = '.';
  Stage stage("lines", static_cast<double>(lines.size()));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    stage.reach(static_cast<double>(i));
    const Place place{file, lines[i].number};
    if (is_overrun(lines[i])) {
      ++overruns;
      if (numbered) continue;
      throw InputError(place,
                       "samples were lost here, and rows without sample numbers do not say "
                       "how many: record with halsampler -t");
    }
    const auto fields = split_fields(lines[i].text, ' ');
    if (out.channels.empty()) {
      for (std::size_t k = first; k < fields.size(); ++k) {
        out.channels.push_back({fmt::format("column {}", k + 1), "", {}, 0});
      }
    }
    refuse_length(fields.size(), first + out.channels.size(), i + 1 == lines.size(), place);
    const double number =
        numbered ? checked_number(fields[0], '.', place) : static_cast<double>(numbers.size());
    if (!numbers.empty() && !(number > numbers.back())) {
      throw InputError(
          place, fmt::format("sample number {} after {}; must increase", number, numbers.back()));
    }
    numbers.push_back(number);
    for (std::size_t k = 0; k < out.channels.size(); ++k) {
      const Field& field = fields[first + k];
      if (decimal == '.') decimal = decimal_of(field.text);
      out.channels[k].samples.push_back(checked_number(field, decimal, place));
    }
  }
  if (overruns > 0) {
    out.notes.push_back(system::counted(overruns, "overrun") + ": samples were lost");
  }
  check(out);
  return out;
}

}  // namespace servomill::sim::recordings
