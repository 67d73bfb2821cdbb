/// Writes identified values as a machine file (identified_values.h).
#pragma once

#include <string>
#include <vector>

#include "sim/input/identified_values.h"

namespace servomill::sim::input {

/// A value that the file sets without knowing its uncertainty.
struct HeldValue {
  std::string key, unit;
  double value = 0.0;
  std::string why;  // "at its bound"
};

struct IdentifiedFile {
  std::vector<std::string> comments;  // lines at the top, without "# "
  std::string based_on;               // machine that was started from, relative to the file
  IdentifiedValues identified;
  /// Expanded uncertainties (k = 2), one a key in its unit, for the comments; empty: twice the
  /// standard deviations.
  std::vector<double> half_widths;
  std::vector<HeldValue> held = {};  // beside the identified ones
};

/// The text of the file. Numbers have as many digits as they need to be read again to the same
/// bits.
/// @pre as many keys as units, values, and rows and columns of the covariance
std::string identified_text(const IdentifiedFile& file);

/// Writes the file. Before it gets its name, its text is read as the machine that it will be, and
/// compared: keys, units, values and covariance to the bit.
/// @throws InputError if it may not be written there, the machine that it is based on cannot be
/// read, or the machine refuses a value: with the line that the file would have had
void write_identified_file(const std::string& path, const IdentifiedFile& file, bool force);

/// The name of a machine file as a file at `path` gives it: relative to its folder.
std::string machine_seen_from(const std::string& path, const std::string& machine);

}  // namespace servomill::sim::input
