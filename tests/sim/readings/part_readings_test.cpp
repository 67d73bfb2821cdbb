#include "sim/readings/part_readings.h"

#include <gtest/gtest.h>

#include "plant/vocabulary/units.h"
#include "tests/sim/readings/reading_files.h"
#include "tests/text.h"

namespace servomill::sim::readings::part_readings_test {
namespace {

class PartReadings : public testing::Test {
 protected:
  std::vector<PartPoint> read(const std::string& text) {
    return read_part_table(files_.write("part.csv", text));
  }
  // Full messages, without the folder.
  std::string refusal(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      std::string out = error.what();
      const std::string folder = files_.path("");
      for (auto at = out.find(folder); at != std::string::npos; at = out.find(folder)) {
        out.erase(at, folder.size());
      }
      return out;
    }
    return "accepted";
  }
  ReadingFiles files_;
};

TEST_F(PartReadings, TakeUnitsFromTheHeading) {
  for (const char* text :
       {"x_mm,y_mm,z_mm,i,j,k,deviation_um\n1,2,3,0,-1,0,12.5\n",
        "name;X [mm];Y [mm];Z [mm];nx;ny;nz;deviation [mm]\nP1;1;2;3;0;-1;0;0,0125\n"}) {
    const std::vector<PartPoint> points = read(text);
    ASSERT_EQ(points.size(), 1U) << text;
    EXPECT_LT((points[0].point - Eigen::Vector3d(1, 2, 3) * mm).norm(), 1e-15);
    EXPECT_EQ(points[0].normal, -Eigen::Vector3d::UnitY());
    EXPECT_NEAR(points[0].deviation, 12.5 * um, 1e-18);
    EXPECT_EQ(points[0].place.line, 2);
  }
}

TEST_F(PartReadings, NormaliseRoundedNormals) {
  const auto points = read("x_mm,y_mm,z_mm,i,j,k,deviation_um\n1,2,3,0.707,-0.707,0,0\n");
  EXPECT_NEAR(points.at(0).normal.norm(), 1.0, 1e-15);
}

TEST_F(PartReadings, RefuseWhatIsMissing) {
  EXPECT_EQ(refusal("x_mm,y_mm,i,j,k,deviation\n1,2,0,-1,0,5\n"),
            "part.csv: error: has no column z_mm\n"
            "part.csv: error: column deviation has no unit of length: name it deviation_um");
  EXPECT_EQ(refusal("x_mm,y_mm,z_mm,i,j,k,deviation_um\n1,,3,0,-1,0,5\n1,2,3,0,-1,0,five\n"),
            "part.csv:2:3: error: y_mm is empty\n"
            "part.csv:3:14: error: deviation_um = five; must be a number");
  EXPECT_EQ(refusal("x_mm,y_mm,z_mm,i,j,k,deviation_um\n1,2,3,0,-1,1,5\n"),
            "part.csv:2: error: i, j, k have length 1.41; a normal must have length 1");
}

}  // namespace
}  // namespace servomill::sim::readings::part_readings_test
