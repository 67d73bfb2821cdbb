#include "controllers/path/collected_motion.h"

#include <algorithm>

namespace servomill::controllers {

using Span = ChainSpeeds::Span;
using Share = Trajectory::Chain::Share;

namespace {

// A part of a span, whose own feed, share and time are copied.
void copy_part(const CollectedMotion& from, Span span, const Share& part, CollectedMotion& to) {
  span.feed = to.speeds.index_of(from.speeds.feeds[span.feed]);
  const bool is_whole = span.share == Trajectory::Chain::kWhole;
  if (is_whole && part.from == 0.0 && part.to == 1.0) {
    to.speeds.spans.push_back(span);
    return;
  }
  const Share whole = is_whole ? Share{} : from.shares[span.share];
  const double width = whole.to - whole.from;
  const double time = is_whole ? 0.0 : from.speeds.times[span.share];
  span.share = static_cast<std::uint32_t>(to.shares.size());
  to.speeds.spans.push_back(span);
  to.speeds.times.push_back(time * (part.to - part.from));
  to.shares.push_back(
      {whole.from + width * part.from, part.to == 1.0 ? whole.to : whole.from + width * part.to});
}

// Share of a span that ends in the middle of a chord.
double share_before(const Polyline& vertices, const Span& span, std::size_t chord) {
  double before = 0.0, length = 0.0;
  for (std::size_t k = span.first; k < span.last; ++k) {
    const double l = (vertices.u(k + 1) - vertices.u(k)).norm();
    length += l;
    before += k < chord ? l : k == chord ? 0.5 * l : 0.0;
  }
  return before / length;
}

PathVertex vertex_of(const Polyline& vertices, std::size_t i) {
  const Polyline::Traits& traits = vertices.traits(i);
  return {vertices.u(i), traits.tolerance_linear, traits.tolerance_rotary, vertices.speed(i),
          traits.arc,    traits.is_exact};
}

// A vertex that stays where it is, so that the chord at it keeps its direction.
PathVertex fixed_vertex_of(const Polyline& vertices, std::size_t i) {
  PathVertex vertex = vertex_of(vertices, i);
  vertex.arc = -1;
  return vertex;
}

}  // namespace

void CollectedMotion::start_at(const Joints& u) {
  vertices.clear();
  vertices.push_back(PathVertex{u, 0.0, 0.0, 0.0, -1});
  speeds.clear();
  shares.clear();
}

Span CollectedMotion::begin_span(const Move& move, std::size_t index) const {
  Span span;
  span.move = static_cast<std::uint32_t>(index);
  span.first = last_vertex();
  span.line = move.line;
  span.s_begin = move.s_begin;
  span.s_end = move.s_end;
  span.rapid = move.kind == MoveKind::rapid;
  return span;
}

void CollectedMotion::end_part(Span span, double from, double to, double time) {
  span.share = static_cast<std::uint32_t>(shares.size());
  span.last = last_vertex();
  speeds.spans.push_back(span);
  speeds.times.push_back(time);
  shares.push_back({from, to});
}

void CollectedMotion::end_at(const PathVertex& end, Span last) {
  if (speeds.spans.empty()) {
    last.first = 0;
    last.share = Trajectory::Chain::kWhole;
    last.feed = speeds.index_of(FeedLimit{});
    speeds.spans.push_back(last);
  }
  vertices.push_back(end);
  speeds.spans.back().last = last_vertex();
  if (speeds.spans.back().share != Trajectory::Chain::kWhole) shares.back().to = 1.0;
}

// A window may reach to the seam: half of the chord. With the turn dd at its vertex the third
// derivative there is dd/w^2, by which the jerk limits the cube of the speed (smooth_path.h).
std::optional<std::size_t> CollectedMotion::seam() const {
  std::optional<std::size_t> best;
  double most = 0.0;
  const auto direction = [&](std::size_t k) -> Joints {
    return (vertices.u(k + 1) - vertices.u(k)).normalized();
  };
  for (std::size_t k = vertices.size() / 2; k + 2 < vertices.size(); ++k) {
    if (vertices.traits(k + 1).is_exact) continue;
    const double length = (vertices.u(k + 1) - vertices.u(k)).norm();
    const Joints d = direction(k);
    const double turn = std::max((d - direction(k - 1)).norm(), (direction(k + 1) - d).norm());
    // The longest chord with the least turn at its ends wins; turns within rounding count as none.
    constexpr double kStraight = 1e-9;
    const double worth = length * length / std::max(turn, kStraight);
    if (worth <= most) continue;
    most = worth;
    best = k;
  }
  return best;
}

CollectedMotion CollectedMotion::take_before(std::size_t chord) {
  const auto k = static_cast<std::uint32_t>(chord);
  PathVertex middle = fixed_vertex_of(vertices, chord + 1);
  middle.u = 0.5 * (vertices.u(chord) + vertices.u(chord + 1));
  CollectedMotion before, behind;
  for (std::size_t i = 0; i < chord; ++i) before.vertices.push_back(vertex_of(vertices, i));
  before.vertices.push_back(fixed_vertex_of(vertices, chord));
  before.vertices.push_back(middle);
  behind.start_at(middle.u);
  behind.vertices.push_back(fixed_vertex_of(vertices, chord + 1));
  for (std::size_t i = chord + 2; i < vertices.size(); ++i) {
    behind.vertices.push_back(vertex_of(vertices, i));
  }
  for (Span span : speeds.spans) {
    const Span whole = span;
    const bool is_divided = span.first <= k && span.last > k;
    const double share = is_divided ? share_before(vertices, span, chord) : 1.0;
    if (whole.first <= k) {
      span.last = std::min(whole.last, k + 1);
      copy_part(*this, span, {0.0, share}, before);
    }
    if (whole.last > k) {
      span.first = whole.first > k ? whole.first - k : 0;
      span.last = whole.last - k;
      copy_part(*this, span, {is_divided ? share : 0.0, 1.0}, behind);
    }
  }
  *this = std::move(behind);
  return before;
}

}  // namespace servomill::controllers
