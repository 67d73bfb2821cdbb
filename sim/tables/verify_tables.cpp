#include "sim/tables/verify_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "controllers/tables/csv_table.h"
#include "controllers/tables/heidenhain_table.h"
#include "controllers/tables/linuxcnc_table.h"
#include "controllers/tables/siemens_table.h"
#include "plant/geometry/travelling_errors.h"
#include "plant/geometry/volumetric.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim::tables {
namespace {

using controllers::ControlTable;
using Eigen::Vector3d;

constexpr int kPositions = 1000;
constexpr double kDigitSlack = 1e-6;  // of a digit, for binary fractions

Axis axis_at(const TableExport& e, int joint) {
  return *e.source.chain.layout.axis[static_cast<std::size_t>(joint)];
}

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

std::vector<controllers::TableText> texts_of(const std::vector<TextFile>& files) {
  std::vector<controllers::TableText> out;
  for (const TextFile& file : files) out.push_back({file.name, file.text});
  return out;
}

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

std::string size_of(bool is_angle, double value) {
  return is_angle ? fmt::format("{:.4f} urad", value / urad) : fmt::format("{:.4f} um", value / um);
}

// One quantity over the position of one axis: as read, and as needed.
struct Comparison {
  std::string file, title;
  bool is_angle = false;
  double digit = 0.0;
  std::function<double(double, int)> read, needed;  // position, direction of travel
  std::function<int(double)> line_at;
};

class Verification {
 public:
  explicit Verification(const TableExport& e) : e_(e) {}

  void check(const TableLine& line, const Comparison& c) {
    for (const int direction : {1, -1}) {
      const auto chord = chords(line, c, direction);
      for (int n = 0; n < kPositions; ++n) {
        throw_if_interrupted();
        const double q = line.from + (line.to - line.from) * n / (kPositions - 1);
        const double read = c.read(q, direction);
        const double wanted = chord(line.entry_of(q));
        if (!(std::abs(read - wanted) <= c.digit * (1.0 + kDigitSlack))) {
          fail(line, c, q, direction, read, wanted);
        }
        double& largest = c.is_angle ? result_.angle : result_.length;
        largest = std::max(largest, std::abs(read - c.needed(q, direction)));
        ++result_.positions;
      }
    }
  }

  // The points of a file are those that were asked for.
  void check_points(const TableLine& line, const std::string& file,
                    const std::vector<controllers::TablePoint>& points) const {
    const double unit = line.joint < kLinearJoints ? mm : deg;
    const char* name = line.joint < kLinearJoints ? "mm" : "deg";
    if (points.size() != line.points) {
      throw InputError({file}, fmt::format("not as verified: {} points; {} are needed",
                                           points.size(), line.points));
    }
    // last digit of positions: mm, deg
    const double digit = e_.request.format == TableFormat::heidenhain ? 1e-4 : 1e-6;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (std::abs(points[i].position - line.entry(i)) <= 0.501 * digit * unit) continue;
      throw InputError(
          {file, points[i].line},
          fmt::format("not as verified: position {:.6f} {}; point {} must be at {:.6f}",
                      points[i].position / unit, name, i, line.entry(i) / unit));
    }
  }

  TableVerification result() const { return result_; }

 private:
  // Linear interpolation between exact values at the requested points.
  std::function<double(double)> chords(const TableLine& line, const Comparison& c,
                                       int direction) const {
    std::vector<double> values;
    for (std::size_t i = 0; i < line.points; ++i) {
      values.push_back(c.needed(line.position(line.entry(i)), direction));
    }
    return [values, &line](double entry) {
      const double last = static_cast<double>(values.size() - 1);
      const double u = std::clamp((entry - line.first) / line.spacing, 0.0, last);
      const auto i = std::min(static_cast<std::size_t>(u), values.size() - 2);
      const double share = u - static_cast<double>(i);
      return (1.0 - share) * values[i] + share * values[i + 1];
    };
  }

