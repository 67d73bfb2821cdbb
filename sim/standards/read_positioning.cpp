#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "plant/vocabulary/units.h"
#include "plant/vocabulary/user_file.h"
#include "sim/readings/columns.h"
#include "sim/readings/read_rows.h"
#include "sim/standards/positioning_log.h"
#include "sim/standards/positioning_readings.h"

namespace servomill::sim::standards {
namespace {

using readings::Column;
using readings::Row;
using readings::Table;

constexpr std::string_view kDirections =
    "must be forward or backward (up, down, positive, negative, +, -)";

// "p1", "p12": run 0, 11
std::optional<int> run_of(std::string_view name) {
  if (name.size() < 2 || name.size() > 5 || name.front() != 'p') return std::nullopt;
  int run = 0;
  for (const char digit : name.substr(1)) {
    if (digit < '0' || digit > '9') return std::nullopt;
    run = 10 * run + (digit - '0');
  }
  return run > 0 ? std::optional(run - 1) : std::nullopt;
}

// "; the position is 1000 times the target: is it in um?" where a ratio of units explains it.
std::string unit_hint(double position, double target) {
  struct Ratio {
    double value;
    std::string_view text;
  };
  constexpr std::array<Ratio, 6> kRatios = {Ratio{1e3, "1000 times"}, {1e-3, "1/1000 of"},
                                            {25.4, "25.4 times"},     {1 / 25.4, "1/25.4 of"},
                                            {deg, "pi/180 times"},    {1 / deg, "180/pi times"}};
  constexpr double kNear = 0.01;
  for (const Ratio& ratio : kRatios) {
    if (target == 0.0 || std::abs(position / target / ratio.value - 1.0) > kNear) continue;
    return fmt::format(
        "; it is {} the target: if columns have different units, put each unit in its name, such "
        "as target_mm, position_um",
        ratio.text);
  }
  return "; check units and signs of target and position";
}

class PositioningReader {
 public:
  explicit PositioningReader(const std::string& path) : table_(readings::read_table(path)) {}

  PositioningFile read() {
    find_columns();
    if (!faults_.empty()) throw InputError(std::move(faults_));
    if (direction_ == nullptr) set_order();
    if (!faults_.empty()) throw InputError(std::move(faults_));
    for (const Row& row : table_.rows) add(row);
    if (!faults_.empty()) throw InputError(std::move(faults_));
    PositioningFile out;
    out.name = table_.file;
    out.test = arrange(readings_, angular_);
    out.remarks = std::move(remarks_);
    for (std::string& one : outliers(readings_, angular_)) out.remarks.push_back(std::move(one));
    return out;
  }

 private:
  void fault(const Place& place, std::string message) {
    faults_.push_back({place, std::move(message)});
  }

  void find_columns() {
    constexpr std::array<std::string_view, 6> kKnown = {"direction", "run",       "target",
                                                        "position",  "deviation", "time"};
    for (const Column& column : table_.columns) {
      if (const auto run = run_of(column.name)) {
        runs_.emplace_back(*run, &column);
      } else if (std::find(kKnown.begin(), kKnown.end(), column.name) == kKnown.end()) {
        fault({table_.file}, fmt::format("column {} is unknown in a positioning test{}; known are "
                                         "{}, and p1, p2, ... with the positions of a run each",
                                         column.written, did_you_mean(column.name, kKnown),
                                         fmt::join(kKnown, ", ")));
      }
    }
    direction_ = table_.find("direction");
    target_ = table_.find("target");
    if (direction_ == nullptr && !runs_.empty()) {
      fault({table_.file}, fmt::format("column direction is missing; it {}", kDirections));
    }
    if (target_ == nullptr) {
      fault({table_.file}, "column target_mm (target_deg for a rotary axis) is missing");
      return;
    }
    angular_ = target_->unit.quantity == config::kAngle;
    target_factor_ = factor(*target_);
    find_values();
  }

  void find_values() {
    position_ = table_.find("position");
    deviation_ = table_.find("deviation");
    const int forms = int(position_ != nullptr) + int(deviation_ != nullptr) + int(!runs_.empty());
    if (forms != 1) {
      fault({table_.file}, fmt::format("has {}; a positioning test needs position_mm, or "
                                       "deviation_um, or positions p1, p2, ... of the runs",
                                       forms == 0 ? "no readings" : "readings in several forms"));
      return;
    }
    if (position_ != nullptr) value_factor_ = factor(*position_);
    if (deviation_ != nullptr) value_factor_ = factor(*deviation_);
    if (!runs_.empty()) value_factor_ = factor(*runs_.front().second);
    if (runs_.size() > 1) {
      const Column& first = *runs_.front().second;
      for (const auto& [run, column] : runs_) {
        if (column->unit.symbol == first.unit.symbol) continue;
        fault({table_.file},
              fmt::format("columns {} and {} have different units; use one unit for all runs",
                          first.written, column->written));
      }
    }
  }

  // To SI; a column without a unit has that of the targets, these mm.
  double factor(const Column& column) {
    if (column.unit.quantity == (angular_ ? config::kAngle : config::kLength)) {
      return column.unit.factor;
    }
    if (column.unit.quantity != config::kNumber) {
      fault({table_.file},
            fmt::format("column {} is in {}, the targets are in {}; use units of the same quantity",
                        column.written, column.unit.symbol, target_->unit.symbol));
      return 1.0;
    }
    if (&column == target_) {
      remarks_.push_back(
          fmt::format("{}: column {} has no unit: mm is assumed; name it target_mm, or target_deg "
                      "for a rotary axis",
                      table_.file, column.written));
      return mm;
    }
    if (&column == deviation_) {
      fault({table_.file},
            fmt::format(
                "column {} has no unit; name it deviation_um, or deviation_urad for a rotary axis",
                column.written));
    }
    return target_factor_;
  }

