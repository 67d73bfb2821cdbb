/// The samples of a case that quantities look at.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
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

  /// Rows of feed motion in these sections; none named: in all.
  const RowRanges& rows(const std::vector<std::string>& sections);

  /// A point in the workpiece at some rows, m; empty if it was not recorded.
  /// @param name  "tool_position_true" or "tool_position_nominal"
  std::vector<Eigen::Vector3d> positions(std::string_view name, const RowRanges& rows) const;

 private:
  RowRanges find_rows(const std::vector<std::string>& sections) const;

  const CaseData& data_;
  std::map<std::vector<std::string>, RowRanges> rows_;
};

/// One column of a recording; empty if it was not recorded.
/// @param label  axis; '\0' for a signal of one column
AtRow column_of(const CaseData& one, std::string_view name, char label);

}  // namespace servomill::sim::evaluation
