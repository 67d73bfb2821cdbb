#include "sim/tables/mesh_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/tables/mesh_table.h"
#include "plant/geometry/volumetric.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/model/propagation.h"
#include "sim/tables/table_uncertainty.h"
#include "sim/tables/unknown_errors.h"

namespace servomill::sim::tables {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kDigit = 1e-6;  // m, of a height
constexpr int kPlaces = 41;      // along each axis, where the mesh is compared

// Z of the tip beside the plane, in the frame of the corrected machine.
class Heights {
 public:
  Heights(const TableSource& source, const std::optional<SkewSettings>& skew)
      : source_(source), machine_(source.chain, source.errors) {
    if (!skew) return;
    R_ = skew->R;
    C_(0, 1) = -skew->a;
    C_(0, 2) = -skew->b;
    C_(1, 2) = -skew->c;
  }

  double at(double x, double y, double added) const {
    return deviation({x, y, source_.reference[2]}, added) -
           deviation(source_.reference.head<kLinearJoints>(), 0.0);
  }

 private:
  double deviation(const Vector3d& p, double added) const {
    Joints Q = source_.reference, nominal = source_.reference;
    Q.head<kLinearJoints>() = C_ * p + added * Vector3d::UnitZ();
    nominal.head<kLinearJoints>() = p;
    const Vector3d tip = machine_.forward(Q, source_.p_ST).p_WT;
    return (R_.transpose() * tip - plant::forward(source_.chain, nominal, source_.p_ST).p_WT).z();
  }

  const TableSource& source_;
  plant::VolumetricModel machine_;
  Matrix3d R_ = Matrix3d::Identity(), C_ = Matrix3d::Identity();
};

double place(double from, double to, int k, int n) { return from + (to - from) * k / (n - 1); }

controllers::SkewFirmware firmware_of(TableFormat format) {
  if (format == TableFormat::klipper) return controllers::SkewFirmware::klipper;
  return format == TableFormat::marlin ? controllers::SkewFirmware::marlin
                                       : controllers::SkewFirmware::reprapfirmware;
}

const char* file_name(TableFormat format) {
  return format == TableFormat::klipper  ? "bed_mesh.cfg"
         : format == TableFormat::marlin ? "bed_mesh.gcode"
                                         : "heightmap.csv";
}

std::string row_text(const BedMesh& mesh, int j) {
  std::vector<std::string> out;
  for (int i = 0; i < mesh.nx; ++i) {
    out.push_back(fmt::format("{:.3f}", mesh.z[std::size_t(j * mesh.nx + i)] / mm + 0.0));
  }
  return fmt::format("{}", fmt::join(out, ", "));
}

std::string klipper_text(const TableExport& e, const BedMesh& mesh) {
  std::string out = fmt::format("[bed_mesh {}]\nversion = 1\npoints =\n", e.request.model);
  for (int j = 0; j < mesh.ny; ++j) out += "  " + row_text(mesh, j) + "\n";
  out += fmt::format("min_x = {:g}\nmax_x = {:g}\nmin_y = {:g}\nmax_y = {:g}\n", mesh.range[0] / mm,
                     mesh.range[1] / mm, mesh.range[2] / mm, mesh.range[3] / mm);
  return out + fmt::format(
                   "x_count = {}\ny_count = {}\nmesh_x_pps = 0\nmesh_y_pps = 0\nalgo = "
                   "lagrange\ntension = 0.2\n",
                   mesh.nx, mesh.ny);
}

std::string heightmap_text(const BedMesh& mesh) {
  std::string out =
      fmt::format("X,Y,{:.2f},{:.2f},{:.2f},{:.2f},-1.00,{:.2f},{:.2f},{},{}\n", mesh.range[0] / mm,
                  mesh.range[1] / mm, mesh.range[2] / mm, mesh.range[3] / mm,
                  (mesh.range[1] - mesh.range[0]) / mm / (mesh.nx - 1),
                  (mesh.range[3] - mesh.range[2]) / mm / (mesh.ny - 1), mesh.nx, mesh.ny);
  for (int j = 0; j < mesh.ny; ++j) out += row_text(mesh, j) + "\n";
  return out;
}

std::string marlin_text(const BedMesh& mesh) {
  std::string out;
  for (int j = 0; j < mesh.ny; ++j) {
    for (int i = 0; i < mesh.nx; ++i) {
      out += fmt::format("M421 I{} J{} Z{:.3f}\n", i, j,
                         mesh.z[std::size_t(j * mesh.nx + i)] / mm + 0.0);
    }
  }
  return out;
}

// Rows along X.
std::vector<double> heights_at_points(const Heights& heights, const BedMesh& mesh) {
  std::vector<double> out;
  for (int j = 0; j < mesh.ny; ++j) {
    for (int i = 0; i < mesh.nx; ++i) {
      out.push_back(heights.at(place(mesh.range[0], mesh.range[1], i, mesh.nx),
                               place(mesh.range[2], mesh.range[3], j, mesh.ny), 0.0));
    }
  }
  return out;
}

void take_uncertainty(const TableExport& e, BedMesh& mesh) {
  if (!e.request.identified) return;
  const auto numbers = [&](const plant::ErrorModel& errors) -> Eigen::VectorXd {
    TableSource source = e.source;
    source.errors = errors;
    const std::vector<double> z = heights_at_points(Heights(source, e.skew), mesh);
    return Eigen::Map<const Eigen::VectorXd>(z.data(), Eigen::Index(z.size()));
  };
  const Eigen::VectorXd z = numbers(e.source.errors);
  const Eigen::VectorXd U =
      model::expanded_uncertainty(numbers, e.source.errors, *e.request.identified);
  const model::Determination found = determination(z, U);
  mesh.uncertainty = found.uncertainty();
  if (found.is_determined()) return;
  throw InputError(
      {}, fmt::format("the bed mesh would correct Z by up to {:.3g} um with U(k = 2) up to {:.3g} "
                      "um: not determined by the calibration; leave out --bed-mesh, or limit it "
                      "with --travel",
                      found.largest() / um, found.uncertainty() / um));
}

}  // namespace

