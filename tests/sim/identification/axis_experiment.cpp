#include "tests/sim/identification/axis_experiment.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "sim/model/machine.h"

namespace servomill::sim::identification {
namespace {

constexpr const char* kMachine = R"(name = "small axis"
structure = "[w b X Y Z (C1) t]"
friction_model = "set_valued"
[nc]
Kv = "25 1/s"
)";

std::string axis_text(char letter, const char* friction) {
  return fmt::format(R"([axis.{}]
drive = "rigid"
lead_mm = 6.283185307179586
motor_inertia = "1e-9 kg m^2"
moving_mass = "95 kg"
slide_viscous_friction = "200 N s/m"
gravity_load = "0 N"
Kt = "0.001 Nm/A"
i_max_A = 1e7
velocity_bandwidth = "150 rad/s"
velocity_reset_time_ms = 20.0
travel_mm = [-1000.0, 1000.0]
v_max = "30 m/min"
a_max = "1 m/s^2"
j_max = "30 m/s^3"
friction = {}
)",
                     letter, friction);
}

void write_file(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  if (!file) throw std::runtime_error("cannot write " + path);
}

}  // namespace

plant::FeedDriveParams small_axis() {
  plant::FeedDriveParams p;
  p.kind = plant::DriveKind::rigid;
  p.r = 1e-3;
  p.J = 1e-9;
  p.M = 95.0;
  p.b_load = 200.0;
  p.Kt = 1e-3;
  p.i_max = 1e7;
  p.friction.kind = plant::FrictionKind::set_valued;
  p.friction.Fc_positive = p.friction.Fc_negative = 20.0;
  p.friction.Fs_positive = p.friction.Fs_negative = 20.0;
  return p;
}

LoopSettings small_loop() {
  LoopSettings loop;
  loop.period = 1e-3;
  loop.Kv = 160.0;
  loop.Kp = 8557.0;
  loop.mean_of = 2;
  return loop;
}

Record ramps(double seconds) {
  constexpr double kSpeeds[] = {0.05, 0.12, -0.08, -0.02, 0.1, -0.12, 0.03, -0.06};
  constexpr double kAcceleration = 1.0, kPart = 0.25;  // m/s^2, s
  Record motion;
  motion.name = "ramps";
  motion.period = 1e-3;
  double q = 0.0, v = 0.0;
  for (double t = 0.0; t < seconds - 0.5e-3; t += motion.period) {
    const double wanted = kSpeeds[static_cast<std::size_t>(t / kPart) % std::size(kSpeeds)];
    const double step = kAcceleration * motion.period;
    v = v < wanted ? std::min(v + step, wanted) : std::max(v - step, wanted);
    q += v * motion.period;
    motion.command.push_back(q);
  }
  return motion;
}

Record recorded(const Record& motion, const AxisModel& model) {
  Record out = motion;
  out.feedback.assign(motion.command.size(), 0.0);
  const std::vector<Simulated> simulated = simulate(out, {&model, 1}, 1);
  out.feedback = simulated.front().feedback;
  out.force = simulated.front().force;
  return out;
}

AxisExperiment::AxisExperiment() {
  std::string name = (std::filesystem::temp_directory_path() / "identification_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  folder_ = name;
  std::string machine = kMachine;
  for (const char letter : {'X', 'Y', 'Z'}) machine += axis_text(letter, "{ coulomb = \"20 N\" }");
  write_file(path("machine.toml"), machine);
}

AxisExperiment::~AxisExperiment() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void AxisExperiment::write_recording(const Record& record, const std::string& name) const {
  std::string text = "time [s],q [m],y [m],F [N]\n";
  for (std::size_t k = 0; k < record.size(); ++k) {
    text += fmt::format("{},{},{},{}\n", record.period * static_cast<double>(k), record.command[k],
                        record.feedback[k], record.force[k]);
  }
  write_file(path(name), text);
}

std::string AxisExperiment::write(const std::string& rest) const {
  const std::string text = R"(name = "small"
machine = "machine.toml"
[loop]
period_ms = 1.0
position_gain = "160 1/s"
velocity_gain = "8557 N s/m"
feedback_mean_of = 2
[[recording]]
file = "recording.csv"
axis.X.command = "q"
axis.X.feedback = "y"
axis.X.force = "F"
)" + rest;
  write_file(path("experiment.toml"), text);
  return path("experiment.toml");
}

}  // namespace servomill::sim::identification
