/// Cutter locations in a file to a program in a file.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/gcode/post_processor.h"

namespace servomill::sim::programs {

struct PostRequest {
  std::string cl_file, machine_file;
  std::vector<std::string> changes;            // "KEY=VALUE": of the machine
  std::string tool_table;                      // of LinuxCNC's format; empty: none
  std::optional<double> tool_length;           // m, of every tool; without table
  std::vector<std::string> tool_lengths;       // "1=50": of tool 1, in place of these
  bool has_no_tool = false;                    // before the first LOADTL, with tool_length 0
  std::optional<Eigen::Vector3d> work_offset;  // m: options.work_offset
  std::optional<double> retract_Z;             // m, machine coordinate: options.safe.retract_Z
  std::string start;  // "A=10,C=90" in mm and deg: options.start; empty: all axes at zero
  controllers::PostOptions options;  // tools, work offset, retract height and start are filled in
};

struct PostProcessedFile {
  std::string program;
  std::vector<controllers::Warning> warnings;
  std::size_t locations = 0, inserted = 0;
  std::string verified;  // result of the verification, for the reader
};

/// The height to retract to is that of the request, of the machine file (axis.Z.retract_mm), or the
/// upper end of the travel of Z. The program is verified (sim/programs/verify_post.h).
/// @param of_refused  where a fault ends it: receives the warnings until then
/// @throws InputError as the reader of the machine, of the tool table, of the locations and the
/// post-processor do
PostProcessedFile post_file(PostRequest request,
                            std::vector<controllers::Warning>* of_refused = nullptr);

}  // namespace servomill::sim::programs
