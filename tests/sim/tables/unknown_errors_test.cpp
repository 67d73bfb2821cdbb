#include "sim/tables/unknown_errors.h"

#include <gtest/gtest.h>

#include "sim/model/machine.h"
#include "sim/model/tip_uncertainty.h"
#include "sim/model/undetermined_errors.h"
#include "tests/sim/tables/small_machine.h"
#include "tests/text.h"

namespace servomill::sim::tables::unknown_errors_test {
namespace {

using plant::ErrorName;

constexpr ErrorName kEXX{Axis::X, Axis::X, false}, kEYX{Axis::Y, Axis::X, false},
    kEZX{Axis::Z, Axis::X, false}, kEC0Y{Axis::C, Axis::Y, true};

// A router whose model has a scale of X, a squareness and Z over X, all with values.
class Unknown : public testing::Test {
 protected:
  Unknown() {
    errors_.component(kEXX) = plant::polynomial({0.0, 1e-4});
    errors_.component(kEZX) = plant::polynomial({0.0, 0.0, 1e-3});
    errors_.location(kEC0Y) = 50e-6;
  }

  void identify(const ErrorName& name) {
    identified_.parts.push_back({{name, plant::constant(2e-6), plant::constant(1e-6)}});
  }

  TableRequest request(TableFormat format) const {
    TableRequest out = request_of(format);
    out.unknown = model::undetermined_errors(errors_, identified_, machine_.chain.layout);
    return out;
  }

  std::string faults(const TableRequest& request) const {
    return fault_messages([&] { export_tables(machine_, errors_, request); });
  }

  model::MachineSettings machine_ = machine_of("[w b X Y Z (C1) t]");
  plant::ErrorModel errors_;
  model::UncertainErrors identified_;
};

TEST_F(Unknown, IsWhatHasNeitherAnIdentifiedNumberNorAValue) {
  identify(kEYX);  // identified, and happens to be 0
  const std::vector<ErrorName> unknown = request(TableFormat::csv).unknown;
  const auto has = [&](const ErrorName& name) {
    return std::find(unknown.begin(), unknown.end(), name) != unknown.end();
  };
  for (const ErrorName& name : {kEXX, kEYX, kEZX, kEC0Y}) EXPECT_FALSE(has(name));
  EXPECT_TRUE(has({Axis::A, Axis::X, false}));
  EXPECT_TRUE(has({Axis::Z, Axis::Y, false}));
  EXPECT_TRUE(has({Axis::B, Axis::Z, true}));
  EXPECT_FALSE(has({Axis::X, Axis::C, false}));  // no such axis
  // 18 component errors and 3 squarenesses less these four
  EXPECT_EQ(unknown.size(), 17u);
}

TEST_F(Unknown, SquarenessStandsAtEitherAxis) {
  errors_.location(kEC0Y) = 0.0;
  identify({Axis::C, Axis::X, true});
  const std::vector<ErrorName> unknown = request(TableFormat::csv).unknown;
  EXPECT_EQ(std::count(unknown.begin(), unknown.end(), kEC0Y), 0);
}

TEST_F(Unknown, AxesWithoutAnyKnownErrorAreRefused) {
  TableRequest all = request(TableFormat::linuxcnc);
  EXPECT_NE(faults(all).find("no errors for a table over Y: EXY, EYY, EZY, EAY, EBY, ECY are not "
                             "determined by the calibration"),
            std::string::npos)
      << faults(all);
  all.axes[1].wanted = all.axes[2].wanted = false;
  EXPECT_EQ(faults(all), "");
  bool is_named = false;
  for (const std::string& line : report(export_tables(machine_, errors_, all))) {
    is_named = is_named || (line.find("not determined by the calibration, assumed to be 0") !=
                                std::string::npos &&
                            line.find("ECZ") != std::string::npos);
  }
  EXPECT_TRUE(is_named);
}

TEST_F(Unknown, MeshesWithoutHeightsAreRefused) {
  TableRequest mesh = request(TableFormat::klipper);
  mesh.mesh = {3, 3};
  EXPECT_EQ(faults(mesh), "");  // EZX is known
  errors_.component(kEZX) = plant::ErrorFunction();
  mesh.unknown = request(TableFormat::klipper).unknown;
  EXPECT_NE(faults(mesh).find("no heights for a bed mesh: EZX, EZY"), std::string::npos);
  mesh.mesh.reset();
  EXPECT_EQ(faults(mesh), "");  // the skew is known
}

TEST_F(Unknown, SkewWithoutSquarenessIsRefused) {
  errors_.location(kEC0Y) = 0.0;
  EXPECT_NE(faults(request(TableFormat::marlin)).find("no squareness for a skew correction"),
            std::string::npos);
}

TEST_F(Unknown, NothingIsSaidOfModelsThatNobodyIdentified) {
  const TableExport tables = export_tables(machine_, errors_, request_of(TableFormat::csv));
  EXPECT_TRUE(with_unknown({}, tables).empty());
}

}  // namespace
}  // namespace servomill::sim::tables::unknown_errors_test
