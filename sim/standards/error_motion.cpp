#include "sim/standards/error_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/metrology/circle_fit.h"
#include "sim/numerics/dense_solver.h"

namespace servomill::sim::standards {
namespace {

double range(const Eigen::ArrayXXd& values) { return values.maxCoeff() - values.minCoeff(); }

// Mean and first harmonic by least squares: (mean, cos, sin).
Eigen::Vector3d first_harmonic(const Eigen::ArrayXd& theta, const Eigen::ArrayXd& r) {
  Eigen::MatrixXd A(theta.size(), 3);
  A << Eigen::ArrayXd::Ones(theta.size()), theta.cos(), theta.sin();
  return numerics::least_squares(A, r.matrix());
}

Eigen::ArrayXd wave(const Eigen::ArrayXd& theta, const Eigen::Vector3d& harmonic) {
  return harmonic[1] * theta.cos() + harmonic[2] * theta.sin();
}

// Width of the narrowest ring about the curve, drawn on a circle that is large against it.
double minimum_zone_width(const Eigen::ArrayXd& theta, const Eigen::ArrayXXd& r) {
  constexpr double kMagnified = 1e4;  // radius over the largest deviation: the centre is linear
  const double radius = kMagnified * std::max(r.abs().maxCoeff(), 1e-12);
  std::vector<Eigen::Vector2d> points;
  points.reserve(static_cast<std::size_t>(r.size()));
  for (Eigen::Index j = 0; j < r.cols(); ++j) {
    for (Eigen::Index i = 0; i < r.rows(); ++i) {
      points.emplace_back((1.0 + r(i, j) / radius) *
                          Eigen::Vector2d(std::cos(theta[i]), std::sin(theta[i])));
    }
  }
  return metrology::minimum_zone(points).width() * radius;
}

}  // namespace

ErrorMotion evaluate_error_motion(const Eigen::ArrayXd& theta, const Eigen::ArrayXXd& r,
                                  Centre centre) {
  ErrorMotion out;
  const Eigen::ArrayXd mean = r.rowwise().mean();
  const Eigen::Vector3d harmonic = first_harmonic(theta, mean);
  const Eigen::ArrayXd fundamental = wave(theta, harmonic);
  out.fundamental = 2.0 * std::hypot(harmonic[1], harmonic[2]);
  out.residual = range(mean - fundamental);
  out.asynchronous = (r.rowwise().maxCoeff() - r.rowwise().minCoeff()).maxCoeff();
  if (centre == Centre::polar_chart) {
    out.total = range(r);
    out.synchronous = range(mean);
    out.total_mrs = out.total;
  } else {
    const Eigen::ArrayXXd about = r.colwise() - (fundamental + harmonic[0]);
    out.total = range(about);
    out.synchronous = out.residual;
    out.total_mrs = minimum_zone_width(theta, about);
  }
  return out;
}

RotationTest rotation_of(std::string name, const Eigen::ArrayXd& theta,
                         const RotationSensors& sensors, double distance) {
  RotationTest out{std::move(name), theta, {}};
  const Eigen::Index revolutions = sensors.begin()->second.cols();
  const auto has = [&](std::string_view one) { return sensors.contains(one); };
  const auto rotating = [&](const Eigen::ArrayXXd& x, const Eigen::ArrayXXd& y) {
    return Eigen::ArrayXXd(x * theta.cos().replicate(1, revolutions) +
                           y * theta.sin().replicate(1, revolutions));
  };
  const auto add = [&](std::string channel, Dimension dimension, Centre centre,
                       Eigen::ArrayXXd readings) {
    out.channels.push_back({std::move(channel), dimension, centre, std::move(readings)});
  };
  constexpr Centre kCentred = Centre::least_squares_circle;
  for (const std::string_view one : {"x", "y", "x2", "y2"}) {
    if (!has(one)) continue;
    add(fmt::format("radial_{}", one), Dimension::length, kCentred, sensors.at(one));
  }
  if (has("x") && has("y")) {
    add("radial_rotating", Dimension::length, kCentred, rotating(sensors.at("x"), sensors.at("y")));
  }
  if (has("z")) add("axial", Dimension::length, Centre::polar_chart, sensors.at("z"));
  RotationSensors tilt;
  for (const auto& [near, far] : {std::pair("x", "x2"), std::pair("y", "y2")}) {
    if (!has(near) || !has(far)) continue;
    tilt[near] = (sensors.at(far) - sensors.at(near)) / distance;
    add(fmt::format("tilt_{}", near), Dimension::angle, kCentred, tilt.at(near));
  }
  if (tilt.size() == 2) {
    add("tilt_rotating", Dimension::angle, kCentred, rotating(tilt.at("x"), tilt.at("y")));
  }
  return out;
}

// Curves are drawn about the same centre as their values: without the first harmonic (LSC), or
// about the polar chart centre for axial error motion, whose first harmonic is an error of the axis
// itself.
Report rotation_report(const RotationTest& test) {
  Report out;
  out.standard = "ISO 230-7";
  out.name = test.name;
  const auto revolutions = test.channels.front().r.cols();
  out.headline = fmt::format("{} revolutions of {} angles", revolutions, test.theta.size());
  for (const RotationTest::Channel& channel : test.channels) {
    const ErrorMotion one = evaluate_error_motion(test.theta, channel.r, channel.centre);
    const bool is_axial = channel.centre == Centre::polar_chart;
    const std::string centre = is_axial ? "" : ", LSC";
    const auto add = [&](std::string_view symbol, std::string_view meaning, double value) {
      out.values.push_back({fmt::format("{}_{}", channel.name, symbol),
                            fmt::format("{} error motion{}", meaning, centre), value,
                            channel.dimension});
    };
    add("total", "total", one.total);
    add("synchronous", "synchronous", one.synchronous);
    if (revolutions > 1) add("asynchronous", "asynchronous", one.asynchronous);
    if (is_axial) {
      add("fundamental", "fundamental", one.fundamental);
      add("residual", "residual synchronous", one.residual);
    } else {
      out.values.push_back({fmt::format("{}_total_MRS", channel.name),
                            "total error motion, minimum radial separation", one.total_mrs,
                            channel.dimension});
    }
    ReportTable curve{fmt::format("curve {}", channel.name), true, {}, {}};
    curve.columns.push_back({"angle", Dimension::angle, true, {}});
    curve.columns.push_back({"synchronous", channel.dimension, false, {}});
    const Eigen::ArrayXd mean = channel.r.rowwise().mean();
    const Eigen::Vector3d harmonic = first_harmonic(test.theta, mean);
    for (Eigen::Index i = 0; i < mean.size(); ++i) {
      const double centred =
          mean[i] - harmonic[0] - (is_axial ? 0.0 : wave(test.theta, harmonic)[i]);
      curve.columns[0].values.push_back(test.theta[i]);
      curve.columns[1].values.push_back(centred);
    }
    out.tables.push_back(std::move(curve));
  }
  if (revolutions < 2) {
    out.remarks.emplace_back(
        "one revolution: asynchronous error motion needs several revolutions and is included in "
        "the synchronous one");
  }
  return out;
}

}  // namespace servomill::sim::standards
