// The reader of STL files, ASCII and binary. Laws: faults have their places; what is accepted is a
// body of some volume, on whose surface its corners lie.
#include <cmath>

#include "sim/metrology/triangle_mesh.h"
#include "tests/fuzz/fuzz.h"

namespace servomill::fuzz {
namespace {

constexpr double kRounding = 1e-12;  // of the size
constexpr std::size_t kMaxCorners = 50;

}  // namespace

void run(std::string_view text) {
  try {
    const auto mesh = sim::metrology::TriangleMesh::parse(text, "part.stl");
    require(std::isfinite(mesh.volume()) && mesh.volume() > 0.0, "a body has a volume");
    double size = 0.0;
    for (const auto& corner : mesh.triangles().corners) size = std::max(size, corner.norm());
    std::size_t count = 0;
    for (const auto& corner : mesh.triangles().corners) {
      if (++count > kMaxCorners) break;
      require(std::abs(mesh.closest(corner).distance) <= kRounding * size,
              "corners lie on the surface");
    }
  } catch (const InputError& error) {
    require_places(error.faults(), text, "part.stl");
  }
}

}  // namespace servomill::fuzz
