/// The table of a sweep as comma-separated values.
#pragma once

#include <string>

#include "sim/sweep/selection.h"

namespace servomill::sim::sweep {

/// "OUT.csv" for "OUT.h5".
std::string csv_name(const std::string& path);

/// File of the table of a sweep, beside which "OUT.csv" is to be written, too.
/// @param shard  "I/N" of --shard; empty: the file has the name that it is given
/// @throws InputError if one of the two cannot be replaced or gone on with
std::string writable_table(std::string path, const Selection& selection, const std::string& shard,
                           bool force);

/// The table as comma-separated values: the columns of the HDF5 file, texts in place of their
/// numbers, statuses by name; numbers so that they read again to the same bits.
/// @throws SystemError
void write_csv(const std::string& table, const std::string& csv);

/// A CSV file of a sweep may be replaced where `force` is set, no other.
/// @throws InputError
void refuse_foreign_csv(const std::string& path, bool force);

}  // namespace servomill::sim::sweep
