// Sentences of a calibration on its readings: what they cannot tell, and which are wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/calibration/identified_errors.h"
#include "sim/calibration/make_up.h"
#include "sim/calibration/report.h"
#include "tests/sim/calibration/random_machine.h"

namespace servomill::sim::calibration::findings_test {
namespace {

using plant::operator""_err;

// Straightness at tools across tells the roll, too, but for its slope: every line has a slope of
// its own.
TEST(Findings, NamesTheRollThatLevelsDoNotSee) {
  readings::Readings all = shop_readings(false);
  make_up(all, gantry(), {}, 3);
  const Calibration found = calibrated(all);
  EXPECT_TRUE(is_combined(found.adjustment, "ECZ"_err));
  ASSERT_EQ(unidentifiable_sentences(found).size(), 1u);
  EXPECT_TRUE(unidentifiable_sentences(found)[0].starts_with(
      "a part of ECZ cannot be separated from the set-up (zero of \"X "))
      << unidentifiable_sentences(found)[0];
  std::erase_if(all.groups, [](const readings::Group& group) {
    return group.axis == Axis::Z && group.p_ST.head<2>().norm() > 0.0;
  });
  const Calibration less = calibrated(all);
  ASSERT_EQ(unidentifiable_sentences(less).size(), 1u);
  EXPECT_TRUE(unidentifiable_sentences(less)[0].starts_with(
      "ECZ cannot be separated from the set-up (zero of \"X "))
      << unidentifiable_sentences(less)[0];
}

TEST(Findings, FindsTheGroupWhoseSignIsWrong) {
  Normal normal(4);
  readings::Readings all = shop_readings();
  const Truth truth = random_truth(calibrated(all).adjustment.unknowns, normal);
  make_up(all, gantry(), truth.errors, 5);
  for (readings::Reading& reading : all.groups[4].rows) reading.deviation *= -1.0;
  const Calibration found = calibrated(all);
  ASSERT_EQ(found.suspects.size(), 1u);
  EXPECT_EQ(found.suspects[0].groups, std::vector<std::size_t>{4});
  EXPECT_EQ(found.suspects[0].factor, -1.0);
}

// Errors are polynomials of degree 4: less does not predict a target that was left out, more not
// better.
TEST(Findings, ChoosesTheSmoothnessThatPredictsTargetsLeftOut) {
  Normal normal(41);
  readings::Readings all = shop_readings();
  CalibrationSettings settings;
  settings.form_linear.degree = 4;
  const Truth truth = random_truth(calibrated(all, settings).adjustment.unknowns, normal);
  make_up(all, gantry(), truth.errors, 42);
  settings.form_linear.degree.reset();
  settings.form_linear.degree_by_data = true;
  const Calibration found = calibrated(all, settings);
  ASSERT_EQ(found.smoothness.size(), 1u);
  EXPECT_EQ(found.smoothness[0].chosen, 4);
  ASSERT_EQ(found.smoothness[0].errors.size(), 9u);
  EXPECT_GT(found.smoothness[0].errors[1].second, 2.0 * found.smoothness[0].errors[3].second);
  // above 1: what predicts a target is uncertain, too
  EXPECT_GT(found.smoothness[0].errors[3].second, 1.0);
  EXPECT_LT(found.smoothness[0].errors[3].second, 2.5);
  EXPECT_NE(report(found).find("degree of linear by cross-validation: 4; excluded readings"),
            std::string::npos);
}

// Knots at the quarters of the travel.
TEST(Findings, ChoosesTheNumberOfKnots) {
  Normal normal(43);
  readings::Readings all = shop_readings();
  CalibrationSettings settings;
  settings.form_linear.number_of_knots = 5;
  const Truth truth = random_truth(calibrated(all, settings).adjustment.unknowns, normal);
  make_up(all, gantry(), truth.errors, 44);
  settings.form_linear.number_of_knots.reset();
  settings.form_linear.knots_by_data = true;
  const Calibration found = calibrated(all, settings);
  ASSERT_EQ(found.smoothness.size(), 1u);
  EXPECT_EQ(found.smoothness[0].chosen, 5);
}

TEST(Findings, NamesAnOutlierOfATenthOfAMillimetre) {
  readings::Readings all = shop_readings();
  make_up(all, gantry(), {}, 6);
  all.groups[1].rows[3].deviation[0] += 0.1e-3;
  const Calibration found = calibrated(all);
  ASSERT_FALSE(found.outliers.empty());
  const Observation& worst = found.observations.all[found.outliers[0].observation];
  EXPECT_EQ(worst.group, 1u);
  EXPECT_EQ(worst.row, 3u);
  EXPECT_GT(found.outliers[0].standardized, 50.0);
}

TEST(Findings, EstimatesTheUncertaintyOfAGroup) {
  Normal normal(8);
  readings::Readings all = shop_readings();
  const Truth truth = random_truth(calibrated(all).adjustment.unknowns, normal);
  for (readings::Group& group : all.groups) {
    if (group.kind == readings::Kind::straightness) group.uncertainty = 2.5e-6;
  }
  make_up(all, gantry(), truth.errors, 9);
  for (readings::Group& group : all.groups) {
    if (group.kind == readings::Kind::straightness) group.uncertainty.reset();
  }
  const Calibration found = calibrated(all);
  double mean = 0.0;
  int count = 0;
  for (std::size_t g = 0; g < all.groups.size(); ++g) {
    if (all.groups[g].kind != readings::Kind::straightness) continue;
    mean += found.adjustment.groups[g].uncertainty;
    ++count;
  }
  EXPECT_NEAR(mean / count, 2.5e-6, 0.3e-6);
}

// Lines of X read in both directions, on a machine whose X loses 6 um: found without being asked
// for. Y loses nothing, and its error gets no step.
TEST(Findings, FindsLostMotionWhereThereIsSome) {
  readings::Readings all;
  for (const Axis axis : {Axis::X, Axis::Y}) {
    readings::Group group =
        line(readings::Kind::positioning, axis, Joints::Zero(), Eigen::Vector3d::Zero(), 0.5e-6);
    const std::vector<readings::Reading> once = group.rows;
    group.rows.insert(group.rows.end(), once.rbegin(), once.rend());
    for (std::size_t k = 0; k < group.rows.size(); ++k) {
      group.rows[k].direction[std::size_t(index_of(axis))] = k < once.size() ? 1 : -1;
    }
    all.groups.push_back(group);
  }
  make_up(all, gantry(), {}, 12);
  for (readings::Reading& reading : all.groups[0].rows) {
    reading.deviation[0] += reading.direction[0] > 0 ? -3e-6 : 3e-6;
  }
  const Calibration found = calibrated(all);
  for (const KnownFunction& known : functions_along_travel(found.adjustment)) {
    if (known.name == "EXX"_err) {
      ASSERT_TRUE(known.reversal);
      EXPECT_LT(std::abs(known.reversal->first + 6e-6), 3.5 * known.reversal->second);
      EXPECT_NEAR(known.reversal->second, 0.5e-6 * std::sqrt(2.0 / 11.0), 0.02e-6);
    } else if (known.name == "EYY"_err) {
      EXPECT_FALSE(known.reversal);
    }
  }
}

// The bar is 101 mm long, and 100 mm stand in the file.
TEST(Findings, NamesABallBarThatIsAMillimetreLonger) {
  readings::Readings all;
  readings::Group circle;
  circle.kind = readings::Kind::circle;
  circle.name = "bar";
  circle.at.head<3>() << 0.5, 0.5, 0.5;
  circle.radius = 0.1;
  circle.uncertainty = 1e-6;
  for (int k = 0; k < 36; ++k) {
    readings::Reading reading;
    reading.Q = circle.at;
    reading.Q[0] += 0.1 * std::cos(std::numbers::pi / 18.0 * k);
    reading.Q[1] += 0.1 * std::sin(std::numbers::pi / 18.0 * k);
    circle.rows.push_back(reading);
  }
  all.groups = {circle};
  make_up(all, gantry(), {}, 13);
  for (readings::Reading& reading : all.groups[0].rows) reading.deviation[0] += 1e-3;
  CalibrationSettings settings;
  settings.errors = {"EC0Y"_err};
  const auto found = warnings(calibrated(all, settings));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].starts_with("radius of \"bar\" is estimated ")) << found[0];
  EXPECT_TRUE(found[0].ends_with(" mm larger than stated: check it")) << found[0];
  all.groups[0].size_uncertainty = 2e-6;
  const auto known = warnings(calibrated(all, settings));
  ASSERT_FALSE(known.empty());
  EXPECT_TRUE(known[0].ends_with("times its uncertainty: check it")) << known[0];
}

