// Tool-centre-point control: the tip goes straight, at its feed, within what the joints can.
#include "controllers/path/tcp_motion.h"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

#include "tip_programs.h"

namespace servomill::controllers::test::tcp_motion_test {
namespace {

using Eigen::Vector3d;
using Sample = Trajectory::Sample;

constexpr double kStep = 0.5e-3;        // s, at which a planned motion is looked at
constexpr double kFeedTol = 1e-3;       // of the feed: steps between chords, and the time law
constexpr double kFeedDip = 3e-3;       // of the feed: what the search for the time law leaves
constexpr double kStraight = 0.5 * um;  // where no corner is rounded: chords, T = 10 um

// ----------------------------------------------------------------------------- along one line

const Vector3d kFrom = Vector3d(-40, 10, 0) * mm, kTo = Vector3d(40, 20, 10) * mm;

std::string words_program(const std::string& tilt, const std::string& path_mode = "") {
  return path_mode + "G43.4 H1\nG0 X-40 Y10 Z0 " + tilt + "10 C0\nG1 X40 Y20 Z10 " + tilt +
         "40 C90 F2000\n";
}

TEST(TcpMotion, RunsStraightInTheWorkpieceWhileTheAxesTurn) {
  for (const auto& [name, machine, tilt] : machines()) {
    for (const std::string mode : {"", "G64 P0.05 ", "G61 "}) {
      const Planned p(machine, words_program(tilt, mode));
      const double T = mode == "G61 " ? p.machine.options.exact_tolerance : kStraight;
      double worst = 0.0;
      p.sample_line(3, kStep, [&](const Sample&, const ToolPose& P) {
        worst = std::max(worst, distance_to_line(P.p_WT, kFrom, kTo));
      });
      EXPECT_LT(worst, T) << name << " " << mode;
      EXPECT_LT((machine.pose(p.trajectory.end()).p_WT - kTo).norm(), 1e-15) << name;
      expect_within_joint_limits(p);
    }
  }
}

// Without it the joints go linearly, and the tip leaves the line by e(t) = 4 e_m t (1 - t) to
// leading order: PAPERS, paper [L], the error of joint interpolation.
TEST(TcpMotion, WithoutItTheTipLeavesTheLineInAParabola) {
  const TipMachine machine = table_machine();
  const JointLayout& layout = machine.chain.layout;
  const auto moves =
      machine.read("G43.4 H1\nG0 X-40 Y10 Z0 A20 C30\nG0 X-38 Y11 Z0.5 A21.5 C33\nM0");
  const auto joints_at_end = [&](std::size_t i) {
    return *machine.control()->joints(moves[i].end_machine.head<3>(),
                                      layout.joints(moves[i].end_machine),
                                      Vector3d(0, 0, -100 * mm));
  };
  const Joints Q_0 = joints_at_end(0), Q_1 = joints_at_end(1);
  const auto error = [&](double t) -> Vector3d {
    const Vector3d straight = moves[0].end_machine.head<3>() +
                              t * (moves[1].end_machine.head<3>() - moves[0].end_machine.head<3>());
    return machine.pose(Q_0 + t * (Q_1 - Q_0)).p_WT - straight;
  };
  const Vector3d e_m = error(0.5);
  // half the second derivative of the tip along the joints' straight way, over four
  const double h = 0.25;
  const Vector3d second = (error(0.5 + h) - 2.0 * e_m + error(0.5 - h)) / (h * h);
  EXPECT_LT((e_m + second / 8.0).norm(), 0.01 * e_m.norm());
  for (double t = 0.1; t < 1.0; t += 0.1) {
    EXPECT_LT((error(t) - 4.0 * t * (1.0 - t) * e_m).norm(), 0.01 * e_m.norm()) << t;
  }
  EXPECT_GT(e_m.norm(), 10 * um) << "more than the tolerance: the control has something to do";
  const Planned p(machine, "G43.4 H1\nG0 X-40 Y10 Z0 A20 C30\nG1 X-38 Y11 Z0.5 A21.5 C33 F500\n");
  p.sample_line(3, kStep, [&](const Sample&, const ToolPose& P) {
    EXPECT_LT(
        distance_to_line(P.p_WT, moves[0].end_machine.head<3>(), moves[1].end_machine.head<3>()),
        kStraight);
  });
}

TEST(TcpMotion, TheFeedIsThatOfTheTip) {
  for (const auto& [name, machine, tilt] : machines()) {
    const Planned p(machine, words_program(tilt));
    const double F = 2000 * mm_per_min;
    const Move& line = p.moves[1];
    p.sample_line(3, kStep, [&](const Sample& now, const ToolPose&) {
      const double f = (now.s - line.s_begin) / (line.s_end - line.s_begin);
      const double share = tip_velocity(p, now).norm() / F;
      EXPECT_LT(share, 1.0 + kFeedTol) << name << " at " << f;
      if (f > 0.1 && f < 0.9) {  // without the ramps
        EXPECT_GT(share, 1.0 - kFeedDip) << name << " at " << f;
      }
      if (f > 0.3 && f < 0.7) {
        EXPECT_GT(share, 1.0 - kFeedTol) << name << " at " << f;
      }
    });
  }
}

TEST(TcpMotion, InverseTimeGivesTheDuration) {
  const TipMachine machine = head_machine();
  const Planned p(machine, "G43.4 H1\nG93 G1 X60 B40 C50 F6\n");
  const double ramps = p.trajectory.duration() - 10.0;
  EXPECT_GT(ramps, 0.0);
  EXPECT_LT(ramps, 0.2) << "s; starting and stopping at 6 mm/s";
}

TEST(TcpMotion, TheProgramIsKnownByTheArcLengthOfTheTip) {
  for (const auto& [name, machine, tilt] : machines()) {
    const Planned p(machine, words_program(tilt));
    const Move& line = p.moves[1];
    EXPECT_NEAR(line.s_end - line.s_begin, (kTo - kFrom).norm(), 1e-15);
    p.sample_line(3, kStep, [&](const Sample& now, const ToolPose& P) {
      const double way = (P.p_WT - kFrom).dot((kTo - kFrom).normalized());
      EXPECT_NEAR(now.s - line.s_begin, way, kStraight) << name;
    });
  }
}

TEST(TcpMotion, ArcsOfTheTipAreRound) {
  for (const auto& [name, machine, tilt] : machines()) {
    const Planned p(machine,
                    "G43.4 H1\nG0 X20 Y0 Z0\nG3 X20 Y0 I-20 P2 " + tilt + "20 C70 F1500\n");
    EXPECT_NEAR(p.moves[1].s_end - p.moves[1].s_begin, 4 * std::numbers::pi * 20 * mm, 1e-14);
    double turned = 0.0;
    p.sample_line(3, kStep, [&](const Sample& now, const ToolPose& P) {
      EXPECT_NEAR(P.p_WT.head<2>().norm(), 20 * mm, kStraight) << name;
      EXPECT_NEAR(P.p_WT.z(), 0.0, kStraight);
      turned = now.s;
    });
    EXPECT_GT(turned, 0.2) << "both turns";
  }
}

// ------------------------------------------------------------------------------ the tool axis

TEST(TcpMotion, TheToolAxisKeepsToTheGreatCircle) {
  for (const auto& [name, machine, tilt] : machines()) {
    const Planned p(machine,
                    "G43.5 H1\nG0 X-40 Y10 Z0 I0.3 J0.1 K1\nG1 X40 Y20 Z10 I0 J0.6 K0.8 F2000\n");
    const Vector3d k_0 = Vector3d(0.3, 0.1, 1).normalized(), k_1(0, 0.6, 0.8);
    const Vector3d normal = k_0.cross(k_1).normalized();
    const double angle = std::acos(k_0.dot(k_1)), T = p.machine.options.rotary_tolerance;
    const Move& line = p.moves[1];
    p.sample_line(3, kStep, [&](const Sample& now, const ToolPose& P) {
      EXPECT_LT(std::abs(P.k_W.dot(normal)), T) << name;
      const double f = (now.s - line.s_begin) / (line.s_end - line.s_begin);
      EXPECT_NEAR(std::acos(std::min(1.0, P.k_W.dot(k_0))), f * angle, T) << name << " at " << f;
      EXPECT_LT(distance_to_line(P.p_WT, kFrom, kTo), kStraight) << name;
    });
  }
}

TEST(TcpMotion, TheTipStandsWhileTheToolAxisTurnsAtItsFeed) {
  for (const auto& [name, machine, tilt] : machines()) {
    const Planned p(machine, "G43.5 H1\nG0 X-40 Y10 Z0 I0.6 K0.8\nG1 J0.6 K0.8 F900\n");
    Vector3d before = Vector3d::Zero();
    int cruising = 0;
    p.sample_line(3, kStep, [&](const Sample&, const ToolPose& P) {
      EXPECT_LT((P.p_WT - kFrom).norm(), kStraight) << name;
      const double rate = (P.k_W - before).norm() / kStep;
      before = P.k_W;
      if (std::abs(rate / (900 * deg_per_min) - 1.0) < 3 * kFeedTol) ++cruising;
    });
    EXPECT_GT(cruising * kStep, 0.8 * 49.7 / 15.0) << "s of the turn by 49.7 deg at 15 deg/s";
    expect_within_joint_limits(p);
  }
}

TEST(GreatCircle, IsKeptByTheKnots) {
  const TipMachine machine = table_machine();
  const auto control = machine.control();
  const JointLayout& layout = machine.chain.layout;
  AxisWords words = AxisWords::Zero();
  words[3] = 15 * deg;
  words[5] = -40 * deg;
  const Joints Q = layout.joints(words);
  const Vector3d k_0 = control->tool_axis(Q), k_1 = Vector3d(0.5, 0.2, 0.7).normalized();
  const AxisTurn turn = control->great_circle(Q, k_1);
  ASSERT_EQ(turn.fault, "");
  EXPECT_NEAR(turn.angle, std::acos(k_0.dot(k_1)), 1e-12);
  RotaryKnot from{0.0, Q};
  for (const RotaryKnot& to : turn.knots) {
    EXPECT_TRUE(to.is_even);
    for (double f = 0.0; f <= 1.0; f += 0.1) {
      const double t = from.fraction + f * (to.fraction - from.fraction);
      const Vector3d k = control->tool_axis(from.Q + f * (to.Q - from.Q));
      EXPECT_LT((k - ToolCentrePoint::axis_between(k_0, k_1, t)).norm(),
                1.01 * control->axis_tolerance());  // looked at in three places of each chord
    }
    from = to;
  }
  EXPECT_LT((control->tool_axis(turn.knots.back().Q) - k_1).norm(), 1e-12);
}

// ------------------------------------------------------------------------------ corners, planes

TEST(TcpMotion, CornersOfTheTipStayWithinTheTolerance) {
  for (const auto& [name, machine, tilt] : machines()) {
    for (const double P_mm : {0.0, 0.05}) {
      const std::string mode = P_mm > 0.0 ? "G64 P0.05 " : "G64 ";
      const Planned p(machine, mode + "G43.4 H1\nG1 X-40 Y10 Z0 F3000\nX0 " + tilt +
                                   "20 C30\nX5 Y30 " + tilt + "25 C50\nX40 Z5 " + tilt +
                                   "40 C90\n");
      const double T = P_mm > 0.0 ? P_mm * mm : p.machine.options.tolerance;
      std::vector<Vector3d> points;
      for (const Move& move : p.moves) {
        if (is_motion(move.kind)) points.push_back(move.end_machine.head<3>());
      }
      double worst = 0.0;
      p.sample(kStep, [&](const Sample& now, const ToolPose& P) {
        if (now.line < 3) return;
        double nearest = 1e9;
        for (std::size_t i = 0; i + 1 < points.size(); ++i) {
          const Vector3d d = points[i + 1] - points[i];
          const double t = std::clamp((P.p_WT - points[i]).dot(d) / d.squaredNorm(), 0.0, 1.0);
          nearest = std::min(nearest, (P.p_WT - points[i] - t * d).norm());
        }
        worst = std::max(worst, nearest);
      });
      EXPECT_LT(worst, T) << name;
      expect_within_joint_limits(p);
    }
  }
}

TEST(TiltedPlane, ASquareLiesInThePlaneWithExactCorners) {
  for (const auto& [name, machine, tilt] : machines()) {
    const Planned p(
        machine,
        "G43 H1 G61\nG68.2 X5 Y6 Z7 I20 J30 K10\nG53.1\nG1 X0 Y0 Z0 F2000\nX30\nY30\nX0\n"
        "Y0\nG2 I15 J15\nG69\n");
    const auto turn = [](double angle, const Vector3d& about) {
      return Eigen::AngleAxisd(angle * deg, about).toRotationMatrix();
    };
    const Eigen::Matrix3d R =
        turn(20, Vector3d::UnitZ()) * turn(30, Vector3d::UnitX()) * turn(10, Vector3d::UnitZ());
    const Vector3d origin = Vector3d(5, 6, 7) * mm;
    std::vector<double> nearest(4, 1e9);
    const double T = p.machine.options.exact_tolerance;
    p.sample(kStep, [&](const Sample& now, const ToolPose& P) {
      if (now.line < 5) return;
      const Vector3d q = R.transpose() * (P.p_WT - origin);
      EXPECT_LT(std::abs(q.z()), T) << name;
      EXPECT_LT((P.k_W - R.col(2)).norm(), 1e-12) << name;
      if (now.line == 9) {
        EXPECT_NEAR((q.head<2>() - Eigen::Vector2d(15, 15) * mm).norm(), 15 * std::sqrt(2) * mm, T);
        return;
      }
      const double edge = std::min(
          {std::abs(q.x()), std::abs(q.y()), std::abs(q.x() - 30 * mm), std::abs(q.y() - 30 * mm)});
      EXPECT_LT(edge, T) << name << " line " << now.line;
    });
    // corners are ends of chains, where the machine stands
    for (std::size_t n = 0; n < p.trajectory.chains(); ++n) {
      const auto held = p.trajectory.chain(n);
      const Trajectory::Chain& chain = *held;
      const Vector3d q = R.transpose() * (machine.pose(chain.end).p_WT - origin);
      const Vector3d corners[] = {{30, 0, 0}, {30, 30, 0}, {0, 30, 0}, {0, 0, 0}};
      for (std::size_t i = 0; i < 4; ++i) {
        nearest[i] = std::min(nearest[i], (q - corners[i] * mm).norm());
      }
    }
    for (const double miss : nearest) EXPECT_LT(miss, 1e-15) << name;
  }
}

// ---------------------------------------------------------------------------------------- travel

TEST(TcpMotion, LeavingTheTravelIsSaidOnceALineAndJoint) {
  TipMachine machine = table_machine();
  const Planned p(machine, words_program("A"));
  Joints lower = machine.lower, upper = machine.upper;
  upper[0] = 10 * mm;
  std::vector<std::string> found;
  for (const Fault& fault :
       travel_faults(p.moves, machine.chain.layout, Joints::Zero(), lower, upper, "p.nc", p.tip)) {
    found.push_back(to_string(fault));
  }
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0],
            "p.nc:3: error: X moves to 23.6604 mm, outside its travel; must be <= 10.0000");
}

