/// The position control that a recording was made with, as its own NC computed it: sampled, P over
/// P or PI. For the cascade of our NC (controllers/servo/cascade.h), whose rates and delays other
/// controls do not share, see nc_loop.h.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "controllers/servo/filters.h"
#include "plant/vocabulary/lanes.h"

namespace servomill::sim::identification {

/// Source of the speed of the velocity loop.
enum class SpeedFeedback : std::uint8_t { scale, motor };

/// Source of the position that the position loop reads.
enum class PositionSource : std::uint8_t { scale, motor };

enum class LoopKind : std::uint8_t {
  open,     // the recorded force drives the axis
  cascade,  // position loop P, velocity loop P or PI
  nc,       // the loops of the machine's own NC, with all their functions
};

/// Constant description of the loop. With q the command and y the feedback of an axis,
///
///   v_cmd = Kv (q - y) + kvf dq/dt
///   v     = (m(n) - m(n - 1)) / period,  m the mean of the last `mean_of` samples of y, or of the
///           position of the motor, seen at the slide
///   F     = Kp (v_cmd - v + 1/Tn integral of the same) + kaf ddq/dt^2,  limited to +-F_max,
///           filtered, limited again
///
/// and F acts from `dead_time` after the sample on, held until the next one acts. Recorded are
/// y(t - feedback_delay) + feedback_offset and, where it drives the axis, F + force_offset.
struct LoopSettings {
  LoopKind kind = LoopKind::cascade;
  double period = 1e-3;  // s
  double Kv = 0.0;       // 1/s
  double Kp = 0.0;       // N s/m or N m s/rad: force per speed error, at the slide
  double Tn = std::numeric_limits<double>::infinity();     // s, reset time
  double kvf = 0.0;                                        // -, velocity feed-forward
  double kaf = 0.0;                                        // kg or kg m^2
  double F_max = std::numeric_limits<double>::infinity();  // N or N m
  double dead_time = 0.0;                                  // s
  double feedback_delay = 0.0, feedback_offset = 0.0;      // s, m or rad: of the recorder
  double force_offset = 0.0;                               // N or N m: of the recorded force
  controllers::FilterChain filters = {};                   // of the force
  int mean_of = 1;                                         // samples
  SpeedFeedback speed_feedback = SpeedFeedback::scale;
  PositionSource position_feedback = PositionSource::scale;
};

/// Most samples in the mean of the feedback.
inline constexpr int kMaxMeanOf = 16;
/// Longest dead time, in periods.
inline constexpr double kLongestDeadTime = 8.0;

/// Eight such loops side by side.
class SampledLoop {
 public:
  /// @param lanes  one setting a lane, of one kind and period; up to eight
  explicit SampledLoop(const std::vector<LoopSettings>& lanes);

  /// Has moved at `speed` (m/s) before the first sample, then at `position` (m or rad).
  /// @param force  that the first sample gives, as it was recorded (N); NaN: not known
  void start(std::size_t lane, double position, double speed, double force);

  /// Force of the next sample, computed from the feedback (eight lanes).
  /// @param q, dq, ddq  command with its derivatives (m, m/s, m/s^2)
  /// @param motor       position of the motor, seen at the slide (m)
  void sample(double q, double dq, double ddq, const LaneArray& feedback, const LaneArray& motor);
  /// The same where the force is given (LoopKind::open).
  void force_sample(const LaneArray& force);

  /// Force that was computed last (N).
  const LaneArray& force() const { return latest_; }
  /// Divides a period into so many equal parts, for acting().
  void set_parts(int parts);
  /// Mean of the force that acts within a part of the period after the sample.
  LaneArray acting(int part) const;

 private:
  void remember(const LaneArray& force);

  std::vector<LoopSettings> lanes_;
  std::array<LaneArray, kMaxMeanOf + 1> past_readings_{};  // ring, of the speed feedback
  std::size_t newest_ = 0;
  LaneArray integral_{}, first_force_{};
  std::array<controllers::FilterState, kLaneWidth> filters_{};
  std::array<LaneArray, static_cast<std::size_t>(kLongestDeadTime) + 2> past_{};  // newest first
  LaneArray latest_{};
  // weight of past_[n] in a part of the period: part after part
  struct Share {
    std::size_t part, n;
    LaneArray weight;
  };
  std::vector<Share> shares_;
  bool first_ = true;
};

}  // namespace servomill::sim::identification
