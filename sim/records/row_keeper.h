/// Keeps recorded rows: few of them in memory, many on the disk.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "sim/records/row_thinning.h"
#include "sim/records/series.h"
#include "sim/records/series_spool.h"

namespace servomill::sim::records {

/// Storage of the rows of a case until they have been compared.
struct RowKeeping {
  std::string folder;            // of what memory is not to hold; empty: that of temporary files
  double most_in_memory = 64e6;  // bytes of the rows of a case; more go to the disk
  int compression = 1;           // of what is encoded
  std::optional<ThinningLimits> thinning = {};  // none: every row is kept
  bool encodes = false;                         // rows as they come, since they go into a file
  bool encodes_beside = true;  // these, and those that go to the disk: in a thread of their own
  /// Signals whose numbers stay beside where rows are encoded, as they are read often; none: all.
  std::optional<std::set<std::string, std::less<>>> read = {};
};

/// Rows of one case. What it holds in memory does not grow with their number, once that is large.
class RowKeeper {
 public:
  /// @param signals  of the rows that come; of those that are kept if they are thinned: more
  /// @param rows  that will come, about
  /// @throws SystemError, as all members
  RowKeeper(const std::vector<Signal>& signals, const RowKeeping& keeping, std::size_t rows);

  /// Adds whole rows, one behind the other.
  void add(std::span<const double> rows);
  /// All rows; once.
  Series take();

 private:
  void make_room(const RowKeeping& keeping, std::size_t rows);
  void keep(std::span<const double> rows);

  std::optional<RowThinning> thinning_;
  std::vector<double> staying_;         // of the rows that come, if they are thinned
  Series series_;                       // in memory
  std::shared_ptr<SeriesSpool> spool_;  // or encoded, or on the disk
};

}  // namespace servomill::sim::records
