// Days side by side, worked out by hand; and a day read back from its file.
#include "sim/run/day_comparison.h"

#include <gtest/gtest.h>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/records/hdf5_group.h"
#include "sim/records/input_file.h"
#include "sim/records/output_file.h"
#include "sim/run/day_course.h"
#include "sim/run/day_report.h"
#include "sim/run/store_day.h"

namespace servomill::sim::run::day_comparison_test {
namespace {

constexpr double kHour = 3600.0;

DayCourse day() {
  DayCourse out;
  out.time = {0.0, 1.0 * kHour, 2.0 * kHour};
  out.bodies = {"head"};
  out.temperatures = {{293.15, 299.15, 297.15}};
  out.sensors = {"nose"};
  out.readings = {{293.15, 290.15, 292.15}};
  out.places = {"centre"};
  out.drift = {{{}, {1.0 * um, 0, -3.0 * um, 0, 2.0 * urad, 0}, {2.0 * um, 0, -1.0 * um, 0, 0, 0}}};
  out.ranges = {{"centre",
                 {1.0 * um, 0, 3.0 * um, 0, 2.0 * urad, 0},
                 {2.0 * um, 0, 3.0 * um, 0, 2.0 * urad, 0},
                 {}}};
  out.cycles = {{0.0, 1.0 * um, 1.5 * um},
                {0.5 * kHour, 2.0 * um, 4.0 * um},
                {1.0 * kHour, 1.0 * um, 3.0 * um}};
  return out;
}

bool has_line(const std::string& text, const std::string& what, const std::string& at,
              const std::string& values) {
  std::size_t begin = 0;
  for (std::size_t end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    std::string line;
    for (const char c : text.substr(begin, end - begin)) {
      if (c != ' ' || (!line.empty() && line.back() != ' ')) line += c;
    }
    while (!line.empty() && line.back() == ' ') line.pop_back();
    if (line.ends_with(at + " " + values) && (line.starts_with(what) || line.starts_with(at))) {
      return true;
    }
  }
  return false;
}

TEST(DaysSideBySide, HaveAColumnEach) {
  DayCourse cool = day();
  cool.temperatures[0] = {293.15, 294.15, 293.15};
  cool.sensors.clear();
  cool.readings.clear();
  cool.ranges[0].whole[2] = 0.5 * um;
  cool.stopped = "body head is too cold";
  const std::string text = days_side_by_side({{"warm", std::make_shared<const DayCourse>(day())},
                                              {"cool", std::make_shared<const DayCourse>(cool)}});
  EXPECT_TRUE(has_line(text, "range of drift", "centre Z", "um 3.00 0.50")) << text;
  EXPECT_TRUE(has_line(text, "first 60 min", "centre X", "um 1.00 1.00")) << text;
  EXPECT_TRUE(has_line(text, "range of drift", "centre B", "urad 2.00 2.00")) << text;
  EXPECT_TRUE(has_line(text, "change of temperature", "head", "K 6.00 1.00")) << text;
  EXPECT_TRUE(has_line(text, "change of reading", "nose", "K -3.00 -")) << text;
  EXPECT_TRUE(has_line(text, "displacement by heat", "worst part", "um 4.00 4.00")) << text;
  EXPECT_TRUE(has_line(text, "displacement by heat", "last part", "um 3.00 3.00")) << text;
  EXPECT_TRUE(text.ends_with("day of cool stopped: body head is too cold\n"));
}

TEST(DayOfAFile, IsTheOneThatWasWritten) {
  const std::string path = testing::TempDir() + "day_comparison_test.h5";
  const DayCourse wanted = day();
  {
    records::OutputFile file(path, true);
    write_day(file.root().group("day"), wanted);
    file.commit();
  }
  const records::InputFile file(path);
  EXPECT_EQ(read_day(file, "/night"), nullptr);
  const auto found = read_day(file, "/day");
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->bodies, wanted.bodies);
  EXPECT_EQ(found->sensors, wanted.sensors);
  EXPECT_EQ(found->places, wanted.places);
  for (std::size_t n = 0; n < wanted.time.size(); ++n) {
    EXPECT_NEAR(found->time[n], wanted.time[n], 1e-9);
    EXPECT_NEAR(found->temperatures[0][n], wanted.temperatures[0][n], 1e-9);
    EXPECT_NEAR(found->readings[0][n], wanted.readings[0][n], 1e-9);
    for (std::size_t c = 0; c < kDrifts; ++c) {
      EXPECT_NEAR(found->drift[0][n][c], wanted.drift[0][n][c], 1e-18);
    }
  }
  EXPECT_EQ(day_table(*found), day_table(wanted));
}

TEST(DayOfAFile, IsRefusedWithListsOfDifferentLengths) {
  const std::string path = testing::TempDir() + "day_comparison_wrong.h5";
  DayCourse wrong = day();
  wrong.readings[0].pop_back();
  {
    records::OutputFile file(path, true);
    write_day(file.root().group("day"), wrong);
    file.commit();
  }
  const records::InputFile file(path);
  try {
    read_day(file, "/day");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("'/day/sensor_nose' has 2 values in place of 3"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace servomill::sim::run::day_comparison_test
