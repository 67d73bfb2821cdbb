/// The file format STL.
#pragma once

#include <string>
#include <string_view>

#include "sim/metrology/triangle_mesh.h"

namespace servomill::sim::metrology {

/// Triangles of an STL file as they stand there; TriangleMesh checks whether they bound a body.
/// @throws InputError as TriangleMesh::parse, for what the file itself has wrong
Triangles read_stl(std::string_view bytes, const std::string& file);

}  // namespace servomill::sim::metrology
