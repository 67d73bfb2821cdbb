// harmonic, parabolic and exact, as rewriters of programs.
#include <gtest/gtest.h>

#include "strategies/linearisation.h"
#include "tests/strategies/identified_machines.h"

namespace servomill::strategies::linearisation_test {
namespace {

constexpr double kRounding = 1e-12;  // m, rad; some products at 1 m

// A line on which both rotary axes turn, 20 deg away from the vertical and more.
struct Line {
  IdentifiedMachine identified = identified_with({});
  Joints Q_0 = identified.reference, Q_1 = identified.reference;
  Move move;

  explicit Line(double h = 1.0) {
    identified.lower.head<3>().setConstant(-0.5);
    identified.upper.head<3>().setConstant(0.5);
    Q_1 += h * (Joints() << 4.0 * mm, -3.0 * mm, 2.0 * mm, 2.0 * deg, 3.0 * deg).finished();
    move.line = 7;
    move.end_machine = identified.layout.words(Q_1);
    move.end = move.end_machine - identified.layout.words(Joints::Constant(1e-3));
    move.s_begin = 0.1;
    move.s_end = 0.1 + (Q_1 - Q_0).head<3>().norm();
    move.feed = 0.02;
    move.feed_mode = FeedMode::inverse_time;
  }

  ToolPose pose(const Joints& Q) const {
    return plant::forward(identified.model.chain(), Q, identified.p_ST);
  }

