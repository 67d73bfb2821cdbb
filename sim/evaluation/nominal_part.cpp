#include "sim/evaluation/nominal_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/units.h"
#include "sim/model/work_frame.h"

namespace servomill::sim::evaluation {
namespace {

constexpr double kStep = 10e-6;  // m, along a normal
constexpr double kShare = 0.9;  // of it, by which the distance grows: facets may be turned a little

// True if the distance from the part grows along the normal: outside of it, or, as at the foot of a
// wall, inside.
bool faces_out(const metrology::TriangleMesh& mesh, const plant::ProbeTarget& target,
               double distance) {
  const auto at = [&](double s) { return mesh.closest(target.point + s * target.normal).distance; };
  return at(kStep) - distance >= kShare * kStep || distance - at(-kStep) >= kShare * kStep;
}

// Points with one kind of fault: how many, and the first.
struct Wrong {
  std::size_t count = 0;
  const plant::ProbeTarget* first = nullptr;
  metrology::SurfacePoint nearest = {};

  void add(const plant::ProbeTarget& target, const metrology::SurfacePoint& surface) {
    if (count++ > 0) return;
    first = &target;
    nearest = surface;
  }
};

}  // namespace

std::vector<Fault> faults_of_plan(std::span<const metrology::ProbeSpec> plan,
                                  const NominalPart& part) {
  std::vector<Fault> faults;
  for (const metrology::ProbeSpec& probe : plan) {
    Wrong off, astray;
    for (const plant::ProbeTarget& target : probe.feature.targets) {
      const metrology::SurfacePoint surface = part.mesh->closest(target.point);
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
                                    begin(off), part.file, model::program_words(off.first->point),
                                    std::abs(off.nearest.distance) / mm, kOffThePart / mm)});
    }
    if (astray.count > 0) {
      const Eigen::Vector3d& n = astray.nearest.normal;
      faults.push_back(
          {probe.place,
           fmt::format("{} have normals that disagree with the part '{}', the first at {}, where "
                       "its normal is ({:.3g}, {:.3g}, {:.3g}); normals must point out of the part",
                       begin(astray), part.file, model::program_words(astray.first->point),
                       n.x() + 0.0, n.y() + 0.0, n.z() + 0.0)});
    }
  }
  return faults;
}

double largest_distance(std::span<const metrology::ProbeSpec> plan,
                        const metrology::TriangleMesh& mesh) {
  double largest = 0.0;
  for (const metrology::ProbeSpec& probe : plan) {
    for (const plant::ProbeTarget& target : probe.feature.targets) {
      largest = std::max(largest, std::abs(mesh.closest(target.point).distance));
    }
  }
  return largest;
}

}  // namespace servomill::sim::evaluation
