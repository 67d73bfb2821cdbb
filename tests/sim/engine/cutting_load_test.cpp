/// Forces of the cut in a simulated machine.
#include "sim/engine/cutting_load.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <numbers>

#include "controllers/servo/cascade.h"
#include "plant/cutting/cutting_force.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/run/run_output.h"
#include "sim/run/store.h"
#include "sim/run/stored_run.h"
#include "tests/counting_new.h"
#include "tests/sim/cutting_block.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::engine::cutting_load_test {
namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

model::Scenario cutting_scenario(const std::string& program, const std::string& more) {
  return small_scenario(program, kTool + kBlock + kSteel + more);
}

// Force in the slot in steady motion (N, in W).
plant::CuttingForce slot_force() {
  const plant::EngagedArc arc{.width = 2 * mm, .height = 1 * mm, .from = 0.0, .to = kPi};
  return plant::average_force(plant::find_material("42CrMo4")->typical, 4, {}, {&arc, 1});
}
const double kChip = 1394.0 / (4775.0 * 4) * mm;  // feed per tooth

std::vector<std::size_t> middle(const run::CaseOutput& out) {
  return rows_within(out.result.servo, -5.0, 10.0);
}

Vector3d mean_force(const run::CaseOutput& out) {
  Vector3d F;
  for (int i = 0; i < 3; ++i)
    F[i] = mean_of(out.result.servo, "cutting_force", "XYZ"[i], middle(out));
  return F;
}

TEST(CuttingTable, is_linear_between_rows_and_zero_beyond_them) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY();
  const CuttingTable table({{1.0, 2e-3, 1e6 * x, 10.0 * y, 0.0},
                            {3.0, 2e-3, 3e6 * x, 30.0 * y, 2.0},
                            {3.0, 0.0, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 2.0},
                            {4.0, 0.0, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 2.0}});
  CuttingTable::Cursor cursor;
  const double speed = 0.02;  // feed per tooth 40 um
  const auto at = [&](double s) { return table.force(s, speed, 1.5, 0.1, cursor); };
  constexpr double kRounding = 1e-9;  // N
  EXPECT_TRUE(at(0.5).isZero(0.0));
  EXPECT_LE((at(1.0) - Vector3d(40.0, 15.0, 0.0)).norm(), kRounding);
  EXPECT_LE((at(2.0) - Vector3d(80.0, 1.6 * 20.0, 0.0)).norm(), kRounding);
  EXPECT_LE((at(3.0) - Vector3d(120.0, 1.7 * 30.0, 0.0)).norm(), kRounding);
  EXPECT_TRUE(at(3.5).isZero(0.0));
  EXPECT_TRUE(at(4.5).isZero(0.0));
  EXPECT_LE((at(2.0) - Vector3d(80.0, 1.6 * 20.0, 0.0)).norm(), kRounding) << "and back";
  EXPECT_TRUE(table.force(2.0, 0.0, 1.0, 0.0, cursor).isZero(0.0)) << "standing";
}

TEST(CuttingLoad, takes_nothing_from_the_heap) {
  const model::Scenario scenario = cutting_scenario(kSlot, one_case("cut"));
  const CuttingTable table({{0.0, 2e-3, {1e6, 0.0, 0.0}, {10.0, 0.0, 0.0}, 0.0},
                            {1.0, 2e-3, {1e6, 0.0, 0.0}, {10.0, 0.0, 0.0}, 1.0}});
  const model::CuttingWear wear;
  const Vector3d compliance(1e-8, 1e-8, 1e-8);
  CuttingLoad load(table, wear, scenario.machine.chain, compliance);
  const std::size_t before = allocations;
  for (int n = 1; n < 100; ++n) load.advance(1e-3 * n, 0.2, Joints::Zero(), {0.0, 0.0, -0.1});
  EXPECT_EQ(allocations, before);
  EXPECT_GT(load.force().x(), 0.0);
}

TEST(Cutting, force_in_a_slot_is_that_of_the_closed_form) {
  const run::CaseOutput out = run_named_case(cutting_scenario(kSlot, one_case("cut")), "cut");
  const Vector3d F = mean_force(out), expected = slot_force().at(kChip);
  EXPECT_LE((F - expected).norm(), 1e-3 * expected.norm()) << F.transpose();  // of the speed
  EXPECT_EQ(largest_of(out.result.servo, "structural_deflection", 'X', middle(out)), 0.0);
  const records::Series& servo = out.result.servo;
  EXPECT_EQ(servo.find("cutting_force")->units, "N");
  EXPECT_EQ(servo.find("structural_deflection")->units, "um");
}

