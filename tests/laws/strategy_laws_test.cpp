/// Laws of every strategy in the registry. A new one is held to them by being in the list.
#include <gtest/gtest.h>

#include "plant/vocabulary/move_curve.h"
#include "tests/strategies/identified_machines.h"

namespace servomill::strategies::strategy_laws_test {
namespace {

// A displacement of 10 um is a difference of coordinates of 0.3 m, twice rounded.
constexpr double kRounding = 1e-15;  // m

const char* name_of(Action action) { return action == Action::impose ? "impose" : "compensate"; }

// The points of a table over one axis with the default spacing, away from the ends.
Joints with_one_axis_moved(const IdentifiedMachine& identified, int joint, double step) {
  Joints Q = identified.reference;
  Q[joint] += step * 1.6384 * mm;
  return Q;
}

Joints random_position(const IdentifiedMachine& identified, plant::Uniform& random) {
  Joints Q = identified.reference;
  for (int j = 0; j < kLinearJoints; ++j) Q[j] = 0.15 * random();
  return Q;
}

// The identified errors of the random models are up to about 3 x size, their slopes 8 x size per m.
constexpr double kErrorSize = 10e-6;  // m, rad

IdentifiedMachine randomly_identified(double size = kErrorSize) {
  plant::Uniform random(11);
  return identified_with(plant::random_errors(random, size));
}

Move line_to(const IdentifiedMachine& identified, const Joints& Q, int line, double s_begin,
             double s_end) {
  Move move;
  move.line = line;
  move.end = move.end_machine = identified.layout.words(Q);
  move.s_begin = s_begin;
  move.s_end = s_end;
  move.feed = 0.02;
  return move;
}

// A rapid, a line, an arc in XY and something that is no motion.
std::vector<Move> some_program(const IdentifiedMachine& identified) {
  Joints Q = identified.reference;
  std::vector<Move> moves;
  Q[0] += 5.0 * mm;
  moves.push_back(line_to(identified, Q, 1, 0.0, 5.0 * mm));
  moves.back().kind = MoveKind::rapid;
  Q[1] += 7.3 * mm;
  moves.push_back(line_to(identified, Q, 2, 5.0 * mm, 12.3 * mm));
  Move dwell;
  dwell.kind = MoveKind::dwell;
  dwell.line = 3;
  dwell.value = 0.5;
  moves.push_back(dwell);
  Move arc = line_to(identified, Q, 4, 12.3 * mm, 12.3 * mm + 5.0 * mm * std::numbers::pi);
  arc.kind = MoveKind::arc;
  arc.arc.centre = arc.centre_machine =
      moves[1].end_machine.head<3>() + Eigen::Vector3d(5e-3, 0, 0);
  arc.end[0] += 10.0 * mm;
  arc.end_machine[0] += 10.0 * mm;
  arc.arc.turns = -1;
  moves.push_back(arc);
  return moves;
}

TEST(EveryStrategy, IsListedInOrderOfItsName) {
  ASSERT_FALSE(entries().empty());
  for (std::size_t i = 1; i < entries().size(); ++i) {
    EXPECT_LT(entries()[i - 1].name, entries()[i].name);
  }
  for (const Entry& entry : entries()) {
    EXPECT_EQ(find(entry.name), &entry);
    EXPECT_FALSE(entry.summary.empty());
  }
  EXPECT_EQ(find("Table"), nullptr);
  EXPECT_EQ(names().size(), entries().size());
}

// Help and reader use the declaration: a default must keep its own rules.
TEST(EveryStrategy, HasDefaultsThatKeepItsOwnRules) {
  for (const Entry& entry : entries()) {
    for (const ParameterSpec& spec : entry.parameters) {
      const std::string where = std::string(entry.name) + "." + std::string(spec.name);
      EXPECT_FALSE(spec.help.empty()) << where;
      EXPECT_TRUE(sim::config::parse_unit(spec.unit).unit || spec.unit.empty()) << where;
      if (std::find(spec.words.begin(), spec.words.end(), spec.default_text) != spec.words.end()) {
        continue;
      }
      ASSERT_TRUE(spec.is_number) << where;
      const double value = std::stod(std::string(spec.default_text));
      EXPECT_GE(value, spec.min) << where;
      EXPECT_LE(value, spec.max) << where;
    }
  }
}

// Hardware and delay follow the entry, the action follows the strategy.
TEST(EveryStrategy, ThatDisplacesTheFeedbackUsesItsHardware) {
  const IdentifiedMachine identified = randomly_identified();
  for (const Entry& entry : entries()) {
    for (const Action action : kBothActions) {
      const Acting acting = make_acting(entry, action, identified);
      EXPECT_EQ(acting.strategy->displaces_feedback(), entry.uses_feedback_hardware) << entry.name;
      EXPECT_EQ(acting.feedback != nullptr, entry.uses_feedback_hardware) << entry.name;
    }
  }
}

// Law 1: an identified model without errors changes nothing, bit for bit.
TEST(EveryStrategy, LeavesPositionsAloneWithoutErrors) {
  const IdentifiedMachine identified = identified_with({});
  plant::Uniform random(1);
  for (const Entry& entry : entries()) {
    for (const Action action : kBothActions) {
      for (const int way : {0, 1, 2, 3}) {
        const Acting acting = make_acting(entry, action, identified, way % 2 == 1, way >= 2);
        for (int n = 0; n < 100; ++n) {
          const Joints Q = random_position(identified, random);
          EXPECT_EQ(acting.displacement(identified.layout, Q), Joints::Zero()) << entry.name;
          if (!acting.feedback) continue;
          EXPECT_EQ(acting.feedback->advance(Q), Joints::Zero()) << entry.name;
        }
      }
    }
  }
}

// Who says that it knows no errors does the same with and without them.
TEST(EveryStrategy, ThatReadsNoErrorsDisplacesNothing) {
  const IdentifiedMachine identified = randomly_identified();
  plant::Uniform random(2);
  for (const Entry& entry : entries()) {
    if (entry.reads_errors) continue;
    const Acting acting = make_acting(entry, Action::compensate, identified);
    for (int n = 0; n < 20; ++n) {
      const Joints Q = random_position(identified, random);
      EXPECT_EQ(acting.displacement(identified.layout, Q), Joints::Zero()) << entry.name;
    }
  }
}

TEST(EveryStrategy, KeepsEveryProgrammedPointWithoutErrors) {
  const IdentifiedMachine identified = identified_with({});
  const std::vector<Move> moves = some_program(identified);
  for (const Entry& entry : entries()) {
    for (const int way : {0, 1, 2, 3}) {
      const Acting acting = make_acting(entry, way % 2 == 1 ? Action::impose : Action::compensate,
                                        identified, false, way >= 2);
      const std::vector<Move> rewritten = rewritten_moves(*acting.strategy, moves);
      auto next = rewritten.begin();
      AxisWords from = identified.layout.words(identified.reference);
      for (const Move& move : moves) {
        if (!is_motion(move.kind)) {
          ASSERT_NE(next, rewritten.end());
          EXPECT_EQ(next->kind, move.kind) << entry.name;
          EXPECT_EQ(next->value, move.value) << entry.name;
          ++next;
          continue;
        }
        const MoveCurve curve(from, move);
        double s = move.s_begin;
        for (; next != rewritten.end() && next->line == move.line; ++next) {
          EXPECT_EQ(next->s_begin, s) << entry.name << " line " << move.line;
          EXPECT_EQ(next->feed, move.feed) << entry.name;
          s = next->s_end;
          const double t = (s - move.s_begin) / (move.s_end - move.s_begin);
          const double off = (next->end_machine - curve.at(t)).cwiseAbs().maxCoeff();
          // t is a quotient of lengths of 10 mm that are stored with 0.02 m before them
          constexpr double kPlace = 1e-17;  // m
          EXPECT_LE(off, kPlace) << entry.name << " line " << move.line << " t " << t;
        }
        EXPECT_EQ(s, move.s_end) << entry.name << " line " << move.line;
        const Move& last = *std::prev(next);
        EXPECT_EQ(last.end_machine, curve.at(1.0)) << entry.name << " line " << move.line;
        from = move.end_machine;
      }
      EXPECT_EQ(next, rewritten.end()) << entry.name;
    }
  }
}

// Law 2: to impose is to displace the axes by the identified error, to compensate by its negative,
// to first order. The points are those where a table interpolates nothing.
TEST(EveryStrategy, DisplacesByTheIdentifiedErrorTimesItsSign) {
  const IdentifiedMachine identified = randomly_identified();
  constexpr double kSlope = 8.0 * kErrorSize, kSize = 10.0 * kErrorSize;  // 1/m, m with levers
  constexpr double kSecondOrder = 3.0 * kSlope * kSize;                   // m: |E'||E|, three axes
  for (const Entry& entry : entries()) {
    for (const Action action : kBothActions) {
      const Acting acting = make_acting(entry, action, identified, true);
      if (!entry.reads_errors || entry.runs_program) continue;
      ASSERT_TRUE(acting.acts()) << entry.name;
      for (int joint = 0; joint < kLinearJoints; ++joint) {
        for (const double step : {-50.0, 0.0, 80.0}) {
          const Joints Q = with_one_axis_moved(identified, joint, step);
          const Eigen::Vector3d error = identified.model.joint_offset(Q, identified.p_ST);
          ASSERT_GT(error.norm(), 100.0 * kSecondOrder);
          const Eigen::Vector3d wanted = (action == Action::impose ? 1.0 : -1.0) * error;
          const double off = (acting.displacement(identified.layout, Q).head<3>() - wanted).norm();
          EXPECT_LE(off, kSecondOrder) << entry.name << " " << name_of(action) << " " << joint;
        }
      }
    }
  }
}

// Law 3: what correcting leaves of generating shrinks with the square of the errors.
TEST(EveryStrategy, CorrectsWhatItGeneratesToFirstOrder) {
  plant::Uniform random(3);
  const IdentifiedMachine large = randomly_identified(kErrorSize),
                          small = randomly_identified(0.5 * kErrorSize);
  for (const Entry& entry : entries()) {
    bool all_axes = false;
    const auto left = [&](const IdentifiedMachine& identified, const Joints& Q) -> Joints {
      const auto by = [&](Action action) {
        return make_acting(entry, action, identified, true, all_axes)
            .displacement(identified.layout, Q);
      };
      return by(Action::impose) + by(Action::compensate);
    };
    for (int n = 0; n < 40; ++n) {
      all_axes = n >= 20;
      const Joints Q = random_position(large, random);
      const double at_full = left(large, Q).norm(), at_half = left(small, Q).norm();
      if (at_full == 0.0) {
        EXPECT_TRUE(!entry.reads_errors || entry.runs_program) << entry.name;
        continue;
      }
      // third order: 1e-4 of the ratio; rounding: 1e-15 m of some nm
      constexpr double kRatioTol = 0.01;
      EXPECT_NEAR(at_full / at_half, 4.0, kRatioTol) << entry.name << ": " << at_full << " m";
    }
  }
}

// Law 4: with one iteration, correcting is the negative of generating at the same argument.
TEST(EveryStrategy, CorrectsInOneStepByTheNegative) {
  const IdentifiedMachine identified = randomly_identified();
  plant::Uniform random(5);
  for (const Entry& entry : entries()) {
    for (const bool all_axes : {false, true}) {
      const Acting generate = make_acting(entry, Action::impose, identified, false, all_axes);
      const Acting correct = make_acting(entry, Action::compensate, identified, false, all_axes);
      for (int n = 0; n < 20; ++n) {
        const Joints Q = random_position(identified, random);
        const Joints sum = generate.displacement(identified.layout, Q) +
                           correct.displacement(identified.layout, Q);
        EXPECT_LE(sum.cwiseAbs().maxCoeff(), kRounding) << entry.name;
      }
    }
  }
}

// Law 5: no hidden state, neither between two strategies nor between two runs of one.
TEST(EveryStrategy, DoesTheSameInEveryRun) {
  const IdentifiedMachine identified = randomly_identified();
  const std::vector<Move> moves = some_program(identified);
  for (const Entry& entry : entries()) {
    const Acting first = make_acting(entry, Action::impose, identified);
    const auto played = [&](SetpointPart* setpoint, FeedbackPart* feedback) {
      plant::Uniform random(7);
      Joints Q = identified.reference;
      std::vector<double> out;
      if (feedback) feedback->settle(Q);
      for (int n = 0; n < 200; ++n) {
        for (int j = 0; j < kLinearJoints; ++j) Q[j] += 1e-6 * random();
        for (int i = 0; i < kJoints; ++i) {
          if (setpoint) out.push_back(setpoint->offset(Q)[i]);
        }
        if (!feedback) continue;
        const Joints d = feedback->advance(Q);
        out.insert(out.end(), d.begin(), d.end());
      }
      return out;
    };
    const auto reference = played(first.setpoint.get(), first.feedback.get());
    EXPECT_EQ(reference.empty(), !(first.setpoint || first.feedback));
    const Acting second = make_acting(entry, Action::impose, identified);
    EXPECT_EQ(played(second.setpoint.get(), second.feedback.get()), reference) << entry.name;
    const auto setpoint = first.strategy->setpoint();
    const auto feedback = first.strategy->feedback(kModelPeriod);
    EXPECT_EQ(played(setpoint.get(), feedback.get()), reference) << entry.name << ", a second run";

    const auto once = rewritten_moves(*first.strategy, moves);
    const auto twice = rewritten_moves(*second.strategy, moves);
    ASSERT_EQ(once.size(), twice.size());
    for (std::size_t i = 0; i < once.size(); ++i) {
      EXPECT_EQ(once[i].end_machine, twice[i].end_machine) << entry.name;
    }
  }
}

// A strategy that has the program run knows nothing before.
TEST(EveryStrategyThatLearns, DisplacesNothingBeforeItHasLearnt) {
  const IdentifiedMachine identified = randomly_identified();
  int tried = 0;
  for (const Entry& entry : entries()) {
    const Acting acting = make_acting(entry, Action::compensate, identified);
    EXPECT_EQ(acting.strategy->learning() != nullptr, entry.runs_program) << entry.name;
    if (!entry.runs_program) continue;
    ++tried;
    EXPECT_FALSE(acting.acts()) << entry.name;
  }
  EXPECT_GE(tried, 2);
}

// Law 6: a strategy that displaces all axes, with perfect identification and axes that stand where
// they are sent, leaves neither tip nor tool axis anything, whatever the machine.
TEST(EveryStrategyOfAllAxes, LeavesNothingOfTipAndToolAxis) {
  constexpr double kPoseTol = 2e-12;  // m, rad: ten times that of the iteration and its slopes
  plant::Uniform random(13);
  int tried = 0;
  for (const char* structure : {"[w C' B' X b Y Z t]", "[w B' A' X b Y Z t]", "[w C' b X Y Z A t]",
                                "[w X b Y Z C B t]", "[w X Y b Z B A t]"}) {
    const IdentifiedMachine identified =
        identified_with(plant::random_errors(random, kErrorSize), structure);
    const plant::MachineChain& chain = identified.model.chain();
    for (const Entry& entry : entries()) {
      if (!default_parameters(entry).is_word("axes") || entry.runs_program) continue;
      const Acting acting = make_acting(entry, Action::compensate, identified, true, true);
      EXPECT_TRUE(acting.strategy->displaces_rotary()) << entry.name;
      ++tried;
      for (int n = 0; n < 20; ++n) {
        const Joints Q = random_position(identified, random);
        const Joints d = acting.displacement(identified.layout, Q);
        // a reading is taken where the axes are, a program says where they are to be
        const Joints Q_true = acting.feedback ? Q : Joints(Q + d);
        const Joints Q_prog = acting.feedback ? Joints(Q - d) : Q;
        const ToolPose got = identified.model.forward(Q_true, identified.p_ST);
        const ToolPose wanted = plant::forward(chain, Q_prog, identified.p_ST);
        EXPECT_LT((got.p_WT - wanted.p_WT).norm(), kPoseTol) << structure << entry.name;
        EXPECT_LT((got.k_W - wanted.k_W).norm(), kPoseTol) << structure << entry.name;
        EXPECT_GT(d.tail<2>().norm(), 1e-7) << "there is something to correct";
      }
    }
  }
  EXPECT_GE(tried, 10);
}

}  // namespace
}  // namespace servomill::strategies::strategy_laws_test
