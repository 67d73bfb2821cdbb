// Machine files: with drives for simulations, without for programs and tables of a real machine.
#include "sim/input/read_machine.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "plant/vocabulary/units.h"
#include "sim/input/machine_description.h"

namespace servomill::sim::input::read_machine_test {
namespace {

using plant::operator""_err;

std::string written(const std::string& name, const std::string& text) {
  const std::string path = testing::TempDir() + std::to_string(getpid()) + "_" + name;
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

const std::string kTenLines =
    "name = \"router\"\n"
    "structure = \"[w b X Y Z (C1) t]\"\n"
    "[axis.X]\n"
    "travel_mm = [0, 1000]\n"
    "[axis.Z]\n"
    "travel_mm = [-150, 0]\n"
    "retract_mm = -1.5\n"
    "[errors.measured]\n"
    "EXX = { um_per_m = 200.0 }\n"
    "EC0Y = \"0.2 mm/m\"\n";

std::string refusal(const std::string& text) {
  try {
    read_machine_description(written("refused.toml", text));
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(what.find("refused.toml"));
  }
  return "taken";
}

TEST(MachineDescription, NeedsStructureTravelAndErrorsOnly) {
  const MachineDescription router = read_machine_description(written("ten.toml", kTenLines));
  EXPECT_FALSE(router.has_drives);
  EXPECT_EQ(router.machine->name, "router");
  EXPECT_EQ(router.machine->nc.upper[0], 1.0);
  EXPECT_EQ(router.machine->nc.lower[2], -0.15);
  EXPECT_TRUE(std::isinf(router.machine->nc.upper[1]));  // no travel given: no limit known
  EXPECT_DOUBLE_EQ(router.retract_Z.value(), -1.5 * mm);
  ASSERT_TRUE(router.errors.contains("measured"));
  EXPECT_DOUBLE_EQ(router.errors.at("measured").location("EC0Y"_err), 0.2e-3);
}

TEST(MachineDescription, SaysWhatIsWrongWithWhatItNeedsAndNothingOfDrives) {
  EXPECT_EQ(refusal("structure = \"[w b X Y Z (C1) t]\"\n[axis.X]\ntravel_m = [0, 1]\n"),
            "refused.toml:3:1: error: axis.X.travel_m is not known; did you mean 'travel_mm'?");
  EXPECT_EQ(refusal("name = \"router\"\n"), "refused.toml: error: structure is missing");
}

TEST(MachineDescription, ReadsAFileWithDrivesAsASimulationDoes) {
  const std::string router = SERVOMILL_SOURCE_DIR "/scenarios/machines/router_3axis.toml";
  const MachineDescription read = read_machine_description(router, {"axis.Z.retract_mm=-2"});
  EXPECT_TRUE(read.has_drives);
  EXPECT_TRUE(read.errors.contains("measured"));
  EXPECT_DOUBLE_EQ(read.retract_Z.value(), -2 * mm);
  EXPECT_GT(read.machine->drives[0].Kt, 0.0);
}

TEST(MachineDescription, TakesSquarenessAsASlope) {
  const auto angle = [](const std::string& value) {
    return read_machine_description(written("slope.toml",
                                            "structure = \"[w b X Y Z (C1) t]\"\n"
                                            "[errors.e]\nEC0Y = \"" +
                                                value + "\"\n"))
        .errors.at("e")
        .location("EC0Y"_err);
  };
  EXPECT_DOUBLE_EQ(angle("0.2 mm/m"), 200e-6);
  EXPECT_DOUBLE_EQ(angle("-50 um/m"), -50e-6);
  EXPECT_DOUBLE_EQ(angle("50 urad"), 50e-6);
}

}  // namespace
}  // namespace servomill::sim::input::read_machine_test
