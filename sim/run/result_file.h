/// Result files of all kinds: their names, the build that wrote them, the version of their layout.
#pragma once

#include <string>
#include <vector>

namespace servomill::sim::records {
class Hdf5Group;
class InputFile;
}  // namespace servomill::sim::records

namespace servomill::sim::run {

/// Version of the layout of result files; a file of another one is refused.
inline constexpr int kSchemaVersion = 1;

/// Writes version and build of this program (sim/run/build_identity.h) to a file.
void write_build(records::Hdf5Group& root);
/// The build that wrote a file; only its version if it is older than that.
std::string build_of(const records::InputFile& file);

/// The lines of a text attribute: one more than it has line breaks.
std::vector<std::string> split_lines(const std::string& text);

/// True if a file begins as HDF5 does.
bool is_hdf5(const std::string& path);

/// The name under which a result file may be made (sim/system/output_name.h): neither it nor its
/// partial file exists, or `force` is set and it is a result file (anything else is never
/// overwritten).
/// @throws InputError, SystemError while another process writes it
std::string writable_name(const std::string& path, bool force);

}  // namespace servomill::sim::run
