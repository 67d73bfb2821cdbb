#include "sim/input/scenario_name.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "plant/vocabulary/input_error.h"

namespace servomill::sim::input::scenario_name_test {
namespace {

namespace fs = std::filesystem;

class ScenarioName : public testing::Test {
 protected:
  ScenarioName()
      : folder_(fs::path(testing::TempDir()) / ("scenario_name_" + std::to_string(getpid()))) {
    write("paper/experiment1.toml", "[[case]]\n");
    write("paper/experiment2.toml", "based_on = \"experiment1.toml\"\n");
    write("machines/mill.toml", "structure = \"[w X b Y Z t]\"\n");
    write("machines/worn.toml", "based_on = \"mill.toml\"\n");
  }
  ~ScenarioName() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  std::string fault(const std::string& word) const {
    try {
      return scenario_file(word, {folder_.string()});
    } catch (const InputError& error) {
      return error.what();
    }
  }

  fs::path folder_;
};

TEST_F(ScenarioName, AreThoseOfFilesWithCases) {
  EXPECT_EQ(scenario_names(folder_),
            (std::vector<std::string>{"paper/experiment1", "paper/experiment2"}));
  EXPECT_TRUE(scenario_names(folder_ / "nowhere").empty());
}

TEST_F(ScenarioName, AreThoseOfAnInstallation) {
  write("share/servomill/scenarios/iso/circle.toml", "[[case]]\n");
  const std::vector<std::string> folders = scenario_folders(folder_ / "share" / "servomill");
  ASSERT_FALSE(folders.empty());
  EXPECT_EQ(folders.back(), (folder_ / "share/servomill/scenarios").string());
  EXPECT_EQ(scenario_file("iso/circle", folders),
            (folder_ / "share/servomill/scenarios/iso/circle.toml").string());
  for (const fs::path& none : {fs::path{}, folder_ / "nowhere"}) {
    EXPECT_LT(scenario_folders(none).size(), folders.size());
  }
}

TEST_F(ScenarioName, OfAnInstallationIsItsFile) {
  for (const char* word : {"paper/experiment1", "paper/experiment1.toml"}) {
    EXPECT_EQ(scenario_file(word, {folder_.string()}),
              (folder_ / "paper/experiment1.toml").string());
  }
}

TEST_F(ScenarioName, OfAMachineIsWithOrWithoutItsFolder) {
  for (const char* word : {"worn", "worn.toml", "machines/worn", "machines/worn.toml"}) {
    EXPECT_EQ(machine_file(word, {folder_.string()}), (folder_ / "machines/worn.toml").string());
  }
  const std::string here = (folder_ / "machines/mill").string();
  EXPECT_EQ(machine_file(here, {}), here + ".toml");
  EXPECT_EQ(machine_file("lathe", {folder_.string()}), "lathe");  // refused where it is read
  try {
    machine_file("machines/wron", {folder_.string()});
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "machines/wron: error: is no file and no machine; did you mean 'worn'?");
  }
}

TEST_F(ScenarioName, IsAFileOfTheCurrentFolderFirst) {
  const std::string here = (folder_ / "paper/experiment2").string();
  EXPECT_EQ(scenario_file(here + ".toml", {folder_.string()}), here + ".toml");
  EXPECT_EQ(scenario_file(here, {folder_.string()}), here + ".toml");
  EXPECT_EQ(scenario_file(here, {}), here + ".toml");
}

TEST_F(ScenarioName, ThatIsWrongIsAnsweredByTheNearest) {
  EXPECT_EQ(fault("paper/experimant1"),
            "paper/experimant1: error: is no file and no scenario; did you mean "
            "'paper/experiment1'?");
  EXPECT_EQ(fault("experiment2"),
            "experiment2: error: is no file and no scenario; did you mean 'paper/experiment2'?");
}

TEST_F(ScenarioName, NearToNoneStaysAPath) {
  EXPECT_EQ(scenario_file("out/of/this/world.toml", {folder_.string()}), "out/of/this/world.toml");
  EXPECT_EQ(scenario_file("paper/experimant1.toml", {}), "paper/experimant1.toml");
}

TEST_F(ScenarioName, NeedsAFolderForANameThatIsNoFile) {
  for (const auto find : {scenario_file, machine_file}) {
    try {
      find("paper/experimant1", {});
      ADD_FAILURE() << "taken";
    } catch (const InputError& error) {
      EXPECT_STREQ(error.what(),
                   "paper/experimant1: error: no such file; names cannot be looked up, because "
                   "there is no folder of scenarios here and none is installed");
    }
  }
}

}  // namespace
}  // namespace servomill::sim::input::scenario_name_test
