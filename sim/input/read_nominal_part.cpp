#include "sim/input/read_nominal_part.h"

#include <optional>
#include <string>
#include <utility>

#include "sim/input/scenario_document.h"
#include "sim/metrology/triangle_mesh.h"
#include "sim/system/base64.h"

namespace servomill::sim::input {
namespace {

std::optional<std::string> bytes_of_text(config::Reader& part) {
  auto bytes = system::from_base64(part.text("stl_base64"));
  if (!bytes) part.fault("stl_base64 is not base64");
  return bytes;
}

}  // namespace

std::shared_ptr<const evaluation::NominalPart> read_nominal_part(config::Reader& part,
                                                                 InputFiles& files) {
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
  auto mesh =
      std::make_shared<const metrology::TriangleMesh>(metrology::TriangleMesh::parse(*bytes, file));
  return std::make_shared<const evaluation::NominalPart>(
      evaluation::NominalPart{file, *std::move(bytes), std::move(mesh)});
}

}  // namespace servomill::sim::input
