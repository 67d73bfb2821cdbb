#include "sim/tables/table_residuals.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "sim/model/machine.h"
#include "tests/sim/tables/rich_tables.h"

namespace servomill::sim::tables::table_residuals_test {
namespace {

std::vector<std::string> notes(TableFormat format, const plant::ErrorModel& errors) {
  std::vector<std::string> out;
  for (const std::string& line :
       report(export_tables(machine_of("[w X b Y Z t]"), errors, three_points(format)))) {
    if (line.starts_with("note: E") || line.starts_with("note: no")) out.push_back(line);
  }
  return out;
}

// The control's BACKLASH belongs to the axis itself: of a straightness it takes the mean.
TEST(TableResiduals, WhatAControlCannotHoldIsReported) {
  plant::ErrorModel errors = reversal_of_x();
  errors.component("EYX"_err) =
      plant::polynomial({0.0, 1e-4}) + plant::reversal({2.0 * um}, 0.1 * mm);
  EXPECT_EQ(
      notes(TableFormat::heidenhain, errors),
      (std::vector<std::string>{"note: EXX depends on the direction of travel, by 4.000 um at "
                                "the ends of the travel; both directions are contained in X over "
                                "X; the mean by Y over X",
                                "note: EYX depends on the direction of travel, by 2.000 um at "
                                "the ends of the travel; both directions are contained in X over "
                                "X; the mean by Y over X"}));
  EXPECT_EQ(notes(TableFormat::siemens, errors)[1],
            "note: EYX depends on the direction of travel, by 2.000 um at the ends of the travel; "
            "both directions are contained in X over X, Y over X");
}

// An error of 5 mm period between points 7 mm apart.
TEST(TableResiduals, TablesThatMakeTheMachineWorseAreRefused) {
  plant::ErrorModel errors;
  errors.component("EYY"_err) = plant::harmonic(12.0 * um, 5.0 * mm);
  TableRequest request = request_of(TableFormat::heidenhain);
  request.spacing = 7.0 * mm;
  try {
    export_tables(machine_of("[w X b Y Z t]"), errors, request);
    FAIL();
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("these tables would increase the error of the machine: TCP off by up to "),
              std::string::npos)
        << what;
    EXPECT_NE(what.find("; Y over Y: points 7 mm apart leave a residual of "), std::string::npos)
        << what;
    EXPECT_NE(what.find(" of an error of +-12.000 um; required: 0."), std::string::npos) << what;
  }
}

// Points one period apart see an error that does not change.
TEST(TableResiduals, PointsThatSeeNothingOfAnErrorAreReported) {
  plant::ErrorModel errors;
  errors.component("EYY"_err) = plant::harmonic(12.0 * um, 5.0 * mm);
  errors.component("EXX"_err) = plant::polynomial({0.0, 1e-4});
  TableRequest request = request_of(TableFormat::heidenhain);
  request.spacing = 5.0 * mm;
  std::string all;
  for (const std::string& line :
       report(export_tables(machine_of("[w X b Y Z t]"), errors, request))) {
    all += line + "\n";
  }
  EXPECT_NE(
      all.find(
          "note: Y over Y: points 5 mm apart leave a residual of 12.000 um of an error of +-12.000 "
          "um; required: 0."),
      std::string::npos)
      << all;

  errors.component("EXX"_err) = {};
  try {
    export_tables(machine_of("[w X b Y Z t]"), errors, request);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("cannot represent any part of the error model"),
              std::string::npos);
    EXPECT_NE(std::string(error.what())
                  .find("; Y over Y: points 5 mm apart leave a residual of 12.000 um"),
              std::string::npos)
        << error.what();
  }
}

// A straightness of which only the direction of travel matters has no mean to hold.
TEST(TableResiduals, ReversalWithoutATableIsReportedAsLost) {
  plant::ErrorModel errors = reversal_of_x();
  errors.component("EYX"_err) = plant::reversal({2.0 * um}, 0.1 * mm);
  for (const TableFormat format : {TableFormat::linuxcnc, TableFormat::heidenhain}) {
    EXPECT_EQ(
        notes(format, errors),
        (std::vector<std::string>{
            "note: EXX depends on the direction of travel, by 4.000 um at the ends of the "
            "travel; both directions are contained in X over X",
            "note: EYX depends on the direction of travel, by 2.000 um at the ends of the travel; "
            "there is no table Y over X: half of it, 1.000 um, remains in each direction"}));
  }
}

TEST(TableResiduals, MoreTablesThanASmallSinumerikHasAreReported) {
  plant::ErrorModel errors = reversal_of_x();
  for (const char* name : {"EXX", "EYX", "EZX", "EXY", "EYZ"}) {
    errors.component(*plant::error_name_of(name)) =
        plant::polynomial({0.0, 1e-4}) + plant::reversal({2.0 * um}, 0.1 * mm);
  }
  const auto lines = report(
      export_tables(machine_of("[w X b Y Z t]"), errors, three_points(TableFormat::siemens)));
  const std::string note =
      "note: 10 tables of $AN_CEC; a SINUMERIK 828D has 8: choose axes with --axis";
  EXPECT_EQ(std::count(lines.begin(), lines.end(), note), 1);
}

}  // namespace
}  // namespace servomill::sim::tables::table_residuals_test
