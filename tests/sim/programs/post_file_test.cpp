// Programs post-processed from files, and what the shipped ones do.
#include "sim/programs/post_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "plant/vocabulary/units.h"
#include "sim/evaluation/comparison_row.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"
#include "sim/run/run.h"
#include "sim/run/run_output.h"
#include "sim/system/read_file.h"

namespace servomill::sim::programs::post_file_test {
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
  request.work_offset = Eigen::Vector3d::Zero();
  request.tool_length = 0.0;
  request.has_no_tool = true;
  return request;
}

std::string shipped(const std::string& name) {
  return system::read_file(kFolder + name, {}, "program");
}

TEST(PostFile, ShippedProgramsArePostedFromShippedLocations) {
  PostRequest example1 = request_of("example1.cls");
  example1.start = "C=180";
  const PostProcessedFile post_processed = post_file(example1);
  EXPECT_EQ(post_processed.program, shipped("example1.ngc"));
  ASSERT_EQ(post_processed.warnings.size(), 2u);
  EXPECT_EQ(post_processed.warnings[0].message,
            "tool axis has length 1.00199; normalised to a unit vector");
  EXPECT_EQ(post_processed.warnings[1].message,
            "between the previous location and this one the TCP deviates from the straight line by "
            "0.156 mm; --classical inserts no points");

  PostRequest table32 = request_of("table32.csv");
  table32.options.feed = 300 * mm_per_min;
  EXPECT_EQ(post_file(table32).program, shipped("table32.ngc"));
  EXPECT_EQ(post_file(table32).locations, 20u);
  table32.changes = {"axis.A.centre_mm=[0,0,-150]", "axis.C.centre_mm=[0,0,-150]"};
  EXPECT_EQ(post_file(table32).program, shipped("table32_low.ngc"));
}

std::map<std::string, double> tool_differences(const std::string& scenario_file) {
  run::RunControl control;
  control.threads = 1;
  std::map<std::string, double> out;
  for (const evaluation::ComparisonRow& row :
       run::run_scenario(input::read_scenario(kFolder + scenario_file), control).comparison) {
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
    EXPECT_NEAR(left["harmonic_post_processed"] / peak, 1.0, 0.01);
  }
  auto left = tool_differences("example1.toml");
  EXPECT_NEAR(left["uncompensated"], 156.0, 0.1);
  EXPECT_NEAR(left["harmonic"] / left["uncompensated"], 0.057, kShareTol);
  EXPECT_NEAR(left["parabolic"] / left["uncompensated"], 0.0053, kShareTol);
  EXPECT_GT(left["harmonic_post_processed"], 2000.0);  // near the singular direction it does harm
}

TEST(PostFile, HeaderSaysWhatTheNcMustKnow) {
  PostRequest request = request_of("table32.csv");
  request.options.mode = controllers::PostMode::joints;
  request.options.feed = 10 * mm;
  request.options.tolerance = {2.5 * um, 50 * urad};
  request.work_offset = Eigen::Vector3d(10 * mm, -20 * mm, 30.5 * mm);
  request.options.work_system = 2;
  request.tool_length = 110 * mm;
  request.has_no_tool = false;
  const std::string program = post_file(request).program;
  EXPECT_TRUE(program.starts_with(
      "(servomill post: table32.csv for dual rotary table C' A' after Li 2024)\n"
      "(TCP within 2.5 um, tool axis within 50 urad of the straight path)\n"
      "(work offset [G55]: X10 Y-20 Z30.5 in the machine, rotary axes at zero)\n"
      "(tool 1: length 110 mm)\n"
      "G21 G90 G91.1 G94 G17 G40 G80 G92.1\nT1 M6\nG55\nG43 H1\nG64 P0.00125\nG0 X"))
      << program.substr(0, 400);
}

std::string fault_of(const PostRequest& request) {
  try {
    post_file(request);
  } catch (const InputError& error) {
    return error.what();
  }
  return "post_processed";
}

// Cutter locations of a test, for a machine that servomill ships.
class Locations {
 public:
  explicit Locations(const std::string& text, const std::string& machine) {
    const std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
    request_.cl_file = (fs::path(testing::TempDir()) / (test + ".cls")).string();
    std::ofstream(request_.cl_file) << text;
    request_.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/" + machine + ".toml";
    request_.work_offset = Eigen::Vector3d::Zero();
    request_.options.tolerance = {1.0 * um, 100.0 * urad};
  }
  ~Locations() { fs::remove(request_.cl_file); }
  Locations(const Locations&) = delete;
  Locations& operator=(const Locations&) = delete;

