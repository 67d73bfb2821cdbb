/// The result of a lane depends on its own numbers only: not on its place, its neighbours, how many
/// they are, or whether they are active.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "plant/drives/drive_bank.h"
#include "tests/plant/drives/random_drive.h"

namespace servomill::plant::drive_lanes_test {
namespace {

constexpr double kTick = 10e-6;
constexpr Tick kSteps[] = {2, 4, 6};
const std::vector<Stretch> kStretches = {{10, {6}}, {12, {2, 6, 10}}};
constexpr int kCalls = 600;

// A drive with the commands and rests that it is given, call after call.
struct Story {
  FeedDriveParams drive;
  std::vector<double> command, F;
  std::vector<bool> active;
};

Story random_story(unsigned seed) {
  Dice dice(seed);
  Story story{random_drive(dice), {}, {}, {}};
  const FeedDriveParams& p = story.drive;
  const double force = 1.3 * p.friction.Fc_positive + std::abs(p.F_load);
  const double strength = force * p.r / p.Kt * (p.has_winding() ? p.R : 1.0);
  double command = 0.0, F = 0.0;
  for (int n = 0; n < kCalls; ++n) {
    if (n % 30 == 0) command = strength * dice.between(-2.0, 2.0);
    if (n % 70 == 0) F = p.friction.Fc_positive * dice.between(-1.0, 1.0);
    story.command.push_back(command);
    story.F.push_back(F);
    story.active.push_back(!dice.one_in(9));
  }
  return story;
}

std::vector<Story> random_stories(unsigned first, unsigned count) {
  std::vector<Story> stories;
  for (unsigned n = 0; n < count; ++n) stories.push_back(random_story(first + n));
  return stories;
}

// Final state of a lane, and its states on the way.
struct Recorded : LaneState {
  std::vector<double> at_stops;  // m
};

// All stories in one bank.
std::vector<Recorded> recorded_together(const std::vector<Story>& stories,
                                        SimdLevel level = simd_level()) {
  std::vector<FeedDriveParams> drives;
  for (const Story& s : stories) drives.push_back(s.drive);
  const DriveBank bank(drives, kTick, kSteps, nullptr, level, kStretches);
  std::vector<Recorded> lanes(drives.size());
  std::vector<LaneArray> positions(3 * blocks_of(drives.size()));
  DriveState state = bank.at_rest(std::vector<double>(drives.size(), 0.1));
  DriveInput input(drives.size());
  for (int n = 0; n < kCalls; ++n) {
    for (std::size_t l = 0; l < stories.size(); ++l) {
      DriveInputBlock& in = input.blocks[l / kLaneWidth];
      in.command[l % kLaneWidth] = stories[l].command[static_cast<std::size_t>(n)];
      in.F[l % kLaneWidth] = stories[l].F[static_cast<std::size_t>(n)];
      in.active[l % kLaneWidth] = stories[l].active[static_cast<std::size_t>(n)];
    }
    if (n % 5 < 3) {
      bank.advance(state, input, kSteps[n % 5]);
      continue;
    }
    const auto stretch = static_cast<std::size_t>(n % 5 - 3);
    bank.advance_with_stops(state, input, stretch, positions);
    for (std::size_t stop = 0; stop < kStretches[stretch].stops.size(); ++stop) {
      for (std::size_t l = 0; l < stories.size(); ++l) {
        lanes[l].at_stops.push_back(
            positions[stop * state.blocks.size() + l / kLaneWidth][l % kLaneWidth]);
      }
    }
  }
  for (std::size_t l = 0; l < stories.size(); ++l) {
    static_cast<LaneState&>(lanes[l]) = state.lane(l);
  }
  return lanes;
}

void expect_equal(const LaneState& a, const LaneState& b, std::size_t lane) {
  SCOPED_TRACE(lane);
  EXPECT_EQ(a.i, b.i);
  EXPECT_EQ(a.w, b.w);
  EXPECT_EQ(a.delta, b.delta);
  EXPECT_EQ(a.v, b.v);
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.z, b.z);
  EXPECT_EQ(a.slide, b.slide);
  EXPECT_EQ(a.contact, b.contact);
  EXPECT_EQ(a.control.halvings, b.control.halvings);
  EXPECT_EQ(a.control.unresolved, b.control.unresolved);
}

void expect_equal(const Recorded& a, const Recorded& b, std::size_t lane) {
  expect_equal(static_cast<const LaneState&>(a), static_cast<const LaneState&>(b), lane);
  EXPECT_EQ(a.at_stops, b.at_stops) << lane;
}

TEST(DriveLanes, MoveAmongOthersAsTheyDoAlone) {
  const std::vector<Story> stories = random_stories(1, 29);
  const std::vector<Recorded> together = recorded_together(stories);
  int moved = 0;
  for (std::size_t l = 0; l < stories.size(); ++l) {
    expect_equal(recorded_together({stories[l]}).front(), together[l], l);
    if (std::abs(together[l].x - 0.1) > 1e-6) ++moved;
  }
  EXPECT_GE(moved, 20);
}

TEST(DriveLanes, MoveTheSameInEveryPlace) {
  const std::vector<Story> stories = random_stories(100, 24);
  std::vector<std::size_t> order(stories.size());
  std::iota(order.begin(), order.end(), 0U);
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  std::vector<Story> shuffled;
  for (const std::size_t l : order) shuffled.push_back(stories[l]);
  const auto here = recorded_together(stories), there = recorded_together(shuffled);
  for (std::size_t l = 0; l < order.size(); ++l) expect_equal(here[order[l]], there[l], l);
}

TEST(DriveLanes, MoveTheSameWithAvx2AndAvx512) {
  const std::vector<SimdLevel> levels = simd_levels();
  if (levels.back() != SimdLevel::avx512) GTEST_SKIP() << "this machine has no AVX-512";
  for (const bool same : {false, true}) {
    std::vector<Story> stories = random_stories(200, 32);
    for (Story& story : stories) {
      if (same) story.drive = stories.front().drive;
    }
    const auto wide = recorded_together(stories, SimdLevel::avx512);
    const auto narrow = recorded_together(stories, SimdLevel::avx2);
    for (std::size_t l = 0; l < stories.size(); ++l) expect_equal(wide[l], narrow[l], l);
  }
}

TEST(DriveLanes, EightTimesTheSameDriveMoveAsOne) {
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U, 6U, 7U, 8U, 9U}) {
    std::vector<Story> stories = random_stories(seed, 8);
    for (Story& story : stories) story.drive = stories.front().drive;
    const auto together = recorded_together(stories);
    for (const std::size_t l : {0U, 7U}) {
      expect_equal(recorded_together({stories[l]}).front(), together[l], l);
    }
  }
}

