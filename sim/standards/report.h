/// Results of a test as a report lists them: parameters with their uncertainty, tables, remarks.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace servomill::sim::standards {

enum class Dimension : std::uint8_t { length, angle, ratio, count };

/// One parameter.
struct ReportValue {
  std::string symbol, meaning;
  double value = std::numeric_limits<double>::quiet_NaN();  // m, rad; NaN: the readings give none
  Dimension dimension = Dimension::length;
  double U = std::numeric_limits<double>::quiet_NaN();  // expanded, k = 2; NaN: not stated
};

/// One column of a table.
struct ReportColumn {
  std::string name;
  Dimension dimension = Dimension::length;
  bool is_place = false;  // targets and angles of a circle: printed in mm and deg
  std::vector<double> values;
};

struct ReportTable {
  std::string name;
  bool on_request = false;            // not printed unless asked for
  std::vector<std::string> rows;      // names, or none
  std::vector<ReportColumn> columns;  // equally long
};

struct Report {
  std::string standard;  // "ISO 230-2"
  std::string name;      // of the readings
  std::string headline;  // "5 targets, 5 runs in both directions"
  std::vector<ReportValue> values;
  std::vector<ReportTable> tables;
  std::vector<std::string> remarks;
};

/// Text for reading: units of um or nm, urad or nrad, as the values fit; parameters that the
/// readings do not give are left out.
std::string printed(const Report& report, bool with_all_tables);
/// One object, numbers in m and rad, null where there is none.
std::string json(const Report& report);
/// One parameter a row: test, standard, parameter, value, unit, U (k = 2).
std::string csv(const std::vector<Report>& reports);

}  // namespace servomill::sim::standards
