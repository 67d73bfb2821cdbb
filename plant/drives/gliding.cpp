#include "plant/drives/gliding.h"

#include <algorithm>

namespace servomill::plant {

// A drive with cogging nowhere is linear, one with backlash may be but has events there, too.
Gliding gliding_of(const FeedDriveParams& p) {
  const FrictionParams& f = p.friction;
  if (p.on_bed() || p.cogging.T != 0.0 || p.gap > 0.0 || f.b_positive > 0.0 || f.b_negative > 0.0)
    return {};
  Gliding g{.speed = 0.0};
  if (f.kind == FrictionKind::none) return g;
  if (f.Fs_positive != f.Fc_positive || f.Fs_negative != f.Fc_negative) {
    g.speed = kStribeckEnd * f.vs;
  }
  if (f.kind == FrictionKind::regularised) g.speed = std::max(g.speed, kTanhEnd * f.v0);
  g.Fc_positive = f.Fc_positive;
  g.Fc_negative = f.Fc_negative;
  if (f.kind == FrictionKind::lugre) g.sigma0 = f.sigma0;
  return g;
}

}  // namespace servomill::plant
