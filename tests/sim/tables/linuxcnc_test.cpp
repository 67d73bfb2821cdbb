// LinuxCNC loads the file that is written for it, and then the axis is where it should be. The
// rules of loading and of use are those of LinuxCNC's sources (usrmotLoadComp in
// src/emc/motion/usrmotintf.cc, EMCMOT_SET_JOINT_COMP in command.c, compute_screw_comp and
// output_to_hal in control.c), restated by this test.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "plant/geometry/volumetric.h"
#include "sim/model/machine.h"
#include "sim/tables/table_export.h"
#include "tests/sim/tables/small_machine.h"

namespace servomill::sim::tables::linuxcnc_test {
namespace {

using plant::operator""_err;

constexpr std::size_t kMaxTriplets = 256;  // EMCMOT_COMP_SIZE
constexpr std::size_t kLineLength = 255;   // LINELEN, with the end of the line

struct JointCompensation {
  struct Triplet {
    double nominal, up, down;  // machine units: mm, deg
  };
  std::vector<Triplet> triplets;
  std::string complaint;

  // Stops at the first line that is no triplet, silently, as LinuxCNC does.
  JointCompensation(const std::string& text, int type) {
    std::istringstream in(text);
    std::string line;
    while (std::getline(in, line)) {
      double nominal = 0.0, up = 0.0, down = 0.0;
      EXPECT_LT(line.size() + 1, kLineLength);
      if (std::sscanf(line.c_str(), "%lf %lf %lf", &nominal, &up, &down) != 3) break;
      if (type == 0) up = nominal - up, down = nominal - down;
      if (triplets.size() >= kMaxTriplets) {
        complaint = "too many compensation entries";
      } else if (!triplets.empty() && nominal <= triplets.back().nominal) {
        complaint = "compensation values must increase";
      } else {
        triplets.push_back({nominal, up, down});
      }
    }
  }

