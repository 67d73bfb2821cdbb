#include "sim/tables/skew_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/tables/skew_table.h"
#include "plant/geometry/volumetric.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/model/propagation.h"
#include "sim/model/undetermined_errors.h"
#include "sim/tables/table_comparison.h"
#include "sim/tables/table_uncertainty.h"
#include "sim/tables/unknown_errors.h"

namespace servomill::sim::tables {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kLength = 100.0;  // mm, S of M556

// Location errors of X, Y and Z alone.
plant::ErrorModel locations_of(const plant::ErrorModel& errors) {
  plant::ErrorModel out;
  for (const Axis axis : {Axis::X, Axis::Y, Axis::Z}) {
    for (const Axis direction : kAllAxes) {
      const plant::ErrorName name{direction, axis, true};
      out.location(name) = errors.location(name);
    }
  }
  return out;
}

Joints at(const Joints& reference, const Vector3d& p) {
  Joints Q = reference;
  Q.head<kLinearJoints>() = p;
  return Q;
}

// Directions of motion of the machine, where the axes follow `commanded` (columns; m/m).
template <typename Commanded>
Matrix3d directions(const plant::VolumetricModel& machine, const TableSource& source,
                    const Commanded& commanded) {
  const Vector3d p0 = source.reference.head<kLinearJoints>();
  const auto tip = [&](const Vector3d& p) {
    return machine.forward(at(source.reference, commanded(p)), source.p_ST).p_WT;
  };
  Matrix3d A;
  constexpr double kStep = 0.1;  // m
  for (int i = 0; i < 3; ++i) {
    A.col(i) = (tip(p0 + kStep * Vector3d::Unit(i)) - tip(p0)) / kStep;
  }
  return A;
}

Matrix3d command_matrix(const SkewSettings& s) {
  Matrix3d C = Matrix3d::Identity();
  C(0, 1) = -s.a;
  C(0, 2) = -s.b;
  C(1, 2) = -s.c;
  return C;
}

// Largest displacement of the tip from that of the reference, in the frame R.
Volume volume_of(const TableSource& source, const std::vector<TableLine>& lines,
                 const SkewSettings& s) {
  const plant::VolumetricModel machine(source.chain, source.errors);
  const Matrix3d C = command_matrix(s);
  const Vector3d reference = source.reference.head<kLinearJoints>();
  const auto error = [&](const Vector3d& p, const Matrix3d& command) -> Vector3d {
    const auto tip = machine.forward(at(source.reference, command * p), source.p_ST).p_WT;
    return tip - s.R * plant::forward(source.chain, at(source.reference, p), source.p_ST).p_WT;
  };
  Volume out;
  constexpr int kPlaces = 21;  // of each axis
  for (int n = 0; n < kPlaces * kPlaces * kPlaces; ++n) {
    throw_if_interrupted();
    const Eigen::Array3d share(n % kPlaces, n / kPlaces % kPlaces, n / kPlaces / kPlaces);
    Vector3d p = reference;
    for (const TableLine& line : lines) {
      if (line.joint >= kLinearJoints) continue;
      p[line.joint] = line.from + (line.to - line.from) * share[line.joint] / (kPlaces - 1);
    }
    const Matrix3d I = Matrix3d::Identity();
    out.before = std::max(out.before, (error(p, I) - error(reference, I)).norm());
    out.after = std::max(out.after, (error(p, C) - error(reference, C)).norm());
  }
  return out;
}

double rounded(double value) {
  constexpr double kDigit = 1e-8;
  return std::round(value / kDigit) * kDigit + 0.0;
}

// Errors that are neither squareness nor anything that squareness comes from.
std::vector<std::string> other_errors(const TableExport& e) {
  std::vector<std::string> names;
  for (const TableLine& line : e.lines) {
    const Axis axis = axis_at(e, line.joint);
    for (const bool is_location : {false, true}) {
      for (const Axis direction : kAllAxes) {
        const plant::ErrorName name{direction, axis, is_location};
        if (is_location && is_linear(axis)) continue;
        const bool is_zero = is_location ? e.source.errors.location(name) == 0.0
                                         : e.source.errors.component(name).is_zero();
        if (!is_zero) names.push_back(to_string(name));
      }
    }
  }
  return names;
}

controllers::SkewFirmware firmware_of(TableFormat format) {
  if (format == TableFormat::klipper) return controllers::SkewFirmware::klipper;
  return format == TableFormat::marlin ? controllers::SkewFirmware::marlin
                                       : controllers::SkewFirmware::reprapfirmware;
}

std::string setting_text(const TableExport& e) {
  const SkewSettings& s = *e.skew;
  const double xz = s.b + s.a * s.c;  // x -= y xy + z (xz - xy yz)
  switch (e.request.format) {
    case TableFormat::marlin:
      return fmt::format("M852 I{:.8f} J{:.8f} K{:.8f}\n", s.a, rounded(xz), s.c);
    case TableFormat::klipper:
      return fmt::format(
          "[skew_correction]\n\n[skew_correction {}]\nxy_skew = {:.8f}\nxz_skew = {:.8f}\n"
          "yz_skew = {:.8f}\n",
          e.request.model, s.a, rounded(xz), s.c);
    default:
      return fmt::format("M556 S{:g} X{:.6f} Y{:.6f} Z{:.6f}\n", kLength, -s.a * kLength + 0.0,
                         -s.c * kLength + 0.0, -s.b * kLength + 0.0);
  }
}

// Directions of motion of the machine with these errors alone.
Matrix3d directions_of(const TableSource& source, const plant::ErrorModel& errors) {
  return directions(plant::VolumetricModel(source.chain, errors), source,
                    [](const Vector3d& p) { return p; });
}

// a, b and c of commands that let the machine move at right angles.
Vector3d factors_of(const Matrix3d& A) {
  const Vector3d x = A.col(0), y = A.col(1), z = A.col(2);
  const Vector3d y_right = y - x.dot(y) / x.dot(x) * x;
  const double c = y_right.dot(z) / y_right.dot(y_right);
  return {x.dot(y) / x.dot(x), x.dot(z - c * y) / x.dot(x), c};
}

// Location errors of X, Y and Z less the squarenesses that are left out.
plant::ErrorModel squarenesses_of(const plant::ErrorModel& errors, const SkewSettings& s) {
  plant::ErrorModel out = locations_of(errors);
  for (const SkewSettings::LeftOut& one : s.left_out) {
    for (const plant::ErrorName& name : one.squareness) out.location(name) = 0.0;
  }
  return out;
}

// Leaves out what is not determined.
void take_uncertainty(const TableExport& e, SkewSettings& s) {
  if (!e.request.identified) return;
  const auto factors = [&](const plant::ErrorModel& errors) -> Eigen::VectorXd {
    return factors_of(directions_of(e.source, locations_of(errors)));
  };
  const Eigen::VectorXd values = factors(e.source.errors);
  const Eigen::VectorXd U =
      model::expanded_uncertainty(factors, e.source.errors, *e.request.identified);
  s.uncertainty = U;
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (determination(values.segment(i, 1), U.segment(i, 1)).is_determined()) continue;
    s.left_out.push_back({model::kSquarenesses[static_cast<std::size_t>(i)], values[i], U[i]});
  }
}

