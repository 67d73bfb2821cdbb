/// Drives do not touch the heap once they are prepared.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/drives/drive_bank.h"
#include "tests/counting_new.h"
#include "tests/plant/drives/drives.h"

namespace servomill::plant::drive_allocation_test {
namespace {

TEST(DriveBank, DoesNotAllocate) {
  std::array<FeedDriveParams, 5> params;
  params.fill(x_axis_with(FrictionKind::none));
  params[0].friction.kind = FrictionKind::none;
  params[1].friction.kind = FrictionKind::set_valued;
  params[2].friction.kind = FrictionKind::regularised;
  params[3].friction.kind = FrictionKind::lugre;
  params[4].friction.kind = FrictionKind::set_valued;
  params[4].gap = 10e-6;
  const std::vector<Tick> steps = {20};
  const DriveBank bank(params, kTick, steps);
  DriveState s = bank.at_rest(std::array<double, 5>{});
  DriveInput input(5);
  const std::size_t before = allocations;
  for (int n = 0; n < 1000; ++n) {
    input.blocks[0].command.fill(4.0 * std::sin(0.02 * n));
    bank.advance(s, input, 20);
  }
  EXPECT_EQ(allocations, before);
  EXPECT_NE(s.blocks[0].x[4], 0.0);
  ::operator delete(::operator new(1));  // the counter counts
  EXPECT_EQ(allocations, before + 1);
}

}  // namespace
}  // namespace servomill::plant::drive_allocation_test
