#include "sim/identification/nc_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "sim/identification/identification.h"
#include "sim/identification/identify.h"
#include "sim/identification/parameter_space.h"
#include "sim/identification/report.h"
#include "tests/sim/identification/axis_experiment.h"

namespace servomill::sim::identification::nc_loop_test {
namespace {

constexpr const char* kTwoMasses = R"(based_on = "machine.toml"
[nc]
velocity_feed_forward = 0.7
acceleration_feed_forward = 0.5
[axis.X]
drive = "two_mass"
motor_inertia = "2e-5 kg m^2"
stiffness = "2e6 N/m"
damping = "800 N s/m"
current_time_constant_ms = 1.5
scale_step = "1 nm"
motor_step = "1 urad"
[axis.X.friction_compensation]
coulomb = "10 N"
[[axis.X.filter]]
type = "notch"
frequency_Hz = 200.0
width_Hz = 80.0
)";

constexpr const char* kOwnNc = R"(
kind = "nc"
period_ms = 1.0
)";
constexpr const char* kOther = R"(
period_ms = 1.0
position_gain = "40 1/s"
velocity_gain = "12000 N s/m"
velocity_reset_time_ms = 50.0
velocity_feed_forward = 0.3
dead_time_ms = 0.4
speed_feedback = "motor"
[[loop.filter]]
type = "low_pass"
frequency_Hz = 150.0
)";

constexpr const char* kSlow = R"(
period_ms = 1.0
position_gain = "15 1/s"
velocity_gain = "4000 N s/m"
speed_feedback = "motor"
)";

// A value that is known, the start that the fit gets, and how near it must come.
struct Known {
  std::string key, value;
  double off = 1.15;
  double share = 1e-3;
};

class Keys : public testing::Test {
 protected:
  Keys() {
    std::ofstream(files_.path("two.toml")) << kTwoMasses;
    Record motion = ramps(2.0);
    motion.feedback = motion.command;
    motion.force = motion.command;
    files_.write_recording(motion);
  }

  Experiment read(const std::string& loop, const std::vector<Known>& known,
                  const std::string& machine = "two.toml",
                  const std::string& roles = "axis.X.force = \"F\"\n") {
    std::string text = "machine = \"" + machine + "\"\n[loop]" + loop +
                       "[[recording]]\nfile = \"recording.csv\"\naxis.X.command = \"q\"\n"
                       "axis.X.feedback = \"y\"\n" +
                       roles;
    for (const Known& one : known) {
      text += "[[estimate]]\nkey = \"" + one.key + "\"\nstart = " + one.value + "\n";
    }
    std::ofstream(files_.path("keys.toml")) << text;
    return read_experiment(files_.path("keys.toml"));
  }

  // Made up with the known values, identified from others.
  void recover(const std::string& loop, const std::vector<Known>& known,
               const std::string& machine = "two.toml") {
    Experiment e = read(loop, known, machine);
    make_up(e);
    std::vector<double> truth;
    for (std::size_t k = 0; k < known.size(); ++k) {
      truth.push_back(e.estimates[k].start);
      e.estimates[k].start *= known[k].off;
    }
    const Identification found = identify(e, 2);
    for (const std::string& said : unidentifiable_sentences(found)) ADD_FAILURE() << said;
    for (const std::string& said : warnings(found)) ADD_FAILURE() << said;
    EXPECT_LT(found.estimation[0].feedback_rms, 20e-9);
    for (std::size_t k = 0; k < known.size(); ++k) {
      EXPECT_TRUE(found.uncertainty.identifiable[k])
          << known[k].key << " scale " << found.fit.scales[k] << " norm "
          << found.fit.jacobian.col(static_cast<Eigen::Index>(k)).norm() << " value "
          << found.fit.values[k];
      EXPECT_NEAR(found.fit.values[k] / truth[k], 1.0, known[k].share) << known[k].key;
    }
  }

  static void make_up(Experiment& e) {
    const ModelOfValues model = model_of(with_values(e.document, e.estimates), {}, {});
    for (AxisRecord& record : e.records) {
      AxisModel axis{model.machine.drives[0], model.loop, record.record.command.front()};
      axis.machine = std::make_shared<model::MachineSettings>(model.machine);
      const Simulated made = simulate(record.record, {&axis, 1}, 1).front();
      record.record.feedback = made.feedback;
      if (model.loop.kind != LoopKind::open) record.record.force = made.force;
    }
  }

