#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/readings/columns.h"
#include "sim/standards/error_motion.h"

namespace servomill::sim::standards {
namespace {

constexpr double kSameAngle = 0.1 * deg;  // of one angle in different revolutions
constexpr std::array<std::string_view, 5> kSensors = {"x", "y", "z", "x2", "y2"};

class RotationReader {
 public:
  RotationReader(const std::string& path, double distance)
      : distance_(distance), table_(readings::read_table(path)) {}

  RotationTest read() {
    find_columns();
    if (!faults_.empty()) throw InputError(std::move(faults_));
    read_rows();
    if (!faults_.empty()) throw InputError(std::move(faults_));
    return rotation_of(table_.file, theta_, sensors_, distance_);
  }

 private:
  void fault(const Place& place, std::string message) {
    faults_.push_back({place, std::move(message)});
  }

  void find_columns() {
    angle_ = table_.find("angle");
    revolution_ = table_.find("revolution");
    if (angle_ == nullptr || !(angle_->unit.quantity == config::kAngle)) {
      fault({table_.file}, "column angle_deg of the rotation is missing");
    }
    for (const std::string_view name : kSensors) {
      const readings::Column* column = table_.find(name);
      if (column == nullptr) continue;
      if (!(column->unit.quantity == config::kLength)) {
        fault({table_.file},
              fmt::format("column {} must name its unit, such as {}_um", column->written, name));
      }
      columns_.emplace_back(name, column);
    }
    if (columns_.empty()) {
      fault({table_.file},
            "has no sensor: columns x_um, y_um (radial), z_um (axial), x2_um, y2_um (radial at a "
            "second position)");
    }
    const bool second = table_.find("x2") != nullptr || table_.find("y2") != nullptr;
    if (second && distance_ <= 0.0) {
      fault({"--distance"}, "is required with x2_um and y2_um: their distance from x_um and y_um");
    }
  }

  double number(const readings::Row& row, const readings::Column& column) {
    const auto value = table_.number(row, column, faults_);
    if (!value) fault(table_.place(row, column), fmt::format("{} is empty", column.written));
    return value.value_or(0.0);
  }

  // Rows of each revolution, in their order.
  void read_rows() {
    std::map<int, std::vector<const readings::Row*>> revolutions;
    for (const readings::Row& row : table_.rows) {
      const int revolution =
          revolution_ == nullptr ? 1 : static_cast<int>(std::lround(number(row, *revolution_)));
      revolutions[revolution].push_back(&row);
    }
    const auto& first = revolutions.begin()->second;
    set_angles(first);
    for (const auto& [name, column] : columns_) {
      sensors_[name].resize(theta_.size(), static_cast<Eigen::Index>(revolutions.size()));
    }
    Eigen::Index j = 0;
    for (const auto& [revolution, rows] : revolutions) {
      if (rows.size() != first.size()) {
        fault(
            {table_.file, rows.back()->line},
            fmt::format(
                "revolution {} has {} angles, the first {}: every revolution needs the same number",
                revolution, rows.size(), first.size()));
        return;
      }
      for (Eigen::Index i = 0; i < theta_.size(); ++i) {
        const readings::Row& row = *rows[static_cast<std::size_t>(i)];
        const double off = std::remainder(number(row, *angle_) - theta_[i], 2.0 * std::numbers::pi);
        if (std::abs(off) > kSameAngle) {
          fault(table_.place(row, *angle_),
                fmt::format("angle {} is {:.3g} deg off that of the first revolution; readings "
                            "must be triggered at the same angles",
                            table_.text(row, *angle_), off / deg));
          return;
        }
        for (const auto& [name, column] : columns_) sensors_[name](i, j) = number(row, *column);
      }
      ++j;
    }
  }

  void set_angles(const std::vector<const readings::Row*>& first) {
    constexpr std::size_t kFewest = 8;
    theta_.resize(static_cast<Eigen::Index>(first.size()));
    for (std::size_t i = 0; i < first.size(); ++i) {
      theta_[static_cast<Eigen::Index>(i)] = number(*first[i], *angle_);
    }
    if (first.size() < kFewest) {
      fault({table_.file}, fmt::format("has {} angles per revolution; must be at least {}",
                                       first.size(), kFewest));
      return;
    }
    // a gap of the first revolution, across its end
    Eigen::ArrayXd sorted = theta_.unaryExpr([](double angle) {
      const double turned = std::fmod(angle, 2.0 * std::numbers::pi);
      return turned < 0.0 ? turned + 2.0 * std::numbers::pi : turned;
    });
    std::sort(sorted.begin(), sorted.end());
    const Eigen::Index n = sorted.size();
    const double widest = std::max((sorted.tail(n - 1) - sorted.head(n - 1)).maxCoeff(),
                                   sorted[0] + 2.0 * std::numbers::pi - sorted[n - 1]);
    constexpr double kWidest = 60.0 * deg;
    if (widest > kWidest) {
      fault({table_.file}, fmt::format("the angles of the first revolution leave a gap of {:.4g} "
                                       "deg; they must cover the full circle",
                                       widest / deg));
    }
  }

  double distance_;
  readings::Table table_;
  std::vector<Fault> faults_;
  const readings::Column *angle_ = nullptr, *revolution_ = nullptr;
  std::vector<std::pair<std::string_view, const readings::Column*>> columns_;
  Eigen::ArrayXd theta_;
  RotationSensors sensors_;
};

}  // namespace

RotationTest read_rotation(const std::string& path, double distance) {
  return RotationReader(path, distance).read();
}

}  // namespace servomill::sim::standards
