/// The file of constants of axes and of a whole machine.
#include "sim/fmu/machine_constants.h"

#include <gtest/gtest.h>

#include "plant/vocabulary/checksum.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/model/heat.h"
#include "sim/model/scenario.h"
#include "tests/sim/fmu/exported.h"

namespace servomill::sim::fmu::machine_constants_test {
namespace {

using plant::operator""_err;

MachineConstants axes_of(const std::vector<int>& joints) {
  const model::Scenario scenario = rich_scenario();
  MachineConstants out;
  for (const int joint : joints) out.axes.push_back(exported_axis(scenario, joint, 0));
  return out;
}

// Little is left out of its errors.
KinematicConstants rich_kinematics() {
  KinematicConstants out = exported_kinematics(rich_scenario());
  plant::incline(out.chain.at(Axis::B), {0.0, 1.0, 1.0});
  out.chain.at(Axis::C).centre = {0.1, 0.2, 0.3};
  out.errors.component("EYX"_err) = plant::polynomial({1e-6, 1.0 / 3.0}) +
                                    plant::harmonic(5e-6, 0.062, 0.1) +
                                    plant::linear_table({0.0, 0.1, 0.3}, {0.0, 1e-6, -1e-6});
  out.errors.component("EZX"_err) = plant::grid({.axes = {Axis::X, Axis::Z},
                                                 .at = {{0.0, 0.1, 0.2}, {-0.1, 0.1}},
                                                 .error = {0.0, 1e-6, 2e-6, 3e-6, 4e-6, 5e-6},
                                                 .interpolation = plant::GridInterpolation::cubic});
  out.errors.component("EXC"_err) = plant::grid(
      {.axes = {Axis::C}, .at = {{0.0, 1.0, 2.0}}, .error = {1e-6, 0.0, 1e-6}, .repeats = {true}});
  out.errors.location("EC0Y"_err) = 1.0 / 7.0;
  out.p_ST = {1e-3, 2e-3, -0.15};
  return out;
}

MachineConstants rich_machine() {
  MachineConstants machine = axes_of({0, 1, 2, 3, 4});
  machine.kinematics = rich_kinematics();
  return machine;
}

TEST(MachineConstants, OfAxesAreReadBackBitForBit) {
  const std::string text = text_of(axes_of({2, 0, 4}));
  const MachineConstants read = read_machine_constants(text, "axis.txt");
  EXPECT_EQ(text_of(read), text);
  EXPECT_FALSE(read.kinematics.has_value());
}

TEST(MachineConstants, OfAWholeMachineAreReadBackBitForBit) {
  const std::string text = text_of(rich_machine());
  const MachineConstants read = read_machine_constants(text, "axis.txt");
  EXPECT_EQ(text_of(read), text);
  const KinematicConstants written = rich_kinematics();
  EXPECT_TRUE(read.kinematics->errors == written.errors);
  EXPECT_TRUE(read.kinematics->chain.layout == written.chain.layout);
  EXPECT_EQ(read.kinematics->p_ST, written.p_ST);
  for (std::size_t n = 0; n < written.chain.axes.size(); ++n) {
    const plant::ChainAxis &a = read.kinematics->chain.axes[n], &b = written.chain.axes[n];
    EXPECT_TRUE(a.axis == b.axis && a.side == b.side && a.joint == b.joint && a.sense == b.sense);
    EXPECT_TRUE(a.centre == b.centre && a.R_MA == b.R_MA && a.is_inclined == b.is_inclined) << n;
  }
}

TEST(MachineConstants, AreRefusedWithAnyByteChanged) {
  const std::string text = text_of(rich_machine());
  for (std::size_t n = 0; n < text.size(); n += 131) {
    std::string changed = text;
    changed[n] = static_cast<char>(changed[n] ^ 1);
    EXPECT_THROW(read_machine_constants(changed, "axis.txt"), InputError) << n;
  }
}

TEST(MachineConstants, HaveATokenOfTheirOwn) {
  const std::string one = text_of(axes_of({0})), other = text_of(axes_of({1}));
  EXPECT_NE(token_of(one), token_of(other));
  EXPECT_EQ(token_of(one), token_of(one));
}

TEST(MachineConstants, AreNotExportedOfMachinesThatChangeOtherwise) {
  const KinematicConstants rigid = rich_kinematics();
  const model::MachineSettings machine = rich_scenario().machine;
  EXPECT_EQ(why_not_exported(rigid, machine), "");
  KinematicConstants loose = rigid;
  loose.errors.component("EYX"_err) = plant::reversal({2e-6}, 1e-4);
  EXPECT_EQ(why_not_exported(loose, machine),
            "its errors depend on the direction of travel, which an FMU does not contain");
  model::MachineSettings other = machine;
  other.heat = std::make_shared<const model::HeatSettings>();
  EXPECT_EQ(why_not_exported(rigid, other),
            "its errors change with temperature, which an FMU does not contain");
  other = machine;
  other.structural_modes.emplace_back();
  EXPECT_EQ(why_not_exported(rigid, other),
            "its structure vibrates, which an FMU does not contain");
  other = machine;
  other.inertial_compliances.emplace_back();
  EXPECT_EQ(why_not_exported(rigid, other),
            "its structure deflects under acceleration, which an FMU does not contain");
}

}  // namespace
}  // namespace servomill::sim::fmu::machine_constants_test
