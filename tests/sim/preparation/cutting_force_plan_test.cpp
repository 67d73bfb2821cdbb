#include "sim/preparation/cutting_force_plan.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim/model/scenario.h"
#include "sim/preparation/prepared_case.h"
#include "tests/sim/cutting_block.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::preparation::cutting_force_plan_test {
namespace {

std::string message_of(const std::string& program, const std::string& toml) {
  try {
    const model::Scenario scenario = small_scenario(program, toml);
    const PreparedCase prepared(scenario, scenario.cases.front());
    return "";
  } catch (const InputError& error) {
    std::string out;
    for (const Fault& fault : error.faults()) {
      out += fault.place.line > 0 ? fmt::format("{}: {}\n", fault.place.line, fault.message)
                                  : fault.message + "\n";
    }
    return out;
  }
}

// Warnings of a case that cuts, without the folder of the program.
std::vector<std::string> notes_of(const std::string& program, const std::string& tool) {
  const model::Scenario scenario =
      small_scenario(program, tool + kBlock + kSteel + one_case("cut"));
  std::vector<std::string> notes = run_named_case(scenario, "cut").notes;
  for (std::string& note : notes) note.erase(0, note.find("small.ngc"));
  return notes;
}

using Notes = std::vector<std::string>;

const std::string kCorner =
    "[[probe]]\nname = \"floor\"\npoints_mm = [[0.0, 0.0, -2.0, 0.0, 0.0, 1.0]]\n";

const std::string kBegin = "G17 G21 G90 T1 M6\nG43 H1\nS4775 M3\n";

TEST(PlanCutting, rapid_moves_through_material_are_reported_with_their_depth) {
  EXPECT_EQ(notes_of(kBegin + "G0 X-30 Y0\nG1 Z-0.1 F1394\nG0 X30\nM30\n", kTool),
            Notes{"small.ngc:6: warning: case cut: rapid move through material, 0.1 mm deep"});
}

// Straight down nothing is cut by the flank.
TEST(PlanCutting, rapid_moves_into_material_are_reported_with_their_depth) {
  EXPECT_EQ(notes_of(kBegin + "G0 X-30 Y0\nZ3\nX0\nZ-5\nG1 X1 F1394\nM30\n", kTool),
            Notes{"small.ngc:7: warning: case cut: rapid move through material, 5 mm deep"});
  EXPECT_EQ(
      notes_of(kBegin + "G0 X-30 Y0\nZ3\nX0\nG1 Z-5 F300\nZ3\nG0 Z-6\nG1 X1 F1394\nM30\n", kTool),
      Notes{"small.ngc:9: warning: case cut: rapid move through material, 1 mm deep"})
      << "what a hole of 5 mm left";
  EXPECT_EQ(
      notes_of(kBegin + "G0 X-30 Y0\nZ3\nX0\nG1 Z-5 F300\nZ3\nG0 Z-5\nG1 X1 F1394\nM30\n", kTool),
      Notes{})
      << "down a hole";
}

// The stock stays; once for all feeds, and not where all is as the work_offset has it.
TEST(PlanCutting, shifted_programs_are_warned_that_the_stock_stays) {
  const std::string there = "G0 X-30 Y0\nZ-2\nG1 X30 F1394\nX-30\nM30\n";
  EXPECT_EQ(notes_of(kBegin + "G52 X5\n" + there, kTool),
            Notes{"small.ngc:7: warning: feeds in coordinates shifted by G52, G92, G10 or another "
                  "work system than G54, which does not shift [[part.stock]]"});
  EXPECT_EQ(notes_of(kBegin + "G52 X5\n" + there, kTool + kCorner),
            Notes{"small.ngc:7: warning: feeds in coordinates shifted by G52, G92, G10 or another "
                  "work system than G54, which does not shift [[probe]] and [[part.stock]]"});
  EXPECT_EQ(notes_of(kBegin + "G55\n" + there, kTool), Notes{}) << "at machine zero as G54 is";
  EXPECT_EQ(notes_of(kBegin + there, kTool), Notes{});
}

// Flutes of 2 mm in slots as deep as they are, deeper, and deeper in two steps.
TEST(PlanCutting, shanks_that_rub_are_reported_with_their_depth) {
  const std::string tool = kTool + "flute_length_mm = 2.0\n";
  const auto slots = [](const std::vector<double>& depths) {
    std::string out = kBegin + "G0 X-30 Y0\n";
    for (const double depth : depths) out += fmt::format("G0 Z-{}\nG1 X30 F1394\nG1 X-30\n", depth);
    return out + "M30\n";
  };
  EXPECT_EQ(notes_of(slots({2.0}), tool), Notes{});
  EXPECT_EQ(notes_of(slots({2.0, 4.0}), tool), Notes{}) << "the shank is in the first slot";
  EXPECT_EQ(notes_of(slots({2.5}), tool),
            Notes{"small.ngc:6: warning: case cut: tool 1 cuts 2.5 mm deep (the maximum) with "
                  "flutes of 2 mm: its shank rubs, and that force is not computed"});
  EXPECT_EQ(notes_of(slots({2.0, 5.0}), tool),
            Notes{"small.ngc:9: warning: case cut: tool 1 cuts 3 mm deep (the maximum) with flutes "
                  "of 2 mm: its shank rubs, and that force is not computed"});
}

// The tip is programmed in the workpiece as it stands with the table at zero.
TEST(CuttingErrors, tell_of_stock_that_turns_without_its_program) {
  const std::string program = "T1 M6\nG43.4 H1\nM3 S4775\nG0 X-30 Y0 Z-2\nG1 X30 F1394\nM30\n";
  const std::string turned = "work_offset = { C_deg = 90.0 }\n";
  const auto message = [&](const std::string& keys) {
    return message_of(program, kTool + kBlock + kSteel + one_case("cut", keys));
  };
  EXPECT_NE(message(turned).find(": case cut: a part is cut from [[part.stock]] in the coordinates "
                                 "of its program; under TCP control (small.ngc:4) these do not "
                                 "rotate with the work_offset of a rotary axis: set it to 0\n"),
            std::string::npos)
      << message(turned);
  EXPECT_EQ(message(turned + "cutting = false\n"), "") << "in air";
  EXPECT_EQ(message("work_offset = { X_mm = 5.0 }\n"), "");
}

TEST(CuttingErrors, tell_what_is_missing) {
  const std::string all = kTool + kBlock + kSteel + one_case("cut");
  EXPECT_EQ(message_of("T1 M6\nG43 H1\nG0 X-30\nZ-2\nG1 X30 F100\nM30\n", all),
            "5: cuts with the spindle stopped; start it (M3 S...)\n");
  EXPECT_EQ(message_of("T2 M6\nG43 H2\nM3 S1000\nG0 X-30\nZ-2\nG1 X30 F100\nM30\n",
                       "[[program.tool]]\nnumber = 2\nlength_mm = 110.0\n" + kBlock + kSteel +
                           one_case("cut")),
            "6: tool 2 is in the stock; program.tool must give it a diameter_mm above 0\n");
  EXPECT_NE(
      message_of("T1 M6\nG43 H1\nM3 S1000\nG0 X-30\nZ2\nG1 X30 F100\nM30\n", all)
          .find("small.ngc never touches the stock: the tools feed within X-30 Y0 Z2 to X30 Y0 Z2, "
                "the stock is within X-20 Y-20 Z-20 to X20 Y20 Z0 (mm, work coordinates)\n"),
      std::string::npos);
  EXPECT_NE(message_of(kSlot, kTool + kSteel + one_case("cut"))
                .find("cutting: needs stock: [[part.stock]] with a box or a cylinder\n"),
            std::string::npos);
  EXPECT_NE(
      message_of(kSlot, kTool + kBlock + "[cutting]\nmaterial = \"42CrMo\"\n" + one_case("cut"))
          .find("cutting.material = \"42CrMo\"; must be one of 42CrMo4; did you mean "
                "'42CrMo4'?\n"),
      std::string::npos);
  EXPECT_NE(message_of(kSlot, kTool + one_case("cut", "cutting = true\n"))
                .find("case[0].cutting = true; needs the table [cutting]\n"),
            std::string::npos);
  EXPECT_NE(
      message_of(kSlot, kTool + kBlock + kSteel + one_case("cut", "cutting = false\nwear = 2.0\n"))
          .find("case[0].wear = 2.0; has no effect: the case runs in air\n"),
      std::string::npos);
  EXPECT_NE(message_of(kSlot, kTool + "[[part.stock]]\n" + kSteel + one_case("cut"))
                .find("part.stock[0]: must have a table 'box' or a table 'cylinder'\n"),
            std::string::npos);
}

}  // namespace
}  // namespace servomill::sim::preparation::cutting_force_plan_test