TEST(DriveLanes, AnInactiveLaneStaysAsItIs) {
  Story story = random_story(3);
  std::fill(story.active.begin(), story.active.end(), false);
  const Recorded still = recorded_together({random_story(1), story})[1];
  const DriveBank bank(std::vector{story.drive}, kTick, kSteps);
  const LaneState rest = bank.at_rest(std::vector{0.1}).lane(0);
  expect_equal(static_cast<const LaneState&>(still), rest, 1);
  for (const double x : still.at_stops) EXPECT_EQ(x, rest.x);
}

TEST(DriveLanes, DifferBetweenInstructionSetsByRounding) {
  // Positions near 0.1 m are rounded alike; the way and the speed tell more.
  constexpr double kPositionTol = 1e-15;  // m, after 24 ms
  constexpr double kSpeedTol = 1e-12;     // m/s
  const std::vector<Story> stories = random_stories(1, 29);
  const auto best = recorded_together(stories, simd_levels().back());
  double largest = 0.0;
  for (const SimdLevel level : simd_levels()) {
    const auto other = recorded_together(stories, level);
    for (std::size_t l = 0; l < stories.size(); ++l) {
      EXPECT_LE(std::abs(other[l].x - best[l].x), kPositionTol) << name_of(level) << ' ' << l;
      EXPECT_LE(std::abs(other[l].v - best[l].v), kSpeedTol) << name_of(level) << ' ' << l;
      largest = std::max(largest, std::abs(other[l].v - best[l].v));
    }
  }
  RecordProperty("largest_difference_of_v", testing::PrintToString(1e15 * largest) + "e-15 m/s");
  if (simd_levels().size() > 1) {
    EXPECT_GT(largest, 0.0);  // they were different ones
  }
}

TEST(PreparedDrives, AreMadeOnceAndKeptInTheNumberAllowed) {
  PreparedDrives kept(2);
  const auto drive = [](unsigned seed) { return random_story(seed).drive; };
  const std::vector<Tick> steps = {2};
  const std::vector<Stretch> stretches = {{2, {1}}};
  const auto first = kept.get(drive(1), kTick, steps);
  EXPECT_EQ(kept.get(drive(1), kTick, steps), first);
  EXPECT_NE(kept.get(drive(1), 2 * kTick, steps), first);
  EXPECT_EQ(kept.get(drive(1), kTick, steps), first);
  EXPECT_NE(kept.get(drive(2), kTick, steps), first);  // the oldest goes
  EXPECT_NE(kept.get(drive(1), kTick, steps), first);
  const auto last = kept.get(drive(1), kTick, steps);
  EXPECT_NE(kept.get(drive(1), kTick, steps, stretches), last);
}

TEST(PreparedDrives, GiveTheSameBankAsThoseMadeForIt) {
  const Story story = random_story(5);
  PreparedDrives kept;
  for (int n = 0; n < 2; ++n) {
    const DriveBank a(std::vector{story.drive}, kTick, kSteps, &kept);
    const DriveBank b(std::vector{story.drive}, kTick, kSteps);
    DriveState s = a.at_rest(std::vector{0.1}), t = s;
    DriveInput input(1);
    input.blocks[0].command[0] = story.command[0];
    a.advance(s, input, 4);
    b.advance(t, input, 4);
    expect_equal(s.lane(0), t.lane(0), 0);
  }
}

}  // namespace
}  // namespace servomill::plant::drive_lanes_test
