#include "controllers/path/trajectory.h"

#include <algorithm>

#include "controllers/path/stored_chain.h"
#include "controllers/path/tcp_motion.h"

namespace servomill::controllers {

namespace {

Trajectory::Sample rest(const Joints& Q) {
  Trajectory::Sample out;
  out.Q_ref = Q;
  out.dQ_ref = out.ddQ_ref = out.dddQ_ref = Joints::Zero();
  return out;
}

Trajectory::Sample rest(const Joints& Q, const Trajectory::Chain::Span& at, double s) {
  Trajectory::Sample out = rest(Q);
  out.s = s;
  out.line = at.line;
  out.move = at.move;
  out.rapid = at.rapid;
  return out;
}

// Joints kBegin to kEnd - 1 at y (m) behind the begin of a piece, with speed v, acceleration a and
// jerk j along the path. Numbers one by one: four of them are two vectors of the processor, five a
// call of a function each.
template <std::size_t kBegin, std::size_t kEnd>
void evaluate(const CubicPiece& q, double y, double v, double a, double j,
              Trajectory::Sample& out) {
  const double *c0 = q.c0.data(), *c1 = q.c1.data(), *c2 = q.c2.data(), *c3 = q.c3.data();
  double *Q = out.Q_ref.data(), *dQ = out.dQ_ref.data(), *ddQ = out.ddQ_ref.data(),
         *dddQ = out.dddQ_ref.data();
  for (std::size_t i = kBegin; i < kEnd; ++i) {
    const double d1 = c1[i] + y * (c2[i] + c3[i] * (y / 2.0)), d2 = c2[i] + c3[i] * y;
    Q[i] = c0[i] + y * (c1[i] + y * (c2[i] / 2.0 + c3[i] * (y / 6.0)));
    dQ[i] = d1 * v;
    ddQ[i] = d2 * (v * v) + d1 * a;
    dddQ[i] = c3[i] * (v * v * v) + d2 * (3.0 * v * a) + d1 * j;
  }
}

}  // namespace

std::shared_ptr<const Trajectory::Chain> Trajectory::chain(std::size_t index) const {
  const Chain& chain = chains_[index];
  if (chain.stored != nullptr) return chain.stored->read();
  return {std::shared_ptr<void>(), &chain};
}

std::size_t Trajectory::weight() const {
  std::size_t weight = 0;
  for (const Chain& chain : chains_) {
    if (chain.plan == nullptr) continue;
    weight += chain.plan->law.phases.size() + chain.plan->path.pieces.size();
  }
  return weight;
}

const Trajectory::Chain& Trajectory::read(Cursor& c) const {
  const Chain& chain = chains_[c.chain];
  if (chain.stored == nullptr) return chain;
  if (c.read == nullptr || c.read_chain != c.chain) {
    c.read = chain.stored->read();
    c.read_chain = c.chain;
  }
  return *c.read;
}

Trajectory::Sample Trajectory::at(double t, Cursor& c) const {
  if (chains_.empty()) return rest(start_);
  if (t <= 0.0) return rest(start_, first_, first_.s_begin);
  if (t >= duration_) return rest(end_, last_, last_.s_end);
  if (c.chain >= chains_.size() || t < chains_[c.chain].t) c = {};
  while (c.chain + 1 < chains_.size() && t >= chains_[c.chain + 1].t) {
    ++c.chain;
    c.phase = c.piece = c.span = 0;
  }
  const Chain& chain = read(c);
  if (chain.plan == nullptr) {
    return rest(chain.begin, chain.spans.front(), chain.spans.front().s_begin);
  }

  // position on the path
  const double time = t - chain.t;
  const std::vector<Phase>& phases = chain.plan->law.phases;
  if (time < phases[c.phase].t) c.phase = c.piece = c.span = 0;
  while (c.phase + 1 < phases.size() && time >= phases[c.phase + 1].t) ++c.phase;
  const Phase& p = phases[c.phase];
  const Phase::State now = p.at(time);
  const double s = std::clamp(now.s, 0.0, chain.plan->path.length());
  const double v = std::max(now.v, 0.0), a = now.a;

  // the path there
  const std::vector<CubicPiece>& pieces = chain.plan->path.pieces;
  while (c.piece > 0 && s < pieces[c.piece].s) --c.piece;
  while (c.piece + 1 < pieces.size() && s >= pieces[c.piece + 1].s) ++c.piece;
  const CubicPiece& q = pieces[c.piece];
  while (c.span > 0 && s < chain.begin_of(chain.spans[c.span])) --c.span;
  while (c.span + 1 < chain.spans.size() && s >= chain.end_of(chain.spans[c.span])) ++c.span;
  const Chain::Span& span = chain.spans[c.span];

  Sample out;
  evaluate<0, 4>(q, s - q.s, v, a, now.j, out);
  evaluate<4, kJoints>(q, s - q.s, v, a, now.j, out);
  for (Joints* part : {&out.Q_ref, &out.dQ_ref, &out.ddQ_ref, &out.dddQ_ref}) {
    auto rotary = part->tail<kJoints - kLinearJoints>();
    if (!rotary.isZero(0.0)) rotary /= rotary_radius_;  // a division takes as long as all the rest
  }
  const double s_begin = chain.begin_of(span), s_end = chain.end_of(span);
  const double x = std::clamp((s - s_begin) / (s_end - s_begin), 0.0, 1.0);
  const auto [from, to] = chain.share_of(span);
  const double f = from + x * (to - from);
  out.s = span.s_begin + f * (span.s_end - span.s_begin);
  out.line = span.line;
  out.move = span.move;
  out.rapid = span.rapid;
  return out;
}

Trajectory plan(const MoveRange& moves, const JointLayout& layout, const Joints& start,
                const JointLimits& limits, const PathOptions& options) {
  return plan(moves, layout, start, limits, options, {});
}

}  // namespace servomill::controllers