  // Correction that is added to the command of the motor and taken off its feedback.
  double at(double position, double velocity) const {
    const auto trim = [&](const Triplet& t) { return velocity > 0.0 ? t.up : t.down; };
    if (position < triplets.front().nominal) return trim(triplets.front());
    std::size_t i = 0;
    while (i + 1 < triplets.size() && position >= triplets[i + 1].nominal) ++i;
    if (i + 1 == triplets.size()) return trim(triplets.back());
    const Triplet &a = triplets[i], &b = triplets[i + 1];
    return trim(a) + (trim(b) - trim(a)) / (b.nominal - a.nominal) * (position - a.nominal);
  }
};

std::size_t lines_in(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

plant::ErrorModel wavy_positioning() {
  plant::ErrorModel errors;
  errors.component("EXX"_err) =
      plant::polynomial({5.0 * um, 2e-4, 1e-3}) + plant::harmonic(10.0 * um, 60.0 * mm, 0.3);
  errors.component("EYY"_err) = plant::harmonic(20.0 * um, 150.0 * mm, 1.0);
  errors.component("EZZ"_err) = plant::polynomial({0.0, -1e-4});
  return errors;
}

class BothTypes : public testing::TestWithParam<int> {};

TEST_P(BothTypes, EveryLineIsLoaded) {
  TableRequest request = request_of(TableFormat::linuxcnc);
  request.comp_file_type = GetParam();
  request.spacing = 200.0 * mm / 255.0;  // 256 points
  const auto tables = export_tables(machine_of("[w X b Y Z t]"), wavy_positioning(), request);
  for (const char* name : {"joint_0_x.comp", "joint_1_y.comp", "joint_2_z.comp"}) {
    const std::string text = file_named(table_files(tables), name).text;
    const JointCompensation joint(text, GetParam());
    EXPECT_EQ(joint.complaint, "");
    EXPECT_EQ(joint.triplets.size(), kMaxTriplets);
    EXPECT_EQ(lines_in(text), kMaxTriplets);
  }
}

// The tip in every place of the three lines, moving up and down: what stays is what the report
// says of interpolation, within the digits of the file.
TEST_P(BothTypes, TheAxisStandsWhereTheCommandSays) {
  constexpr double kDigits = 1.1e-9;  // m, value and position are written with 1e-6 mm
  TableRequest request = request_of(TableFormat::linuxcnc);
  request.comp_file_type = GetParam();
  request.spacing = 5.0 * mm;
  const model::MachineSettings machine = machine_of("[w X b Y Z t]");
  const auto tables = export_tables(machine, wavy_positioning(), request);
  const auto files = table_files(tables);
  const plant::VolumetricModel actual(machine.chain, wavy_positioning());
  const std::array<const char*, 3> names = {"joint_0_x.comp", "joint_1_y.comp", "joint_2_z.comp"};
  ASSERT_EQ(tables.tables.size(), 3U);
  for (int j = 0; j < kLinearJoints; ++j) {
    const JointCompensation joint(file_named(files, names[static_cast<std::size_t>(j)]).text,
                                  GetParam());
    double worst = 0.0, without = 0.0;
    for (int n = 0; n <= 1000; ++n) {
      Joints Q = tables.source.reference;
      Q[j] = machine.nc.lower[j] + (machine.nc.upper[j] - machine.nc.lower[j]) * n / 1000.0;
      for (const double velocity : {1.0, -1.0}) {
        Joints motor = Q + tables.base;
        motor[j] += joint.at(Q[j] / mm, velocity) * mm;
        const Eigen::Vector3d p = actual.forward(motor, Eigen::Vector3d::Zero()).p_WT;
        worst = std::max(worst, std::abs(p[j] - Q[j]));
        const Eigen::Vector3d off = actual.forward(Q + tables.base, Eigen::Vector3d::Zero()).p_WT;
        without = std::max(without, std::abs(off[j] - Q[j]));
      }
    }
    const double promised = tables.tables[static_cast<std::size_t>(j)].residual;
    EXPECT_LE(worst, promised + kDigits) << names[static_cast<std::size_t>(j)];
    EXPECT_GT(without, 10.0 * um);
    EXPECT_LT(promised, without / 15.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Linuxcnc, BothTypes, testing::Values(0, 1));

// A rotary joint: tip and tool axis, whichever way the coordinate counts.
TEST(Linuxcnc, TurnsARotaryAxisToWhereTheCommandSays) {
  constexpr double kDigits = 1e-9;  // rad
  plant::ErrorModel errors;
  errors.component("ECC"_err) = plant::harmonic(50.0 * urad, 120.0 * deg);
  for (const plant::Sense sense : {plant::Sense::tool, plant::Sense::table}) {
    model::MachineSettings machine = machine_of("[w C' X b Y Z t]");
    machine.chain.at(Axis::C).sense = sense;
    const auto tables = export_tables(machine, errors, request_of(TableFormat::linuxcnc));
    const JointCompensation joint(file_named(table_files(tables), "joint_3_c.comp").text, 0);
    EXPECT_EQ(joint.complaint, "");
    EXPECT_TRUE(tables.left.empty());
    const plant::VolumetricModel actual(machine.chain, errors);
    const int c = *machine.chain.layout.joint_of(Axis::C);
    const Eigen::Vector3d p_ST(0.0, 0.0, -0.1);
    double worst = 0.0;
    for (int n = 0; n <= 360; ++n) {
      Joints Q = Joints::Zero();
      Q.head<3>() << 1.0, 0.0, 0.1;  // 1 m off the axis: 1 m/rad
      Q[c] = n * deg;
      Joints motor = Q + tables.base;
      motor[c] += joint.at(Q[c] / deg, 1.0) * deg;
      const Eigen::Vector3d nominal = plant::forward(machine.chain, Q, p_ST).p_WT;
      worst = std::max(worst, (actual.forward(motor, p_ST).p_WT - nominal).norm());
    }
    ASSERT_EQ(tables.tables.size(), 1U);
    EXPECT_LE(worst, tables.tables.front().residual + kDigits);
    EXPECT_LT(tables.tables.front().residual, 1.0 * urad);
  }
}

// Positions of an endless joint are not taken back into one turn.
TEST(Linuxcnc, SaysThatATableIsNotRepeated) {
  plant::ErrorModel errors;
  errors.component("ECC"_err) = plant::harmonic(50.0 * urad, 120.0 * deg);
  const auto lines = report(
      export_tables(machine_of("[w C' X b Y Z t]"), errors, request_of(TableFormat::linuxcnc)));
  const std::string note =
      "note: C over C: the control does not repeat the table: beyond 0 and 360 deg the end values "
      "apply";
  EXPECT_EQ(std::count(lines.begin(), lines.end(), note), 1);
}

// LinuxCNC corrects only errors of an axis over itself: the rest is named.
TEST(Linuxcnc, NamesWhatItCannotHold) {
  plant::ErrorModel errors = wavy_positioning();
  errors.component("EYX"_err) = plant::harmonic(30.0 * um, 100.0 * mm);
  errors.location("EC0Y"_err) = 40.0 * urad;
  errors.component("EAZ"_err) = plant::polynomial({0.0, 1e-4});  // 20 urad at z = 200 mm
  const auto tables =
      export_tables(machine_of("[w X b Y Z t]"), errors, request_of(TableFormat::linuxcnc));
  ASSERT_EQ(tables.left.size(), 3U);
  EXPECT_EQ(tables.left[0].name, "EYX"_err);
  EXPECT_NEAR(tables.left[0].size, 30.0 * um, 0.001 * um);  // samples of a sine
  EXPECT_NEAR(tables.left[0].tip, 30.0 * um, 0.02 * um);
  EXPECT_EQ(tables.left[1].name, "EC0Y"_err);
  // 100 mm from the reference
  EXPECT_NEAR(tables.left[1].tip, 40.0 * urad * 100.0 * mm, 0.001 * um);
  EXPECT_EQ(tables.left[2].name, "EAZ"_err);
  EXPECT_NEAR(tables.left[2].size, 20.0 * urad, 1e-12);
  EXPECT_NEAR(tables.left[2].tool_axis, 20.0 * urad, 1e-9);
}

}  // namespace
}  // namespace servomill::sim::tables::linuxcnc_test
