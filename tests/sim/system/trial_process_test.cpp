#include "sim/system/trial_process.h"

#include <gtest/gtest.h>

#include <csignal>
#include <stdexcept>

namespace servomill::sim::system::trial_process_test {
namespace {

TEST(TrialProcess, WorkThatEndsIsFine) {
  int here = 0;
  EXPECT_EQ(try_in_process([&] { here = 1; }, 5), "");
  EXPECT_EQ(here, 0) << "done in another process";
  EXPECT_EQ(try_in_process([] { throw std::runtime_error("refused"); }, 5), "");
}

TEST(TrialProcess, NamesACrash) {
  EXPECT_EQ(try_in_process([] { raise(SIGSEGV); }, 5), "crashes (signal 11)");
}

TEST(TrialProcess, EndsWorkThatHangs) {
  volatile bool forever = true;
  EXPECT_EQ(try_in_process(
                [&] {
                  while (forever) {
                  }
                },
                1),
            "does not come to an end within 1 s");
}

}  // namespace
}  // namespace servomill::sim::system::trial_process_test