// The tool axis goes round the pole beyond the end of C.
TEST(TcpMotion, AnAxisAtItsEndCannotGoOn) {
  const auto message = [](double least_A, const std::string& program) {
    TipMachine machine = table_machine();
    machine.lower[3] = least_A;
    machine.lower[4] = -170 * deg;
    machine.upper[4] = 170 * deg;
    try {
      machine.read(program);
      return std::string();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
  };
  const std::string round = "G43.5 H1\nG0 X0 I0.342 J0.94 K2\nG1 I-0.342 J0.94 K2 F100\n";
  EXPECT_EQ(message(0.0, round),
            "p.nc:3:1: error: during the move, the tool axis (0.000000, 0.425361, 0.905024) "
            "requires C = 180.0000 deg; must be <= 170.0000");
  EXPECT_EQ(message(-120 * deg, round), "") << "A goes the other way from the begin";
  EXPECT_EQ(message(-120 * deg, "G0 A26 C160\nG43.5 H1\nG1 I-0.342 J0.94 K2 F100\n"),
            "p.nc:3:1: error: C reaches its travel limit at 170.0000 deg; otherwise would have to "
            "jump from 170.0000 to -10.0000 deg");
}

// Through the vertical A would go to the other side, but ends before.
TEST(TcpMotion, TheAxisThatIsAtItsEndIsNamed) {
  TipMachine machine = table_machine();
  machine.lower[3] = -10 * deg;
  try {
    machine.read("G0 A5\nG43.5 H1\nG1 I0 J0.5 K0.866 F100\n");
    FAIL() << "A would have to pass its end, or C to jump";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              "p.nc:3:1: error: A reaches its travel limit at -10.0000 deg; otherwise C would have "
              "to jump from 0.0000 to -180.0000 deg");
  }
}

