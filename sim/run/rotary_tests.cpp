#include "sim/run/rotary_tests.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/comparison.h"
#include "sim/metrology/r_test.h"
#include "sim/run/machine_tests.h"
#include "sim/standards/ball_test.h"
#include "sim/standards/error_motion.h"

namespace servomill::sim::run {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using model::MachineTest;

Joints joints_at(const evaluation::CaseData& one, const AxisWords& ref) {
  return one.chain.layout.joints(ref);
}

// Rows between two standstills in which a turn is read.
struct TurnRows {
  std::size_t begin = 0, end = 0;
  double from = 0.0;  // rad, interpolated position of the axis at the first angle
  int direction = 1;
  std::size_t first = 0, last = 0;  // rows of the readings
};

using Values = std::vector<std::vector<double>>;  // of each sensor, at each angle

// Values of all sensors where the axis passes the angles, linear between rows.
// @param angles  rad, from the first on, rising
// @param sensors  f(row), as many values as there are sensors
template <class F>
Values read_at(const MachineTest& test, const TestRows& rows, TurnRows& turn,
               const std::vector<double>& angles, std::size_t number, F sensors) {
  const int axis = index_of(test.axes.front());
  Values out(number);
  double before = 0.0;
  std::vector<double> last;
  std::size_t next = 0;
  for (std::size_t row = turn.begin; row < turn.end && next < angles.size(); ++row) {
    const double turned = turn.direction * (rows.ref(row)[axis] - turn.from);
    std::vector<double> now = sensors(row);
    for (; !last.empty() && next < angles.size() && turned >= angles[next]; ++next) {
      const double share = turned > before ? (angles[next] - before) / (turned - before) : 1.0;
      if (next == 0) turn.first = row;
      turn.last = row;
      for (std::size_t k = 0; k < number; ++k) {
        out[k].push_back(last[k] + share * (now[k] - last[k]));
      }
    }
    before = turned;
    last = std::move(now);
  }
  if (next == angles.size()) return out;
  throw InputError(test.place,
                   fmt::format("test {}: the recording contains {} of {} angles of a turn",
                               test.name, next, angles.size()));
}

std::vector<double> spaced(int count, double step) {
  std::vector<double> out;
  for (int i = 0; i < count; ++i) out.push_back(i * step);
  return out;
}

// Errors of the device on one sensor, over all its readings one after another.
void add_device(const MachineTest& test, std::vector<Values>& turns) {
  const std::size_t sensors = turns.front().size();
  std::vector<standards::PositioningTest> read;
  for (std::size_t k = 0; k < sensors; ++k) {
    std::vector<double> all;
    for (const Values& turn : turns) all.insert(all.end(), turn[k].begin(), turn[k].end());
    standards::PositioningTest& one = read.emplace_back();
    const auto n = static_cast<Eigen::Index>(all.size());
    one.targets = Eigen::ArrayXd::Zero(n);
    one.up = Eigen::Map<const Eigen::ArrayXd>(all.data(), n);
    one.time_up = Eigen::ArrayXd::LinSpaced(n, 0.0, 1.0);
  }
  read = standards::read_by_device(std::move(read), test.device, test.seed, {});
  for (std::size_t k = 0; k < sensors; ++k) {
    Eigen::Index i = 0;
    for (Values& turn : turns) {
      for (double& value : turn[k]) value = read[k].up(i++, 0);
    }
  }
}

// A direction fixed to what carries a rotary axis, in the workpiece.
Vector3d base_in_workpiece(const plant::MachineChain& chain, Axis axis, const Joints& Q,
                           const Vector3d& direction) {
  std::size_t end = 0;
  while (chain.axes[end++].axis != axis) continue;
  ToolPose P{Vector3d::Zero(), direction};
  while (end-- > 0) {
    const plant::ChainAxis& one = chain.axes[end];
    plant::apply(one, plant::motion_at(one, Q[one.joint]), P);
  }
  return P.k_W;
}

// Displacements of balls on the axis of a table, relative to the spindle.
class TableArtefact {
 public:
  TableArtefact(const MachineTest& test, const evaluation::CaseData& one, const TestRows& rows,
                const Standstill& zero)
      : rows_(rows), distance_(test.distance) {
    const Joints Q = joints_at(one, zero.ref);
    const Axis about = test.axes.front();
    const Matrix3d R_SW = metrology::R_WS(one.chain, Q).transpose();
    const Matrix3d& R_MA = one.chain.at(about).R_MA;
    const int k = index_of(about) - index_of(Axis::A);
    ball_ = rows.nominal(zero);
    // the spindle keeps its attitude against the base of the table, which turns in the workpiece
    for (int i = 0; i < 3; ++i) {
      const Vector3d direction = R_MA.col((k + 1 + i) % 3);
      sensor_.row(i) = (R_SW * base_in_workpiece(one.chain, about, Q, direction)).transpose();
    }
    along_ = base_in_workpiece(one.chain, about, Q, R_MA.col(k));
    far_ = R_SW * along_ * distance_;
  }

