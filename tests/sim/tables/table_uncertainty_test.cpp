/// Tables of identified errors: their uncertainty, and what is not determined.
#include "sim/tables/table_uncertainty.h"

#include <gtest/gtest.h>

#include "sim/model/machine.h"
#include "sim/model/tip_uncertainty.h"
#include "sim/tables/mesh_settings.h"
#include "sim/tables/skew_settings.h"
#include "tests/sim/tables/small_machine.h"
#include "tests/text.h"

namespace servomill::sim::tables::table_uncertainty_test {
namespace {

using plant::operator""_err;

// EXX = scale x +- 3 um/m (standard), EZX = bow x^2, EC0Y and EB0Z: squarenesses.
class Identified : public testing::Test {
 protected:
  Identified() {
    errors_.component("EXX"_err) = plant::polynomial({0.0, kScale});
    errors_.component("EZX"_err) = plant::polynomial({0.0, 0.0, kBow});
    errors_.location("EC0Y"_err) = kXY;
    errors_.location("EB0Z"_err) = kXZ;
    identified_.model = "test";
  }

  // A number g that scatters: the error is g times a shape.
  void know(const plant::ErrorName& name, const plant::ErrorFunction& shape, double g,
            double deviation) {
    identified_.parts.push_back(
        {{name, scaled(shape, g + deviation), scaled(shape, g - deviation)}});
    const auto n = Eigen::Index(identified_.parts.size());
    identified_.correlation = Eigen::MatrixXd::Identity(n, n);
  }

  // All of them, with these standard deviations.
  void know_all(double bow, double xz) {
    know("EXX"_err, plant::polynomial({0.0, 1.0}), kScale, 3e-6);
    know("EZX"_err, plant::polynomial({0.0, 0.0, 1.0}), kBow, bow);
    know("EC0Y"_err, plant::constant(1.0), kXY, 2e-6);
    know("EB0Z"_err, plant::constant(1.0), kXZ, xz);
  }

  TableRequest request(TableFormat format) const {
    TableRequest out = request_of(format);
    out.identified = std::make_shared<const model::UncertainErrors>(identified_);
    return out;
  }

  TableExport tables(TableFormat format) const {
    return export_tables(machine_, errors_, request(format));
  }

  static constexpr double kOneInterval = 0.02;  // tables of 2^n steps end behind the travel
  static constexpr double kScale = 100e-6, kBow = 2e-3, kXY = 50e-6, kXZ = 400e-6;  // 1, 1/m, rad
  static constexpr double kUnknownXZ = 340e-6, kUnknownBow = 3e-3;

  model::MachineSettings machine_ = machine_of("[w b X Y Z t]");
  plant::ErrorModel errors_;
  model::UncertainErrors identified_;
};

const CompensationTable* table_of(const TableExport& e, int output, int over) {
  for (const CompensationTable& table : e.tables) {
    if (table.output == output && table.line.joint == over) return &table;
  }
  return nullptr;
}

bool reports(const std::vector<std::string>& lines, const std::string& text) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const std::string& line) { return line.find(text) != std::string::npos; });
}

// Relative to the middle of travel, X = 0: U = 2 * 3 um/m * 0.1 m at the ends.
TEST_F(Identified, UncertaintyOfATableIsThatOfItsEnds) {
  know_all(1e-5, 2e-6);
  const TableExport e = tables(TableFormat::heidenhain);
  const CompensationTable* own = table_of(e, 0, 0);
  ASSERT_NE(own, nullptr);
  ASSERT_TRUE(own->uncertainty.has_value());
  EXPECT_NEAR(*own->uncertainty, 0.6e-6, kOneInterval * 0.6e-6);
  EXPECT_TRUE(reports(report(e), "; U(k = 2) up to 0.604 um"));
  // X over Z by EB0Z: 2 * 2 urad * 0.1 m
  const CompensationTable* cross = table_of(e, 0, 2);
  ASSERT_NE(cross, nullptr);
  EXPECT_NEAR(*cross->uncertainty, 0.4e-6, kOneInterval * 0.4e-6);
}

TEST_F(Identified, WithoutIdentifiedNumbersNothingIsStated) {
  const TableExport e = export_tables(machine_, errors_, request_of(TableFormat::heidenhain));
  EXPECT_FALSE(table_of(e, 0, 0)->uncertainty.has_value());
  EXPECT_FALSE(reports(report(e), "U(k = 2)"));
}

