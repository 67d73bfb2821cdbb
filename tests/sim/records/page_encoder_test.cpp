// Pages of rows as chunks: equal columns share one.

#include "sim/records/page_encoder.h"

#include <gtest/gtest.h>

#include <span>
#include <vector>

namespace servomill::sim::records::page_encoder_test {
namespace {

using Indices = std::vector<std::size_t>;

Indices chunks_of(PageEncoder& encoder, const std::vector<std::vector<double>>& columns) {
  encoder.encode(std::vector<std::span<const double>>(columns.begin(), columns.end()));
  const auto all = encoder.chunk_of_columns();
  return {all.begin(), all.end()};
}

TEST(PageEncoder, EncodesEqualColumnsOnce) {
  PageEncoder encoder(std::vector(4, Storage::float64), {16, 1}, 1);
  EXPECT_EQ(chunks_of(encoder, {{1, 3}, {2, 4}, {1, 3}, {2, 4}}), (Indices{0, 1, 0, 1}));
  EXPECT_EQ(encoder.chunks().size(), 2u);
}

TEST(PageEncoder, ComparesToTheLastRow) {
  PageEncoder encoder(std::vector(2, Storage::float64), {16, 1}, 1);
  EXPECT_EQ(chunks_of(encoder, {{1, 2, 3}, {1, 2, 4}}), (Indices{0, 1}));
}

TEST(PageEncoder, ComparesEachPageAnew) {
  PageEncoder encoder(std::vector(2, Storage::float64), {16, 1}, 1);
  EXPECT_EQ(chunks_of(encoder, {{1}, {2}}), (Indices{0, 1}));
  EXPECT_EQ(chunks_of(encoder, {{5}, {5}}), (Indices{0, 0}));
  EXPECT_EQ(encoder.chunks().size(), 1u);
  EXPECT_EQ(chunks_of(encoder, {{6}, {7}}), (Indices{0, 1}));
}

TEST(PageEncoder, TellsStoragesApart) {
  PageEncoder encoder({Storage::float64, Storage::float32, Storage::int32}, {16, 1}, 1);
  EXPECT_EQ(chunks_of(encoder, {{1}, {1}, {1}}), (Indices{0, 1, 2}));
}

TEST(PageEncoder, TellsZerosOfDifferentSignApart) {
  PageEncoder encoder(std::vector(2, Storage::float64), {16, 1}, 1);
  EXPECT_EQ(chunks_of(encoder, {{0.0}, {-0.0}}), (Indices{0, 1}));
}

}  // namespace
}  // namespace servomill::sim::records::page_encoder_test
