// Errors over several axes in tables of controls: what ISG CSV holds, what the others say.
#include "sim/tables/grid_tables.h"

#include <gtest/gtest.h>

#include "sim/model/machine.h"
#include "sim/tables/table_export.h"
#include "tests/sim/tables/rich_tables.h"

namespace servomill::sim::tables::grid_tables_test {
namespace {

using plant::GridInterpolation;

constexpr const char* kToolSide = "[w b X Y Z t]";
constexpr const char* kWorkpieceSide = "[w X b Y Z t]";

// EZX sags with the ram, linear between its points.
plant::ErrorModel sag() {
  plant::ErrorModel errors;
  errors.component("EZX"_err) = plant::grid({{Axis::Z, Axis::X},
                                             {{0.0, 200 * mm}, {-100 * mm, 20 * mm, 100 * mm}},
                                             {0.0, -8 * um, 0.0, 0.0, -2 * um, 1 * um},
                                             {}});
  return errors;
}

plant::ErrorModel sag_and_angle(GridInterpolation interpolation) {
  plant::ErrorModel errors = sag();
  errors.component("EZX"_err) = errors.component("EZX"_err) + plant::polynomial({1 * um, 2e-5});
  errors.component("EBX"_err) = plant::grid(
      {{Axis::Z, Axis::X},
       {{0.0, 60 * mm, 130 * mm, 200 * mm}, {-100 * mm, -20 * mm, 30 * mm, 100 * mm}},
       {0, 1e-5, 3e-5, 2e-5, 1e-5, 2e-5, 4e-5, 2e-5, 2e-5, 2e-5, 1e-5, 0, 0, 1e-5, 0, 0},
       interpolation});
  errors.component("EYX"_err) = plant::harmonic(5 * um, 300 * mm);
  return errors;
}

TEST(GridTables, IsgWritesOneRecordForEachCombination) {
  const TableExport e = export_tables(machine_of(kToolSide), sag(), request_of(TableFormat::isg));
  EXPECT_TRUE(e.tables.empty());
  EXPECT_EQ(table_files(e).at(0).text,
            "// Geometric errors of small machine; see notes.txt\n"
            "Z X EZX\n"
            "0.000000 -100.000000 0.000000\n"
            "0.000000 20.000000 -0.008000\n"
            "0.000000 100.000000 0.000000\n"
            "200.000000 -100.000000 0.000000\n"
            "200.000000 20.000000 -0.002000\n"
            "200.000000 100.000000 0.001000\n");
  EXPECT_LT(e.grids.at(0).residual, 1e-15);
}

TEST(GridTables, OfIsgHoldTheErrorModel) {
  for (const char* structure : {kToolSide, kWorkpieceSide, "[w C' X b Y Z t]"}) {
    for (const auto form : {GridInterpolation::linear, GridInterpolation::cubic}) {
      const TableExport e =
          export_tables(machine_of(structure), sag_and_angle(form), rich_request(TableFormat::isg));
      const auto files = table_files(e);
      const TableVerification verified = verify_tables(e, files);
      EXPECT_GT(verified.positions, 2000U) << structure;
      // chords of EYX over 10 mm: (2 pi / 300 mm)^2 5 um (10 mm)^2 / 8 = 27 nm; a spline is written
      // at quarters of its intervals
      EXPECT_LT(verified.length, form == GridInterpolation::linear ? 28e-9 : 0.3 * um);
      EXPECT_LT(verified.angle, form == GridInterpolation::linear ? 1e-8 : 2 * urad);
    }
  }
}

// Straightness of a rotary table over z turns with the table where all axes count as tool axes: a
// chord over 10 deg leaves 60 um (1 - cos 5 deg) = 0.23 um.
TEST(GridTables, OfARotaryTableHaveThePointsThatItsRotationNeeds) {
  plant::ErrorModel errors;
  errors.component("EXC"_err) = plant::grid({{Axis::Z}, {{0.0, 200 * mm}}, {20 * um, 60 * um}, {}});
  TableRequest request = request_of(TableFormat::isg);
  request.rotary_spacing = 10 * deg;
  const TableExport e = export_tables(machine_of("[w C' b X Y Z t]"), errors, request);
  const TableVerification verified = verify_tables(e, table_files(e));
  EXPECT_LT(verified.length, 0.24 * um);
  request.rotary_spacing = 1 * deg;
  const TableExport fine = export_tables(machine_of("[w C' b X Y Z t]"), errors, request);
  EXPECT_LT(verify_tables(fine, table_files(fine)).length, 0.01 * um);
}

TEST(GridTables, AChangedDigitOfARecordIsFound) {
  const TableExport e = export_tables(machine_of(kToolSide), sag(), request_of(TableFormat::isg));
  auto files = table_files(e);
  std::string& text = files.at(0).text;
  text.replace(text.find("-0.002000"), 9, "-0.002002");
  EXPECT_EQ(fault_of(e, files),
            "volcomp.csv:2: error: verification failed: EZX: the file gives -2.0020 um, the error "
            "model -2.0000 um");
}

TEST(GridTables, AMissingOrFurtherGridIsFound) {
  const TableExport e =
      export_tables(machine_of(kToolSide), sag_and_angle({}), rich_request(TableFormat::isg));
  auto files = table_files(e);
  std::string& text = files.at(0).text;
  const std::string whole = text;
  const std::size_t at = text.find("Z X EBX");
  text.replace(at, 7, "Z X EAX");
  EXPECT_EQ(fault_of(e, files),
            "volcomp.csv:" + std::to_string(std::count(text.begin(), text.begin() + at, '\n') + 1) +
                ": error: verification failed: EAX over several axes is unexpected");
}

TEST(GridTables, OtherFormatsOfErrorsRefuseThemByName) {
  for (const TableFormat format : {TableFormat::csv, TableFormat::etalon}) {
    try {
      export_tables(machine_of(kWorkpieceSide), sag(), request_of(format));
      ADD_FAILURE();
    } catch (const InputError& error) {
      EXPECT_STREQ(error.what(),
                   "<input>: error: EZX depends on the position of Z, too; this format contains "
                   "functions of "
                   "the position of X only; use --format isg");
    }
  }
}

// Tables of displacements hold the error on the line through the reference, and say so.
TEST(GridTables, TablesOfOneAxisReportWhatTheyDoNotHold) {
  plant::ErrorModel errors = sag();
  TableRequest request = request_of(TableFormat::siemens);
  request.axes[2].reference = 200 * mm;
  request.spacing = 5 * mm;
  const TableExport e = export_tables(machine_of(kToolSide), errors, request);
  ASSERT_EQ(e.tables.size(), 2U);  // Z over X at z = 200, Z over Z at x = 0
  const double at_zero = -2 * um * 100 / 120;
  EXPECT_NEAR(e.tables[0].at(20 * mm), -2 * um - at_zero, 1e-9);
  EXPECT_NEAR(e.tables[1].at(0.0), -8 * um * 100 / 120 - at_zero, 1e-9);
  verify_tables(e, table_files(e));
  ASSERT_EQ(e.left.size(), 1U);
  EXPECT_EQ(to_string(e.left[0].name), "EZX");
  EXPECT_NEAR(e.left[0].size, 8 * um, 0.1 * um);
  // at x = -100, z = 0, where the error is 0 and the tables add 0 and -5 um
  EXPECT_NEAR(e.left[0].tip, 5 * um, 1e-9);
  const std::vector<std::string> text = report(e);
  EXPECT_EQ(std::count(text.begin(), text.end(),
                       "note: EZX depends on the position of Z, too; tables over one axis contain "
                       "it on the lines through the reference only (isg contains all of it)"),
            1);
}

// The error whose grid it is, and what makes it smaller.
TEST(GridTables, OfMoreThanAMillionRecordsAreRefused) {
  TableRequest request = request_of(TableFormat::isg);
  request.spacing = 0.025 * mm;
  plant::GridPoints points{{Axis::Z, Axis::X}, {{}, {-100 * mm, 100 * mm}}, {}, {}};
  for (int i = 0; i < 40; ++i) {
    points.at[0].push_back(5 * mm * i);
    points.error.insert(points.error.end(), {0.0, i * um});
  }
  plant::ErrorModel errors;
  errors.component("EZX"_err) = plant::grid(points) + plant::polynomial({0.0, 0.0, 1e-6});
  for (const auto& [structure, name] :
       {std::pair{kToolSide, "EZX"}, std::pair{"[w X b Y Z t]", "EXX from EZX"}}) {
    try {
      export_tables(machine_of(structure), errors, request);
      ADD_FAILURE();
    } catch (const InputError& error) {
      const std::string text = error.what();
      EXPECT_EQ(text.find(std::string("<input>: error: ") + name + " over 2 axes: a grid of "), 0U)
          << text;
      EXPECT_NE(text.find(" records; at most 1000000 are written; choose a larger --spacing, or "
                          "fewer positions in the model's grid"),
                text.npos);
    }
  }
}

TEST(GridTables, FirmwaresReportTheirPart) {
  TableRequest request = request_of(TableFormat::marlin);
  const auto notes = [&](const TableRequest& one) {
    plant::ErrorModel errors = sag();
    errors.location("EC0Y"_err) = 100e-6;
    const std::vector<std::string> text = report(export_tables(machine_of(kToolSide), errors, one));
    return std::count_if(text.begin(), text.end(), [&](const std::string& line) {
      return line == "note: EZX depends on the position of Z, too; " +
                         std::string(one.mesh
                                         ? "the bed mesh contains it at Z = 50 mm only, as far "
                                           "as it moves Z"
                                         : "the skew correction contains none of it") +
                         " (isg contains all of it)";
    });
  };
  request.axes[2].reference = 50 * mm;
  EXPECT_EQ(notes(request), 1);
  request.mesh = {5, 4};
  EXPECT_EQ(notes(request), 1);
}

}  // namespace
}  // namespace servomill::sim::tables::grid_tables_test