// EB0Z = 400 +- 680 urad: 40 um at the ends of Z, U = 68 um. EZX: 20 um at the ends, U = 60 um.
TEST_F(Identified, WhatIsNotDeterminedHasNoTable) {
  know_all(kUnknownBow, kUnknownXZ);
  const TableExport e = tables(TableFormat::heidenhain);
  EXPECT_NE(table_of(e, 0, 0), nullptr);
  EXPECT_EQ(table_of(e, 0, 2), nullptr);
  EXPECT_EQ(table_of(e, 2, 0), nullptr);
  EXPECT_TRUE(reports(report(e),
                      "note: no table X over Z: up to 40.3 um with U(k = 2) up to 68.5 um: not "
                      "determined by the calibration"));
  EXPECT_TRUE(
      reports(report(e), "note: no table Z over X: up to 20.3 um with U(k = 2) up to 60.8 um"));
  EXPECT_LT(verify_tables(e, table_files(e)).length, 0.1e-6);  // of those that are written
}

TEST_F(Identified, ATableThatIsNotNeededIsFoundOnVerifying) {
  know_all(kUnknownBow, kUnknownXZ);
  const TableExport without = tables(TableFormat::heidenhain);
  const TableExport with = export_tables(machine_, errors_, request_of(TableFormat::heidenhain));
  EXPECT_NE(fault_messages([&] {
              verify_tables(without, table_files(with));
            }).find("a table Z over X is unexpected"),
            std::string::npos);
}

TEST_F(Identified, TablesOfWhichNothingIsDeterminedAreRefused) {
  errors_ = {};
  errors_.component("EXX"_err) = plant::polynomial({0.0, kScale});
  know("EXX"_err, plant::polynomial({0.0, 1.0}), kScale, kScale);
  EXPECT_EQ(fault_messages([&] { tables(TableFormat::linuxcnc); }),
            "linuxcnc tables over the selected axes cannot represent any part of the error "
            "model 'test'; no table X over X: up to 10 um with U(k = 2) up to 20 um: not "
            "determined by the calibration\n");
}

TEST_F(Identified, SkewFactorsThatAreNotDeterminedAreZero) {
  know_all(1e-5, kUnknownXZ);
  const TableExport e = tables(TableFormat::klipper);
  EXPECT_NEAR(e.skew->a, -kXY, 1e-8);
  EXPECT_EQ(e.skew->b, 0.0);
  EXPECT_NEAR((*e.skew->uncertainty)[0], 4e-6, 1e-9);
  ASSERT_EQ(e.skew->left_out.size(), 1u);
  EXPECT_TRUE(reports(report(e), "U(k = 2): 4, 680 and 0 um/m"));
  EXPECT_TRUE(reports(report(e),
                      "note: 0 for EB0Z: 400 um/m with U(k = 2) 680 um/m: not determined by the "
                      "calibration"));
  const std::vector<TextFile> files = table_files(e);
  EXPECT_NE(files[0].text.find("xz_skew = 0.00000000"), std::string::npos) << files[0].text;
  EXPECT_LT(verify_tables(e, files).angle, 1e-8);
}

TEST_F(Identified, ASkewCorrectionThatIsNotDeterminedIsRefused) {
  errors_.location("EC0Y"_err) = 0.0;
  know("EB0Z"_err, plant::constant(1.0), kXZ, kUnknownXZ);
  EXPECT_EQ(fault_messages([&] { tables(TableFormat::marlin); }),
            "marlin cannot represent any part of this error model: X, Y and Z are at right "
            "angles; EB0Z: 400 um/m with U(k = 2) 680 um/m: not determined by the calibration; it "
            "represents EC0Y, EB0Z, EA0Z and the like\n");
}

TEST_F(Identified, BedMeshesThatAreNotDeterminedAreRefused) {
  know_all(kUnknownBow, 2e-6);
  TableRequest mesh = request(TableFormat::klipper);
  mesh.mesh = {5, 3};
  EXPECT_EQ(fault_messages([&] { export_tables(machine_, errors_, mesh); }),
            "the bed mesh would correct Z by up to 20 um with U(k = 2) up to 60.1 um: not "
            "determined by the calibration; leave out --bed-mesh, or limit it with --travel\n");
  identified_ = {};
  know_all(1e-5, 2e-6);
  mesh.identified = std::make_shared<const model::UncertainErrors>(identified_);
  const TableExport e = export_tables(machine_, errors_, mesh);
  EXPECT_NEAR(*e.mesh->uncertainty, 0.2e-6, 1e-9);  // 2 * 1e-5 / m * (0.1 m)^2
}

