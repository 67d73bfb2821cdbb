#include "sim/programs/line_stage.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

namespace servomill::sim::programs::line_stage_test {
namespace {

TEST(LineStage, StandsStillInALoop) {
  const std::string file = (std::filesystem::temp_directory_path() / "line_stage.ngc").string();
  std::ofstream(file) << "G21\nG1 X1\nG1 X2\nM2\n";
  const ProgressWatch watch;
  LineStage stage(file);
  EXPECT_EQ(watch.stages().at(0).total, 4.0);
  for (const int line : {1, 2, 3, 2, 3}) stage.at(line);
  EXPECT_EQ(watch.stages().at(0).done, 3.0);
  std::filesystem::remove(file);
}

TEST(LineStage, OfAFileThatCannotBeReadHasNoEnd) {
  const ProgressWatch watch;
  const LineStage stage("absent.ngc");
  EXPECT_EQ(watch.stages().at(0).total, 0.0);
}

}  // namespace
}  // namespace servomill::sim::programs::line_stage_test
