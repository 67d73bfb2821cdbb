#include "plant/drives/drive_bank.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>
#include <utility>

namespace servomill::plant {
namespace {

enum Row : int { kCurrent = 0, kVelocity = 3, kCommand = 5 };

using Matrix7l = Eigen::Matrix<long double, 7, 7>;

// [A B; 0 0] h -> exp: the first rows hold exp(A h) and the integral that multiplies the input.
// Computed in variables of equal size (all m/s or m/s^2) and in long double: in SI the entries span
// eight decades, and a slide at rest under load would creep by what the exponential loses.
Eigen::Matrix<double, 5, 7> hold_matrix(const FeedDriveParams& p, double h) {
  const double stiffness = p.is_rigid() ? 0.0 : p.k;
  const double omega = std::sqrt(stiffness / p.M) + 1.0;
  Eigen::Matrix<double, 7, 1> scale;
  scale << 1.0, 1.0 / p.r, 1.0 / omega, 1.0, 1.0 / omega, 1.0, p.M;
  Matrix7l generator = Matrix7l::Zero();
  generator.topRows<5>() = drive_equations(p).cast<long double>() * static_cast<long double>(h);
  const Eigen::Matrix<long double, 7, 1> S = scale.cast<long double>();
  const Matrix7l scaled = S.cwiseInverse().asDiagonal() * generator * S.asDiagonal();
  Matrix7l E = S.asDiagonal() * Matrix7l(scaled.exp()) * S.cwiseInverse().asDiagonal();
  if (p.current_is_command()) {
    E.row(kCurrent).setZero();
    E(kCurrent, kCommand) = 1.0L;
  }
  return E.topRows<5>().cast<double>();
}

}  // namespace

DriveBank::DriveBank(const std::array<FeedDriveParams, kJoints>& params,
                     const std::array<bool, kJoints>& present, double base_period,
                     std::span<const Tick> steps)
    : params_(params), present_(present) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!present_[j]) continue;
    inverse_r_[j] = 1.0 / params_[j].r;
    F_load_[j] = params_[j].F_load;
  }
  Tick longest = 1;
  for (const Tick step : steps) {
    assert(step > 0);
    longest = std::max(longest, step);
    const auto index = static_cast<std::size_t>(step);
    if (index >= matrix_of_step_.size()) matrix_of_step_.resize(index + 1, -1);
    if (matrix_of_step_[index] >= 0) continue;
    matrix_of_step_[index] = static_cast<int>(matrices_.size());
    StepMatrix& matrix = matrices_.emplace_back();
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (!present_[j]) continue;
      const double h = static_cast<double>(step) * base_period;
      const auto E = hold_matrix(params_[j], h);
      for (std::size_t row = 0; row < kStates; ++row) {
        for (std::size_t col = 0; col < kColumns; ++col) {
          matrix.coefficient[row * kColumns + col][j] =
              E(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(col));
        }
      }
      if (params_[j].is_linear()) continue;
      const auto middle = hold_matrix(params_[j], 0.5 * h);
      for (std::size_t col = 0; col < kColumns; ++col) {
        matrix.middle[col][j] = middle(kVelocity, static_cast<Eigen::Index>(col));
      }
    }
  }
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (steps.empty() || !present_[j] || params_[j].is_linear()) continue;
    ExactStep exact(params_[j], base_period, longest);
    nonlinear_.push_back({j, exact.gliding(), std::move(exact)});
  }
}

DriveState::Lanes DriveBank::product(const DriveState::Lanes* row, const Columns& in) {
  DriveState::Lanes sum{};
  for (std::size_t col = 0; col < kColumns; ++col) {
    const DriveState::Lanes& a = row[col];
    const DriveState::Lanes& u = *in[col];
    for (std::size_t j = 0; j < kJoints; ++j) sum[j] += a[j] * u[j];
  }
  return sum;
}

void DriveBank::advance(DriveState& s, const DriveInput& input, Tick step) const {
  assert(static_cast<std::size_t>(step) < matrix_of_step_.size());
  const int index = matrix_of_step_[static_cast<std::size_t>(step)];
  assert(index >= 0);
  const StepMatrix& matrix = matrices_[static_cast<std::size_t>(index)];
  DriveState::Lanes force;
  for (std::size_t j = 0; j < kJoints; ++j) force[j] = input.F[j] + F_load_[j];
  std::array<bool, kJoints> glides{};
  for (const auto& [j, gliding, exact] : nonlinear_) {
    glides[j] = gliding.holds(s.v[j], s.z[j]);
    if (glides[j]) force[j] += gliding.force(s.v[j]);
  }

  const Columns in = {&s.i, &s.w, &s.delta, &s.v, &s.x, &input.command, &force};
  std::array<DriveState::Lanes, kStates> out;
  for (std::size_t row = 0; row < kStates; ++row) {
    out[row] = product(&matrix.coefficient[row * kColumns], in);
  }
  if (!nonlinear_.empty()) {
    // A joint that left its zone of constant friction, or never was in it, is moved by itself.
    const DriveState::Lanes middle = product(matrix.middle.data(), in);
    for (const auto& [j, gliding, exact] : nonlinear_) {
      const double direction = s.v[j] > 0.0 ? 1.0 : -1.0;
      const double slowest = std::min(direction * middle[j], direction * out[kVelocity][j]);
      if (glides[j] && slowest > gliding.speed) {
        s.slide[j] = s.v[j] > 0.0 ? SlideMode::positive : SlideMode::negative;
        continue;
      }
      LaneState lane = s.lane(j);
      exact.advance(lane, input.command[j], input.F[j], step);
      out[0][j] = lane.i;
      out[1][j] = lane.w;
      out[2][j] = lane.delta;
      out[3][j] = lane.v;
      out[4][j] = lane.x;
      s.set_lane(j, lane);
    }
  }
  s.i = out[0];
  s.w = out[1];
  s.delta = out[2];
  s.v = out[3];
  s.x = out[4];
}

DriveState DriveBank::at_rest(const Joints& Q) const {
  DriveState s;
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (present_[j]) s.set_lane(j, plant::at_rest(params_[j], Q[static_cast<Eigen::Index>(j)]));
  }
  return s;
}

}  // namespace servomill::plant
