#include "sim/calibration/point_observations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "plant/vocabulary/units.h"
#include "sim/calibration/touched_spheres.h"
#include "sim/metrology/best_fit.h"
#include "sim/metrology/location_errors.h"
#include "sim/numerics/dense_solver.h"

namespace servomill::sim::calibration {
namespace {

using Eigen::Vector3d;
using readings::Group;
using readings::Kind;
using readings::Reading;

// Unknowns of an artefact on the table: place and turn; what its calibration leaves open is common
// to all places where it stood.
struct Placed {
  Eigen::Isometry3d motion;  // from the frame of the artefact to W, of the nominal machine
  Point shift{}, turn{};
};

Vector3d mean_of(const std::vector<Vector3d>& points) {
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

// Artefact aligned with centres; the rotation about a line of balls is kept.
Eigen::Isometry3d laid_on(const std::vector<Vector3d>& own, const std::vector<Vector3d>& centres) {
  const auto fit = metrology::best_fit(own, centres);
  if (const auto* found = std::get_if<metrology::BestFit>(&fit)) return found->motion;
  const auto turn =
      numerics::rotation_between(own.back() - own.front(), centres.back() - centres.front());
  return Eigen::Translation3d(mean_of(centres)) * turn * Eigen::Translation3d(-mean_of(own));
}

class PointObservations {
 public:
  explicit PointObservations(ObservationBuilder& builder) : b_(builder) {}

  void add() {
    switch (group().kind) {
      case Kind::ball_bar:
        return add_ball_bar();
      case Kind::r_test:
        return add_r_test();
      case Kind::sphere:
        return add_spheres();
      case Kind::touch:
        return add_touches();
      case Kind::part:
        return add_part();
      default:
        return;
    }
  }

 private:
  const Group& group() const { return b_.group(); }
  Vector3d tip(const Joints& Q) const { return b_.tip(Q); }

  // Ball or stylus in the spindle: its place adds R_WS delta to the tip.
  std::optional<Point> add_tool(const std::string& name) {
    if (group().tool_is_known) return std::nullopt;
    return b_.add_point(name);
  }
  void add_tool_parts(Observation& one, const std::optional<Point>& tool, const Vector3d& n_W,
                      const Joints& Q) const {
    if (!tool) return;
    add_parts(one, *tool, metrology::R_WS(b_.chain(), Q).transpose() * n_W);
  }
  static void add_parts(Observation& one, const Point& point, const Vector3d& factors) {
    for (std::size_t k = 0; k < 3; ++k) one.set_up.push_back({point[k], factors[int(k)]});
  }

  void add_ball_bar() {
    const Point ball = b_.add_point("ball on the table");
    const auto tool = add_tool("ball in the spindle");
    const std::size_t length = b_.add_size("length");
    for (std::size_t row = 0; row < group().rows.size(); ++row) {
      const Joints& Q = group().rows[row].Q;
      const Vector3d bar = tip(Q) - group().ball_W;
      const double nominal = bar.norm();
      if (std::abs(nominal - group().length) > readings::kLargestDeviation) {
        throw InputError({group().file, group().rows[row].line},
                         fmt::format("the balls are {:.3f} mm apart at these axis positions, the "
                                     "bar is {:.3f} mm long: check ball_mm, point_mm and length_mm",
                                     nominal / mm, group().length / mm));
      }
      Pose pose;
      pose.n_W = bar / nominal;
      Observation& one = b_.add(row, 0, pose);
      ObservationBuilder::correct(one, group().length - nominal);
      one.set_up.push_back({length, 1.0});
      add_parts(one, ball, -pose.n_W);
      add_tool_parts(one, tool, pose.n_W, Q);
    }
  }

  void add_r_test() {
    const Point nest = b_.add_point("nest");
    const auto tool = add_tool("ball");
    for (std::size_t row = 0; row < group().rows.size(); ++row) {
      for (int k = 0; k < 3; ++k) {
        Observation& one = add_along(row, k, tool);
        add_parts(one, nest, -one.poses.front().n_W);
      }
    }
  }

  // A number along X, Y or Z of W.
  Observation& add_along(std::size_t row, int k, const std::optional<Point>& tool) {
    Pose pose;
    pose.n_W = Vector3d::Unit(k);
    Observation& one = b_.add(row, k, pose);
    add_tool_parts(one, tool, pose.n_W, group().rows[row].Q);
    return one;
  }

  // Spheres stand alone, or as the balls of an artefact.
  class Spheres {
   public:
    Spheres(ObservationBuilder& b, std::vector<Vector3d> nominal) : centre_(std::move(nominal)) {
      if (b.group().artefact) {
        placed_ = place(b);
        return;
      }
      for (const std::string& name : b.group().spheres) alone_.push_back(b.add_point(name));
    }

    /// Place of a sphere by the nominal machine and the calibration of its artefact.
    const Vector3d& centre(std::size_t sphere) const { return centre_[sphere]; }

    /// The parts of - n . centre in a number.
    void add_parts(Observation& one, std::size_t sphere, const Vector3d& n_W) const {
      const auto add = [&](const Point& point, const Vector3d& factors) {
        PointObservations::add_parts(one, point, factors);
      };
      if (!placed_) {
        add(alone_[sphere], -n_W);
        return;
      }
      const Vector3d arm = centre_[sphere] - middle_;
      add(placed_->shift, -n_W);
      add(placed_->turn, -arm.cross(n_W));
      if (calibration_.scale) one.set_up.push_back({*calibration_.scale, -arm.dot(n_W)});
      if (!calibration_.balls.empty()) {
        add(calibration_.balls[ball_[sphere]], -placed_->motion.linear().transpose() * n_W);
      }
    }

   private:
    Placed place(ObservationBuilder& b) {
      const readings::Artefact& artefact = b.readings().artefacts[*b.group().artefact];
      std::vector<Vector3d> own;
      for (const std::string& name : b.group().spheres) {
        ball_.push_back(*artefact.find(name));
        own.push_back(artefact.balls[ball_.back()].centre);
      }
      Placed out{.motion = laid_on(own, centre_)};
      for (std::size_t k = 0; k < own.size(); ++k) {
        const Vector3d centre = out.motion * own[k];
        const double off = (centre - centre_[k]).norm();
        if (off > readings::kLargestDeviation) {
          throw InputError(
              {b.group().file},
              fmt::format("sphere {} is {:.3g} mm from its position in \"{}\"; check names, axis "
                          "positions, signs and {}",
                          b.group().spheres[k], off / mm, artefact.name, artefact.file));
        }
        centre_[k] = centre;
      }
      middle_ = mean_of(centre_);
      out.shift = b.add_point("place of " + artefact.name);
      for (std::size_t k = 0; k < 3; ++k) {
        out.turn[k] =
            b.add_own(fmt::format("turn of {} about {}", artefact.name, "XYZ"[k]), urad, "urad");
      }
      calibration_ = b.calibration_of(*b.group().artefact);
      return out;
    }

    std::vector<Vector3d> centre_;  // m, in W
    Vector3d middle_ = Vector3d::Zero();
    std::vector<Point> alone_;
    std::optional<Placed> placed_;
    std::vector<std::size_t> ball_;  // of the artefact, of each sphere
    ArtefactUnknowns calibration_;
  };

  // The stylus stands at the centre: nominal tip + deviation = centre.
  void add_spheres() {
    const auto tool = add_tool("stylus");
    std::vector<Vector3d> mean(group().spheres.size(), Vector3d::Zero());
    std::vector<int> count(group().spheres.size(), 0);
    for (const Reading& reading : group().rows) {
      mean[reading.sphere] += tip(reading.Q);
      ++count[reading.sphere];
    }
    for (std::size_t k = 0; k < mean.size(); ++k) mean[k] /= count[k];
    const Spheres spheres(b_, mean);
    for (std::size_t row = 0; row < group().rows.size(); ++row) {
      const Reading& reading = group().rows[row];
      const Vector3d off = tip(reading.Q) - spheres.centre(reading.sphere);
      for (int k = 0; k < 3; ++k) {
        Observation& one = add_along(row, k, tool);
        one.d = -off[k];
        spheres.add_parts(one, reading.sphere, one.poses.front().n_W);
      }
      if (off.norm() > readings::kLargestDeviation) refuse_stray(reading, off.norm());
    }
  }

  [[noreturn]] void refuse_stray(const Reading& reading, double off) const {
    throw InputError({group().file, reading.line},
                     fmt::format("sphere {} is {:.3g} mm from the other spheres of its name; check "
                                 "axis positions, signs and point_mm",
                                 group().spheres[reading.sphere], off / mm));
  }

  // Single touches: n . (tip + deviation + stylus - centre) = radius + pre-travel, n outwards.
  void add_touches() {
    const auto tool = add_tool("stylus");
    const TouchedSpheres touched = touched_spheres(group(), b_.chain());
    const std::size_t radius = b_.add_size("radius");
    std::vector<std::size_t> lobes;
    for (int wave = 2; wave <= group().lobes; ++wave) {
      for (const char* const part : {"cos", "sin"}) {
        lobes.push_back(
            b_.add_own(fmt::format("pre-travel {} {}", part, wave), um, "um", group().lobe_size));
      }
    }
    const Spheres spheres(b_, touched.centre);
    for (std::size_t row = 0; row < group().rows.size(); ++row) {
      const Reading& reading = group().rows[row];
      Pose pose;
      pose.n_W = touched.n_W[row];
      Observation& one = b_.add(row, 0, pose);
      one.d = group().radius - pose.n_W.dot(tip(reading.Q) - spheres.centre(reading.sphere));
      add_tool_parts(one, tool, pose.n_W, reading.Q);
      spheres.add_parts(one, reading.sphere, pose.n_W);
      one.set_up.push_back({radius, -1.0});
      add_lobes(one, lobes, metrology::R_WS(b_.chain(), reading.Q).transpose() * pose.n_W);
      if (std::abs(one.d) > readings::kLargestDeviation) refuse_stray(reading, std::abs(one.d));
    }
  }

  // By the direction about the spindle; none along it.
  static void add_lobes(Observation& one, const std::vector<std::size_t>& lobes,
                        const Vector3d& n_S) {
    const double across = std::hypot(n_S.x(), n_S.y());
    const double azimuth = std::atan2(n_S.y(), n_S.x());
    for (std::size_t k = 0; k < lobes.size(); ++k) {
      const double angle = static_cast<double>(k / 2 + 2) * azimuth;
      one.set_up.push_back({lobes[k], -across * (k % 2 == 0 ? std::cos(angle) : std::sin(angle))});
    }
  }

  // A part that the machine has cut: its surface stands where the tool was. The datum of the
  // measurement is free.
  void add_part() {
    Vector3d middle = Vector3d::Zero();
    for (const Reading& reading : group().rows) middle += tip(reading.Q);
    middle /= static_cast<double>(group().rows.size());
    const Point shift = b_.add_point("datum");
    Point turn{};
    for (std::size_t k = 0; k < 3; ++k) {
      turn[k] = b_.add_own(fmt::format("datum about {}", "XYZ"[k]), urad, "urad");
    }
    const bool surface = group().is_surface;
    const std::size_t radius = surface ? b_.add_size("radius of the tool") : 0;
    for (std::size_t row = 0; row < group().rows.size(); ++row) {
      const Reading& reading = group().rows[row];
      Pose pose;
      pose.n_W = reading.normal;
      Observation& one = b_.add(row, 0, pose);
      add_parts(one, shift, pose.n_W);
      add_parts(one, turn, (tip(reading.Q) - middle).cross(pose.n_W));
      if (surface) one.set_up.push_back({radius, -1.0});
    }
  }

  ObservationBuilder& b_;
};

}  // namespace

void add_point_observations(ObservationBuilder& builder) { PointObservations(builder).add(); }

}  // namespace servomill::sim::calibration
