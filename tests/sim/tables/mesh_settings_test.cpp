// Bed meshes of firmwares make the tip move in a plane.
#include "sim/tables/mesh_settings.h"

#include <gtest/gtest.h>

#include "controllers/tables/mesh_table.h"
#include "sim/model/machine.h"
#include "tests/sim/tables/rich_tables.h"
#include "tests/text.h"

namespace servomill::sim::tables::mesh_settings_test {
namespace {

constexpr std::array<TableFormat, 3> kFirmwares = {TableFormat::marlin, TableFormat::klipper,
                                                   TableFormat::reprapfirmware};

TableRequest mesh_request(TableFormat format, int nx = 5, int ny = 4) {
  TableRequest request = request_of(format);
  request.mesh = {nx, ny};
  return request;
}

// Bowed and twisted rails, and a leaning Z that the skew correction takes.
plant::ErrorModel bed() {
  plant::ErrorModel errors;
  errors.component("EZX"_err) = plant::polynomial({0.0, 1e-4, -5e-4});
  errors.component("EZY"_err) = plant::polynomial({0.0, -2e-4, 8e-4});
  errors.component("EAX"_err) = plant::polynomial({0.0, 3e-4});
  return errors;
}

std::string text_of(const std::vector<TextFile>& files, const std::string& name) {
  for (const TextFile& file : files) {
    if (file.name == name) return file.text;
  }
  return "no " + name;
}

TEST(MeshSettings, EveryFirmwareReadsWhatWasMeant) {
  for (const char* structure : {"[w b X Y Z t]", "[w Y b X Z t]", "[w X Y b Z t]"}) {
    for (const TableFormat format : kFirmwares) {
      plant::ErrorModel errors = bed();
      for (const double skew : {0.0, 300e-6}) {
        errors.location("EC0Y"_err) = skew;
        errors.location("EB0Z"_err) = -0.5 * skew;
        const TableExport e = export_tables(machine_of(structure), errors, mesh_request(format));
        const auto files = table_files(e);
        EXPECT_EQ(files.size(), skew == 0.0 ? 1u : 2u);
        EXPECT_EQ(fault_of(e, files), "verified") << structure << name_of(format);
        EXPECT_EQ(verify_tables(e, files).positions, 20u);
        ASSERT_TRUE(e.mesh);
        EXPECT_LT(e.mesh->after, 0.2 * e.mesh->before);
      }
    }
  }
}

// More points, less between them: bilinear, so with the square of the spacing.
TEST(MeshSettings, RemainderFallsWithTheSquareOfTheSpacing) {
  const auto after = [](int n) {
    // large beside the digit of 1 um
    return export_tables(machine_of("[w b X Y Z t]"), plant::scaled(bed(), 100.0),
                         mesh_request(TableFormat::klipper, n, n))
        .mesh->after;
  };
  EXPECT_NEAR(after(5) / after(9), 4.0, 1.2);
}

// The tip is high where EZX is positive: the firmware has to add less.
TEST(MeshSettings, SignsOfTheFirmwares) {
  plant::ErrorModel errors;
  errors.component("EZX"_err) = plant::polynomial({0.0, 1e-4});
  const model::MachineSettings machine = machine_of("[w b X Y Z t]");
  const auto first_and_last = [&](TableFormat format, const std::string& name) {
    const auto file = table_files(export_tables(machine, errors, mesh_request(format, 3, 3)));
    const auto firmware = format == TableFormat::klipper ? controllers::SkewFirmware::klipper
                          : format == TableFormat::marlin
                              ? controllers::SkewFirmware::marlin
                              : controllers::SkewFirmware::reprapfirmware;
    const auto mesh = controllers::read_mesh_table({name, text_of(file, name)}, firmware);
    return mesh.z.back() - mesh.z.front();
  };
  const double travel = machine.nc.upper[0] - machine.nc.lower[0];
  EXPECT_NEAR(first_and_last(TableFormat::klipper, "bed_mesh.cfg"), -1e-4 * travel, 1.1e-6);
  EXPECT_NEAR(first_and_last(TableFormat::marlin, "bed_mesh.gcode"), -1e-4 * travel, 1.1e-6);
  EXPECT_NEAR(first_and_last(TableFormat::reprapfirmware, "heightmap.csv"), -1e-4 * travel, 1.1e-6);
}

TEST(MeshSettings, AChangedHeightIsFound) {
  for (const TableFormat format : kFirmwares) {
    const TableExport e = export_tables(machine_of("[w b X Y Z t]"), bed(), mesh_request(format));
    auto files = table_files(e);
    std::string& text = files.back().text;
    const std::string last =
        text.substr(0, text.find(format == TableFormat::klipper ? "min_x" : "\1"));
    const std::size_t point = last.rfind('.');
    text[point + 1] = text[point + 1] == '9' ? '8' : char(text[point + 1] + 1);
    EXPECT_NE(fault_of(e, files), "verified") << name_of(format);
  }
}

TEST(MeshSettings, ReadersRefuseWhatTheyDoNotKnow) {
  using controllers::SkewFirmware;
  const auto faults = [](const std::string& text, SkewFirmware firmware) {
    return fault_messages([&] { controllers::read_mesh_table({"m", text}, firmware); });
  };
  EXPECT_EQ(faults("M421 I0 J0 Z0.1\nG29\n", SkewFirmware::marlin),
            "'G29' is not supported; only M421 I J Z\n");
  EXPECT_EQ(faults("M421 I0 J0 Z0.1\nM421 I1 J1 Z0.1\n", SkewFirmware::marlin),
            "2 heights in a mesh of 2 x 2\n");
  EXPECT_EQ(faults("min_x = 3\n", SkewFirmware::klipper), "'min_x = 3' is not supported\n");
  EXPECT_EQ(faults("RepRapFirmware height map file v2\n"
                   "axis0,axis1,min0,max0,min1,max1,radius,spacing0,spacing1,num0,num1\n"
                   "X,Y,0,10,0,10,-1,10,10,2,2\n0.001, 0\n0.001, 0.002\n",
                   SkewFirmware::reprapfirmware),
            "the mesh contains a point that was not probed\n");
}

}  // namespace
}  // namespace servomill::sim::tables::mesh_settings_test
