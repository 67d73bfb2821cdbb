#include "strategies/gcode.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "plant/vocabulary/move_curve.h"
#include "strategies/compensation.h"

namespace servomill::strategies {
namespace {

const std::array<ParameterSpec, 3>& specs() {
  static const std::array<ParameterSpec, 3> kSpecs = {{
      {.name = "tolerance_um",
       .help = "chord tolerance of the rewritten blocks",
       .unit = "um",
       .default_text = "0.1",
       .min = 1e-3},
      {.name = "max_block_mm",
       .help = "largest length of a rewritten block",
       .unit = "mm",
       .default_text = "1",
       .min = 1e-3},
      kIterationsSpec,
  }};
  return kSpecs;
}

struct RewriteParams {
  Sign sign = Sign::correct;
  Iterations iterations = Iterations::one;
  double tolerance = 0.0;  // m
  double max_block = 0.0;  // m
};

// Displaces one programmed move after the other and appends the blocks that result.
class Rewriter {
 public:
  Rewriter(const Belief& belief, const RewriteParams& params, const AxisWords& start,
           std::vector<Move>& out)
      : belief_(belief), params_(params), out_(out), out_at_(start) {}

  void rewrite(const AxisWords& from, const Move& move) {
    move_ = &move;
    curve_ = MoveCurve(from, move);
    s_ = move.s_begin;
    if (move.kind == MoveKind::rapid) {
      // displaced at its end only: nothing is cut on the way
      emit(1.0, displaced(1.0));
    } else if (curve_.length() == 0.0 && (move.end_machine - from).tail<3>().any()) {
      // Rotary axes alone keep their angular feed: X, Y and Z wait where they are, and the next
      // move takes them to where they belong.
      AxisWords target = move.end_machine;
      target.head<3>() = out_at_.head<3>();
      emit(1.0, target);
    } else {
      cut();
    }
  }

 private:
  static constexpr int kMostSplits = 24;

  void cut() {
    const auto pieces = std::max<std::int64_t>(
        1, std::llround(std::ceil(curve_.length() / params_.max_block - 1e-9)));
    const double dt = 1.0 / static_cast<double>(pieces);
    AxisWords a = displaced(0.0);
    for (std::int64_t i = 0; i < pieces; ++i) {
      const double t0 = static_cast<double>(i) * dt;
      const double t1 = i + 1 == pieces ? 1.0 : static_cast<double>(i + 1) * dt;
      const AxisWords b = displaced(t1);
      split(t0, a, t1, b, kMostSplits);
      a = b;
    }
  }

  AxisWords displaced(double t) const {
    AxisWords p = curve_.at(t);
    p.head<3>() +=
        set_point_displacement(belief_, params_.sign, params_.iterations, belief_.layout.joints(p));
    return p;
  }

  // Halves [t0, t1] until the chord is within tolerance at a quarter, the half and three quarters.
  void split(double t0, const AxisWords& a, double t1, const AxisWords& b, int splits_left) {
    if (splits_left == 0 || chord_error(t0, a, t1, b) <= params_.tolerance) {
      emit(t1, b);
      return;
    }
    const double t = 0.5 * (t0 + t1);
    const AxisWords m = displaced(t);
    split(t0, a, t, m, splits_left - 1);
    split(t, m, t1, b, splits_left - 1);
  }

  double chord_error(double t0, const AxisWords& a, double t1, const AxisWords& b) const {
    double worst = 0.0;
    for (const double f : {0.25, 0.5, 0.75}) {
      const AxisWords off = displaced(t0 + f * (t1 - t0)) - (a + f * (b - a));
      worst = std::max(worst, off.head<3>().norm());
    }
    return worst;
  }

  void emit(double t, const AxisWords& target) {
    Move block = *move_;
    if (block.kind == MoveKind::arc) block.kind = MoveKind::feed;
    // work offsets do not rotate here: what displaces the machine displaces the work coordinates
    block.end += target - block.end_machine;
    block.end_machine = target;
    out_at_ = target;
    block.s_begin = s_;
    block.s_end = move_->s_begin + t * (move_->s_end - move_->s_begin);
    s_ = block.s_end;
    out_.push_back(block);
  }

  const Belief& belief_;
  const RewriteParams& params_;
  std::vector<Move>& out_;
  const Move* move_ = nullptr;
  AxisWords out_at_;  // displaced end of the block before
  MoveCurve curve_;
  double s_ = 0.0;
};

class RewrittenProgram final : public Strategy {
 public:
  RewrittenProgram(const Belief& belief, const RewriteParams& params)
      : belief_(belief), params_(params) {}

  bool rewrites() const override { return true; }

  std::vector<Move> rewrite(const std::vector<Move>& moves) const override {
    std::vector<Move> out;
    AxisWords at = belief_.layout.words(belief_.reference);
    Rewriter rewriter(belief_, params_, at, out);
    for (const Move& move : moves) {
      if (!is_motion(move.kind)) {
        out.push_back(move);
        continue;
      }
      rewriter.rewrite(at, move);
      at = move.end_machine;
    }
    return out;
  }

 private:
  Belief belief_;
  RewriteParams params_;
};

std::unique_ptr<Strategy> make(const Parameters& p, Sign sign, const Belief& belief) {
  RewriteParams params;
  params.sign = sign;
  params.iterations = iterations_of(p);
  params.tolerance = p.number("tolerance_um");
  params.max_block = p.number("max_block_mm");
  return std::make_unique<RewrittenProgram>(belief, params);
}

}  // namespace

Entry gcode_entry() {
  return {"gcode", "rewrites the program into short displaced blocks", specs(), make};
}

}  // namespace servomill::strategies
