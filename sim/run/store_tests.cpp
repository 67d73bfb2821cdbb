#include "sim/run/store_tests.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/records/hdf5_group.h"
#include "sim/records/nexus.h"
#include "sim/records/output_file.h"
#include "sim/run/machine_tests.h"
#include "sim/run/test_sheet.h"
#include "sim/standards/circle_test.h"

namespace servomill::sim::run {
namespace {

void write_readings(records::Hdf5Group& group, const char* name, const char* direction,
                    const Eigen::ArrayXXd& deviations, const char* unit) {
  std::vector<double> rows;
  for (Eigen::Index i = 0; i < deviations.rows(); ++i) {
    for (Eigen::Index run = 0; run < deviations.cols(); ++run) {
      rows.push_back(deviations(i, run) / um);
    }
  }
  group.table(name, static_cast<std::size_t>(deviations.cols()), rows,
              {unit, fmt::format("actual minus target position, approached {}", direction)},
              "target", "run");
}

void write_line(records::Hdf5Group& group, const standards::PositioningTest& readings) {
  std::vector<double> targets, runs;
  const char* const unit = readings.angular ? "urad" : "um";
  for (const double target : readings.targets) {
    targets.push_back(target / (readings.angular ? deg : mm));
  }
  for (Eigen::Index run = 0; run < readings.up.cols(); ++run) {
    runs.push_back(static_cast<double>(run + 1));
  }
  group.list("target", targets,
             {readings.angular ? "deg" : "mm",
              "target position in work coordinates, or along the diagonal"});
  group.counts("run", runs, {"1", "number of the run"});
  write_readings(group, "deviation_up", "upwards", readings.up, unit);
  write_readings(group, "deviation_down", "downwards", readings.down, unit);
  records::make_nexus_data(group, {"deviation_up", {"target", "run"}, {"deviation_down"}});
}

void write_turn(records::Hdf5Group group, const standards::CirclePath& turn, double radius) {
  std::vector<double> angles, deviations;
  for (const Eigen::Vector2d& p : turn.points) {
    angles.push_back(std::atan2(p.y(), p.x()) / deg);
    deviations.push_back((p.norm() - radius) / um);
  }
  group.list("angle", angles, {"deg", "from the first axis of the plane to the second"});
  group.list("deviation", deviations, {"um", "reading of the ball bar minus the nominal radius"},
             "angle");
  records::make_nexus_data(group, {"deviation", {"angle"}, {}});
}

std::string group_name(const standards::CirclePath& turn) {
  return turn.sense == metrology::Sense::counter_clockwise ? "ccw" : "cw";
}

std::string group_name(const SensorReadings& sensors, const TurnReadings& turn) {
  return sensors.turns_are == "revolution" ? "revolution_" + turn.name : turn.name;
}

// Group of the default plot; none: that of the test itself.
std::string first_part_of(const TestResult& one) {
  if (one.lines.size() > 1) return one.lines.front().name;
  if (one.circle) return group_name(one.circle->turns.front());
  if (one.sensors) return group_name(*one.sensors, one.sensors->turns.front());
  return "";
}

// A group for each direction or revolution.
void write_sensors(records::Hdf5Group& group, const SensorReadings& sensors) {
  for (const TurnReadings& turn : sensors.turns) {
    records::Hdf5Group of_turn = group.group(group_name(sensors, turn));
    std::vector<double> angles;
    for (const double angle : turn.angles) angles.push_back(angle / deg);
    of_turn.list("angle", angles, {"deg", "position of the rotary axis; of its table from x to y"});
    for (std::size_t k = 0; k < turn.values.size(); ++k) {
      std::vector<double> values;
      for (const double value : turn.values[k]) values.push_back(value / um);
      of_turn.list(std::string(sensors.sensors[k]), values, {"um", "reading of the sensor"},
                   "angle");
    }
    std::vector<std::string> names(sensors.sensors.begin(), sensors.sensors.end());
    records::make_nexus_data(of_turn, {names[0], {"angle"}, {names.begin() + 1, names.end()}});
  }
}

void write_test(records::Hdf5Group group, const TestResult& one) {
  group.attribute("standard", one.report.standard);
  records::make_nexus_group(group, "NXcollection", first_part_of(one));
  if (one.lines.size() == 1) {
    write_line(group, one.lines.front().test);
  } else if (!one.lines.empty()) {
    for (const LineReadings& line : one.lines) {
      records::Hdf5Group of_line = group.group(line.name);
      write_line(of_line, line.test);
    }
  }
  if (one.circle) {
    for (const standards::CirclePath& turn : one.circle->turns) {
      write_turn(group.group(group_name(turn)), turn, one.circle->radius);
    }
  }
  if (one.sensors) write_sensors(group, *one.sensors);
  for (const standards::ReportValue& value : one.report.values) {
    const ReportUnit unit = unit_of(value.dimension);
    group.scalar(value.symbol, value.value / unit.factor, {unit.name, value.meaning});
    group.scalar("U_" + value.symbol, value.U / unit.factor,
                 {unit.name, "expanded uncertainty (k = 2) of " + value.symbol});
  }
}

}  // namespace

void write_tests(records::Hdf5Group group,
                 std::span<const std::shared_ptr<const TestResult>> tests) {
  records::make_nexus_group(group, "NXcollection", tests.front()->name);
  for (const auto& one : tests) write_test(group.group(one->name), *one);
}

}  // namespace servomill::sim::run
