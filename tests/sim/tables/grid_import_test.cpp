// Errors over several axes out of ISG CSV, and back.
#include "sim/tables/grid_import.h"

#include <gtest/gtest.h>

#include "sim/config/document.h"
#include "sim/input/read_errors.h"
#include "sim/model/machine.h"
#include "tests/sim/tables/rich_tables.h"

namespace servomill::sim::tables::grid_import_test {
namespace {

// The example of the document, for X on either side of the bed.
constexpr const char* kText =
    "Z X EXX EYX EZX EAX EBX ECX\n"
    "0.0 0.0 0.02 0.01 0.07 0.00 0.0042 0.003\n"
    "0.0 10.0 0.00 -0.1 0.01 0.00 0.0011 0.002\n"
    "100.0 0.0 0.01 0.02 0.03 0.07 0.0040 0.003\n"
    "100.0 10.0 0.03 -0.09 0.03 0.06 0.0015 0.000\n";

ImportedColumns columns_of(const std::string& text) {
  const std::vector<controllers::TableText> files = {{"v.csv", text}};
  return read_columns(TableFormat::isg, files);
}

plant::ErrorModel read_back(const std::string& text, const JointLayout& layout) {
  const config::Document document = config::Document::from_text(text, "errors.toml");
  config::Reader root(document);
  config::Reader models = root.table("errors");
  auto all = input::read_error_models(models, layout);
  root.finish();
  return all.at("measured");
}

TEST(GridImport, RoundTripsTheExampleOfTheDocument) {
  for (const char* structure : {"[w b X Y Z t]", "[w X b Y Z t]"}) {
    const plant::MachineChain chain = machine_of(structure).chain;
    const ImportedColumns columns = columns_of(kText);
    const ErrorImport imported = import_errors(columns, chain);
    const plant::ErrorModel model =
        read_back(errors_toml(imported.errors, "measured", imported.notes), chain.layout);
    EXPECT_EQ(verify_import(columns, chain, model), 6000U) << structure;
  }
}

// On the tool side nothing is converted: the file comes back as it was.
TEST(GridImport, OfTheToolSideIsTheFile) {
  const plant::MachineChain chain = machine_of("[w b X Y Z t]").chain;
  const plant::ErrorModel errors = import_errors(columns_of(kText), chain).errors;
  const plant::GridPoints& points = errors.component("EYX"_err).grids.at(0).points();
  EXPECT_EQ(points.axes, (std::vector{Axis::Z, Axis::X}));
  EXPECT_EQ(points.at[0], (std::vector{0.0, 100 * mm}));
  EXPECT_NEAR(points.error[3], -90 * um, 1e-18);
}

TEST(GridImport, WrittenTablesComeBackAsTheModel) {
  const model::MachineSettings machine = machine_of("[w b X Y Z t]");
  plant::ErrorModel errors;
  errors.component("EZX"_err) = plant::grid({{Axis::Y, Axis::Z, Axis::X},
                                             {{-50 * mm, 150 * mm}, {0, 200 * mm}, {-0.1, 0, 0.1}},
                                             {0, 1e-6, 2e-6, 0, 4e-6, 0, 0, 3e-6, 0, 0, 5e-6, 9e-6},
                                             {}});
  errors.location("EC0Y"_err) = 20 * urad;
  const auto files = table_files(export_tables(machine, errors, request_of(TableFormat::isg)));
  const ErrorImport imported = import_errors(columns_of(files.at(0).text), machine.chain);
  EXPECT_EQ(imported.errors.component("EZX"_err).grids.at(0).points().at,
            errors.component("EZX"_err).grids.at(0).points().at);
  for (std::size_t n = 0; n < 12; ++n) {
    EXPECT_NEAR(imported.errors.component("EZX"_err).grids.at(0).points().error[n],
                errors.component("EZX"_err).grids.at(0).points().error[n], 0.5e-9);
  }
  EXPECT_NEAR(imported.errors.location("EC0Y"_err), 20 * urad, 1e-12);
}

// Z 0..200, X -100..100 mm for 0..100 and 0..10 in the file.
TEST(GridImport, KeepsTheValuesAtTheEndsToTheEndsOfTheTravel) {
  for (const char* structure : {"[w b X Y Z t]", "[w X b Y Z t]"}) {
    const model::MachineSettings machine = machine_of(structure);
    const ImportedColumns in_file = columns_of(kText);
    ImportedColumns columns = in_file;
    std::vector<std::string> notes;
    cover_travel(columns, machine, notes);
    ASSERT_EQ(notes.size(), 6U);
    EXPECT_EQ(notes[0],
              "assumed: EXX is constant from the ends of the table (Z 0 to 100 mm, X 0 to 10 mm) "
              "to the ends of the travel");
    const ErrorImport imported = import_errors(columns, machine.chain);
    const config::Document document = config::Document::from_text(
        errors_toml(imported.errors, "measured", imported.notes), "errors.toml");
    config::Reader root(document);
    config::Reader models = root.table("errors");
    const plant::ErrorModel model =
        input::read_error_models(models, input::MachineAxes(machine)).at("measured");
    root.finish();
    EXPECT_EQ(verify_import(columns, machine.chain, model), 6000U) << structure;
    EXPECT_EQ(verify_import(in_file, machine.chain, model), 6000U) << structure;
    if (std::string(structure) != "[w b X Y Z t]") continue;
    AxisWords q = AxisWords::Zero();
    q << -0.05, 0, 0.15, 0, 0, 0;
    EXPECT_NEAR(model.component("EZX"_err).value(-0.05, q), 30 * um, 1e-12);  // that of Z 100, X 0
  }
}

TEST(GridImport, WantsOneTurnOfAnEndlessAxis) {
  ImportedColumns columns = columns_of("C X EXX\n0 0 0.1\n0 1 0\n90 0 0\n90 1 0\n");
  std::vector<std::string> notes;
  try {
    cover_travel(columns, machine_of("[w C' b X Y Z t]"), notes);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "v.csv:1: error: EXX covers 0 to 90 deg of C, whose travel is endless; must cover "
                 "one turn");
  }
}

// Conversion turns by 360 degrees, whose sine is not exactly 0.
TEST(GridImport, ClosesATurnThatIsConverted) {
  const model::MachineSettings machine = machine_of("[w C' b X Y Z t]");
  ImportedColumns columns = columns_of(
      "C X EXC\n-180 0 -0.005\n-180 1 -0.005\n0 0 0.005\n0 1 0.005\n180 0 -0.005\n180 1 -0.005\n");
  std::vector<std::string> notes;
  cover_travel(columns, machine, notes);
  const ErrorImport imported = import_errors(columns, machine.chain);
  const config::Document document = config::Document::from_text(
      errors_toml(imported.errors, "measured", imported.notes), "errors.toml");
  config::Reader root(document);
  config::Reader models = root.table("errors");
  const auto all = input::read_error_models(models, input::MachineAxes(machine));
  root.finish();
  EXPECT_GT(verify_import(columns, machine.chain, all.at("measured")), 0U);
}

TEST(GridImport, RefusesATurnThatDoesNotClose) {
  ImportedColumns columns = columns_of("C X EXX\n0 0 0.1\n0 1 0\n360 0 0\n360 1 0\n");
  std::vector<std::string> notes;
  try {
    cover_travel(columns, machine_of("[w C' b X Y Z t]"), notes);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "v.csv:1: error: EXX is not the same at both ends of a turn of C");
  }
}

