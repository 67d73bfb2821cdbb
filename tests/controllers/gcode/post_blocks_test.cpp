#include "controllers/gcode/post_blocks.h"

#include "tests/controllers/gcode/cutter_locations.h"

namespace servomill::controllers::post_blocks_test {
namespace {

TEST(PostBlocks, EveryBlockTakesTheTimeThatTheTipNeeds) {
  constexpr double kRelative = 1e-9;  // F has 12 digits, coordinates 7 decimals of mm
  PostOptions options = usual_options();
  options.feed = 0.02;
  const auto inverse = machine(kTableTable);
  const ClData data = wandering(2);
  const PostProcessed made = post(data, "p.cls", inverse, options);
  const auto moves = read_again(made, options);
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

TEST(PostBlocks, StandingTipTurnsWithTheRateOfTheToolAxis) {
  PostOptions options = usual_options();
  options.rotary_rate = 0.5;
  const auto inverse = machine(kTableTable);
  const ClData data = cl("GOTO/10,0,0,0.6,0,0.8\nGOTO/10,0,0,0.8,0,0.6\n");
  const auto moves = read_again(post(data, "p.cls", inverse, options), options);
  double time = 0.0;
  for (std::size_t i = 1; i < moves.size(); ++i) {
    time += (moves[i].end_machine - moves[i - 1].end_machine).head<3>().norm() / moves[i].feed;
  }
  const double angle = std::atan2(0.8, 0.6) - std::atan2(0.6, 0.8);
  EXPECT_NEAR(time, angle / options.rotary_rate, 1e-6);
}

TEST(PostBlocks, TipWordsAreTheLocations) {
  PostOptions options = usual_options();
  options.mode = PostMode::tip;
  options.tolerance.axis = 1.0;
  const ClData data = wandering(4);
  const PostProcessed made = post(data, "p.cls", machine(kTableTable), options);
  ASSERT_EQ(made.moves.size(), data.records.size() + 1);
  for (std::size_t n = 0; n < data.records.size(); ++n) {
    EXPECT_LT((made.moves[n + 1].end.head<3>() - data.records[n].P.p_WT).norm(), 1e-15);
  }
  EXPECT_DOUBLE_EQ(made.moves.back().feed, options.feed);
  EXPECT_EQ(made.moves.back().feed_mode, FeedMode::units_per_minute);
}

TEST(PostBlocks, StopsOnlyTheFunctionsThatRun) {
  const auto inverse = machine(kTableTable);
  const PostOptions options = usual_options();
  const std::string file = "p.cls";
  PostReport report(file, inverse.chain().layout);
  PostBlocks blocks(inverse, options, 0.0, report);
  ClRecord coolant;
  coolant.kind = MoveKind::coolant;
  coolant.number = 8;
  blocks.function(coolant);
  EXPECT_EQ(blocks.coolant(), 8);
  blocks.stop_functions(0.0);
  blocks.stop_functions(0.0);
  const std::vector<Move> moves = blocks.take();
  ASSERT_EQ(moves.size(), 2u);
  EXPECT_EQ(moves[1].kind, MoveKind::coolant);
  EXPECT_EQ(moves[1].number, 0);
}

}  // namespace
}  // namespace servomill::controllers::post_blocks_test
