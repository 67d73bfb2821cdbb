// Error models out of parameter files: nothing is lost, changed or taken for something else.
#include "sim/tables/error_import.h"

#include <gtest/gtest.h>

#include "sim/config/document.h"
#include "sim/input/read_errors.h"
#include "sim/model/machine.h"
#include "tests/sim/tables/rich_tables.h"

namespace servomill::sim::tables::error_import_test {
namespace {

std::vector<controllers::TableText> texts(const std::vector<TextFile>& files, TableFormat format) {
  std::vector<controllers::TableText> out;
  for (const TextFile& file : files) {
    const bool is_csv = file.name.ends_with(".csv");
    if (format == TableFormat::csv ? is_csv : file.name != "notes.txt") {
      out.push_back({file.name, file.text});
    }
  }
  return out;
}

plant::ErrorModel read_back(const std::string& text, const JointLayout& layout) {
  const config::Document document = config::Document::from_text(text, "errors.toml");
  config::Reader root(document);
  config::Reader models = root.table("errors");
  auto all = input::read_error_models(models, layout);
  root.finish();
  return all.at("measured");
}

// Without dependence on the direction of travel, which tables of one column do not hold.
plant::ErrorModel means(const plant::ErrorModel& errors) {
  plant::ErrorModel out = errors;
  for (auto& axis : out.components) {
    for (auto& error : axis) error = plant::travelling(error, 0.0);
  }
  return out;
}

TEST(ErrorImport, RoundTripsOfEveryFormat) {
  for (const char* structure : {"[w C' X b Y Z t]", "[w C' X Y b Z t]", "[w b X Y Z C t]"}) {
    const model::MachineSettings machine = machine_of(structure);
    const plant::MachineChain& chain = machine.chain;
    for (const TableFormat format : {TableFormat::csv, TableFormat::isg, TableFormat::etalon}) {
      const plant::ErrorModel errors = means(rich_model());
      const TableExport tables = export_tables(machine, errors, rich_request(format));
      const auto files = texts(table_files(tables), format);
      const ImportedColumns columns = read_columns(format, files);
      const ErrorImport imported = import_errors(columns, chain);
      const plant::ErrorModel model =
          read_back(errors_toml(imported.errors, "measured", imported.notes), chain.layout);
      EXPECT_GT(verify_import(columns, chain, model), 5000U);
      for (const TableLine& line : tables.lines) {
        const Axis axis = *chain.layout.axis[static_cast<std::size_t>(line.joint)];
        for (const Axis direction : kAllAxes) {
          const plant::ErrorName name{direction, axis, false}, place{direction, axis, true};
          EXPECT_NEAR(model.location(place), errors.location(place), 1e-9) << to_string(place);
          for (std::size_t i = 0; i < line.points; ++i) {
            const double q = line.entry(i);
            EXPECT_NEAR(model.component(name).value(q), errors.component(name).value(q), 2e-9)
                << structure << " " << name_of(format) << " " << to_string(name) << " " << q;
          }
        }
      }
    }
  }
}

const plant::MachineChain kRouter = machine_of("[w X b Y Z t]").chain;

ErrorImport imported(const std::string& text, const plant::MachineChain& chain = kRouter) {
  return import_errors(
      read_columns(TableFormat::isg, std::vector<controllers::TableText>{{"v.csv", text}}), chain);
}

std::string fault_of(const std::string& text) {
  try {
    imported(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "imported";
}

TEST(ErrorImport, AxesThatCarryTheWorkpieceAreConverted) {
  // roll about Z while X travels: E' = J^-1 E J, so that EYX = EYX' - ECX' x
  const ErrorImport made = imported("X EYX ECX\n0 0.002 1e-5\n100 0.004 3e-5\n");
  const plant::ErrorFunction& eyx = made.errors.component("EYX"_err);
  EXPECT_NEAR(eyx.value(0.0), 2.0 * um, 1e-12);
  EXPECT_NEAR(eyx.value(100.0 * mm), 4.0 * um - 3e-5 * 0.1, 1e-9);
  EXPECT_NEAR(eyx.value(50.0 * mm), 3.0 * um - 2e-5 * 0.05, 2e-9);
  ASSERT_EQ(made.notes.size(), 2U);
  EXPECT_EQ(made.notes[0],
            "converted: the errors of X, which carries the workpiece, but is treated in the file "
            "as carrying the tool");
}

TEST(ErrorImport, NothingIsDroppedSilently) {
  const ErrorImport made = imported("P0Z PXC C0Y\n-100 1 0.0001\n#\nC ECC EXC\n0 0 0\n90 0 0\n");
  EXPECT_EQ(made.errors.component("ECC"_err), plant::ErrorFunction{});
  EXPECT_EQ(made.notes.at(0), "not imported: ECC, which is 0 everywhere");
  EXPECT_EQ(made.notes.back(), "not imported: P0Z, PXC; the machine file has the kinematics");
}

TEST(ErrorImport, RefusesErrorsThatTheMachineCannotHave) {
  EXPECT_NE(fault_of("C ECC\n0 1e-5\n90 2e-5\n").find("v.csv:2: error: ECC "), std::string::npos);
  EXPECT_EQ(fault_of("X0Y\n0.1\n"), "v.csv:2: error: EX0Y has no effect on the motion of Y");
  EXPECT_EQ(
      fault_of("C0Y\n0.2\n"),
      "v.csv:2: error: EC0Y is 0.2 rad, implausible for a machine; angles are in rad, not in deg");
  EXPECT_EQ(fault_of("X EXX\n0 0\n100 101\n"),
            "v.csv:3: error: EXX is 101 mm, implausible for a machine");
}

TEST(ErrorImport, ErrorsByDirectionOfTravelAreRefused) {
  const std::vector<controllers::TableText> files = {
      {"x.csv", "X_mm,EXX_up_um,EXX_down_um\n0,1,2\n10,1,2\n"}};
  try {
    import_errors(read_columns(TableFormat::csv, files), kRouter);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "x.csv:2: error: EXX depends on the direction of travel; tables do not contain "
                 "reversal distances, so only means are imported");
  }
}

TEST(ErrorImport, ADisplacementOfAnAxisIsNoError) {
  try {
    read_columns(TableFormat::siemens, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.faults().front().message,
              "siemens contains axis displacements, from which errors cannot be derived; csv, isg "
              "and etalon contain errors");
  }
}

// A changed digit of the written model is found.
TEST(ErrorImport, AnotherModelIsFound) {
  const ImportedColumns columns = read_columns(
      TableFormat::isg, std::vector<controllers::TableText>{
                            {"v.csv", "C0Y\n2e-5\n#\nX EYX ECX\n0 0.002 1e-5\n100 0.004 3e-5\n"}});
  const plant::ErrorModel right = import_errors(columns, kRouter).errors;
  EXPECT_EQ(verify_import(columns, kRouter, right), 2001U);
  for (int n = 0; n < 3; ++n) {
    plant::ErrorModel wrong = right;
    if (n == 0) wrong.location("EC0Y"_err) *= 1.001;
    if (n == 1) wrong.component("EYX"_err).tables.front().error.back() += 0.01 * um;
    if (n == 2) wrong.component("ECX"_err).tables.front().error.front() += 0.01 * urad;
    EXPECT_THROW(verify_import(columns, kRouter, wrong), InputError) << n;
  }
}

}  // namespace
}  // namespace servomill::sim::tables::error_import_test