std::string text_of(const SkewSettings::LeftOut& one) {
  return fmt::format("{}: {:.3g} um/m with U(k = 2) {:.3g} um/m: not determined by the calibration",
                     to_string(one.squareness[0]), std::abs(one.value) / um, one.uncertainty / um);
}

[[noreturn]] void refuse_nothing(const TableExport& e, const SkewSettings& s) {
  std::string why = "X, Y and Z are at right angles";
  for (const SkewSettings::LeftOut& one : s.left_out) why += "; " + text_of(one);
  throw InputError({}, fmt::format("{} cannot represent any part of this error model: {}; it "
                                   "represents EC0Y, EB0Z, EA0Z and the like",
                                   name_of(e.request.format), why));
}

}  // namespace

std::optional<SkewSettings> skew_settings_of(const TableExport& e, bool is_required) {
  const auto linear = std::count_if(e.lines.begin(), e.lines.end(), [](const TableLine& line) {
    return line.joint < kLinearJoints;
  });
  if (linear != kLinearJoints) {
    throw InputError(
        {}, fmt::format("{} corrects machines with X, Y and Z", name_of(e.request.format)));
  }
  SkewSettings s;
  take_uncertainty(e, s);
  const Matrix3d A = directions_of(e.source, squarenesses_of(e.source.errors, s));
  const Vector3d factors = factors_of(A);
  s.a = rounded(factors[0]);
  s.b = rounded(factors[1]);
  s.c = rounded(factors[2]);
  if (s.a == 0.0 && s.b == 0.0 && s.c == 0.0) {
    if (!is_required) return std::nullopt;
    refuse_nothing(e, s);
  }
  Matrix3d right = A * command_matrix(s);
  for (int i = 0; i < 3; ++i) {
    s.lengths[i] = right.col(i).norm() - 1.0;
    right.col(i).normalize();
  }
  s.R = right;
  s.volume = volume_of(e.source, e.lines, s);
  return s;
}

