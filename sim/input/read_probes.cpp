#include "sim/input/read_probes.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "plant/vocabulary/units.h"
#include "sim/input/read_vector.h"

namespace servomill::sim::input {
namespace {

using Eigen::Vector3d;

constexpr std::array<std::string_view, 6> kKinds = {"line",     "plane", "circle",
                                                    "cylinder", "notch", "points_mm"};
constexpr double kMaxPoints = 1e6;
constexpr double kMaxRepetitions = 1e4;
constexpr double kMaxSeed = 9007199254740992.0;  // 2^53: whole numbers are exact up to there
constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kAcross = 1e-6;  // cosine of what still counts as a right angle

// A direction of any length but 0.
Vector3d read_direction(config::Reader& table, std::string_view key) {
  const std::size_t before = table.faults();
  const Vector3d v = read_vector(table, key, config::kNumber);
  if (table.faults() > before) return Vector3d::UnitZ();
  if (v.norm() > 0.0) return v.normalized();
  table.fault(key, "must not be zero");
  return Vector3d::UnitZ();
}

int read_points(config::Reader& table, int least) {
  return static_cast<int>(
      table.integer("points", {config::at_least(least), config::at_most(kMaxPoints)}));
}

// [along, across] with at least `least` each.
std::array<int, 2> read_grid(config::Reader& table, std::array<int, 2> least) {
  const std::size_t before = table.faults();
  const std::vector<double> n = table.reals("points", config::kNumber);
  const auto is_whole = [](double x) { return x == std::floor(x); };
  if (table.faults() > before) return least;
  if (n.size() == 2 && is_whole(n[0]) && is_whole(n[1]) && n[0] >= least[0] && n[1] >= least[1] &&
      n[0] * n[1] <= kMaxPoints) {
    return {static_cast<int>(n[0]), static_cast<int>(n[1])};
  }
  table.fault(
      "points",
      fmt::format("must be two integers, at least [{}, {}], and at most {:g} points in total",
                  least[0], least[1], kMaxPoints));
  return least;
}

bool is_across(const Vector3d& normal, const Vector3d& along) {
  return std::abs(normal.dot(along)) <= kAcross * along.norm();
}

std::optional<metrology::Feature> read_line(config::Reader& table) {
  const std::size_t before = table.faults();
  const Vector3d from = read_vector(table, "from_mm", config::kLength);
  const Vector3d to = read_vector(table, "to_mm", config::kLength);
  const Vector3d normal = read_direction(table, "normal");
  const int points = read_points(table, 2);
  if (table.faults() > before) return std::nullopt;
  if (from == to) {
    table.fault("to_mm", "must differ from from_mm");
  } else if (!is_across(normal, to - from)) {
    table.fault("normal", "must be at right angles to the line");
  }
  if (table.faults() > before) return std::nullopt;
  return metrology::line_feature(from, to, normal, points);
}

std::optional<metrology::Feature> read_plane(config::Reader& table) {
  const std::size_t before = table.faults();
  const Vector3d corner = read_vector(table, "corner_mm", config::kLength);
  const Vector3d u = read_vector(table, "u_mm", config::kLength);
  const Vector3d v = read_vector(table, "v_mm", config::kLength);
  const Vector3d normal = read_direction(table, "normal");
  const auto points = read_grid(table, {2, 2});
  if (table.faults() > before) return std::nullopt;
  if (!(u.cross(v).norm() > kAcross * u.norm() * v.norm())) {
    table.fault("v_mm", "must not be parallel to u_mm; both must be non-zero");
  } else if (!is_across(normal, u) || !is_across(normal, v)) {
    table.fault("normal", "must be at right angles to u_mm and v_mm");
  }
  if (table.faults() > before) return std::nullopt;
  return metrology::plane_feature(corner, u, v, normal, points[0], points[1]);
}

struct Round {
  Vector3d centre;
  double radius;
  bool outside;
  metrology::ArcOfPoints arc;
};

Round read_round(config::Reader& table) {
  Round out;
  out.centre = read_vector(table, "centre_mm", config::kLength);
  out.radius = table.real("radius_mm", config::kLength, {config::above(0.0)});
  out.outside = table.boolean("outside");
  out.arc.from = table.real_or("from_deg", 0.0, config::kAngle);
  out.arc.to = table.real_or("to_deg", out.arc.from + kTurn, config::kAngle);
  const double sweep = out.arc.to - out.arc.from;
  if (table.has("to_deg") && !(sweep > 0.0 && sweep <= kTurn * (1.0 + 1e-12))) {
    table.fault("to_deg", "must exceed from_deg, by at most 360");
  }
  return out;
}

std::optional<metrology::Feature> read_circle(config::Reader& table) {
  const std::size_t before = table.faults();
  Round round = read_round(table);
  round.arc.points = read_points(table, 3);
  if (table.faults() > before) return std::nullopt;
  return metrology::circle_feature(round.centre, round.radius, round.outside, round.arc);
}

std::optional<metrology::Feature> read_cylinder(config::Reader& table) {
  const std::size_t before = table.faults();
  Round round = read_round(table);
  const double to_z = table.real("to_mm", config::kLength);
  const auto points = read_grid(table, {3, 2});
  round.arc.points = points[0];
  if (table.faults() > before) return std::nullopt;
  if (to_z == round.centre.z()) {
    table.fault("to_mm", "is the Z of the other end and must differ from that of centre_mm");
    return std::nullopt;
  }
  return metrology::cylinder_feature(round.centre, round.radius, round.outside, round.arc, to_z,
                                     points[1]);
}

std::optional<metrology::Feature> read_notch(config::Reader& table) {
  const std::size_t before = table.faults();
  const Vector3d from = read_vector(table, "from_mm", config::kLength);
  const Vector3d to = read_vector(table, "to_mm", config::kLength);
  const double width = table.real("width_mm", config::kLength, {config::above(0.0)});
  const int points = read_points(table, 1);
  if (table.faults() > before) return std::nullopt;
  if (from == to) {
    table.fault("to_mm", "must differ from from_mm");
  } else if (from.z() != to.z()) {
    table.fault("to_mm", "must be at the height of from_mm");
  }
  if (table.faults() > before) return std::nullopt;
  return metrology::notch_feature(from, to, width, points);
}

std::optional<double> number(const config::Value& value) {
  if (value.type == config::Value::Type::integer) return static_cast<double>(value.integer);
  if (value.type == config::Value::Type::real && std::isfinite(value.real)) return value.real;
  return std::nullopt;
}

std::optional<plant::ProbeTarget> target(const config::Value& item) {
  std::array<double, 6> x{};
  if (item.type != config::Value::Type::list || item.children.size() != x.size())
    return std::nullopt;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto found = number(item.children[i]);
    if (!found) return std::nullopt;
    x[i] = *found;
  }
  const Vector3d normal(x[3], x[4], x[5]);
  if (!(normal.norm() > 0.0)) return std::nullopt;
  return plant::ProbeTarget{Vector3d(x[0], x[1], x[2]) * mm, normal.normalized()};
}

std::optional<metrology::Feature> read_explicit(config::Reader& probe) {
  constexpr const char* kKey = "points_mm";
  const config::Value* list = probe.raw(kKey);
  if (list->type != config::Value::Type::list || list->children.empty()) {
    probe.fault(kKey, "must be a list of [x, y, z, nx, ny, nz]");
    return std::nullopt;
  }
  metrology::Feature out;
  for (const config::Value& item : list->children) {
    const auto found = target(item);
    if (!found) {
      probe.fault(
          kKey, fmt::format("has the item {}; must be [x, y, z, nx, ny, nz] with a non-zero normal",
                            config::inline_toml(item)));
      return std::nullopt;
    }
    out.targets.push_back(*found);
  }
  return out;
}

std::optional<metrology::Feature> read_kind(config::Reader& probe, std::string_view kind) {
  if (kind == "points_mm") return read_explicit(probe);
  config::Reader table = probe.table(kind);
  if (kind == "line") return read_line(table);
  if (kind == "plane") return read_plane(table);
  if (kind == "circle") return read_circle(table);
  if (kind == "cylinder") return read_cylinder(table);
  return read_notch(table);
}

// The one kind that a probe names.
std::optional<std::string_view> kind_of(config::Reader& probe) {
  std::optional<std::string_view> found;
  for (const std::string_view kind : kKinds) {
    if (!probe.has(kind)) continue;
    if (found) {
      probe.fault(fmt::format("has {} and {}; must have exactly one of {}", *found, kind,
                              fmt::join(kKinds, ", ")));
      probe.skip_rest();
      return std::nullopt;
    }
    found = kind;
  }
  if (!found) {
    probe.fault(fmt::format("has no geometry; must have one of {}", fmt::join(kKinds, ", ")));
    probe.skip_rest();
  }
  return found;
}

// The name becomes a group of the result file.
void check_name(config::Reader& probe, const std::string& name,
                const std::vector<metrology::ProbeSpec>& earlier) {
  if (name.empty() || name == "." || name == "..") {
    probe.fault("name", "must not be empty");
  } else if (name.find('/') != std::string::npos) {
    probe.fault("name", "must not contain '/'");
  } else if (std::any_of(earlier.begin(), earlier.end(),
                         [&](const metrology::ProbeSpec& one) { return one.name == name; })) {
    probe.fault("name", "is already used by an earlier probe");
  }
}

}  // namespace

