#include "sim/input/input_files.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "plant/vocabulary/checksum.h"

namespace servomill::sim::input::input_files_test {
namespace {

class Files : public testing::Test {
 protected:
  Files() : path_(testing::TempDir() + "servomill_input_files_test.txt") { write("before"); }
  ~Files() override { std::filesystem::remove(path_); }

  void write(const std::string& text) const { std::ofstream(path_, std::ios::binary) << text; }

  std::string path_;
};

TEST_F(Files, AreWhatTheyWereWhenFirstRead) {
  InputFiles files;
  EXPECT_EQ(*files.text(path_, {}, "program"), "before");
  write("after");
  EXPECT_EQ(*files.text(path_, {}, "program"), "before");
}

TEST_F(Files, AreRefusedWhenForgottenAndChanged) {
  InputFiles files(1);  // byte beside the last text
  const std::string other = SERVOMILL_SOURCE_DIR "/tests/cli/gallery/part.ngc";
  files.text(path_, {}, "program");
  files.text(other, {}, "program");
  EXPECT_EQ(*files.text(path_, {}, "program"), "before");
  write("after");
  EXPECT_EQ(*files.text(path_, {}, "program"), "before");
  files.text(other, {}, "program");
  try {
    files.text(path_, {"scenario.toml", 3}, "program");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), path_ + ": error: has changed since it was first read");
  }
}

TEST_F(Files, HoldLongProgramsOnTheDisk) {
  std::string program = "(long)\n";
  while (program.size() <= StoredText::kMaxInMemory) program += "G1 X1 Y2\n";
  write("\xEF\xBB\xBF" + program);
  InputFiles files;
  const auto read = files.program(path_, {}, "program");
  EXPECT_TRUE(read->is_on_disk());
  EXPECT_EQ(read->all(), program);  // without its byte-order mark
  EXPECT_EQ(files.program(path_, {}, "program"), read);
  EXPECT_EQ(files.checksum(path_, {}, "program"), crc64(program));
}

TEST_F(Files, AreRefusedWhenAForgottenProgramHasChanged) {
  InputFiles files(1);
  const std::string other = SERVOMILL_SOURCE_DIR "/tests/cli/gallery/part.ngc";
  files.program(path_, {}, "program");
  files.program(other, {}, "program");
  write("after");
  try {
    files.program(path_, {"scenario.toml", 3}, "program");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), path_ + ": error: has changed since it was first read");
  }
}

TEST_F(Files, NameTheProgramThatCannotBeRead) {
  try {
    InputFiles().program("/nowhere/p.ngc", {"scenario.toml", 3}, "program");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "scenario.toml:3: error: program '/nowhere/p.ngc' cannot be read: No such file or "
                 "directory");
  }
}

TEST_F(Files, MayBeTextsThatLieOnNoDisk) {
  InputFiles files(1);
  files.provide("nowhere/scenario.toml", "title = 1");
  files.text(path_, {}, "program");
  EXPECT_EQ(*files.text("nowhere/scenario.toml", {}, "scenario"), "title = 1");
  EXPECT_EQ(files.document("nowhere/scenario.toml")->name(), "nowhere/scenario.toml");
  write("title = 1");
  EXPECT_EQ(files.checksum("nowhere/scenario.toml", {}, "scenario"),
            InputFiles().checksum(path_, {}, "scenario"));
}

// The check value of CRC-64/XZ in the catalogue of parametrised CRC algorithms.
TEST_F(Files, HaveTheChecksumThatXzWouldStore) {
  write("123456789");
  EXPECT_EQ(InputFiles().checksum(path_, {}, "program"), 0x995DC9BBDF1939FAU);
}

}  // namespace
}  // namespace servomill::sim::input::input_files_test
