/// Options of the commands that look at the servo loops of one axis.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/ticks.h"
#include "sim/config/quantity.h"
#include "sim/model/forward.h"
#include "tools/servomill/command.h"

namespace servomill::tools {

/// Adds --axis, --case and --set.
void add_axis_options(Options& options);

/// Machine and feedback hardware of a scenario as --case has them.
/// @throws InputError for a case that there is not
void restrict_to_case(const Options& options, sim::model::Scenario& scenario);

/// The scenario of the command, its machine and feedback hardware as --case has them.
/// @throws InputError for a case that there is not
std::shared_ptr<const sim::model::Scenario> scenario_for_axes(const Options& options);

/// Joints that --axis names: one, several ("X,Y") or all.
/// @throws InputError for an axis that the machine lacks
std::vector<int> chosen_joints(const Options& options, const sim::model::MachineSettings& machine);

/// Value of an option that takes a number with a unit ("20 um"), in SI. A bare number is in
/// `bare_unit`, which the help of the option names.
/// @throws InputError
std::optional<double> quantity_option(const Options& options, const std::string& name,
                                      sim::config::Quantity quantity, std::string_view bare_unit);

/// The same, which must be > 0.
std::optional<double> positive_option(const Options& options, const std::string& name,
                                      sim::config::Quantity quantity, std::string_view bare_unit);

/// Unit of a bare number where the quantity depends on other options: mm, mm/s, N; deg, deg/s, Nm.
std::string_view bare_unit(sim::config::Quantity quantity);

/// Machine coordinate of Z that --retract names (m): "Z=400", "Z=400 mm".
/// @throws InputError
std::optional<double> retract_option(const Options& options);

/// Value of an option that takes a bare number > 0.
/// @throws InputError for anything else, NaN included
double positive_number(const Options& options, const std::string& name);

/// Value of an option that takes a ratio > 0 dB: "8 dB", "8".
/// @throws InputError
double decibel_option(const Options& options, const std::string& name);

/// A word out of several. @throws InputError with the nearest
std::size_t choice_option(const Options& options, const std::string& name,
                          std::span<const std::string_view> words);

/// Machine, axis, periods and reading delay in one line.
std::string axis_headline(const sim::model::MachineSettings& machine, int joint,
                          Tick reading_delay);

/// The same axis as a reader names a length of it: "um" or "urad".
inline const char* small_unit(int joint) { return joint < kLinearJoints ? "um" : "urad"; }

double decibel(double ratio);

}  // namespace servomill::tools