BedMesh bed_mesh_of(const TableExport& e) {
  BedMesh out;
  std::tie(out.nx, out.ny) = std::tuple((*e.request.mesh)[0], (*e.request.mesh)[1]);
  for (const TableLine& line : e.lines) {
    if (line.joint > 1) continue;
    out.range[std::size_t(2 * line.joint)] = line.from;
    out.range[std::size_t(2 * line.joint + 1)] = line.to;
  }
  take_uncertainty(e, out);
  const Heights heights(e.source, e.skew);
  controllers::MeshTable mesh{.nx = out.nx, .ny = out.ny, .range = out.range, .z = {}};
  for (const double z : heights_at_points(heights, out)) {
    mesh.z.push_back(std::round(-z / kDigit) * kDigit + 0.0);
  }
  out.z = mesh.z;
  for (int n = 0; n < kPlaces * kPlaces; ++n) {
    const double x = place(out.range[0], out.range[1], n % kPlaces, kPlaces);
    const double y = place(out.range[2], out.range[3], n / kPlaces, kPlaces);
    out.before = std::max(out.before, std::abs(heights.at(x, y, 0.0)));
    out.after = std::max(out.after, std::abs(heights.at(x, y, mesh.at(x, y, out.range))));
  }
  return out;
}

std::vector<std::string> mesh_report(const TableExport& e) {
  const BedMesh& mesh = *e.mesh;
  return {fmt::format("bed mesh of error model '{}' on {}: {} x {} points, X {:g} to {:g} mm, Y "
                      "{:g} to {:g} mm, at Z {:g} mm",
                      e.request.model, e.machine, mesh.nx, mesh.ny, mesh.range[0] / mm,
                      mesh.range[1] / mm, mesh.range[2] / mm, mesh.range[3] / mm,
                      e.source.reference[2] / mm),
          fmt::format("Z of the TCP away from the reference: off by up to {:.1f} um without the "
                      "mesh, {:.1f} um with{}",
                      mesh.before / um, mesh.after / um,
                      mesh.uncertainty
                          ? fmt::format("; U(k = 2) up to {:.3g} um", *mesh.uncertainty / um)
                          : "")};
}

TextFile mesh_file(const TableExport& e) {
  const BedMesh& mesh = *e.mesh;
  const TableFormat format = e.request.format;
  if (format == TableFormat::reprapfirmware) {
    return {file_name(format),
            fmt::format("RepRapFirmware height map file v2, {}\naxis0,axis1,min0,max0,min1,max1,"
                        "radius,spacing0,spacing1,num0,num1\n{}",
                        mesh_report(e)[0], heightmap_text(mesh))};
  }
  const bool klipper = format == TableFormat::klipper;
  std::string text;
  for (const std::string& line : with_unknown(mesh_report(e), e)) {
    text += fmt::format("{} {}\n", klipper ? '#' : ';', line);
  }
  text += klipper ? fmt::format("# in addition to a section [bed_mesh]; BED_MESH_PROFILE LOAD={}\n",
                                e.request.model)
                  : "; needs a mesh of these points over this range in the firmware; M420 S1\n";
  return {file_name(format), text + (klipper ? klipper_text(e, mesh) : marlin_text(mesh))};
}

void verify_mesh(const TableExport& e, const std::vector<TextFile>& files, TableVerification& out) {
  const char* name = file_name(e.request.format);
  const auto file = std::find_if(files.begin(), files.end(),
                                 [&](const TextFile& one) { return one.name == name; });
  if (file == files.end()) throw InputError({name}, "is missing");
  const controllers::MeshTable mesh =
      controllers::read_mesh_table({file->name, file->text}, firmware_of(e.request.format));
  const std::array<double, 4>& range = e.mesh->range;
  const auto is_far = [](double a, double b) { return std::abs(a - b) > 10e-6; };
  if (mesh.nx != e.mesh->nx || mesh.ny != e.mesh->ny ||
      (mesh.range && !std::equal(range.begin(), range.end(), mesh.range->begin(),
                                 [&](double a, double b) { return !is_far(a, b); }))) {
    throw InputError({name}, "verification failed: points or range are others");
  }
  const Heights heights(e.source, e.skew);
  for (int j = 0; j < mesh.ny; ++j) {
    for (int i = 0; i < mesh.nx; ++i) {
      const double x = place(range[0], range[1], i, mesh.nx);
      const double y = place(range[2], range[3], j, mesh.ny);
      const double off = std::abs(heights.at(x, y, mesh.at(x, y, range)));
      out.length = std::max(out.length, off);
      ++out.positions;
      if (off <= 0.6 * kDigit) continue;
      throw InputError({name},
                       fmt::format("verification failed: at X {:g}, Y {:g} mm Z is off by {:.3f} "
                                   "um",
                                   x / mm, y / mm, off / um));
    }
  }
}

}  // namespace servomill::sim::tables
