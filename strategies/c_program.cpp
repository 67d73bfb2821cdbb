#include "strategies/c_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "plant/vocabulary/move_curve.h"
#include "plant/vocabulary/units.h"

namespace servomill::strategies {
namespace {

constexpr double kFarthest = 1e3;  // m, rad: beyond that no machine goes
constexpr double kSlowest = 1e-3;  // factors of the feed
constexpr double kFastest = 1e3;
constexpr double kRotaryTol = 1e-12;  // rad, rounding of positions on the way

std::int32_t kind_of(MoveKind kind) {
  switch (kind) {
    case MoveKind::rapid:
      return SERVOMILL_RAPID;
    case MoveKind::arc:
    case MoveKind::spline:
      return SERVOMILL_ARC;
    default:
      return SERVOMILL_LINE;
  }
}

AxisWords words_of(const JointLayout& layout, const double* Q) { return layout.words(Joints(Q)); }

// Each motion and where it begins, in machine coordinates.
template <class Visit>
void each_motion(const MoveRange& moves, const AxisWords& start, Visit visit) {
  AxisWords from = start;
  for (const Move& move : moves) {
    if (!is_motion(move.kind)) continue;
    visit(from, move);
    from = move.end_machine;
  }
}

}  // namespace

struct CProgram::Parts {
  struct Motion {
    AxisWords from;
    Move move;
  };
  JointLayout layout;
  std::vector<Motion> motions;
  std::vector<servomill_move> seen;
  std::vector<const servomill_move*> pointers;
  std::vector<servomill_block> blocks;
  servomill_program program{};

  static void position(const void* host, std::size_t motion, double share, double* Q) {
    const Parts& parts = *static_cast<const Parts*>(host);
    if (motion >= parts.motions.size() || !(share >= 0.0 && share <= 1.0)) {
      std::fill_n(Q, SERVOMILL_JOINTS, std::numeric_limits<double>::quiet_NaN());
      return;
    }
    const auto& [from, move] = parts.motions[motion];
    const Joints at = parts.layout.joints(MoveCurve(from, move).at(share));
    std::copy_n(at.data(), kJoints, Q);
  }

  // One more than there may be is kept, as a sign.
  static void add_block(void* host, const servomill_block* block) {
    Parts& parts = *static_cast<Parts*>(host);
    if (parts.blocks.size() > kMaxPluginBlocks) return;
    servomill_block one{};
    std::memcpy(&one, block, std::min(block->size, sizeof one));
    parts.blocks.push_back(one);
  }
};

CProgram::CProgram(const MoveRange& moves, const JointLayout& layout, const Joints& start)
    : parts_(new Parts{.layout = layout,
                       .motions = {},
                       .seen = {},
                       .pointers = {},
                       .blocks = {},
                       .program = {}}) {
  Parts& parts = *parts_;
  parts.motions.reserve(moves.size());
  parts.seen.reserve(moves.size());
  each_motion(moves, layout.words(start), [&](const AxisWords& from, const Move& move) {
    parts.motions.push_back({from, move});
    servomill_move one{};
    one.size = sizeof one;
    one.kind = kind_of(move.kind);
    one.line = move.line;
    const Joints end = layout.joints(move.end_machine);
    std::copy_n(end.data(), kJoints, one.end);
    one.s_begin = move.s_begin;
    one.s_end = move.s_end;
    one.feed = move.kind == MoveKind::rapid ? 0.0 : move.feed;
    parts.seen.push_back(one);
  });
  for (const servomill_move& one : parts.seen) parts.pointers.push_back(&one);
  servomill_program& program = parts.program;
  program.size = sizeof program;
  program.moves = parts.pointers.data();
  program.move_count = parts.pointers.size();
  std::copy_n(start.data(), kJoints, program.start);
  program.host = parts_.get();
  program.position = &Parts::position;
  program.add_block = &Parts::add_block;
}

CProgram::~CProgram() = default;

const servomill_program* CProgram::program() const { return &parts_->program; }

std::vector<servomill_block> CProgram::take_blocks() { return std::move(parts_->blocks); }

namespace {

// Puts blocks in place of motions, one motion after the other.
class Replacing {
 public:
  Replacing(const std::vector<servomill_block>& blocks, const JointLayout& layout,
            const Joints& start, bool displaces_rotary, const PutMove& put)
      : blocks_(blocks),
        layout_(layout),
        displaces_rotary_(displaces_rotary),
        put_(put),
        from_(layout.words(start)),
        at_(from_) {}

  // @return why a block cannot be; empty if all can
  std::string run(const MoveRange& moves) {
    for (const Move& move : moves) {
      if (!wrong_.empty()) break;
      if (is_motion(move.kind)) {
        replace(move);
      } else {
        put_(move);
      }
    }
    if (wrong_.empty() && next_ < blocks_.size()) {
      wrong_ = fmt::format("block {} refers to motion {} after motion {}, or to a missing motion",
                           next_ + 1, blocks_[next_].move, next_ > 0 ? blocks_[next_ - 1].move : 0);
    }
    return wrong_;
  }

