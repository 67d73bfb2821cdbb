#include "sim/calibration/heat_readings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "plant/heat/temperature.h"
#include "plant/vocabulary/input_error.h"
#include "sim/model/heat.h"
#include "sim/model/machine.h"
#include "sim/readings/columns.h"

namespace servomill::sim::calibration {
namespace {

constexpr std::array<const char*, 3> kDrifts = {"drift_X", "drift_Y", "drift_Z"};
constexpr std::string_view kSensorEnding = "_degC";

class HeatTable {
 public:
  HeatTable(const std::string& path, const model::MachineSettings& machine)
      : table_(readings::read_table(path)), machine_(machine) {
    out_.file = path;
  }

  HeatReadings read() {
    find_columns();
    if (faults_.empty()) {
      for (const readings::Row& row : table_.rows) read(row);
    }
    if (faults_.empty() && out_.rows.empty()) fault("has no readings");
    if (!faults_.empty()) throw InputError(std::move(faults_));
    return std::move(out_);
  }

 private:
  void fault(std::string message) { faults_.push_back({{table_.file}, std::move(message)}); }

  void find_columns() {
    const JointLayout& layout = machine_.chain.layout;
    for (int j = 0; j < kJoints; ++j) {
      if (!layout.has(j)) continue;
      const std::string name(1, layout.letter_of(j));
      const char* unit = j < kLinearJoints ? "mm" : "deg";
      axes_.push_back({j, table_.find(name)});
      if (axes_.back().second == nullptr) {
        fault(fmt::format("needs a column {}_{}: the position of every axis", name, unit));
      }
    }
    tool_ = table_.find("tool");
    for (std::size_t c = 0; c < kDrifts.size(); ++c) drifts_[c] = table_.find(kDrifts[c]);
    if (std::all_of(drifts_.begin(), drifts_.end(), [](auto* one) { return one == nullptr; })) {
      fault("needs a column drift_X_um, drift_Y_um or drift_Z_um");
    }
    find_sensors();
  }

  void find_sensors() {
    std::vector<std::string_view> known;
    for (const model::HeatSensor& one : machine_.heat->sensors) known.push_back(one.name);
    for (const readings::Column& column : table_.columns) {
      if (!column.written.ends_with(kSensorEnding)) continue;
      const std::string name =
          column.written.substr(0, column.written.size() - kSensorEnding.size());
      if (std::find(known.begin(), known.end(), name) == known.end()) {
        fault(fmt::format("column {}: the machine has no temperature sensor '{}'{}; it has {}",
                          column.written, name, did_you_mean(name, known), fmt::join(known, ", ")));
      }
      out_.sensors.push_back(name);
      sensors_.push_back(&column);
    }
    if (sensors_.empty()) fault("needs a column NAME_degC for each temperature sensor");
  }

  void read(const readings::Row& row) {
    HeatReading one;
    for (const auto& [joint, column] : axes_) one.Q[joint] = needed(row, *column);
    if (tool_ != nullptr) one.p_ST.z() = -needed(row, *tool_);
    for (const readings::Column* sensor : sensors_) one.T.push_back(kelvin(needed(row, *sensor)));
    for (std::size_t c = 0; c < drifts_.size(); ++c) {
      if (drifts_[c] == nullptr) continue;
      const auto value = table_.number(row, *drifts_[c], faults_);
      if (value) one.drift[static_cast<Eigen::Index>(c)] = *value;
    }
    out_.rows.push_back(std::move(one));
  }

  double needed(const readings::Row& row, const readings::Column& column) {
    const std::size_t before = faults_.size();
    const std::optional<double> value = table_.number(row, column, faults_);
    if (!value && faults_.size() == before) {
      faults_.push_back({table_.place(row, column), column.written + " is empty"});
    }
    return value.value_or(0.0);
  }

  readings::Table table_;
  const model::MachineSettings& machine_;
  HeatReadings out_;
  std::vector<Fault> faults_;
  std::vector<std::pair<int, const readings::Column*>> axes_;
  const readings::Column* tool_ = nullptr;
  std::array<const readings::Column*, kDrifts.size()> drifts_ = {};
  std::vector<const readings::Column*> sensors_;
};

}  // namespace

HeatReadings read_heat_readings(const std::string& path, const model::MachineSettings& machine) {
  return HeatTable(path, machine).read();
}

}  // namespace servomill::sim::calibration
