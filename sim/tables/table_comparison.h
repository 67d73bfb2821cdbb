/// Comparison of what a written table gives with what the error model needs.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "controllers/tables/control_table.h"
#include "sim/tables/compensation_tables.h"
#include "sim/tables/table_export.h"
#include "sim/tables/verify_tables.h"

namespace servomill::sim::tables {

/// Tolerance of comparisons in digits beyond the last one written, for binary fractions.
inline constexpr double kDigitSlack = 1e-6;

Axis axis_at(const TableExport& tables, int joint);

std::vector<controllers::TableText> texts_of(const std::vector<TextFile>& files);

/// "1.2340 um"
std::string exact_size(bool is_angle, double value);

/// One quantity over the position of one axis: as read, and as needed.
struct Comparison {
  std::string file, title;
  bool is_angle = false;
  double digit = 0.0;                               // m, rad: last one of the file
  std::function<double(double, int)> read, needed;  // position, direction of travel
  std::function<int(double)> line_at;
};

/// Comparisons over all axes, and their sum.
class TableComparison {
 public:
  explicit TableComparison(const TableExport& tables) : e_(tables) {}

  /// @throws InputError at the first position at which the file gives another value than the chords
  ///         of the error model over the requested points
  void check(const TableLine& line, const Comparison& comparison);

  /// @throws InputError if the points of a file are not those that were asked for
  void check_points(const TableLine& line, const std::string& file,
                    const std::vector<controllers::TablePoint>& points) const;

  /// One more position, where the file is off the error model by so much (m, rad).
  void count(bool is_angle, double difference);

  TableVerification result() const { return result_; }

 private:
  std::function<double(double)> chords(const TableLine& line, const Comparison& comparison,
                                       int direction) const;
  [[noreturn]] void fail(const TableLine& line, const Comparison& comparison, double q,
                         int direction, double read, double wanted) const;

  const TableExport& e_;
  TableVerification result_;
};

/// verify_tables of the formats that hold the errors by their names.
TableVerification verify_columns(const TableExport& tables, const std::vector<TextFile>& files);

}  // namespace servomill::sim::tables