TEST(TcpMotion, WhatLinearAxesCannotReachIsSaidWithTheLine) {
  TipMachine machine = table_machine();
  machine.chain = plant::make_chain(plant::parse_structure("[w C' A' X' b Z t]"));
  try {
    Planned(machine, "G43.4 H1\nG0 X10\nG1 X20 A10 F100\n");
    FAIL() << "there is no Y";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              "p.nc:3: error: the linear axes cannot reach this TCP position");
  }
}

// Chords of a long program are on the disk.
TEST(TcpMotion, IsTheSameWithChordsOnTheDisk) {
  const NamedMachine in_memory = machines().front();
  TipMachine little = in_memory.machine;
  little.options.plans_in_memory = 1000;
  const std::string program = words_program(in_memory.tilt);
  const Planned p(in_memory.machine, program), q(little, program);
  EXPECT_FALSE(p.tip.chords.is_on_disk());
  EXPECT_TRUE(q.tip.chords.is_on_disk());
  ASSERT_EQ(p.tip.chords.size(), q.tip.chords.size());
  for (std::size_t i = 0; i < p.tip.chords.size(); ++i) {
    const JointChord &a = p.tip.chords[i], &b = q.tip.chords[i];
    EXPECT_EQ(a.end, b.end);
    EXPECT_EQ(a.tolerance_linear, b.tolerance_linear);
    EXPECT_EQ(a.tolerance_rotary, b.tolerance_rotary);
  }
  EXPECT_EQ(p.trajectory.duration(), q.trajectory.duration());
}

}  // namespace
}  // namespace servomill::controllers::test::tcp_motion_test
