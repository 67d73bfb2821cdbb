#include "strategies/gcode.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "plant/vocabulary/move_curve.h"
#include "strategies/pose_compensation.h"

namespace servomill::strategies {
namespace {

const std::array<ParameterSpec, 7>& specs() {
  static const std::array<ParameterSpec, 7> kSpecs = {{
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
      {.name = "tolerance_urad",
       .help = "axes = all: chord tolerance of the rotary axes",
       .unit = "urad",
       .default_text = "0.5",
       .min = 1e-3},
      {.name = "max_block_deg",
       .help = "axes = all: largest turn of a rotary axis in a rewritten block",
       .unit = "deg",
       .default_text = "1",
       .min = 1e-3},
      kIterationsSpec,
      kAxesSpec,
      kSingularSpec,
  }};
  return kSpecs;
}

struct RewriteParams {
  Sign sign = Sign::correct;
  Iterations iterations = Iterations::one;
  DisplacedAxes axes = DisplacedAxes::linear;
  double sigma_0 = 0.0;
  double tolerance = 0.0;       // m
  double max_block = 0.0;       // m
  double tolerance_turn = 0.0;  // rad
  double max_block_turn = 0.0;  // rad
};

// Displaces one programmed move after the other and appends the blocks that result.
class Rewriter {
 public:
  Rewriter(const Belief& belief, const RewriteParams& params, const AxisWords& start,
           std::vector<Move>& out)
      : belief_(belief),
        params_(params),
        all_(belief, params.iterations, params.sigma_0),
        out_(out),
        out_at_(start) {}

  void rewrite(const AxisWords& from, const Move& move) {
    move_ = &move;
    turn_ = displaces_all() ? (move.end_machine - from).tail<3>().cwiseAbs().maxCoeff() : 0.0;
    curve_ = MoveCurve(from, move);
    s_ = move.s_begin;
    if (move.kind == MoveKind::rapid) {
      // displaced at its end only: nothing is cut on the way
      emit(1.0, displaced(1.0));
    } else if (curve_.length() == 0.0 && (move.end_machine - from).tail<3>().any()) {
      // Rotary axes alone keep their angular feed: X, Y and Z wait where they are, and the next
      // move takes them to where they belong.
      AxisWords target = displaces_all() ? displaced(1.0) : move.end_machine;
      target.head<3>() = out_at_.head<3>();
      emit(1.0, target);
    } else {
      cut();
    }
  }

 private:
  static constexpr int kMostSplits = 24;

  bool displaces_all() const { return params_.axes == DisplacedAxes::all; }

  void cut() {
    const double blocks =
        std::max(curve_.length() / params_.max_block, turn_ / params_.max_block_turn);
    const auto pieces = std::max<std::int64_t>(1, std::llround(std::ceil(blocks - 1e-9)));
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
    const Joints Q = belief_.layout.joints(p);
    if (displaces_all()) {
      p += belief_.layout.words(all_.of_set_point(params_.sign, Q));
    } else {
      p.head<3>() += set_point_displacement(belief_, params_.sign, params_.iterations, Q);
    }
    return p;
  }

  // Halves [t0, t1] until the chord is within tolerance at a quarter, the half and three quarters.
  void split(double t0, const AxisWords& a, double t1, const AxisWords& b, int splits_left) {
    if (splits_left == 0 || is_within_tolerance(t0, a, t1, b)) {
      emit(t1, b);
      return;
    }
    const double t = 0.5 * (t0 + t1);
    const AxisWords m = displaced(t);
    split(t0, a, t, m, splits_left - 1);
    split(t, m, t1, b, splits_left - 1);
  }

  bool is_within_tolerance(double t0, const AxisWords& a, double t1, const AxisWords& b) const {
    for (const double f : {0.25, 0.5, 0.75}) {
      const AxisWords off = displaced(t0 + f * (t1 - t0)) - (a + f * (b - a));
      if (off.head<3>().norm() > params_.tolerance) return false;
      if (displaces_all() && off.tail<3>().norm() > params_.tolerance_turn) return false;
    }
    return true;
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
  PoseCompensation all_;
  std::vector<Move>& out_;
  const Move* move_ = nullptr;
  AxisWords out_at_;  // displaced end of the block before
  MoveCurve curve_;
  double turn_ = 0.0;  // rad, of the rotary axis that turns most; 0 where none is displaced
  double s_ = 0.0;
};

class RewrittenProgram final : public Strategy {
 public:
  RewrittenProgram(const Belief& belief, const RewriteParams& params)
      : belief_(belief), params_(params) {}

  bool rewrites() const override { return true; }
  bool displaces_rotary() const override { return params_.axes == DisplacedAxes::all; }
  std::optional<Leftover> uncorrectable(const Joints& Q) const override {
    return strategies::uncorrectable(belief_, params_.sign, params_.axes, params_.sigma_0, Q);
  }

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
  params.axes = displaced_axes_of(p);
  params.sigma_0 = std::sin(p.number("singular_deg"));
  params.tolerance_turn = p.number("tolerance_urad");
  params.max_block_turn = p.number("max_block_deg");
  return std::make_unique<RewrittenProgram>(belief, params);
}

}  // namespace

Entry gcode_entry() {
  return {"gcode", "rewrites the program into short displaced blocks", specs(), make};
}

}  // namespace servomill::strategies
