// Cases on threads: each runs once, its end and what it threw are known, and none begins when
// nobody waits for it any more.

#include "sim/run/case_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

namespace servomill::sim::run::case_pool_test {
namespace {

using namespace std::chrono_literals;

TEST(CasePool, RunsEveryCaseOnce) {
  constexpr std::size_t kCases = 20;
  for (const unsigned threads : {1u, 3u, 40u}) {
    std::vector<std::atomic<int>> runs(kCases);
    CasePool pool(kCases, threads, [&](std::size_t i) { ++runs[i]; });
    for (std::size_t i = 0; i < kCases; ++i) {
      ASSERT_TRUE(pool.wait(i, 60s));
      EXPECT_TRUE(pool.has_ended(i));
      EXPECT_EQ(pool.failure(i), nullptr);
      EXPECT_EQ(runs[i], 1);
    }
  }
}

TEST(CasePool, KeepsWhatACaseThrowsAndRunsTheOthers) {
  CasePool pool(3, 1, [](std::size_t i) {
    if (i == 1) throw std::runtime_error("of one");
  });
  for (std::size_t i = 0; i < 3; ++i) ASSERT_TRUE(pool.wait(i, 60s));
  EXPECT_EQ(pool.failure(0), nullptr);
  EXPECT_EQ(pool.failure(2), nullptr);
  EXPECT_THROW(std::rethrow_exception(pool.failure(1)), std::runtime_error);
}

TEST(CasePool, WaitsNoLongerThanItIsTold) {
  std::atomic<bool> may_end = false;
  CasePool pool(1, 1, [&](std::size_t) { may_end.wait(false); });
  EXPECT_FALSE(pool.wait(0, 1ms));
  EXPECT_FALSE(pool.has_ended(0));
  may_end = true;
  may_end.notify_one();
  EXPECT_TRUE(pool.wait(0, 60s));
}

TEST(CasePool, BeginsNoFurtherCaseWhenItGoes) {
  std::atomic<bool> may_end = false;
  std::atomic<int> begun = 0;
  const std::jthread later([&] {
    begun.wait(0);
    std::this_thread::sleep_for(300ms);  // meanwhile the pool goes
    may_end = true;
    may_end.notify_one();
  });
  {
    const CasePool pool(100, 1, [&](std::size_t) {
      ++begun;
      begun.notify_all();
      may_end.wait(false);
    });
    begun.wait(0);
  }
  EXPECT_EQ(begun, 1);
}

}  // namespace
}  // namespace servomill::sim::run::case_pool_test
