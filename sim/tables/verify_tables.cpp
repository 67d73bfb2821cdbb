#include "sim/tables/verify_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "controllers/tables/heidenhain_table.h"
#include "controllers/tables/linuxcnc_table.h"
#include "controllers/tables/siemens_table.h"
#include "plant/geometry/travelling_errors.h"
#include "plant/geometry/volumetric.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "sim/tables/mesh_settings.h"
#include "sim/tables/skew_settings.h"
#include "sim/tables/table_comparison.h"

namespace servomill::sim::tables {
namespace {

using controllers::ControlTable;
using Eigen::Vector3d;

// Displacement that one machine with errors needs, from its kinematics alone.
class Needed {
 public:
  Needed(const TableExport& e, plant::ErrorModel errors) : e_(e), errors_(std::move(errors)) {
    plant::ErrorModel linear = errors_;
    for (const Axis a : kAllAxes) {
      if (!is_linear(a)) linear.component({a, a, false}) = {};
    }
    model_ = std::make_unique<plant::VolumetricModel>(e.source.chain, linear);
  }

  // Displacement of X, Y and Z that brings the tip of the machine with errors to the ideal one.
  Vector3d linear(const Joints& Q) const {
    const Vector3d p_ideal = plant::forward(e_.source.chain, Q, e_.source.p_ST).p_WT;
    const Eigen::Matrix3d J = plant::linear_jacobian(e_.source.chain, Q);
    Joints at = Q;
    constexpr int kSteps = 8;  // each divides what is left by the size of the errors
    for (int n = 0; n < kSteps; ++n) {
      const Vector3d off = model_->forward(at, e_.source.p_ST).p_WT - p_ideal;
      at.head<kLinearJoints>() -= plant::least_squares(J, off).x;
    }
    return (at - Q).head<kLinearJoints>();
  }

  // Displacement of a rotary axis that brings a point off it to its ideal position.
  double rotary(int joint, double q) const {
    const Axis axis = axis_at(e_, joint);
    plant::ErrorModel own;
    own.component({axis, axis, false}) = errors_.component({axis, axis, false});
    const plant::VolumetricModel model(e_.source.chain, own);
    const Vector3d p_ST(0.3, 0.5, 0.7);  // m, off every axis
    Joints Q = e_.source.reference;
    Q[joint] = q;
    const Vector3d p_ideal = plant::forward(e_.source.chain, Q, p_ST).p_WT;
    const Vector3d J = plant::jacobian(e_.source.chain, Q, p_ST).J_pQ.col(joint);
    constexpr int kSteps = 20;
    for (int n = 0; n < kSteps; ++n) {
      Q[joint] -= J.dot(model.forward(Q, p_ST).p_WT - p_ideal) / J.squaredNorm();
    }
    return Q[joint] - q;
  }

  Joints over(int joint, double q) const {
    Joints Q = e_.source.reference, d = Joints::Zero();
    Q[joint] = q;
    if (joint < kLinearJoints) {
      d.head<kLinearJoints>() = linear(Q);
    } else {
      d[joint] = rotary(joint, q);
    }
    return d;
  }

 private:
  const TableExport& e_;
  plant::ErrorModel errors_;
  std::unique_ptr<plant::VolumetricModel> model_;
};

std::vector<ControlTable> read(const TableExport& e, const std::vector<TextFile>& files) {
  const auto texts = texts_of(files);
  std::vector<Axis> joints;
  for (const TableLine& line : e.lines) joints.push_back(axis_at(e, line.joint));
  switch (e.request.format) {
    case TableFormat::linuxcnc:
      return controllers::read_linuxcnc_tables(texts, joints);
    case TableFormat::heidenhain:
      return controllers::read_heidenhain_tables(texts);
    default:
      return controllers::read_siemens_tables(
          texts, e.request.most_points.value_or(e.rules().most_points));
  }
}

const TableLine* line_of(const TableExport& e, Axis axis) {
  for (const TableLine& line : e.lines) {
    if (axis_at(e, line.joint) == axis) return &line;
  }
  return nullptr;
}

// Displacements over all wanted axes, of the axes that the format can displace.
class Displacements {
 public:
  Displacements(const TableExport& e, const std::vector<TextFile>& files)
      : e_(e), tables_(read(e, files)), check_(e), folder_(files.empty() ? "" : files[0].name) {
    const Needed mean(e, e.source.errors);
    base_.head<kLinearJoints>() = mean.linear(e.source.reference);
    for (int j = kLinearJoints; j < kJoints; ++j) {
      if (e.source.chain.layout.has(j)) base_[j] = mean.rotary(j, e.source.reference[j]);
    }
  }

