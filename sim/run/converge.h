/// Dependence of the numbers of a comparison on what a computation chooses: the same scenario with
/// one step halved at a time.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/evaluation/comparison_row.h"
#include "sim/input/scenario_source.h"
#include "sim/model/forward.h"
#include "sim/run/run.h"

namespace servomill::sim::run {

/// A step that can be halved.
enum class Refinement : std::uint8_t {
  recording,  // period of the recorder: what the comparison is sampled from
  block,      // length of the blocks of rewritten programs; their chord tolerance a quarter, which
              // is that of chords of half the length
  solver,     // tolerance of drives that are not linear; linear ones are propagated exactly
  tick,       // base period, all periods and delays in seconds as they are
};
inline constexpr std::size_t kRefinements = 4;
struct RefinementInfo {
  std::string_view name;  // "recording", ...
  std::string_view help;
};
const RefinementInfo& info_of(Refinement refinement);

/// One line of the comparison and what becomes of it.
struct ConvergedRow {
  evaluation::ComparisonRow row;              // of the scenario unchanged
  std::array<double, kRefinements> change{};  // with the step halved, minus `row`; NaN: not known
  double resolution = 0.0;                    // of what it is computed from, in the unit of `row`

  /// Bound of the error that the steps leave. An error of first order is as large as twice what
  /// halving changes, one of a higher order is less. No digit below the resolution r is known:
  ///   e = max(2 sum |change|, r / 2)                                                        (1)
  double error() const;
  /// Tells if the resolution, not a change, says which digits there are.
  bool is_limited_by_resolution() const;
  /// Significant digits of the value that an error e does not reach: e <= half a unit of the last
  /// one. At most kAllDigits, which is what a value has that nothing changes; 0 where there is none
  /// or a change is not known.
  int digits() const;
  /// The value with these digits, such as "0.10"; "-" without any.
  std::string stable() const;
};
inline constexpr int kAllDigits = 9;

struct Convergence {
  std::vector<ConvergedRow> rows;
  /// Reason why a step was not halved; empty: it was, or the scenario has no such step and nothing
  /// changes.
  std::array<std::string, kRefinements> why_not;
  /// Blocks that are left alone: their lengths or tolerances are inputs of the scenario.
  std::vector<std::string> inputs;   // "case one: strategy gcode: max_block_mm"
  std::vector<std::string> stopped;  // "case one: axis Y: following error ..."
  std::optional<std::string> note;   // of tests whose parameters are missing
};

struct ConvergeControl {
  unsigned threads = 0;  // 0: one a core
  const engine::StopFlag* stop = nullptr;
};

/// Resolution (um or urad by `unit`; else 0: not known; of shares of the imposed displacement
/// find_convergence has it) of what a row is computed from: the larger
/// of the rounding of recorded values and, if the case has servo loops, the measuring step of its
/// scales, of one axis or the largest of its kind.
double resolution_of(const model::Scenario& scenario, const evaluation::ComparisonRow& row);

/// Lengths and tolerances of blocks to which the scenario gives other values than the defaults,
/// such as one that is identified: they are inputs, not steps of the computation.
std::vector<std::string> blocks_as_inputs(const model::Scenario& scenario);

/// The keys of a scenario, as --set takes them, that halve one of its steps; empty: it has none.
std::vector<std::string> halved(Refinement refinement, const model::Scenario& scenario);

/// Runs a scenario unchanged and once with each of these steps halved.
/// @return nullopt if it was stopped
/// @throws InputError before anything is simulated
std::optional<Convergence> find_convergence(const input::ScenarioSource& source,
                                            const std::set<Refinement>& refinements,
                                            const ConvergeControl& control = {});

/// The rows as text, aligned; with what could not be halved below them.
std::string format_table(const Convergence& found);

/// One JSON object: that of its comparison with changes (by name; null where it is not known),
/// digits and stable (null without digits).
std::string to_json(const ConvergedRow& row);

}  // namespace servomill::sim::run
