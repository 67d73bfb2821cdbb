/// Leaves out rows of a long recording where little happens, and keeps what they would have shown.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "sim/records/series.h"

namespace servomill::sim::records {

/// The number of rows before it that a row of a thinned recording stands for, itself included.
inline constexpr std::string_view kSamples = "samples";

/// Limits of a recording's size.
struct ThinningLimits {
  double bytes = 0.0;               // of its chunks on the disk
  std::size_t rows = 0;             // that will come, about
  std::vector<bool> keep_all = {};  // by section: every row of it stays, whatever that takes
  // > 0: each so many-th row since time 0 stays, whatever that takes; no other limit counts
  std::size_t every = 0;
  double row_period = 0.0;  // s, of the rows that come, then
};

/// Thins rows of a fixed period. The rows that stay: the first and the last, those where the
/// program goes to another section or from feed to rapid and back and, as long as the limit allows,
/// those
///
///   - at which a block ends or an axis reverses,
///   - by which the contour error has changed by a tenth of its greatest value,
///   - that follow the row before by the longest time that the limit leaves.
///
/// A row that stays tells of those left out before it how many they are (`samples`, itself
/// included) and, of some signals, least and greatest value, mean and root mean square: largest
/// values, ranges, means and rms of these are those of all rows. Which rows stay depends on the
/// rows alone.
///
/// With ThinningLimits::every those stay that such a period would have recorded, the ends of
/// sections, of rapid moves and of windows, and the last row.
class RowThinning {
 public:
  /// @param signals  of the rows that come; among them line, section and rapid
  RowThinning(const std::vector<Signal>& signals, ThinningLimits limits);

  /// Signals of the rows that stay: the recorded ones, then the extremes of the rows left out.
  const std::vector<Signal>& signals() const { return signals_; }

  /// Adds whole rows; those that stay are put behind `out`.
  void add(std::span<const double> rows, std::vector<double>& out);
  /// Puts the last row there, if it has not stayed.
  void finish(std::vector<double>& out);

  /// Says what the first rows of those that stayed take on the disk: the others may take the rest.
  void account(std::uint64_t bytes, std::size_t rows);

 private:
  // A signal whose values between rows have statistics: columns of a row, or computed from them.
  struct Watched {
    enum class Kind : std::uint8_t { column, length, angle };
    Kind kind = Kind::column;
    std::size_t columns = 1;          // of its own
    std::size_t from = 0, other = 0;  // first columns of what it is made of
    bool has_mean = false;            // beside least and greatest value
    bool is_single = false;           // kept as float32
  };
  // Extremes of a column since the last row that stayed.
  struct Statistics {
    double least = 0.0, greatest = 0.0, sum = 0.0, squares = 0.0;
  };

  void watch(const Signal& signal, Watched watched);
  void watch_tool(const Series& coming);
  void add_row(std::span<const double> row, std::vector<double>& out);
  void add_row_of_period(std::span<const double> row, std::vector<double>& out);
  bool is_at_period(std::span<const double> row) const;
  bool must_stay(std::span<const double> before, std::span<const double> row) const;
  bool is_event(std::span<const double> before, std::span<const double> row);
  bool contour_error_has_changed(std::span<const double> row);
  bool takes_event();
  bool keeps_all(std::span<const double> row) const;
  static double value(const Watched& watched, std::size_t column, std::span<const double> row);
  void tell_of(std::span<const double> row);
  void stay(std::span<const double> row, std::vector<double>& out);
  void spread();

  ThinningLimits limits_;
  std::vector<Signal> signals_;
  std::size_t width_ = 0;  // of the rows that come
  std::vector<Watched> watched_;
  std::vector<std::size_t> axes_;  // columns of the interpolated position
  std::size_t time_ = 0, line_ = 0, section_ = 0, rapid_ = 0, contour_error_ = 0;
  std::optional<std::size_t> window_, in_window_;  // where rows of some windows come

  std::vector<double> before_;          // the row before; empty: there was none
  std::vector<int> senses_;             // in which the axes went last
  std::vector<Statistics> statistics_;  // column after column of what is watched
  std::size_t samples_ = 0;             // since a row stayed
  double last_contour_error_ = 0.0, greatest_contour_error_ = 0.0;

  double bytes_ = 0.0, bytes_per_row_ = 0.0;           // as accounted for
  std::size_t come_ = 0, stayed_ = 0, accounted_ = 0;  // rows
  double longest_ = 1.0;                               // rows that one stands for, without an event
  double events_ = 0.0, events_per_row_ = 0.0;         // that may be kept
};

}  // namespace servomill::sim::records
