/// Tables of an identification's report, and those of the intervals that were requested.
#pragma once

#include <string>
#include <vector>

#include "sim/identification/experiment.h"
#include "sim/identification/identification.h"
#include "sim/identification/identify.h"

namespace servomill::sim::identification {

/// A table of which all columns but the first are aligned to the right.
class Lines {
 public:
  explicit Lines(std::vector<std::string> heading) { lines_.push_back(std::move(heading)); }
  void add(std::vector<std::string> line) { lines_.push_back(std::move(line)); }
  std::string text() const;

 private:
  std::vector<std::vector<std::string>> lines_;
};

/// Digits that an uncertainty leaves meaning in.
std::string with_uncertainty(double value, double half_width);

/// Keys of an estimate, joined by "=".
std::string names_of(const Estimate& one);

/// Bootstrap and profiles, each with a line of what it is; empty if none was requested.
std::string interval_tables(const Identification& result);

}  // namespace servomill::sim::identification