std::vector<std::string> skew_report(const TableExport& e) {
  const SkewSettings& s = *e.skew;
  std::vector<std::string> out = {
      fmt::format("skew correction of error model '{}' on {}", e.request.model, e.machine),
      fmt::format("document: {}", e.rules().document),
      fmt::format("added to the command: X {:+.3f} um/m of Y, X {:+.3f} um/m of Z, Y {:+.3f} um/m "
                  "of Z",
                  0.0 - s.a / um, 0.0 - s.b / um, 0.0 - s.c / um)};
  if (s.uncertainty) {
    const Vector3d U = *s.uncertainty / um;
    out.push_back(fmt::format("U(k = 2): {:.3g}, {:.3g} and {:.3g} um/m", U[0], U[1], U[2]));
  }
  for (const SkewSettings::LeftOut& one : s.left_out) out.push_back("note: 0 for " + text_of(one));
  const Vector3d turn(0.5 * (s.R(2, 1) - s.R(1, 2)), 0.5 * (s.R(0, 2) - s.R(2, 0)),
                      0.5 * (s.R(1, 0) - s.R(0, 1)));
  if (turn.cwiseAbs().maxCoeff() > e.rules().angle_step) {
    out.push_back(
        fmt::format("note: X keeps its direction; the frame is rotated by A {:.3f}, B "
                    "{:.3f}, C {:.3f} urad, which a rotated work offset corrects",
                    turn.x() / urad, turn.y() / urad, turn.z() / urad));
  }
  constexpr double kSmall = 1e-7;  // m/m
  if (s.lengths.cwiseAbs().maxCoeff() > kSmall) {
    out.push_back(
        fmt::format("note: travels are longer by X {:+.3f}, Y {:+.3f}, Z {:+.3f} um/m, of second "
                    "order, which steps per mm would correct",
                    s.lengths.x() / um, s.lengths.y() / um, s.lengths.z() / um));
  }
  const auto others = other_errors(e);
  out.push_back(others.empty()
                    ? "not in this correction: none"
                    : fmt::format("not in this correction: {}", fmt::join(others, ", ")));
  out.push_back(
      fmt::format("TCP at poses all over the travel of X, Y and Z, relative to the reference: off "
                  "by up to {:.3f} um without this correction, {:.3f} um with",
                  s.volume.before / um, s.volume.after / um));
  return out;
}

std::vector<TextFile> skew_files(const TableExport& e) {
  const bool klipper = e.request.format == TableFormat::klipper;
  std::string text;
  for (const std::string& line : with_unknown(skew_report(e), e)) {
    text += fmt::format("{} {}\n", klipper ? '#' : ';', line);
  }
  const char* name = klipper                                   ? "skew.cfg"
                     : e.request.format == TableFormat::marlin ? "skew.gcode"
                                                               : "skew.g";
  if (klipper) {
    text += fmt::format("# after a restart: SKEW_PROFILE LOAD={}\n", e.request.model);
  } else if (e.request.format == TableFormat::marlin) {
    text += "; requires SKEW_CORRECTION_GCODE and SKEW_CORRECTION_FOR_Z; M500 stores it\n";
  }
  return {{name, text + setting_text(e)}};
}

TableVerification verify_skew(const TableExport& e, const std::vector<TextFile>& files) {
  const controllers::SkewSetting setting = controllers::read_skew_table(
      {files.at(0).name, files.at(0).text}, firmware_of(e.request.format));
  const plant::VolumetricModel machine(e.source.chain, squarenesses_of(e.source.errors, *e.skew));
  const Matrix3d A =
      directions(machine, e.source, [&](const Vector3d& p) { return setting.commanded(p); });
  const Matrix3d G = A.transpose() * A;
  TableVerification out{.right_angles = 3};
  constexpr std::array<std::array<int, 2>, 3> kPairs = {{{0, 1}, {0, 2}, {1, 2}}};
  for (const auto& [i, j] : kPairs) {
    const double off = std::abs(G(i, j));
    out.angle = std::max(out.angle, off);
    if (off <= e.rules().angle_step * (1.0 + kDigitSlack)) continue;
    throw InputError(
        {files.at(0).name, setting.line},
        fmt::format("verification failed: {} and {} move at {:.4f} urad off a right angle",
                    "XYZ"[i], "XYZ"[j], off / urad));
  }
  return out;
}

}  // namespace servomill::sim::tables