TEST(Findings, SaysWhereLostMotionStaysUnknown) {
  readings::Readings all;
  all.groups = {
      line(readings::Kind::positioning, Axis::X, Joints::Zero(), Eigen::Vector3d::Zero(), 0.5e-6)};
  EXPECT_EQ(calibrated(all).one_way, std::vector<Axis>{Axis::X});
}

TEST(Findings, NamesTheErrorsOfAnAxisThatNoGroupMoves) {
  readings::Readings all = shop_readings();
  std::erase_if(all.groups, [](const readings::Group& group) {
    return group.axis == Axis::Z || group.kind == readings::Kind::squareness;
  });
  for (readings::Group& group : all.groups) {
    for (readings::Reading& row : group.rows) row.Q[2] = 0.5;
  }
  make_up(all, gantry(), {}, 31);
  const Calibration found = calibrated(all);
  const auto sentences = unidentifiable_sentences(found);
  EXPECT_EQ(sentences.back(), "no group moves Z: cannot determine EXZ, EYZ, EZZ, EAZ, EBZ and ECZ");
  const auto keys = identified_errors(found, "found").values.unidentifiable;
  EXPECT_EQ(std::count(keys.begin(), keys.end(), "errors.found.EZZ"), 1);
  EXPECT_EQ(std::count(keys.begin(), keys.end(), "errors.found.EXX"), 0);
}

