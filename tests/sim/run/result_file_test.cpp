#include "sim/run/result_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "sim/records/hdf5_group.h"
#include "sim/records/input_file.h"
#include "sim/records/output_file.h"
#include "sim/run/build_identity.h"
#include "tests/text.h"

namespace servomill::sim::run::result_file_test {
namespace {

namespace fs = std::filesystem;

class ResultFile : public testing::Test {
 protected:
  void SetUp() override { fs::remove_all(folder_), fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
  }
  void write_result(const std::string& name) const {
    records::OutputFile file(path(name), true);
    records::Hdf5Group root = file.root();
    write_build(root);
    file.commit();
  }

  fs::path folder_ = fs::temp_directory_path() / "servomill_result_file_test";
};

TEST_F(ResultFile, CarriesTheBuildThatWroteIt) {
  write_result("a.h5");
  EXPECT_EQ(build_of(records::InputFile(path("a.h5"))), result_identity());
}

TEST_F(ResultFile, IsRecognisedByItsFirstBytes) {
  write_result("a.h5");
  write("b.h5", "no HDF5");
  EXPECT_TRUE(is_hdf5(path("a.h5")));
  EXPECT_FALSE(is_hdf5(path("b.h5")));
  EXPECT_FALSE(is_hdf5(path("none.h5")));
}

TEST_F(ResultFile, IsReplacedOnlyWithForceAndOthersNever) {
  write_result("a.h5");
  write("b.txt", "mine");
  EXPECT_EQ(writable_name(path("new.h5"), false), path("new.h5"));
  EXPECT_EQ(writable_name(path("a.h5"), true), path("a.h5"));
  EXPECT_EQ(fault_messages([&] { writable_name(path("b.txt"), true); }),
            "exists and is not a result file; --force does not overwrite other files\n");
}

TEST(SplitLines, GivesOneLineMoreThanThereAreBreaks) {
  EXPECT_EQ(split_lines(""), std::vector<std::string>{""});
  EXPECT_EQ(split_lines("a\n\nb"), (std::vector<std::string>{"a", "", "b"}));
}

}  // namespace
}  // namespace servomill::sim::run::result_file_test
