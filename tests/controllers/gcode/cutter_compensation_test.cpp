// The geometry of corners under cutter radius compensation, and the distance that the tool keeps.
#include "controllers/gcode/cutter_compensation.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "plant/vocabulary/arc_sweep.h"
#include "tests/controllers/gcode/program.h"

namespace servomill::controllers::cutter_compensation_test {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

constexpr double kRoundTol = 1e-12;  // m, of points some 0.1 m from the origin

Vector2d at(double angle) { return {std::cos(angle), std::sin(angle)}; }

PlaneMove line(const Vector2d& begin, const Vector2d& end) { return {begin, end}; }

// Counter-clockwise if sweep > 0.
PlaneMove arc(const Vector2d& centre, double R, double angle, double sweep) {
  return {centre + R * at(angle), centre + R * at(angle + sweep), true, centre, sweep > 0 ? 1 : -1};
}

PlaneMove mirrored(PlaneMove move) {
  for (Vector2d* p : {&move.begin, &move.end, &move.centre}) p->y() = -p->y();
  move.turns = -move.turns;
  return move;
}

// The corner between two programmed moves, for a tool that follows the first.
Corner corner_between(const Cutter& cutter, const PlaneMove& before, const PlaneMove& next) {
  const HeldMove held = following_move(cutter, before).move;
  return corner(cutter, held.end, held, next);
}

void expect_point(const Vector2d& found, const Vector2d& wanted) {
  EXPECT_LE((found - wanted).norm(), kRoundTol)
      << "found " << found.transpose() << "\nwanted " << wanted.transpose();
}

constexpr Cutter kLeft = {0.002, true};
constexpr Cutter kRight = {0.002, false};

// Checks the mirror image of each corner, too, with the tool on the other side.
void expect_corner(const PlaneMove& before, const PlaneMove& next, CornerKind kind,
                   const Vector2d& point) {
  const Corner left = corner_between(kLeft, before, next);
  EXPECT_EQ(left.fault, "");
  EXPECT_EQ(left.kind, kind);
  expect_point(left.point, point);
  const Corner right = corner_between(kRight, mirrored(before), mirrored(next));
  EXPECT_EQ(right.fault, "");
  EXPECT_EQ(right.kind, kind);
  expect_point(right.point, {point.x(), -point.y()});
}

void expect_no_corner(const PlaneMove& before, const PlaneMove& next, const std::string& fault) {
  EXPECT_EQ(corner_between(kLeft, before, next).fault, fault);
  EXPECT_EQ(corner_between(kRight, mirrored(before), mirrored(next)).fault, fault);
}

// The path comes along X to the origin; the tool is above it, radius 2 mm.
const PlaneMove kAlongX = line({-0.02, 0.0}, {0.0, 0.0});

TEST(Corner, LineToLine) {
  expect_corner(kAlongX, line({0, 0}, {0.01, 0}), CornerKind::straight, {0, 0.002});
  expect_corner(kAlongX, line({0, 0}, {0, -0.01}), CornerKind::convex, {0.002, 0});
  expect_corner(kAlongX, line({0, 0}, {-0.01, -1e-5}), CornerKind::convex,
                0.002 * at(std::atan2(-1e-5, -0.01) + pi / 2));
  expect_corner(kAlongX, line({0, 0}, {0, 0.01}), CornerKind::concave, {-0.002, 0.002});
  // the tool touches both lines: its centre lies on their bisector
  const double turn = 1.0;
  expect_corner(kAlongX, line({0, 0}, 0.01 * at(turn)), CornerKind::concave,
                {-0.002 * std::tan(turn / 2), 0.002});
}

TEST(Corner, ATurnBelowOneTwentiethOfARadianIsNone) {
  for (const double side : {1.0, -1.0}) {
    EXPECT_EQ(corner_between(kLeft, kAlongX, line({0, 0}, 0.01 * at(side * 0.0499))).kind,
              CornerKind::straight);
    EXPECT_EQ(corner_between(kLeft, kAlongX, line({0, 0}, 0.01 * at(side * 0.0501))).kind,
              side > 0 ? CornerKind::concave : CornerKind::convex);
  }
}

TEST(Corner, LineToArc) {
  // around a centre below: outside, tangent, and 90 degrees away
  expect_corner(kAlongX, arc({0, -0.01}, 0.01, pi / 2, -1), CornerKind::straight, {0, 0.002});
  expect_corner(kAlongX, arc({-0.01, 0}, 0.01, 0, -1), CornerKind::convex, {0.002, 0});
  // up and around a centre to the right, outside: the circle of the tool has radius 12 mm
  expect_corner(kAlongX, arc({0.01, 0}, 0.01, pi, -1), CornerKind::concave,
                {0.01 - std::sqrt(0.012 * 0.012 - 0.002 * 0.002), 0.002});
  // up and around a centre to the left, inside: radius 8 mm
  expect_corner(kAlongX, arc({-0.01, 0}, 0.01, 0, 1), CornerKind::concave,
                {-0.01 + std::sqrt(0.008 * 0.008 - 0.002 * 0.002), 0.002});
}

TEST(Corner, ArcToLine) {
  const PlaneMove up = line({0, 0}, {0, 0.01});
  // comes along X at the top of a circle, tool outside
  const PlaneMove outside = arc({0, -0.01}, 0.01, pi / 2 + 1, -1);
  expect_corner(outside, line({0, 0}, {0.01, 0}), CornerKind::straight, {0, 0.002});
  expect_corner(outside, line({0, 0}, {0, -0.01}), CornerKind::convex, {0.002, 0});
  expect_corner(outside, up, CornerKind::concave,
                {-0.002, -0.01 + std::sqrt(0.012 * 0.012 - 0.002 * 0.002)});
  // comes along X at the bottom of a circle, tool inside
  const PlaneMove inside = arc({0, 0.01}, 0.01, -pi / 2 - 1, 1);
  expect_corner(inside, up, CornerKind::concave,
                {-0.002, 0.01 - std::sqrt(0.008 * 0.008 - 0.002 * 0.002)});
}

TEST(Corner, ArcToArc) {
  const PlaneMove top = arc({0, -0.01}, 0.01, pi / 2 + 1, -1);
  const PlaneMove bottom = arc({0, 0.01}, 0.01, -pi / 2 - 1, 1);
  expect_corner(top, arc({0, -0.02}, 0.02, pi / 2, -1), CornerKind::straight, {0, 0.002});
  expect_corner(top, arc({-0.01, 0}, 0.01, 0, -1), CornerKind::convex, {0.002, 0});
  // equal circles: their crossings lie on the line at 135 degrees through the origin
  const double half = std::sqrt(0.5) * 0.01;  // of the distance between the centres
  const double outer = std::sqrt(0.012 * 0.012 - half * half) - half;
  expect_corner(top, arc({0.01, 0}, 0.01, pi, -1), CornerKind::concave, outer * at(3 * pi / 4));
  const double inner = half - std::sqrt(0.008 * 0.008 - half * half);
  expect_corner(bottom, arc({-0.01, 0}, 0.01, 0, 1), CornerKind::concave, inner * at(3 * pi / 4));
}

// As around the top of an "m": the tool could loop around the tangent point, or stay above.
TEST(Corner, AToolThatTurnsBackAtTheTopOfAnArcStaysOutside) {
  const PlaneMove before = arc({-0.01, 0}, 0.01, pi, -pi);  // ends at the origin, downwards
  const PlaneMove next = arc({0.01, 0}, 0.01, pi, -pi);     // begins upwards
  expect_corner(before, next, CornerKind::concave, {0, std::sqrt(0.012 * 0.012 - 0.01 * 0.01)});
  // a line down and back up is rolled around, whichever way
  EXPECT_EQ(corner_between(kLeft, line({0, 0.01}, {0, 0}), line({0, 0}, {0, 0.01})).kind,
            CornerKind::convex);
}

TEST(Corner, WhereTheToolDoesNotFit) {
  const std::string start = "the tool does not fit into the corner between ";
  expect_no_corner(kAlongX, arc({-0.001, -0.003}, std::sqrt(1e-5), std::atan2(3, 1), 1.9),
                   start + "line and arc without gouging");
  expect_no_corner(arc({-0.001, 0.003}, std::sqrt(1e-5), std::atan2(-3, 1) - 1.9, 1.9),
                   line({0, 0}, {-0.01, 0}), start + "arc and line without gouging");
  expect_no_corner(arc({-0.01, 0}, 0.01, -pi / 2, pi / 2),
                   arc({-0.001, -0.003}, std::sqrt(1e-5), std::atan2(3, 1), 1.9),
                   start + "arc and arc without gouging");
  expect_no_corner(arc({-0.01, 0}, 0.01, -pi / 2, pi / 2), arc({-0.01, 0}, 0.01, 0, -1),
                   "two arcs with the same centre, and the corner between them is concave");
}

TEST(FollowingMove, AToolInsideAnArcMustBeSmaller) {
  const auto fault = [](double R) { return following_move(kLeft, arc({0, 0}, R, 0, 1)).fault; };
  EXPECT_EQ(fault(0.0020001), "");
  EXPECT_EQ(fault(0.002),
            "the tool does not fit inside the arc: tool radius 2.0000 mm, arc radius 2.0000 mm");
  EXPECT_EQ(following_move(kRight, arc({0, 0}, 0.001, 0, 1)).fault, "");  // outside
}

TEST(EntryMove, LineEndsBesideTheEnd) {
  const Compensated entry = entry_move(kLeft, line({-0.01, 0.003}, {-0.01, 0.013}));
  EXPECT_EQ(entry.fault, "");
  expect_point(entry.move.end, {-0.012, 0.013});
  expect_point(entry_move(kRight, line({-0.01, 0.003}, {-0.01, 0.013})).move.end, {-0.008, 0.013});
}

TEST(EntryMove, MustBeLongerThanTheRadius) {
  EXPECT_EQ(entry_move(kLeft, line({0, 0}, {0.0020001, 0})).fault, "");
  const std::string wanted =
      "the first move with cutter compensation is 2.0000 mm long; must be longer than the tool "
      "radius, 2.0000 mm";
  EXPECT_EQ(entry_move(kLeft, line({0, 0}, {0.002, 0})).fault, wanted);
  EXPECT_EQ(entry_move(kLeft, arc({0, 0}, 0.1, 0, 0.02)).fault, wanted);
}

// It begins where the tool is, ends beside the end, and ends in the programmed direction.
TEST(EntryMove, ArcStaysAnArc) {
  for (const Cutter& cutter : {kLeft, kRight}) {
    for (const double sweep : {1.0, -1.0, 2.5, -2.5}) {
      const PlaneMove programmed = arc({0.01, 0.02}, 0.03, 0.4, sweep);
      const Compensated entry = entry_move(cutter, programmed);
      ASSERT_EQ(entry.fault, "");
      EXPECT_EQ(entry.move.turns, programmed.turns);
      expect_point(entry.move.end, following_move(cutter, programmed).move.end);
      EXPECT_NEAR((programmed.begin - entry.move.centre).norm(),
                  (entry.move.end - entry.move.centre).norm(), kRoundTol);
      const Vector2d to_old = programmed.centre - programmed.end;
      const Vector2d to_new = entry.move.centre - entry.move.end;
      EXPECT_NEAR(to_old.x() * to_new.y() - to_old.y() * to_new.x(), 0.0, kRoundTol);
    }
  }
}

TEST(MoveEnd, ALineMustNotRunBackwards) {
  HeldMove held;
  held.direction = {1, 0};
  const std::string fault = "the tool cannot reach the line in the concave corner without gouging";
  EXPECT_EQ(move_end(held, Vector2d(0, 0), {0, 0.01}, kEndToleranceMm), "");
  expect_point(held.end, {0, 0.01});
  EXPECT_EQ(move_end(held, Vector2d(0, 0), {-1e-9, 0.01}, kEndToleranceMm), fault);
  expect_point(held.end, {0, 0.01});
  EXPECT_EQ(move_end(held, std::nullopt, {-1e-9, 0.01}, kEndToleranceMm), "");
}

TEST(MoveEnd, AnArcMustNotBecomeLonger) {
  const std::string fault = "the tool cannot reach the arc in the concave corner without gouging";
  for (const EndTolerance& tolerance : {kEndToleranceMm, kEndToleranceInch}) {
    const auto fault_at = [&](double angle) {
      HeldMove held;
      held.is_arc = true;
      held.turns = 1;
      held.end = 0.01 * at(1);
      held.sweep = 1;
      return move_end(held, Vector2d(0.01, 0), 0.01 * at(angle), tolerance);
    };
    EXPECT_EQ(fault_at(0.2), "");
    EXPECT_EQ(fault_at(1 + 0.999 * tolerance.sweep), "");
    EXPECT_EQ(fault_at(1 + 1.001 * tolerance.sweep), fault);
    EXPECT_EQ(fault_at(-0.1), fault);  // all the way round
  }
}

TEST(MoveEnd, AnArcKeepsItsRadius) {
  HeldMove held;
  held.is_arc = true;
  held.turns = 1;
  held.end = {0.01, 0};
  held.sweep = 1;
  EXPECT_EQ(move_end(held, std::nullopt, {0.010009, 0}, kEndToleranceMm), "");
  held.end = {0.01, 0};
  EXPECT_EQ(
      move_end(held, std::nullopt, {0.010011, 0}, kEndToleranceMm),
      "the compensated arc would have radius 10.0000 mm at its start, but 10.0110 mm at its end");
}

// ------------------------------------------------------------------------------------------- laws

double distance(const PlaneMove& move, const Vector2d& p) {
  if (!move.is_arc) {
    const Vector2d along = move.end - move.begin;
    const double t = std::clamp((p - move.begin).dot(along) / along.squaredNorm(), 0.0, 1.0);
    return (p - move.begin - t * along).norm();
  }
  const double ends = std::min((p - move.begin).norm(), (p - move.end).norm());
  const auto angle = [&](const Vector2d& q) {
    return std::atan2(q.y() - move.centre.y(), q.x() - move.centre.x());
  };
  const double sign = move.turns > 0 ? 1.0 : -1.0;
  const auto from_begin = [&](const Vector2d& q) {
    return std::fmod(sign * (angle(q) - angle(move.begin)) + 4 * pi, 2 * pi);
  };
  if (from_begin(p) > from_begin(move.end)) return ends;
  return std::min(ends, std::abs((p - move.centre).norm() - (move.end - move.centre).norm()));
}

// A path that always advances along X, so that it does not cross itself, of lines and arcs.
class RandomPath {
 public:
  explicit RandomPath(unsigned seed) : random_(seed) {}

