#include "controllers/gcode/post_report.h"

#include <fmt/format.h>

#include "tests/controllers/gcode/cutter_locations.h"

namespace servomill::controllers::post_report_test {
namespace {

using Eigen::Vector3d;

TEST(PostReport, SingularToolAxisIsToldOnce) {
  const PostProcessed made = post(cl("GOTO/0,0,10\nGOTO/0,0,0\nGOTO/5,0,0\n"), "p.cls",
                                  machine(kTableTable), usual_options());
  ASSERT_EQ(made.warnings.size(), 1u);
  EXPECT_EQ(to_string(made.warnings[0]),
            "p.cls:1: warning: the tool axis is in a singular direction, here and at 2 other "
            "locations: a rotary axis is undetermined");
}

TEST(PostReport, TimesThatAskTooMuchOfAnAxisAreReported) {
  PostOptions options = usual_options();
  options.v_max << 1.0, 1.0, 1.0, 10.0, 20.0;
  // 10 mm past the vertical at 0.01: C turns by 174 deg, most of it within 0.2 mm
  const auto past = [&](double distance) {
    return post(cl(fmt::format("GOTO/0,0,0,-0.2,{0},1\nGOTO/10,0,0,0.2,{0},1\n", distance)),
                "p.cls", machine(kTableTable), options);
  };
  EXPECT_TRUE(std::none_of(past(0.1).warnings.begin(), past(0.1).warnings.end(), [](const auto& w) {
    return w.message.starts_with("the programmed feed");
  }));
  options.feed = 0.5;
  const PostProcessed fast = past(0.01);
  ASSERT_FALSE(fast.warnings.empty());
  const Warning& warning = fast.warnings.back();
  EXPECT_EQ(warning.place.line, 2);
  EXPECT_TRUE(warning.message.starts_with("the programmed feed rate requires C at "))
      << warning.message;
  EXPECT_NE(
      warning.message.find("deg from a singular direction of the tool axis; its limit is 1146: "
                           "the feed rate is reduced to "),
      std::string::npos)
      << warning.message;
}

TEST(PostReport, WhatClassicalPostsBendIsReported) {
  PostOptions options = usual_options();
  options.mode = PostMode::locations;
  const PostProcessed made = post(cl("GOTO/10,0,0,0,-0.1,1\nGOTO/30,0,0,0.3,-0.3,1\nGOTO/30,1,0\n"),
                                  "p.cls", machine(kTableTable), options);
  const auto inverse = machine(kTableTable);
  const Joints Q_0 = inverse.chain().layout.joints(made.moves[1].end_machine);
  const Joints Q_1 = inverse.chain().layout.joints(made.moves[2].end_machine);
  double bend = 0.0;
  for (double t = 0.0; t < 1.0; t += 0.0625) {
    const Vector3d way = options.work_offset + Vector3d(10 + 20 * t, 0, 0) * mm;
    bend = std::max(
        bend,
        (plant::forward(inverse.chain(), Q_0 + t * (Q_1 - Q_0), Vector3d(0, 0, -100 * mm)).p_WT -
         way)
            .norm());
  }
  ASSERT_EQ(made.warnings.size(), 1u);
  EXPECT_EQ(
      to_string(made.warnings.back()),
      fmt::format("p.cls:2: warning: between the previous location and this one the TCP deviates "
                  "from the straight line by {:.4g} mm; --classical inserts no points",
                  bend / mm));
}

TEST(PostReport, WarningsOfWhatIsRefusedAreKept) {
  std::vector<Warning> warnings;
  const ClData data = cl("GOTO/0,0,0\nGOTO/900,0,0\n");
  EXPECT_THROW(post(data, "p.cls", machine(kTableTable), usual_options(), &warnings), InputError);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].place.line, 1);
}

TEST(PostReport, IsFullAfterTwentyErrorsAndThrowsThemAll) {
  const auto inverse = machine(kTableTable);
  const std::string file = "p.cls";
  PostReport report(file, inverse.chain().layout);
  for (int line = 1; line <= 20; ++line) {
    EXPECT_FALSE(report.is_full());
    report.fault(line, "is out of reach");
  }
  EXPECT_TRUE(report.is_full());
  report.note_singular(7);
  std::vector<Warning> warnings;
  try {
    report.conclude(&warnings);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.faults().size(), 20u);
  }
  EXPECT_EQ(warnings.size(), 1u);
}

TEST(PostReport, KeepsTheWorstBendAndTheMostSlowedBlock) {
  const auto inverse = machine(kTableTable);
  const std::string file = "p.cls";
  PostReport report(file, inverse.chain().layout);
  report.note_bend(3, 1.0 * um);
  report.note_bend(5, 4.0 * um);
  report.note_bend(8, 2.0 * um);
  report.note_slowed({{3, 0, 2.0, 1.0}, {3, 4, 4.0, 1.0}});
  report.note_slowed({{9, 1, 3.0, 1.0}});
  const std::vector<Warning> warnings = report.conclude(nullptr);
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_EQ(warnings[0].place.line, 5);
  EXPECT_NE(warnings[0].message.find("by 0.004 mm, and exceeds the tolerance on 2 other moves"),
            std::string::npos)
      << warnings[0].message;
  EXPECT_EQ(warnings[1].place.line, 3);
  EXPECT_TRUE(warnings[1].message.starts_with("the programmed feed rate requires C at "))
      << warnings[1].message;
}

}  // namespace
}  // namespace servomill::controllers::post_report_test