  TableVerification run() {
    for (const ControlTable& table : tables_) {
      const TableLine* line = line_of(e_, table.base_axis);
      if (line == nullptr || !line->wanted ||
          !e_.source.chain.layout.joint_of(table.compensated_axis)) {
        throw InputError({table.file, table.points.front().line},
                         fmt::format("verification failed: a table {} over {} is unexpected",
                                     letter(table.compensated_axis), letter(table.base_axis)));
      }
      check_.check_points(*line, table.file, table.points);
    }
    for (const TableLine& line : e_.lines) {
      if (line.wanted) run(line);
    }
    return check_.result();
  }

 private:
  void run(const TableLine& line) {
    const Axis base = axis_at(e_, line.joint);
    const std::array<Needed, 3> needed = {Needed(e_, plant::travelling(e_.source.errors, base, -1)),
                                          Needed(e_, e_.source.errors),
                                          Needed(e_, plant::travelling(e_.source.errors, base, 1))};
    for (int output = 0; output < kJoints; ++output) {
      if (!e_.source.chain.layout.has(output)) continue;
      const bool own = output == line.joint;
      const bool both_linear = line.joint < kLinearJoints && output < kLinearJoints;
      if (!own && !(e_.rules().cross && both_linear)) continue;
      const bool directed = own || e_.rules().direction == DirectionRule::all;
      const auto value = [&](double q, int direction) {
        const Needed& of = needed[directed ? static_cast<std::size_t>(direction + 1) : 1U];
        return of.over(line.joint, q)[output] - base_[output];
      };
      compare(line, output, value);
    }
  }

  void compare(const TableLine& line, int output, const std::function<double(double, int)>& value) {
    const Axis base = axis_at(e_, line.joint), compensated = axis_at(e_, output);
    std::vector<const ControlTable*> tables;
    for (const ControlTable& table : tables_) {
      if (table.base_axis == base && table.compensated_axis == compensated)
        tables.push_back(&table);
    }
    double omitted = 0.0;
    for (const OmittedTable& table : e_.omitted) {
      if (table.base != line.joint || table.output != output) continue;
      if (!tables.empty()) {
        throw InputError({tables.front()->file, tables.front()->points.front().line},
                         fmt::format("verification failed: a table {} over {} is unexpected",
                                     letter(compensated), letter(base)));
      }
      if (table.uncertainty) return;
      omitted = table.largest;
    }
    Comparison c;
    c.file = tables.empty() ? folder_ : tables.front()->file;
    c.title = fmt::format("{} over {}", letter(compensated), letter(base));
    c.is_angle = output >= kLinearJoints;
    c.digit = (c.is_angle ? e_.rules().angle_step : e_.rules().length_step) + omitted;
    c.needed = value;
    c.read = [tables](double q, int direction) {
      double sum = 0.0;
      for (const ControlTable* table : tables) sum += table->at(q, direction);
      return sum;
    };
    c.line_at = [tables](double q) {
      return tables.empty() ? 0 : tables.front()->point_below(q).line;
    };
    check_.check(line, c);
  }

  const TableExport& e_;
  std::vector<ControlTable> tables_;
  TableComparison check_;
  std::string folder_;
  Joints base_ = Joints::Zero();
};

}  // namespace

TableVerification verify_tables(const TableExport& e, const std::vector<TextFile>& files) {
  if (e.rules().skew) {
    TableVerification out;
    if (e.skew) out = verify_skew(e, files);
    if (e.mesh) verify_mesh(e, files, out);
    return out;
  }
  return e.rules().components ? verify_columns(e, files) : Displacements(e, files).run();
}

std::string to_string(const TableVerification& v) {
  if (v.right_angles > 0) {
    const std::string mesh =
        fmt::format("; Z at {} points of the mesh within {:.4f} um", v.positions, v.length / um);
    return fmt::format("verified: {} right angles, largest deviation {:.4f} urad{}", v.right_angles,
                       v.angle / urad, v.positions > 0 ? mesh : "");
  }
  std::string text =
      fmt::format("verified: {} positions, largest difference to the error model {:.4f} um",
                  v.positions, v.length / um);
  if (v.angle > 0.0) text += fmt::format(", {:.4f} urad", v.angle / urad);
  return text;
}

}  // namespace servomill::sim::tables