TEST(Cutting, force_grows_with_wear_and_with_the_length_that_was_cut) {
  const model::Scenario scenario = small_scenario(
      kSlot, kTool + kBlock + "[cutting]\nmaterial = \"42CrMo4\"\nwear_per_m = 10.0\n" +
                 one_case("new") + one_case("worn", "wear = 2.5\n"));
  const run::CaseOutput fresh = run_named_case(scenario, "new"),
                        worn = run_named_case(scenario, "worn");
  const Vector3d E = slot_force().edge, more = mean_force(worn) - mean_force(fresh);
  EXPECT_LE((more - 1.5 * E).norm(), 1e-3 * E.norm());
  // from 15 to 30 mm behind the first touch at X-24: 1 + 10/m x 26.5 mm on average
  const Vector3d expected = slot_force().at(kChip, 1.0 + 10.0 * 26.5 * mm);
  EXPECT_LE((mean_force(fresh) - expected).norm(), 2e-3 * expected.norm());
}

TEST(Cutting, is_felt_by_no_one_in_air) {
  const model::Scenario without = small_scenario(kSlot, kTool + one_case("air"));
  const model::Scenario with = cutting_scenario(kSlot, one_case("air", "cutting = false\n"));
  EXPECT_EQ(run_named_case(without, "air").result.servo.by_rows(),
            run_named_case(with, "air").result.servo.by_rows());
}

// Only one of the two cases has a force to record.
TEST(Cutting, comes_back_from_its_file_beside_a_case_in_air) {
  const model::Scenario scenario =
      cutting_scenario(kSlot, one_case("cut") + one_case("air", "cutting = false\n") +
                                  "[[quantity]]\nname = \"cycle_time\"\n");
  const auto folder = std::filesystem::path(testing::TempDir()) / fmt::format("cut_{}", getpid());
  std::filesystem::create_directories(folder);
  const std::string path = folder / "cut.h5";
  run::RunStore store(path, false, scenario);
  for (const char* name : {"cut", "air"}) store.add(run_named_case(scenario, name));
  store.commit({});
  const run::StoredRun back = run::read_run(path);
  std::filesystem::remove_all(folder);
  ASSERT_EQ(back.cases.size(), 2U);
  EXPECT_TRUE(back.cases[0].servo->column("cutting_force", 'X').has_value());
  EXPECT_FALSE(back.cases[1].servo->column("cutting_force", 'X').has_value());
  EXPECT_EQ(evaluation::compare(back.quantities, back.cases).size(), 2U);
}

// An integrating velocity loop leaves nothing of a constant force at the scale.
TEST(Cutting, displaces_the_tip_by_force_over_stiffness_and_not_the_scale) {
  const model::Scenario scenario = cutting_scenario(
      kSlot,
      "[machine_override.axis.X]\nscale_step = 0.0\nstructural_stiffness = \"50 N/um\"\n"
      "[machine_override.axis.Y]\nscale_step = 0.0\nstructural_stiffness = \"40 N/um\"\n"
      "[machine_override.axis.Z]\nscale_step = 0.0\nstructural_stiffness = \"20 N/um\"\n" +
          one_case("air", "cutting = false\n") + one_case("cut"));
  const run::CaseOutput air = run_named_case(scenario, "air"),
                        cut = run_named_case(scenario, "cut");
  const Vector3d F = slot_force().at(kChip);
  const Vector3d expected = F.cwiseQuotient(Vector3d(50.0, 40.0, 20.0));  // um
  constexpr double kSettled = 0.02;  // um: what is left of the entry, and motor steps
  for (int i = 0; i < 3; ++i) {
    const char axis = "XYZ"[i];
    const auto more = [&](const std::string& name) {
      return mean_of(cut.result.servo, name, axis, middle(cut)) -
             mean_of(air.result.servo, name, axis, middle(air));
    };
    EXPECT_NEAR(more("true_linear") * 1e3, 0.0, kSettled) << axis;
    EXPECT_NEAR(more("tool_deviation"), expected[i], kSettled) << axis;
  }
}

