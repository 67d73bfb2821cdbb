/// The list of quantities that a scenario may ask for. Keys, units, help texts and evaluation all
/// follow from an entry; nothing else compares the name of a quantity.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/metrology/probing_plan.h"

namespace servomill::sim::model {
struct QuantitySpec;
}  // namespace servomill::sim::model

namespace servomill::sim::evaluation {

struct CaseData;
struct CaseEvaluation;

/// Value of a recording at a row; rows are asked for in rising order. Empty: was not recorded.
using AtRow = std::function<double(std::size_t)>;

/// A value in the unit of the entry; NaN and why, where there is none.
struct QuantityValue {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::string note = {};  // also what is not alike, or not complete
};

/// Tells if a quantity of a ball takes [[quantity.bar]] in place of sections.
enum class BallBars : std::uint8_t { none, optional, required };

/// QuantityEntry::probes of a quantity of any number of features, unless named of all.
inline constexpr int kEveryProbe = 1000;

struct QuantityEntry {
  std::string_view name;
  std::string_view unit;
  std::string_view help;

  // keys of [[quantity]]
  std::string_view axes = {};     // letters allowed of `axis`; none: has no such key
  bool has_statistic = false;     // what `evaluate` returns is that of spec.statistic
  bool needs_baseline = false;    // another case to compare with
  bool needs_covariance = false;  // of the identified errors of the machine
  bool needs_imposed = false;     // the scenario's imposed error model, which it subtracts
  bool needs_day = false;         // of the scenario
  int circles = 0;                // sections evaluated together, each one turn of a circle; 0: any
  bool is_r_test = false;  // in the spindle, seen by sensors on the table: r_test_quantities.h
  BallBars bars = BallBars::none;
  bool identifies = false;  // location errors from readings: a line for each of them
  int probes = 0;           // features of the part evaluated together: probe_quantities.h; a
                            // base case is then optional unless needs_baseline
  std::span<const metrology::FeatureKind> kinds = {};  // of these features
  bool has_fit = false;                                // minimum zone or least squares

  /// Evaluates one case.
  /// @param base  the case it is compared with; nullptr: none
  /// @pre both cases have finished, unless is_of_program
  QuantityValue (*evaluate)(const model::QuantitySpec& spec, CaseEvaluation& one,
                            const CaseData* base) = nullptr;
  bool is_of_program = false;  // known of a case that stopped, too
  /// Recorded signals that `evaluate` reads beside time, s, line, section and rapid; none: any.
  /// Points of a sweep record no others.
  std::optional<std::span<const std::string_view>> reads = {};
  bool reads_demands = false;  // CaseData::demands

  // for budgets and convergence
  /// Signed value in `unit`, sample by sample: PathSignal. nullptr: it has none
  AtRow (*signal)(const model::QuantitySpec& spec, const CaseData& one,
                  const CaseData* base) = nullptr;
  bool is_of_servo = false;            // of the servo loops alone: no geometric error is left in it
  std::string_view derived_from = {};  // the signal that it condenses; in % it is a share of it

  bool needs_axis() const { return !axes.empty(); }
  /// True if it is of a shape, whose points at equal intervals all count.
  bool needs_every_row() const { return circles > 0 || is_r_test; }
};

/// All of them, by family.
std::span<const QuantityEntry> quantities();
std::vector<std::string_view> quantity_names();
/// The entry of that name, or nullptr.
const QuantityEntry* find_quantity(std::string_view name);
/// @pre one of quantity_names()
const QuantityEntry& quantity_entry(std::string_view name);

}  // namespace servomill::sim::evaluation
