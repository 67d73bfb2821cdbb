/// Output of a sweep while it runs.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "plant/vocabulary/simd.h"
#include "sim/evaluation/comparison_row.h"
#include "sim/model/forward.h"
#include "sim/preparation/estimate.h"
#include "sim/sweep/run_sweep.h"
#include "sim/sweep/table.h"
#include "tools/servomill/json_list.h"

namespace servomill::tools {

/// One line a point, in the order of the points: a line waits for those before it, so that two runs
/// of a sweep print the same. Where a point is not done the reason goes to standard error.
class SweepLines {
 public:
  enum class Form : std::uint8_t { table, json, none };

  /// @param rows  the comparison of each point (Sweep::quantities)
  /// @param done  places in the selection that are not run; empty: all are run
  SweepLines(Form form, const sim::model::SweepDesign& design,
             std::vector<sim::evaluation::ComparisonRow> rows,
             const sim::sweep::Selection& selection, std::vector<bool> done);

  /// Prints the points that no other holds up any more.
  void add(const sim::sweep::SweepPoint& point);
  /// Prints what still waits for points that were not run.
  void finish();

 private:
  struct Said {
    std::string out, error;
    std::vector<std::string> objects;  // JSON
  };
  std::string heading() const;
  std::string line_of(const sim::sweep::SweepPoint& point) const;
  Said said_of(const sim::sweep::SweepPoint& point) const;
  void print(const Said& said);

  Form form_;
  const sim::model::SweepDesign& design_;
  std::vector<sim::evaluation::ComparisonRow> rows_;
  const sim::sweep::Selection& selection_;
  std::vector<bool> done_;
  std::map<std::uint64_t, Said> waiting_;  // by place in the selection
  std::uint64_t next_ = 0;                 // place
  bool headed_ = false;
  JsonList list_;
};

/// "98 points done, 2 points refused".
std::string points_by_status(const sim::sweep::StatusCounts& counts);

/// Prints the estimate for the remaining points, if they are like the first: on standard error, and
/// only if it is long or large.
void tell_estimate(sim::preparation::RunEstimate takes, std::uint64_t points, unsigned threads,
                   bool series);

/// Prints the distribution of each quantity over the samples of a complete table, where there are
/// samples.
void print_statistics(const std::string& table);

/// Says on standard error how many samples of identified values were refused, and what helps.
void tell_refused_samples(const sim::model::SweepDesign& design,
                          const sim::sweep::StatusCounts& counts);

/// Says on standard error if points of a table were computed at several levels of instructions.
void tell_mixed_levels(const std::string& path, const std::vector<SimdLevel>& levels);

}  // namespace servomill::tools
