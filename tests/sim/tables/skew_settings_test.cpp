// Skew corrections of firmwares make the axes of the machine move at right angles.
#include "sim/tables/skew_settings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "controllers/tables/skew_table.h"
#include "plant/geometry/volumetric.h"
#include "sim/model/machine.h"
#include "tests/sim/tables/rich_tables.h"

namespace servomill::sim::tables::skew_settings_test {
namespace {

using Eigen::Vector3d;

constexpr std::array<TableFormat, 3> kFirmwares = {TableFormat::marlin, TableFormat::klipper,
                                                   TableFormat::reprapfirmware};

std::string last_lines(const plant::ErrorModel& errors, TableFormat format) {
  const auto files =
      table_files(export_tables(machine_of("[w Y b X Z t]"), errors, request_of(format)));
  std::string text = files.at(0).text, out;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string line = text.substr(0, end + 1);
    if (line.front() != '#' && line.front() != ';') out += line;
    text.erase(0, end + 1);
  }
  return out;
}

// EC0Y > 0: Y leans towards -X, the angle of X and Y is obtuse, for which M556 takes a positive X.
TEST(SkewSettings, SignsOfTheFirmwares) {
  plant::ErrorModel errors;
  errors.location("EC0Y"_err) = 200.0 * urad;
  EXPECT_EQ(last_lines(errors, TableFormat::marlin), "M852 I-0.00020000 J0.00000000 K0.00000000\n");
  EXPECT_EQ(last_lines(errors, TableFormat::reprapfirmware),
            "M556 S100 X0.020000 Y0.000000 Z0.000000\n");
  errors = {};
  errors.location("EB0Z"_err) = 100.0 * urad;  // Z leans towards +X
  errors.location("EA0Z"_err) = 50.0 * urad;   // and -Y
  EXPECT_EQ(last_lines(errors, TableFormat::klipper),
            "[skew_correction]\n\n[skew_correction test]\nxy_skew = 0.00000000\n"
            "xz_skew = 0.00010000\nyz_skew = -0.00005000\n");
  EXPECT_EQ(last_lines(errors, TableFormat::reprapfirmware),
            "M556 S100 X0.000000 Y0.005000 Z-0.010000\n");
}

plant::ErrorModel skewed(double size) {
  plant::ErrorModel errors;
  errors.location("EC0X"_err) = 0.5 * size;
  errors.location("EB0X"_err) = -0.3 * size;
  errors.location("EC0Y"_err) = -1.0 * size;
  errors.location("EA0Y"_err) = 0.4 * size;
  errors.location("EA0Z"_err) = 0.7 * size;
  errors.location("EB0Z"_err) = -0.6 * size;
  return errors;
}

// Side and diagonals of squares that the machine draws, and the formula of Klipper's SET_SKEW.
TEST(SkewSettings, KlippersOwnMeasurementGivesTheSame) {
  const model::MachineSettings machine = machine_of("[w Y b X Z t]");
  const plant::ErrorModel errors = skewed(300.0 * urad);
  const TableExport e = export_tables(machine, errors, request_of(TableFormat::klipper));
  const auto setting = controllers::read_skew_table({"s", table_files(e).at(0).text},
                                                    controllers::SkewFirmware::klipper);
  const plant::VolumetricModel actual(machine.chain, errors);
  const auto factor = [&](int i, int j) {
    const auto corner = [&](double p, double q) -> Vector3d {
      Joints Q = Joints::Zero();
      Q[i] = p;
      Q[j] = q;
      return actual.forward(Q, Vector3d::Zero()).p_WT;
    };
    const double L = 0.1;  // m
    const double ac = (corner(L, L) - corner(0, 0)).norm(),
                 bd = (corner(0, L) - corner(L, 0)).norm();
    const double ad = (corner(L, 0) - corner(0, 0)).norm();
    const double side = std::sqrt(2 * ac * ac + 2 * bd * bd - 4 * ad * ad) / 2;
    return std::tan(std::numbers::pi / 2 -
                    std::acos((ac * ac - side * side - ad * ad) / (2 * side * ad)));
  };
  EXPECT_NEAR(setting.xy, factor(0, 1), 1.1e-8);  // digits of 1e-8
  EXPECT_NEAR(setting.xz, factor(0, 2), 1.1e-8);
  EXPECT_NEAR(setting.yz, factor(1, 2), 0.2e-6);  // Klipper neglects xy xz: 450 urad x 270 urad
}

TEST(SkewSettings, MachinesOfAnyOrderMoveAtRightAngles) {
  for (const char* structure : {"[w b X Y Z t]", "[w X Y b Z t]", "[w C' Y b X Z t]"}) {
    for (const double size : {20e-6, 300e-6, 5e-3}) {
      for (const TableFormat format : kFirmwares) {
        const TableExport e =
            export_tables(machine_of(structure), skewed(size), request_of(format));
        EXPECT_EQ(fault_of(e, table_files(e)), "verified") << structure << name_of(format) << size;
        EXPECT_LT(verify_tables(e, table_files(e)).angle, 1e-8);
        // within 0.4 m only the lengths of second order remain, and digits
        EXPECT_LT(e.skew->volume.after, 0.4 * 4.0 * size * size + 10e-9);
        EXPECT_GT(e.skew->volume.before, 0.05 * size);
      }
    }
  }
}

TEST(SkewSettings, AChangedDigitIsFound) {
  for (const TableFormat format : kFirmwares) {
    const TableExport e =
        export_tables(machine_of("[w Y b X Z t]"), skewed(300.0 * urad), request_of(format));
    const auto files = table_files(e);
    const std::string& text = files[0].text;
    std::size_t changed = 0;
    bool is_comment = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (i == 0 || text[i - 1] == '\n') is_comment = text[i] == '#' || text[i] == ';';
      // the last two digits of a number are within the tolerance
      const bool inside = i + 3 < text.size() && std::isdigit(text[i]) &&
                          std::isdigit(text[i + 1]) && std::isdigit(text[i + 2]);
      if (is_comment || !inside || text.compare(i - 1, 4, "M852") == 0 ||
          text.compare(i - 1, 4, "M556") == 0) {
        continue;
      }
      auto mutant = files;
      mutant[0].text[i] = text[i] == '5' ? '6' : '5';
      EXPECT_NE(fault_of(e, mutant), "verified") << name_of(format) << " " << mutant[0].text;
      ++changed;
    }
    EXPECT_GT(changed, 12U);
  }
}

TEST(SkewSettings, ReportsWhatItDoesNotHold) {
  plant::ErrorModel errors = skewed(300.0 * urad);
  errors.component("EXX"_err) = plant::polynomial({0.0, 1e-4});
  const auto lines =
      report(export_tables(machine_of("[w Y b X Z t]"), errors, request_of(TableFormat::marlin)));
  const auto has = [&](const std::string& start) {
    return std::any_of(lines.begin(), lines.end(),
                       [&](const std::string& line) { return line.starts_with(start); });
  };
  EXPECT_TRUE(has("not in this correction: EXX"));
  EXPECT_TRUE(has("note: X keeps its direction; the frame is rotated by A "));
  try {
    export_tables(machine_of("[w Y b X Z t]"), reversal_of_x(), request_of(TableFormat::klipper));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.faults().front().message,
              "klipper cannot represent any part of this error model: X, Y and Z are at right "
              "angles; it represents EC0Y, EB0Z, EA0Z and the like");
  }
}

}  // namespace
}  // namespace servomill::sim::tables::skew_settings_test
