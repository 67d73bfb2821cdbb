/// The columns of the table of a sweep.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "sim/model/forward.h"
#include "sim/records/chunk_encoder.h"
#include "sim/records/meaning.h"

namespace servomill::sim::records {
class InputFile;
struct Plot;  // sim/records/nexus.h
}  // namespace servomill::sim::records

namespace servomill::sim::sweep {

/// Group of the table in a sweep file.
inline const std::string kSweepGroup = "/sweep";

/// Rows that are read or written at once.
inline constexpr std::size_t kSweepBlockRows = 4096;

/// A number that there is not.
inline constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

/// One column of numbers.
struct TableColumn {
  std::string name;  // of the dataset: letters, digits and '_'
  records::Meaning meaning;
  records::Storage storage = records::Storage::float64;
  double fill = 0.0;                                            // where a point was not run
  std::vector<std::pair<std::string, std::string>> attributes;  // what it is a column of
  std::vector<std::string> texts;                               // of a column of their places
};

/// Columns of a sweep table beside point, status, reason and the instructions that computed it: a
/// column for each key of the sweep, then one for each line of the comparison.
std::vector<TableColumn> columns_of(const model::Scenario& base);

/// The same of a file that is there. @throws InputError
std::vector<TableColumn> columns_of(const records::InputFile& file);

/// First quantity with those of its unit, over the swept key if it is one number, else over points.
records::Plot plot_of(const std::vector<TableColumn>& columns);

}  // namespace servomill::sim::sweep
