/// The points at which a search for a quicker time law looks at the limits of the joints.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "controllers/path/barrier_kernel.h"
#include "controllers/path/path_parts.h"
#include "controllers/path/speed_spline.h"

namespace servomill::controllers {

/// Three points of every part. Those of a short path are formed once and kept, 700 bytes a part; of
/// a long one they are formed anew whenever they are due, so that the memory does not grow with it.
/// Either way the same bits.
class BarrierStore {
 public:
  static constexpr std::size_t kMaxKept = 8192;  // parts: 6 MB

  /// Points first_block .. first_block + count - 1 blocks; the lanes behind the last point repeat
  /// it.
  struct Blocks {
    BarrierPoints* points = nullptr;
    std::size_t first = 0, count = 0;
    const BarrierPoints& holding(std::size_t point) const {
      return points[point / kLaneWidth - first];
    }
  };

  /// All must outlive this.
  /// @param v_top  m/s, largest speed on each piece
  /// @param first  coefficients where the search begins, of which the points have their time
  /// @param most_kept  parts of which the points are kept
  BarrierStore(const SmoothPath& path, const SpeedSpline& spline, const PathParts& parts,
               std::span<const double> v_top, const std::vector<double>& first,
               std::size_t most_kept = kMaxKept);

  void prepare(const BarrierJoints& joints, const std::array<int, kBarrierJoints>& moving,
               const BarrierKernel& kernel);
  /// The blocks of the points of these parts. They are valid until the next call.
  Blocks of(std::size_t first_part, std::size_t last_part);

 private:
  void form(std::size_t first_group, std::size_t count);
  void fill(std::size_t group, BarrierParts& to) const;

  const SmoothPath& path_;
  const SpeedSpline& spline_;
  const PathParts& parts_;
  std::span<const double> v_top_;
  const std::vector<double>& first_c_;
  BarrierJoints joints_;
  std::array<int, kBarrierJoints> moving_{};
  BarrierKernel kernel_{};
  std::size_t most_kept_;
  bool is_kept_ = false;
  std::vector<BarrierParts> groups_;
  std::vector<BarrierPoints> points_;
};

}  // namespace servomill::controllers