  // x, y, z of the first ball, x and y of the second.
  std::vector<double> at(std::size_t row) const {
    const Matrix3d R_ST = rows_.spindle(row).transpose();
    const Vector3d p = rows_.actual(row);
    const Vector3d near = sensor_ * (R_ST * (ball_ - p));
    std::vector<double> out = {near[0], near[1], near[2]};
    if (distance_ > 0.0) {
      const Vector3d far = sensor_ * (R_ST * (ball_ + distance_ * along_ - p) - far_);
      out.insert(out.end(), {far[0], far[1]});
    }
    return out;
  }

 private:
  const TestRows& rows_;
  double distance_;
  Vector3d ball_, along_, far_;  // m, in the workpiece; the last from ball to ball in the spindle
  Matrix3d sensor_;              // rows: directions of x, y, z in the spindle
};

std::shared_ptr<const SensorReadings> readings_of(std::string turns_are,
                                                  std::vector<std::string_view> sensors,
                                                  std::vector<TurnReadings> turns) {
  return std::make_shared<const SensorReadings>(
      SensorReadings{std::move(turns_are), std::move(sensors), std::move(turns)});
}

constexpr std::array<std::string_view, 5> kArtefactSensors = {"x", "y", "z", "x2", "y2"};

// Angles of a revolution of the table as seen from its base, from x to y: a coordinate in the sense
// of the tool counts against it.
Eigen::ArrayXd table_angles(const MachineTest& test, plant::Sense sense) {
  const double sign = sense == plant::Sense::table ? 1.0 : -1.0;
  Eigen::ArrayXd out(test.readings);
  for (int i = 0; i < test.readings; ++i) {
    out[i] = sign * (test.begin + i * test.reading_spacing());
  }
  return out;
}

std::vector<TurnReadings> revolutions_of(const Eigen::ArrayXd& theta, const Values& read) {
  std::vector<TurnReadings> out;
  const auto count = static_cast<std::size_t>(theta.size());
  for (std::size_t first = 0; first < read[0].size(); first += count) {
    TurnReadings& turn = out.emplace_back();
    turn.name = std::to_string(out.size());
    turn.angles.assign(theta.data(), theta.data() + theta.size());
    for (const std::vector<double>& sensor : read) {
      const double* const begin = sensor.data() + first;
      turn.values.emplace_back(begin, begin + count);
    }
  }
  return out;
}

}  // namespace

RotaryDevice::RotaryDevice(const MachineTest& test, const evaluation::CaseData& one,
                           const TestRows& rows, const Standstill& zero)
    : rows_(rows),
      axis_(metrology::axis_in_workpiece(one.chain, test.axes.front(), joints_at(one, zero.ref))
                .direction),
      R_zero_(rows.spindle(zero.end - 1)) {}

double RotaryDevice::deviation(const Standstill& at, double nominal, double from, double to) const {
  const Matrix3d back = Eigen::AngleAxisd(-nominal, axis_).toRotationMatrix();
  return rows_.mean_of<double>(at, from, to, [&](std::size_t row) {
    const Eigen::AngleAxisd off(back * rows_.spindle(row) * R_zero_.transpose());
    return off.angle() * off.axis().dot(axis_);
  });
}

