// Text files are there whole or not at all, and never overwritten unasked.
#include "sim/system/write_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "plant/vocabulary/input_error.h"
#include "sim/system/read_file.h"

namespace servomill::sim::system::write_file_test {
namespace {

namespace fs = std::filesystem;

TEST(WriteTextFile, NeverOverwritesUnlessForced) {
  const std::string path = testing::TempDir() + "write_file_test.ngc";
  fs::remove(path);
  write_text_file(path, "one", false);
  try {
    write_text_file(path, "two", false);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()), path + ": error: exists; use --force to overwrite");
  }
  EXPECT_EQ(read_file(path, {}, "program"), "one");
  write_text_file(path, "two", true);
  EXPECT_EQ(read_file(path, {}, "program"), "two");
  EXPECT_FALSE(fs::exists(path + ".partial"));
  fs::remove(path);
}

TEST(WriteTextFile, SaysWhyItFails) {
  const std::string path = testing::TempDir() + "no_such_folder/p.ngc";
  try {
    write_text_file(path, "one", false);
    FAIL();
  } catch (const InputError& error) {
    const std::string folder = testing::TempDir() + "no_such_folder";
    EXPECT_EQ(std::string(error.what()), path + ": error: folder '" + folder + "' does not exist");
  }
}

}  // namespace
}  // namespace servomill::sim::system::write_file_test
