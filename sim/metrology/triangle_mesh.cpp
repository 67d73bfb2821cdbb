#include "sim/metrology/triangle_mesh.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <nanoflann.hpp>
#include <span>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "sim/metrology/read_stl.h"

namespace servomill::sim::metrology {
namespace {

using Eigen::Vector3d;
using Corners = std::array<int, 3>;
using Edge = std::pair<int, int>;

constexpr double kNoArea = 1e-7;   // of the longest edge squared: what single precision resolves
constexpr double kSamples = 5000;  // about, over the whole surface

Vector3d area_vector(const Triangles& t, const Corners& c) {
  return 0.5 * (t.corners[c[1]] - t.corners[c[0]]).cross(t.corners[c[2]] - t.corners[c[0]]);
}

std::string in_mm(const Vector3d& p) {
  return fmt::format("({:g}, {:g}, {:g})", p.x() / mm, p.y() / mm, p.z() / mm);
}

void check_triangles(const Triangles& t, const std::string& file) {
  if (t.triangles.empty()) throw InputError({file}, "the mesh has no triangles");
  for (std::size_t i = 0; i < t.triangles.size(); ++i) {
    throw_if_interrupted();
    double longest = 0.0;
    for (int k = 0; k < 3; ++k) {
      const Vector3d& corner = t.corners[t.triangles[i][k]];
      if (!corner.allFinite()) {
        throw InputError({file}, fmt::format("triangle {} has a corner that is not finite", i + 1));
      }
      const Vector3d edge = t.corners[t.triangles[i][(k + 1) % 3]] - corner;
      longest = std::max(longest, edge.squaredNorm());
    }
    if (!(area_vector(t, t.triangles[i]).norm() > kNoArea * longest)) {
      throw InputError({file}, fmt::format("triangle {} at {} mm has no area", i + 1,
                                           in_mm(t.corners[t.triangles[i][0]])));
    }
  }
}

// Every edge must be passed as often in one direction as in the other.
void check_closed(const Triangles& t, const std::string& file) {
  struct Use {
    int forward = 0, backward = 0;
    std::size_t first = 0;  // triangle
  };
  std::map<Edge, Use> edges;
  for (std::size_t i = 0; i < t.triangles.size(); ++i) {
    throw_if_interrupted();
    for (int k = 0; k < 3; ++k) {
      const int a = t.triangles[i][k], b = t.triangles[i][(k + 1) % 3];
      Use& use = edges.try_emplace(std::minmax(a, b), Use{0, 0, i}).first->second;
      ++(a < b ? use.forward : use.backward);
    }
  }
  const std::pair<const Edge, Use>*open = nullptr, *flipped = nullptr;
  int count = 0;
  for (const auto& entry : edges) {
    const Use& use = entry.second;
    if (use.forward == use.backward) continue;
    const bool is_flip = (use.forward + use.backward) % 2 == 0;
    const auto*& first = is_flip ? flipped : open;
    if (!first || use.first < first->second.first) first = &entry;
    if (!is_flip) ++count;
  }
  const auto where = [&](const std::pair<const Edge, Use>& edge) {
    return fmt::format("of triangle {} from {} to {} mm", edge.second.first + 1,
                       in_mm(t.corners[edge.first.first]), in_mm(t.corners[edge.first.second]));
  };
  if (open) {
    throw InputError({file}, fmt::format("the mesh has holes: {} open edge{}, the first {}", count,
                                         count == 1 ? "" : "s", where(*open)));
  }
  if (flipped) {
    throw InputError({file}, fmt::format("neighbours at an edge {} have inconsistent orientation: "
                                         "the vertex order of one of them is reversed",
                                         where(*flipped)));
  }
}

double volume_of(const Triangles& t) {
  double volume = 0.0;
  const Vector3d origin = t.corners[t.triangles.front()[0]];
  for (const Corners& c : t.triangles)
    volume += area_vector(t, c).dot(t.corners[c[0]] - origin) / 3.0;
  return volume;
}

// The nearest point of a triangle, and whether it is a corner (0, 1, 2), an edge (3: from corner 0,
// 4: from 1, 5: from 2) or the face (6).
struct Nearest {
  Vector3d point;
  int part = 6;
};

Nearest nearest_of(const std::array<Vector3d, 3>& corner, const Vector3d& place) {
  // inside the prism over the face? Else the nearest point of the three edges.
  const Vector3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  bool inside = true;
  for (int k = 0; k < 3; ++k) {
    inside &= normal.cross(corner[(k + 1) % 3] - corner[k]).dot(place - corner[k]) >= 0.0;
  }
  if (inside) {
    return {place - normal.dot(place - corner[0]) / normal.squaredNorm() * normal, 6};
  }
  Nearest best;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const Vector3d edge = corner[(k + 1) % 3] - corner[k];
    const double share = edge.dot(place - corner[k]) / edge.squaredNorm();
    const int part = share <= 0.0 ? k : share >= 1.0 ? (k + 1) % 3 : 3 + k;
    const Vector3d point = part < 3 ? corner[part] : Vector3d(corner[k] + share * edge);
    const double distance = (place - point).squaredNorm();
    if (distance < least) {
      least = distance;
      best = {point, part};
    }
  }
  return best;
}

// A sample of the surface and the triangle it is of.
struct Samples {
  std::vector<Vector3d> points;
  std::vector<int> triangles;