// Z of the tip: 20 um at the ends of X with U = 60 um; X of the tip is known.
TEST_F(Identified, FormatsOfErrorsAreJudgedByTheTip) {
  know_all(kUnknownBow, 2e-6);
  for (const TableFormat format : {TableFormat::csv, TableFormat::isg, TableFormat::etalon}) {
    const std::string fault = fault_messages([&] { tables(format); });
    EXPECT_EQ(fault.rfind("Z of the TCP is corrected by up to ", 0), 0u) << fault;
    EXPECT_NE(fault.find("not determined by the calibration; take the measurements that servomill "
                         "calibrate names, or limit the travel with --travel"),
              std::string::npos);
  }
  identified_ = {};
  know_all(1e-5, 2e-6);
  const TableExport e = tables(TableFormat::csv);
  ASSERT_NE(table_of(e, 0, 0), nullptr);
  EXPECT_NEAR(*table_of(e, 0, 0)->uncertainty, 0.6e-6, 1e-9);  // EXX at +-100 mm
}

// Both sides of the rule: the largest uncertainty against the largest significant value.
TEST(Determination, NeedsASignificantValueAsLargeAsTheLargestUncertainty) {
  model::Determination curve;
  curve.add(0.0, 3.0);  // passes through 0
  EXPECT_FALSE(curve.is_determined());
  curve.add(-3.0, 3.0);
  EXPECT_TRUE(curve.is_determined());
  curve.add(2.9, 3.1);  // beyond the readings
  EXPECT_FALSE(curve.is_determined());
  curve.add(3.1, 1.0);
  EXPECT_TRUE(curve.is_determined());
  EXPECT_EQ(curve.largest(), 3.1);
  EXPECT_EQ(curve.uncertainty(), 3.1);
}

TEST(Determination, OfTheTipIgnoresWhatDoesNotMatter) {
  model::TipDetermination tip;
  tip.add({100.0, 40.0, 9.9}, {1.0, 1.0, 50.0});
  EXPECT_EQ(tip.undetermined(), std::nullopt);
  tip.add({0.0, 0.0, 10.1}, {1.0, 1.0, 50.0});
  EXPECT_EQ(tip.undetermined(), 2);
  EXPECT_EQ(tip.undetermined({false, false, true}), std::nullopt);
}

// A screw that repeats every 5 mm, as the default spacing of this travel does.
TEST(DefaultSpacing, IsFineEnoughForAScrew) {
  model::MachineSettings machine = machine_of("[w b X Y Z t]");
  machine.nc.lower[0] = -500.0 * mm;
  machine.nc.upper[0] = 500.0 * mm;
  plant::ErrorModel errors;
  errors.component("EXX"_err) = plant::polynomial({0.0, 20e-6});
  errors.component("EXX"_err).harmonics = {{12.0 * um, 5.0 * mm, 0.0}};
  for (const TableFormat format : {TableFormat::csv, TableFormat::isg, TableFormat::etalon}) {
    const TableExport e = export_tables(machine, errors, request_of(format));
    ASSERT_EQ(e.tables.size(), 1u);
    EXPECT_LE(e.tables[0].line.spacing, 0.5 * mm * (1.0 + 1e-9));
    EXPECT_LT(e.tables[0].residual, 0.02 * e.tables[0].largest());
    EXPECT_TRUE(e.coarse.empty());
  }
  TableRequest given = request_of(TableFormat::csv);
  given.spacing = 5.0 * mm;  // as asked for, and reported
  const TableExport e = export_tables(machine, errors, given);
  EXPECT_EQ(e.tables[0].line.spacing, 5.0 * mm);
  EXPECT_TRUE(reports(report(e), "note: EXX over X: points 5 mm apart leave a residual of 12.0"));
  // 256 points at most: the report tells
  const TableExport few = export_tables(machine, errors, request_of(TableFormat::linuxcnc));
  EXPECT_TRUE(reports(report(few), "note: X over X: points 5 mm apart leave "));
}

}  // namespace
}  // namespace servomill::sim::tables::table_uncertainty_test
