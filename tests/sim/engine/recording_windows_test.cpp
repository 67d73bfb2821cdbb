#include "sim/engine/recording_windows.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim/engine/program_path.h"
#include "sim/model/scenario.h"
#include "sim/preparation/case_program.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::engine::recording_windows_test {
namespace {

ProgramPath path_of(const std::string& program) {
  const model::Scenario scenario = small_scenario(program, "[[case]]\nname = \"one\"\n");
  const auto moves = preparation::read_program(scenario, scenario.cases.front()).all();
  return {moves, AxisWords::Zero()};
}

// Numbers of the pieces inside, "0 2 3".
std::string inside(const model::RecordWindows& windows, const ProgramPath& path) {
  const RecordingWindows found(windows, path);
  std::string out;
  for (std::size_t piece = 0; piece < path.size(); ++piece) {
    if (found.contains(piece, 1e9)) out += (out.empty() ? "" : " ") + std::to_string(piece);
  }
  return out;
}

// Pieces 0; a 1 2; b 3; a 4; a 5 6; b 7.
constexpr const char* kSections =
    "G1 X1 F1000\n(MSG, a)\nX2\nX3\n(MSG, b)\nX4\n(MSG, a)\nX5\n(MSG, a)\nX6\nX7\n(MSG, a)\n"
    "(MSG, b)\nX8\nM2\n";

TEST(RecordingWindows, CountPassesOfEachSection) {
  const ProgramPath path = path_of(kSections);
  EXPECT_EQ(inside({{"a"}, {}, {}, 1}, path), "1 2 4 5 6");
  EXPECT_EQ(inside({{"a"}, {}, {}, 2}, path), "1 2 5 6");
  EXPECT_EQ(inside({{"a"}, {}, {}, 3}, path), "1 2");
  EXPECT_EQ(inside({{"a", "b"}, {}, {}, 2}, path), "1 2 3 5 6");
  EXPECT_EQ(inside({}, path), "0 1 2 3 4 5 6 7");
}

TEST(RecordingWindows, ContainBothEndsOfATime) {
  const ProgramPath path = path_of(kSections);
  const RecordingWindows windows({{"b"}, {}, {{0.1, 0.3}, {2.0, 3.0}}, 1}, path);
  EXPECT_TRUE(windows.limited());
  EXPECT_TRUE(windows.contains(0, 0.1));
  EXPECT_TRUE(windows.contains(0, 3 * 0.1));  // 0.30000000000000004
  EXPECT_FALSE(windows.contains(0, 0.30001));
  EXPECT_TRUE(windows.contains(3, 0.5));
  EXPECT_FALSE(windows.contains(0, 1.99999));
  EXPECT_TRUE(windows.contains(0, 3.0));
  EXPECT_FALSE(RecordingWindows().limited());
}

}  // namespace
}  // namespace servomill::sim::engine::recording_windows_test
