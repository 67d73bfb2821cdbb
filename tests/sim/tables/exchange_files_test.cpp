// Files for the volumetric compensation of the ISG kernel mean what its machine model says.
#include "sim/tables/exchange_files.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "controllers/tables/isg_table.h"
#include "plant/geometry/volumetric.h"
#include "sim/model/machine.h"
#include "tests/sim/tables/rich_tables.h"

namespace servomill::sim::tables::exchange_files_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

Isometry3d shift(const Vector3d& v) { return Isometry3d(Eigen::Translation3d(v)); }

Isometry3d turn(Axis about, double angle) {
  return Isometry3d(Eigen::AngleAxisd(angle, Vector3d::Unit(index_of(about) - index_of(Axis::A))));
}

// Small shifts and turns in any order: they commute to first order.
Isometry3d small(const std::array<double, kAxisWords>& e) {
  Isometry3d H = shift({e[0], e[1], e[2]});
  for (const Axis a : {Axis::A, Axis::B, Axis::C}) {
    H = H * turn(a, e[static_cast<std::size_t>(index_of(a))]);
  }
  return H;
}

// The machine model of TF5280 with all axes in the tool, as products of 4 x 4 matrices from the
// file alone: each axis is L J L^-1 E, about its centre if it is rotary.
class IsgMachine {
 public:
  IsgMachine(const std::string& text, const plant::MachineChain& chain)
      : errors_(controllers::read_isg_table({"volcomp.csv", text})), chain_(chain) {}

  Vector3d tip(const Joints& Q, const Vector3d& p_ST) const {
    Isometry3d H = Isometry3d::Identity();
    for (const plant::ChainAxis& a : chain_.axes) {
      const double q = Q[a.joint];
      const bool linear = is_linear(a.axis);
      const Isometry3d J = linear ? shift(q * Vector3d::Unit(index_of(a.axis))) : turn(a.axis, q);
      const Isometry3d L = small(values(a.axis, true, q)), E = small(values(a.axis, false, q));
      const Isometry3d C = linear ? Isometry3d::Identity() : shift(a.centre);
      H = H * C * L * J * L.inverse() * E * C.inverse();
    }
    return H * p_ST;
  }

 private:
  std::array<double, kAxisWords> values(Axis axis, bool is_location, double q) const {
    std::array<double, kAxisWords> out{};
    for (const Axis direction : kAllAxes) {
      const std::string name = to_string(plant::ErrorName{direction, axis, is_location});
      double& value = out[static_cast<std::size_t>(index_of(direction))];
      const auto location = errors_.locations.find(name);
      if (is_location && location != errors_.locations.end()) value = location->second.value;
      for (const controllers::ErrorColumn& column : errors_.components) {
        if (is_location || column.name != name) continue;
        value = controllers::ControlTable{.file = "", .points = column.points}.at(q, 1);
      }
    }
    return out;
  }

  controllers::ErrorColumns errors_;
  plant::MachineChain chain_;
};

// Errors of all 6 components of every axis, linear over linear axes and constant over rotary ones,
// and every location error that means something.
plant::ErrorModel all_errors(const JointLayout& layout) {
  plant::ErrorModel errors;
  double n = 1.0;
  for (const auto& axis : layout.axis) {
    if (!axis) continue;
    for (const Axis direction : kAllAxes) {
      const double size = (static_cast<int>(n) % 2 == 0 ? 1.0 : -1.0) * (5.0 + n) * 1e-6;
      n += 1.0;
      errors.component({direction, *axis, false}) =
          is_linear(*axis) ? plant::polynomial({size, 30e-6}) : plant::constant(size);
      const plant::ErrorName location{direction, *axis, true};
      if (!plant::why_meaningless(location, layout)) errors.location(location) = 1.5 * size;
    }
  }
  return errors;
}

