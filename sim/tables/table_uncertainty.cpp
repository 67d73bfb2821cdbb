#include "sim/tables/table_uncertainty.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "plant/geometry/volumetric.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/model/propagation.h"

namespace servomill::sim::tables {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::string size_of(bool angle, double value) {
  return angle ? fmt::format("{:.3g} urad", value / urad) : fmt::format("{:.3g} um", value / um);
}

// Some of the points of a table, its ends included.
std::vector<double> places_of(const CompensationTable& table) {
  constexpr std::size_t kPlaces = 41;
  const std::size_t last = table.line.points - 1, intervals = std::min(last, kPlaces - 1);
  std::vector<double> out;
  for (std::size_t i = 0; i <= intervals; ++i) {
    out.push_back(table.line.position(table.line.entry(i * last / intervals)));
  }
  return out;
}

std::vector<int> directions_of(const CompensationTable& table) {
  return table.depends_on_direction() ? std::vector<int>{1, -1} : std::vector<int>{0};
}

// A machine with other errors, and what tables hold of it.
class Held {
 public:
  Held(const TableExport& e, const plant::ErrorModel& errors)
      : rules_(e.rules()), source_(e.source) {
    source_.errors = errors;
    if (!rules_.components) correction_.emplace(source_);
  }

  double at(const CompensationTable& table, double q, int direction) const {
    if (correction_) return -correction_->over(table.line.joint, q, direction)[table.output];
    if (!rules_.tool_side) return component_on_line(source_, *table.component, q, direction);
    AxisWords words = source_.chain.layout.words(source_.reference);
    words[index_of(table.component->axis)] = q;
    return written_error(source_, rules_, *table.component, words);
  }

 private:
  const FormatRules& rules_;
  TableSource source_;
  std::optional<LineCorrection> correction_;
};

// All tables one after the other.
VectorXd values_of(const TableExport& e, const plant::ErrorModel& errors) {
  const Held held(e, errors);
  std::vector<double> out;
  for (const CompensationTable& table : e.tables) {
    for (const double q : places_of(table)) {
      for (const int direction : directions_of(table)) out.push_back(held.at(table, q, direction));
    }
  }
  return Eigen::Map<const VectorXd>(out.data(), Index(out.size()));
}

Index count_of(const CompensationTable& table) {
  return Index(places_of(table).size() * directions_of(table).size());
}

// Deviations of the tip since the reference, of X, Y and Z at one pose after the other.
VectorXd tip_deviations(const TableExport& e, const plant::ErrorModel& errors) {
  constexpr int kPoses = 500;
  const plant::VolumetricModel machine(e.source.chain, errors);
  const auto deviation = [&](const Joints& Q) {
    return machine.first_order_error(Q, e.source.p_ST).dp_W;
  };
  const Eigen::Vector3d reference = deviation(e.source.reference);
  Eigen::Matrix3Xd out(3, kPoses);
  for (int n = 0; n < kPoses; ++n) {
    out.col(n) = deviation(spread_pose(e.source, e.lines, n + 1)) - reference;
  }
  return out.reshaped();
}

}  // namespace

model::Determination determination(const VectorXd& values, const VectorXd& expanded) {
  model::Determination out;
  for (Index i = 0; i < values.size(); ++i) out.add(values[i], expanded[i]);
  return out;
}

void take_uncertainty(TableExport& e) {
  if (!e.request.identified || e.tables.empty()) return;
  const auto numbers = [&](const plant::ErrorModel& errors) { return values_of(e, errors); };
  const VectorXd values = numbers(e.source.errors);
  const VectorXd U = model::expanded_uncertainty(numbers, e.source.errors, *e.request.identified);
  std::vector<CompensationTable> kept;
  Index first = 0;
  for (CompensationTable& table : e.tables) {
    const Index count = count_of(table);
    const auto found = determination(values.segment(first, count), U.segment(first, count));
    first += count;
    table.uncertainty = found.uncertainty();
    if (e.rules().components || found.is_determined()) {
      kept.push_back(std::move(table));
    } else {
      e.omitted.push_back({table.line.joint, table.output, table.largest(), table.uncertainty});
    }
  }
  e.tables = std::move(kept);
}

void refuse_undetermined_tip(const TableExport& e) {
  if (!e.request.identified) return;
  const auto numbers = [&](const plant::ErrorModel& errors) { return tip_deviations(e, errors); };
  const VectorXd values = numbers(e.source.errors);
  const VectorXd U = model::expanded_uncertainty(numbers, e.source.errors, *e.request.identified);
  model::TipDetermination tip;
  for (Index n = 0; n < values.size(); n += 3) tip.add(values.segment<3>(n), U.segment<3>(n));
  const auto i = tip.undetermined();
  if (!i) return;
  throw InputError(
      {},
      fmt::format("{} of the TCP is corrected by up to {} in the travel, with U(k = 2) up to {}: "
                  "not determined by the calibration; take the measurements that servomill "
                  "calibrate names, or limit the travel with --travel",
                  "XYZ"[*i], size_of(false, tip.of(*i).largest()),
                  size_of(false, tip.of(*i).uncertainty())));
}

std::string uncertainty_text(const CompensationTable& table) {
  if (!table.uncertainty) return "";
  return fmt::format("; U(k = 2) up to {}", size_of(table.is_angle(), *table.uncertainty));
}

std::vector<std::string> undetermined_lines(const TableExport& e) {
  std::vector<std::string> out;
  for (const OmittedTable& table : e.omitted) {
    if (!table.uncertainty) continue;
    const bool is_angle = table.output >= kLinearJoints;
    out.push_back(
        fmt::format("no table {} over {}: up to {} with U(k = 2) up to {}: not determined by the "
                    "calibration",
                    e.letter(table.output), e.letter(table.base), size_of(is_angle, table.largest),
                    size_of(is_angle, *table.uncertainty)));
  }
  return out;
}

}  // namespace servomill::sim::tables