  std::optional<double> number(const Row& row, const Column& column) {
    const auto value = table_.number(row, column, faults_);
    if (!value) fault(table_.place(row, column), fmt::format("{} is empty", column.written));
    return value ? std::optional(*value / column.unit.factor) : std::nullopt;
  }

  void add(const Row& row) {
    const int direction = direction_ == nullptr
                              ? by_order_[place_in_order_++]
                              : readings::direction_of(table_.text(row, *direction_)).value_or(0);
    if (direction == 0) {
      fault(table_.place(row, *direction_),
            fmt::format("direction = {}; {}", table_.text(row, *direction_), kDirections));
    }
    const auto target = number(row, *target_);
    if (!target || direction == 0) return;
    TargetReading one;
    one.target = *target * target_factor_;
    one.direction = direction;
    for (const auto& [run, column] : runs_) add_value(row, *column, run, one);
    if (!runs_.empty()) return;
    if (const Column* column = table_.find("time")) {
      const auto time = number(row, *column);
      if (time) one.time = *time * column->unit.factor;
    }
    const auto run = run_number(row, one);
    if (run) add_value(row, position_ != nullptr ? *position_ : *deviation_, *run, one);
  }

  // Directions of rows without them, in the order in which they were taken: targets that rise were
  // approached forward. The last target of a run, there twice, begins the way back.
  void set_order() {
    std::vector<double> targets;
    for (const Row& row : table_.rows) targets.push_back(number(row, *target_).value_or(0.0));
    by_order_.assign(targets.size(), 0);
    for (std::size_t i = 0; i + 1 < targets.size(); ++i) {
      if (targets[i + 1] == targets[i]) continue;
      const int way = targets[i + 1] > targets[i] ? 1 : -1;
      by_order_[i + 1] = way;
      const bool begins = i == 0 || targets[i] == targets[i - 1];
      if (begins) by_order_[i] = way;
    }
    const auto lost = std::find(by_order_.begin(), by_order_.end(), 0);
    if (lost != by_order_.end()) {
      fault({table_.file, table_.rows[std::size_t(lost - by_order_.begin())].line},
            fmt::format("the order of the rows does not determine its direction; add a column "
                        "direction: it {}",
                        kDirections));
      return;
    }
    remarks_.push_back(
        fmt::format("{}: has no column direction: taken from the order of the rows, ascending "
                    "targets as forward",
                    table_.file));
  }

  // The column run, or how often the target was approached before.
  std::optional<int> run_number(const Row& row, const TargetReading& one) {
    const Column* column = table_.find("run");
    if (column == nullptr) return approaches_[{one.target, one.direction}]++;
    constexpr double kMax = 1000.0;
    const auto run = number(row, *column);
    if (!run) return std::nullopt;
    if (*run >= 1.0 && *run <= kMax && *run == std::floor(*run)) return static_cast<int>(*run) - 1;
    fault(table_.place(row, *column), fmt::format("run = {:g}; must be an integer from 1 to "
                                                  "{:g}",
                                                  *run, kMax));
    return std::nullopt;
  }

  void add_value(const Row& row, const Column& column, int run, TargetReading one) {
    if (table_.text(row, column).empty()) {
      fault(table_.place(row, column),
            fmt::format("run {} is missing at this target; measure it, or remove the run at all "
                        "targets",
                        run + 1));
      return;
    }
    const std::size_t before = faults_.size();
    const auto value = number(row, column);
    if (!value || faults_.size() > before) return;
    one.run = run;
    one.place = table_.place(row, column);
    const double si = *value * value_factor_;
    one.deviation = &column == deviation_ ? si : si - one.target;
    const double largest = angular_ ? readings::kLargestAngle : readings::kLargestDeviation;
    if (std::abs(one.deviation) > largest) {
      const double unit = angular_ ? 1e-3 : mm;
      fault(one.place,
            fmt::format("{} = {:g} at target {:g} deviates by {:.6g} {}; must be at most {:g} {}{}",
                        column.written, *value, one.target / target_factor_, one.deviation / unit,
                        angular_ ? "mrad" : "mm", largest / unit, angular_ ? "mrad" : "mm",
                        &column == deviation_ ? "; check its unit" : unit_hint(si, one.target)));
      return;
    }
    readings_.push_back(one);
  }

  Table table_;
  std::vector<Fault> faults_;
  std::vector<std::string> remarks_;
  std::vector<TargetReading> readings_;
  bool angular_ = false;
  double target_factor_ = mm, value_factor_ = mm;
  const Column *direction_ = nullptr, *target_ = nullptr, *position_ = nullptr,
               *deviation_ = nullptr;
  std::vector<std::pair<int, const Column*>> runs_;
  std::map<std::pair<double, int>, int> approaches_;
  std::vector<int> by_order_;  // direction of each row where no column has it
  std::size_t place_in_order_ = 0;
};

}  // namespace

PositioningFile read_positioning(const std::string& path) {
  std::string why;
  const std::string text = read_input(path, kMaxBytesOfDocument, why);
  if (!why.empty()) throw InputError({path}, why);
  if (is_list_of_readings(text)) return parse_list_of_readings(text, path);
  return PositioningReader(path).read();
}

}  // namespace servomill::sim::standards