bool warns(const Calibration& found, const std::string& text) {
  const auto all = warnings(found);
  return std::any_of(all.begin(), all.end(),
                     [&](const std::string& one) { return one.find(text) != std::string::npos; });
}

// Readings in mm in a column of um: their scatter is a thousandth of what is stated.
TEST(Findings, NamesResidualsThatAreFarTooSmall) {
  readings::Readings all;
  all.groups.push_back(line(readings::Kind::positioning, Axis::X, Joints::Zero(),
                            Eigen::Vector3d::Zero(), 0.3e-6, 41));
  make_up(all, gantry(), {}, 32);
  CalibrationSettings settings;
  settings.form_linear.degree = 1;
  constexpr const char* kSmall =
      "times those expected from its uncertainty of 0.3 um: readings in a larger unit than stated "
      "(mm for "
      "um), copied rows, or an uncertainty stated too large";
  EXPECT_FALSE(warns(calibrated(all, settings), kSmall));
  for (readings::Reading& row : all.groups[0].rows) row.deviation /= 1000.0;
  EXPECT_TRUE(warns(calibrated(all, settings), kSmall));
}

TEST(Findings, NamesACopiedRow) {
  readings::Readings all = shop_readings();
  make_up(all, gantry(), {}, 33);
  EXPECT_FALSE(warns(calibrated(all), "in every value"));
  readings::Reading copy = all.groups[2].rows[4];
  copy.line = 20;
  all.groups[2].rows.push_back(copy);
  EXPECT_TRUE(
      warns(calibrated(all), ":20: equals line 6 in every value; it is used: remove copied rows"));
}

}  // namespace
}  // namespace servomill::sim::calibration::findings_test
