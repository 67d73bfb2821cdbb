#include "controllers/path/trajectory.h"

#include <algorithm>

#include "controllers/path/stored_chain.h"

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
  const double y = s - q.s;
  const Joints d1 = q.c1 + y * (q.c2 + q.c3 * (y / 2.0)), d2 = q.c2 + q.c3 * y;
  while (c.span > 0 && s < chain.begin_of(chain.spans[c.span])) --c.span;
  while (c.span + 1 < chain.spans.size() && s >= chain.end_of(chain.spans[c.span])) ++c.span;
  const Chain::Span& span = chain.spans[c.span];

  Sample out;
  out.Q_ref = q.c0 + y * (q.c1 + y * (q.c2 / 2.0 + q.c3 * (y / 6.0)));
  out.dQ_ref = d1 * v;
  out.ddQ_ref = d2 * (v * v) + d1 * a;
  out.dddQ_ref = q.c3 * (v * v * v) + d2 * (3.0 * v * a) + d1 * now.j;
  for (Joints* part : {&out.Q_ref, &out.dQ_ref, &out.ddQ_ref, &out.dddQ_ref}) {
    part->tail<kJoints - kLinearJoints>() /= rotary_radius_;
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

}  // namespace servomill::controllers
