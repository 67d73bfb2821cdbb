// Inputs are opened within bounds, and remembered while a command runs.
#include "plant/vocabulary/user_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace servomill::user_file_test {
namespace {

namespace fs = std::filesystem;

class UserFile : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
    return path(name);
  }

  fs::path folder_ = fs::path(testing::TempDir()) / ("user_file_" + std::to_string(getpid()));
};

std::string why_not(const std::string& path, std::uintmax_t most = kMaxBytesOfFile) {
  std::string why;
  read_input(path, most, why);
  return why;
}

TEST_F(UserFile, IsReadWhole) {
  std::string text(3'000'001, 'x'), why;
  text[7] = '\0';
  EXPECT_EQ(read_input(file("text", text), kMaxBytesOfFile, why), text);
  EXPECT_EQ(why, "");
  EXPECT_EQ(read_input(file("empty", ""), kMaxBytesOfFile, why), "");
  EXPECT_EQ(why, "");
}

TEST_F(UserFile, IsRefusedIfItHasNoEndThatIsKnown) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  EXPECT_EQ(why_not(path("pipe")), "is a pipe, not a regular file");
  EXPECT_EQ(why_not("/dev/zero"), "is a device, not a regular file");
  EXPECT_EQ(why_not("/dev/random"), "is a device, not a regular file");
  EXPECT_EQ(why_not(folder_.string()), "is a folder");
  EXPECT_EQ(why_not(path("none")), "No such file or directory");
}

TEST_F(UserFile, IsRefusedBeyondItsLimitBeforeItIsRead) {
  const std::string large = file("large", "");
  fs::resize_file(large, 3'000'000'000);  // takes no room on the disk, and nobody reads it
  EXPECT_EQ(why_not(large), "is 3 GB, larger than the limit of 2 GB");
  EXPECT_EQ(why_not(file("small", "12345"), 4), "is 5e-06 MB, larger than the limit of 4e-06 MB");
  // what says that it is empty, and is not
  EXPECT_EQ(why_not("/proc/self/status", 10), "is larger than the limit of 1e-05 MB");
}

TEST_F(UserFile, IsAnInputUnderEveryNameWhileACommandRuns) {
  const std::string input = file("input", "1"), other = file("other", "1");
  fs::create_symlink("input", path("soft"));
  fs::create_hard_link(input, path("hard"));
  std::string why;
  open_input(input, why);
  EXPECT_FALSE(is_input(input)) << "nothing is remembered without a record";
  {
    const InputRecord record;
    open_input(path("soft"), why);
    for (const char* name : {"input", "soft", "hard"}) EXPECT_TRUE(is_input(path(name))) << name;
    EXPECT_FALSE(is_input(other));
    EXPECT_FALSE(is_input(path("none")));
    remember_input(other);
    EXPECT_TRUE(is_input(other));
  }
  EXPECT_FALSE(is_input(input));
}

}  // namespace
}  // namespace servomill::user_file_test
