/// Distribution of the quantities of a sweep over its samples: the result of a Monte Carlo run.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/sweep/conformity.h"
#include "sim/sweep/table_columns.h"

namespace servomill::sim::sweep {

/// Fewest values of which the ends of an interval of 95 % are given: 2.5 % of them are one.
inline constexpr std::size_t kMinForInterval = 40;

/// Numbers that describe a set of values; NaN where there are too few.
struct Distribution {
  std::uint64_t count = 0;
  double mean = 0.0;
  double deviation = 0.0;        // standard deviation, with count - 1
  double low = 0.0, high = 0.0;  // 2.5 and 97.5 %: the interval of 95 %
};

/// Distribution of the finite ones of some values. Quantiles are interpolated between neighbours
/// (type 7 of Hyndman and Fan, "Sample quantiles in statistical packages", 1996).
Distribution distribution_of(std::span<const double> values);

/// One quantity at one point of the grid.
struct SampledQuantity {
  std::string grid;    // "program.feed_override = 0.5"; empty: there is no grid
  TableColumn column;  // with its attributes
  Distribution distribution;
  std::optional<model::Tolerance> tolerance = {};
  std::optional<Conformity> conformity = {};  // with the tolerance
};

/// All quantities of a table at each point of its grid, over the samples that have a value: points
/// that were refused or failed have none. Nothing where the sweep has no samples.
/// @throws InputError if the file is no table of a sweep
std::vector<SampledQuantity> sample_statistics(const std::string& table);

/// The statistics as JSON objects.
std::vector<std::string> statistics_json(const std::vector<SampledQuantity>& quantities);

/// The statistics as a table of text; so many lines at most, and how many more there are.
std::string format_statistics(const std::vector<SampledQuantity>& quantities, std::size_t most);

}  // namespace servomill::sim::sweep
