#include "sim/nominal_part.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "plant/vocabulary/units.h"
#include "sim/config/base64.h"
#include "sim/scenario_document.h"

namespace servomill::sim {
namespace {

std::optional<std::string> read_bytes(Reader& part, const std::string& file, InputFiles& files) {
  if (!part.has("stl_base64")) return *files.text(file, part.place("stl"), "part");
  const auto bytes = from_base64(part.text("stl_base64"));
  if (!bytes) part.fault("stl_base64 is not base64");
  return bytes;
}

std::string place_of(const Eigen::Vector3d& p) {
  return fmt::format("X{:g} Y{:g} Z{:g}", p.x() / mm, p.y() / mm, p.z() / mm);
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
  const std::string file = part.has("stl_base64") ? name : beside(part.place("stl"), name);
  auto bytes = read_bytes(part, file, files);
  if (!bytes) return nullptr;
  auto mesh = std::make_shared<const TriangleMesh>(TriangleMesh::parse(*bytes, file));
  return std::make_shared<const NominalPart>(NominalPart{file, *std::move(bytes), std::move(mesh)});
}

std::vector<Fault> faults_of_plan(std::span<const ProbeSpec> plan, const NominalPart& part) {
  std::vector<Fault> faults;
  for (const ProbeSpec& probe : plan) {
    Wrong off, inwards;
    for (const plant::ProbeTarget& target : probe.feature.targets) {
      const SurfacePoint surface = part.mesh->closest(target.point);
      if (std::abs(surface.distance) > kOffThePart) {
        off.add(target, surface);
      } else if (surface.on_face && surface.normal.dot(target.normal) < 0.0) {
        inwards.add(target, surface);
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
                                    begin(off), part.file, place_of(off.first->point),
                                    std::abs(off.nearest.distance) / mm, kOffThePart / mm)});
    }
    if (inwards.count > 0) {
      faults.push_back(
          {probe.place, fmt::format("{} face into the part '{}', the first at {}; normals must "
                                    "point out of it",
                                    begin(inwards), part.file, place_of(inwards.first->point))});
    }
  }
  return faults;
}

}  // namespace servomill::sim
