#include "plant/cutting/vibrating_teeth.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace servomill::plant {
namespace {

constexpr double kCircle = 2.0 * std::numbers::pi;
constexpr double kLongestSpan = kCircle / 72.0;  // rad

// Chip along + sine sin(phi) + cosine cos(phi), m.
struct Chip {
  double one = 0.0, sine = 0.0, cosine = 0.0;
  double at(double phi) const { return one + sine * std::sin(phi) + cosine * std::cos(phi); }
};

// The thinnest chip of (1) at phi.
Chip chip_at(double phi, std::span<const double> offsets, std::size_t tooth, const EdgeSlice& slice,
             double c, const PassageDifferences& between) {
  Chip thinnest;
  double least = 0.0;
  for (std::size_t m = 1; m <= between.size(); ++m) {
    const Eigen::Vector2d& x = between[m - 1];
    const double feed = static_cast<double>(m) * c;
    const double runout = offsets[tooth] - offsets[(tooth + m) % offsets.size()];
    const Chip chip{runout * slice.sine - feed * slice.along,
                    feed * slice.across + slice.sine * x.x(), slice.sine * x.y()};
    const double h = chip.at(phi);
    if (m > 1 && h >= least) continue;
    thinnest = chip;
    least = h;
  }
  return thinnest;
}

// Adds the force of a chip, integrated over phi.
void add_chip(const CuttingCoefficients& K, const EdgeSlice& slice, const EdgeIntegrals& I,
              const Chip& h, double wear, Eigen::Vector3d& F) {
  const double one = h.one * I.one + h.sine * I.sine + h.cosine * I.cosine;
  const double sine = h.one * I.sine + h.sine * I.sine_squared + h.cosine * I.sine_cosine;
  const double cosine =
      h.one * I.cosine + h.sine * I.sine_cosine + h.cosine * (I.one - I.sine_squared);
  const double sk = slice.sine, ck = slice.cosine;
  const double outward_c = K.Krc * sk + K.Kac * ck, outward_e = wear * (K.Kre * sk + K.Kae * ck);
  const double Kte = wear * K.Kte;
  F.x() -= slice.width * (outward_c * sine + K.Ktc * cosine + outward_e * I.sine + Kte * I.cosine);
  F.y() -= slice.width * (outward_c * cosine - K.Ktc * sine + outward_e * I.cosine - Kte * I.sine);
  F.z() +=
      slice.width * ((K.Krc * ck - K.Kac * sk) * one + wear * (K.Kre * ck - K.Kae * sk) * I.one);
}

}  // namespace

std::vector<EdgeSlice> short_slices(std::span<const EdgeSlice> slices) {
  std::vector<EdgeSlice> out;
  for (const EdgeSlice& slice : slices) {
    const int parts = std::max(1, static_cast<int>(std::ceil(slice.lag_span / kLongestSpan)));
    for (int part = 0; part < parts; ++part) {
      EdgeSlice one = slice;
      one.width /= parts;
      one.lag_span /= parts;
      one.lag += part * one.lag_span;
      out.push_back(one);
    }
  }
  return out;
}

std::vector<double> radius_offsets(const Cutter& cutter) {
  std::vector<double> out;
  for (int tooth = 0; tooth < cutter.teeth; ++tooth) out.push_back(cutter.radius_offset(tooth));
  return out;
}

Eigen::Vector3d mean_vibrating_force(const CuttingCoefficients& K, std::span<const double> offsets,
                                     std::span<const EdgeSlice> slices,
                                     const EdgeRotation& rotation, double c, double wear,
                                     const PassageDifferences& between) {
  Eigen::Vector3d F = Eigen::Vector3d::Zero();
  if (!(c > 0.0)) return F;
  for (const EdgeSlice& slice : slices) {
    const double middle = 0.5 * (slice.from + slice.to);
    const double reach = 0.5 * (slice.to - slice.from + rotation.dtheta + slice.lag_span);
    for (std::size_t tooth = 0; tooth < offsets.size(); ++tooth) {
      const double share = static_cast<double>(tooth) / static_cast<double>(offsets.size());
      const double phi = rotation.phi - slice.lag + kCircle * share;
      const double centre = phi + 0.5 * (rotation.dtheta - slice.lag_span);
      const double off = std::remainder(centre - middle, kCircle);  // most are not in contact
      if (std::abs(off) > reach && reach < 0.5 * kCircle) continue;
      const double where = std::clamp(middle + off, slice.from, slice.to);
      const Chip chip = chip_at(where, offsets, tooth, slice, c, between);
      const double h = chip.at(where);
      if (h <= -kRubbing) continue;
      add_chip(K, slice,
               rotation_integrals({phi, rotation.dtheta}, slice.lag_span, slice.from, slice.to),
               h > 0.0 ? chip : Chip{}, wear, F);
    }
  }
  return F / rotation.dtheta;
}

}  // namespace servomill::plant
