#include "sim/sweep/selection.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/sweep/table_csv.h"

namespace servomill::sim::sweep::selection_test {
namespace {

TEST(Selection, OfOneShardIsAllInTheirOrder) {
  const Selection all{10, 20};
  ASSERT_EQ(all.size(), 10U);
  for (std::uint64_t i = 0; i < 10; ++i) EXPECT_EQ(all.point(i), 10 + i);
}

TEST(Selection, SharesEveryPointOnce) {
  for (const std::uint64_t points : {1U, 7U, 64U, 100U, 1000U, 4099U}) {
    for (const std::uint64_t shards : {1U, 2U, 3U, 7U, 8U}) {
      if (shards > points) continue;
      std::vector<int> held(points);
      for (std::uint64_t shard = 1; shard <= shards; ++shard) {
        const Selection one{5, 5 + points, shard, shards};
        EXPECT_GT(one.size(), 0U) << points << ' ' << shards;
        for (std::uint64_t place = 0; place < one.size(); ++place) {
          const std::uint64_t point = one.point(place);
          ASSERT_GE(point, one.first);
          ASSERT_LT(point, one.last);
          ++held[point - 5];
          EXPECT_EQ(one.place(point), place);
          EXPECT_EQ(one.shard_of(point), shard);
          if (place > 0) {
            EXPECT_GT(point, one.point(place - 1));
          }
        }
      }
      EXPECT_EQ(held, std::vector<int>(points, 1)) << points << " points, " << shards << " shards";
    }
  }
}

TEST(Selection, KeepsNeighboursTogether) {
  const Selection shard{0, 1024, 2, 4};
  for (std::uint64_t place = 0; place < 16; ++place) EXPECT_EQ(shard.point(place), 16 + place);
  EXPECT_EQ(shard.point(16), 16 + 4 * 16);
}

TEST(ReadSelection, CountsFromOne) {
  EXPECT_EQ(read_selection(100, "", ""), (Selection{0, 100, 1, 1}));
  EXPECT_EQ(read_selection(100, "1-20", ""), (Selection{0, 20, 1, 1}));
  EXPECT_EQ(read_selection(100, "100-100", ""), (Selection{99, 100, 1, 1}));
  EXPECT_EQ(read_selection(100, "11-30", "3/4"), (Selection{10, 30, 3, 4}));
}

std::string refusal(const std::string& range, const std::string& shard) {
  try {
    read_selection(100, range, shard);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ReadSelection, SaysWhatIsWrong) {
  for (const std::string wrong : {"0-5", "5", "5-4", "-3", "a-b", "1-2-3", "1.5-2"}) {
    EXPECT_EQ(refusal(wrong, ""),
              "--points " + wrong + ": error: must be A-B (first and last point), counted from 1");
  }
  EXPECT_EQ(refusal("1-101", ""), "--points 1-101: error: the sweep has 100 points");
  for (const std::string wrong : {"0/4", "5/4", "4", "1/0", "1/9999999", "-1/4", "1/4/8"}) {
    EXPECT_EQ(refusal("", wrong), "--shard " + wrong +
                                      ": error: must be I/N, shard I of N, with 1 <= I <= N <= "
                                      "1000000");
  }
  EXPECT_EQ(refusal("", "1/101"),
            "--shard 1/101: error: the sweep has only 100 points: too few for so many shards");
}

TEST(ShardName, StandsBeforeTheEnding) {
  EXPECT_EQ(shard_name("a/out.h5", {0, 9, 2, 8}), "a/out.2-of-8.h5");
  EXPECT_EQ(shard_name("out", {0, 9, 1, 1}), "out.1-of-1");
}

TEST(WritableTable, IsThatOfTheShardAndRefusedWhereItIsAFolder) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(testing::TempDir()) / ("tables_" + std::to_string(getpid()));
  fs::create_directories(folder / "taken.csv");
  const std::string path = folder / "out.h5";
  EXPECT_EQ(writable_table(path, {0, 9, 1, 1}, "", false), path);
  EXPECT_EQ(writable_table(path, {0, 9, 2, 8}, "2/8", false), (folder / "out.2-of-8.h5").string());
  EXPECT_THROW(writable_table(folder / "taken.h5", {0, 9, 1, 1}, "", true), InputError);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace servomill::sim::sweep::selection_test
