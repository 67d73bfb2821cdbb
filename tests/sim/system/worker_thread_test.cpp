#include "sim/system/worker_thread.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace servomill::sim::system::worker_thread_test {
namespace {

TEST(WorkerThread, DoesJobsInOrderInAnotherThread) {
  std::vector<int> done;
  std::thread::id who;
  WorkerThread background;
  for (int i = 0; i < 100; ++i) {
    background.post([&, i] {
      done.push_back(i);
      who = std::this_thread::get_id();
    });
  }
  background.wait();
  ASSERT_EQ(done.size(), 100U);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(done[static_cast<std::size_t>(i)], i);
  EXPECT_NE(who, std::this_thread::get_id());
}

TEST(WorkerThread, TakesNoJobBeforeTheLastIsDone) {
  std::atomic<int> undone = 0;
  WorkerThread background;
  for (int i = 0; i < 50; ++i) {
    background.post([&] { --undone; });
    EXPECT_LE(++undone, 1);
  }
  background.wait();
  EXPECT_EQ(undone, 0);
}

TEST(WorkerThread, SaysWhatAJobThrewAndDoesNoOther) {
  int later = 0;
  WorkerThread background;
  background.post([] { throw std::runtime_error("disk full"); });
  for (int i = 0; i < 3; ++i) {
    try {
      background.post([&] { ++later; });
      FAIL() << "nothing thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "disk full");
    }
  }
  EXPECT_THROW(background.wait(), std::runtime_error);
  EXPECT_EQ(later, 0);
}

TEST(WorkerThread, EndsWithTheJobThatRuns) {
  std::atomic<bool> done = false;
  {
    WorkerThread background;
    background.post([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      done = true;
    });
  }
  EXPECT_TRUE(done);
}

TEST(ForEachIndex, CallsEachOnceForAnyNumberOfThreads) {
  for (const unsigned threads : {1U, 2U, 7U}) {
    for (const std::size_t count :
         {std::size_t{0}, std::size_t{1}, std::size_t{5}, std::size_t{1000}}) {
      std::vector<std::atomic<int>> calls(count);
      for_each_index(count, threads, [&](std::size_t i) { ++calls[i]; });
      for (const auto& one : calls) EXPECT_EQ(one, 1);
    }
  }
}

TEST(ForEachIndex, ThrowsWhatACallThrew) {
  EXPECT_THROW(for_each_index(100, 3,
                              [](std::size_t i) {
                                if (i == 17) throw std::runtime_error("17");
                              }),
               std::runtime_error);
}

}  // namespace
}  // namespace servomill::sim::system::worker_thread_test