  AxisExperiment files_;
};

TEST_F(Keys, OfTheScrewAndTheCurrentLoopUnderOurOwnNc) {
  recover(kOwnNc, {{"axis.X.moving_mass", "\"95 kg\""},
                   {"axis.X.stiffness", "\"2e6 N/m\"", 0.8},
                   {"axis.X.damping", "\"800 N s/m\"", 1.3, 1e-2},
                   {"axis.X.current_time_constant_ms", "1.5", 0.7, 1e-2}});
}

TEST_F(Keys, OfTheNcItself) {
  recover(kOwnNc, {{"nc.Kv", "\"25 1/s\""},
                   {"nc.velocity_feed_forward", "0.7"},
                   {"nc.acceleration_feed_forward", "0.5", 0.5},
                   {"axis.X.velocity_bandwidth", "\"150 rad/s\""},
                   {"axis.X.velocity_reset_time_ms", "20.0"}});
}

TEST_F(Keys, OfFrictionAndItsCompensation) {
  recover(kOwnNc, {{"axis.X.friction.coulomb", "\"20 N\"", 0.8, 1e-2},
                   {"axis.X.friction_compensation.coulomb", "\"10 N\"", 0.7, 1e-2}});
}

TEST_F(Keys, OfAFilterInAList) {
  recover(kOwnNc, {{"axis.X.filter[0].frequency_Hz", "200.0", 0.9, 1e-2}});
}

TEST_F(Keys, ATorqueConstantThatTheNcTakesForAnother) {
  recover(kOwnNc, {{"axis.X.Kt", "\"0.0012 Nm/A\""}, {"axis.X.moving_mass", "\"95 kg\""}});
}

TEST_F(Keys, Backlash) {
  std::ofstream(files_.path("gap.toml")) << R"(based_on = "two.toml"
[axis.X]
backlash = "30 um"
)";
  recover(kOwnNc, {{"axis.X.backlash", "\"30 um\"", 0.8, 2e-2}}, "gap.toml");
}

TEST_F(Keys, OfAnotherControlWithAFilter) {
  recover(kOther,
          {{"axis.X.moving_mass", "\"95 kg\""},
           {"loop.position_gain", "\"40 1/s\""},
           {"loop.velocity_gain", "\"12000 N s/m\"", 1.1},
           {"loop.velocity_feed_forward", "0.3"},
           {"loop.velocity_reset_time_ms", "50.0", 1.15, 1e-2},
           {"loop.dead_time_ms", "0.4", 1.3, 1e-2}},
          "machine.toml");
}

TEST_F(Keys, OffsetAndDelayOfTheSensor) {
  recover(kOwnNc,
          {{"loop.feedback_delay_ms", "0.3"}, {"loop.feedback_offset", "\"0.05 mm\"", 0.5}});
}

TEST_F(Keys, TheMotorAsTheFeedbackShowsTheScrew) {
  std::ofstream(files_.path("stiff.toml"))
      << "based_on = \"two.toml\"\n[axis.X]\ndamping = \"8000 N s/m\"\n";
  recover(std::string(kSlow).replace(1, 0, "position_feedback = \"motor\"\n"),
          {{"axis.X.stiffness", "\"2e7 N/m\"", 1.2, 1e-2}}, "stiff.toml");
}

// The slide is predicted from a fit to the motor alone, whatever its scale counts from.
TEST_F(Keys, TheScaleOfTheSlideIsCompared) {
  const std::string loop = std::string(kSlow).replace(1, 0, "position_feedback = \"motor\"\n");
  Experiment e =
      read(loop, {{"axis.X.moving_mass", "\"95 kg\""}}, "two.toml", "axis.X.scale = \"y\"\n");
  ASSERT_EQ(e.records[0].record.scale.size(), e.records[0].record.size());
  make_up(e);
  const ModelOfValues model = model_of(e.document, {}, {});
  AxisModel axis{model.machine.drives[0], model.loop, e.records[0].record.command.front()};
  e.records[0].record.scale = simulate(e.records[0].record, {&axis, 1}, 1).front().scale;
  for (double& x : e.records[0].record.scale) x += 0.25;
  const Identification good = identify(e, 2);
  EXPECT_LT(good.estimation[0].scale_rms, 1e-9);
  EXPECT_GT(good.estimation[0].scale_rms, 0.0);
  for (double& x : e.records[0].record.scale) x *= 1.001;
  EXPECT_GT(identify(e, 2).estimation[0].scale_rms, 1e-5);
}

