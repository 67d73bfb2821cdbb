/// Tables of readings in CSV files: named columns with units.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/config/quantity.h"

namespace servomill::sim::readings {

/// One column: its name without the unit, and the factor of that.
struct Column {
  std::string name;     // "deviation" of "deviation_um"
  std::string written;  // "deviation_um"
  config::Unit unit;    // of a column without one: a number
  int number = 0;       // from 1
};

/// A row of a table that is not empty.
struct Row {
  int line = 0;
  std::vector<std::string> fields;  // as many as columns
  std::vector<int> columns;         // of text, from 1
};

/// Rows under one line of names. Lines that begin with '#' are comments; the separator is ';',
/// ',', a tab or blanks, whichever the line of names has; with ';' the decimal sign may be a comma.
struct Table {
  std::string file;
  char decimal = '.';
  std::vector<Column> columns;
  std::vector<Row> rows;

  const Column* find(std::string_view name) const;
  /// The field of a column in SI, or nothing where it is empty. Faults are added to `faults`.
  std::optional<double> number(const Row& row, const Column& column,
                               std::vector<Fault>& faults) const;
  const std::string& text(const Row& row, const Column& column) const;
  Place place(const Row& row, const Column& column) const;
};

/// @throws InputError if the file cannot be read, has no line of names or rows of another length
Table read_table(const std::string& path);

/// "X_mm" as "X" in mm. Units are lengths, angles and times; another ending belongs to the name.
Column parse_column(std::string_view written, int number);

}  // namespace servomill::sim::readings
