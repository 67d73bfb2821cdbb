#include "sim/calibration/observation_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/units.h"
#include "sim/metrology/location_errors.h"

namespace servomill::sim::calibration {

using Eigen::Vector3d;
using readings::Reading;

namespace {

constexpr double kLostMotion = 50e-6;  // m, standard deviation that is expected

// Linear joints that move within a group in known directions.
std::vector<int> travelling_joints(const readings::Group& group) {
  std::vector<int> out;
  for (int j = 0; j < kLinearJoints; ++j) {
    const bool moves =
        std::any_of(group.rows.begin(), group.rows.end(), [j](const Reading& reading) {
          return reading.direction[static_cast<std::size_t>(j)] != 0;
        });
    if (moves) out.push_back(j);
  }
  return out;
}

bool has_direction(const Reading& reading) {
  return std::any_of(reading.direction.begin(), reading.direction.end(),
                     [](int direction) { return direction != 0; });
}

}  // namespace

ObservationBuilder::ObservationBuilder(const readings::Readings& readings,
                                       const plant::MachineChain& chain)
    : readings_(readings), chain_(chain) {
  for (const readings::Instrument& instrument : readings.instruments) {
    if (!(instrument.scale_uncertainty > 0.0)) {
      scales_.emplace_back();
      continue;
    }
    scales_.emplace_back(add_unknown({.name = "scale of " + instrument.name,
                                      .group = std::nullopt,
                                      .prior = instrument.scale_uncertainty,
                                      .unit = 1e-6,
                                      .unit_name = "um/m"}));
  }
}

std::size_t ObservationBuilder::add_unknown(SetUpUnknown unknown) {
  out_.set_up.push_back(std::move(unknown));
  return out_.set_up.size() - 1;
}

std::size_t ObservationBuilder::add_own(std::string name, double unit, std::string unit_name,
                                        std::optional<double> prior) {
  return add_unknown({.name = std::move(name),
                      .group = group_,
                      .prior = prior,
                      .unit = unit,
                      .unit_name = std::move(unit_name)});
}

Point ObservationBuilder::add_point(const std::string& name) {
  return {add_own(name + " X"), add_own(name + " Y"), add_own(name + " Z")};
}

std::size_t ObservationBuilder::add_size(const std::string& name) {
  const std::size_t out = add_own(name, um, "um", group().size_uncertainty);
  out_.set_up[out].is_size = true;
  return out;
}

std::optional<std::size_t> ObservationBuilder::scale() const {
  const auto instrument = group().instrument;
  return instrument ? scales_[*instrument] : std::nullopt;
}

const ArtefactUnknowns& ObservationBuilder::calibration_of(std::size_t artefact) {
  const auto [found, is_new] = artefacts_.try_emplace(artefact);
  if (!is_new) return found->second;
  const readings::Artefact& one = readings_.artefacts[artefact];
  const auto add = [this](std::string name, double prior, std::string unit_name) {
    return add_unknown({.name = std::move(name),
                        .group = std::nullopt,
                        .prior = prior,
                        .unit = 1e-6,
                        .unit_name = std::move(unit_name)});
  };
  if (one.scale_uncertainty > 0.0) {
    found->second.scale = add("scale of " + one.name, one.scale_uncertainty, "um/m");
  }
  if (one.uncertainty > 0.0) {
    for (const readings::Ball& ball : one.balls) {
      const std::string name = fmt::format("ball {} of {}", ball.name, one.name);
      found->second.balls.push_back({add(name + " X", one.uncertainty, "um"),
                                     add(name + " Y", one.uncertainty, "um"),
                                     add(name + " Z", one.uncertainty, "um")});
    }
  }
  return found->second;
}

Observation& ObservationBuilder::add(std::size_t row, int number, Pose pose) {
  const Reading& reading = group().rows[row];
  pose.Q = reading.Q;
  pose.p_ST = group().p_ST;
  pose.direction = reading.direction;
  out_.all.push_back({.poses = {pose},
                      .set_up = {},
                      .d = reading.deviation[number],
                      .correction = 0.0,
                      .group = group_,
                      .row = row});
  return out_.all.back();
}

void ObservationBuilder::correct(Observation& one, double by) {
  one.d += by;
  one.correction += by;
}

Vector3d ObservationBuilder::tip(const Joints& Q) const {
  return plant::forward(chain_, Q, group().p_ST).p_WT;
}

Vector3d ObservationBuilder::direction_of(Axis axis, const Joints& Q) const {
  const Vector3d unit = Vector3d::Unit(index_of(axis) % 3);
  return plant::R_WM(chain_, Q) * unit;
}

Vector3d ObservationBuilder::turn_of(Axis axis, const Joints& Q) const {
  Joints beyond = Q;
  const double step = 1e-4;
  beyond[joint(axis)] += step;
  const Eigen::Matrix3d R = metrology::R_WS(chain_, Q);
  const Eigen::Matrix3d dR = (metrology::R_WS(chain_, beyond) - R) * R.transpose() / step;
  return Vector3d(dR(2, 1) - dR(1, 2), dR(0, 2) - dR(2, 0), dR(1, 0) - dR(0, 1)).normalized();
}

double ObservationBuilder::share_of_time(std::size_t row) const {
  const std::vector<Reading>& rows = group().rows;
  const double first = rows.front().time, last = rows.back().time;
  if (!std::isnan(first) && last > first) return (rows[row].time - first) / (last - first);
  return static_cast<double>(row) / static_cast<double>(std::max<std::size_t>(rows.size() - 1, 1));
}

void ObservationBuilder::add_drift() {
  const bool is_angle = readings::is_angular(group().kind, group().axis);
  std::vector<std::size_t> rates;
  for (int k = 0; k < readings::numbers_of(group().kind); ++k) {
    rates.push_back(is_angle ? add_own("drift", urad, "urad") : add_own("drift"));
  }
  std::size_t number = 0, row_before = group().rows.size();
  for (Observation& one : out_.all) {
    if (one.group != group_) continue;
    number = one.row == row_before ? number + 1 : 0;
    row_before = one.row;
    one.set_up.push_back({rates[number], share_of_time(one.row)});
  }
}

void ObservationBuilder::add_turning_points() {
  const std::vector<int> joints = travelling_joints(group());
  std::map<std::pair<std::size_t, int>, std::size_t> unknowns;  // of row and joint
  for (Observation& one : out_.all) {
    if (one.group != group_ || !has_direction(group().rows[one.row])) continue;
    const Reading& reading = group().rows[one.row];
    for (const int joint : joints) {
      if (reading.direction[static_cast<std::size_t>(joint)] != 0) continue;
      const Axis axis = *chain_.layout.axis[static_cast<std::size_t>(joint)];
      const auto [found, is_new] = unknowns.try_emplace({one.row, joint});
      if (is_new) {
        found->second =
            add_own(fmt::format("turning point of {} in line {}", letter(axis), reading.line), 1e-6,
                    "um", kLostMotion);
        out_.set_up[found->second].turning = axis;
      }
      const Pose& pose = one.poses.front();
      one.set_up.push_back({found->second, pose.n_W.dot(direction_of(axis, pose.Q))});
    }
  }
}

}  // namespace servomill::sim::calibration
