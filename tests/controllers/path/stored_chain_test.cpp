/// A long motion on the disk is the motion in memory, bit for bit.
#include "controllers/path/stored_chain.h"

#include <gtest/gtest.h>

#include <cmath>

#include "programs.h"

namespace servomill::controllers::test::stored_chain_test {
namespace {

Program rows() {
  Program program;
  for (int n = 0; n < 3000; ++n) {
    program.line(0.1 * mm * n, 2 * mm * std::sin(0.01 * n), std::cos(0.02 * n) * mm, 50 * mm);
    if (n % 1000 == 500) program.dwell(0.1);
  }
  return program;
}

Trajectory planned(std::size_t plans_in_memory) {
  PathOptions options;
  options.stretch = 400;
  options.plans_in_memory = plans_in_memory;
  return rows().plan(options);
}

void expect_same(const Trajectory::Sample& one, const Trajectory::Sample& other) {
  EXPECT_EQ(one.Q_ref, other.Q_ref);
  EXPECT_EQ(one.dddQ_ref, other.dddQ_ref);
  EXPECT_EQ(one.s, other.s);
  EXPECT_EQ(one.line, other.line);
  EXPECT_EQ(one.move, other.move);
  EXPECT_EQ(one.rapid, other.rapid);
}

TEST(StoredChain, IsSampledAsInMemory) {
  const Trajectory memory = planned(1'000'000'000);
  for (const std::size_t bytes : {0U, 200'000U}) {
    const Trajectory disk = planned(bytes);
    ASSERT_EQ(disk.chains(), memory.chains());
    ASSERT_GT(disk.chains(), 8U);
    EXPECT_EQ(disk.duration(), memory.duration());
    EXPECT_LT(disk.weight(), memory.weight());
    Trajectory::Cursor one, other;
    for (double t = -0.1; t < memory.duration() + 0.1; t += 3 * ms) {
      expect_same(disk.at(t, one), memory.at(t, other));
    }
    for (double t = memory.duration(); t > 0.0; t -= 0.37) {  // backwards
      expect_same(disk.at(t, one), memory.at(t, other));
    }
  }
}

TEST(StoredChain, IsReadOnceByAllThatLookAtIt) {
  const Trajectory disk = planned(0);
  const auto one = disk.chain(0), other = disk.chain(0);
  EXPECT_EQ(one, other);
  EXPECT_NE(one, disk.chain(1));
  EXPECT_EQ(one->duration, one->plan->law.duration);
}

// Equal motions have one plan: on the disk it would be there once for each.
TEST(ChainStore, KeepsPlansThatChainsShare) {
  const Trajectory memory = planned(1'000'000'000);
  Trajectory::Chain chain = *memory.chain(0);
  ChainStore store(0);
  EXPECT_EQ(store.keep(chain).plan, chain.plan);
  chain.plan = std::make_shared<Trajectory::Chain::Plan>(*chain.plan);
  const Trajectory::Chain stored = store.keep(std::move(chain));
  EXPECT_EQ(stored.plan, nullptr);
  ASSERT_NE(stored.stored, nullptr);
  EXPECT_EQ(stored.stored->read()->plan->law.phases.size(),
            memory.chain(0)->plan->law.phases.size());
}

}  // namespace
}  // namespace servomill::controllers::test::stored_chain_test