  // what nanoflann asks for
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t k) const {
    return points[i][static_cast<int>(k)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Samples>,
                                                 Samples, 3, std::size_t>;

// Halves the triangle across its longest edge until a ball of radius h about its middle covers it.
void add_samples(const std::array<Vector3d, 3>& corner, int triangle, double h, Samples& samples) {
  const Vector3d middle = (corner[0] + corner[1] + corner[2]) / 3.0;
  double radius = 0.0, longest = 0.0;
  int k_longest = 0;
  for (int k = 0; k < 3; ++k) {
    radius = std::max(radius, (corner[k] - middle).norm());
    const double length = (corner[(k + 1) % 3] - corner[k]).norm();
    if (length > longest) {
      longest = length;
      k_longest = k;
    }
  }
  if (radius <= h) {
    samples.points.push_back(middle);
    samples.triangles.push_back(triangle);
    return;
  }
  const Vector3d &a = corner[k_longest], &b = corner[(k_longest + 1) % 3],
                 &c = corner[(k_longest + 2) % 3];
  const Vector3d half = 0.5 * (a + b);
  add_samples({a, half, c}, triangle, h, samples);
  add_samples({half, b, c}, triangle, h, samples);
}

}  // namespace

struct TriangleMesh::Parts {
  Triangles body;
  std::vector<Vector3d> face_normals, corner_normals;
  std::vector<std::array<Vector3d, 3>> edge_normals;  // from corner 0, 1, 2 of each triangle
  double covering = 0.0;                              // m, radius of the balls about samples
  Samples samples;
  std::unique_ptr<Tree> tree;

  std::array<Vector3d, 3> corners(int triangle) const {
    const Corners& c = body.triangles[triangle];
    return {body.corners[c[0]], body.corners[c[1]], body.corners[c[2]]};
  }

  // Normals of edges are sums of those of their faces, those of corners are weighted by angles.
  void find_normals() {
    std::map<Edge, Vector3d> of_edges;
    corner_normals.assign(body.corners.size(), Vector3d::Zero());
    for (std::size_t i = 0; i < body.triangles.size(); ++i) {
      throw_if_interrupted();
      const Corners& c = body.triangles[i];
      const auto corner = corners(static_cast<int>(i));
      const Vector3d normal = area_vector(body, c).normalized();
      face_normals.push_back(normal);
      for (int k = 0; k < 3; ++k) {
        const Vector3d to = corner[(k + 1) % 3] - corner[k], from = corner[(k + 2) % 3] - corner[k];
        corner_normals[c[k]] += std::atan2(to.cross(from).norm(), to.dot(from)) * normal;
        of_edges.try_emplace(std::minmax(c[k], c[(k + 1) % 3]), Vector3d::Zero()).first->second +=
            normal;
      }
    }
    for (Vector3d& normal : corner_normals) normal.normalize();
    for (const Corners& c : body.triangles) {
      auto& normals = edge_normals.emplace_back();
      for (int k = 0; k < 3; ++k) {
        normals[k] = of_edges.at(std::minmax(c[k], c[(k + 1) % 3])).normalized();
      }
    }
  }

  void find_samples() {
    double area = 0.0;
    for (const Corners& c : body.triangles) area += area_vector(body, c).norm();
    covering = std::sqrt(area / kSamples);
    for (std::size_t i = 0; i < body.triangles.size(); ++i) {
      throw_if_interrupted();
      add_samples(corners(static_cast<int>(i)), static_cast<int>(i), covering, samples);
    }
    tree = std::make_unique<Tree>(3, samples, nanoflann::KDTreeSingleIndexAdaptorParams(10));
    tree->buildIndex();
  }

  Vector3d normal_at(int triangle, int part) const {
    if (part == 6) return face_normals[triangle];
    if (part >= 3) return edge_normals[triangle][part - 3];
    return corner_normals[body.triangles[triangle][part]];
  }
};

TriangleMesh::TriangleMesh(Triangles triangles, const std::string& file)
    : parts_(std::make_unique<Parts>()) {
  check_triangles(triangles, file);
  check_closed(triangles, file);
  parts_->body = std::move(triangles);
  if (!(volume() > 0.0)) {
    throw InputError(
        {file},
        "the mesh is inside out: the vertices of its triangles are clockwise seen from outside");
  }
  parts_->find_normals();
  parts_->find_samples();
}

TriangleMesh::TriangleMesh(TriangleMesh&&) noexcept = default;
TriangleMesh& TriangleMesh::operator=(TriangleMesh&&) noexcept = default;
TriangleMesh::~TriangleMesh() = default;

TriangleMesh TriangleMesh::parse(std::string_view bytes, const std::string& file) {
  return TriangleMesh(read_stl(bytes, file), file);
}

const Triangles& TriangleMesh::triangles() const { return parts_->body; }
double TriangleMesh::volume() const { return volume_of(parts_->body); }

SurfacePoint TriangleMesh::closest(const Vector3d& place) const {
  const Parts& m = *parts_;
  std::size_t first = 0;
  double squared = 0.0;
  m.tree->knnSearch(place.data(), 1, &first, &squared);
  int triangle = m.samples.triangles[first];
  Nearest best = nearest_of(m.corners(triangle), place);
  double least = (place - best.point).squaredNorm();

  std::vector<std::pair<std::size_t, double>> candidates;
  const double reach = (std::sqrt(least) + m.covering) * (1.0 + 1e-12);  // rounding
  nanoflann::SearchParams unsorted;
  unsorted.sorted = false;
  m.tree->radiusSearch(place.data(), reach * reach, candidates, unsorted);
  int last = triangle;
  for (const auto& [sample, unused] : candidates) {
    const int i = m.samples.triangles[sample];
    if (i == last) continue;
    last = i;
    const Nearest nearest = nearest_of(m.corners(i), place);
    const double distance = (place - nearest.point).squaredNorm();
    // of those that share an edge the first in the file, whatever the order of the search
    if (distance < least || (distance == least && i < triangle)) {
      least = distance;
      best = nearest;
      triangle = i;
    }
  }
  const Vector3d normal = m.normal_at(triangle, best.part);
  const double side = normal.dot(place - best.point) < 0.0 ? -1.0 : 1.0;
  return {best.point, normal, side * std::sqrt(least), best.part == 6};
}

}  // namespace servomill::sim::metrology
