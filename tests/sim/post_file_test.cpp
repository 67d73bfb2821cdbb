// Programs posted from files, and what the shipped ones do.
#include "sim/post_file.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "plant/vocabulary/units.h"
#include "sim/read_file.h"
#include "sim/run.h"
#include "sim/scenario.h"

namespace servomill::sim {
namespace {

namespace fs = std::filesystem;
const std::string kFolder = SERVOMILL_SOURCE_DIR "/scenarios/li2024/";

// As the comments of the scenarios say.
PostRequest request_of(const std::string& cl_file) {
  PostRequest request;
  request.cl_file = kFolder + cl_file;
  request.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/li2024.toml";
  request.options.mode = controllers::PostMode::locations;
  request.options.tolerance.tip = 0.01 * um;
  request.options.approach = controllers::Approach::direct;
  request.part_zero = Eigen::Vector3d::Zero();
  request.tool_length = 0.0;
  request.has_no_tool = true;
  return request;
}

std::string shipped(const std::string& name) { return read_file(kFolder + name, {}, "program"); }

TEST(PostFile, ShippedProgramsArePostedFromShippedLocations) {
  PostRequest example1 = request_of("example1.cls");
  example1.start = "C=180";
  const PostedFile posted = post_file(example1);
  EXPECT_EQ(posted.program, shipped("example1.ngc"));
  ASSERT_EQ(posted.warnings.size(), 2u);
  EXPECT_EQ(posted.warnings[0].message, "tool axis has length 1.00199; taken as a unit vector");
  EXPECT_EQ(posted.warnings[1].message,
            "on the way here the axes lead the tip 0.156 mm off the straight way; only --classical "
            "inserts no points");

  PostRequest table32 = request_of("table32.csv");
  table32.options.feed = 300 * mm_per_min;
  EXPECT_EQ(post_file(table32).program, shipped("table32.ngc"));
  EXPECT_EQ(post_file(table32).locations, 20u);
  table32.changes = {"axis.A.centre_mm=[0,0,-150]", "axis.C.centre_mm=[0,0,-150]"};
  EXPECT_EQ(post_file(table32).program, shipped("table32_low.ngc"));
}

std::map<std::string, double> tool_differences(const std::string& scenario_file) {
  RunControl control;
  control.threads = 1;
  std::map<std::string, double> out;
  for (const ComparisonRow& row :
       run_scenario(read_scenario(kFolder + scenario_file), control).comparison) {
    if (row.quantity == "tool_difference") out[row.case_name] = row.value;
  }
  return out;
}

// The simulated NC does what tests/known_answers/li2024_test.cpp computes.
TEST(PostFile, ShippedScenariosShowTheNumbersOfThePaper) {
  constexpr double kPeakTol = 0.01;     // um
  constexpr double kShareTol = 0.0015;  // of the peak: chords of 20 um, corners between two samples
  for (const auto& [file, peak] : {std::pair{"table32.toml", 2.30}, {"table32_low.toml", 3.99}}) {
    auto left = tool_differences(file);
    EXPECT_NEAR(left["uncompensated"], peak, kPeakTol);
    EXPECT_NEAR(left["harmonic"] / peak, 0.056, kShareTol);
    EXPECT_NEAR(left["parabolic"] / peak, 0.0015, kShareTol);
    EXPECT_NEAR(left["harmonic_posted"] / peak, 1.0, 0.01);
  }
  auto left = tool_differences("example1.toml");
  EXPECT_NEAR(left["uncompensated"], 156.0, 0.1);
  EXPECT_NEAR(left["harmonic"] / left["uncompensated"], 0.057, kShareTol);
  EXPECT_NEAR(left["parabolic"] / left["uncompensated"], 0.0053, kShareTol);
  EXPECT_GT(left["harmonic_posted"], 2000.0);  // near the singular direction it does harm
}

TEST(PostFile, HeaderSaysWhatTheNcMustKnow) {
  PostRequest request = request_of("table32.csv");
  request.options.mode = controllers::PostMode::joints;
  request.options.feed = 10 * mm;
  request.options.tolerance = {2.5 * um, 50 * urad};
  request.part_zero = Eigen::Vector3d(10 * mm, -20 * mm, 30.5 * mm);
  request.options.work_system = 2;
  request.tool_length = 110 * mm;
  request.has_no_tool = false;
  const std::string program = post_file(request).program;
  EXPECT_TRUE(program.starts_with(
      "(servomill post: table32.csv for dual rotary table C' A' after Li 2024)\n"
      "(tip within 2.5 um, tool axis within 50 urad of the straight way)\n"
      "(part zero [G55]: X10 Y-20 Z30.5 in the machine, rotary axes at zero)\n"
      "(tool 1: length 110 mm)\n"
      "G21 G90 G91.1 G94 G17 G40 G80\nT1 M6\nG55\nG43 H1\nG64 P0.00125\nG0 X"))
      << program.substr(0, 400);
}

// Head or table: the axes go with the length of the tool and the place of the part. 0 may be given.
TEST(PostFile, PlaceOfThePartAndLengthOfTheToolAreNotAssumed) {
  for (const char* machine : {"generic_head_table_bc.toml", "generic_trunnion_ac.toml"}) {
    PostRequest request = request_of("table32.csv");
    request.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/" + std::string(machine);
    request.options.feed = 300 * mm_per_min;
    request.tool_length.reset();
    request.part_zero.reset();
    try {
      post_file(request);
      FAIL();
    } catch (const InputError& error) {
      EXPECT_EQ(error.what(),
                request.cl_file +
                    ": error: the place of the part is not given, and the rotary axes of this "
                    "machine turn about points of their own; add --part-zero X,Y,Z (0,0,0 is a "
                    "place, too)\n" +
                    request.cl_file +
                    ": error: the length of the tool is not given, and this machine has rotary "
                    "axes; add --tool-length or --tools");
    }
    request.options.mode = controllers::PostMode::tip;  // the NC knows
    EXPECT_NO_THROW(post_file(request));
    request.options.mode = controllers::PostMode::locations;
    request.tool_length = 0.0;  // said on purpose
    request.part_zero = Eigen::Vector3d::Zero();
    EXPECT_NO_THROW(post_file(request));
  }
}

}  // namespace
}  // namespace servomill::sim
