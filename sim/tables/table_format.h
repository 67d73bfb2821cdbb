/// The formats in which NCs take compensation tables, and what each of them can hold.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace servomill::sim::tables {

enum class TableFormat : std::uint8_t {
  linuxcnc,
  heidenhain,
  siemens,
  csv,
  isg,
  etalon,
  marlin,
  klipper,
  reprapfirmware
};

inline constexpr std::array<std::string_view, 9> kTableFormats = {
    "linuxcnc", "heidenhain", "siemens", "csv",           "isg",
    "etalon",   "marlin",     "klipper", "reprapfirmware"};

/// Dependence on the direction of travel that a format holds: `own`, only of a table over the
/// position of the compensated axis itself.
enum class DirectionRule : std::uint8_t { none, own, all };

struct FormatRules {
  std::string_view document;  // that the format follows
  std::size_t most_points;    // in one table
  bool cross;                 // one axis corrected over the position of another one
  bool power_of_two;          // older controls: spacing 2^n x 0.1 um
  bool one_turn;              // entries of rotary axes lie within 0..360 deg
  bool wraps;                 // the table of an endless axis repeats
  DirectionRule direction;    // of travel
  double length_step;         // m, last digit written
  double angle_step;          // rad
  bool components = false;    // holds the errors by their names, not displacements of axes
  bool tool_side = false;     // every axis counts as carrying the tool (tool_side_errors.h)
  bool grids = false;         // component errors over several axes
  bool skew = false;          // holds the squareness of X, Y and Z only
};

const FormatRules& rules_of(TableFormat format);

inline std::string_view name_of(TableFormat format) {
  return kTableFormats[static_cast<std::size_t>(format)];
}

/// Older Heidenhain controls: spacing 2^n times this (TNC 407/415/425 Technical Manual, 1998,
/// page 153), and no step between points larger than the spacing over kGridSteps (page 156).
inline constexpr double kGridStep = 0.1e-6;  // m
inline constexpr double kGridSteps = 64.0;

}  // namespace servomill::sim::tables
