/// The whole of a calibration: what is looked for, the adjustment, and what its residuals say of
/// the readings.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/calibration/adjustment.h"
#include "sim/calibration/contradictions.h"

namespace servomill::sim::calibration {

/// A grid over the axis of an error and another one, as a form asks for it.
struct GridSettings {
  Axis across = Axis::X;                    // the other axis
  std::array<std::optional<int>, 2> knots;  // of its own axis, of the other one; none: the targets
};

/// Form of one error, or of all, as the table `adjustment` of a file of readings asks for it.
struct FormSettings {
  std::optional<int> degree;
  std::optional<std::vector<double>> knots;            // m or rad; empty: none
  std::optional<int> number_of_knots;                  // equally spaced over the readings
  std::vector<double> periods;                         // m or rad
  bool degree_by_data = false, knots_by_data = false;  // by cross-validation
  std::optional<int> reversal_degree;
  std::optional<double> reversal_distance;  // m or rad
  std::optional<double> size;               // m or rad; standard deviation that is expected
  std::vector<GridSettings> grids = {};     // of one error: over another axis, too
};

struct CalibrationSettings {
  /// First axis: straight along itself by convention; second: in the plane of both.
  std::array<Axis, 2> frame = {Axis::X, Axis::Y};
  std::vector<plant::ErrorName> errors;   // that are looked for; empty: all
  FormSettings form_linear, form_rotary;  // of component errors without a form of their own
  std::vector<std::pair<plant::ErrorName, FormSettings>> forms;
  bool robust = false;
};

/// Reads the table `adjustment`; without one, the defaults.
/// @throws InputError
CalibrationSettings read_settings(const std::string& path, const JointLayout& layout);

/// Location errors of a machine in a frame that its first two axes define: squarenesses, then tilts
/// and offsets of the rotary axes. Those of the frame are 0 by convention.
std::vector<plant::ErrorName> sought_locations(const plant::MachineChain& chain,
                                               const std::array<Axis, 2>& frame);

/// Degree or number of knots that predicts readings best which were left out.
struct Smoothness {
  std::string form;  // "linear", "EYX"
  bool is_of_knots = false;
  int chosen = 0;
  std::vector<std::pair<int, double>> errors;  // of each that was tried, in standard uncertainties
};

/// Chooses what a form leaves to the data: the smallest of the degrees 1 to 9 or numbers of knots 2
/// to 17 whose readings are predicted as well as by the best, within 1 %. Forms follow each other.
/// @param adjusted  adjustment with these settings, with predictions
std::vector<Smoothness> choose_smoothness(
    CalibrationSettings& settings,
    const std::function<Adjustment(const CalibrationSettings&)>& adjusted);

struct Calibration {
  readings::Readings readings;
  CalibrationSettings settings;
  Observations observations;
  Adjustment adjustment;
  std::vector<Outlier> outliers;          // largest first
  std::vector<Suspect> suspects;          // groups that fit with another sign or unit
  std::vector<Smoothness> smoothness;     // of forms that the data have chosen
  std::vector<Axis> one_way;              // axes whose positions are read in one direction only
  std::vector<plant::ErrorName> unmoved;  // sought errors of axes that no group moves
};

/// @throws InputError where nothing can be adjusted
Calibration calibrate(readings::Readings readings, const plant::MachineChain& chain,
                      const CalibrationSettings& settings);

/// Standardized residuals above it are outliers: among n of normal noise, one in a thousand
/// adjustments has one, since P(|z| > t) <= exp(-t^2/2).
double outlier_limit(std::size_t n);

/// Error of a function reached upwards minus that reached downwards, in the middle of the travel,
/// and its standard uncertainty (m or rad); none: not looked for.
std::optional<std::pair<double, double>> reversal_of(const Adjustment& adjustment,
                                                     const SoughtFunction& function);

/// Component error with its standard uncertainty along the travel.
struct KnownFunction {
  plant::ErrorName name;
  std::vector<double> s;                              // m or rad
  std::vector<double> value, sigma;                   // m or rad
  std::vector<double> expected;                       // m or rad; sigma without any reading
  std::optional<std::pair<double, double>> reversal;  // reversal_of()
};
/// Every function of which something is known, at `points` equally spaced places, more where it has
/// shorter periods.
std::vector<KnownFunction> functions_along_travel(const Adjustment& adjustment, int points = 41);

/// A component error over two axes beside its mean over the other one, as it was found.
struct KnownGrid {
  plant::ErrorName name;
  GridForm form;
  double least = 0.0, most = 0.0;  // m or rad, at its knots
  double sigma = 0.0;              // m or rad, largest standard uncertainty at its knots
  bool is_combined = false;        // a part of it is left out, or holds what was left out
};
std::vector<KnownGrid> known_grids(const Adjustment& adjustment);

/// Error at positions of its own axis, at one position of the other axis of its grid.
struct KnownLine {
  plant::ErrorName name;
  Axis across = Axis::X;
  double at = 0.0;                      // m or rad of the other axis
  std::vector<double> s, value, sigma;  // m or rad
};
/// At each knot of the other axis of each grid, whose function of the own axis is part of it.
std::vector<KnownLine> lines_of_grids(const Adjustment& adjustment);

/// "EA0C is determined only in combination: EA0Y holds EA0Y + EA0C", one sentence for each
/// combination; functions without any effect on the readings in one sentence.
std::vector<std::string> unidentifiable_sentences(const Calibration& calibration);

/// Errors of which the readings determine nothing: they have no number in the file.
std::vector<plant::ErrorName> undetermined_errors(const Calibration& calibration);

/// True if a part of an error is left out, or holds what was left out of another.
bool is_combined(const Adjustment& adjustment, const plant::ErrorName& name);

}  // namespace servomill::sim::calibration
