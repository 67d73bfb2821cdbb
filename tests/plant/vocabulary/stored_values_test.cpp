#include "plant/vocabulary/stored_values.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <thread>
#include <vector>

#include "tests/mapped_memory.h"

namespace servomill::stored_values_test {
namespace {

struct Value {
  double number;
  int line;
};

constexpr std::size_t kCount = 300'000;  // 4.8 MB

Value value(std::size_t n) { return {0.1 * static_cast<double>(n), static_cast<int>(n) + 1}; }

StoredValues<Value> values(std::size_t most_in_memory, bool is_reserved) {
  StoredValues<Value> out("values", most_in_memory);
  if (is_reserved) out.reserve(kCount);
  for (std::size_t n = 0; n < kCount; ++n) {
    out.push_back(value(n));
    EXPECT_EQ(out.back().line, value(n).line);
  }
  out.finish();
  return out;
}

std::size_t wrong_ones(const StoredValues<Value>& all) {
  std::size_t wrong = 0;
  for (std::size_t n = 0; n < kCount; ++n) {
    wrong += all[n].number == value(n).number && all[n].line == value(n).line ? 0 : 1;
  }
  return wrong;
}

TEST(StoredValues, AreTheSameInMemoryAndOnTheDisk) {
  for (const bool is_reserved : {false, true}) {
    for (const std::size_t most : {std::size_t{1} << 30U, std::size_t{1'000'000}, std::size_t{0}}) {
      const StoredValues<Value> all = values(most, is_reserved);
      EXPECT_EQ(all.is_on_disk(), most < kCount * sizeof(Value)) << most;
      EXPECT_EQ(all.size(), kCount);
      EXPECT_EQ(wrong_ones(all), 0U) << most;
      EXPECT_EQ(all.back().line, value(kCount - 1).line);
      const StoredValues<Value> copy = all;
      EXPECT_EQ(wrong_ones(copy), 0U) << most;
    }
  }
}

TEST(StoredValues, GiveBackTheMemoryOfWhatWasRead) {
  constexpr std::size_t kBytes = kCount * sizeof(Value);
  const StoredValues<Value> all = values(0, true);
  ASSERT_EQ(wrong_ones(all), 0U);
  const double read = mapped_bytes_in_memory();
  all.release();
  EXPECT_GT(read - mapped_bytes_in_memory(), 0.9 * kBytes);
  EXPECT_EQ(wrong_ones(all), 0U);
}

TEST(StoredValues, AreReadWhileAnotherThreadGivesThemBack) {
  const StoredValues<Value> all = values(0, true);
  std::jthread other([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) all.release();
  });
  for (int i = 0; i < 10; ++i) EXPECT_EQ(wrong_ones(all), 0U);
}

TEST(StoredValues, MayBeNone) {
  StoredValues<Value> none("values", 0);
  none.reserve(0);
  none.finish();
  EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace servomill::stored_values_test
