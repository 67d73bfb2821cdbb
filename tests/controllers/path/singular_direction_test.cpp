// Singular directions of the tool axis under tool-centre-point control: moves that pass near them
// are slowed, moves through them keep the axis that need not turn.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "controllers/path/tcp_motion.h"
#include "tip_programs.h"

namespace servomill::controllers::test::singular_direction_test {
namespace {

using Eigen::Vector3d;
using Sample = Trajectory::Sample;

constexpr double kStep = 0.5e-3;        // s, at which a planned motion is sampled
constexpr double kStraight = 0.5 * um;  // where no corner is rounded: chords, T = 10 um

const Vector3d kFrom = Vector3d(-40, 10, 0) * mm, kTo = Vector3d(40, 20, 10) * mm;

std::string past_the_pole(double distance) {
  return fmt::format(
      "G43.5 H1\nG0 X-40 Y10 Z0 I-0.3 J{0:.9f} K1\nG1 X40 Y20 Z10 I0.3 J{0:.9f} K1 F2000\n",
      distance);
}

// The message assumes a constant feed and the programmed path: to change the feed takes
// jerk, too, which near the pole leaves less than half; rounding within the tolerance gains some.
void expect_about(double share, double said) {
  constexpr double kLess = 0.3, kMore = 1.15;
  EXPECT_LT(share, kMore * said);
  EXPECT_GT(share, kLess * said);
}

TEST(SingularDirection, PassingNearItSlowsTheMoveAndSaysSo) {
  for (const auto& [name, machine, tilt] : machines()) {
    const Planned p(machine, past_the_pole(0.001));
    double slowest = 1e9, worst = 0.0, step = 0.0;
    Joints before = Joints::Zero();
    bool first = true;
    p.sample_line(3, kStep, [&](const Sample& now, const ToolPose& P) {
      worst = std::max(worst, distance_to_line(P.p_WT, kFrom, kTo));
      if (!first) step = std::max(step, (now.Q_ref - before).tail<2>().cwiseAbs().maxCoeff());
      before = now.Q_ref;
      first = false;
      const double f = (now.s - p.moves[1].s_begin) / (p.moves[1].s_end - p.moves[1].s_begin);
      if (f > 0.1 && f < 0.9) slowest = std::min(slowest, tip_velocity(p, now).norm());
    });
    EXPECT_LT(worst, kStraight) << name;
    EXPECT_LE(step, p.machine.limits.v[4] * kStep * 1.01) << "no jump";
    EXPECT_LT(slowest, 0.1 * 2000 * mm_per_min);
    expect_within_joint_limits(p);
    ASSERT_EQ(p.tip.slowed.size(), 1U);
    const FeedReduction& slowed = p.tip.slowed.front();
    EXPECT_EQ(slowed.line, 3);
    EXPECT_EQ(p.machine.chain.layout.letter_of(slowed.joint), 'C');
    // C = atan(w t / d) at the distance d from the pole: dC <= w / d, ddC <= 0.65 (w / d)^2,
    // dddC <= 2 (w / d)^3
    const double w = 2 * std::atan(0.3) * 2000 * mm_per_min / (kTo - kFrom).norm() / 0.001;
    EXPECT_EQ(slowed.order, 3);
    EXPECT_NEAR(slowed.needed / (2 * w * w * w), 1.0, 0.05);
    EXPECT_NEAR(slowed.singular_angle, 0.001, 0.2 * 0.001);
    expect_about(slowest / (2000 * mm_per_min), slowed.share());
  }
}

TEST(SingularDirection, IsSaidInOneSentence) {
  const Planned p(head_machine(), past_the_pole(0.01));
  ASSERT_EQ(p.tip.slowed.size(), 1U);
  const JointLayout& layout = p.machine.chain.layout;
  EXPECT_EQ(to_string(p.tip.slowed.front(), layout),
            "the programmed feed rate requires C at 1.553e+06 deg/s^3, 0.57 deg from a singular "
            "direction of the tool axis; its limit is 1.146e+05: the feed rate is reduced to about "
            "41.9 %");
  EXPECT_EQ(to_string({7, 4, 1369 * deg, 1200 * deg, 0.01}, layout),
            "the programmed feed rate requires C at 1369 deg/s, 0.57 deg from a singular direction "
            "of the tool axis; its limit is 1200: the feed rate is reduced to 87.7 %");
  EXPECT_EQ(to_string({7, 0, 2.0, 1.0, 0.3, 2, 1}, layout),
            "the programmed feed rate requires X at 2000 mm/s^2; its limit is 1000: the feed rate "
            "is reduced to about 70.7 %, and in one other block");
  EXPECT_EQ(to_string({7, 4, 1e6, 20.0, 0.0}, layout),
            "in a singular direction of the tool axis the TCP is at rest while C rotates");
}

// Half a turn of C in the time that the tip takes for 0.1 um is no matter of the tool axis.
TEST(TcpMotion, ATurnThatIsTooFastIsNoSingularDirection) {
  for (const std::string tilt : {"A30", "A0"}) {
    const Planned p(table_machine(), "G43.4 H1\nG0 " + tilt + "\nG1 X0.0001 C180 F1000\n");
    ASSERT_EQ(p.tip.slowed.size(), 1U);
    EXPECT_EQ(to_string(p.tip.slowed.front(), p.machine.chain.layout),
              "the TCP is at rest while C rotates");
  }
}

// Speeds suffice here, accelerations do not.
TEST(SingularDirection, AccelerationsAndJerksSlowTheMoveAsSaid) {
  for (auto [name, machine, tilt] : machines()) {
    machine.limits.j *= 1e3;
    const Planned p(machine, past_the_pole(0.015));
    const double w = 2 * std::atan(0.3) * 2000 * mm_per_min / (kTo - kFrom).norm() / 0.015;
    ASSERT_LT(w, machine.limits.v[4]);
    ASSERT_EQ(p.tip.slowed.size(), 1U);
    const FeedReduction& slowed = p.tip.slowed.front();
    EXPECT_EQ(slowed.order, 2);
    EXPECT_NEAR(slowed.needed / (0.65 * w * w), 1.0, 0.05) << name;
    double slowest = 1e9;
    p.sample_line(3, kStep, [&](const Sample& now, const ToolPose&) {
      const double f = (now.s - p.moves[1].s_begin) / (p.moves[1].s_end - p.moves[1].s_begin);
      if (f > 0.1 && f < 0.9) slowest = std::min(slowest, tip_velocity(p, now).norm());
    });
    expect_about(slowest / (2000 * mm_per_min), slowed.share());
    // and without a word where they suffice
    machine.limits.a *= 1e3;
    EXPECT_TRUE(Planned(machine, past_the_pole(0.015)).tip.slowed.empty());
  }
}

TEST(InverseTime, BlocksThatAskTooMuchOfAnAxisAreCounted) {
  const TipMachine machine = table_machine();  // C can do 1200 deg/s, X 667 mm/s
  const auto slowed = [&](const std::string& program) {
    return slowed_inverse_time(machine.read(program), machine.chain.layout, Joints::Zero(),
                               machine.limits, machine.options);
  };
  EXPECT_FALSE(slowed("G93\nG1 X10 C100 F719\nG1 X20 C200 F719"));
  EXPECT_FALSE(slowed("G94\nG1 X10 C100 F90000\n"));
  const auto one = slowed("G93\nG1 X10 C100 F600\nG1 X20 C200 F721\nG1 X20.1 C300 F900");
  ASSERT_TRUE(one);
  EXPECT_EQ(one->line, 4);
  EXPECT_EQ(one->others, 1U);
  EXPECT_EQ(to_string(*one, machine.chain.layout),
            "the programmed feed rate requires C at 1500 deg/s; its limit is 1200: the feed rate "
            "is reduced to 80 %, and in one other block");
  EXPECT_EQ(slowed("G93\nG1 X10 F6000\n")->joint, 0);
}

TEST(SingularDirection, ACrossingKeepsTheAxisThatNeedNotTurn) {
  for (const auto& [name, machine, tilt] : machines()) {
    // exactly, and by less than the tolerance of the tool axis
    for (const double distance : {0.0, 1e-6}) {
      const Planned p(machine, past_the_pole(distance));
      EXPECT_TRUE(p.tip.slowed.empty()) << name << " " << distance;
      double low = 1e9, high = -1e9;
      p.sample_line(3, kStep, [&](const Sample& now, const ToolPose& P) {
        low = std::min(low, now.Q_ref[4]);
        high = std::max(high, now.Q_ref[4]);
        EXPECT_LT(distance_to_line(P.p_WT, kFrom, kTo), kStraight) << name;
      });
      EXPECT_LT(high - low, 1e-4) << name << ": C stays";
    }
  }
}

TEST(SingularDirection, LeavingItTurnsTheFreeAxisFirstWithTheTipInPlace) {
  for (const auto& [name, machine, tilt] : machines()) {
    const Planned p(machine, "G43.5 H1\nG0 X-40 Y10 Z0 K1\nG1 X40 Y20 Z10 I0.3 J0.3 K1 F2000\n");
    const Vector3d k_1 = Vector3d(0.3, 0.3, 1).normalized();
    p.sample_line(3, kStep, [&](const Sample&, const ToolPose& P) {
      EXPECT_LT(distance_to_line(P.p_WT, kFrom, kTo), kStraight) << name;
      EXPECT_LT(std::abs(P.k_W.dot(Vector3d(1, -1, 0).normalized())),
                p.machine.options.rotary_tolerance)
          << name;
    });
    EXPECT_LT((machine.pose(p.trajectory.end()).k_W - k_1).norm(), 1e-12);
    ASSERT_EQ(p.tip.slowed.size(), 1U);
    EXPECT_EQ(p.tip.slowed.front().line, 3);
    expect_within_joint_limits(p);
  }
}

// Behind the singular direction the axis that tilts goes to one side or the other: the nearer one,
// or the one that the travel allows.
TEST(SingularDirection, IsLeftOnTheBranchThatArrives) {
  TipMachine table = table_machine(), head = head_machine(), nutating = table_machine();
  table.lower[3] = -10 * deg;
  head.upper[3] = 10 * deg;
  nutating.chain = plant::make_chain(plant::parse_structure("[w C' B' X b Y Z t]"));
  plant::incline(nutating.chain.at(Axis::B), {0, 1, 1});
  nutating.lower[3] = -10 * deg;
  nutating.upper[3] = 190 * deg;
  for (const TipMachine& machine : {table, head, nutating}) {
    for (int phi = -180; phi < 180; phi += 30) {
      const Vector3d k(0.5 * std::cos(phi * deg), 0.5 * std::sin(phi * deg), std::sqrt(0.75));
      const Planned p(machine, fmt::format("G43.5 H1\nG1 X10 I{:.9f} J{:.9f} K{:.9f} F1000\n", k[0],
                                           k[1], k[2]));
      const Joints Q = p.trajectory.end();
      EXPECT_LT((machine.pose(Q).k_W - k).norm(), 1e-9) << phi << ", as printed";
      EXPECT_TRUE(machine.control()->inverse().is_within_travel(Q)) << phi << ": " << Q.transpose();
      p.sample_line(2, kStep, [&](const Sample&, const ToolPose& P) {
        const Vector3d across = Vector3d::UnitZ().cross(k).normalized();
        EXPECT_LT(std::abs(P.k_W.dot(across)), p.machine.options.rotary_tolerance) << phi;
      });
    }
  }
}

TEST(SingularDirection, IsLeftOnTheNearerBranchWhereBothArrive) {
  const Planned p(table_machine(), "G43.5 H1\nG1 X10 I0 J-0.5 K0.866 F1000\n");
  EXPECT_NEAR(std::abs(p.trajectory.end()[4]), 0.0, 1e-12);
  TipMachine one_sided = table_machine();
  (p.trajectory.end()[3] > 0.0 ? one_sided.upper : one_sided.lower)[3] = 0.0;
  const Planned other(one_sided, "G43.5 H1\nG1 X10 I0 J-0.5 K0.866 F1000\n");
  EXPECT_NEAR(std::abs(other.trajectory.end()[4]), 180 * deg, 1e-12);
}

// C at the end of its travel: it goes a turn back before the tool axis leaves the vertical.
TEST(SingularDirection, IsLeftAFullTurnAwayWhereTheTravelEnds) {
  TipMachine machine = table_machine();
  machine.lower[3] = 0.0;
  machine.lower[4] = -360 * deg;
  machine.upper[4] = 360 * deg;
  for (int phi = 0; phi < 360; phi += 15) {
    const Planned p(machine,
                    fmt::format("G0 C340\nG43.5 H1\nG1 X0 K1 F1000\nX10 I{:.9f} J{:.9f} K2\n",
                                std::cos(phi * deg), std::sin(phi * deg)));
    EXPECT_TRUE(machine.control()->inverse().is_within_travel(p.trajectory.end())) << phi;
  }
}

}  // namespace
}  // namespace servomill::controllers::test::singular_direction_test
