#include "sim/run/store_day.h"

#include <fmt/format.h>

#include <numeric>

#include "plant/heat/temperature.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/records/hdf5_group.h"
#include "sim/records/input_file.h"
#include "sim/records/nexus.h"
#include "sim/records/output_file.h"
#include "sim/run/day_course.h"

namespace servomill::sim::run {
namespace {

constexpr double kMinute = 60.0, kHour = 3600.0;  // s

void write_drift(records::Hdf5Group group, const DayCourse& day, std::size_t place) {
  std::vector<double> hours;
  for (const double t : day.time) hours.push_back(t / kHour);
  group.list("time", hours, {"h", "time since the start of the day"});
  for (std::size_t c = 0; c < kDrifts; ++c) {
    const bool is_length = c < 3;
    const char* unit = is_length ? "um" : "urad";
    const std::string what = fmt::format("{} {}", is_length ? "along" : "about", kDriftNames[c]);
    std::vector<double> drift;
    for (const auto& at : day.drift[place]) drift.push_back(at[c] / um);  // um is urad
    const std::string name = kDriftNames[c];
    group.list(name, drift, {unit, "drift of the tip since the start, " + what}, "time");
    const DriftRange& range = day.ranges[place];
    group.scalar("range_60min_" + name, range.first_hour[c] / um,
                 {unit, "range of the drift " + what + " within the first 60 min (ISO 230-3)"});
    group.scalar("range_" + name, range.whole[c] / um,
                 {unit, "range of the drift " + what + " (ISO 230-3)"});
    group.scalar("reached_" + name, range.reached[c] / kHour,
                 {"h", "time at which the range of the drift " + what + " was reached"});
  }
  records::make_nexus_data(group, {kDriftNames[0], {"time"}, {kDriftNames[1], kDriftNames[2]}});
}

void write_cycles(records::Hdf5Group group, const DayCourse& day) {
  std::vector<double> begin, rms, most;
  for (const DayCycle& cycle : day.cycles) {
    begin.push_back(cycle.begin / kHour);
    rms.push_back(cycle.rms / um);
    most.push_back(cycle.most / um);
  }
  group.list("begin", begin, {"h", "begin of each cycle since the start of the day"});
  group.list("rms", rms,
             {"um", "rms along the path of the thermal displacement of the TCP, without datum"},
             "begin");
  group.list("largest", most, {"um", "greatest of it"}, "begin");
  records::make_nexus_data(group, {"rms", {"begin"}, {"largest"}});
}

void write_datums(records::Hdf5Group group, const DayCourse& day) {
  std::vector<double> hours;
  for (const double t : day.datums) hours.push_back(t / kHour);
  std::vector<double> numbers(hours.size());
  std::iota(numbers.begin(), numbers.end(), 1.0);
  group.list("time", hours, {"h", "time of each datum since the start of the day"});
  group.counts("number", numbers, {"1", "number of the datum"}, "time");
  records::make_nexus_data(group, {"number", {"time"}, {}});
  group.scalar("measuring", day.measuring / kMinute, {"min", "time of datums in between cycles"});
}

}  // namespace

void write_day(records::Hdf5Group group, const DayCourse& day) {
  std::vector<double> hours;
  for (const double t : day.time) hours.push_back(t / kHour);
  group.list("time", hours, {"h", "time since the start of the day"});
  std::vector<std::string> names;
  const auto write = [&](const std::string& name, std::vector<double> T, const std::string& what) {
    for (double& one : T) one = celsius(one);
    group.list(name, T, {"degC", what}, "time");
    names.push_back(name);
  };
  for (std::size_t i = 0; i < day.bodies.size(); ++i) {
    write("temperature_" + day.bodies[i], day.temperatures[i], "temperature of " + day.bodies[i]);
  }
  for (std::size_t i = 0; i < day.sensors.size(); ++i) {
    write("sensor_" + day.sensors[i], day.readings[i],
          "reading of temperature sensor " + day.sensors[i]);
  }
  if (!names.empty()) {
    records::make_nexus_data(group, {names[0], {"time"}, {names.begin() + 1, names.end()}});
  }
  if (!day.places.empty()) {
    records::Hdf5Group drift = group.group("drift");
    records::make_nexus_group(drift, "NXcollection", day.places.front());
    for (std::size_t k = 0; k < day.places.size(); ++k) {
      write_drift(drift.group(day.places[k]), day, k);
    }
  }
  if (!day.cycles.empty()) write_cycles(group.group("cycles"), day);
  if (!day.datums.empty()) write_datums(group.group("datums"), day);
  if (!day.stopped.empty()) group.attribute("stopped", day.stopped);
}

namespace {

// Values of a list times a unit.
std::vector<double> read_list(const records::InputFile& file, const std::string& path, double unit,
                              std::size_t length) {
  std::vector<double> values = file.values(path);
  if (values.size() != length) {
    throw InputError({file.path()},
                     fmt::format("'{}' has {} values in place of {}", path, values.size(), length));
  }
  for (double& value : values) value *= unit;
  return values;
}

DriftRange read_range(const records::InputFile& file, const std::string& group,
                      const std::string& place) {
  DriftRange out{place, {}, {}, {}};
  for (std::size_t c = 0; c < kDrifts; ++c) {
    const std::string name = kDriftNames[c];
    out.first_hour[c] = read_list(file, group + "/range_60min_" + name, um, 1)[0];
    out.whole[c] = read_list(file, group + "/range_" + name, um, 1)[0];
    out.reached[c] = read_list(file, group + "/reached_" + name, kHour, 1)[0];
  }
  return out;
}

// Cycles and datums.
void read_parts(const records::InputFile& file, const std::string& group, DayCourse& out) {
  if (file.has(group + "/cycles")) {
    const std::string path = group + "/cycles";
    const std::size_t count = file.values(path + "/begin").size();
    const auto begin = read_list(file, path + "/begin", kHour, count),
               rms = read_list(file, path + "/rms", um, count),
               most = read_list(file, path + "/largest", um, count);
    for (std::size_t n = 0; n < count; ++n) out.cycles.push_back({begin[n], rms[n], most[n]});
  }
  if (file.has(group + "/datums")) {
    const std::string path = group + "/datums";
    out.datums = read_list(file, path + "/time", kHour, file.values(path + "/time").size());
    out.measuring = read_list(file, path + "/measuring", kMinute, 1)[0];
  }
}

}  // namespace

std::shared_ptr<const DayCourse> read_day(const records::InputFile& file,
                                          const std::string& group) {
  if (!file.has(group)) return nullptr;
  auto out = std::make_shared<DayCourse>();
  const std::size_t readings = file.values(group + "/time").size();
  out->time = read_list(file, group + "/time", kHour, readings);
  for (const std::string& name : file.datasets(group)) {
    const bool is_body = name.starts_with("temperature_"), is_sensor = name.starts_with("sensor_");
    if (!is_body && !is_sensor) continue;
    std::vector<double> T = read_list(file, group + "/" + name, 1.0, readings);
    for (double& one : T) one = kelvin(one);
    (is_body ? out->bodies : out->sensors).push_back(name.substr(name.find('_') + 1));
    (is_body ? out->temperatures : out->readings).push_back(std::move(T));
  }
  if (file.has(group + "/drift")) {
    for (const std::string& place : file.groups(group + "/drift")) {
      const std::string path = group + "/drift/" + place;
      out->places.push_back(place);
      out->ranges.push_back(read_range(file, path, place));
      auto& drift = out->drift.emplace_back(readings);
      for (std::size_t c = 0; c < kDrifts; ++c) {
        const auto one = read_list(file, path + "/" + kDriftNames[c], um, readings);
        for (std::size_t n = 0; n < readings; ++n) drift[n][c] = one[n];
      }
    }
  }
  read_parts(file, group, *out);
  if (file.has_attribute(group, "stopped")) out->stopped = file.text(group, "stopped");
  return out;
}

}  // namespace servomill::sim::run