// Without integral part the drive gives way like a spring: F r^2 / (Kp Kv) at the scale.
TEST(Cutting, bends_a_proportional_drive_by_its_static_stiffness) {
  const model::Scenario scenario = cutting_scenario(
      kSlot, "[machine_override.axis.Y]\nscale_step = 0.0\nvelocity_reset_time_ms = 0.0\n" +
                 one_case("air", "cutting = false\n") + one_case("cut"));
  const run::CaseOutput air = run_named_case(scenario, "air"),
                        cut = run_named_case(scenario, "cut");
  const controllers::CascadeParams& y = scenario.machine.nc.cascade[1];
  const double expected = slot_force().at(kChip).y() * y.r * y.r / (y.Kp * y.Kv);
  const double bent = (mean_of(cut.result.servo, "true_linear", 'Y', middle(cut)) -
                       mean_of(air.result.servo, "true_linear", 'Y', middle(air))) *
                      mm;
  EXPECT_NEAR(bent, expected, 0.005 * std::abs(expected));
}

TEST(Cutting, meets_nothing_where_the_cutter_has_been) {
  const std::string twice =
      "G17 G90 T1 M6\nG43 H1\nS4775 M3\nG0 X-30 Y0\nZ-2\n(MSG, first)\nG1 X30 F1394\n(MSG, "
      "second)\nG1 X-30\nM30\n";
  const run::CaseOutput out = run_named_case(cutting_scenario(twice, one_case("cut")), "cut");
  const records::Series& servo = out.result.servo;
  const std::size_t section = *servo.column("section"), F = *servo.column("cutting_force", 'Y');
  double first = 0.0, second = 0.0;
  for (std::size_t n = 0; n < servo.rows(); ++n) {
    double& most =
        out.sections[static_cast<std::size_t>(servo.at(n, section))] == "second" ? second : first;
    most = std::max(most, std::abs(servo.at(n, F)));
  }
  EXPECT_GT(first, 100.0);
  EXPECT_EQ(second, 0.0);
}

// Finishing a boss with 0.1 mm of allowance: the same force all around, and none on a second turn
// of the same circle, although steps of the removed volume are chords.
TEST(Cutting, follows_a_circle_and_leaves_nothing_for_a_second_turn) {
  const std::string circles =
      "G17 G90 T1 M6\nG43 H1\nS4775 M3\nG0 X30 Y0\nZ-2\nG1 X24 F1394\n(MSG, first)\nG2 X24 Y0 "
      "I-24 J0\n(MSG, second)\nG2 X24 Y0 I-24 J0\nM30\n";
  const model::Scenario scenario = small_scenario(
      circles, kTool + kSteel +
                   "[[part.stock]]\ncylinder = { centre_mm = [0.0, 0.0], radius_mm = 20.1, from_mm "
                   "= -20.0, to_mm = 0.0 }\n" +
                   one_case("cut"));
  const run::CaseOutput out = run_named_case(scenario, "cut");
  const records::Series& servo = out.result.servo;
  const std::size_t section = *servo.column("section"), s = *servo.column("s");
  // clockwise about the boss, material on the right: climb milling of a curved wall
  const double a = 24 * mm, R = 4 * mm, wall = 20.1 * mm;
  const double phi = std::acos((a * a + R * R - wall * wall) / (2.0 * a * R));
  const plant::EngagedArc arc{.width = 2 * mm, .height = 1 * mm, .from = kPi - phi, .to = kPi};
  const double expected =
      plant::average_force(plant::find_material("42CrMo4")->typical, 4, {}, {&arc, 1})
          .at(kChip)
          .norm();
  double s_first = 0.0, second = 0.0;
  for (std::size_t n = 0; n < servo.rows(); ++n) {
    Vector3d F;
    for (int i = 0; i < 3; ++i) F[i] = servo.at(n, *servo.column("cutting_force", "XYZ"[i]));
    const std::string& name = out.sections[static_cast<std::size_t>(servo.at(n, section))];
    if (name == "first" && s_first == 0.0) s_first = servo.at(n, s);
    const double on_circle = servo.at(n, s) - s_first;
    if (name == "first" && on_circle > 10.0 && on_circle < 130.0) {
      EXPECT_NEAR(F.norm(), expected, 0.01 * expected) << on_circle;
    }
    if (name == "second") second = std::max(second, F.norm());
  }
  EXPECT_EQ(second, 0.0);
}

