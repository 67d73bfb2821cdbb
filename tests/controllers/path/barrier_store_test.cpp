/// The points of a path, kept or formed when they are due.
#include "controllers/path/barrier_store.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

#include "controllers/path/limit_form.h"

namespace servomill::controllers::barrier_store_test {
namespace {

// Pieces and knots that divide a path in different places, some of which are the same.
class Cut {
 public:
  explicit Cut(std::size_t pieces) {
    std::mt19937 dice(7);
    const auto uniform = [&](double low, double high) {
      return low + (high - low) * (static_cast<double>(dice()) / 4294967296.0);
    };
    const auto some = [&] {
      Joints out;
      for (double& x : out) x = uniform(-1.0, 1.0);
      return out;
    };
    for (std::size_t i = 0; i < pieces; ++i) {
      path.pieces.push_back({static_cast<double>(i), some(), some(), some(), some(), i});
    }
    path.s = {0.0, static_cast<double>(pieces)};
    for (double s = 0.25; s < path.length(); s += dice() % 4 == 0 ? 1.75 : 0.375) {
      spline.t.push_back(s);
    }
    for (std::size_t i = 0; i < spline.t.size() + 1; ++i) spline.c.push_back(uniform(1.0, 2.0));
    v_top.assign(pieces, 3.0);
    parts.lay(path, spline.t, 0);
  }

  BarrierStore store(SimdLevel level, std::size_t most_kept) {
    BarrierStore out(path, spline, parts, v_top, spline.c, most_kept);
    out.prepare(joints, moving, at_simd_level(level, []<SimdLevel chosen>() {
                  return make_barrier_kernel<chosen>();
                }));
    return out;
  }

  SmoothPath path;
  SpeedSpline spline;
  PathParts parts;
  std::vector<double> v_top;
  BarrierJoints joints = {3, {0.1, 0.05, 0.2}, {0.02, 0.03, 0.04}};
  std::array<int, kBarrierJoints> moving = {0, 2, 4};
};

// A point of a part, worked out alone.
struct Point {
  double s = 0.0, length = 0.0, swell = 0.0;
  LimitForm form;
};

Point point_of(const Cut& cut, const PathPart& part, std::size_t place) {
  const double h = part.to - part.from;
  const CubicPiece& piece = cut.path.pieces[part.piece];
  Joints per_jerk = Joints::Zero();
  for (std::size_t k = 0; k < cut.joints.count; ++k) {
    per_jerk[cut.moving[k]] = cut.joints.per_jerk[k];
  }
  const LimitForm begin = LimitForm::on(piece, part.from - piece.s, per_jerk);
  if (place == 0) return {part.from, h / 6.0, 0.0, begin};
  if (place == 2) return {part.to, h / 6.0, 0.0, begin.shifted(h)};
  // the control point of (1), a quadratic in s, is L_m - h^2 L''/8 with L'' = 4.5 q''' b''
  const double swell = 4.5 * h * h / 8.0;
  LimitForm middle = begin.shifted(0.5 * h);
  middle.j2 -= swell * middle.j0;
  return {0.5 * (part.from + part.to), h * (2.0 / 3.0), swell, middle};
}

void expect_is(const Cut& cut, const BarrierPoints& points, std::size_t lane, const PathPart& part,
               const Point& point) {
  Eigen::Matrix3d S = cut.spline.matrix(part.interval);
  const double y = point.s - cut.spline.t[part.interval];
  S.row(0) += y * (S.row(1) + 0.5 * y * S.row(2));
  S.row(1) += y * S.row(2);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      ASSERT_EQ(points.S[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)][lane], S(i, j));
    }
  }
  const double* c = &cut.spline.c[part.interval];
  const double b = S(0, 0) * c[0] + S(0, 1) * c[1] + S(0, 2) * c[2];
  EXPECT_EQ(points.length[lane], point.length);
  EXPECT_EQ(points.time[lane], point.length / std::sqrt(b));
  EXPECT_EQ(points.b_top[lane], 9.0);
  EXPECT_EQ(points.swell[lane], point.swell);
  EXPECT_EQ(points.interval[lane], part.interval);
  for (std::size_t k = 0; k < cut.joints.count; ++k) {
    ASSERT_EQ(points.j0[k][lane], point.form.j0[cut.moving[k]]);
    ASSERT_EQ(points.j1[k][lane], point.form.j1[cut.moving[k]]);
    ASSERT_EQ(points.j2[k][lane], point.form.j2[cut.moving[k]]);
  }
}

