#include "sim/config/rule.h"

#include <gtest/gtest.h>

#include <limits>

#include "sim/config/quantity.h"

namespace servomill::sim::config::rule_test {
namespace {

TEST(Rule, HoldsOnOneSideOfItsBound) {
  EXPECT_FALSE(all_hold({above(1.0)}, 1.0));
  EXPECT_TRUE(all_hold({above(1.0)}, 1.000001));
  EXPECT_TRUE(all_hold({at_least(1.0)}, 1.0));
  EXPECT_FALSE(all_hold({at_least(1.0)}, 0.999999));
  EXPECT_FALSE(all_hold({below(1.0)}, 1.0));
  EXPECT_TRUE(all_hold({below(1.0)}, 0.999999));
  EXPECT_TRUE(all_hold({at_most(1.0)}, 1.0));
  EXPECT_FALSE(all_hold({at_most(1.0)}, 1.000001));
}

TEST(Rule, AllOfThemHoldAndTheValueIsFinite) {
  EXPECT_TRUE(all_hold({}, -1e300));
  EXPECT_TRUE(all_hold({above(0.0), at_most(2.0)}, 2.0));
  EXPECT_FALSE(all_hold({above(0.0), at_most(2.0)}, 0.0));
  EXPECT_FALSE(all_hold({}, std::numeric_limits<double>::infinity()));
  EXPECT_FALSE(all_hold({}, std::numeric_limits<double>::quiet_NaN()));
}

TEST(Rule, RequirementIsInTheUnitOfTheUser) {
  const Unit um{"um", kLength, 1e-6};
  EXPECT_EQ(requirement({above(0.0), at_most(500e-6)}, 1.0, um, true), "must be > 0 and <= 500 um");
  EXPECT_EQ(requirement({above(0.0), at_most(500e-6)}, 1.0, um, false), "must be > 0 and <= 500");
  EXPECT_EQ(requirement({at_least(2.0), below(3.0)}, 1.0, Unit{}, false), "must be >= 2 and < 3");
  EXPECT_EQ(requirement({above(0.0)}, std::numeric_limits<double>::infinity(), um, true),
            "must be finite");
}

}  // namespace
}  // namespace servomill::sim::config::rule_test