// Many turns in one block: each removes what it goes through, however even their number is.
TEST(Cutting, of_a_helix_in_one_block_leaves_nothing_for_a_turn_at_its_bottom) {
  for (const int turns : {15, 16, 17}) {
    const std::string bore = fmt::format(
        "G17 G90 T1 M6\nG43 H1\nS4775 M3\nG0 X11 Y0\nZ1\nG3 I-11 Z-{0} P{0} F1394\n(MSG, "
        "flat)\nG3 I-11\n(MSG, again)\nG3 I-11\nM30\n",
        turns);
    const model::Scenario scenario = cutting_scenario(bore, one_case("cut"));
    const run::CaseOutput out = run_named_case(scenario, "cut");
    const records::Series& servo = out.result.servo;
    const std::size_t section = *servo.column("section");
    double again = 0.0, first = 0.0;
    for (std::size_t n = 0; n < servo.rows(); ++n) {
      Vector3d F;
      for (int i = 0; i < 3; ++i) F[i] = servo.at(n, *servo.column("cutting_force", "XYZ"[i]));
      const std::string& name = out.sections[static_cast<std::size_t>(servo.at(n, section))];
      if (name == "flat") first = std::max(first, F.norm());
      if (name == "again") again = std::max(again, F.norm());
    }
    EXPECT_EQ(again, 0.0) << turns;
    // at most what a turn of 1 mm depth leaves, not the whole depth
    EXPECT_LT(first, 2.0 * slot_force().at(kChip).norm()) << turns;
  }
}

// Straight down into the block: the bottom's edges bear it all.
TEST(Cutting, plunging_is_borne_by_the_bottom) {
  const run::CaseOutput out =
      run_named_case(cutting_scenario("G17 G90 T1 M6\nG43 H1\nS4775 M3\nG0 X-30 Y0\nZ2\nX0\n(MSG, "
                                      "down)\nG1 Z-4 F300\nM30\n",
                                      one_case("cut")),
                     "cut");
  const plant::EngagedArc bottom{.width = 4 * mm, .kappa = 0.0, .from = 0.0, .to = 2.0 * kPi};
  const double c = 300.0 / (4775.0 * 4) * mm;
  const double expected =
      plant::average_force(plant::find_material("42CrMo4")->typical, 4, {0.0, -1.0}, {&bottom, 1})
          .at(c)
          .z();
  const records::Series& servo = out.result.servo;
  const std::size_t z = *servo.column("tool_position_nominal", 'Z');
  const std::size_t section = *servo.column("section");
  std::size_t seen = 0;
  for (std::size_t n = 0; n < servo.rows(); ++n) {
    if (out.sections[static_cast<std::size_t>(servo.at(n, section))] != "down") continue;
    if (servo.at(n, z) > -0.5 || servo.at(n, z) < -3.0) continue;
    ++seen;
    EXPECT_NEAR(servo.at(n, *servo.column("cutting_force", 'Z')), expected, 1e-3 * expected);
    EXPECT_NEAR(servo.at(n, *servo.column("cutting_force", 'X')), 0.0, 1e-3 * expected);
  }
  EXPECT_GT(seen, 100U);
}

// The table turns by 90 degrees, the program and the part with it: the axes feel the force of
// another side of the part.
TEST(Cutting, turns_with_the_work) {
  const model::Scenario scenario = cutting_scenario(
      kSlot,
      "[machine_override.axis.X]\nstructural_stiffness = \"50 N/um\"\n"
      "[machine_override.axis.Y]\nstructural_stiffness = \"50 N/um\"\n"
      "[machine_override.axis.Z]\nstructural_stiffness = \"50 N/um\"\n" +
          one_case("straight") + one_case("turned", "work_offset = { C_deg = 90.0 }\n"));
  const run::CaseOutput straight = run_named_case(scenario, "straight"),
                        turned = run_named_case(scenario, "turned");
  for (const char axis : {'X', 'Y', 'Z'}) {
    EXPECT_NEAR(mean_of(turned.result.servo, "structural_deflection", axis, middle(turned)),
                mean_of(straight.result.servo, "structural_deflection", axis, middle(straight)),
                1e-3)
        << axis;
  }
  const Vector3d F = mean_force(straight), F_turned = mean_force(turned);
  EXPECT_NEAR(std::abs(F_turned.x()), std::abs(F.y()), 1e-3 * F.norm());
  EXPECT_NEAR(F_turned.z(), F.z(), 1e-3 * F.norm());
}

