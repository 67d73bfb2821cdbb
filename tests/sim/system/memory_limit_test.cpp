// Memory that control groups allow a process: made-up trees of both versions.
#include "sim/system/memory_limit.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

namespace servomill::sim::system::memory_limit_test {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

class MemoryOfGroups : public testing::Test {
 protected:
  MemoryOfGroups() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("groups_") + info->name() + std::to_string(getpid()));
  }
  ~MemoryOfGroups() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& path, const std::string& text) const {
    std::filesystem::create_directories((folder_ / path).parent_path());
    std::ofstream(folder_ / path) << text << '\n';
  }
  double limit(const std::string& groups) const {
    write("cgroup", groups);
    return memory_of_groups(folder_ / "cgroup", folder_ / "fs");
  }

 private:
  std::filesystem::path folder_;
};

TEST_F(MemoryOfGroups, IsTheLeastOnTheWayToTheRoot) {
  write("fs/slurm/memory.max", "2000");
  write("fs/slurm/job/memory.max", "3000");
  write("fs/slurm/job/task/memory.max", "max");
  EXPECT_EQ(limit("0::/slurm/job/task"), 2000.0);
  write("fs/memory.max", "500");
  EXPECT_EQ(limit("0::/slurm/job/task"), 500.0);
}

TEST_F(MemoryOfGroups, OfVersion1HaveAHierarchyOfTheirOwn) {
  write("fs/memory/slurm/memory.limit_in_bytes", "7000");
  write("fs/slurm/memory.max", "1");  // of no group of this process
  EXPECT_EQ(limit("5:cpu,cpuacct:/slurm\n4:memory:/slurm/job\n1:name=systemd:/"), 7000.0);
  EXPECT_EQ(limit("4:cpu,memory:/slurm"), 7000.0);
  EXPECT_EQ(limit("4:memory_of_another_kind:/slurm"), kNoLimit);
}

TEST_F(MemoryOfGroups, SetNoLimitWhereNoneIsWritten) {
  EXPECT_EQ(limit("0::/"), kNoLimit);
  EXPECT_EQ(limit("0::/a/b"), kNoLimit);
  EXPECT_EQ(limit("no line of a group"), kNoLimit);
  EXPECT_EQ(memory_of_groups("/nowhere/cgroup", "/nowhere"), kNoLimit);
}

TEST(MemoryOfProcess, IsSomethingAndNoMoreThanTheMachineHas) {
  EXPECT_GT(memory_of_process(), 1e7);
  EXPECT_LE(memory_of_process(), static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
                                     static_cast<double>(sysconf(_SC_PAGESIZE)));
}

TEST(ResidentMemory, GrowsWithWhatIsHeld) {
  constexpr std::size_t kBytes = 64'000'000;
  const double before = resident_memory();
  EXPECT_GT(before, 1e6);
  EXPECT_LT(before, memory_of_process());
  const std::vector<char> held(kBytes, 1);
  EXPECT_GT(resident_memory(), before + 0.9 * static_cast<double>(held.size()));
}

}  // namespace
}  // namespace servomill::sim::system::memory_limit_test
