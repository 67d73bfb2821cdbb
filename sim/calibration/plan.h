/// Planning of the measurements to take next: set-ups of the instruments at hand that lower the
/// worst uncertainty of the tip in the working volume most for the time they take.
#pragma once

#include <string>
#include <vector>

#include "sim/calibration/calibration.h"
#include "sim/calibration/optimal_design.h"
#include "sim/model/forward.h"

namespace servomill::sim::calibration {

enum class PlanInstrument : std::uint8_t { laser, level, square, ballbar, probe };
inline constexpr std::array<std::string_view, 5> kPlanInstruments = {"laser", "level", "square",
                                                                     "ballbar", "probe"};

struct PlanSettings {
  std::vector<PlanInstrument> instruments;
  double time = 8.0 * 3600.0;  // s
  std::vector<double> tool_lengths = {0.1,
                                      0.2};  // m; of measured points and of the tips that count
};

/// A set-up that can be taken, with its rows and without their numbers.
struct PlannedSetUp {
  readings::Group group;
  double time = 0.0;                // s, once
  int count = 0;                    // how often to take it
  bool through_the_middle = false;  // as ISO 230 places it
};

/// Uncertainties are those of the errors that the set-ups can tell (measurable.h).
struct Plan {
  std::vector<PlannedSetUp> set_ups;  // all candidates
  double before = 0.0;                // m, worst standard uncertainty of the tip with what is known
  double after = 0.0;                 // m, with the plan
  double usual = 0.0;       // m, with lines through the middle of the travel, in the same time
  double bound = 0.0;       // m, that no plan of these candidates goes below
  double efficiency = 1.0;  // of variances: bound^2 / after^2
  double beyond = 0.0;      // m, worst standard uncertainty of the tip that none of them lowers
  std::vector<std::string> untold;  // errors of which this is most
};

/// @param taken  readings that are there already; none: nullptr
/// @throws InputError if an axis has no travel, no instrument applies to the machine, the time is
///                    too short for every set-up, or none of them lowers the uncertainty
Plan plan_calibration(const model::MachineSettings& machine, const PlanSettings& settings,
                      const readings::Readings* taken);

/// The plan as text: what to measure, and what it is expected to give.
std::string report(const Plan& plan, const PlanSettings& settings);

/// The same as one JSON object: the chosen set-ups, worst uncertainties of the tip (k = 2).
std::string report_json(const Plan& plan, const PlanSettings& settings);

/// Its set-ups as readings, once for each time they are to be taken; their numbers are missing.
readings::Readings planned_readings(const Plan& plan);

}  // namespace servomill::sim::calibration