TEST(PathParts, AreCutWhereKnotsAndPiecesAre) {
  SmoothPath path;
  path.pieces.resize(3);
  path.pieces[1].s = 1.0, path.pieces[2].s = 2.0;
  path.s = {0.0, 3.0};
  const std::vector<double> knots = {0.5, 0.75, 2.5, 3.0};
  PathParts parts;
  parts.lay(path, knots, 0);
  const std::array<PathPart, 5> expected = {
      {{0, 0, 0.5, 0.75}, {1, 0, 0.75, 1.0}, {1, 1, 1.0, 2.0}, {1, 2, 2.0, 2.5}, {2, 2, 2.5, 3.0}}};
  ASSERT_EQ(parts.size(), expected.size());
  for (std::size_t n = 0; n < parts.size(); ++n) {
    const PathPart part = parts[n];
    EXPECT_EQ(part.interval, expected[n].interval) << n;
    EXPECT_EQ(part.piece, expected[n].piece) << n;
    EXPECT_EQ(part.from, expected[n].from) << n;
    EXPECT_EQ(part.to, expected[n].to) << n;
  }
  EXPECT_EQ(parts.first_of(0), 0U);
  EXPECT_EQ(parts.first_of(1), 1U);
  EXPECT_EQ(parts.first_of(2), 4U);
  EXPECT_EQ(parts.first_of(3), 5U);
}

TEST(BarrierStore, FormsBothEndsAndTheMiddleOfEveryPart) {
  Cut cut(23);
  for (const SimdLevel level : simd_levels()) {
    BarrierStore store = cut.store(level, 0);
    const auto all = store.of(0, cut.parts.size());
    for (std::size_t n = 0; n < cut.parts.size(); ++n) {
      for (std::size_t place = 0; place < 3; ++place) {
        const std::size_t k = 3 * n + place;
        SCOPED_TRACE(k);
        expect_is(cut, all.holding(k), k % kLaneWidth, cut.parts[n],
                  point_of(cut, cut.parts[n], place));
      }
    }
  }
}

// The search looks at whole blocks: what lies behind the last point must not add anything.
TEST(BarrierStore, RepeatsTheLastPointBehindIt) {
  Cut cut(5);
  ASSERT_NE(3 * cut.parts.size() % kLaneWidth, 0U);
  BarrierStore store = cut.store(simd_level(), 0);
  PathPart last = cut.parts[cut.parts.size() - 1];
  last.from = last.to;
  const auto all = store.of(0, cut.parts.size());
  for (std::size_t k = 3 * cut.parts.size(); k % kLaneWidth != 0; ++k) {
    Point point = point_of(cut, last, 0);
    point.length = 1e-12;
    expect_is(cut, all.holding(k), k % kLaneWidth, last, point);
  }
}

TEST(BarrierStore, GivesTheSameBitsKeptAndFormedAnew) {
  Cut cut(57);
  BarrierStore kept = cut.store(simd_level(), cut.parts.size());
  BarrierStore anew = cut.store(simd_level(), 0);
  for (std::size_t first = 0; first < cut.parts.size(); first += 5) {
    for (std::size_t last = first + 1; last <= cut.parts.size(); last += 7) {
      const auto a = kept.of(first, last), b = anew.of(first, last);
      ASSERT_EQ(a.first, b.first);
      ASSERT_EQ(a.count, b.count);
      for (std::size_t k = 3 * first; k < 3 * last; ++k) {
        const std::size_t lane = k % kLaneWidth;
        const BarrierPoints &p = a.holding(k), &q = b.holding(k);
        ASSERT_EQ(p.interval[lane], q.interval[lane]);
        ASSERT_EQ(p.time[lane], q.time[lane]);
        ASSERT_EQ(p.S[0][1][lane], q.S[0][1][lane]);
        ASSERT_EQ(p.j2[2][lane], q.j2[2][lane]);
      }
    }
  }
}

}  // namespace
}  // namespace servomill::controllers::barrier_store_test
