/// A scenario run at the points of its [sweep] table.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/evaluation/comparison_row.h"
#include "sim/input/scenario_source.h"
#include "sim/model/forward.h"
#include "sim/preparation/estimate.h"

namespace servomill::sim::sweep {

/// The rows of a sweep's table at any point, without their values: those of the comparison, then
/// the parameters of tests of the machine.
std::vector<evaluation::ComparisonRow> quantities_of(const model::Scenario& scenario);

/// A scenario with a sweep. Constant: threads may share it.
class Sweep {
 public:
  /// @param changes  what --set says, at all points
  /// @param text     of the scenario, which then need not be on a disk; none: that of the file
  /// @throws InputError if the scenario cannot be read or has no [sweep] table
  Sweep(std::string scenario_path, std::vector<std::string> changes,
        std::optional<std::string> text = {});

  /// The scenario as it is without its sweep. Its `swept_files` are those that values of the sweep
  /// and its samples name, and the machines that these are based on, one line each: "CHECKSUM
  /// NAME", or "unreadable NAME"; sorted. They belong to what the sweep is: a table of it is not
  /// gone on with when they have changed.
  const model::Scenario& base() const { return *base_; }
  const model::SweepDesign& design() const;
  /// Name of the scenario.
  const std::string& name() const;
  /// Notes on parts of the scenario that a sweep omits: its day, windows of the recording.
  std::vector<std::string> left_out() const;

  /// Reads the scenario with the values of a point set as --set would. Names of files among the
  /// values are relative to the scenario that holds the list. Sample n is probed with a noise of
  /// its own, cmm.seed + n, unless the sweep varies that seed.
  /// @throws InputError at the values that are refused
  model::Scenario at(std::uint64_t point) const;

  /// quantities_of() the base.
  std::vector<evaluation::ComparisonRow> quantities() const;

  /// Refuses what is wrong at every point, such as a key that there is not: points are read and
  /// prepared, from the first to the last in equal steps, until one is found right. A point at
  /// which the system fails is not wrong.
  /// @throws InputError
  /// @return what the first right point takes on one thread, where one was found
  std::optional<preparation::RunEstimate> refuse_hopeless() const;

  /// Reads and prepares all points, of more than 256 so many in equal steps.
  /// @throws InputError at the first point that is refused
  void check() const;

 private:
  InputError at_the_list(const InputError& error, const std::vector<std::string>& values) const;
  std::string assignment(std::size_t key, const std::string& value) const;
  std::optional<std::string> named_file(std::size_t key, const std::string& value) const;
  std::string swept_files() const;
  bool draws_probing_noise() const;

  std::string path_;
  std::vector<std::string> changes_;
  input::ScenarioSource source_;
  std::shared_ptr<const model::Scenario> base_;
};

}  // namespace servomill::sim::sweep
