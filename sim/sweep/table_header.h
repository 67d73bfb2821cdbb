/// Header of a sweep file, before its table.
#pragma once

#include <cstdint>
#include <string>

#include "sim/model/scenario.h"
#include "sim/sweep/selection.h"

namespace servomill::sim::records {
class InputFile;
}  // namespace servomill::sim::records

namespace servomill::sim::sweep {

/// Version of the layout of sweep files; a file of another one is refused.
inline constexpr int kSweepSchemaVersion = 3;

/// A file of both `before` and `after` that is not the same (Scenario::swept_files); empty: there
/// is none. Lists of other files belong to other scenarios.
std::string changed_file(const std::string& before, const std::string& after);

/// Content of the header.
struct SweepHeader {
  model::Scenario base;  // as stored; the keys of its sweep may stand in another order
  std::uint64_t points = 0;
  Selection selection;
};

/// @throws InputError if the file is no table of a sweep of this version
SweepHeader read_sweep_header(const records::InputFile& file);

/// True of a table that was begun but got no row. A small file that HDF5 opens is not taken for
/// one.
/// @throws InputError if the file is one of HDF5 that cannot be read
bool is_unborn(const std::string& path);

/// Why a file is not the table of this sweep; empty: it is.
std::string why_other(const SweepHeader& header, const model::Scenario& base,
                      const Selection& selection);

}  // namespace servomill::sim::sweep
