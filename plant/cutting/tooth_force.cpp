#include "plant/cutting/tooth_force.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "plant/cutting/edge_integrals.h"

namespace servomill::plant {
namespace {

constexpr double kPi = std::numbers::pi, kTurn = 2.0 * kPi;
constexpr double kSameAngle = 1e-9;   // rad, of arcs that continue each other
constexpr double kSameHeight = 1e-9;  // m
constexpr double kStraight = 1e-12;   // cosine of kappa on a flank

bool continues(const EngagedArc& below, const EngagedArc& above) {
  const double end = below.height + 0.5 * below.width, begin = above.height - 0.5 * above.width;
  return std::abs(std::cos(above.kappa)) < kStraight &&
         std::abs(std::cos(below.kappa)) < kStraight &&
         std::abs(above.from - below.from) < kSameAngle &&
         std::abs(above.to - below.to) < kSameAngle && std::abs(end - begin) < kSameHeight;
}

// Pieces of a flank that are engaged at the same angles become one.
std::vector<EngagedArc> joined(std::span<const EngagedArc> arcs) {
  std::vector<EngagedArc> out;
  for (const EngagedArc& arc : arcs) {
    if (out.empty() || !continues(out.back(), arc)) {
      out.push_back(arc);
      continue;
    }
    out.back().height += 0.5 * arc.width;
    out.back().width += arc.width;
  }
  return out;
}

// Adds a chip of thickness slope c (across sin(phi) - along) + offset, integrated over phi.
// @param is_edge  1: the edge is in contact; 0: a correction of what is added already
void add(const CuttingCoefficients& K, const EdgeSlice& slice, const EdgeIntegrals& I, double slope,
         double offset, double is_edge, double c, double wear, Eigen::Vector3d& F) {
  const double a = slope * c * slice.across;
  const double b = offset * slice.sine - slope * c * slice.along;
  const double h_one = a * I.sine + b * I.one;
  const double h_sine = a * I.sine_squared + b * I.sine;
  const double h_cosine = a * I.sine_cosine + b * I.cosine;
  const double edge = is_edge * wear, sk = slice.sine, ck = slice.cosine;
  const double outward_c = K.Krc * sk + K.Kac * ck;
  const double outward_e = edge * (K.Kre * sk + K.Kae * ck), Kte = edge * K.Kte;
  F.x() -=
      slice.width * (outward_c * h_sine + K.Ktc * h_cosine + outward_e * I.sine + Kte * I.cosine);
  F.y() -=
      slice.width * (outward_c * h_cosine - K.Ktc * h_sine + outward_e * I.cosine - Kte * I.sine);
  F.z() +=
      slice.width * ((K.Krc * ck - K.Kac * sk) * h_one + edge * (K.Kre * ck - K.Kae * sk) * I.one);
}

// The part of [from, to] in which c (across sin(phi) - along) is above x; empty: from > to.
AngleRange above(const EdgeSlice& slice, double c, double x, double from, double to) {
  const double needed = x / c + slice.along;
  if (slice.across <= 0.0) return needed < 0.0 ? AngleRange{from, to} : AngleRange{};
  const double sine = needed / slice.across;
  if (sine >= 1.0) return {};
  if (sine <= -1.0) return {from, to};
  const double first = std::asin(sine);
  return {std::max(from, first), std::min(to, kPi - first)};
}

// Force of one tooth, integrated over a rotation.
void add_tooth(const CuttingCoefficients& K, const std::vector<ToothChips::Piece>& pieces,
               const EdgeSlice& slice, const EdgeRotation& rotation, double c, double wear,
               Eigen::Vector3d& F) {
  double slope = 0.0, offset = 0.0, edge = 1.0;
  for (const ToothChips::Piece& piece : pieces) {
    const AngleRange range = piece.x > 0.0
                                 ? above(slice, c, piece.x * slice.sine, slice.from, slice.to)
                                 : AngleRange{slice.from, slice.to};
    if (!(range.to > range.from)) return;
    const EdgeIntegrals I = rotation_integrals(rotation, slice.lag_span, range.from, range.to);
    add(K, slice, I, piece.slope - slope, piece.offset - offset, edge, c, wear, F);
    slope = piece.slope;
    offset = piece.offset;
    edge = 0.0;
  }
}

using Piece = ToothChips::Piece;

// The lines of (1), m = 1 .. N.
std::vector<Piece> lines_of(const Cutter& cutter, int tooth) {
  std::vector<Piece> lines;
  for (int m = 1; m < cutter.teeth; ++m) {
    const double before = cutter.radius_offset((tooth + m) % cutter.teeth);
    lines.push_back({0.0, static_cast<double>(m), cutter.radius_offset(tooth) - before});
  }
  lines.push_back({0.0, static_cast<double>(cutter.teeth), 0.0});
  return lines;
}

// The line that is crossed first from x = now.x on; without a slope: none is.
Piece next_line(const std::vector<Piece>& lines, const Piece& now) {
  Piece next{std::numeric_limits<double>::infinity(), 0.0, 0.0};
  for (const Piece& line : lines) {
    if (line.slope >= now.slope) continue;
    const double crossing = (line.offset - now.offset) / (now.slope - line.slope);
    if (crossing < next.x || (crossing == next.x && line.slope < next.slope)) {
      next = {crossing, line.slope, line.offset};
    }
  }
  return next;
}

// Least of the lines from x = 0 on: there the one of the smallest offset, from each crossing on one
// of a smaller slope.
std::vector<Piece> lower_envelope(const std::vector<Piece>& lines) {
  std::vector<Piece> pieces;
  Piece now = *std::min_element(lines.begin(), lines.end(), [](const Piece& a, const Piece& b) {
    return a.offset != b.offset ? a.offset < b.offset : a.slope < b.slope;
  });
  while (now.slope > 0.0) {
    pieces.push_back(now);
    now = next_line(lines, now);
  }
  return pieces;
}

// Rising pieces from their zero on.
std::vector<Piece> positive_part(const std::vector<Piece>& pieces) {
  std::vector<Piece> out;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Piece& piece = pieces[i];
    const double zero = -piece.offset / piece.slope;
    if (i + 1 < pieces.size() && pieces[i + 1].x <= zero) continue;
    out.push_back({std::max(piece.x, zero), piece.slope, piece.offset});
  }
  return out;
}

}  // namespace