  PostRequest& request() { return request_; }
  std::string beside(const std::string& ending, const std::string& text) const {
    std::ofstream(request_.cl_file + ending) << text;
    return request_.cl_file + ending;
  }
  std::string at(int line) const { return fmt::format("{}:{}: error: ", request_.cl_file, line); }

 private:
  PostRequest request_;
};

const std::string kTilted = "FEDRAT/600\nRAPID\nGOTO/0,0,50,0,0.6,0.8\nGOTO/5,0,50\n";
const std::string kNoTool =
    "no tool is loaded before this location; add LOADTL/N before it or --tool N, and --tool-length "
    "or --tools (an empty spindle: --tool 0 --tool-length 0)";
std::string no_length_of(int tool) {
  return fmt::format(
      "the length of tool {} is unknown; add --tool-length \"110 mm\" or --tools TABLE (0 is "
      "allowed)",
      tool);
}

// The axes go with the place of the part; under tip control X and Y of the approach do where the
// table turns.
TEST(PostFile, PlaceOfThePartIsNotAssumed) {
  const std::string no_place =
      ": error: the work offset is unknown, and the rotary axes of this machine rotate about fixed "
      "points; add --work-offset X,Y,Z (0,0,0 is allowed)";
  for (const char* machine :
       {"generic_head_table_bc", "generic_trunnion_ac", "generic_head_head_ca"}) {
    Locations locations("LOADTL/1\n" + kTilted, machine);
    PostRequest& request = locations.request();
    request.tool_length = 0.0;
    request.work_offset.reset();
    EXPECT_EQ(fault_of(request), request.cl_file + no_place);
    request.options.mode = controllers::PostMode::tip;
    const bool is_head = std::string(machine) == "generic_head_head_ca";
    EXPECT_EQ(fault_of(request),
              is_head ? "post_processed" : request.cl_file + no_place + " or --approach direct");
    request.options.approach = controllers::Approach::direct;
    EXPECT_EQ(fault_of(request), "post_processed");
  }
}

// Under G49 the spindle nose would go where the tip belongs.
TEST(PostFile, LengthOfTheToolIsNotAssumed) {
  for (const char* machine : {"generic_trunnion_ac", "generic_head_head_ca", "router_3axis"}) {
    for (const auto mode : {controllers::PostMode::joints, controllers::PostMode::tip}) {
      const bool turns = std::string(machine) != "router_3axis";
      if (!turns && mode == controllers::PostMode::tip) continue;
      Locations locations(turns ? kTilted : "FEDRAT/600\nRAPID\nGOTO/0,0,-130\nGOTO/5,0,-130\n",
                          machine);
      PostRequest& request = locations.request();
      request.options.mode = mode;
      EXPECT_EQ(fault_of(request), locations.at(3) + kNoTool) << machine;
      const std::string table = locations.beside(".tbl", "T1 P1 Z100\n");
      request.tool_table = table;
      EXPECT_EQ(fault_of(request), locations.at(3) + kNoTool) << machine;
      request.tool_table.clear();
      fs::remove(table);
      request.has_no_tool = true;
      EXPECT_EQ(fault_of(request), locations.at(3) + kNoTool) << machine;
      request.tool_length = 0.1;
      EXPECT_EQ(
          fault_of(request),
          "--tool 0: error: an empty spindle has no tool length; use --tool N, or --tool-length 0");
      request.tool_length = 0.0;  // said on purpose
      EXPECT_EQ(fault_of(request), "post_processed") << machine;
      request.has_no_tool = false;
      request.options.tool = 3;
      request.tool_length.reset();
      EXPECT_EQ(fault_of(request), locations.at(3) + no_length_of(3)) << machine;
      request.tool_length = 0.1;
      EXPECT_EQ(fault_of(request), "post_processed") << machine;
    }
  }
}

