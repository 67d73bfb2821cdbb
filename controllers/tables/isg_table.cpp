#include "controllers/tables/isg_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "controllers/tables/error_parameter.h"
#include "controllers/tables/table_text.h"

namespace servomill::controllers {
namespace {

struct Record {
  int line = 0;
  std::vector<double> values;
};

struct Block {
  int line = 0;  // of the header; 0: there is none yet
  std::vector<std::string> header;
  std::vector<Record> records;
};

std::string_view without_comment(std::string_view line) {
  return trimmed(line.substr(0, line.find("//")));
}

// Words between blanks and tabs.
std::vector<std::string_view> words_in(std::string_view line, const TableText& file, int number) {
  if (line.find_first_of(",;") != std::string_view::npos) {
    refuse(file.name, number,
           "contains a comma or a semicolon; columns must be separated by spaces and numbers use "
           "decimal points");
  }
  std::vector<std::string_view> words;
  while (!(line = trimmed(line)).empty()) {
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
  return words;
}

// Parameters that describe the kinematics, which a machine file holds.
bool is_kinematics(std::string_view name) {
  return name.size() == 3 &&
         (name.starts_with("P") || name.starts_with("N0") || name.starts_with("LN"));
}

// Parameters that change what the errors mean.
bool changes_the_model(std::string_view name) {
  return name.size() == 3 && (name.starts_with("V") || name.starts_with("ID"));
}

std::vector<Axis> arguments_of(const Block& block, const TableText& file) {
  std::vector<Axis> arguments;
  for (const std::string& word : block.header) {
    if (word.size() != 1) continue;
    const auto axis = axis_of(word.front());
    if (!axis) refuse(file.name, block.line, fmt::format("'{}' is not an axis", word));
    arguments.push_back(*axis);
  }
  return arguments;
}

// @pre the block has that argument
std::size_t column_of(const Block& block, Axis argument) {
  const auto place =
      std::find(block.header.begin(), block.header.end(), std::string(1, letter(argument)));
  return static_cast<std::size_t>(place - block.header.begin());
}

void check_not_repeated(const Block& block, const TableText& file) {
  for (std::size_t i = 0; i < block.header.size(); ++i) {
    const auto end = block.header.begin() + static_cast<std::ptrdiff_t>(i);
    if (std::find(block.header.begin(), end, block.header[i]) == end) continue;
    refuse(file.name, block.line, fmt::format("{} appears twice", block.header[i]));
  }
}

void read_location(const Block& block, const TableText& file, std::size_t column,
                   const ErrorParameter& parameter, ErrorColumns& out) {
  if (block.records.size() != 1) {
    refuse(file.name, block.records.size() > 1 ? block.records[1].line : block.line,
           fmt::format("{}: {} records of a position error; must be one", block.header[column],
                       block.records.size()));
  }
  const Record& record = block.records.front();
  add_location(out, file.name, parameter, {record.values[column], record.line});
}

void read_component(const Block& block, const TableText& file, std::size_t column,
                    const ErrorParameter& parameter, ErrorColumns& out) {
  const std::size_t at = column_of(block, parameter.axis);
  ErrorColumn error{.file = file.name, .name = parameter.iso_name(), .base_axis = parameter.axis};
  for (const Record& record : block.records) {
    const double value = record.values[column] * parameter.unit();
    error.points.push_back(
        {record.values[at] * coordinate_unit(parameter.axis), value, value, record.line});
  }
  add_component(out, std::move(error), block.line);
}

void read_grid(const Block& block, const TableText& file, std::size_t column,
               const ErrorParameter& parameter, const std::vector<Axis>& arguments,
               ErrorColumns& out) {
  std::vector<GridRecord> records;
  for (const Record& record : block.records) {
    GridRecord& one =
        records.emplace_back(GridRecord{{}, record.values[column] * parameter.unit(), record.line});
    for (const Axis axis : arguments) {
      one.position.push_back(record.values[column_of(block, axis)] * coordinate_unit(axis));
    }
  }
  add_grid(
      out,
      grid_of(
          {.file = file.name, .name = parameter.iso_name(), .axes = arguments, .line = block.line},
          records));
}

void read_other(const Block& block, const TableText& file, std::size_t column, ErrorColumns& out) {
  const std::string& name = block.header[column];
  if (is_kinematics(name)) {
    out.not_read.push_back(name);
    return;
  }
  if (!changes_the_model(name)) {
    refuse(file.name, block.line, fmt::format("'{}' is not a parameter of TF5280", name));
  }
  for (const Record& record : block.records) {
    if (record.values[column] == 0.0) continue;
    refuse(file.name, record.line,
           fmt::format("{} is not 0; {} are not supported", name,
                       name.starts_with("V") ? "axes with modified orientation"
                                             : "offsets of the programmed values"));
  }
}

void read_block(const Block& block, const TableText& file, ErrorColumns& out) {
  if (block.line == 0) return;
  if (block.records.empty()) refuse(file.name, block.line, "a header without a record");
  check_not_repeated(block, file);
  const std::vector<Axis> arguments = arguments_of(block, file);
  for (std::size_t i = 0; i < block.header.size(); ++i) {
    if (block.header[i].size() == 1) continue;
    const auto parameter = error_parameter_of(block.header[i]);
    if (!parameter) {
      read_other(block, file, i, out);
    } else if (!parameter->is_location && arguments.empty()) {
      refuse(file.name, block.line,
             fmt::format("{} has no argument; must be a function of an axis position",
                         block.header[i]));
    } else if (!parameter->is_location && arguments == std::vector{parameter->axis}) {
      read_component(block, file, i, *parameter, out);
    } else if (!parameter->is_location) {
      read_grid(block, file, i, *parameter, arguments, out);
    } else if (arguments.empty()) {
      read_location(block, file, i, *parameter, out);
    } else {
      refuse(file.name, block.line,
             fmt::format("{} is a function of {}; only constant position errors are supported",
                         block.header[i], letter(arguments.front())));
    }
  }
}

Record record_of(const std::vector<std::string_view>& words, const Block& block,
                 const TableText& file, int number) {
  if (words.size() != block.header.size()) {
    refuse(file.name, number,
           fmt::format("{} values for {} columns", words.size(), block.header.size()));
  }
  Record record{.line = number, .values = {}};
  for (const std::string_view word : words) {
    record.values.push_back(number_at(word, file.name, number));
  }
  return record;
}

}  // namespace

ErrorColumns read_isg_table(const TableText& file) {
  ErrorColumns out;
  Block block;
  int number = 0;
  for (const std::string_view text : lines_of(file.text)) {
    ++number;
    const std::string_view line = without_comment(text);
    if (line.empty()) continue;
    if (line.starts_with('#')) {
      read_block(block, file, out);
      block = {};
      continue;
    }
    const auto words = words_in(line, file, number);
    if (block.line == 0) {
      block.line = number;
      block.header.assign(words.begin(), words.end());
    } else {
      block.records.push_back(record_of(words, block, file, number));
    }
  }
  read_block(block, file, out);
  if (out.components.empty() && out.locations.empty() && out.grids.empty()) {
    refuse(file.name, 0, "contains no geometric error");
  }
  return out;
}

}  // namespace servomill::controllers
