#include "plant/vocabulary/progress.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace servomill::progress_test {
namespace {

TEST(Stage, IsSeenWhileItLives) {
  const ProgressWatch watch;
  {
    Stage stage("points", 40.0, Steps::unlike);
    stage.reach(12.0);
    stage.advance();
    const std::vector<StageState> seen = watch.stages();
    ASSERT_EQ(seen.size(), 1U);
    EXPECT_EQ(seen[0].counted, "points");
    EXPECT_EQ(seen[0].done, 13.0);
    EXPECT_EQ(seen[0].total, 40.0);
    EXPECT_EQ(seen[0].steps, Steps::unlike);
    EXPECT_GE(seen[0].seconds, 0.0);
  }
  EXPECT_TRUE(watch.stages().empty());
}

TEST(Stage, IsNeverBeyondItsEnd) {
  const ProgressWatch watch;
  Stage stage("points", 2.0);
  stage.reach(3.0);  // an estimate of points in work
  EXPECT_EQ(watch.stages()[0].done, 2.0);
}

TEST(Stage, OfAnUnknownNumberOfStepsCountsOn) {
  const ProgressWatch watch;
  Stage stage("iterations", 0.0);
  stage.reach(3.0);
  EXPECT_EQ(watch.stages()[0].done, 3.0);
  EXPECT_EQ(share_done(watch.stages()), 0.0);
}

TEST(Stage, IsAdvancedByAnyThread) {
  const ProgressWatch watch;
  Stage stage("points", 2000.0);
  {
    const auto count = [&] {
      for (int n = 0; n < 1000; ++n) stage.advance();
    };
    const std::jthread one(count), other(count);
  }
  EXPECT_EQ(watch.stages()[0].done, 2000.0);
}

TEST(Stage, FollowsTheShareOfSomebodyElse) {
  const ProgressWatch watch;
  std::atomic<float> share = 0.25F;
  const Stage stage(share);
  EXPECT_EQ(share_done(watch.stages()), 0.25);
  share = 0.75F;
  EXPECT_EQ(share_done(watch.stages()), 0.75);
}

// Threads that share the work of a stage would show theirs one over the other.
TEST(Stage, OfAnotherThreadIsSeenByNobody) {
  const ProgressWatch watch;
  std::jthread([] { const Stage stage("points", 2.0); }).join();
  std::jthread([&] {
    const Stage stage("points", 2.0);
    EXPECT_TRUE(watch.stages().empty());
  }).join();
}

TEST(Stage, WithoutAWatchHasNoEffect) {
  Stage stage("points", 2.0);
  stage.advance();
  EXPECT_EQ(stage.state().done, 1.0);
}

TEST(ShareDone, CountsWhatIsDoneOfAStep) {
  const ProgressWatch watch;
  EXPECT_EQ(share_done(watch.stages()), 0.0);
  Stage runs("runs", 4.0);
  runs.reach(1.0);
  EXPECT_EQ(share_done(watch.stages()), 0.25);
  Stage rows("rows", 10.0);
  rows.reach(5.0);
  EXPECT_DOUBLE_EQ(share_done(watch.stages()), 1.5 / 4.0);
}

TEST(ProgressWatch, TakesTheThreadFromTheOneBefore) {
  const ProgressWatch outer;
  {
    const ProgressWatch inner;
    const Stage stage("points", 2.0);
    EXPECT_TRUE(outer.stages().empty());
    EXPECT_EQ(inner.stages().size(), 1U);
  }
  const Stage stage("points", 2.0);
  EXPECT_EQ(outer.stages().size(), 1U);
}

TEST(ProgressWatch, SeesNothingOnceForgotten) {
  const ProgressWatch watch;
  ProgressWatch::forget();
  const Stage stage("points", 2.0);
  EXPECT_TRUE(watch.stages().empty());
}

}  // namespace
}  // namespace servomill::progress_test
