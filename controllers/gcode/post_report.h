/// Errors and warnings of a post-processor run: those of one location, and those that are counted
/// and given once for the whole program.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "controllers/gcode/cl_data.h"
#include "controllers/path/feed_reduction.h"

namespace servomill::controllers {

class PostReport {
 public:
  /// @param file    name of the cutter locations, for messages; outlives the report
  /// @param layout  letters of the axes; outlives the report
  PostReport(const std::string& file, const JointLayout& layout) : file_(file), layout_(layout) {}

  void fault(int line, std::string message);
  void warn(int line, std::string message);

  /// No more errors need be looked for: a machine that is too small has one a location.
  bool is_full() const;

  /// A location with a singular tool axis.
  void note_singular(int line);

  /// A block that leads the tip off its straight path by more than the tolerance.
  /// @param deviation  m
  void note_bend(int line, double deviation);

  /// A block in which joints exceed their speed limits at the programmed feed.
  /// @param joints  each such joint, at least one
  void note_slowed(const std::vector<FeedReduction>& joints);

  /// Warnings of the run, those that are counted last.
  /// @param of_refused  receives the warnings if there are errors
  /// @throws InputError with every error
  std::vector<Warning> conclude(std::vector<Warning>* of_refused);

 private:
  void sum_up();

  const std::string& file_;
  const JointLayout& layout_;
  std::vector<Fault> faults_;
  std::vector<Warning> warnings_;
  std::size_t singular_ = 0;
  int first_singular_ = 0;  // line
  std::size_t bent_ = 0;    // blocks that lead the tip off by more than the tolerance
  double bend_ = 0.0;       // m, at most
  int most_bent_ = 0;       // its line
  std::size_t slowed_blocks_ = 0;
  std::optional<FeedReduction> slowed_;  // the one that falls most
};

}  // namespace servomill::controllers
