/// Declaration of a strategy: its name, its keys and what it can do.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string_view>

#include "plant/vocabulary/parameters.h"
#include "strategies/strategy.h"

namespace servomill::strategies {

/// All that the other rooms know of a strategy: they ask what it can do and never compare its name.
struct Entry {
  std::string_view name;
  std::string_view summary;
  std::span<const ParameterSpec> parameters;
  /// @throws InputError without a place when the parameters contradict the identified model
  std::function<std::unique_ptr<Strategy>(const Parameters&, Action, const IdentifiedMachine&)>
      make;
  bool reads_gains = false;  ///< false: IdentifiedMachine::Kv is NaN, so that nothing depends on it
  bool reads_errors = true;  ///< false: knows no geometric errors, and takes neither model nor sign
  bool acts = true;          ///< false: leaves everything as it is
  /// Margins from which its gain follows (IdentifiedMachine::added_gain); nullptr or nullopt: none.
  std::optional<WantedMargins> (*wanted_margins)(const Parameters&) = nullptr;
  /// Tells if it knows the position loops and the friction (IdentifiedMachine::loops): it may then
  /// know a machine of its own; nullptr: it never does.
  bool (*reads_loops)(const Parameters&) = nullptr;
  bool once = false;  ///< true: a second one in a case would correct the same again
  /// True if it corrects how axes and structure follow the path: it moves nothing off it on
  /// purpose.
  bool corrects_following = false;
  bool corrects_inertia = false;  ///< true: what it corrects is the structure under acceleration
  bool corrects_heat = false;     ///< true: errors by temperature, of a machine with heat
  bool imposes = true;            ///< false: its `action` can only be to compensate
  bool runs_program = false;      ///< true: it has the program run before it acts
  /// Parameters of these runs that recordings of actual ones stand for; empty: it reads none.
  std::span<const std::string_view> recorded_instead = {};
  /// True if the thermal network of the known machine is computed for it
  /// (TemperatureReading::bodies); nullptr: it never is.
  bool (*computes_heat)(const Parameters&) = nullptr;
  /// True if it may know a machine of its own (key `machine`).
  bool knows_machine(const Parameters& p) const {
    return runs_program || corrects_heat || (reads_loops != nullptr && reads_loops(p));
  }
  /// Use of the feedback hardware by its signals: a case has one, and so one such
  /// strategy. True exactly where Strategy::displaces_feedback() is.
  bool uses_feedback_hardware = false;
  /// "strategy ramp (libramp.so)" if it comes from a shared library, whose functions may crash or
  /// not return; empty: it is one of the tree.
  std::string_view plugin = {};
  /// Tells if it adds the error where the machine starts, which two strategies of a case that know
  /// the same model must not both do; nullptr: no parameter decides that.
  bool (*holds_error_at_reference)(const Parameters&) = nullptr;
};

}  // namespace servomill::strategies
