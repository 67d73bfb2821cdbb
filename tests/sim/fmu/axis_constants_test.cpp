/// The file of constants of an exported axis.
#include "sim/fmu/axis_constants.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "plant/vocabulary/checksum.h"
#include "plant/vocabulary/input_error.h"
#include "sim/model/scenario.h"
#include "tests/sim/fmu/exported.h"

namespace servomill::sim::fmu::axis_constants_test {
namespace {

std::string rich_text(int joint) {
  AxisConstants axis = exported_axis(rich_scenario(), joint, 7);
  axis.program = "0.1.0+0123";
  axis.case_name = "plain";
  return text_of(axis);
}

std::string message_of(const std::string& text) {
  try {
    read_axis_constants(text, "axis.txt");
  } catch (const InputError& e) {
    return e.what();
  }
  return "read";
}

std::string with_checksum(const std::string& text) {
  const std::string lines = text.substr(0, text.rfind("checksum"));
  return lines + fmt::format("checksum = {:016x}\n", crc64(lines));
}

TEST(AxisConstants, AreReadBackBitForBit) {
  for (int joint = 0; joint < kJoints; ++joint) {
    const std::string text = rich_text(joint);
    EXPECT_EQ(text_of(read_axis_constants(text, "axis.txt")), text);
  }
}

TEST(AxisConstants, KeepTheDriveAndTheLoops) {
  const model::Scenario scenario = rich_scenario();
  const AxisConstants axis = read_axis_constants(rich_text(1), "axis.txt");
  EXPECT_TRUE(axis.drive() == scenario.machine.drives[1]);
  EXPECT_EQ(axis.cascade().Kv, scenario.machine.nc.cascade[1].Kv);
  EXPECT_EQ(axis.machine.scale[1].read(0.0123, 77), scenario.machine.scale[1].read(0.0123, 77));
  EXPECT_EQ(axis.reading_delay, 7);
  EXPECT_EQ(axis.axis, "Y");
}

TEST(AxisConstants, AreRefusedWithAnyByteChanged) {
  const std::string text = rich_text(1);
  for (std::size_t n = 0; n < text.size(); n += 7) {
    std::string changed = text;
    changed[n] = static_cast<char>(changed[n] ^ 1);
    EXPECT_NE(message_of(changed), "read") << n;
  }
}

TEST(AxisConstants, NameTheLineThatIsNotAsWritten) {
  const std::string text = rich_text(0);
  EXPECT_EQ(message_of("servomill axis 0\n"),
            "axis.txt:1: error: must begin with 'servomill axis 2': it belongs to another version");
  std::string changed = text;
  changed.replace(changed.find("joint = 0"), 9, "joint = 9");
  EXPECT_EQ(message_of(changed),
            "axis.txt:1: error: its checksum is wrong: the file has been changed");
  EXPECT_EQ(message_of(with_checksum(changed)), "axis.txt:7: error: 'joint' is too large");
  changed = text;
  changed.replace(changed.find("drive.M = "), 10, "drive.M = x");
  EXPECT_EQ(message_of(with_checksum(changed)),
            "axis.txt:17: error: 'x750' is no value of 'drive.M'");
  EXPECT_EQ(message_of(with_checksum(text.substr(0, text.find("drive.M")))),
            "axis.txt:17: error: 'drive.M' is expected here");
}

TEST(AxisConstants, AreNotExportedWithCvode) {
  AxisConstants axis = exported_axis(rich_scenario(), 0, 0);
  EXPECT_EQ(why_not_exported(axis), "");
  axis.machine.integrator = model::Integrator::cvode;
  EXPECT_EQ(why_not_exported(axis),
            "its drives are integrated by CVODE, which an FMU does not contain; use integrator = "
            "\"exact\"");
}

}  // namespace
}  // namespace servomill::sim::fmu::axis_constants_test
