/// Drives at random, about those of the axes of a milling machine.
#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "plant/drives/feed_drive.h"

namespace servomill::plant {

class Dice {
 public:
  explicit Dice(unsigned seed) : bits_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * std::ldexp(static_cast<double>(bits_()), -32);
  }
  double of_size(double low, double high) { return low * std::pow(high / low, between(0.0, 1.0)); }
  bool one_in(double n) { return between(0.0, n) < 1.0; }

 private:
  std::mt19937 bits_;
};

/// `small` scales forces and masses to a rotary axis.
inline FeedDriveParams random_drive(Dice& dice) {
  FeedDriveParams p;
  p.kind = dice.one_in(2)   ? DriveKind::two_mass
           : dice.one_in(2) ? DriveKind::rigid
                            : DriveKind::direct;
  const bool rotary = p.kind == DriveKind::direct;
  const double small = rotary ? 0.01 : 1.0;
  p.r = rotary ? 1.0 : 0.02 / (2.0 * std::numbers::pi);
  p.J = rotary ? dice.of_size(0.5, 20.0) : dice.of_size(3e-3, 3e-2);
  p.M = small * dice.of_size(100.0, 2000.0);
  p.k = dice.of_size(3e7, 6e8);
  if (!dice.one_in(5)) p.c = dice.of_size(1e3, 1e5);
  if (!dice.one_in(3)) p.b_motor = dice.of_size(0.003, 0.03);
  if (!dice.one_in(3)) p.b_load = small * dice.of_size(100.0, 5000.0);
  if (p.kind == DriveKind::two_mass && dice.one_in(3)) p.gap = dice.of_size(1e-7, 1e-4);
  p.Kt = rotary ? 10.0 : 1.6;
  if (dice.one_in(3)) {
    p.L = dice.of_size(2e-3, 1e-2);
    p.R = dice.of_size(0.3, 2.0);
    p.Ke = dice.of_size(0.3, 1.0);
  } else if (dice.one_in(2)) {
    p.T_i = dice.of_size(1e-4, 1e-3);
  }
  if (dice.one_in(3)) p.F_load = small * dice.between(-200.0, 200.0);

  const double Fc = small * dice.of_size(100.0, 600.0);
  FrictionParams& f = p.friction;
  f.kind = static_cast<FrictionKind>(static_cast<int>(dice.between(0.0, 4.0)));
  f.Fc_positive = Fc;
  f.Fc_negative = Fc * dice.between(0.7, 1.3);
  f.Fs_positive = f.Fc_positive * dice.between(1.0, 1.6);
  f.Fs_negative = f.Fc_negative * dice.between(1.0, 1.6);
  f.vs = dice.of_size(5e-4, 2e-2);
  f.v0 = dice.of_size(1e-5, 1e-3);
  f.sigma0 = small * dice.of_size(1e7, 2e8);
  if (!dice.one_in(5)) f.sigma1 = small * dice.of_size(1e3, 1e5);
  // as measured axes have it: friction that rises from breakaway on, and viscous by direction
  if (dice.one_in(4)) f.Fs_positive = f.Fc_positive * dice.between(0.3, 1.0);
  if (dice.one_in(4)) f.b_positive = small * dice.of_size(50.0, 2000.0);
  if (dice.one_in(4)) f.b_negative = small * dice.of_size(50.0, 2000.0);
  if (rotary && dice.one_in(2)) {
    p.cogging = {dice.between(0.0, Fc), std::floor(dice.between(10.0, 150.0)),
                 dice.between(0.0, 6.0)};
  }
  return p;
}

}  // namespace servomill::plant
