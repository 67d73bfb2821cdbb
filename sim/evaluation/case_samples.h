/// The samples of a case that quantities look at.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/evaluation/comparison.h"
#include "sim/evaluation/quantity.h"
#include "sim/evaluation/row_ranges.h"

namespace servomill::sim::evaluation {

/// Finds the rows of sections, once for all quantities.
class CaseSamples {
 public:
  /// @param data  must outlive this; has a recording if rows are asked for
  explicit CaseSamples(const CaseData& data) : data_(data) {}

  const CaseData& data() const { return data_; }

  /// Rows of feed motion in these sections and in the windows of the recording; no section named:
  /// in all.
  const RowRanges& rows(const std::vector<std::string>& sections);

  /// A point in the workpiece at some rows, m; empty if it was not recorded.
  /// @param name  "tool_position_true" or "tool_position_nominal"
  std::vector<Eigen::Vector3d> positions(std::string_view name, const RowRanges& rows) const;

 private:
  RowRanges find_rows(const std::vector<std::string>& sections) const;

  const CaseData& data_;
  std::map<std::vector<std::string>, RowRanges> rows_;
};

/// Rows of feed motion of these sections (none named: of all) that lie outside the windows of the
/// recording.
std::size_t rows_left_out(const CaseData& one, const std::vector<std::string>& sections);

/// Tells if a row follows the one before, without rows left out in between. @pre row > 0
bool follows(const records::Series& series, std::optional<std::size_t> window, std::size_t row);

/// Leaves out rows at whose s the recording of the base case has a gap.
RowRanges rows_with_counterpart(const CaseData& one, const CaseData& base, const RowRanges& rows);

/// One column of a recording; empty if it was not recorded.
/// @param label  axis; '\0' for a signal of one column
AtRow column_of(const CaseData& one, std::string_view name, char label);

}  // namespace servomill::sim::evaluation