TEST(PostFile, LengthOfALoadedToolIsNotAssumed) {
  for (const char* machine : {"generic_trunnion_ac", "router_3axis"}) {
    Locations locations("LOADTL/1\nFEDRAT/600\nRAPID\nGOTO/0,0,-130\nGOTO/5,0,-130\n", machine);
    PostRequest& request = locations.request();
    EXPECT_EQ(fault_of(request), locations.at(1) + no_length_of(1));
    request.options.mode = controllers::PostMode::tip;
    EXPECT_EQ(fault_of(request), locations.at(1) + no_length_of(1));
  }
}

TEST(PostFile, LengthsMayBeThoseOfSingleTools) {
  Locations locations("LOADTL/1\nFEDRAT/600\nGOTO/0,0,-130\nLOADTL/2\nGOTO/5,0,-130\n",
                      "router_3axis");
  PostRequest& request = locations.request();
  request.tool_lengths = {"1=50"};
  EXPECT_EQ(fault_of(request), locations.at(4) + no_length_of(2));
  request.tool_lengths = {"1=50", "2=60 mm"};
  const std::string program = post_file(request).program;
  EXPECT_NE(program.find("tool 1: length 50 mm"), std::string::npos) << program;
  EXPECT_NE(program.find("tool 2: length 60 mm"), std::string::npos) << program;
  request.tool_lengths = {"1=50", "2=sixty"};
  EXPECT_EQ(fault_of(request),
            "--tool-length 2=sixty: error: length must be a length such as \"3 mm\"");
}

// The first section runs with the tool of --tool, its length in force, and that tool is loaded.
TEST(PostFile, ToolBeforeTheFirstLoadtl) {
  Locations locations(kTilted + "LOADTL/2\nRAPID\nGOTO/5,0,50\n", "generic_trunnion_ac");
  PostRequest& request = locations.request();
  request.tool_length = 100 * mm;
  EXPECT_EQ(fault_of(request), locations.at(3) + kNoTool);
  request.options.tool = 1;
  const std::string program = post_file(request).program;
  const std::size_t first = program.find("T1 M6"), second = program.find("T2 M6");
  ASSERT_NE(first, std::string::npos);
  ASSERT_NE(second, std::string::npos);
  EXPECT_NE(program.substr(first, second - first).find("\nG43 H1\n"), std::string::npos) << program;
  EXPECT_NE(program.substr(second).find("\nG43 H2\n"), std::string::npos) << program;
  EXPECT_EQ(program.find("\nG49\n"), std::string::npos) << program;
}

// Retract, rotary axes, X and Y, and only then tip control and Z.
TEST(PostFile, ApproachUnderTipControlNamesXAndYAtTheRetractHeight) {
  Locations locations(
      "LOADTL/1\nDELAY/0.5\nFEDRAT/600\nRAPID\nGOTO/0,6,50,0,0.6,0.8\nGOTO/5,6,50\n",
      "generic_trunnion_ac");
  PostRequest& request = locations.request();
  request.tool_length = 100 * mm;
  request.options.mode = controllers::PostMode::tip;
  const std::string program = post_file(request).program;
  // A' turns about X at Z 50: y = 0.8 * 12 - 0.6 * (58 - 50) = 4.8
  EXPECT_NE(program.find("T1 M6\nG49 G53 G0 Z500\nG54 G0 A-36.8698976 C0\nG4 P0.5\n"
                         "G54 G0 X0 Y4.8\nG54\nG43.4 H1\nG64 P0.001\n"
                         "G0 X0 Y12 Z58 A-36.8698976 C0\nG0 Y6 Z50\n"),
            std::string::npos)
      << program;
}

// Equal tool axes next to the singular direction have solutions that differ by 3e-6 deg.
TEST(PostFile, RapidsOfOneToolAxisTurnNoRotaryAxis) {
  for (const char* machine : {"generic_nutating_head_bc", "generic_nutating_table_bc"}) {
    Locations locations(
        "LOADTL/1\nFEDRAT/600\nRAPID\nGOTO/4,2,33,0,0,1\nGOTO/8,8,21\nRAPID\nGOTO/0,1,30\n"
        "GOTO/4,4,6,0.3,0,1\n",
        machine);
    PostRequest& request = locations.request();
    request.tool_length = 100 * mm;
    EXPECT_EQ(fault_of(request), "post_processed");
  }
}

}  // namespace
}  // namespace servomill::sim::programs::post_file_test
