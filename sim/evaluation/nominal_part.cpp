#include "sim/evaluation/nominal_part.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "plant/vocabulary/units.h"
#include "sim/input/scenario_document.h"
#include "sim/model/work_frame.h"
#include "sim/system/base64.h"

namespace servomill::sim {
namespace {

std::optional<std::string> bytes_of_text(Reader& part) {
  auto bytes = from_base64(part.text("stl_base64"));
  if (!bytes) part.fault("stl_base64 is not base64");
  return bytes;
}

constexpr double kStep = 10e-6;  // m, along a normal
constexpr double kShare = 0.9;  // of it, by which the distance grows: facets may be turned a little

// Whether the distance from the part grows along the normal: outside of it, or, as at the foot of a
// wall, inside.
bool faces_out(const TriangleMesh& mesh, const plant::ProbeTarget& target, double distance) {
  const auto at = [&](double s) { return mesh.closest(target.point + s * target.normal).distance; };
  return at(kStep) - distance >= kShare * kStep || distance - at(-kStep) >= kShare * kStep;
}

// What is wrong with points of one kind: how many, and the first.
struct Wrong {
  std::size_t count = 0;
  const plant::ProbeTarget* first = nullptr;
  SurfacePoint nearest = {};

  void add(const plant::ProbeTarget& target, const SurfacePoint& surface) {
    if (count++ > 0) return;
    first = &target;
    nearest = surface;
  }
};

}  // namespace

std::shared_ptr<const NominalPart> read_nominal_part(Reader& part, InputFiles& files) {
  if (!part.has("stl")) return nullptr;
  const std::size_t before = part.faults();
  const std::string name = part.text("stl");
  if (part.faults() == before && name.empty()) part.fault("stl", "must name an STL file");
  if (part.faults() > before) return nullptr;
  const bool is_here = part.has("stl_base64") && !is_outdated_copy(part, "stl", "stl_base64");
  if (!is_here) part.raw("stl_base64");
  const std::string file = is_here ? name : beside(part.place("stl"), name);
  auto bytes = is_here ? bytes_of_text(part) : *files.text(file, part.place("stl"), "part");
  if (!bytes) return nullptr;
  auto mesh = std::make_shared<const TriangleMesh>(TriangleMesh::parse(*bytes, file));
  return std::make_shared<const NominalPart>(NominalPart{file, *std::move(bytes), std::move(mesh)});
}

std::vector<Fault> faults_of_plan(std::span<const ProbeSpec> plan, const NominalPart& part) {
  std::vector<Fault> faults;
  for (const ProbeSpec& probe : plan) {
    Wrong off, astray;
    for (const plant::ProbeTarget& target : probe.feature.targets) {
      const SurfacePoint surface = part.mesh->closest(target.point);
      if (std::abs(surface.distance) > kOffThePart) {
        off.add(target, surface);
      } else if (!faces_out(*part.mesh, target, surface.distance)) {
        astray.add(target, surface);
      }
    }
    const auto begin = [&](const Wrong& wrong) {
      return fmt::format("probe '{}': {} of {} points", probe.name, wrong.count,
                         probe.feature.targets.size());
    };
    if (off.count > 0) {
      faults.push_back(
          {probe.place, fmt::format("{} are not on the part '{}', the first, {}, is "
                                    "{:.3g} mm off; must be <= {:g} mm",
                                    begin(off), part.file, program_words(off.first->point),
                                    std::abs(off.nearest.distance) / mm, kOffThePart / mm)});
    }
    if (astray.count > 0) {
      const Eigen::Vector3d& n = astray.nearest.normal;
      faults.push_back(
          {probe.place,
           fmt::format("{} do not face as the part '{}' does, the first at {}, where it faces "
                       "({:.3g}, {:.3g}, {:.3g}); normals must point out of it",
                       begin(astray), part.file, program_words(astray.first->point), n.x() + 0.0,
                       n.y() + 0.0, n.z() + 0.0)});
    }
  }
  return faults;
}

}  // namespace servomill::sim
