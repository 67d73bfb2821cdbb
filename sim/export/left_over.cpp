#include "sim/export/left_over.h"

#include <algorithm>
#include <cmath>

#include "plant/geometry/volumetric.h"

namespace servomill::sim {
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

Joints held(const LineCorrection& correction, const TableLine& line, const FormatRules& rules,
            double q) {
  if (!line.wanted) return Joints::Zero();
  Joints d = correction.over(line.joint, q);
  if (!rules.cross) d = Joints::Unit(line.joint) * d[line.joint];
  return d;
}

std::vector<Samples> samples_of(const std::vector<TableLine>& lines, auto count_of, auto held_at) {
  std::vector<Samples> out;
  for (const TableLine& line : lines) {
    Samples s{line.joint, spread(line, count_of(line.joint)), {}};
    for (const double q : s.q) s.d.push_back(held_at(line, q));
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
    Q[s.joint] = s.q[i];
    for_all(samples, next + 1, Q, d + s.d[i], f);
  }
}

double largest_within(const plant::ErrorFunction& error, const TableLine& line) {
  constexpr int kPlaces = 20001;
  double most = 0.0;
  for (const double q : spread(line, kPlaces)) most = std::max(most, std::abs(error.value(q)));
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

// The error alone. Between the ends of the other linear axes what stays is linear.
LeftOver stay_of(TableSource source, const std::vector<TableLine>& lines, const FormatRules& rules,
                 const plant::ErrorName& name, int own) {
  constexpr int kFine = 129, kFineTurn = 33, kEnds = 2, kAngles = 5;
  source.errors = only(source.errors, name);
  const LineCorrection correction(source);
  const auto samples = samples_of(
      lines,
      [&](int joint) {
        const bool fine = joint == own && !name.is_location;
        return joint < kLinearJoints ? (fine ? kFine : kEnds) : (fine ? kFineTurn : kAngles);
      },
      [&](const TableLine& line, double q) { return held(correction, line, rules, q); });
  const plant::VolumetricModel machine(source.chain, source.errors);
  LeftOver out{.name = name};
  Joints Q = source.reference;
  for_all(samples, 0, Q, Joints::Zero(), [&](const Joints& at, const Joints& d) {
    const ToolPose actual = machine.forward(at + d, source.p_ST);
    const ToolPose nominal = plant::forward(source.chain, at, source.p_ST);
    out.tip = std::max(out.tip, (actual.p_WT - nominal.p_WT).norm());
    out.tool_axis = std::max(out.tool_axis, (actual.k_W - nominal.k_W).norm());
  });
  return out;
}

}  // namespace

std::vector<LeftOver> left_over(const TableSource& source, const std::vector<TableLine>& lines,
                                const FormatRules& rules) {
  std::vector<LeftOver> out;
  for (const TableLine& line : lines) {
    const Axis axis = *source.chain.layout.axis[static_cast<std::size_t>(line.joint)];
    for (const bool is_location : {false, true}) {
      for (const Axis direction : kAllAxes) {
        const plant::ErrorName name{direction, axis, is_location};
        const double size = is_location ? std::abs(source.errors.location(name))
                                        : largest_within(source.errors.component(name), line);
        if (size == 0.0) continue;
        LeftOver one = stay_of(source, lines, rules, name, line.joint);
        one.size = size;
        if (one.tip > kNothing || one.tool_axis > kNothing) out.push_back(one);
      }
    }
  }
  return out;
}

Volume volume(const TableSource& source, const std::vector<TableLine>& lines,
              const std::vector<CompensationTable>& tables) {
  constexpr int kLinear = 14, kAngles = 6;  // 13 and 5 intervals: seldom at points of a table
  const auto samples = samples_of(
      lines, [](int joint) { return joint < kLinearJoints ? kLinear : kAngles; },
      [&](const TableLine& line, double q) -> Joints {
        Joints d = Joints::Zero();
        for (const CompensationTable& table : tables) {
          if (table.line.joint == line.joint) d[table.output] -= table.at(line.entry_of(q));
        }
        return d;
      });
  const plant::VolumetricModel machine(source.chain, source.errors);
  Volume out;
  Joints Q = source.reference;
  for_all(samples, 0, Q, Joints::Zero(), [&](const Joints& at, const Joints& d) {
    const Eigen::Vector3d nominal = plant::forward(source.chain, at, source.p_ST).p_WT;
    const auto error = [&](const Joints& where) {
      return (machine.forward(where, source.p_ST).p_WT - nominal).norm();
    };
    out.before = std::max(out.before, error(at));
    out.after = std::max(out.after, error(at + d));
  });
  return out;
}

}  // namespace servomill::sim