TEST(ExchangeFiles, MatrixProductOfTheFileIsTheMachine) {
  for (const char* structure :
       {"[w X b Y Z t]", "[w X Y b Z t]", "[w C' A' Y b X Z t]", "[w Y X b Z C B t]"}) {
    model::MachineSettings machine = machine_of(structure);
    for (plant::ChainAxis& a : machine.chain.axes) a.centre = Vector3d(0.03, -0.05, 0.08);
    const plant::ErrorModel errors = all_errors(machine.chain.layout);
    TableRequest request = rich_request(TableFormat::isg);
    request.rotary_spacing = 1.0 * deg;
    const auto files = table_files(export_tables(machine, errors, request));
    const IsgMachine isg(files.at(0).text, machine.chain);
    const plant::VolumetricModel actual(machine.chain, errors);
    double largest = 0.0;
    for (const double s : {-0.9, -0.3, 0.4, 1.0}) {
      Joints Q;
      Q << 0.1 * s, 0.05 + 0.1 * s * s * s, 0.1 - 0.1 * s, 1.0 + s, 2.5 - 2.0 * s;
      const Vector3d p_ST(0.02, -0.03, -0.15);
      const Vector3d ideal = plant::forward(machine.chain, Q, p_ST).p_WT;
      const Vector3d tip = actual.forward(Q, p_ST).p_WT;
      largest = std::max(largest, (tip - ideal).norm());
      // second order, five axes of 50 urad: (250e-6)^2 / 2 of 0.5 m; chords over 1 deg: 2 nm an
      // axis; digits: 0.5 nm, 0.5 nrad
      EXPECT_LT((isg.tip(Q, p_ST) - tip).norm(), 25e-9) << structure << " " << s;
    }
    EXPECT_GT(largest, 20.0 * um) << structure;
  }
}

TEST(ExchangeFiles, AsTheDocumentWritesThem) {
  plant::ErrorModel errors;
  errors.component("EYX"_err) = plant::polynomial({1.0 * um, 1e-4});
  errors.component("ECZ"_err) = plant::polynomial({0.0, 1e-4});
  errors.location("EC0Y"_err) = -20.0 * urad;
  TableRequest request = request_of(TableFormat::isg);
  request.spacing = 100.0 * mm;
  const model::MachineSettings machine = machine_of("[w b X Y Z t]");
  EXPECT_EQ(table_files(export_tables(machine, errors, request)).at(0).text,
            "// Geometric errors of small machine; see notes.txt\n"
            "C0Y\n-0.000020000\n#\n"
            "X EYX\n-100.000000 -0.009000\n0.000000 0.001000\n100.000000 0.011000\n#\n"
            "Z ECZ\n0.000000 0.000000000\n100.000000 0.000010000\n200.000000 0.000020000\n");
  request.format = TableFormat::etalon;
  EXPECT_EQ(table_files(export_tables(machine, errors, request)).at(0).text,
            "// Geometric errors of small machine; see notes.txt\n"
            "[C0Y]\nVALUE = -0.000020000\n"
            "[EYX]\nGridpoints = {\n-100.000000 -0.009000\n0.000000 0.001000\n"
            "100.000000 0.011000\n}  // end of EYX\n"
            "[ECZ]\nGridpoints = {\n0.000000 0.000000000\n100.000000 0.000010000\n"
            "200.000000 0.000020000\n}  // end of ECZ\n");
}

std::string refusal(const plant::ErrorModel& errors, const model::MachineSettings& machine) {
  try {
    export_tables(machine, errors, request_of(TableFormat::isg));
  } catch (const InputError& error) {
    return error.faults().front().message;
  }
  return "exported";
}

TEST(ExchangeFiles, AxesThatNoDocumentDefinesAreRefusedByName) {
  model::MachineSettings machine = machine_of("[w C' X b Y Z t]");
  machine.chain.at(Axis::C).sense = plant::Sense::table;
  plant::ErrorModel errors;
  errors.component("EXX"_err) = plant::polynomial({0.0, 1e-4});
  EXPECT_EQ(refusal(errors, machine), "exported");
  errors.location("EX0C"_err) = 5.0 * um;
  EXPECT_EQ(refusal(errors, machine),
            "isg cannot represent errors of the rotary axis C: its direction is that of the table "
            "rotation, and the signs of the errors of workpiece_axes are undocumented");
  plant::incline(machine.chain.at(Axis::C), {0.0, 1.0, 1.0});
  machine.chain.at(Axis::C).sense = plant::Sense::tool;
  EXPECT_EQ(
      refusal(errors, machine),
      "isg cannot represent errors of the inclined axis C: no document found defines the frame of "
      "its errors");
}

TEST(ExchangeFiles, ReportsTheMeanOfReversals) {
  const TableExport tables = rich_tables(TableFormat::isg);
  const auto lines = report(tables);
  EXPECT_EQ(lines.back(), "not in these tables: the dependence on the direction of travel (notes)");
  const auto has = [&](const std::string& line) {
    return std::find(lines.begin(), lines.end(), line) != lines.end();
  };
  EXPECT_TRUE(has("position errors: C0Y; the others of the redundant set are 0"));
  EXPECT_TRUE(
      has("note: EYX depends on the direction of travel, by 4.000 um at the ends of the "
          "travel; the tables contain the mean"));
}

}  // namespace
}  // namespace servomill::sim::tables::exchange_files_test
