// Tables over single axes: the errors that they hold and leave, and when they are refused.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <sstream>

#include "plant/geometry/volumetric.h"
#include "plant/vocabulary/input_error.h"
#include "sim/model/machine.h"
#include "sim/tables/compensation_tables.h"
#include "sim/tables/table_export.h"
#include "tests/pattern.h"
#include "tests/sim/tables/small_machine.h"

namespace servomill::sim::tables::table_export_test {
namespace {

using plant::operator""_err;

constexpr double kSecondOrder = 0.02 * um;  // products of two errors: 40 um x 2e-4, both ways

std::string refusal(const model::MachineSettings& machine, const plant::ErrorModel& errors,
                    const TableRequest& request) {
  try {
    export_tables(machine, errors, request);
  } catch (const InputError& error) {
    return error.faults().front().message;
  }
  return "";
}

plant::ErrorModel without_angles() {
  plant::ErrorModel errors;
  errors.component("EXX"_err) = plant::harmonic(8.0 * um, 90.0 * mm);
  errors.component("EYX"_err) = plant::harmonic(10.0 * um, 120.0 * mm, 0.4);
  errors.component("EZX"_err) = plant::polynomial({0.0, 1e-4, 5e-4});
  errors.component("EXY"_err) = plant::polynomial({0.0, 0.0, -4e-4});
  errors.component("EYY"_err) = plant::harmonic(5.0 * um, 200.0 * mm, 2.0);
  errors.component("EZY"_err) = plant::harmonic(6.0 * um, 170.0 * mm);
  errors.component("EXZ"_err) = plant::polynomial({2.0 * um, 0.0, 3e-4});
  errors.component("EYZ"_err) = plant::harmonic(7.0 * um, 130.0 * mm, 1.0);
  errors.component("EZZ"_err) = plant::polynomial({0.0, -5e-5});
  errors.location("EC0Y"_err) = 50.0 * urad;
  errors.location("EA0Z"_err) = 40.0 * urad;
  errors.location("EB0Z"_err) = -20.0 * urad;
  return errors;
}

// The tables of a control: of each axis over each, at equidistant points.
struct ReadTable {
  double first = 0.0, step = 1.0;  // m
  std::map<int, double> value;     // m
  double at(double q) const {
    const int last = static_cast<int>(value.size()) - 1;
    const double u = std::clamp((q - first) / step, 0.0, static_cast<double>(last));
    const int i = std::min(static_cast<int>(u), last - 1);
    return value.at(i) + (u - i) * (value.at(i + 1) - value.at(i));
  }
};
using ReadTables = std::map<std::pair<int, int>, ReadTable>;  // {output, input}

int joint_of_letter(char letter) { return static_cast<int>(std::string("XYZ").find(letter)); }

// Displacement of the axes of a SINUMERIK: the setpoint gets what $AN_CEC says; an axis whose
// actual value counts $AA_ENC_COMP more stops so much earlier.
ReadTables read_siemens(const std::vector<TextFile>& files) {
  ReadTables own, cross;
  std::map<int, ReadTable> by_index;
  std::map<int, std::pair<int, int>> axes;
  static const Pattern kOwn(R"(\$AA_ENC_COMP\[0,(\d+),([XYZ])1\]=(\S+))"),
      kOwnKey(R"(\$AA_ENC_COMP_(STEP|MIN)\[0,([XYZ])1\]=(\S+))"),
      kCross(R"(\$AN_CEC\[(\d+),(\d+)\]=(\S+))"),
      kCrossKey(R"(\$AN_CEC_(STEP|MIN)\[(\d+)\]=(\S+))"),
      kAxis(R"(\$AN_CEC_(INPUT|OUTPUT)_AXIS\[(\d+)\]=\(([XYZ])1\))");
  for (const TextFile& file : files) {
    std::istringstream in(file.text);
    std::string line;
    std::vector<std::string> m;
    while (std::getline(in, line)) {
      if (m = kOwn.parts_of(line); !m.empty()) {
        const int j = joint_of_letter(m[2][0]);
        own[{j, j}].value[std::stoi(m[1])] = -std::stod(m[3]) * mm;
      } else if (m = kOwnKey.parts_of(line); !m.empty()) {
        const int j = joint_of_letter(m[2][0]);
        (m[1] == "STEP" ? own[{j, j}].step : own[{j, j}].first) = std::stod(m[3]) * mm;
      } else if (m = kCross.parts_of(line); !m.empty()) {
        by_index[std::stoi(m[1])].value[std::stoi(m[2])] = std::stod(m[3]) * mm;
      } else if (m = kCrossKey.parts_of(line); !m.empty()) {
        ReadTable& table = by_index[std::stoi(m[2])];
        (m[1] == "STEP" ? table.step : table.first) = std::stod(m[3]) * mm;
      } else if (m = kAxis.parts_of(line); !m.empty()) {
        auto& [output, input] = axes[std::stoi(m[2])];
        (m[1] == "INPUT" ? input : output) = joint_of_letter(m[3][0]);
      }
    }
  }
  for (const auto& [index, table] : by_index) own[axes.at(index)] = table;
  return own;
}

// Listings X.COM, Y.COM, ...: [column] = F(X), the error that the axis must not make.
ReadTables read_heidenhain(const std::vector<TextFile>& files) {
  ReadTables tables;
  for (const TextFile& file : files) {
    if (file.name.substr(1) != ".COM.txt") continue;
    const int input = joint_of_letter(file.name[0]);
    std::istringstream in(file.text);
    std::string line, word;
    std::getline(in, line);
    std::istringstream head(line);
    std::vector<int> outputs;
    head >> word;
    EXPECT_EQ(word, "AXISPOS");
    while (head >> word) outputs.push_back(joint_of_letter(word[0]));
    for (int row = 0; std::getline(in, line); ++row) {
      std::istringstream numbers(line);
      double position = 0.0, value = 0.0;
      numbers >> position;
      for (const int output : outputs) {
        ReadTable& table = tables[{output, input}];
        if (row == 0) table.first = position * mm;
        if (row == 1) table.step = position * mm - table.first;
        EXPECT_TRUE(numbers >> value);
        table.value[row] = -value * mm;
      }
    }
  }
  return tables;
}

Joints corrected(const ReadTables& tables, const Joints& Q) {
  Joints out = Q;
  for (const auto& [axes, table] : tables) out[axes.first] += table.at(Q[axes.second]);
  return out;
}

double promised(const TableExport& tables) {
  double sum = 0.0;
  for (const CompensationTable& table : tables.tables) sum += table.residual;
  return sum;
}

struct Control {
  TableFormat format;
  ReadTables (*read)(const std::vector<TextFile>&);
};

class CrossFormats : public testing::TestWithParam<Control> {};

// Positioning, straightness and squareness are functions of one axis each: the tables correct them
// in the whole of the travel.
TEST_P(CrossFormats, CorrectAllPoseErrorsWithoutAnglesEverywhere) {
  const model::MachineSettings machine = machine_of("[w X b Y Z t]");
  TableRequest request = request_of(GetParam().format);
  request.tool_length = 50.0 * mm;
  const auto tables = export_tables(machine, without_angles(), request);
  EXPECT_TRUE(tables.left.empty());
  ASSERT_EQ(tables.tables.size(), 9U);
  const ReadTables read = GetParam().read(table_files(tables));
  ASSERT_EQ(read.size(), 9U);

  const plant::VolumetricModel actual(machine.chain, without_angles());
  std::mt19937 random(5);
  double before = 0.0, after = 0.0;
  for (int n = 0; n < 2000; ++n) {
    Joints Q = Joints::Zero();
    for (int j = 0; j < kLinearJoints; ++j) {
      const double share = static_cast<double>(random()) / static_cast<double>(random.max());
      Q[j] = machine.nc.lower[j] + share * (machine.nc.upper[j] - machine.nc.lower[j]);
    }
    const Eigen::Vector3d nominal = plant::forward(machine.chain, Q, tables.source.p_ST).p_WT;
    const auto off = [&](const Joints& at) {
      return (actual.forward(at, tables.source.p_ST).p_WT - nominal).norm();
    };
    before = std::max(before, off(Q + tables.base));
    after = std::max(after, off(corrected(read, Q + tables.base)));
  }
  EXPECT_GT(before, 25.0 * um);
  EXPECT_LE(after, promised(tables) + kSecondOrder);
  EXPECT_LT(after, before / 40.0);
  EXPECT_GE(tables.volume.before, 0.95 * before);
}

INSTANTIATE_TEST_SUITE_P(TableExport, CrossFormats,
                         testing::Values(Control{TableFormat::siemens, read_siemens},
                                         Control{TableFormat::heidenhain, read_heidenhain}));

// An angle that grows along X moves the tip by the product of two coordinates, of which lines know
// nothing: k (x - x0) (y - y0) stays, and the tilt of the tool.
TEST(TableExport, AnglesAreHeldOnTheLinesOnly) {
  constexpr double k = 2e-4;  // rad/m
  plant::ErrorModel errors;
  errors.component("ECX"_err) = plant::polynomial({0.0, k});
  errors.component("EAX"_err) = plant::polynomial({0.0, k});
  const auto tables =
      export_tables(machine_of("[w X b Y Z t]"), errors, request_of(TableFormat::siemens));
  ASSERT_EQ(tables.left.size(), 2U);
  EXPECT_EQ(tables.left[0].name, "EAX"_err);
  EXPECT_EQ(tables.left[1].name, "ECX"_err);
  // table [w X b ...]: the error acts on the tool side seen from the table, which turns about its
  // own centre; 100 mm from the reference in X, Y and Z
  EXPECT_NEAR(tables.left[1].tip, k * 0.1 * 0.1, 0.001 * um);
  EXPECT_NEAR(tables.left[0].tip, k * 0.1 * std::hypot(0.1, 0.1), 0.001 * um);
  EXPECT_NEAR(tables.left[0].tool_axis, k * 0.1, 1e-9);
  EXPECT_NEAR(tables.left[1].tool_axis, 0.0, 1e-9);  // turns about itself
}

// Errors of a rotary table other than its positioning are no functions of one axis in machine axes.
TEST(TableExport, RotaryAndLocationErrorsOfFiveAxesAreLeftByName) {
  plant::ErrorModel errors;
  errors.component("EXC"_err) = plant::harmonic(4.0 * um, 360.0 * deg);
  errors.component("ECC"_err) = plant::harmonic(15.0 * urad, 90.0 * deg);
  errors.location("EY0C"_err) = 8.0 * um;
  errors.location("EA0C"_err) = 25.0 * urad;
  errors.component("EXX"_err) = plant::harmonic(8.0 * um, 90.0 * mm);
  const auto tables =
      export_tables(machine_of("[w C' X b Y Z t]"), errors, request_of(TableFormat::siemens));
  std::string names;
  for (const TableResidual& one : tables.left) names += to_string(one.name) + " ";
  EXPECT_EQ(names, "EXC EY0C EA0C ");
}

// |f - its chord| of a parabola c x^2 is c h^2 / 4.
TEST(TableExport, InterpolationLeavesWhatTheClosedFormSays) {
  constexpr double c = 1e-3, h = 10.0 * mm;
  constexpr double kRounding = 0.001 * um;  // 1e-6 mm, of two points
  plant::ErrorModel errors;
  errors.component("EYX"_err) = plant::polynomial({0.0, 0.0, c});
  TableRequest request = request_of(TableFormat::siemens);
  request.spacing = h;
  const auto tables = export_tables(machine_of("[w X b Y Z t]"), errors, request);
  ASSERT_EQ(tables.tables.size(), 1U);
  EXPECT_NEAR(tables.tables.front().residual, c * h * h / 4.0, kRounding);
}

TEST(TableExport, CsvHoldsEveryErrorByItsName) {
  plant::ErrorModel errors = without_angles();
  errors.component("EAX"_err) = plant::polynomial({0.0, 3e-5});
  TableRequest request = request_of(TableFormat::csv);
  request.spacing = 4.0 * mm;
  const auto files = table_files(export_tables(machine_of("[w X b Y Z t]"), errors, request));
  std::istringstream in(file_named(files, "x.csv").text);
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "X_mm,EXX_um,EYX_um,EZX_um,EAX_urad");
  constexpr double kDigits = 0.5001e-4;  // um, urad
  int rows = 0;
  for (; std::getline(in, line); ++rows) {
    double x = 0.0, xx = 0.0, yx = 0.0, zx = 0.0, ax = 0.0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf", &x, &xx, &yx, &zx, &ax), 5);
    EXPECT_DOUBLE_EQ(x, -100.0 + 4.0 * rows);
    EXPECT_NEAR(xx, errors.component("EXX"_err).value(x * mm) / um, kDigits);
    EXPECT_NEAR(yx, errors.component("EYX"_err).value(x * mm) / um, kDigits);
    EXPECT_NEAR(zx, errors.component("EZX"_err).value(x * mm) / um, kDigits);
    EXPECT_NEAR(ax, errors.component("EAX"_err).value(x * mm) / urad, kDigits);
  }
  EXPECT_EQ(rows, 51);
  EXPECT_EQ(file_named(files, "locations.csv").text,
            "error,value,unit\nEC0Y,50.0000,urad\nEA0Z,40.0000,urad\nEB0Z,-20.0000,urad\n");
}

TEST(TableExport, UsualSpacingIsTheSmallestThatFits) {
  const auto spacing = [](TableFormat format) {
    return export_tables(machine_of("[w X b Y Z t]"), without_angles(), request_of(format))
        .lines.front()
        .spacing;
  };
  EXPECT_DOUBLE_EQ(spacing(TableFormat::linuxcnc), 1.0 * mm);       // 201 points
  EXPECT_DOUBLE_EQ(spacing(TableFormat::siemens), 2.0 * mm);        // 201 are too many
  EXPECT_DOUBLE_EQ(spacing(TableFormat::heidenhain), 0.8192 * mm);  // 0.4096 gives 490
}

// 256 points fit, 257 do not.
TEST(TableExport, RefusesMorePointsThanTheControlTakes) {
  TableRequest request = request_of(TableFormat::linuxcnc);
  request.spacing = 200.0 * mm / 255.0;
  EXPECT_EQ(refusal(machine_of("[w X b Y Z t]"), without_angles(), request), "");
  request.spacing = 200.0 * mm / 256.0;
  EXPECT_EQ(refusal(machine_of("[w X b Y Z t]"), without_angles(), request),
            "table over X: 257 points, 0.78125 mm apart, from -100 to 100 mm; at most 256 points "
            "are allowed; the smallest spacing that fits is 0.7844 mm");
}

TEST(TableExport, RefusesAnEndlessLinearAxis) {
  model::MachineSettings machine = machine_of("[w X b Y Z t]");
  machine.nc.upper[1] = std::numeric_limits<double>::infinity();
  TableRequest request = request_of(TableFormat::linuxcnc);
  EXPECT_EQ(refusal(machine, without_angles(), request),
            "axis Y has no travel; set --travel Y=FROM:TO");
  request.axes[1].from = -50.0 * mm;
  request.axes[1].to = 150.0 * mm;
  EXPECT_EQ(refusal(machine, without_angles(), request), "");
}

TEST(TableExport, RefusesAModelOfWhichTheFormatHoldsNothing) {
  plant::ErrorModel errors;
  errors.component("EYX"_err) = plant::harmonic(10.0 * um, 120.0 * mm);
  EXPECT_EQ(
      refusal(machine_of("[w X b Y Z t]"), errors, request_of(TableFormat::linuxcnc)),
      "linuxcnc tables over the selected axes cannot represent any part of the error model 'test'");
  EXPECT_EQ(refusal(machine_of("[w X b Y Z t]"), errors, request_of(TableFormat::siemens)), "");
}

// Over Y alone, what comes from X stays.
TEST(TableExport, CountsAxesWithoutTablesAsLeft) {
  TableRequest request = request_of(TableFormat::siemens);
  request.axes[0].wanted = request.axes[2].wanted = false;
  const auto tables = export_tables(machine_of("[w X b Y Z t]"), without_angles(), request);
  std::string names;
  for (const TableResidual& one : tables.left) names += to_string(one.name) + " ";
  EXPECT_EQ(names, "EXX EYX EZX EXZ EYZ EZZ EA0Z EB0Z ");
}

// Entries of a rotary axis lie within 0..360 deg: those beyond the travel stand for angles below 0.
TEST(TableExport, HeidenhainTurnsNegativeAnglesIntoOneTurn) {
  model::MachineSettings machine = machine_of("[w B' X b Y Z t]");
  const int b = *machine.chain.layout.joint_of(Axis::B);
  machine.nc.lower[b] = -120.0 * deg;
  machine.nc.upper[b] = 90.0 * deg;
  plant::ErrorModel errors;
  errors.component("EBB"_err) = plant::polynomial({0.0, 1e-4});  // no function of one turn
  const auto tables = export_tables(machine, errors, request_of(TableFormat::heidenhain));
  ASSERT_EQ(tables.tables.size(), 1U);
  const CompensationTable& table = tables.tables.front();
  EXPECT_EQ(table.line.first, 0.0);
  EXPECT_NEAR(table.at(300.0 * deg), -60.0 * deg * 1e-4, 1e-6);
  EXPECT_NEAR(table.at(60.0 * deg), 60.0 * deg * 1e-4, 1e-6);
  EXPECT_LT(table.residual, 1e-7);  // rad, rounding to 1e-5 deg
}

}  // namespace
}  // namespace servomill::sim::tables::table_export_test
