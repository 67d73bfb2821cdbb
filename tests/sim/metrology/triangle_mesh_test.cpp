#include "sim/metrology/triangle_mesh.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cctype>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <numbers>
#include <string>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "tests/sim/metrology/random_poses.h"

namespace servomill::sim::metrology::triangle_mesh_test {
namespace {

using Eigen::Vector3d;

constexpr double kRounding = 1e-15;  // m, of some operations on lengths of 0.2 m

// A cuboid of half-lengths h about the origin, two triangles a side.
Triangles cuboid(const Vector3d& h) {
  Triangles out;
  for (int i = 0; i < 8; ++i) {
    out.corners.push_back(h.cwiseProduct(Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  }
  out.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return out;
}

// |p - nearest point of the cuboid| in closed form.
double cuboid_distance(const Vector3d& h, const Vector3d& p) {
  const Vector3d q = p.cwiseAbs() - h;
  return q.cwiseMax(0.0).norm() + std::min(0.0, q.maxCoeff());
}

std::string fault_of(const std::string& bytes) {
  try {
    TriangleMesh::parse(bytes, "part.stl");
  } catch (const InputError& fault) {
    return fault.what();
  }
  return "no fault";
}

std::string fault_of(const Triangles& triangles) {
  try {
    TriangleMesh mesh(triangles, "part.stl");
  } catch (const InputError& fault) {
    return fault.what();
  }
  return "no fault";
}

TEST(TriangleMesh, KnowsTheDistanceFromACuboid) {
  Random random(1);
  const Vector3d h(0.08, 0.03, 0.01);
  const TriangleMesh mesh(cuboid(h));
  EXPECT_NEAR(mesh.volume(), 8.0 * h.prod(), kRounding);
  for (int n = 0; n < 20000; ++n) {
    const Vector3d p = random.in_cube(n % 2 ? 0.1 : 0.3);
    const SurfacePoint nearest = mesh.closest(p);
    EXPECT_NEAR(nearest.distance, cuboid_distance(h, p), kRounding) << p.transpose();
    EXPECT_NEAR((p - nearest.point).norm(), std::abs(nearest.distance), kRounding);
    EXPECT_NEAR(nearest.normal.norm(), 1.0, kRounding);
  }
}

// At an edge and a corner the nearest triangle alone cannot tell inside from outside.
TEST(TriangleMesh, TellsInsideFromOutsideAtEdgesAndCorners) {
  const TriangleMesh mesh(cuboid(Vector3d(0.1, 0.1, 0.1)));
  const Vector3d corner(0.1, 0.1, 0.1), edge(0.1, 0.1, 0.03);
  for (const Vector3d& out : {Vector3d(1, 1, 1), Vector3d(1, 0.1, 0.1), Vector3d(0.1, 1, 0.5)}) {
    EXPECT_GT(mesh.closest(corner + 1e-3 * out).distance, 0.0);
    EXPECT_LT(mesh.closest(corner - 1e-3 * out).distance, 0.0);
  }
  EXPECT_TRUE(mesh.closest(edge + Vector3d(1e-3, 1e-3, 0))
                  .normal.isApprox(Vector3d(1, 1, 0).normalized(), 1e-15));
  EXPECT_TRUE(mesh.closest(corner + Vector3d(1e-3, 1e-3, 1e-3))
                  .normal.isApprox(Vector3d(1, 1, 1).normalized(), 1e-15));
}

// The part that is shipped; its needles and large triangles against all triangles tried.
class M1Part : public testing::Test {
 protected:
  M1Part() : mesh(read()) {}
  static TriangleMesh read() {
    std::ifstream file(SERVOMILL_SOURCE_DIR "/scenarios/guevel2025/m1_part.stl", std::ios::binary);
    return TriangleMesh::parse(std::string(std::istreambuf_iterator<char>(file), {}),
                               "m1_part.stl");
  }
  TriangleMesh mesh;
};

// Circle of 110 mm, diamond of 113, square of 160, base of 176, from 0 to -6, -12, -20, -40 mm.
TEST_F(M1Part, HasTheVolumeOfItsSteps) {
  const double expected = std::numbers::pi * 55.0 * 55.0 * 6.0 + 113.0 * 113.0 * 6.0 +
                          160.0 * 160.0 * 8.0 + 176.0 * 176.0 * 20.0;  // mm^3
  // the polygon's mean radius is 55 mm + 0.03 um: corners 0.1 um outside, sides 0.1 um inside
  EXPECT_NEAR(mesh.volume() / (mm * mm * mm), expected, 2.0 * std::numbers::pi * 55.0 * 6.0 * 1e-4);
}

TEST_F(M1Part, HasItsFacesWhereTheProgramCutsThem) {
  constexpr double kSinglePrecision = 5e-9;  // m: of 0.1 m
  const auto distance = [&](double x, double y, double z) {
    return mesh.closest(Vector3d(x, y, z) * mm).distance;
  };
  EXPECT_NEAR(distance(10.0, 20.0, 0.5), 0.5 * mm, kSinglePrecision);
  EXPECT_NEAR(distance(56.0, 0.0, -3.0), 1.0 * mm, 0.1 * um + kSinglePrecision);
  const double c = std::cos(30.0 * deg), s = std::sin(30.0 * deg);
  EXPECT_NEAR(distance(58.5 * c, 58.5 * s, -9.0), 2.0 * mm, kSinglePrecision);
  EXPECT_NEAR(distance(-80.1, 30.0, -16.0), 0.1 * mm, kSinglePrecision);
  EXPECT_NEAR(distance(84.0, -60.0, -19.9), 0.1 * mm, kSinglePrecision);
  EXPECT_NEAR(distance(0.0, 0.0, -39.0), -1.0 * mm, kSinglePrecision);
}

// Distance from a triangle: its plane where the foot of p has no negative barycentric coordinate,
// and its sides.
double to_triangle(const Vector3d& p, const Vector3d& A, const Vector3d& B, const Vector3d& C) {
  const Eigen::Matrix<double, 3, 2> sides =
      (Eigen::Matrix<double, 3, 2>() << B - A, C - A).finished();
  const Eigen::Matrix2d gram = sides.transpose() * sides;
  const Eigen::Vector2d b = gram.inverse() * (sides.transpose() * (p - A));
  double least = std::numeric_limits<double>::infinity();
  if (b[0] >= 0.0 && b[1] >= 0.0 && b.sum() <= 1.0) least = (p - A - sides * b).norm();
  for (const auto& [from, to] : {std::pair(A, B), std::pair(B, C), std::pair(C, A)}) {
    const double share = (to - from).dot(p - from) / (to - from).squaredNorm();
    least = std::min(least, (p - from - std::clamp(share, 0.0, 1.0) * (to - from)).norm());
  }
  return least;
}

TEST_F(M1Part, FindsTheNearestOfAllTriangles) {
  Random random(2);
  const Triangles& t = mesh.triangles();
  for (int n = 0; n < 300; ++n) {
    const Vector3d p = random.in_cube(0.1);
    const double found = std::abs(mesh.closest(p).distance);
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& c : t.triangles) {
      nearest =
          std::min(nearest, to_triangle(p, t.corners[c[0]], t.corners[c[1]], t.corners[c[2]]));
    }
    EXPECT_NEAR(found, nearest, kRounding);
  }
}

TEST(Stl, BinaryIsReadAsItWasWritten) {
  const Triangles written = cuboid(Vector3d(0.08, 0.03, 0.01));
  const TriangleMesh mesh = TriangleMesh::parse(binary_stl(written), "part.stl");
  ASSERT_EQ(mesh.triangles().triangles.size(), 12u);
  ASSERT_EQ(mesh.triangles().corners.size(), 8u) << "corners are welded";
  EXPECT_NEAR(mesh.volume(), 8.0 * 0.08 * 0.03 * 0.01, 1e-11);
}

std::string facet(const std::string& a, const std::string& b, const std::string& c) {
  return "  facet normal 0 0 0\n    outer loop\n      vertex " + a + "\n      vertex " + b +
         "\n      vertex " + c + "\n    endloop\n  endfacet\n";
}

const std::string kTetrahedron = "solid corner of a cube\n" + facet("0 0 0", "0 1e1 0", "10 0 0") +
                                 facet("0 0 0", "10 0 0", "0 0 +10") +
                                 facet("0 0 0", "0 0 10", "0 10 -0.0") +
                                 facet("10 0 0", "0 10 0", "0 0 10") + "endsolid corner\n";

TEST(Stl, AsciiIsReadInMillimetres) {
  const TriangleMesh mesh = TriangleMesh::parse(kTetrahedron, "part.stl");
  EXPECT_EQ(mesh.triangles().corners.size(), 4u);
  EXPECT_NEAR(mesh.volume(), 1e-6 / 6.0, 1e-20);
  EXPECT_NEAR(mesh.closest(Vector3d(1, 1, 1) * 20.0 * mm).distance,
              (60.0 - 10.0) / std::sqrt(3.0) * mm, kRounding);
  EXPECT_NEAR(mesh.closest(Vector3d(1, 1, 1) * 1.0 * mm).distance, -1.0 * mm, kRounding);
}

TEST(Stl, AsciiMayBeInUpperCaseBehindBlankLines) {
  std::string upper = kTetrahedron;
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  for (const std::string& text : {upper, "\n  \n" + upper, "\xEF\xBB\xBF" + kTetrahedron}) {
    EXPECT_EQ(TriangleMesh::parse(text, "part.stl").triangles().triangles.size(), 4U);
  }
}

TEST(Stl, FaultsOfTextHavePlaces) {
  std::string text = kTetrahedron;
  text.replace(text.find("1e1"), 3, "ten");
  EXPECT_EQ(fault_of(text), "part.stl:5:16: error: expected a number, found 'ten'");
  text = kTetrahedron;
  text.replace(text.find("1e1"), 3, "nan");
  EXPECT_EQ(fault_of(text), "part.stl:5:16: error: expected a finite number, found 'nan'");
  text = kTetrahedron;
  text.replace(text.find("vertex"), 6, "vertx");
  EXPECT_EQ(fault_of(text), "part.stl:4:7: error: expected 'vertex', found 'vertx'");
  EXPECT_EQ(fault_of(kTetrahedron.substr(0, 200)),
            "part.stl:12:4: error: expected 'vertex', but the file ends here");
  EXPECT_EQ(fault_of(kTetrahedron.substr(0, kTetrahedron.find("endsolid"))),
            "part.stl:30:1: error: expected 'facet' or 'endsolid', but the file ends here");
  EXPECT_EQ(fault_of(std::string("solid nothing\nendsolid nothing\n")),
            "part.stl: error: the mesh has no triangles");
  EXPECT_EQ(
      fault_of(std::string("hello")),
      "part.stl: error: not STL: 5 bytes, neither 'solid' nor the 84 bytes of a binary header");
}

TEST(Stl, FaultsOfBinaryFilesNameTrianglesAndBytes) {
  const std::string whole = binary_stl(cuboid(Vector3d(0.08, 0.03, 0.01)));
  EXPECT_EQ(fault_of(whole.substr(0, 84 + 3 * 50 + 20)),
            "part.stl: error: binary STL with 12 triangles has 684 bytes, but the file has 254: it "
            "is truncated in triangle 4");
  EXPECT_EQ(fault_of(whole + "x"),
            "part.stl: error: binary STL with 12 triangles has 684 bytes, but the file has 685: it "
            "continues after them");
  std::string bytes = whole;
  bytes.replace(84 + 50 + 24, 4, std::string("\0\0\xc0\x7f", 4));  // NaN as X of corner 2
  EXPECT_EQ(fault_of(bytes).substr(0, 66),
            "part.stl: error: triangle 2, byte 158: corner 2 is (nan, 30, -10);");
  bytes = whole.substr(0, 84);
  bytes.replace(80, 4, std::string(4, '\0'));
  EXPECT_EQ(fault_of(bytes), "part.stl: error: the mesh has no triangles");
}

TEST(TriangleMesh, RefusesWhatBoundsNoBody) {
  const Triangles whole = cuboid(Vector3d(0.08, 0.03, 0.01));
  Triangles t = whole;
  t.triangles.erase(t.triangles.begin() + 3);
  EXPECT_EQ(fault_of(t),
            "part.stl: error: the mesh has holes: 3 open edges, the first of triangle 3 from "
            "(80, -30, 10) to (-80, 30, 10) mm");
  t = whole;
  std::swap(t.triangles[0][0], t.triangles[0][1]);
  EXPECT_EQ(
      fault_of(t),
      "part.stl: error: neighbours at an edge of triangle 1 from (-80, -30, -10) to (80, -30, -10) "
      "mm have inconsistent orientation: the vertex order of one of them is reversed");
  t = whole;
  for (auto& c : t.triangles) std::swap(c[0], c[1]);
  EXPECT_EQ(fault_of(t),
            "part.stl: error: the mesh is inside out: the vertices of its triangles are clockwise "
            "seen from outside");
  t = whole;
  t.triangles.push_back({0, 1, 0});
  EXPECT_EQ(fault_of(t), "part.stl: error: triangle 13 at (-80, -30, -10) mm has no area");
  t = whole;
  t.corners[7].x() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(fault_of(t), "part.stl: error: triangle 4 has a corner that is not finite");
}

}  // namespace
}  // namespace servomill::sim::metrology::triangle_mesh_test
