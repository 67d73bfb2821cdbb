/// Causes of residuals, taken away from cases.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "sim/model/forward.h"

namespace servomill::sim::run {

/// Causes of a residual. Taking a cause away (of the case and of the case that it is
/// compared with) means:
enum class Cause : std::uint8_t {
  lag,         // loops and drives: axes stand where the NC wants them (servo = "ideal")
  table,       // points of compensation tables, lines for several axes, their ends: the error
               // itself (layout = "continuous")
  delay,       // response, dead time and update of tables, signal delay and model period of the
               // feedback hardware, delay of the scales: 0, and one base tick for the model
  saturation,  // limits of virtual displacements: out of reach
  single_evaluation,  // errors evaluated where displacing changes them: iterations = "converged"
  identification,  // strategies know the actual errors (or, without one, in the imposed model), and
                   // in the origin of the case (rewrite_origin = "case")
  friction,        // dry friction, backlash, cogging, and what the NC does against them: none
  measurement,     // errors, noise, steps, marks of encoders, errors of screws: none
  cutting,         // the case runs in air
  inertia,         // structure under acceleration: rigid, and its bed stands still
  heat,            // temperatures: the machine at its reference temperature
  interpolation,   // chords of rewritten programs and path tolerances a hundredth, no
                   // nominal-position filter, no block time
  uncorrected,     // errors of the machine that no strategy of the case corrects: none
  uncorrectable,   // stays without all others: what the axes of the strategies cannot do, and
                   // the hundredth of tolerances
  imposed,         // likewise: imposed on purpose by strategies
};
inline constexpr std::size_t kCauses = 15;
/// Kinds of errors that a machine has: after Andolfatto et al. (2011) static, servo, dynamic and
/// thermal, here with the force of the cut. Static geometry: all that its errors and their
/// compensation leave. Imposed errors are on purpose.
enum class CauseGroup : std::uint8_t { geometry, servo, inertia, heat, force, imposed };
inline constexpr std::array<std::string_view, 6> kCauseGroups = {
    "static geometry", "servo", "inertia", "heat", "force", "imposed"};
struct CauseInfo {
  std::string_view name;  // "lag", "table", ...
  std::string_view help;
  CauseGroup group = CauseGroup::geometry;
};
const CauseInfo& info_of(Cause cause);
using Causes = std::set<Cause>;

/// Causes in the order in which the signal passes them.
inline constexpr std::array kChain = {Cause::interpolation, Cause::lag, Cause::delay};
/// Causes that add to the signal, beside measurement.
inline constexpr std::array kAdding = {
    Cause::table,          Cause::saturation, Cause::single_evaluation,
    Cause::identification, Cause::friction,   Cause::cutting,
    Cause::inertia,        Cause::heat,       Cause::uncorrected};

/// All that can be taken away.
Causes all_causes();

/// Causes that are present in a case. An ideal servo has none of the loops.
Causes present(const Causes& causes, const model::Scenario& scenario, const model::CaseSpec& one);

/// Cause that remains without all others; none if it begins behind the strategies.
/// @param base  the case it is compared with, or nullptr
std::optional<Cause> rest_of(const model::QuantitySpec& quantity, const model::CaseSpec& one,
                             const model::CaseSpec* base);

/// The cases that have a cause to be removed that another run has not removed already, without it.
/// @param present_in  by case; others are left out
model::Scenario without(const model::Scenario& scenario, const Causes& removed,
                        const Causes& already, const std::map<std::string, Causes>& present_in);

}  // namespace servomill::sim::run