// The current drives the axis: its constant follows from a mass that is known, its offset by a
// load.
TEST_F(Keys, TorqueConstantAndOffsetOfTheCurrentSensor) {
  Record driven = ramps(1.0);
  driven.feedback = driven.command;
  driven.force.clear();
  for (std::size_t k = 0; k < driven.size(); ++k) {
    driven.force.push_back(120.0 * std::sin(0.04 * static_cast<double>(k)));
  }
  files_.write_recording(driven);
  Experiment e = read("\nkind = \"open\"\nperiod_ms = 1.0\n",
                      {{"axis.X.Kt", "\"0.0011 Nm/A\""}, {"loop.force_offset", "\"3 N\""}},
                      "machine.toml", "axis.X.motor_current = { channel = \"F\", unit = \"A\" }\n");
  make_up(e);
  e.estimates[0].start = 0.001;
  e.estimates[1].start = 0.0;
  const Identification found = identify(e, 2);
  EXPECT_NEAR(found.fit.values[0], 0.0011, 1e-7);
  EXPECT_NEAR(found.fit.values[1], 3.0, 1e-3);
}

TEST_F(Keys, AnAxisThatIsHeavierHasNoOtherGains) {
  const Experiment e = read(kOwnNc, {{"axis.X.moving_mass", "\"190 kg\""}});
  EXPECT_FALSE(e.estimates[0].of_nc);
  const ModelOfValues light = model_of(e.document, {}, {});
  const ModelOfValues heavy = model_of(with_values(e.document, e.estimates), {}, {});
  EXPECT_EQ(heavy.machine.drives[0].M, 190.0);
  EXPECT_EQ(heavy.machine.nc.cascade[0].Kp, light.machine.nc.cascade[0].Kp);
}

TEST_F(Keys, APeriodThatTheNcHasNot) {
  EXPECT_THROW(read("\nkind = \"nc\"\nperiod_ms = 0.31\n", {}), InputError);
}

TEST(CommandBetween, IsExactForAParabola) {
  Record r;
  r.period = 0.5;
  for (int k = 0; k < 8; ++k) {
    const double t = 0.5 * k;
    r.command.push_back(2.0 + 3.0 * t - 0.7 * t * t);
  }
  for (const double share : {0.0, 0.25, 0.6}) {
    const double t = 0.5 * (3.0 + share);
    const CommandBetween c = command_between(r, 3, share);
    EXPECT_NEAR(c.q, 2.0 + 3.0 * t - 0.7 * t * t, 1e-12);
    EXPECT_NEAR(c.dq, 3.0 - 1.4 * t, 1e-12);
    EXPECT_NEAR(c.ddq, -1.4, 1e-12);
  }
}

// Friction by recording, one mass for both.
TEST_F(Keys, ValuesThatEachRecordingHasForItself) {
  Record motion = ramps(2.0);
  motion.feedback = motion.force = motion.command;
  files_.write_recording(motion, "warm.csv");
  std::ofstream(files_.path("own.toml")) << R"(machine = "machine.toml"
[loop]
period_ms = 1.0
position_gain = "160 1/s"
velocity_gain = "8557 N s/m"
[[recording]]
file = "recording.csv"
axis.X = { command = "q", feedback = "y" }
[[recording]]
file = "warm.csv"
axis.X = { command = "q", feedback = "y" }
[[estimate]]
key = "axis.X.moving_mass"
[[estimate]]
key = "axis.X.slide_viscous_friction"
own = true
)";
  Experiment e = read_experiment(files_.path("own.toml"));
  ASSERT_EQ(e.estimates.size(), 3u);
  const double viscous[] = {300.0, 180.0};
  for (std::size_t r = 0; r < 2; ++r) {
    AxisModel axis{small_axis(), e.loop};
    axis.drive.M = 90.0;
    axis.drive.b_load = viscous[r];
    axis.position = e.records[r].record.command.front();
    e.records[r].record.feedback = simulate(e.records[r].record, {&axis, 1}, 1).front().feedback;
  }
  const Identification found = identify(e, 2);
  EXPECT_NEAR(found.fit.values[0], 90.0, 1e-3);
  EXPECT_NEAR(found.fit.values[1], 300.0, 1e-2);
  EXPECT_NEAR(found.fit.values[2], 180.0, 1e-2);
}

}  // namespace
}  // namespace servomill::sim::identification::nc_loop_test
