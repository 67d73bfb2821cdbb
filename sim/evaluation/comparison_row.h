/// Lines of the comparison: as numbers, as text, as JSON.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "sim/model/tolerance.h"

namespace servomill::sim::evaluation {

/// One line of the printed comparison.
struct ComparisonRow {
  std::string case_name, quantity, axis, statistic, unit, reference, basis;
  std::string sections;
  double value = 0.0;     // NaN where the case stopped or the samples are missing
  std::string note = {};  // why there is no value, where that is known, or what is not alike
  std::optional<model::Tolerance> tolerance = {};  // in `unit`
};

/// "+-20", "-10 to 20"
std::string tolerance_text(const model::Tolerance& tolerance);

/// The table as text, aligned.
std::string format_table(std::span<const ComparisonRow> rows);

/// Text as it may stand between the quotes of a JSON string.
std::string json_escaped(std::string_view text);

/// One JSON object with the keys case, quantity, axis, statistic, sections, value, unit, reference,
/// basis, null where there is none; note, tolerance (its limits) and is_within_tolerance where
/// there is one.
std::string to_json(const ComparisonRow& row);

}  // namespace servomill::sim::evaluation
