#include "controllers/path/motion_stretches.h"

#include <utility>

#include "controllers/path/smooth_path.h"

namespace servomill::controllers {

using Chain = Trajectory::Chain;

std::optional<Chain> MotionStretches::add(CollectedMotion motion) {
  Stretch next;
  next.plan = std::make_shared<Chain::Plan>();
  next.plan->path = smooth(std::move(motion.vertices), limits_.j);
  next.plan->path.pieces.shrink_to_fit();
  next.speeds = std::move(motion.speeds);
  next.shares = std::move(motion.shares);
  next.limits = limits_along(next.plan->path, next.speeds, limits_, options_);
  std::optional<Chain> before;
  if (waiting_) {
    std::vector<SegmentLimits> ahead = waiting_->limits;
    const double seam = waiting_->plan->path.length();
    for (SegmentLimits stretch : next.limits) {
      stretch.end += seam;
      ahead.push_back(stretch);
    }
    auto law = plan_speed_through(ahead, waiting_->v_begin, seam);
    if (law) {
      next.v_begin = law->speed;
      next.to_rest = std::move(law->behind);
      before = take(std::move(law->before), law->speed);
    } else {
      before = take(std::move(waiting_->to_rest), 0.0);
    }
  }
  waiting_ = std::move(next);
  return before;
}

Chain MotionStretches::finish() {
  auto law = plan_speed(waiting_->limits, {waiting_->v_begin, 0.0});
  Chain last = take(law ? *std::move(law) : std::move(waiting_->to_rest), 0.0);
  waiting_.reset();
  return last;
}

Chain MotionStretches::take(TimeLaw law, double v_end) {
  Stretch& stretch = *waiting_;
  stretch.plan->law = refined_law(std::move(law), stretch.plan->path, stretch.speeds, limits_,
                                  options_, stretch.limits, {stretch.v_begin, v_end});
  Chain chain;
  chain.duration = stretch.plan->law.duration;
  chain.plan = std::move(stretch.plan);
  chain.spans.assign(stretch.speeds.spans.begin(), stretch.speeds.spans.end());
  chain.shares = std::move(stretch.shares);
  return chain;
}

}  // namespace servomill::controllers
