/// A polyline in joint space, and what the program allows and asks on the way to each vertex.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "plant/vocabulary/axes.h"

namespace servomill::controllers {

/// One vertex. Rotary coordinates are multiplied by a radius, so that all five are metres.
struct PathVertex {
  Joints u = Joints::Zero();      // m
  double tolerance_linear = 0.0;  // m, on the way to this vertex
  double tolerance_rotary = 0.0;  // m
  double speed = 0.0;             // m/s along the path, programmed on the way to this vertex
  int arc = -1;  // interior point of that arc or spline: may be moved outward so that the curve
                 // passes it
  bool is_exact = false;  // of a spline, which the path follows as it is (exact_curves.h)
};

/// Vertices, held so that a million of them take 52 MB: neighbours rarely differ in more than place
/// and speed.
class Polyline {
 public:
  struct Traits {
    double tolerance_linear = 0.0, tolerance_rotary = 0.0;  // m
    int arc = -1;
    bool is_exact = false;
    bool operator==(const Traits&) const = default;
  };

  Polyline() = default;
  Polyline(const std::vector<PathVertex>& vertices) {  // NOLINT: they are one
    for (const PathVertex& vertex : vertices) push_back(vertex);
  }

  std::size_t size() const { return u_.size(); }
  const Joints& u(std::size_t i) const { return u_[i]; }
  double speed(std::size_t i) const { return speed_[i]; }
  const Traits& traits(std::size_t i) const { return traits_[index_[i]]; }
  bool has_arcs() const { return has_arcs_; }

  void push_back(const PathVertex& vertex);
  void set_last_arc(int arc);
  void move_to(std::size_t i, const Joints& u) { u_[i] = u; }
  void clear();

 private:
  std::uint32_t index_of(const Traits& traits);

  std::vector<Joints> u_;
  std::vector<double> speed_;
  std::vector<std::uint32_t> index_;  // into traits_
  std::vector<Traits> traits_;
  bool has_arcs_ = false;
};

}  // namespace servomill::controllers
