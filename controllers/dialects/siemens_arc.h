/// Arcs of a block: G2 and G3 about a programmed centre or with a radius, CIP through a point.
#pragma once

#include <Eigen/Core>

#include "controllers/dialects/siemens_target.h"

namespace servomill::controllers {

class SiemensArc {
 public:
  /// All of them outlive the arc.
  /// @param target  positions that the arc ends at; receives the axes of its plane
  SiemensArc(const SiemensState& state, const SiemensBlock& block, const SiemensContext& context,
             const SiemensFrame& frame, SiemensTarget& target)
      : state_(state), block_(block), context_(context), frame_(frame), target_(target) {}

  /// Refuses words that do not go with the arc; sets its plane unless it passes through a point.
  void check_words();

  /// Plane, centre and turns of the arc to the target.
  /// @param out  receives them
  void read(MachineAction& out);

 private:
  [[noreturn]] void fail(int column, std::string message) const;
  [[noreturn]] void fail(std::string message) const { fail(block_.column, std::move(message)); }

  bool is_through_point() const { return *state_.motion == kThroughPoint; }
  void check_centre_words();
  void check_through_words() const;
  void refuse_rotary_axes() const;
  void refuse_new_length(int still) const;

  void read_about_centre(MachineAction& out);
  void read_through_point(MachineAction& out);
  Eigen::Vector2d start_in_plane() const;
  Eigen::Vector3d through_point(const Eigen::Vector3d& start) const;
  Eigen::Vector2d programmed_centre(const Eigen::Vector2d& start) const;
  Eigen::Vector2d centre_of_radius(const Eigen::Vector2d& start, const Eigen::Vector2d& end,
                                   bool is_clockwise) const;
  Eigen::Vector3d in_space(const Eigen::Vector2d& point) const;
  int turns_of(const Eigen::Vector2d& start, const Eigen::Vector2d& end,
               const Eigen::Vector2d& centre, bool is_clockwise) const;

  const SiemensState& state_;
  const SiemensBlock& block_;
  const SiemensContext& context_;
  const SiemensFrame& frame_;
  SiemensTarget& target_;
  int normal_axis_ = 2;
  int u_ = 0, v_ = 1;  // axes of the plane, in the order of its orientation
};

/// Refuses the words of CIP in a block without it.
void refuse_through_point(const SiemensState& state, const SiemensBlock& block,
                          const SiemensContext& context);

}  // namespace servomill::controllers