TEST(GridImport, AnotherModelIsFound) {
  const plant::MachineChain chain = machine_of("[w b X Y Z t]").chain;
  const ImportedColumns columns = columns_of(kText);
  plant::ErrorModel errors = import_errors(columns, chain).errors;
  errors.component("EXX"_err) = errors.component("EXX"_err) + plant::constant(3e-9);
  EXPECT_THROW(verify_import(columns, chain, errors), InputError);
}

std::string fault_of(const char* text, const char* structure) {
  try {
    import_errors(columns_of(text), machine_of(structure).chain);
  } catch (const InputError& error) {
    return error.what();
  }
  return "imported";
}

TEST(GridImport, RefusesWhatTheMachineCannotHave) {
  EXPECT_EQ(fault_of("C X EXX\n0 0 0.1\n0 1 0\n1 0 0\n1 1 0\n", "[w b X Y Z t]"),
            "v.csv:1: error: EXX is a function of C, which the machine lacks");
  EXPECT_EQ(fault_of("Z X EXA\n0 0 0.1\n0 1 0\n1 0 0\n1 1 0\n", "[w b X Y Z t]"),
            "v.csv:1: error: EXA is an error of axis A; the machine has X Y Z");
  EXPECT_EQ(fault_of("Z X EXX\n0 0 101\n0 1 0\n1 0 0\n1 1 0\n", "[w b X Y Z t]"),
            "v.csv:1: error: EXX is 101 mm, implausible for a machine");
  EXPECT_EQ(fault_of("Z EXX\n0 0\n1 0.1\n", "[w X b Y Z t]"),
            "v.csv:1: error: EXX is not a function of X; the errors of X, which carries the "
            "workpiece, are converted, and that needs its positions");
}

}  // namespace
}  // namespace servomill::sim::tables::grid_import_test
