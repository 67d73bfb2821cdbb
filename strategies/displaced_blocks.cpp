#include "strategies/displaced_blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "plant/kinematics/inverse.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "strategies/linearisation.h"
#include "strategies/programmed_way.h"
#include "strategies/turning_points.h"

namespace servomill::strategies {
namespace {

// Displaces one programmed move after the other and hands out the blocks that result.
class Rewriter {
 public:
  Rewriter(const IdentifiedMachine& identified, const BlockLimits& limits,
           PointDisplacement& displacement, const PutMove& put)
      : identified_(identified),
        limits_(limits),
        displacement_(displacement),
        inverse_(nominal_inverse(identified)),
        put_(put),
        Q_(identified.reference),
        out_at_(identified.layout.words(identified.reference)) {}

  void rewrite(const Move& move) {
    const ProgrammedWay way(inverse_, identified_.p_ST, Q_, move);
    move_ = &move;
    way_ = &way;
    s_ = move.s_begin;
    t_ = 0.0;
    if (way.controls_tip()) {
      cut();
    } else if (move.kind == MoveKind::rapid || move.synchronised != Synchronised::no) {
      // displaced at its end only: nothing is cut on the way, or the spindle turns with the whole
      reach(place(1.0, Q_));
    } else if (way.length() == 0.0 && way.turn().any()) {
      // Rotary axes alone keep their angular feed: X, Y and Z wait where they are, and the next
      // move takes them to where they belong.
      Place target = place(1.0, Q_);
      if (!limits_.turns) target.words = move.end_machine;
      target.words.head<3>() = out_at_.head<3>();
      reach(target);
    } else {
      cut();
    }
    Q_ = way.end();
  }

 private:
  static constexpr int kMaxSplits = 24;

  struct Place {
    double t = 0.0;   // of the move
    Joints Q;         // as programmed
    AxisWords words;  // displaced
    PointDisplacement::At off;
  };

  void cut() {
    const bool minds_turn = limits_.turns || way_->controls_tip();
    const double turn = minds_turn ? way_->turn().cwiseAbs().maxCoeff() : 0.0;
    const double blocks =
        std::max(way_->length() / limits_.max_block, turn / limits_.max_block_turn);
    const auto pieces = std::max<std::int64_t>(1, std::llround(std::ceil(blocks - 1e-9)));
    const double dt = 1.0 / static_cast<double>(pieces);
    Place a = place(0.0, Q_);
    for (std::int64_t i = 0; i < pieces; ++i) {
      throw_if_interrupted();
      const double end = i + 1 == pieces ? 1.0 : static_cast<double>(i + 1) * dt;
      for (const double t : ends_of_pieces(a, end)) {
        const Place b = place(t, a.Q);
        split(a, b, kMaxSplits);
        travel(b);
        a = b;
      }
    }
  }

  // Shares of the way at which an axis with hysteresis reverses, and the end. A straight move
  // reverses an axis, too, where its correction does.
  std::vector<double> ends_of_pieces(const Place& a, double end) const {
    constexpr double kTurn = 0.25 * std::numbers::pi, kWave = 0.5 * mm;
    const double share = end - a.t;
    const double steps = std::max(way_->sweep() / kTurn, way_->length() / kWave) * share;
    std::vector<double> out;
    for (const plant::Play& play : displacement_.plays()) {
      const auto x = [&](double t) {
        return displacement_.travelled(way_->at(t, a.Q), play.joint);
      };
      const auto turns = turning_points(x, a.t, end, std::max(4, static_cast<int>(steps)));
      out.insert(out.end(), turns.begin(), turns.end());
    }
    std::sort(out.begin(), out.end());
    constexpr double kSame = 1e-6;
    double before = a.t;
    std::erase_if(out, [&](double t) {
      const bool is_same = std::min(t - before, end - t) < kSame * share;
      if (!is_same) before = t;
      return is_same;
    });
    out.push_back(end);
    return out;
  }

  double s_at(double t) const { return move_->s_begin + t * (move_->s_end - move_->s_begin); }

  Place place(double t, const Joints& Q_near) const {
    Place out{t, way_->at(t, Q_near), {}, {}};
    out.off = displacement_.at(out.Q, s_at(t));
    out.words = identified_.layout.words(out.Q) + out.off.d;
    return out;
  }

  void travel(const Place& target) {
    const AxisWords d = target.words - identified_.layout.words(target.Q);
    displacement_.travel(target.Q, {d, target.off.step});
  }

  void reach(const Place& target) {
    travel(target);
    emit(target);
  }

  // Halves the way from a to b until the chord is within tolerance at a quarter, the half and three
  // quarters.
  void split(const Place& a, const Place& b, int splits_left) {
    const Place middle = place(0.5 * (a.t + b.t), a.Q);
    const bool is_within = is_within_tolerance(a, middle, b) || is_step(a, b);
    if (splits_left == 0 || is_within) {
      // a rapid may turn where it stands: it cuts nothing
      if (!is_within && way_->controls_tip() && move_->kind != MoveKind::rapid) {
        throw InputError({{}, move_->line, 0},
                         "cannot be rewritten: the rotary axes jump within the move, in a singular "
                         "direction of the tool axis");
      }
      emit(b);
      return;
    }
    split(a, middle, splits_left - 1);
    split(middle, b, splits_left - 1);
  }

  // Lost motion is taken up at once, where an axis reverses.
  bool is_step(const Place& a, const Place& b) const {
    return (b.t - a.t) * way_->length() < limits_.tolerance &&
           (b.off.step - a.off.step).norm() > limits_.tolerance;
  }