 private:
  void replace(const Move& move) {
    const AxisWords from = std::exchange(from_, move.end_machine);
    const MoveCurve curve(from, move);
    const std::size_t motion = motion_++;
    if (next_ == blocks_.size() || blocks_[next_].move != motion) return leave(move, from);
    double share = 0.0;
    for (; next_ < blocks_.size() && blocks_[next_].move == motion; ++next_) {
      const servomill_block& block = blocks_[next_];
      wrong_ = wrong_with(block, share, curve);
      if (!wrong_.empty()) {
        wrong_ = fmt::format("block {} (line {}) {}", next_ + 1, move.line, wrong_);
        return;
      }
      add(move, curve, block, share);
      share = block.share;
    }
    if (share < 1.0) {
      wrong_ = fmt::format("the blocks of motion {} (line {}) end at a share of {:g}, expected 1",
                           motion, move.line, share);
    }
  }

  // A motion without blocks: the same end. A curve must begin where it did, too.
  void leave(const Move& move, const AxisWords& from) {
    const bool is_curve = move.kind == MoveKind::arc || move.kind == MoveKind::spline;
    if (is_curve && at_ != from) {
      wrong_ =
          fmt::format("the {} of line {} has no blocks, and the blocks before it end elsewhere",
                      move.kind == MoveKind::arc ? "arc" : "spline", move.line);
    }
    at_ = move.end_machine;
    put_(move);
  }

  std::string wrong_with(const servomill_block& block, double share_before,
                         const MoveCurve& curve) const {
    if (!(block.share > share_before && block.share <= 1.0)) {
      return fmt::format("ends at a share of {:g}, expected > {:g} and <= 1", block.share,
                         share_before);
    }
    if (!(block.feed_factor >= kSlowest && block.feed_factor <= kFastest)) {
      return fmt::format("has the feed factor {:g}, expected {:g} to {:g}", block.feed_factor,
                         kSlowest, kFastest);
    }
    const Joints programmed = layout_.joints(curve.at(block.share));
    for (int j = 0; j < kJoints; ++j) {
      if (!layout_.has(j)) continue;
      const char letter = layout_.letter_of(j);
      if (!std::isfinite(block.end[j])) {
        return fmt::format("ends at {} = {:g}, which is not finite", letter, block.end[j]);
      }
      if (std::abs(block.end[j]) > kFarthest) {
        return fmt::format("ends at {} = {:g} {}, implausible for any machine", letter,
                           block.end[j], j < kLinearJoints ? "m" : "rad");
      }
      const bool moves_rotary =
          j >= kLinearJoints && std::abs(block.end[j] - programmed[j]) > kRotaryTol;
      if (moves_rotary && !displaces_rotary_) {
        return fmt::format("displaces the rotary axis {}, contrary to its declaration", letter);
      }
    }
    return "";
  }

  void add(const Move& move, const MoveCurve& curve, const servomill_block& block,
           double share_before) {
    const auto s = [&](double share) {
      return share == 1.0 ? move.s_end : move.s_begin + share * (move.s_end - move.s_begin);
    };
    AxisWords end = words_of(layout_, block.end);
    const bool turns = (curve.at(1.0) - curve.at(0.0)).tail<3>().any();
    const bool stands = curve.length() == 0.0;
    // rotary axes alone keep their angular feed
    if (stands && turns) end.head<3>() = at_.head<3>();
    Move out = move;
    if (out.kind != MoveKind::rapid) out.kind = MoveKind::feed;
    out.spline.reset();
    // work offsets do not rotate here: what displaces the machine displaces the work coordinates
    out.end += end - out.end_machine;
    out.end_machine = end;
    out.s_begin = s(share_before);
    out.s_end = s(block.share);
    // F is in degrees where nothing moves; with blocks, X, Y and Z do
    const double unit = stands && !turns ? mm / deg : 1.0;
    out.feed *= unit * block.feed_factor;
    if (out.feed_mode == FeedMode::units_per_revolution) out.value *= unit * block.feed_factor;
    at_ = end;
    put_(out);
  }

  const std::vector<servomill_block>& blocks_;
  const JointLayout& layout_;
  bool displaces_rotary_;
  const PutMove& put_;
  AxisWords from_, at_;  // programmed, with blocks
  std::size_t motion_ = 0, next_ = 0;
  std::string wrong_;
};

}  // namespace

std::string put_with_blocks(const MoveRange& moves, const std::vector<servomill_block>& blocks,
                            const JointLayout& layout, const Joints& start, bool displaces_rotary,
                            const PutMove& put) {
  if (blocks.size() > kMaxPluginBlocks) {
    return fmt::format("adds more than {} blocks", kMaxPluginBlocks);
  }
  return Replacing(blocks, layout, start, displaces_rotary, put).run(moves);
}

}  // namespace servomill::strategies
