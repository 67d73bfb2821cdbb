// Locks of files that are written: one writer at a time, until the file has its final name.

#include "sim/system/write_lock.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <utility>

#include "sim/system/system_error.h"

namespace servomill::sim::system::write_lock_test {
namespace {

using enum WriteLock::File;

class WriteLocks : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string message(WriteLock::File file) const {
    try {
      const WriteLock lock(path("out"), file);
    } catch (const SystemError& error) {
      return error.what();
    }
    return "";
  }

 private:
  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / "write_lock_test";
};

TEST_F(WriteLocks, KeepOthersOutAsLongAsTheyLive) {
  std::optional<WriteLock> lock(std::in_place, path("out"), created);
  EXPECT_EQ(writer_of(path("out")), Writer::alive);
  EXPECT_EQ(message(replaced),
            path("out") + ": error: cannot be created: another process writes it");
  EXPECT_EQ(message(resumed), path("out") + ": error: cannot be opened: another process writes it");
  EXPECT_EQ(message(created), path("out") + ": error: cannot be created: File exists");
  lock.reset();
  EXPECT_EQ(writer_of(path("out")), Writer::none);
  EXPECT_EQ(message(replaced), "");
  EXPECT_EQ(message(resumed), "");
}

TEST_F(WriteLocks, StayWithTheFileWhenItGetsItsName) {
  WriteLock lock(path("out"), created);
  std::filesystem::rename(path("out"), path("named"));
  EXPECT_EQ(writer_of(path("named")), Writer::alive);
  EXPECT_EQ(message(created), "") << "the name is free";
  lock = WriteLock();
  EXPECT_EQ(writer_of(path("named")), Writer::none);
}

TEST_F(WriteLocks, GoWithWhoTakesThem) {
  WriteLock lock(path("out"), created);
  const WriteLock taken = std::move(lock);
  lock = WriteLock();
  EXPECT_EQ(writer_of(path("out")), Writer::alive);
}

TEST_F(WriteLocks, LeaveWhatIsInTheFile) {
  std::ofstream(path("out")) << "kept";
  { const WriteLock lock(path("out"), replaced); }
  { const WriteLock lock(path("out"), resumed); }
  std::string read;
  std::ifstream(path("out")) >> read;
  EXPECT_EQ(read, "kept");
}

TEST_F(WriteLocks, BindNoWriterOnADiskOfItsOwn) {
  EXPECT_FALSE(locks_bind_writers(path("out")));
  EXPECT_FALSE(locks_bind_writers("out"));
}

TEST_F(WriteLocks, AreNoneOfWhatDoesNotOpen) {
  EXPECT_EQ(message(resumed), "");
  EXPECT_FALSE(std::filesystem::exists(path("out")));
  EXPECT_EQ(writer_of(path("out")), Writer::unknown);
  EXPECT_THROW(WriteLock(path("nowhere/out"), replaced), SystemError);
}

}  // namespace
}  // namespace servomill::sim::system::write_lock_test
