/// Component errors of an axis as if it carried the tool, for controls that count every axis so.
///
/// Our error model and TF5280 with `workpiece_axes 0` and its usual calculation rule, in the axes
/// of M (plant/geometry/error_model.h):
///
///     ours, tool side        H = L J(q) L^-1 E(q)
///     ours, workpiece side   H = E(q) L J(q) L^-1
///     TF5280, every axis     H = L J(q) L^-1 E'(q)
///
/// Hence E' = E on the tool side and E' = J^-1 E J on the workpiece side. L is the same in both;
/// neglected is what L turns E' by, of second order in the errors. Angles of ours turn about the
/// centre of the axis; angles of E' about the origin of M for a linear axis, about the centre for a
/// rotary one.
///
/// Sources: TF5280 counts all axes as carrying the tool where workpiece_axes is 0, its default
/// (ISG kernel, Werkstueckachsen, isg-stuttgart.de/fileadmin/kernel/kernel-html/de-DE/
/// 296411019.html), and follows ISO 230-1 and ISO/TR 16907 (infosys.beckhoff.com/content/1033/
/// tf5280_volumetric_comp/296386187.html). The order of the matrices is in none of the pages found;
/// errors that belong to the moved body are assumed, as in ISO 230-1. `alternative_model` selects
/// another rule, which is not covered.
#pragma once

#include <Eigen/Core>

#include <string_view>

#include "plant/geometry/error_model.h"
#include "plant/kinematics/chain.h"

namespace servomill::sim::tables {

/// All six component errors of one axis at one position, along and about X, Y, Z.
struct ComponentErrors {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();   // rad
};

/// The part of that direction.
double& part_of(ComponentErrors& errors, Axis direction);

/// E' of E. @param q  position of the axis (m, rad)
ComponentErrors tool_side(const plant::ChainAxis& axis, const ComponentErrors& ours, double q);

/// E of E'.
ComponentErrors from_tool_side(const plant::ChainAxis& axis, const ComponentErrors& theirs,
                               double q);

/// Refuses errors of axes for which no document found defines E': rotary axes that count as their
/// table turns (Sense::table), whose errors would need workpiece_axes > 0, and inclined ones.
/// @throws InputError with the name of the axis
void refuse_undocumented_axes(const plant::MachineChain& chain, const plant::ErrorModel& errors,
                              std::string_view format, const Place& at);

/// True if E' = E at all positions.
bool is_as_ours(const plant::ChainAxis& axis);

}  // namespace servomill::sim::tables