std::vector<EdgeSlice> edge_slices(const Cutter& cutter, const FeedDirection& feed,
                                   std::span<const EngagedArc> arcs) {
  std::vector<EdgeSlice> slices;
  const double lag_per_height = std::tan(cutter.helix) / cutter.radius;
  for (const EngagedArc& arc : joined(arcs)) {
    const AngleRange contact = contact_range(feed, arc.kappa);
    if (contact.empty()) continue;
    const double sk = std::sin(arc.kappa), ck = std::cos(arc.kappa);
    const double span = std::abs(ck) < kStraight ? arc.width * lag_per_height : 0.0;
    const double lag = arc.height * lag_per_height - 0.5 * span;
    for (const double turn : {-kTurn, 0.0, kTurn}) {
      const double from = std::max(arc.from + turn, contact.from);
      const double to = std::min(arc.to + turn, contact.to);
      if (!(to > from)) continue;
      slices.push_back({from, to, arc.width, lag, span, sk, ck, feed.across * sk, feed.along * ck});
    }
  }
  return slices;
}

ToothChips::ToothChips(const Cutter& cutter) {
  for (int tooth = 0; tooth < cutter.teeth; ++tooth) {
    teeth_.push_back(positive_part(lower_envelope(lines_of(cutter, tooth))));
  }
}

double ToothChips::at(int tooth, double x) const {
  double h = 0.0;
  for (const Piece& piece : pieces(tooth)) {
    if (x > piece.x) h = piece.slope * x + piece.offset;
  }
  return h;
}

Eigen::Vector3d mean_tooth_force(const CuttingCoefficients& K, const ToothChips& chips,
                                 std::span<const EdgeSlice> slices, double theta, double dtheta,
                                 double c, double wear) {
  assert(dtheta > 0.0 && dtheta <= kTurn);
  Eigen::Vector3d F = Eigen::Vector3d::Zero();
  if (!(c > 0.0)) return F;
  const int N = chips.teeth();
  for (const EdgeSlice& slice : slices) {
    for (int tooth = 0; tooth < N; ++tooth) {
      const double turns = (theta - slice.lag) / kTurn + static_cast<double>(tooth) / N;
      const double phi = kTurn * (turns - std::floor(turns));
      // most teeth are not in contact
      if (phi - slice.lag_span > slice.to && phi + dtheta < slice.from + kTurn) continue;
      add_tooth(K, chips.pieces(tooth), slice, {phi, dtheta}, c, wear, F);
    }
  }
  return F / dtheta;
}

}  // namespace servomill::plant
