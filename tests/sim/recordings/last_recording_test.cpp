#include "sim/recordings/last_recording.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "plant/vocabulary/input_error.h"

namespace servomill::sim::recordings::last_recording_test {
namespace {

namespace fs = std::filesystem;

class Last : public testing::Test {
 protected:
  Last() : folder_(fs::path(testing::TempDir()) / ("last_recording_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    std::ofstream(path("a.csv")) << "t,x\n0,1\n1,2\n";
    std::ofstream(path("b.csv")) << "t,x\n0,3\n1,4\n";
  }
  ~Last() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return folder_ / name; }
  fs::path folder_;
  LastRecording last_;
};

TEST_F(Last, FileIsReadOnce) {
  const Recording& first = last_.read(path("a.csv"));
  fs::remove(path("a.csv"));
  EXPECT_EQ(&last_.read(path("a.csv")), &first);
  EXPECT_EQ(first.channels.at(0).samples, (std::vector{1.0, 2.0}));
}

TEST_F(Last, AnotherFileIsRead) {
  last_.read(path("a.csv"));
  EXPECT_EQ(last_.read(path("b.csv")).channels.at(0).samples, (std::vector{3.0, 4.0}));
}

TEST_F(Last, AnotherUnitOfTimeIsAnotherRecording) {
  EXPECT_EQ(last_.read(path("a.csv")).bases.at(0).values.at(1), 1.0);
  EXPECT_EQ(last_.read(path("a.csv"), "ms").bases.at(0).values.at(1), 1e-3);
}

TEST_F(Last, FailureIsNotKept) {
  last_.read(path("a.csv"));
  EXPECT_THROW(last_.read(path("none.csv")), InputError);
  EXPECT_EQ(last_.read(path("a.csv")).channels.at(0).samples, (std::vector{1.0, 2.0}));
}

}  // namespace
}  // namespace servomill::sim::recordings::last_recording_test
