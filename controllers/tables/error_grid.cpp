#include "controllers/tables/error_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "controllers/tables/error_parameter.h"
#include "controllers/tables/table_text.h"

namespace servomill::controllers {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

std::vector<double> positions_of(const std::vector<GridRecord>& records, std::size_t argument) {
  std::vector<double> out;
  for (const GridRecord& record : records) out.push_back(record.position[argument]);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::size_t place_of(const ErrorGrid& grid, const std::vector<double>& position) {
  std::size_t place = 0;
  for (std::size_t k = 0; k < grid.axes.size(); ++k) {
    const auto found = std::lower_bound(grid.at[k].begin(), grid.at[k].end(), position[k]);
    place = place * grid.at[k].size() + static_cast<std::size_t>(found - grid.at[k].begin());
  }
  return place;
}

// The positions of the combination at a place.
std::vector<double> positions_at(const ErrorGrid& grid, std::size_t place) {
  std::vector<double> out(grid.axes.size());
  for (std::size_t k = out.size(); k-- > 0;) {
    out[k] = grid.at[k][place % grid.at[k].size()];
    place /= grid.at[k].size();
  }
  return out;
}

// "Z = 100, X = 0" of the combination at a place.
std::string position_text(const ErrorGrid& grid, std::size_t place) {
  const std::vector<double> positions = positions_at(grid, place);
  std::string text;
  for (std::size_t k = 0; k < positions.size(); ++k) {
    text += fmt::format("{}{} = {:g}", k == 0 ? "" : ", ", letter(grid.axes[k]),
                        positions[k] / coordinate_unit(grid.axes[k]));
  }
  return text;
}

// The first place without a record: sorted, the records before it are at the first places.
// @pre there are more combinations than records
std::size_t first_missing(const ErrorGrid& grid, const std::vector<GridRecord>& records) {
  std::vector<std::vector<double>> there;
  for (const GridRecord& record : records) there.push_back(record.position);
  std::sort(there.begin(), there.end());
  there.erase(std::unique(there.begin(), there.end()), there.end());
  std::size_t place = 0;
  while (place < there.size() && there[place] == positions_at(grid, place)) ++place;
  return place;
}

}  // namespace

double ErrorGrid::value(std::span<const double> position) const {
  const std::size_t n = axes.size();
  double sum = 0.0;
  for (std::size_t corner = 0; corner < (std::size_t{1} << n); ++corner) {
    double weight = 1.0;
    std::size_t place = 0;
    for (std::size_t k = 0; k < n; ++k) {
      const std::vector<double>& s = at[k];
      const double q = std::clamp(position[k], s.front(), s.back());
      const auto above = std::upper_bound(s.begin() + 1, s.end() - 1, q);
      const auto i = static_cast<std::size_t>(above - s.begin()) - 1;
      const double share = (q - s[i]) / (s[i + 1] - s[i]);
      const bool upper = (corner >> k & 1U) != 0U;
      weight *= upper ? share : 1.0 - share;
      place = place * s.size() + i + (upper ? 1 : 0);
    }
    sum += weight * error[place];
  }
  return sum;
}

ErrorGrid grid_of(ErrorGrid grid, const std::vector<GridRecord>& records) {
  double combinations = 1.0;  // of large tables with missing records more than an integer holds
  for (std::size_t k = 0; k < grid.axes.size(); ++k) {
    grid.at.push_back(positions_of(records, k));
    if (grid.at.back().size() < 2) {
      refuse(grid.file, grid.line,
             fmt::format("{}: one position of {}; a grid requires at least two", grid.name,
                         letter(grid.axes[k])));
    }
    combinations *= static_cast<double>(grid.at.back().size());
  }
  if (combinations > static_cast<double>(records.size())) {
    refuse(grid.file, grid.line,
           fmt::format("{}: {} records, but their positions form a grid of {:.15g} points; {} is "
                       "the first without a record; interpolation GRID requires one for each",
                       grid.name, records.size(), combinations,
                       position_text(grid, first_missing(grid, records))));
  }
  grid.error.assign(static_cast<std::size_t>(combinations), kMissing);
  for (const GridRecord& record : records) {
    double& error = grid.error[place_of(grid, record.position)];
    if (!std::isnan(error)) {
      refuse(grid.file, record.line,
             fmt::format("{} appears twice at {}", grid.name,
                         position_text(grid, place_of(grid, record.position))));
    }
    error = record.error;
  }
  return grid;
}

}  // namespace servomill::controllers
