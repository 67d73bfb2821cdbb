#include "sim/config/quantity.h"

#include <gtest/gtest.h>

#include <array>
#include <numbers>

namespace servomill::sim::config::quantity_test {
namespace {

constexpr double kRounding = 1e-15;  // relative, a few roundings of the factors

struct Case {
  std::string_view symbol;
  Quantity quantity;
  double factor;
};

constexpr double kPi = std::numbers::pi;
constexpr std::array kCases = {
    Case{"m", kLength, 1.0},
    Case{"um", kLength, 1e-6},
    Case{"inch", kLength, 0.0254},
    Case{"arcsec", kAngle, kPi / 648000.0},
    Case{"mm/min", kVelocity, 1e-3 / 60.0},
    Case{"m/min/mm", kRate, 1000.0 / 60.0},
    Case{"1/min", kRate, 1.0 / 60.0},
    Case{"Hz", kRate, 1.0},
    Case{"rpm", kAngularVelocity, kPi / 30.0},
    Case{"deg/s", kAngularVelocity, kPi / 180.0},
    Case{"m/s^2", kAcceleration, 1.0},
    Case{"m/s^3", kJerk, 1.0},
    Case{"rad/s^2", kAngularAcceleration, 1.0},
    Case{"rad/s^3", kAngularJerk, 1.0},
    Case{"kg m^2", kInertia, 1.0},
    Case{"kg mm^2", kInertia, 1e-6},
    Case{"kN", kForce, 1e3},
    Case{"N m", kTorque, 1.0},
    Case{"Nm", kTorque, 1.0},
    Case{"V", kVoltage, 1.0},
    Case{"N/um", kStiffness, 1e6},
    Case{"N s/m", kDamping, 1.0},
    Case{"Nm/rad", kTorsionalStiffness, 1.0},
    Case{"Nms/rad", kTorsionalDamping, 1.0},
    Case{"Nm/A", kTorqueConstant, 1.0},
    Case{"N/A", kForceConstant, 1.0},
    Case{"mm/rad", kTransmission, 1e-3},
    Case{"mm/rev", kTransmission, 1e-3 / (2.0 * kPi)},
    Case{"um/m", kNumber, 1e-6},
    Case{"um/mm", kNumber, 1e-3},
    Case{"um/m/K", kExpansion, 1e-6},
    Case{"%", kNumber, 1e-2},
};

TEST(ParseUnit, KnowsDimensionAndFactor) {
  for (const Case& c : kCases) {
    const ParsedUnit parsed = parse_unit(c.symbol);
    ASSERT_TRUE(parsed.unit) << c.symbol << ": " << parsed.complaint;
    EXPECT_EQ(parsed.unit->quantity, c.quantity) << c.symbol;
    EXPECT_NEAR(parsed.unit->factor / c.factor, 1.0, kRounding) << c.symbol;
  }
}

TEST(ParseUnit, NamesTheNearestSymbolOfAnUnknownOne) {
  EXPECT_EQ(parse_unit("mmm").complaint, "unknown unit 'mmm'; did you mean 'mm'?");
  EXPECT_EQ(parse_unit("m/sec").complaint, "unknown unit 'sec'");
  EXPECT_EQ(parse_unit("mm/mins").complaint, "unknown unit 'mins'; did you mean 'min'?");
}

TEST(ParseUnit, GuessesNothingWhereSeveralSymbolsAreAsNear) {
  EXPECT_EQ(parse_unit("mn").complaint, "unknown unit 'mn'");
  EXPECT_EQ(scale_text("5 mn", kLength).complaint,
            "unknown unit 'mn'; a length is in m, mm, um, nm, inch");
  EXPECT_EQ(scale_text("5 mn", kTime).complaint,
            "unknown unit 'mn'; a time is in s, ms, us, min, h");
  EXPECT_EQ(scale_text("5 mn", kStiffness).complaint,
            "unknown unit 'mn'; must be a stiffness such as \"3 N/um\"");
  EXPECT_EQ(scale_text("5 1/mn", kRate).complaint,
            "unknown unit 'mn'; must be a rate such as \"3 1/s\"");
}

TEST(ScaleText, NamesTheKindAndTheNearestUnitOfIt) {
  EXPECT_EQ(scale_text("5 mmm", kLength).complaint,
            "unknown unit 'mmm'; a length is in m, mm, um, nm, inch; did you mean 'mm'?");
  EXPECT_EQ(scale_text("5 mins", kTime).complaint,
            "unknown unit 'mins'; a time is in s, ms, us, min, h; did you mean 'min'?");
  EXPECT_EQ(scale_text("5 kgs", kMass).complaint,
            "unknown unit 'kgs'; a mass is in g, kg; did you mean 'kg'?");
  EXPECT_EQ(scale_text("5 mm/mins", kVelocity).complaint,
            "unknown unit 'mins'; must be a velocity such as \"3 mm/s\"; did you mean 'min'?");
}

TEST(ParseUnit, RefusesWhatIsNoProduct) {
  for (const std::string_view text : {"", "m/", "/s", "m//s", "m^", "m^0", "m^12", "m s ", "2 m"}) {
    EXPECT_FALSE(parse_unit(text).unit) << "'" << text << "'";
  }
}

TEST(UnitOfKey, ReadsTheEndOfTheKey) {
  EXPECT_EQ(unit_of_key("lead_mm", kLength)->symbol, "mm");
  EXPECT_EQ(unit_of_key("max_rate_mm_per_s", kVelocity)->symbol, "mm/s");
  EXPECT_EQ(unit_of_key("a_max_m_per_s2", kAcceleration)->symbol, "m/s^2");
  EXPECT_EQ(unit_of_key("J_kg_m2", kInertia)->symbol, "kg m^2");
  EXPECT_EQ(unit_of_key("Kv_per_s", kRate)->symbol, "1/s");
  EXPECT_EQ(unit_of_key("k_t_Nm_per_A", kTorqueConstant)->symbol, "Nm/A");
  EXPECT_EQ(unit_of_key("EAX_urad", kAngle)->symbol, "urad");
}

TEST(UnitOfKey, FindsNoneInANameWithoutUnitOfTheQuantity) {
  EXPECT_FALSE(unit_of_key("Kv", kRate));
  EXPECT_FALSE(unit_of_key("mm", kLength));
  EXPECT_FALSE(unit_of_key("period_s", kLength));
}

TEST(SiUnit, ReadsAgainToTheSameQuantityWithFactorOne) {
  for (const Case& c : kCases) {
    if (c.quantity == kNumber) continue;
    const ParsedUnit parsed = parse_unit(si_unit(c.quantity));
    ASSERT_TRUE(parsed.unit) << si_unit(c.quantity);
    EXPECT_EQ(parsed.unit->quantity, c.quantity) << si_unit(c.quantity);
    EXPECT_EQ(parsed.unit->factor, 1.0) << si_unit(c.quantity);
    EXPECT_EQ(parse_unit(example_unit(c.quantity)).unit->quantity, c.quantity);
  }
  constexpr Quantity kOdd{.m = 2, .kg = 1, .s = -1, .A = -2};
  EXPECT_EQ(si_unit(kOdd), "kg m^2/A^2/s");
  EXPECT_EQ(parse_unit(si_unit(kOdd)).unit->quantity, kOdd);
  EXPECT_EQ(name_of(kOdd), "a quantity in kg m^2/A^2/s");
}

TEST(InUnit, PrintsUpToSixDigits) {
  EXPECT_EQ(in_unit(0.3e-6, "um"), "0.3 um");
  EXPECT_EQ(in_unit(60.0, "m/min/mm"), "3.6 m/min/mm");
}

}  // namespace
}  // namespace servomill::sim::config::quantity_test
