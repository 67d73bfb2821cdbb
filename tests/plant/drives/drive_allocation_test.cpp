/// Drives do not touch the heap once they are prepared.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/drives/drive_bank.h"
#include "tests/counting_new.h"
#include "tests/plant/drives/drives.h"

namespace servomill::plant {
namespace {

TEST(DriveBank, DoesNotAllocate) {
  std::array<FeedDriveParams, kJoints> params;
  params.fill(x_axis_with(FrictionKind::none));
  params[0].friction.kind = FrictionKind::none;
  params[1].friction.kind = FrictionKind::set_valued;
  params[2].friction.kind = FrictionKind::regularised;
  params[3].friction.kind = FrictionKind::lugre;
  params[4].friction.kind = FrictionKind::set_valued;
  params[4].gap = 10e-6;
  const std::vector<Tick> steps = {20};
  const DriveBank bank(params, {true, true, true, true, true}, kTick, steps);
  DriveState s = bank.at_rest(Joints::Zero());
  DriveInput input;
  const std::size_t before = allocations;
  for (int n = 0; n < 1000; ++n) {
    input.command.fill(4.0 * std::sin(0.02 * n));
    bank.advance(s, input, 20);
  }
  EXPECT_EQ(allocations, before);
  EXPECT_NE(s.x[4], 0.0);
  ::operator delete(::operator new(1));  // the counter counts
  EXPECT_EQ(allocations, before + 1);
}

}  // namespace
}  // namespace servomill::plant
