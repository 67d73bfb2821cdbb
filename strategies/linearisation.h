/// Programs of joint positions whose lines bend in the workpiece because rotary axes turn on the
/// way: what the strategies share that put points into such lines. Source: X. Li (2024), see
/// plant/kinematics/nonlinear_error.h.
///
/// A program without tool-centre-point control does not say where the tool should be on the way. It
/// is taken to be straight between where the axes put the tool at both ends. Feed moves in which
/// rotary and linear axes go together are rewritten; rapids and moves of rotary axes alone are left
/// as they are.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "plant/kinematics/nonlinear_error.h"
#include "plant/vocabulary/parameters.h"
#include "strategies/strategy.h"

namespace servomill::strategies {

/// Points behind the start of a line that goes from Q_0 to Q_1, the last at t = 1 with Q_1.
/// @throws InputError without a place if there are none
using PointsOfLine =
    std::function<std::vector<plant::PathPoint>(const Joints& Q_0, const Joints& Q_1)>;

/// Hands out the moves with points put into every line that may bend. Line, arc length and duration
/// of a move are shared out among its blocks.
/// @throws InputError with the line (and no file) for an arc with rotary axes, and where there are
/// no points
void put_with_points(const MoveRange& moves, const IdentifiedMachine& identified,
                     const PointsOfLine& points_of, const PutMove& put);

/// The nominal machine that a strategy assumes, with its travel.
plant::InverseKinematics nominal_inverse(const IdentifiedMachine& identified);

/// Parameters of the strategies that compensate with a model of the error.
std::span<const ParameterSpec> error_model_specs();

/// Such a strategy.
std::unique_ptr<Strategy> make_error_model(plant::ErrorShape shape, const Parameters& parameters,
                                           const IdentifiedMachine& identified);

}  // namespace servomill::strategies
