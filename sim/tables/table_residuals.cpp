#include "sim/tables/table_residuals.h"

#include <algorithm>
#include <cmath>

#include "plant/geometry/volumetric.h"
#include "plant/vocabulary/interrupt.h"
#include "sim/tables/grid_tables.h"

namespace servomill::sim::tables {
namespace {

// Places of one axis that are looked at, with the displacements of the tables there.
struct Samples {
  int joint;
  std::vector<double> q;
  std::vector<Joints> d;
};

std::vector<double> spread(const TableLine& line, int count) {
  std::vector<double> q;
  for (int i = 0; i < count; ++i) q.push_back(line.from + (line.to - line.from) * i / (count - 1));
  return q;
}

Joints held(const LineCorrection& correction, const TableLine& line,
            const std::vector<OmittedTable>& omitted, const FormatRules& rules, double q) {
  if (!line.wanted) return Joints::Zero();
  Joints d = correction.over(line.joint, q);
  if (!rules.cross) d = Joints::Unit(line.joint) * d[line.joint];
  for (const OmittedTable& table : omitted) {
    if (table.base == line.joint) d[table.output] = 0.0;
  }
  return d;
}

std::vector<Samples> samples_of(const TableSource& source, const std::vector<TableLine>& lines,
                                const std::vector<OmittedTable>& omitted, const FormatRules& rules,
                                auto count_of) {
  const LineCorrection correction(source);
  std::vector<Samples> out;
  for (const TableLine& line : lines) {
    Samples s{line.joint, spread(line, count_of(line.joint)), {}};
    for (const double q : s.q) s.d.push_back(held(correction, line, omitted, rules, q));
    out.push_back(std::move(s));
  }
  return out;
}

// Calls f(Q, d) at all combinations of the samples from `next` on.
template <class F>
void for_all(const std::vector<Samples>& samples, std::size_t next, Joints& Q, const Joints& d,
             F&& f) {
  if (next == samples.size()) return f(Q, d);
  const Samples& s = samples[next];
  for (std::size_t i = 0; i < s.q.size(); ++i) {
    throw_if_interrupted();
    Q[s.joint] = s.q[i];
    for_all(samples, next + 1, Q, d + s.d[i], f);
  }
}

// Over the travel of its axis, and over that of every axis which its grids name.
double largest_within(const TableSource& source, const std::vector<TableLine>& lines,
                      const plant::ErrorName& name, int own) {
  constexpr int kPlaces = 20001, kPlacesOfGrid = 65;
  const plant::ErrorFunction& error = source.errors.component(name);
  const std::vector<Axis> axes = error.grid_axes();
  std::vector<Samples> samples;
  for (const TableLine& line : lines) {
    const Axis axis = *source.chain.layout.axis[static_cast<std::size_t>(line.joint)];
    const bool is_named = std::find(axes.begin(), axes.end(), axis) != axes.end();
    if (line.joint != own && !is_named) continue;
    Samples s{line.joint, spread(line, axes.empty() ? kPlaces : kPlacesOfGrid), {}};
    s.d.assign(s.q.size(), Joints::Zero());
    samples.push_back(std::move(s));
  }
  double most = 0.0;
  Joints Q = source.reference;
  for_all(samples, 0, Q, Joints::Zero(), [&](const Joints& at, const Joints&) {
    most = std::max(most, std::abs(error.value(at[own], source.chain.layout.words(at))));
  });
  return most;
}

plant::ErrorModel only(const plant::ErrorModel& errors, const plant::ErrorName& name) {
  plant::ErrorModel out;
  if (name.is_location) {
    out.location(name) = errors.location(name);
  } else {
    out.component(name) = errors.component(name);
  }
  return out;
}

// The error alone. Between the ends of the other linear axes what stays is linear, but of axes that
// its grids name.
TableResidual stay_of(TableSource source, const std::vector<TableLine>& lines,
                      const std::vector<OmittedTable>& omitted, const FormatRules& rules,
                      const plant::ErrorName& name, int own) {
  constexpr int kFine = 129, kFineTurn = 33, kEnds = 2, kAngles = 5;
  source.errors = only(source.errors, name);
  std::vector<Axis> axes;
  if (!name.is_location) axes = source.errors.component(name).grid_axes();
  const auto samples = samples_of(source, lines, omitted, rules, [&](int joint) {
    const auto axis = source.chain.layout.axis[static_cast<std::size_t>(joint)];
    const bool is_named = std::find(axes.begin(), axes.end(), axis) != axes.end();
    if (joint != own && is_named) return kFineTurn;
    const bool fine = joint == own && !name.is_location;
    return joint < kLinearJoints ? (fine ? kFine : kEnds) : (fine ? kFineTurn : kAngles);
  });
  const plant::VolumetricModel machine(source.chain, source.errors);
  TableResidual out{.name = name};
  Joints Q = source.reference;
  for_all(samples, 0, Q, LineCorrection(source).base(), [&](const Joints& at, const Joints& d) {
    const ToolPose actual = machine.forward(at + d, source.p_ST);
    const ToolPose nominal = plant::forward(source.chain, at, source.p_ST);
    out.tip = std::max(out.tip, (actual.p_WT - nominal.p_WT).norm());
    out.tool_axis = std::max(out.tool_axis, (actual.k_W - nominal.k_W).norm());
  });
  return out;
}

}  // namespace

std::vector<TableResidual> table_residuals(const TableSource& source,
                                           const std::vector<TableLine>& lines,
                                           const std::vector<OmittedTable>& omitted,
                                           const FormatRules& rules) {
  std::vector<TableResidual> out;
  for (const TableLine& line : lines) {
    const Axis axis = *source.chain.layout.axis[static_cast<std::size_t>(line.joint)];
    for (const bool is_location : {false, true}) {
      for (const Axis direction : kAllAxes) {
        const plant::ErrorName name{direction, axis, is_location};
        const double size = is_location ? std::abs(source.errors.location(name))
                                        : largest_within(source, lines, name, line.joint);
        if (size == 0.0) continue;
        TableResidual one = stay_of(source, lines, omitted, rules, name, line.joint);
        one.size = size;
        if (one.tip > kNothing || one.tool_axis > kNothing) out.push_back(one);
      }
    }
  }
  return out;
}

Volume volume(const TableSource& source, const std::vector<TableLine>& lines,
              const std::vector<CompensationTable>& tables) {
  const plant::VolumetricModel machine(source.chain, source.errors);
  const Joints base = LineCorrection(source).base();
  Volume out;
  const auto look_at = [&](const Joints& Q) {
    Joints d = Joints::Zero();
    for (const CompensationTable& table : tables) {
      const double entry = table.line.entry_of(Q[table.line.joint]);
      d[table.output] -= 0.5 * (table.at(entry, 1) + table.at(entry, -1));
    }
    const Eigen::Vector3d nominal = plant::forward(source.chain, Q, source.p_ST).p_WT;
    const auto error = [&](const Joints& where) {
      return (machine.forward(where, source.p_ST).p_WT - nominal).norm();
    };
    out.before = std::max(out.before, error(Q + base));
    out.after = std::max(out.after, error(Q + base + d));
  };
  for (unsigned corner = 0; corner < (1U << lines.size()); ++corner) {
    Joints Q = source.reference;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      Q[lines[i].joint] = (corner >> i & 1U) != 0U ? lines[i].to : lines[i].from;
    }
    look_at(Q);
  }
  constexpr int kPoses = 20000;
  for (int n = 1; n <= kPoses; ++n) look_at(spread_pose(source, lines, n));
  return out;
}

}  // namespace servomill::sim::tables