TEST(Cutting, is_the_same_for_the_reference_integrator) {
  const auto with = [&](const std::string& integrator) {
    return run_named_case(
        cutting_scenario("G17 G90 T1 M6\nG43 H1\nS4775 M3\nG0 X-24.5\nZ-2\nG1 X-23 "
                         "F1394\nM30\n",
                         "[program.start]\nX_mm = -24.5\nZ_mm = 108.0\n[record]\nsettle_ms = 1.0\n"
                         "[machine_override]\nintegrator = \"" +
                             integrator + "\"\n" + one_case("cut")),
        "cut");
  };
  const run::CaseOutput exact = with("exact"), cvode = with("cvode");
  const records::Series &a = exact.result.servo, &b = cvode.result.servo;
  ASSERT_EQ(a.rows(), b.rows());
  constexpr double kNanometre = 1e-6;  // mm
  double largest = 0.0, force = 0.0;
  for (const char axis : {'X', 'Y', 'Z'}) {
    const std::size_t x = *a.column("true_linear", axis), F = *a.column("cutting_force", axis);
    for (std::size_t n = 0; n < a.rows(); ++n) {
      largest = std::max(largest, std::abs(a.at(n, x) - b.at(n, x)));
      force = std::max(force, std::abs(a.at(n, F)));
    }
  }
  EXPECT_LE(largest, kNanometre);
  EXPECT_GT(force, 100.0);
}

TEST(Cutting, gives_the_same_bits_alone_and_beside_other_cases) {
  const model::Scenario scenario =
      cutting_scenario(kSlot, one_case("cut") + one_case("air", "cutting = false\n") +
                                  one_case("worn", "wear = 2.0\n"));
  const run::RunOutput together = run::run_scenario(scenario, {});
  for (const run::CaseOutput& one : together.cases) {
    EXPECT_EQ(one.result.servo.by_rows(), run_named_case(scenario, one.name).result.servo.by_rows())
        << one.name;
  }
}

TEST(Cutting, bends_the_structure_of_an_ideal_machine_too) {
  const model::Scenario scenario =
      cutting_scenario(kSlot, "[machine_override.axis.Z]\nstructural_stiffness = \"20 N/um\"\n" +
                                  one_case("cut", "servo = \"ideal\"\n"));
  const run::CaseOutput out = run_named_case(scenario, "cut");
  const double expected = slot_force().at(kChip).z() / 20.0;  // um
  EXPECT_NEAR(mean_of(out.result.servo, "tool_deviation", 'Z', middle(out)), expected,
              1e-3 * std::abs(expected));
}

TEST(CuttingKeys, give_coefficients_of_ones_own) {
  const model::Scenario scenario = small_scenario(
      kSlot, kTool + kBlock +
                 "[cutting]\nKtc = \"2300 N/mm^2\"\nKrc = \"900 N/mm^2\"\nKac = 4e8\nKte = \"40 "
                 "N/mm\"\nKre = \"50 N/mm\"\nKae = 5000.0\n" +
                 one_case("cut"));
  const auto& typical = plant::find_material("42CrMo4")->typical;
  for (const auto& K : plant::kCuttingCoefficients) {
    EXPECT_NEAR(scenario.cutting->coefficients.*K.member, typical.*K.member,
                1e-9 * typical.*K.member)
        << K.name;
  }
  const model::Scenario harder =
      small_scenario(kSlot, kTool + kBlock + kSteel + "Ktc = \"2600 N/mm^2\"\n" + one_case("cut"));
  EXPECT_NEAR(harder.cutting->coefficients.Ktc, 2600e6, 1.0);
  EXPECT_EQ(harder.cutting->coefficients.Krc, typical.Krc);
}

}  // namespace
}  // namespace servomill::sim::engine::cutting_load_test
