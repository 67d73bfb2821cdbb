/// Account of the time of a planned program: by kind of motion, limit, tool, section and line.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "controllers/path/active_limits.h"
#include "sim/programs/program_duration.h"

namespace servomill::sim::programs {

/// Time of motion (s) by the limit that bounds it.
class LimitTimes {
 public:
  void add(const controllers::MotionStretch& stretch);
  void add(const LimitTimes& other);
  /// @param joint  -1: of limits that are not those of a joint
  double of(controllers::LimitKind kind, int joint) const;
  double of(controllers::LimitKind kind) const;  ///< of all joints together

 private:
  // the first column is of none of the joints
  std::array<std::array<double, kJoints + 1>, controllers::kLimitKinds> by_{};
};

/// Time and travel of a program or a part of it.
struct TimeShare {
  double feed = 0.0, rapid = 0.0, dwell = 0.0;   // s
  double feed_travel = 0.0, rapid_travel = 0.0;  // m
  double at_feed = 0.0;  // s, feed motion at the programmed feeds alone, feed override applied
  LimitTimes limits;

  double time() const { return feed + rapid + dwell; }
};

/// The same of one line, shorter: a program may have millions.
struct LineTime {
  double time = 0.0;        // s
  double feed_time = 0.0;   // s, that of feed motion
  double travel = 0.0;      // m
  double at_feed = 0.0;     // s
  float limit_time = 0.0F;  // s, of the limit that bounds its moves for longest
  controllers::LimitKind limit = controllers::LimitKind::none;
  std::int8_t joint = -1;
  std::uint32_t tool = 0;  // the last
  std::uint32_t section = 0;
};

/// Times of a program, and events whose time planning does not know.
struct TimeAccounts {
  static constexpr int kNoTool = -1;  // before the first M6

  TimeShare total;
  std::map<int, TimeShare> tools;
  std::vector<std::pair<std::string, TimeShare>> sections;  // in their order; "" before the first
  std::vector<std::vector<LineTime>> lines;                 // by file and number of the line
  int tool_changes = 0;                                     // to another tool
  int spindle_changes = 0;                                  // starts, stops and changes of speed
  int stops = 0;                                            // M0, M1, M60
  int synchronised = 0;                                     // moves that the spindle turns with
  int probings = 0;                                         // G38.2 ... G38.5
};

/// Books the parts of one program, in their order.
class TimeAccountant {
 public:
  TimeAccountant(const JointLayout& layout, const controllers::JointLimits& limits,
                 const controllers::PathOptions& options);

  void add(const PlannedPart& part);
  const TimeAccounts& accounts() const { return out_; }
  TimeAccounts take() { return std::move(out_); }

 private:
  class Part;
  void note(const Move& move);
  void book_travel(const Move& move, std::uint16_t file);
  double length_of(const Move& move) const;
  LineTime& line_of(const Move& move, std::uint16_t file);

  const JointLayout& layout_;
  controllers::JointLimits limits_;
  controllers::PathOptions options_;
  TimeAccounts out_;
  int tool_ = TimeAccounts::kNoTool;
  std::size_t section_ = 0;
  std::pair<int, double> spindle_ = {0, 0.0};  // direction, rad/s
  AxisWords at_ = AxisWords::Zero();           // machine coordinates
  bool controls_tip_ = false;                  // then X Y Z of `at_` are the tip
};

}  // namespace servomill::sim::programs