  std::vector<PlaneMove> make(double r) {
    std::vector<PlaneMove> path;
    Vector2d at_now = Vector2d::Zero();
    double heading = uniform(-1, 1);
    for (int i = 0; i < 12; ++i) {
      // straight on, or a true corner: in between the tool leaves a small kink
      if (uniform(0, 1) > 0.3) {
        double next = heading;
        while (std::abs(next - heading) < 0.06) next = uniform(-1, 1);
        heading = next;
      }
      if (uniform(0, 1) < 0.5) {
        path.push_back(line(at_now, at_now + r * uniform(6, 20) * at(heading)));
      } else {
        const double R = r * uniform(8, 30);
        double next = heading;
        while (std::abs(next - heading) < 0.7) next = uniform(-1.1, 1.1);
        const double side = next > heading ? 1.0 : -1.0;
        const Vector2d to_centre = side * at(heading + pi / 2);
        path.push_back(arc(at_now + R * to_centre, R, heading - side * pi / 2, next - heading));
        path.back().begin = at_now;
        heading = next;
      }
      at_now = path.back().end;
    }
    return path;
  }

 private:
  double uniform(double a, double b) {
    return boost::random::uniform_real_distribution<double>(a, b)(random_);
  }
  boost::random::mt19937 random_;
};

std::string words(const PlaneMove& move) {
  std::string text = fmt::format("X{:.10f} Y{:.10f}", move.end.x() / mm, move.end.y() / mm);
  if (!move.is_arc) return "G1 " + text;
  const Vector2d to_centre = (move.centre - move.begin) / mm;
  return fmt::format("{} {} I{:.10f} J{:.10f}", move.turns > 0 ? "G3" : "G2", text, to_centre.x(),
                     to_centre.y());
}

std::string program_of(const std::vector<PlaneMove>& path, const Cutter& cutter) {
  const Vector2d before =
      path[0].begin - 20 * cutter.radius * (path[0].end - path[0].begin).normalized();
  std::string text =
      fmt::format("G21 F600\nG0 X{:.10f} Y{:.10f}\nG{}.1 D{}\nG1 X0 Y0\n", before.x() / mm,
                  before.y() / mm, cutter.is_left ? 41 : 42, 2 * cutter.radius / mm);
  for (const PlaneMove& move : path) text += words(move) + "\n";
  return text + "G40\nM2\n";
}

constexpr double kLawTol = 1e-10;  // m: words have ten decimals, corners turn by 0.06 rad or more

// Every point of the tool's path is `radius` away from the programmed path.
void expect_offset(const std::vector<Move>& moves, const std::vector<PlaneMove>& path,
                   const Cutter& cutter) {
  for (std::size_t i = 2; i < moves.size(); ++i) {  // behind the entry
    const Eigen::Vector3d begin = moves[i - 1].end.head<3>(), end = moves[i].end.head<3>();
    for (int k = 0; k <= 20; ++k) {
      const double t = 0.05 * k;
      const Eigen::Vector3d p =
          moves[i].kind == MoveKind::arc
              ? ArcSweep(begin, end, moves[i].arc.centre, 2, moves[i].arc.turns).point(t)
              : Eigen::Vector3d(begin + t * (end - begin));
      double nearest = std::numeric_limits<double>::infinity();
      for (const PlaneMove& move : path) nearest = std::min(nearest, distance(move, p.head<2>()));
      ASSERT_NEAR(nearest, cutter.radius, kLawTol) << "move " << i << " of line " << moves[i].line;
    }
  }
}

void expect_arcs_are_round(const std::vector<Move>& moves) {
  for (std::size_t i = 1; i < moves.size(); ++i) {
    if (moves[i].kind != MoveKind::arc) continue;
    const Eigen::Vector3d& centre = moves[i].arc.centre;
    EXPECT_NEAR((moves[i - 1].end.head<3>() - centre).norm(),
                (moves[i].end.head<3>() - centre).norm(), kLawTol);
  }
}

// s counts the programmed path, of which an inserted corner is no part.
void expect_arc_length(const std::vector<Move>& moves, const std::vector<PlaneMove>& path) {
  for (std::size_t i = 1; i < moves.size(); ++i) {
    EXPECT_EQ(moves[i].s_begin, moves[i - 1].s_end);
    EXPECT_GE(moves[i].s_end, moves[i].s_begin);
  }
  double length = 0.0;
  for (const PlaneMove& move : path) {
    const auto lift = [](const Vector2d& v) { return Eigen::Vector3d(v.x(), v.y(), 0.0); };
    length +=
        move.is_arc
            ? ArcSweep(lift(move.begin), lift(move.end), lift(move.centre), 2, move.turns).length()
            : (move.end - move.begin).norm();
  }
  EXPECT_NEAR(moves.back().s_end - moves[1].s_end, length, kLawTol);
}

TEST(Law, TheToolKeepsItsDistance) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    const Cutter cutter = {0.001 * (1 + seed % 3), seed % 2 == 0};
    const std::vector<PlaneMove> path = RandomPath(seed).make(cutter.radius);
    const std::string text = program_of(path, cutter);
    SCOPED_TRACE(fmt::format("seed {}\n{}", seed, text));
    std::vector<Move> moves = interpret(text, "p.nc", {});
    moves.pop_back();
    expect_offset(moves, path, cutter);
    expect_arcs_are_round(moves);
    expect_arc_length(moves, path);
    if (testing::Test::HasFailure()) return;
  }
}

}  // namespace
}  // namespace servomill::controllers::cutter_compensation_test
