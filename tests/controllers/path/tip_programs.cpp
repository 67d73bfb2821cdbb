#include "tip_programs.h"

#include <Eigen/Geometry>

namespace servomill::controllers::test {
namespace {

TipMachine machine_of(const std::string& structure) {
  TipMachine machine;
  machine.chain = plant::make_chain(plant::parse_structure(structure));
  machine.limits.v << 40.0 * m_per_min, 40.0 * m_per_min, 40.0 * m_per_min, 100.0 * rpm,
      200.0 * rpm;
  machine.limits.a << 6.0, 7.0, 8.0, 50.0, 100.0;
  machine.limits.j << 100.0, 100.0, 100.0, 1000.0, 2000.0;
  return machine;
}

}  // namespace

std::shared_ptr<const ToolCentrePoint> TipMachine::control() const {
  return std::make_shared<ToolCentrePoint>(chain, lower, upper,
                                           kGreatCircleShare * options.rotary_tolerance);
}

ProgramSetup TipMachine::setup() const {
  ProgramSetup setup;
  setup.tools = ToolTable::parse("T1 P1 Z100 D8\n", "tools.tbl");
  setup.machine = control();
  return setup;
}

std::vector<Move> TipMachine::read(const std::string& program) const {
  return interpret(program + "\nM2\n", "p.nc", setup());
}

ToolPose TipMachine::pose(const Joints& Q) const {
  return plant::forward(chain, Q, Eigen::Vector3d(0.0, 0.0, -100.0 * mm));
}

TipMachine table_machine() {
  TipMachine machine = machine_of("[w C' A' X' b Y Z t]");
  machine.chain.at(Axis::A).centre = Eigen::Vector3d(0.0, 0.0, -60.0 * mm);
  machine.chain.at(Axis::C).centre = Eigen::Vector3d(0.0, 1.0 * mm, 0.0);
  machine.lower[3] = -120.0 * deg;
  machine.upper[3] = 120.0 * deg;
  return machine;
}

TipMachine head_machine() {
  TipMachine machine = machine_of("[w X' b Y Z C B t]");
  machine.chain.at(Axis::B).centre = Eigen::Vector3d(0.0, 0.0, 80.0 * mm);
  machine.chain.at(Axis::C).centre = Eigen::Vector3d(2.0 * mm, 0.0, 0.0);
  machine.lower[3] = -110.0 * deg;
  machine.upper[3] = 110.0 * deg;
  return machine;
}

Planned::Planned(const TipMachine& with, const std::string& program)
    : machine(with), moves(machine.read(program)) {
  const std::map<int, Eigen::Vector3d> tips = {{0, Eigen::Vector3d::Zero()},
                                               {1, Eigen::Vector3d(0.0, 0.0, -100.0 * mm)}};
  const Joints start = Joints::Zero();
  tip =
      tip_motions(moves, *machine.control(), tips, start, machine.limits, machine.options, "p.nc");
  trajectory = plan(moves, machine.chain.layout, start, machine.limits, machine.options, tip);
}

void Planned::sample(
    double step, const std::function<void(const Trajectory::Sample&, const ToolPose&)>& f) const {
  Trajectory::Cursor cursor{};
  for (int n = 0; n * step <= trajectory.duration(); ++n) {
    const Trajectory::Sample now = trajectory.at(n * step, cursor);
    f(now, machine.pose(now.Q_ref));
  }
}

void Planned::sample_line(
    int line, double step,
    const std::function<void(const Trajectory::Sample&, const ToolPose&)>& f) const {
  int seen = 0;
  sample(step, [&](const Trajectory::Sample& now, const ToolPose& P) {
    if (now.line != line) return;
    ++seen;
    f(now, P);
  });
  EXPECT_GT(seen, 0) << "line " << line;
}

double distance_to_line(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                        const Eigen::Vector3d& b) {
  return (p - a).cross((b - a).normalized()).norm();
}

std::vector<NamedMachine> machines() {
  return {{"table", table_machine(), "A"}, {"head", head_machine(), "B"}};
}

Eigen::Vector3d tip_velocity(const Planned& p, const Trajectory::Sample& now) {
  const Eigen::Vector3d p_ST(0.0, 0.0, -100.0 * mm);
  return plant::jacobian(p.machine.chain, now.Q_ref, p_ST).J_pQ * now.dQ_ref;
}

void expect_within_joint_limits(const Planned& p, double step) {
  constexpr double kLimitRounding = 1e-6;  // of a joint limit
  const JointLimits& limits = p.machine.limits;
  Joints v = Joints::Zero(), a = v, j = v;
  p.sample(step, [&](const Trajectory::Sample& now, const ToolPose&) {
    v = v.cwiseMax(now.dQ_ref.cwiseAbs());
    a = a.cwiseMax(now.ddQ_ref.cwiseAbs());
    j = j.cwiseMax(now.dddQ_ref.cwiseAbs());
  });
  EXPECT_LE(v.cwiseQuotient(limits.v).maxCoeff(), 1.0 + kLimitRounding);
  EXPECT_LE(a.cwiseQuotient(limits.a).maxCoeff(), 1.0 + kLimitRounding);
  EXPECT_LE(j.cwiseQuotient(limits.j).maxCoeff(), 1.0 + kLimitRounding);
}

}  // namespace servomill::controllers::test
