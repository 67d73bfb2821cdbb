// Skew corrections as the firmwares read and apply them.
#include "controllers/tables/skew_table.h"

#include <gtest/gtest.h>

#include "plant/vocabulary/input_error.h"

namespace servomill::controllers::skew_table_test {
namespace {

SkewSetting marlin(const std::string& text) {
  return read_skew_table({"s.gcode", text}, SkewFirmware::marlin);
}
SkewSetting klipper(const std::string& text) {
  return read_skew_table({"s.cfg", text}, SkewFirmware::klipper);
}
SkewSetting reprapfirmware(const std::string& text) {
  return read_skew_table({"s.g", text}, SkewFirmware::reprapfirmware);
}

template <typename Read>
std::string fault_of(Read read, const std::string& text) {
  try {
    read(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "read";
}

// skew() of planner.h: x - y xy - z (xz - xy yz), y - z yz.
TEST(SkewTable, MarlinSubtracts) {
  const Eigen::Vector3d p = marlin("; comment\nM852 I0.1 J0.2 K0.3\n").commanded({1.0, 2.0, 3.0});
  EXPECT_DOUBLE_EQ(p.x(), 1.0 - 2.0 * 0.1 - 3.0 * (0.2 - 0.1 * 0.3));
  EXPECT_DOUBLE_EQ(p.y(), 2.0 - 3.0 * 0.3);
  EXPECT_DOUBLE_EQ(p.z(), 3.0);
}

TEST(SkewTable, KlipperSubtracts) {
  const SkewSetting s = klipper(
      "[skew_correction]\n[skew_correction my skew]\nxy_skew = 0.1\nxz_skew = 0.2\nyz_skew = "
      "0.3\n");
  EXPECT_EQ(s.commanded({1.0, 2.0, 3.0}), marlin("M852 I0.1 J0.2 K0.3").commanded({1.0, 2.0, 3.0}));
}

// The example of duet3d.dozuki.com/Wiki/M556; AxisTransform adds.
TEST(SkewTable, ReprapfirmwareAdds) {
  const SkewSetting s = reprapfirmware("M556 S100 X0.7 Y-0.2 Z0.6\n");
  const Eigen::Vector3d p = s.commanded({1.0, 2.0, 3.0});
  EXPECT_DOUBLE_EQ(p.x(), 1.0 + 0.007 * 2.0 + 0.006 * 3.0);
  EXPECT_DOUBLE_EQ(p.y(), 2.0 - 0.002 * 3.0);
}

TEST(SkewTable, RefusesWhatTheFirmwareWouldTakeOtherwise) {
  EXPECT_EQ(fault_of(marlin, "M852 S0.1 J0 K0\n"),
            "s.gcode:1: error: 'S0.1' is not supported in M852");
  EXPECT_EQ(fault_of(marlin, "M852 I0.1 J0\n"), "s.gcode:1: error: K is missing in M852");
  EXPECT_EQ(fault_of(marlin, "M852 I2 J0 K0\n"), "s.gcode:1: error: I = 2; must be from -1 to 1");
  EXPECT_EQ(fault_of(marlin, "G20\nM852 I0 J0 K0\n"),
            "s.gcode:2: error: a second command; only one is supported");
  EXPECT_EQ(fault_of(marlin, "M556 S100 X0 Y0 Z0\n"),
            "s.gcode:1: error: 'M556 S100 X0 Y0 Z0' is not supported; only M852");
  EXPECT_EQ(fault_of(marlin, "\n"), "s.gcode: error: contains no skew setting");
  EXPECT_EQ(fault_of(reprapfirmware, "M556 S1 X0 Y0 Z0\n"), "s.g:1: error: S = 1; must be >= 10");
  EXPECT_EQ(fault_of(reprapfirmware, "M556 S100 X0 Y0 Z0 P1\n"),
            "s.g:1: error: 'P1' is not supported in M556");
  EXPECT_EQ(fault_of(reprapfirmware, "M556 S100 X0 X0 Y0 Z0\n"), "s.g:1: error: X appears twice");
  EXPECT_EQ(fault_of(klipper, "[skew_correction]\n"),
            "s.cfg: error: contains no profile [skew_correction NAME]");
  EXPECT_EQ(fault_of(klipper, "[skew_correction a]\nxy_skew = 0\n"),
            "s.cfg: error: [skew_correction] is missing");
  EXPECT_EQ(fault_of(klipper, "[skew_correction]\n[skew_correction a]\nxy_skew = 0\n"),
            "s.cfg:2: error: xz_skew is missing");
  EXPECT_EQ(fault_of(klipper, "[skew_correction]\n[skew_correction a]\nxy = 0\n"),
            "s.cfg:3: error: 'xy' is not supported");
  EXPECT_EQ(fault_of(klipper, "[printer]\n"), "s.cfg:1: error: '[printer]' is not supported");
}

}  // namespace
}  // namespace servomill::controllers::skew_table_test
