#include "sim/tables/tool_side_errors.h"

#include <fmt/format.h>

#include "plant/geometry/rotation_vector.h"

namespace servomill::sim::tables {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// v in the body that the axis moves, or back from it.
Vector3d turned_by(const plant::ChainAxis& axis, double q, const Vector3d& v) {
  if (is_linear(axis.axis)) return v;
  return plant::turned(axis, plant::motion_at(axis, q), v);
}

// Errors about the point c as errors about the origin: Trans(c) E Trans(-c).
ComponentErrors about_origin(const ComponentErrors& e, const Vector3d& c) {
  return {e.shift + c - plant::TurnOf(e.turn) * c, e.turn};
}

ComponentErrors about_point(const ComponentErrors& e, const Vector3d& c) {
  return about_origin(e, -c);
}

// Trans(d) E Trans(-d) for the travel d of a linear axis; Rot E Rot^-1 for a rotary one, all about
// its centre.
ComponentErrors moved(const plant::ChainAxis& axis, const ComponentErrors& e, double q) {
  if (is_linear(axis.axis)) {
    Vector3d travel = Vector3d::Zero();
    travel[index_of(axis.axis)] = q;
    return about_origin(e, travel);
  }
  return {turned_by(axis, q, e.shift), turned_by(axis, q, e.turn)};
}

}  // namespace

double& part_of(ComponentErrors& errors, Axis direction) {
  return is_linear(direction) ? errors.shift[index_of(direction)]
                              : errors.turn[index_of(direction) - index_of(Axis::A)];
}

ComponentErrors tool_side(const plant::ChainAxis& axis, const ComponentErrors& ours, double q) {
  const ComponentErrors e = is_linear(axis.axis) ? about_origin(ours, axis.centre) : ours;
  return axis.side == plant::Side::tool ? e : moved(axis, e, -q);
}

ComponentErrors from_tool_side(const plant::ChainAxis& axis, const ComponentErrors& theirs,
                               double q) {
  const ComponentErrors e = axis.side == plant::Side::tool ? theirs : moved(axis, theirs, q);
  return is_linear(axis.axis) ? about_point(e, axis.centre) : e;
}

void refuse_undocumented_axes(const plant::MachineChain& chain, const plant::ErrorModel& errors,
                              std::string_view format, const Place& at) {
  for (const plant::ChainAxis& axis : chain.axes) {
    bool has_error = false;
    for (const Axis direction : kAllAxes) {
      has_error = has_error || errors.location({direction, axis.axis, true}) != 0.0 ||
                  !errors.component({direction, axis.axis, false}).is_zero();
    }
    if (!has_error) continue;
    const bool is_table = axis.sense == plant::Sense::table;
    if (!is_table && !axis.is_inclined) continue;
    throw InputError(at,
                     fmt::format("{} cannot represent errors of the {} axis {}: {}", format,
                                 is_table ? "rotary" : "inclined", letter(axis.axis),
                                 is_table ? "its direction is that of the table rotation, and the "
                                            "signs of the errors of workpiece_axes are undocumented"
                                          : "no document found defines the frame of its errors"));
  }
}

bool is_as_ours(const plant::ChainAxis& axis) {
  const bool own_centre = !is_linear(axis.axis) || axis.centre.isZero(0.0);
  return axis.side == plant::Side::tool && own_centre;
}

}  // namespace servomill::sim::tables
