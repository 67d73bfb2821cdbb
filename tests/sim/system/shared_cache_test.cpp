#include "sim/system/shared_cache.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

namespace servomill::sim::system::shared_cache_test {
namespace {

template <class... Parts>
MemoKey key_of(const Parts&... parts) {
  MemoKey key;
  (key.add(parts), ...);
  return key;
}

TEST(MemoKey, TellsEveryDifference) {
  EXPECT_EQ(key_of(1.5, 2, std::string_view("a")).bytes(),
            key_of(1.5, 2, std::string_view("a")).bytes());
  EXPECT_NE(key_of(0.0).bytes(), key_of(-0.0).bytes());
  EXPECT_NE(key_of(1).bytes(), key_of(1.0).bytes());
  const std::string_view ab = "ab", a = "a", b = "b", none = "";
  EXPECT_NE(key_of(ab, none).bytes(), key_of(a, b).bytes());
  EXPECT_NE(key_of(Eigen::Vector2d(1.0, 2.0)).bytes(), key_of(Eigen::Vector2d(2.0, 1.0)).bytes());
}

TEST(SharedCache, ComputesOnceWhatWasAskedForBefore) {
  SharedCache<int> memo(10);
  int computed = 0;
  const auto square = [&](int x) {
    return memo.get(key_of(x), [&] {
      ++computed;
      return x * x;
    });
  };
  EXPECT_EQ(*square(3), 9);
  EXPECT_EQ(*square(4), 16);
  EXPECT_EQ(square(3), square(3));  // the very same object
  EXPECT_EQ(computed, 2);
  EXPECT_EQ(memo.made(), 2U);
}

// It takes memory as it is: a second one would take as much again.
TEST(SharedCache, GivesWhatItForgotAsLongAsSomebodyHoldsIt) {
  SharedCache<int> memo(1);
  const auto ask = [&](int x) { return memo.get(key_of(x), [x] { return x; }); };
  auto held = ask(1);
  const auto other = ask(2);  // there is room for one
  EXPECT_EQ(memo.size(), 1U);
  EXPECT_EQ(ask(1), held);
  EXPECT_EQ(memo.made(), 2U);
  held.reset();
  EXPECT_EQ(*ask(1), 1);
  EXPECT_EQ(memo.made(), 3U);
}

TEST(SharedCache, ForgetsWhatWasNotUsedForLongestAndNoMore) {
  SharedCache<int> memo(3);
  const auto ask = [&](int x) { return memo.get(key_of(x), [x] { return x; }); };
  const auto first = ask(1);
  ask(2);
  ask(3);
  ask(1);  // 2 is now the oldest
  ask(4);
  EXPECT_EQ(memo.size(), 3U);
  const std::size_t before = memo.made();
  ask(1), ask(3), ask(4);
  EXPECT_EQ(memo.made(), before);
  ask(2);
  EXPECT_EQ(memo.made(), before + 1);
  EXPECT_EQ(*first, 1);  // whoever was given a result keeps it
}

TEST(SharedCache, BoundsTheWeightButKeepsTheLastResultHoweverHeavy) {
  SharedCache<std::string> memo(10, [](const std::string& text) { return text.size(); });
  const auto ask = [&](const std::string& text) {
    return memo.get(key_of(std::string_view(text)), [&] { return text; });
  };
  ask("12345");
  ask("12345 ");
  EXPECT_EQ(memo.size(), 1U);
  ask("heavier than all that is allowed");
  ask("heavier than all that is allowed");
  EXPECT_EQ(memo.size(), 1U);
  EXPECT_EQ(memo.made(), 3U);
}

TEST(SharedCache, AsksAnewForWhatFailed) {
  SharedCache<int> memo(10);
  const auto fail = []() -> int { throw std::runtime_error("no"); };
  EXPECT_THROW(memo.get(key_of(1), fail), std::runtime_error);
  EXPECT_THROW(memo.get(key_of(1), fail), std::runtime_error);
  EXPECT_EQ(memo.size(), 0U);
  EXPECT_EQ(*memo.get(key_of(1), [] { return 7; }), 7);
}

TEST(SharedCache, LetsThreadsWaitForTheFirstThatAsks) {
  SharedCache<int> memo(10);
  std::atomic<int> computed = 0, right = 0;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 8; ++t) {
      threads.emplace_back([&] {
        const auto slow = [&] {
          std::this_thread::sleep_for(std::chrono::milliseconds(20));
          return ++computed;
        };
        right += *memo.get(key_of(1), slow) == 1 ? 1 : 0;
      });
    }
  }
  EXPECT_EQ(computed, 1);
  EXPECT_EQ(right, 8);
}

TEST(SharedCache, GivesEveryThreadItsOwnFailure) {
  SharedCache<int> memo(10);
  std::atomic<int> failed = 0;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&, t] {
        const auto slow = [&]() -> int {
          std::this_thread::sleep_for(std::chrono::milliseconds(20));
          throw std::runtime_error(std::to_string(t));
        };
        try {
          memo.get(key_of(1), slow);
        } catch (const std::runtime_error& error) {
          failed += error.what() == std::to_string(t) ? 1 : 0;
        }
      });
    }
  }
  EXPECT_EQ(failed, 4);
}

}  // namespace
}  // namespace servomill::sim::system::shared_cache_test