  // Largest distance of the tip from the chord at equal t, over all blocks (m).
  double bend(const std::vector<Move>& blocks) const {
    const plant::StraightToolPath path(pose(Q_0), pose(Q_1));
    double worst = 0.0, t = 0.0;
    Joints Q = Q_0;
    for (const Move& block : blocks) {
      const Joints next = identified.layout.joints(block.end_machine);
      const double t_end = (block.s_end - move.s_begin) / (move.s_end - move.s_begin);
      for (double f = 0.0; f <= 1.0; f += 0.05) {
        const Eigen::Vector3d tip = pose(Q + f * (next - Q)).p_WT;
        worst = std::max(worst, (tip - path.at(t + f * (t_end - t)).p_WT).norm());
      }
      t = t_end;
      Q = next;
    }
    return worst;
  }
};

std::vector<Move> rewritten(const Line& line, const char* strategy, const char* key = "",
                            double value = 0.0, const char* definition = "",
                            const char* amplitude = "machine") {
  const Entry& entry = *find(strategy);
  Parameters parameters = default_parameters(entry);
  if (*key != '\0') parameters.set(key, value);
  if (*definition != '\0') parameters.set("definition", std::string_view(definition));
  if (std::string_view(strategy) != "exact") {
    parameters.set("amplitude", std::string_view(amplitude));
  }
  return rewritten_moves(*entry.make(parameters, Action::compensate, line.identified), {line.move});
}

TEST(Linearisation, HarmonicLeavesASeventeenthParabolicMuchLess) {
  const Line line(0.3);  // the longer, the less is it a parabola
  const double bend = line.bend({line.move});
  EXPECT_GT(bend, 4.0 * um);
  const double harmonic = line.bend(rewritten(line, "harmonic")) / bend;
  const double parabolic = line.bend(rewritten(line, "parabolic")) / bend;
  EXPECT_NEAR(harmonic, 0.056, 0.001);  // sin(pi t) against 4 t (1 - t)
  EXPECT_LT(parabolic, 0.003);
}

// Deviation of a block's linear axes from the line, over 4 t (1 - t): the amplitude at its end.
Eigen::Vector3d amplitude_at(const Line& line, const Move& block) {
  const double t = (block.s_end - line.move.s_begin) / (line.move.s_end - line.move.s_begin);
  const Joints Q = line.identified.layout.joints(block.end_machine);
  const Joints straight = line.Q_0 + t * (line.Q_1 - line.Q_0);
  return (straight - Q).head<3>() / (4.0 * t * (1.0 - t));
}

TEST(Linearisation, AmplitudeOfTheMachineIsTheSameForAllPointsOfALine) {
  const Line line;
  const auto change = [&](const char* amplitude) {
    const auto blocks = rewritten(line, "parabolic", "spacing_mm", 0.1 * mm, "", amplitude);
    const Eigen::Vector3d first = amplitude_at(line, blocks.front());
    const Eigen::Vector3d last = amplitude_at(line, blocks[blocks.size() - 2]);
    return (last - first).norm() / first.norm();
  };
  EXPECT_LT(change("machine"), 1e-6);
  EXPECT_GT(change("workpiece"), 0.05);  // turned with the tables, by 5 deg
}

TEST(Linearisation, WhichFrameLeavesLessDependsOnTheLine) {
  const Line line;  // as large tilts go; of the paper's locations the machine leaves half as much
  const double bend = line.bend({line.move});
  const auto left = [&](const char* amplitude) {
    return line.bend(rewritten(line, "parabolic", "spacing_mm", 0.01 * mm, "", amplitude)) / bend;
  };
  EXPECT_NEAR(left("machine"), 0.0076, 0.0002);
  EXPECT_NEAR(left("workpiece"), 0.0055, 0.0002);
}

TEST(Linearisation, RefusesAnAmplitudeOfTheWorkpieceForPostedLocations) {
  try {
    rewritten(Line(), "harmonic", "", 0.0, "post_processed_location", "workpiece");
    FAIL() << "was not refused";
  } catch (const InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "<input>: error: amplitude = \"workpiece\" needs definition = \"joint_interpolation\": "
        "post-processed locations are compared in the machine");
  }
}

TEST(Linearisation, ExactKeepsItsTolerance) {
  const Line line;
  for (const double tolerance : {10.0 * um, 1.0 * um, 0.1 * um}) {
    const double bend = line.bend(rewritten(line, "exact", "tolerance_um", tolerance));
    EXPECT_LT(bend, 1.01 * tolerance);  // looked at in three places between two points
    EXPECT_GT(bend, 0.1 * tolerance);
  }
}

TEST(Linearisation, PostedLocationAsPublishedLeavesTheTipWhereItWas) {
  const Line line;
  const auto blocks = rewritten(line, "harmonic", "", 0.0, "post_processed_location");
  EXPECT_GT(blocks.size(), 30u);
  EXPECT_GT(line.bend(blocks) / line.bend({line.move}), 0.9);
}

TEST(Linearisation, ToleranceOnBothSidesOfTheErrorOfTheModel) {
  const Line line;
  const plant::InverseKinematics inverse = nominal_inverse(line.identified);
  const plant::PostProcessedSegment segment(inverse, line.identified.p_ST, line.Q_0, line.Q_1);
  const double a = segment.error(plant::NonlinearError::joint_interpolation, 0.5)->norm();
  for (const char* strategy : {"harmonic", "parabolic"}) {
    EXPECT_EQ(rewritten(line, strategy, "tolerance_um", 1.0001 * a).size(), 1u);
    EXPECT_GT(rewritten(line, strategy, "tolerance_um", 0.9999 * a).size(), 30u);
  }
}

TEST(Linearisation, BlocksShareLineLengthAndTimeOfTheMove) {
  const Line line;
  for (const char* strategy : {"exact", "harmonic", "parabolic"}) {
    const auto blocks = rewritten(line, strategy);
    ASSERT_GT(blocks.size(), 10u);
    double s = line.move.s_begin;
    for (const Move& block : blocks) {
      EXPECT_EQ(block.line, line.move.line);
      EXPECT_EQ(block.s_begin, s);
      EXPECT_GT(block.s_end, s);
      EXPECT_EQ(block.feed, line.move.feed);
      EXPECT_LT((block.end_machine - block.end - (line.move.end_machine - line.move.end)).norm(),
                kRounding);
      s = block.s_end;
    }
    EXPECT_EQ(s, line.move.s_end);
    EXPECT_EQ(blocks.back().end_machine, line.move.end_machine);
    EXPECT_EQ(blocks.back().end, line.move.end);
  }
}

TEST(Linearisation, MovesOfLinearOrOfRotaryAxesAloneAndRapidsStay) {
  for (const char* strategy : {"exact", "harmonic", "parabolic"}) {
    Line linear;
    linear.move.end_machine.tail<3>() = linear.identified.layout.words(linear.Q_0).tail<3>();
    Line rotary;
    rotary.move.end_machine.head<3>() = rotary.Q_0.head<3>();
    Line rapid;
    rapid.move.kind = MoveKind::rapid;
    for (const Line& line : {linear, rotary, rapid}) {
      const auto blocks = rewritten(line, strategy);
      ASSERT_EQ(blocks.size(), 1u) << strategy;
      EXPECT_EQ(blocks[0].end_machine, line.move.end_machine);
    }
  }
}

std::string fault_of(const Line& line, const char* strategy) {
  try {
    rewritten(line, strategy);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Linearisation, RefusesArcsOnWhichRotaryAxesTurn) {
  Line line;
  line.move.kind = MoveKind::arc;
  EXPECT_EQ(
      fault_of(line, "exact"),
      "<input>:7: error: an arc with rotary axis motion cannot be linearised; write it as lines");
}

TEST(Linearisation, RefusesLinesWithoutAStraightWay) {
  Line line;  // one turn of the table more than the way needs
  line.Q_1[4] += 360.0 * deg;
  line.move.end_machine = line.identified.layout.words(line.Q_1);
  EXPECT_EQ(fault_of(line, "exact"),
            "<input>:7: error: the TCP cannot follow a straight line between these axis positions; "
            "it stops after 100.0 %");
}

}  // namespace
}  // namespace servomill::strategies::linearisation_test