  [[noreturn]] void fail(const TableLine& line, const Comparison& c, double q, int direction,
                         double read, double wanted) const {
    const bool is_linear_base = line.joint < kLinearJoints;
    throw InputError(
        {c.file, c.line_at(q)},
        fmt::format(
            "not as verified: {} at {}{:.6g} {}, travelling {}: the file gives {}, the error "
            "model {}",
            c.title, e_.letter(line.joint), q / (is_linear_base ? mm : deg),
            is_linear_base ? "mm" : "deg", direction > 0 ? "up" : "down", size_of(c.is_angle, read),
            size_of(c.is_angle, wanted)));
  }

  const TableExport& e_;
  TableVerification result_;
};

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
                         fmt::format("not as verified: a table {} over {} is not needed",
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
      if (table.base == line.joint && table.output == output) omitted = table.largest;
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
  Verification check_;
  std::string folder_;
  Joints base_ = Joints::Zero();
};

// The errors themselves, by their names.
class Columns {
 public:
  Columns(const TableExport& e, const std::vector<TextFile>& files)
      : e_(e), columns_(controllers::read_csv_tables(texts_of(files))), check_(e) {}

  TableVerification run() {
    for (const TableLine& line : e_.lines) {
      const Axis axis = axis_at(e_, line.joint);
      for (const Axis direction : kAllAxes) {
        if (line.wanted) check_component(line, {direction, axis, false});
        check_location({direction, axis, true});
      }
    }
    return check_.result();
  }

 private:
  // The column that holds an error in one direction of travel; empty points: there is none.
  ControlTable column(const TableLine& line, const plant::ErrorName& name, int direction) const {
    ControlTable out;
    for (const controllers::ErrorColumn& one : columns_.components) {
      const bool is_it = one.name == to_string(name) && one.base_axis == name.axis &&
                         one.direction * direction >= 0;
      if (!is_it) continue;
      check_.check_points(line, one.file, one.points);
      out.file = one.file;
      out.points = one.points;
    }
    return out;
  }

  void check_component(const TableLine& line, const plant::ErrorName& name) {
    const plant::ErrorFunction& error = e_.source.errors.component(name);
    const std::array<ControlTable, 2> tables = {column(line, name, -1), column(line, name, 1)};
    if (tables[0].points.empty() && tables[1].points.empty() && error.is_zero()) return;
    Comparison c;
    c.file = tables[1].file;
    c.title = to_string(name);
    c.is_angle = !is_linear(name.direction);
    c.digit = c.is_angle ? e_.rules().angle_step : e_.rules().length_step;
    c.needed = [&](double q, int direction) {
      return plant::travelling(error, direction).value(q);
    };
    c.read = [&](double q, int direction) {
      const ControlTable& table = tables[direction > 0 ? 1 : 0];
      return table.points.empty() ? 0.0 : table.at(line.entry_of(q), direction);
    };
    c.line_at = [&](double q) {
      return tables[1].points.empty() ? 0 : tables[1].point_below(line.entry_of(q)).line;
    };
    check_.check(line, c);
  }

  void check_location(const plant::ErrorName& name) const {
    const double wanted = e_.source.errors.location(name);
    const auto found = columns_.locations.find(to_string(name));
    const bool is_there = found != columns_.locations.end();
    const double read = is_there ? found->second.value : 0.0;
    const bool is_angle = !is_linear(name.direction);
    const double digit = is_angle ? e_.rules().angle_step : e_.rules().length_step;
    if (std::abs(read - wanted) <= digit * (1.0 + kDigitSlack)) return;
    throw InputError(
        {"locations.csv", is_there ? found->second.line : 0},
        fmt::format("not as verified: {}: the file gives {}, the error model {}", to_string(name),
                    size_of(is_angle, read), size_of(is_angle, wanted)));
  }

  const TableExport& e_;
  controllers::ErrorColumns columns_;
  Verification check_;
};

}  // namespace

TableVerification verify_tables(const TableExport& e, const std::vector<TextFile>& files) {
  return e.request.format == TableFormat::csv ? Columns(e, files).run()
                                              : Displacements(e, files).run();
}

std::string to_string(const TableVerification& v) {
  std::string text =
      fmt::format("verified: {} positions, largest difference to the error model {:.4f} um",
                  v.positions, v.length / um);
  if (v.angle > 0.0) text += fmt::format(", {:.4f} urad", v.angle / urad);
  return text;
}

}  // namespace servomill::sim::tables
