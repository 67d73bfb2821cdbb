#include "plant/cutting/directional_factors.h"

#include <cmath>
#include <numbers>

#include "plant/cutting/edge_integrals.h"

namespace servomill::plant {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// (1) of one slice, integrated over phi.
Eigen::Matrix2d of_slice(const CuttingCoefficients& K, const EdgeSlice& slice,
                         const EdgeIntegrals& I) {
  const double tangential = slice.width * slice.sine * K.Ktc;
  const double outward = slice.width * slice.sine * (K.Krc * slice.sine + K.Kac * slice.cosine);
  const double cosine_squared = I.one - I.sine_squared;
  Eigen::Matrix2d along, across;  // t r^T, r r^T
  along << I.sine_cosine, cosine_squared, -I.sine_squared, -I.sine_cosine;
  across << I.sine_squared, I.sine_cosine, I.sine_cosine, cosine_squared;
  return tangential * along + outward * across;
}

}  // namespace

std::vector<Eigen::Matrix2d> directional_factors(const CuttingCoefficients& K, int teeth,
                                                 std::span<const EdgeSlice> slices, int parts) {
  const double dphi = kTurn / teeth / parts;
  std::vector<Eigen::Matrix2d> out(static_cast<std::size_t>(parts), Eigen::Matrix2d::Zero());
  for (int part = 0; part < parts; ++part) {
    Eigen::Matrix2d& A = out[static_cast<std::size_t>(part)];
    for (const EdgeSlice& slice : slices) {
      for (int tooth = 0; tooth < teeth; ++tooth) {
        const double phi = kTurn * tooth / teeth + part * dphi - slice.lag;
        A += of_slice(K, slice,
                      rotation_integrals({phi, dphi}, slice.lag_span, slice.from, slice.to));
      }
    }
    A /= dphi;
  }
  return out;
}

std::vector<EdgeSlice> flank_slices(double depth, double from, double to, double helix,
                                    double radius) {
  return {{.from = from,
           .to = to,
           .width = depth,
           .lag = 0.0,
           .lag_span = depth * std::tan(helix) / radius}};
}

}  // namespace servomill::plant