  // @param middle  where the way is halved; without tip control it is that of the chord, too,
  //                whatever is near
  bool is_within_tolerance(const Place& a, const Place& middle, const Place& b) const {
    const bool minds_turn = limits_.turns || way_->controls_tip();
    for (const double f : {0.5, 0.25, 0.75}) {  // the chord mostly is farthest in its middle
      const double t = a.t + f * (b.t - a.t);
      const bool is_middle = t == middle.t && !way_->controls_tip();
      const AxisWords words = is_middle ? middle.words : place(t, a.Q + f * (b.Q - a.Q)).words;
      const AxisWords off = words - (a.words + f * (b.words - a.words));
      if (off.head<3>().norm() > limits_.tolerance) return false;
      if (minds_turn && off.tail<3>().norm() > limits_.tolerance_turn) return false;
    }
    return true;
  }

  void emit(const Place& target) {
    Move block = *move_;
    if (block.kind != MoveKind::rapid) block.kind = MoveKind::feed;
    block.spline.reset();
    // work offsets do not rotate here: what displaces the machine displaces the work coordinates
    block.end += target.words - block.end_machine;
    block.end_machine = target.words;
    block.s_begin = s_;
    block.s_end = s_at(target.t);
    if (way_->controls_tip()) {
      leave_tip_control(block, target.t - t_);
    } else if (way_->length() == 0.0 && !way_->turn().any()) {
      take_linear_feed(block);
    }
    out_at_ = target.words;
    s_ = block.s_end;
    t_ = target.t;
    put_(block);
  }

  // A move that stands has F in degrees; displaced, X, Y and Z go where the one before left them.
  static void take_linear_feed(Move& block) {
    block.feed *= mm / deg;
    if (block.feed_mode == FeedMode::units_per_revolution) block.value *= mm / deg;
  }

  // A block of the axes that takes the time of its share of the move.
  void leave_tip_control(Move& block, double share) const {
    block.tool_control = ToolControl::none;
    block.tool_offset = 0;
    block.plane.reset();
    if (block.kind == MoveKind::rapid) return;
    block.feed_mode = FeedMode::inverse_time;
    // its feed is that of the tip along s, or nothing moves
    if (block.s_end > block.s_begin || way_->angle() == 0.0) return;
    const double turned = (block.end_machine - out_at_).tail<3>().norm();
    block.feed = turned * move_->feed / (share * way_->angle());
  }

  const IdentifiedMachine& identified_;
  const BlockLimits& limits_;
  PointDisplacement& displacement_;
  plant::InverseKinematics inverse_;
  const PutMove& put_;
  Joints Q_;  // as programmed, where the move begins
  const Move* move_ = nullptr;
  const ProgrammedWay* way_ = nullptr;
  AxisWords out_at_;  // displaced end of the block before
  double s_ = 0.0, t_ = 0.0;
};

// Before the work: a program in blocks of a micrometre is a slip. So many blocks take some 15 GB of
// temporary files with their plan, 0.5 GB of memory, and minutes.
void refuse_too_many(const MoveRange& moves, const BlockLimits& limits) {
  constexpr double kMaxBlocks = 5e7;
  double blocks = 0.0;
  for (const Move& move : moves) {
    if (move.kind != MoveKind::rapid) blocks += (move.s_end - move.s_begin) / limits.max_block;
  }
  if (blocks <= kMaxBlocks) return;
  throw TooManyBlocks(fmt::format("max_block_mm = {:g} gives {:.2g} blocks; must be <= {:.2g}",
                                  limits.max_block / mm, blocks, kMaxBlocks));
}

}  // namespace

const std::array<ParameterSpec, 4> kBlockSpecs = {{
    {.name = "tolerance_um",
     .help = "chord tolerance of the rewritten blocks",
     .unit = "um",
     .default_text = "0.1",
     .min = 1e-3,
     .shortcoming = Shortcoming::chord_tolerance},
    {.name = "max_block_mm",
     .help = "maximum length of a rewritten block",
     .unit = "mm",
     .default_text = "1",
     .min = 1e-3,
     .shortcoming = Shortcoming::block_length},
    {.name = "tolerance_urad",
     .help = "with axes = all: chord tolerance of the rotary axes",
     .unit = "urad",
     .default_text = "0.5",
     .min = 1e-3,
     .shortcoming = Shortcoming::chord_tolerance},
    {.name = "max_block_deg",
     .help = "with axes = all: maximum rotation of a rotary axis in a rewritten block",
     .unit = "deg",
     .default_text = "1",
     .min = 1e-3,
     .shortcoming = Shortcoming::block_length},
}};

BlockLimits block_limits_of(const Parameters& p) {
  BlockLimits out;
  out.tolerance = p.number("tolerance_um");
  out.max_block = p.number("max_block_mm");
  out.tolerance_turn = p.number("tolerance_urad");
  out.max_block_turn = p.number("max_block_deg");
  return out;
}

void put_displaced_blocks(const MoveRange& moves, const IdentifiedMachine& identified,
                          const BlockLimits& limits, PointDisplacement& displacement,
                          const PutMove& put) {
  refuse_too_many(moves, limits);
  Rewriter rewriter(identified, limits, displacement, put);
  for (const Move& move : moves) {
    throw_if_interrupted();
    if (is_motion(move.kind)) {
      rewriter.rewrite(move);
    } else {
      put(move);
    }
  }
}

}  // namespace servomill::strategies
