#include "controllers/gcode/post_processor.h"

#include <Eigen/Geometry>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>

#include "controllers/gcode/printer.h"
#include "tests/controllers/gcode/program.h"

namespace servomill::controllers {
namespace {

constexpr double kPrintTol = 1e-9;  // m, rad: seven decimals of mm and deg, seen from 0.3 m
const char* const kTableTable = "[w C' A' b X Y Z t]";
const std::array<const char*, 4> kStructures = {kTableTable, "[w C' B' X b Y Z (C1) t]",
                                                "[w C' X' b Y Z B t]", "[w X' b Y Z C A t]"};

plant::InverseKinematics machine(const char* structure, double a_lower = -2.0) {
  plant::InverseSettings settings;
  settings.lower << -0.5, -0.5, -0.5, a_lower, -50.0;
  settings.upper << 0.5, 0.5, 0.5, 2.0, 50.0;
  return plant::InverseKinematics(plant::make_chain(plant::parse_structure(structure)), settings);
}

PostOptions usual_options() {
  PostOptions options;
  options.tools = usual_setup().tools;
  options.tool = 1;
  options.part_zero << 0.03, -0.02, 0.05;
  options.feed = 0.02;
  options.tolerance = {1.0 * um, 20.0 * urad};
  return options;
}

ClData cl(std::string_view text) { return read_cl_data(text, "p.cls"); }

// Locations every few millimetres with a tool axis that wanders, away from the vertical.
ClData wandering(unsigned seed, int count = 30) {
  boost::random::mt19937 engine(seed);
  boost::random::uniform_real_distribution<double> part(-1.0, 1.0);
  ClData data;
  Eigen::Vector3d p(0.02, 0.03, 0.04), k(0.5, 0.3, 0.8);
  for (int n = 0; n < count; ++n) {
    ClRecord& record = data.records.emplace_back();
    record.line = n + 1;
    record.P = {p, k.normalized()};
    p += 3.0 * mm * Eigen::Vector3d(part(engine), part(engine), part(engine));
    k += 0.05 * Eigen::Vector3d(part(engine), part(engine), part(engine));
  }
  return data;
}

// The posted program as servomill reads it again.
std::vector<Move> read_again(const Posted& posted, const PostOptions& options) {
  ProgramSetup setup;
  setup.tools = options.tools;
  setup.work_offset[0].head<3>() = options.part_zero;
  std::vector<Move> motions;
  for (const Move& move : interpret(print_program(posted.moves, {}, "").text, "p.ngc", setup)) {
    if (is_motion(move.kind)) motions.push_back(move);
  }
  return motions;
}

std::string fault_of_post(const ClData& data, const plant::InverseKinematics& inverse,
                          const PostOptions& options = usual_options()) {
  try {
    post(data, "p.cls", inverse, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Post, ToolGoesStraightFromLocationToLocation) {
  const PostOptions options = usual_options();
  const Eigen::Vector3d p_ST(0.0, 0.0, -100.0 * mm);
  for (const char* structure : kStructures) {
    const auto inverse = machine(structure);
    const ClData data = wandering(1);
    const Posted posted = post(data, "p.cls", inverse, options);
    EXPECT_GT(posted.inserted, data.records.size()) << structure;
    const auto moves = read_again(posted, options);
    ASSERT_EQ(moves.size(), data.records.size() + posted.inserted);
    std::size_t n = 0;
    Joints Q = inverse.chain().layout.joints(moves[0].end_machine);
    double s = 0.0, s_of_location = 0.0;
    for (std::size_t i = 1; i < moves.size(); ++i) {
      const Joints next = inverse.chain().layout.joints(moves[i].end_machine);
      const ToolPose from = data.records[n].P, to = data.records[n + 1].P;
      const double length = (to.p_WT - from.p_WT).norm();
      const double share = (posted.moves[i + 1].s_end - posted.moves[i + 1].s_begin) / length;
      const plant::StraightToolPath path(from, to);
      for (double f = 0.0; f <= 1.0; f += 0.05) {
        const ToolPose is = plant::forward(inverse.chain(), Q + f * (next - Q), p_ST);
        const ToolPose wanted = path.at((s - s_of_location) / length + f * share);
        EXPECT_LT((is.p_WT - options.part_zero - wanted.p_WT).norm(),
                  1.01 * options.tolerance.tip + kPrintTol);
        EXPECT_LT(angle_between(is.k_W, wanted.k_W), 1.01 * options.tolerance.axis + kPrintTol);
      }
      Q = next;
      s += share * length;
      if (s > s_of_location + 0.999999 * length) {
        s_of_location += length;
        ++n;
      }
    }
    EXPECT_EQ(n, data.records.size() - 1);
  }
}

TEST(Post, EveryBlockTakesTheTimeThatTheTipNeeds) {
  constexpr double kRelative = 1e-9;  // F has 12 digits, coordinates 7 decimals of mm
  PostOptions options = usual_options();
  options.feed = 0.02;
  const auto inverse = machine(kTableTable);
  const ClData data = wandering(2);
  const Posted posted = post(data, "p.cls", inverse, options);
  const auto moves = read_again(posted, options);
  double time = 0.0, length = 0.0;
  for (std::size_t i = 1; i < moves.size(); ++i) {
    EXPECT_EQ(moves[i].feed_mode, FeedMode::inverse_time);
    time += (moves[i].end_machine - moves[i - 1].end_machine).head<3>().norm() / moves[i].feed;
  }
  for (std::size_t n = 1; n < data.records.size(); ++n) {
    length += (data.records[n].P.p_WT - data.records[n - 1].P.p_WT).norm();
  }
  EXPECT_NEAR(time / (length / options.feed), 1.0, kRelative);
}

TEST(Post, StandingTipTurnsWithTheRateOfTheToolAxis) {
  PostOptions options = usual_options();
  options.turn_rate = 0.5;
  const auto inverse = machine(kTableTable);
  const ClData data = cl("GOTO/10,0,0,0.6,0,0.8\nGOTO/10,0,0,0.8,0,0.6\n");
  const auto moves = read_again(post(data, "p.cls", inverse, options), options);
  double time = 0.0;
  for (std::size_t i = 1; i < moves.size(); ++i) {
    time += (moves[i].end_machine - moves[i - 1].end_machine).head<3>().norm() / moves[i].feed;
  }
  const double angle = std::atan2(0.8, 0.6) - std::atan2(0.6, 0.8);
  EXPECT_NEAR(time, angle / options.turn_rate, 1e-6);
}

TEST(Post, EndlessAxisGoesOnTurning) {
  PostOptions options = usual_options();
  ClData data;
  for (int n = 0; n <= 40; ++n) {  // two turns about the vertical
    const double angle = n * 18.0 * deg;
    ClRecord& record = data.records.emplace_back();
    record.line = n + 1;
    record.P = {0.02 * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0),
                Eigen::Vector3d(std::cos(angle), std::sin(angle), 1.0).normalized()};
  }
  const auto inverse = machine(kTableTable);
  const Posted posted = post(data, "p.cls", inverse, options);
  const double first = posted.moves[1].end_machine[index_of(Axis::C)];
  const double last = posted.moves.back().end_machine[index_of(Axis::C)];
  EXPECT_NEAR(std::abs(last - first), 720.0 * deg, kPrintTol);
}

TEST(Post, ClassicalPostHasOneBlockALocation) {
  PostOptions options = usual_options();
  options.mode = PostMode::locations;
  const ClData data = wandering(3);
  const Posted posted = post(data, "p.cls", machine(kTableTable), options);
  EXPECT_EQ(posted.inserted, 0u);
  EXPECT_EQ(posted.moves.size(), data.records.size() + 1);  // and the tool
}

TEST(Post, TipWordsAreTheLocations) {
  PostOptions options = usual_options();
  options.mode = PostMode::tip;
  options.tolerance.axis = 1.0;
  const ClData data = wandering(4);
  const Posted posted = post(data, "p.cls", machine(kTableTable), options);
  ASSERT_EQ(posted.moves.size(), data.records.size() + 1);
  for (std::size_t n = 0; n < data.records.size(); ++n) {
    EXPECT_LT((posted.moves[n + 1].end.head<3>() - data.records[n].P.p_WT).norm(), 1e-15);
  }
  EXPECT_DOUBLE_EQ(posted.moves.back().feed, options.feed);
  EXPECT_EQ(posted.moves.back().feed_mode, FeedMode::units_per_minute);
}

TEST(Post, TipControlNeedsFewerPoints) {
  PostOptions options = usual_options();
  const ClData data = wandering(5);
  const auto inserted = [&](PostMode mode) {
    options.mode = mode;
    return post(data, "p.cls", machine(kTableTable), options).inserted;
  };
  EXPECT_LT(inserted(PostMode::tip), inserted(PostMode::joints));
}

TEST(Post, WholeProgramAsPrinted) {
  PostOptions options;
  options.tools = usual_setup().tools;
  const ClData data =
      cl("LOADTL/1\nSPINDL/600,CLW\nCOOLNT/ON\nRAPID\nGOTO/0,0,10,0,0,1\nFEDRAT/600\n"
         "GOTO/0,0,0\nGOTO/10,0,0\nSPINDL/OFF\nFINI\n");
  PrintOptions print;
  print.axes = "XYZAC";
  EXPECT_EQ(print_program(post(data, "p.cls", machine(kTableTable), options).moves, print, "").text,
            "G21 G90 G91.1 G94 G17 G40 G80\nT1 M6\nS600\nM3\nM8\nG54\nG43 H1\nG64 P0.001\n"
            "G0 X0 Y0 Z10 A0 C0\nG93\nG1 Z0 F60\nG1 X10 F60\nM5\nM30\n");
  options.mode = PostMode::tip;
  print.tip_control = true;
  EXPECT_EQ(print_program(post(data, "p.cls", machine(kTableTable), options).moves, print, "").text,
            "G21 G90 G91.1 G94 G17 G40 G80\nT1 M6\nS600\nM3\nM8\nG54\nG43.4 H1\nG64 P0.001\n"
            "G0 X0 Y0 Z10 A0 C0\nG1 Z0 F600\nG1 X10\nM5\nM30\n");
}

TEST(Post, SingularToolAxisIsToldOnce) {
  const Posted posted = post(cl("GOTO/0,0,10\nGOTO/0,0,0\nGOTO/5,0,0\n"), "p.cls",
                             machine(kTableTable), usual_options());
  ASSERT_EQ(posted.warnings.size(), 1u);
  EXPECT_EQ(to_string(posted.warnings[0]),
            "p.cls:1: warning: the tool axis is singular, here and at 2 more locations: a rotary "
            "axis keeps its angle");
}

TEST(Post, Faults) {
  EXPECT_EQ(fault_of_post(cl("GOTO/900,0,0\n"), machine(kTableTable)),
            "p.cls:1: error: axis X would stand at 930 mm, beyond its travel of -500 to 500");
  EXPECT_EQ(fault_of_post(cl("GOTO/0,0,0\nGOTO/0,0,0,0,0,-1\n"), machine(kTableTable)),
            "p.cls:2: error: the tool axis turns round: no way of turning is the shortest");
  EXPECT_EQ(
      fault_of_post(cl("GOTO/0,0,0,0,-1,-1\n"), machine(kTableTable)),
      "p.cls:1: error: axis A would stand at 135 deg, beyond its travel of -114.592 to 114.592");
  EXPECT_EQ(fault_of_post(cl("GOTO/0,0,0,1,0,0\n"), machine("[w b X Y Z C t]")),
            "p.cls:1: error: the rotary axes miss this tool axis by 90 deg");
  PostOptions options = usual_options();
  options.feed = 0.0;
  EXPECT_EQ(
      fault_of_post(cl("GOTO/0,0,1\nGOTO/0,0,0\nGOTO/1,0,0\n"), machine(kTableTable), options),
      "p.cls:2: error: no feed is given for this location; add FEDRAT or --feed");
  EXPECT_EQ(fault_of_post(cl("LOADTL/7\nGOTO/0,0,1\n"), machine(kTableTable)),
            "p.cls:1: error: tool 7 is not in the tool table");
}

TEST(Post, ATableThatTiltsToOneSideCannotPassTheVertical) {
  EXPECT_EQ(
      fault_of_post(cl("GOTO/0,0,0,0,-0.6,0.8\nGOTO/5,0,0,0,0.6,0.8\n"), machine(kTableTable, 0.0)),
      "p.cls:2: error: at 50.0 % of the way here the tool axis passes a singular direction, or "
      "the end of a rotary axis' travel, where the axes would have to jump; lead it past at a "
      "distance, or retract there");
  EXPECT_EQ(
      fault_of_post(cl("GOTO/0,0,0,0,-0.6,0.8\nGOTO/5,0,0,0,0.6,0.8\n"), machine(kTableTable)), "");
}

}  // namespace
}  // namespace servomill::controllers
