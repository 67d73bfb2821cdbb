/// Programs compensated and run on a machine that has just the errors that were identified.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "controllers/gcode/interpreter.h"
#include "plant/vocabulary/move_curve.h"
#include "plant/vocabulary/units.h"
#include "sim/input/read_errors.h"
#include "sim/model/scenario.h"
#include "sim/programs/canonical_moves.h"
#include "sim/programs/compensate/compensate.h"
#include "sim/programs/compensate/correction.h"

namespace servomill::sim::programs {

inline const std::string kWrittenPrefix = "compensate_";

inline std::string written(const std::string& name, const std::string& text) {
  // a folder for each test program: they may run beside each other
  const std::string folder = fmt::format("{}trial_{}", testing::TempDir(), getpid());
  std::filesystem::create_directories(folder);
  const std::string path = folder + "/" + kWrittenPrefix + name;
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

inline const std::string kRouter = SERVOMILL_SOURCE_DIR "/scenarios/machines/router_3axis.toml";
inline const std::string kTools = "T1 P1 Z+40 D+6\nT2 P2 Z+55.5 D+8\n";
inline const std::string kOffsets =
    "5220 1\n5221 200\n5222 250\n5223 -90\n5241 300\n5242 200\n5243 -95\n5250 12.5\n";

struct Trial {
  CompensateRequest request;

  explicit Trial(const std::string& program, const std::string& name = "part.ngc") {
    request.program_file = written(name, program);
    request.machine_file = kRouter;
    request.inputs.tool_table = written("tools.tbl", kTools);
    request.inputs.parameter_file = written("offsets.var", kOffsets);
  }
  Compensated run() const { return compensate(request); }
};

/// Program without its header, which is all comments at the top.
inline std::string without_header(const std::string& text) {
  std::string out;
  bool in_header = true;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    const std::string line = text.substr(from, end - from);
    const bool is_header =
        in_header &&
        (line.starts_with("(servomill compensate") || line.starts_with("(path within") ||
         line.starts_with("(assumed") || line.find("unrolled)") != std::string::npos ||
         line.find("replaced by") != std::string::npos);
    if (!is_header && line != "%") in_header = false;
    if (!is_header) out += line + "\n";
    from = end + 1;
  }
  return out;
}

/// The moves of a program on the machine of a request.
inline std::vector<Move> moves_of(const std::string& text, const CompensateRequest& request) {
  controllers::ProgramSetup setup = program_setup(request.inputs, request.program_file);
  return controllers::interpret(text, "text", setup);
}

/// The fault of a program, from the name of its file on as `written` was given it; "taken" if none.
inline std::string refusal(const Trial& trial) {
  try {
    trial.run();
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(what.find(kWrittenPrefix) + kWrittenPrefix.size());
  }
  return "taken";
}

}  // namespace servomill::sim::programs
