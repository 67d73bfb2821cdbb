/// The reference that the NC gives to the servo loops: canonical moves as a function of time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "controllers/path/path_limits.h"
#include "controllers/path/smooth_path.h"
#include "controllers/path/time_law.h"
#include "plant/vocabulary/move_list.h"

namespace servomill::controllers {

class StoredChain;
struct TipMotions;  // controllers/path/tcp_motion.h

/// A planned program. Immutable; any number of readers, each with its own cursor.
class Trajectory {
 public:
  struct Sample {
    Joints Q_ref, dQ_ref, ddQ_ref, dddQ_ref;  // m, rad; per s, s^2, s^3
    double s = 0.0;                           // m, arc length on the path of the original program
    int line = 0;                             // of the original program
    std::size_t move = 0;                     // index of the move
    bool rapid = false;
  };

  struct Chain;

  /// Place of the last sample; makes forward reading O(1). Value-initialised: at the beginning.
  struct Cursor {
    std::size_t chain = 0, phase = 0, piece = 0, span = 0;
    std::shared_ptr<const Chain> read = {};  // of a long program: the chain, from the disk
    std::size_t read_chain = 0;              // its index
  };

  double duration() const { return duration_; }  ///< s
  const Joints& start() const { return start_; }
  const Joints& end() const { return end_; }

  /// Reference at time t (s). Before 0 it stands at the start, after the end at the end.
  /// Neither allocates nor throws but where the next stretch of a long program comes from the disk;
  /// reading backwards costs a search from the begin.
  Sample at(double t, Cursor& cursor) const;

  /// A part of the motion from rest to rest, a stretch of a long one (motion_stretches.h), or a
  /// dwell (without path).
  struct Chain {
    struct Span {  // one move on the path, or one chord of a move under tool control
      std::uint32_t move = 0;
      std::uint32_t first = 0, last = 0;  // vertices of the path
      std::uint32_t share = kWhole;       // of the move: index into shares
      int line = 0;
      double s_begin = 0.0, s_end = 0.0;  // m, of the move on the path of the original program
      bool rapid = false;
    };
    struct Share {
      double from = 0.0, to = 1.0;
    };
    static constexpr std::uint32_t kWhole = 0xffffffff;

    struct Plan {
      SmoothPath path;  // rotary joints times the rotary radius
      TimeLaw law;
    };

    double t = 0.0, duration = 0.0;    // s
    std::shared_ptr<const Plan> plan;  // shared by equal motions; nullptr: a dwell
    std::vector<Span> spans;
    std::vector<Share> shares;
    Joints begin, end;
    std::shared_ptr<const StoredChain> stored;  // plan, spans and shares, if they are not here

    double begin_of(const Span& span) const { return plan->path.s[span.first]; }  // m
    double end_of(const Span& span) const { return plan->path.s[span.last]; }     // m
    Share share_of(const Span& span) const {
      return span.share == kWhole ? Share{} : shares[span.share];
    }
  };
  std::size_t chains() const { return chains_.size(); }
  /// Complete; valid as long as both this and the pointer live.
  std::shared_ptr<const Chain> chain(std::size_t index) const;
  /// Phases and pieces in memory; those on the disk do not count.
  std::size_t weight() const;
  double rotary_radius() const { return rotary_radius_; }

 private:
  friend class Planner;
  const Chain& read(Cursor& c) const;

  Joints start_ = Joints::Zero(), end_ = Joints::Zero();
  double duration_ = 0.0, rotary_radius_ = 1.0;
  std::vector<Chain> chains_;
  Chain::Span first_, last_;  // of all chains
};

/// Plans the motion of a program: the joint targets are `layout.joints(move.end_machine)` or, of
/// moves under tool control, the chords of `tip`. The motion stops at the first and last move,
/// dwell, M0, M1, tool change, after G61.1 moves, between rapid and feed, between rotary-only and
/// other moves, at (moves under tool control count as such others, even where the tip stands), at
/// reversals (sharper than 120 degrees), at the corners of G61, and at corners of G64 that a stop
/// passes sooner than a rounding within the tolerance.
///
/// Laws: on every joint |dQ| <= v, |ddQ| <= a, |dddQ| <= j; the path speed of X Y Z (of the rotary
/// joints for rotary-only moves) never exceeds the feed; the path stays within the tolerance of the
/// programmed one; the end of the program is reached exactly, at rest.                       (1)
/// Under tool control the feed is that of the tip in the workpiece (of the rotation where the tip
/// stands), chord by chord.
/// A NC that needs time for each block (options.block_time) goes through none in less: where blocks
/// are shorter than that times the feed, the path speed is at most their length over it.
///
/// @param moves   canonical moves; feed and arc moves have feed > 0
/// @param start   joints before the first move (5; m, rad)
/// @param tip     of the same moves and start
/// @pre limits > 0 for the joints of the layout; tolerances and overrides > 0
Trajectory plan(const MoveRange& moves, const JointLayout& layout, const Joints& start,
                const JointLimits& limits, const PathOptions& options, const TipMotions& tip);
/// The same of moves without tool control.
Trajectory plan(const MoveRange& moves, const JointLayout& layout, const Joints& start,
                const JointLimits& limits, const PathOptions& options = {});

}  // namespace servomill::controllers
