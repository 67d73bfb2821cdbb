#include "controllers/gcode/post_processor.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "controllers/gcode/printer.h"
#include "controllers/path/trajectory.h"
#include "tests/controllers/gcode/cutter_locations.h"

namespace servomill::controllers::post_processor_test {
namespace {

using Eigen::Vector3d;

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
    const PostProcessed made = post(data, "p.cls", inverse, options);
    EXPECT_GT(made.inserted, data.records.size()) << structure;
    const auto moves = read_again(made, options);
    ASSERT_EQ(moves.size(), data.records.size() + made.inserted);
    std::size_t n = 0;
    Joints Q = inverse.chain().layout.joints(moves[0].end_machine);
    double s = 0.0, s_of_location = 0.0;
    for (std::size_t i = 1; i < moves.size(); ++i) {
      const Joints next = inverse.chain().layout.joints(moves[i].end_machine);
      const ToolPose from = data.records[n].P, to = data.records[n + 1].P;
      const double length = (to.p_WT - from.p_WT).norm();
      const double share = (made.moves[i + 1].s_end - made.moves[i + 1].s_begin) / length;
      const plant::StraightToolPath path(from, to);
      for (double f = 0.0; f <= 1.0; f += 0.05) {
        const ToolPose is = plant::forward(inverse.chain(), Q + f * (next - Q), p_ST);
        const ToolPose wanted = path.at((s - s_of_location) / length + f * share);
        EXPECT_LT((is.p_WT - options.work_offset - wanted.p_WT).norm(),
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
  const PostProcessed made = post(data, "p.cls", inverse, options);
  const double first = made.moves[1].end_machine[index_of(Axis::C)];
  const double last = made.moves.back().end_machine[index_of(Axis::C)];
  EXPECT_NEAR(std::abs(last - first), 720.0 * deg, kPrintTol);
}

TEST(Post, ClassicalPostHasOneBlockALocation) {
  PostOptions options = usual_options();
  options.mode = PostMode::locations;
  const ClData data = wandering(3);
  const PostProcessed made = post(data, "p.cls", machine(kTableTable), options);
  EXPECT_EQ(made.inserted, 0u);
  EXPECT_EQ(made.moves.size(), data.records.size() + 1);  // and the tool
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
  options.approach = Approach::direct;
  options.tools = usual_setup().tools;
  const ClData data =
      cl("LOADTL/1\nSPINDL/600,CLW\nCOOLNT/ON\nRAPID\nGOTO/0,0,10,0,0,1\nFEDRAT/600\n"
         "GOTO/0,0,0\nGOTO/10,0,0\nSPINDL/OFF\nFINI\n");
  PrintOptions print;
  print.axes = "XYZAC";
  EXPECT_EQ(print_program(post(data, "p.cls", machine(kTableTable), options).moves, print, "").text,
            "G21 G90 G91.1 G94 G17 G40 G80 G92.1\nT1 M6\nS600\nM3\nM8\nG54\nG43 H1\nG64 P0.0005\n"
            "G0 X0 Y0 Z10 A0 C0\nG93\nG1 Z0 F60\nG1 X10 F60\nM5\nM30\n");
  options.mode = PostMode::tip;
  print.tcp_control = true;
  EXPECT_EQ(print_program(post(data, "p.cls", machine(kTableTable), options).moves, print, "").text,
            "G21 G90 G91.1 G94 G17 G40 G80 G92.1\nT1 M6\nS600\nM3\nM8\nG54\nG43.4 H1\nG64 P0.001\n"
            "G0 X0 Y0 Z10 A0 C0\nG1 Z0 F600\nG1 X10\nM5\nM30\n");
}

TEST(Post, Faults) {
  EXPECT_EQ(fault_of_post(cl("GOTO/900,0,0\n"), machine(kTableTable)),
            "p.cls:1: error: axis X would move to 930 mm, outside its travel of -500 to 500");
  EXPECT_EQ(fault_of_post(cl("GOTO/0,0,0\nGOTO/0,0,0,0,0,-1\n"), machine(kTableTable)),
            "p.cls:2: error: the tool axis is reversed (180 deg): the direction of rotation is "
            "undetermined");
  EXPECT_EQ(
      fault_of_post(cl("GOTO/0,0,0,0,-1,-1\n"), machine(kTableTable)),
      "p.cls:1: error: axis A would move to 135 deg, outside its travel of -114.592 to 114.592");
  EXPECT_EQ(fault_of_post(cl("GOTO/0,0,0,1,0,0\n"), machine("[w b X Y Z C t]")),
            "p.cls:1: error: the rotary axes cannot reach this tool axis; the error is 90 deg");
  PostOptions options = usual_options();
  options.feed = 0.0;
  EXPECT_EQ(
      fault_of_post(cl("GOTO/0,0,1\nGOTO/0,0,0\nGOTO/1,0,0\n"), machine(kTableTable), options),
      "p.cls:2: error: no feed rate is defined for this location; add FEDRAT or --feed");
  EXPECT_EQ(fault_of_post(cl("LOADTL/7\nGOTO/0,0,1\n"), machine(kTableTable)),
            "p.cls:1: error: tool 7 is not in the tool table");
}

TEST(Post, ATableThatTiltsToOneSideCannotPassTheVertical) {
  EXPECT_EQ(
      fault_of_post(cl("GOTO/0,0,0,0,-0.6,0.8\nGOTO/5,0,0,0,0.6,0.8\n"), machine(kTableTable, 0.0)),
      "p.cls:2: error: at 50.0 % of the move to this location axis A reaches its travel limit at 0 "
      "deg; the alternative solution would require the axes to jump; keep the tool axis away from "
      "it, retract there, or change the start position (--start)");
  EXPECT_EQ(
      fault_of_post(cl("GOTO/0,0,0,0,-0.6,0.8\nGOTO/5,0,0,0,0.6,0.8\n"), machine(kTableTable)), "");
}

// ------------------------------------------------------------------ tolerance, speeds, warnings

// Chords and the rounding of corners (G64 P) share the tolerance of the tip.
TEST(Post, ChordsAndRoundingTogetherKeepToTheTolerance) {
  const PostOptions options = usual_options();
  const Vector3d p_ST(0.0, 0.0, -100.0 * mm);
  const auto inverse = machine(kTableTable);
  const ClData data = wandering(6);
  const auto moves = read_again(post(data, "p.cls", inverse, options), options);
  const JointLayout& layout = inverse.chain().layout;
  const auto distance_from_way = [&](const Vector3d& tip) {
    double nearest = 1e9;
    for (std::size_t n = 1; n < data.records.size(); ++n) {
      const Vector3d a = data.records[n - 1].P.p_WT + options.work_offset;
      const Vector3d d = data.records[n].P.p_WT + options.work_offset - a;
      const double t = std::clamp((tip - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (tip - a - t * d).norm());
    }
    return nearest;
  };
  double chords = 0.0;
  for (std::size_t i = 1; i < moves.size(); ++i) {
    const Joints Q = layout.joints(moves[i - 1].end_machine);
    const Joints step = layout.joints(moves[i].end_machine) - Q;
    for (double f = 0.0; f < 1.0; f += 0.05) {
      chords = std::max(
          chords, distance_from_way(plant::forward(inverse.chain(), Q + f * step, p_ST).p_WT));
    }
  }
  constexpr double kPlaces = 0.01;  // of the tolerance: chords are looked at in three places
  EXPECT_LE(chords + moves.back().path_tolerance,
            (1.0 + kPlaces) * options.tolerance.tip + kPrintTol);
  EXPECT_GT(chords + moves.back().path_tolerance, 0.7 * options.tolerance.tip);

  JointLimits limits;
  limits.v << 0.5, 0.5, 0.5, 10.0, 10.0;
  limits.a << 5.0, 5.0, 5.0, 50.0, 50.0;
  limits.j << 100.0, 100.0, 100.0, 1000.0, 1000.0;
  const Trajectory trajectory =
      plan(moves, layout, layout.joints(moves.front().end_machine), limits);
  Trajectory::Cursor cursor{};
  double worst = 0.0;
  for (double t = 0.0; t < trajectory.duration(); t += 0.5e-3) {
    worst = std::max(
        worst, distance_from_way(
                   plant::forward(inverse.chain(), trajectory.at(t, cursor).Q_ref, p_ST).p_WT));
  }
  EXPECT_LT(worst, options.tolerance.tip);
}

// ------------------------------------------------------------------------ singular directions

// Joints of the feed moves, in order.
std::vector<Joints> joints_of(const PostProcessed& made, const plant::InverseKinematics& inverse) {
  std::vector<Joints> out;
  for (const Move& move : made.moves) {
    if (is_motion(move.kind)) out.push_back(inverse.chain().layout.joints(move.end_machine));
  }
  return out;
}

// A part that begins upright beside the axis of C and then tilts: the rapid turns C to where it
// will be, and nothing has to turn while cutting.
TEST(Post, LooksAheadForTheAngleThatIsFree) {
  for (const PostMode mode : {PostMode::joints, PostMode::tip, PostMode::locations}) {
    for (int phi = -180; phi < 180; phi += 45) {
      PostOptions options = usual_options();
      options.mode = mode;
      const auto inverse = machine(kTableTable, -0.1);  // A tilts to one side
      const std::string part =
          fmt::format("RAPID\nGOTO/40,10,30\nGOTO/40,10,0\nGOTO/45,10,0\nGOTO/50,15,0,{},{},1\n",
                      0.5 * std::cos(phi * deg), 0.5 * std::sin(phi * deg));
      const PostProcessed made = post(cl(part), "p.cls", inverse, options);
      const auto joints = joints_of(made, inverse);
      EXPECT_NEAR(joints.back()[4], joints.front()[4], 1e-6) << phi;
      EXPECT_NEAR(joints.back()[3], std::atan(0.5), 1e-9) << phi;
      EXPECT_LT(joints.size(), 200u);
    }
  }
}

// It comes to the vertical from one side and leaves it to another.
TEST(Post, TurnsTheFreeAxisWithTheTipInPlace) {
  const Vector3d p_ST(0.0, 0.0, -100.0 * mm);
  PostOptions options = usual_options();
  const std::string part = "GOTO/40,10,0,0,-0.5,1\nGOTO/45,10,0,0,0,1\nGOTO/50,15,0,0.5,0,1\n";
  const Vector3d upright = Vector3d(45, 10, 0) * mm + options.work_offset;
  const auto inverse = machine(kTableTable);
  const PostProcessed made = post(cl(part), "p.cls", inverse, options);
  double turned = 0.0, time = 0.0;
  for (std::size_t i = 1; i < made.moves.size(); ++i) {
    const Move& move = made.moves[i];
    const Joints Q_0 = inverse.chain().layout.joints(made.moves[i - 1].end_machine);
    const Joints Q_1 = inverse.chain().layout.joints(move.end_machine);
    if (move.line != 3 || move.s_end > move.s_begin) continue;
    turned += std::abs(Q_1[4] - Q_0[4]);
    time += std::abs(Q_1[4] - Q_0[4]) / move.feed;
    for (double f = 0.0; f <= 1.0; f += 0.1) {
      const ToolPose P = plant::forward(inverse.chain(), Q_0 + f * (Q_1 - Q_0), p_ST);
      EXPECT_LT((P.p_WT - upright).norm(), 1.01 * kChordTolerance * options.tolerance.tip);
      EXPECT_LT(angle_between(P.k_W, Vector3d::UnitZ()), 1e-9);
    }
  }
  EXPECT_NEAR(turned, 90 * deg, 1e-6);
  EXPECT_NEAR(time, 90 * deg / options.rotary_rate, 1e-6);
  ASSERT_GE(made.warnings.size(), 1u);
  EXPECT_EQ(to_string(made.warnings.front()),
            "p.cls:3: warning: C rotates by 90 deg at a fixed TCP before the tool axis leaves a "
            "singular direction; a retract there would avoid it");
  // the NC with tip control turns it in one block
  options.mode = PostMode::tip;
  const PostProcessed tip = post(cl(part), "p.cls", inverse, options);
  EXPECT_EQ(std::count_if(tip.moves.begin(), tip.moves.end(),
                          [](const Move& m) { return m.line == 3 && m.s_end == m.s_begin; }),
            1);
}

TEST(Post, LeavesASingularDirectionOnTheBranchThatArrives) {
  const auto inverse = machine(kTableTable, -0.1);
  for (const double y : {-0.5, 0.5}) {
    const PostProcessed made = post(cl(fmt::format("GOTO/0,0,0\nGOTO/10,0,0,0,{},0.866\n", y)),
                                    "p.cls", inverse, usual_options());
    EXPECT_GT(joints_of(made, inverse).back()[3], 0.0);
  }
}

}  // namespace
}  // namespace servomill::controllers::post_processor_test
