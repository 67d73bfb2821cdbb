// Subroutines in files of their own: beside a program, in folders, and kept with a scenario.
#include "sim/input/subroutine_files.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "controllers/gcode/called_subroutines.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"
#include "sim/preparation/case_program.h"
#include "sim/preparation/prepared_case.h"

namespace servomill::sim::input::subroutine_files_test {
namespace {

class Folder {
 public:
  Folder() : path_(std::filesystem::path(testing::TempDir()) / "subroutine_files_test") {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_ / "more");
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return (path_ / name).string();
  }
  std::string path(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

std::string first_line(std::optional<controllers::ProgramText> text) {
  std::string_view line;
  return text && text->next(line) ? std::string(line) : "";
}

TEST(SubroutineFiles, BesideTheProgramComeFirst) {
  const Folder folder;
  folder.write("hole.ngc", "beside");
  folder.write("more/hole.ngc", "in the folder");
  folder.write("more/slot.ngc", "slot");
  const auto find = subroutine_files(folder.path("plate.ngc"), {folder.path("more")});
  EXPECT_EQ(first_line(find("hole")), "beside");
  EXPECT_EQ(first_line(find("slot")), "slot");
  EXPECT_FALSE(find("none"));
  EXPECT_FALSE(find("more"));
}

TEST(SubroutineFiles, OfNumbersMayBeCalledAsOtherControlsDo) {
  const Folder folder;
  folder.write("O0015.nc", "four digits");
  folder.write("O00016.nc", "five digits");
  folder.write("17.nc", "a number");
  folder.write("17.tap", "of another program");
  folder.write("hole.nc", "no number");
  const auto find = subroutine_files(folder.path("plate.nc"), {});
  EXPECT_EQ(first_line(find("15")), "four digits");
  EXPECT_EQ(first_line(find("16")), "five digits");
  EXPECT_EQ(first_line(find("17")), "a number");
  EXPECT_FALSE(find("hole"));
  folder.write("17.ngc", "as LinuxCNC");
  EXPECT_EQ(first_line(find("17")), "as LinuxCNC");
}

TEST(SubroutineFiles, WhatAProgramCallsIsKnownBeforeItRuns) {
  EXPECT_EQ(controllers::called_subroutines(controllers::ProgramText::of_text(
                "o<a B> call [1]\no7 call\no#1 call\nM98 P100\no<c> sub\n(o<d> call)\n?\n", "p")),
            (std::set<std::string>{"100", "7", "ab"}));
}

TEST(SubroutineFiles, AScenarioKeepsTheirTexts) {
  const Folder folder;
  folder.write("line.ngc", "o<line> sub\no<go> call [#1]\no<line> endsub\n");
  folder.write("go.ngc", "o<go> sub\nG1 X#1 F600\no<go> endsub\n");
  folder.write("plate.ngc", "o<line> call [3]\nM2\n");
  const std::string scenario_file =
      folder.write("s.toml", "title = \"t\"\nmachine = \"" SERVOMILL_SOURCE_DIR
                             "/scenarios/machines/hsm600u.toml\"\n[program]\nfile = \"plate.ngc\"\n"
                             "[[case]]\nname = \"one\"\n");
  const model::Scenario scenario = read_scenario(scenario_file);
  EXPECT_EQ(scenario.program.subroutines.size(), 2U);
  std::filesystem::remove(folder.path("line.ngc"));
  std::filesystem::remove(folder.path("go.ngc"));
  const model::Scenario again = read_resolved_scenario(scenario.resolved, "again");
  EXPECT_EQ(again.resolved, scenario.resolved);
  const std::vector<Move> moves =
      preparation::read_program(again, again.cases.front(), nullptr).all();
  ASSERT_EQ(moves.size(), 2U);
  EXPECT_DOUBLE_EQ(moves[0].end[0], 3e-3);
}

}  // namespace
}  // namespace servomill::sim::input::subroutine_files_test