metrology::Cmm read_cmm(config::Reader& root) {
  config::Reader table = root.table_or_empty("cmm");
  metrology::Cmm cmm;
  cmm.uncertainty =
      table.real_or("uncertainty_um", cmm.uncertainty, config::kLength, {config::at_least(0.0)});
  cmm.probe_radius =
      table.real_or("probe_radius_mm", cmm.probe_radius, config::kLength, {config::at_least(0.0)});
  cmm.repetitions = static_cast<int>(table.integer_or(
      "repetitions", cmm.repetitions, {config::at_least(1), config::at_most(kMaxRepetitions)}));
  cmm.seed = static_cast<std::uint64_t>(
      table.integer_or("seed", 1, {config::at_least(0), config::at_most(kMaxSeed)}));
  cmm.clearance =
      table.real_or("approach_mm", cmm.clearance, config::kLength, {config::above(0.0)});
  cmm.depth = table.real_or("search_mm", cmm.depth, config::kLength, {config::above(0.0)});
  cmm.tooth_marks = table.boolean_or("tooth_marks", false);
  if (cmm.tooth_marks && cmm.probe_radius > 0.0) {
    table.fault("tooth_marks",
                "requires a point stylus: a ball would bridge them (probe_radius_mm = 0)");
  }
  return cmm;
}

std::vector<metrology::ProbeSpec> read_probes(config::Reader& root, bool has_cutter) {
  std::vector<metrology::ProbeSpec> out;
  for (config::Reader& probe : root.tables_or_none("probe")) {
    metrology::ProbeSpec spec;
    spec.place = probe.place("name");
    const std::size_t before = probe.faults();
    spec.name = probe.text("name");
    if (probe.faults() == before) check_name(probe, spec.name, out);
    if (const auto kind = kind_of(probe)) {
      if (auto feature = read_kind(probe, *kind)) spec.feature = std::move(*feature);
    }
    if (!has_cutter && out.empty()) {
      probe.fault(
          "cannot be probed: nothing is cut, because no [[program.tool]] has a diameter_mm");
    }
    out.push_back(std::move(spec));
  }
  return out;
}

}  // namespace servomill::sim::input