void evaluate_error_motion(const MachineTest& test, const evaluation::CaseData& one,
                           const TestRows& rows, TestResult& out) {
  const std::vector<Standstill> at = rows.at_stops();
  const TableArtefact artefact(test, one, rows, at[0]);
  TurnRows turn{at[0].end - 1, at[1].begin + 1,
                at[0].ref[index_of(test.axes.front())] + test.cycle.overrun, 1};
  const std::vector<double> angles =
      spaced(test.readings * test.revolutions, test.reading_spacing());
  const std::size_t number = test.distance > 0.0 ? 5 : 3;
  std::vector<Values> read = {
      read_at(test, rows, turn, angles, number, [&](std::size_t row) { return artefact.at(row); })};
  out.feeds = rows.feeds(turn.first, turn.last, out.feeds);
  // sensors are set to zero at the first reading
  for (std::vector<double>& sensor : read[0]) {
    const double zero = sensor.front();
    for (double& value : sensor) value -= zero;
  }
  add_device(test, read);

  standards::RotationSensors sensors;
  for (std::size_t k = 0; k < number; ++k) {
    sensors[kArtefactSensors[k]] =
        Eigen::Map<const Eigen::ArrayXXd>(read[0][k].data(), test.readings, test.revolutions);
  }
  const Eigen::ArrayXd theta = table_angles(test, one.chain.at(test.axes.front()).sense);
  out.report = standards::rotation_report(
      standards::rotation_of(out.report.name, theta, sensors, test.distance));
  out.sensors = readings_of(
      "revolution",
      {kArtefactSensors.begin(), kArtefactSensors.begin() + static_cast<std::ptrdiff_t>(number)},
      revolutions_of(theta, read[0]));
}

void evaluate_ball(const MachineTest& test, const evaluation::CaseData& one, const TestRows& rows,
                   TestResult& out) {
  using metrology::NestDirection;
  constexpr std::array kDirections = {NestDirection::radial, NestDirection::tangential,
                                      NestDirection::axial};
  const std::vector<std::string_view> names = {"radial", "tangential", "axial"};
  const std::vector<Standstill> at = rows.at_stops();
  const Vector3d ball = rows.nominal(at[0]);
  const int axis = index_of(test.axes.front());
  const std::vector<double> angles = spaced(test.readings, test.reading_spacing());
  std::vector<Values> read;
  for (std::size_t k = 0; k < 2; ++k) {
    TurnRows turn{at[k].end - 1, at[k + 1].begin + 1, 0.0, k == 0 ? 1 : -1};
    turn.from = at[k].ref[axis] + turn.direction * test.cycle.overrun;
    metrology::TipPath path;
    for (std::size_t row = turn.begin; row < turn.end; ++row) {
      path.Q.push_back(joints_at(one, rows.ref(row)));
      path.nominal.push_back(ball);
      path.actual.push_back(rows.actual(row));
    }
    std::array<metrology::BallDeviation, 3> nest;
    for (std::size_t i = 0; i < nest.size(); ++i) {
      nest[i] = metrology::nest_deviation(one.chain, path, kDirections[i]);
      if (nest[i].why_not.empty()) continue;
      throw InputError(test.place,
                       fmt::format("case {}: test {}: {}", one.name, test.name, nest[i].why_not));
    }
    read.push_back(read_at(test, rows, turn, angles, nest.size(), [&](std::size_t row) {
      const std::size_t i = row - turn.begin;
      return std::vector<double>{nest[0].d[i], nest[1].d[i], nest[2].d[i]};
    }));
    out.feeds = rows.feeds(turn.first, turn.last, out.feeds);
  }
  add_device(test, read);

  standards::BallTest result{out.report.name, {names.begin(), names.end()}, {}};
  std::vector<TurnReadings> turns;
  for (std::size_t k = 0; k < 2; ++k) {
    const int direction = k == 0 ? 1 : -1;
    result.paths.push_back({direction, read[k]});
    TurnReadings& turn = turns.emplace_back();
    turn.name = k == 0 ? "forward" : "backward";
    for (const double angle : angles) {
      turn.angles.push_back(k == 0 ? test.begin + angle : test.end - angle);
    }
    turn.values = read[k];
    result.paths.back().angles = turn.angles;
  }
  out.report = standards::ball_report(result);
  out.sensors = readings_of("direction", names, std::move(turns));
}

}  // namespace servomill::sim::run
