#include "plant/cutting/cutting_force.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "plant/cutting/edge_integrals.h"

namespace servomill::plant {
namespace {

constexpr double kPi = std::numbers::pi, kTurn = 2.0 * kPi;
constexpr double kNoChip = 1e-12;  // of h / c, rounding: below it an edge slides along the feed

// Over the part of an arc that is in contact, whole turns apart.
EdgeIntegrals integrals_of(const EngagedArc& arc, const AngleRange& contact) {
  EdgeIntegrals sum;
  if (contact.empty()) return sum;
  for (const double turn : {-kTurn, 0.0, kTurn}) {
    sum.add(std::max(arc.from, contact.from + turn), std::min(arc.to, contact.to + turn));
  }
  return sum;
}

// h / c
double chip(const FeedDirection& feed, double kappa, double phi) {
  return feed.across * std::sin(kappa) * std::sin(phi) - feed.along * std::cos(kappa);
}

bool holds(const EngagedArc& arc, double phi) {
  const double beyond = std::fmod(phi - arc.from, kTurn);
  return (beyond < 0.0 ? beyond + kTurn : beyond) < arc.to - arc.from;
}

}  // namespace

AngleRange contact_range(const FeedDirection& feed, double kappa) {
  const double most = feed.across * std::sin(kappa), least = feed.along * std::cos(kappa);
  if (least >= most - kNoChip) return {};
  if (least < -most) return {-0.5 * kPi, 1.5 * kPi};
  const double first = std::asin(least / most);
  return {first, kPi - first};
}

CuttingForce average_force(const CuttingCoefficients& K, int teeth, const FeedDirection& feed,
                           std::span<const EngagedArc> arcs) {
  CuttingForce sum;
  for (const EngagedArc& arc : arcs) {
    const EdgeIntegrals I = integrals_of(arc, contact_range(feed, arc.kappa));
    const double sk = std::sin(arc.kappa), ck = std::cos(arc.kappa);
    const double a = feed.across * sk, b = feed.along * ck;  // h = c (a sin(phi) - b)
    const double h_one = a * I.sine - b * I.one;
    const double h_sine = a * I.sine_squared - b * I.sine;
    const double h_cosine = a * I.sine_cosine - b * I.cosine;
    const double per_turn = teeth * arc.width / kTurn;
    const double outward_c = K.Krc * sk + K.Kac * ck, outward_e = K.Kre * sk + K.Kae * ck;
    sum.shear += per_turn * Eigen::Vector3d(-outward_c * h_sine - K.Ktc * h_cosine,
                                            -outward_c * h_cosine + K.Ktc * h_sine,
                                            (K.Krc * ck - K.Kac * sk) * h_one);
    sum.edge += per_turn * Eigen::Vector3d(-outward_e * I.sine - K.Kte * I.cosine,
                                           -outward_e * I.cosine + K.Kte * I.sine,
                                           (K.Kre * ck - K.Kae * sk) * I.one);
  }
  return sum;
}

CuttingTorque average_torque(const CuttingCoefficients& K, int teeth, const FeedDirection& feed,
                             std::span<const EngagedArc> arcs) {
  CuttingTorque sum;
  for (const EngagedArc& arc : arcs) {
    const EdgeIntegrals I = integrals_of(arc, contact_range(feed, arc.kappa));
    const double h_one =
        feed.across * std::sin(arc.kappa) * I.sine - feed.along * std::cos(arc.kappa) * I.one;
    const double per_turn = teeth * arc.width * arc.radius / kTurn;
    sum.shear += per_turn * K.Ktc * h_one;
    sum.edge += per_turn * K.Kte * I.one;
  }
  return sum;
}

Eigen::Vector3d force_at_rotation(const CuttingCoefficients& K, const Cutter& cutter,
                                  const FeedDirection& feed, std::span<const EngagedArc> arcs,
                                  double theta, double c, double wear) {
  Eigen::Vector3d F = Eigen::Vector3d::Zero();
  for (const EngagedArc& arc : arcs) {
    const double lag = arc.height * std::tan(cutter.helix) / cutter.radius;
    const double sk = std::sin(arc.kappa), ck = std::cos(arc.kappa);
    for (int tooth = 0; tooth < cutter.teeth; ++tooth) {
      const double phi = theta + kTurn * tooth / cutter.teeth - lag;
      const double h = c * chip(feed, arc.kappa, phi);
      if (h <= kNoChip * c || !holds(arc, phi)) continue;
      const Eigen::Vector3d r(std::sin(phi), std::cos(phi), 0.0);
      const Eigen::Vector3d t(std::cos(phi), -std::sin(phi), 0.0);
      const Eigen::Vector3d n = sk * r - ck * Eigen::Vector3d::UnitZ();
      const Eigen::Vector3d m = ck * r + sk * Eigen::Vector3d::UnitZ();
      F -= arc.width * ((K.Ktc * h + wear * K.Kte) * t + (K.Krc * h + wear * K.Kre) * n +
                        (K.Kac * h + wear * K.Kae) * m);
    }
  }
  return F;
}

}  // namespace servomill::plant
