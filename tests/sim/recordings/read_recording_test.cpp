#include "sim/recordings/read_recording.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/text.h"

namespace servomill::sim::recordings::read_recording_test {
namespace {

namespace fs = std::filesystem;

class ReadRecording : public testing::Test {
 protected:
  ReadRecording()
      : folder_(fs::path(testing::TempDir()) / ("read_recording_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~ReadRecording() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return folder_ / name; }
  std::string refusal(const std::string& bytes) const {
    std::ofstream(path("a"), std::ios::binary) << bytes;
    return fault_messages([&] { read_recording(path("a")); });
  }
  fs::path folder_;
};

TEST_F(ReadRecording, ContentDecidesNotTheName) {
  std::ofstream(path("a.h5")) << "t [s],x\n0,1\n1,2\n";
  EXPECT_EQ(read_recording(path("a.h5")).format, "CSV, separator ',', decimal '.'");
}

TEST_F(ReadRecording, OtherKindsAreNamed) {
  EXPECT_EQ(refusal(""), "is empty\n");
  EXPECT_EQ(refusal("PK\x03\x04zip"),
            "cannot be read as a recording: it is a zip archive or a spreadsheet; export it as "
            "CSV\n");
  EXPECT_EQ(refusal("\xFF\xFEt"),
            "cannot be read as a recording: it is a text in UTF-16; save it as UTF-8\n");
  EXPECT_TRUE(refusal("only words\n").starts_with("is not a recording of a known format ("));
}

}  // namespace
}  // namespace servomill::sim::recordings::read_recording_test
