#include "controllers/servo/cascade.h"

namespace servomill::controllers {

void set_lane(CascadeLanes& lanes, std::size_t lane, const CascadeGains& g) {
  lanes.Kv[lane] = g.Kv;
  lanes.kvf[lane] = g.kvf;
  lanes.v_max[lane] = g.v_max;
  lanes.i_per_a[lane] = g.i_per_a;
  lanes.per_r[lane] = g.per_r;
  lanes.per_Tv[lane] = g.per_Tv;
  lanes.per_Kt[lane] = g.per_Kt;
  lanes.Kp[lane] = g.Kp;
  lanes.Ki_Tv[lane] = g.Ki_Tv;
  lanes.i_max[lane] = g.i_max;
  lanes.di_max[lane] = g.di_max;
  lanes.filters.set_lane(lane, g.filters);
}

void set_lane(CascadeLanesState& lanes, std::size_t lane, const CascadeState& s) {
  lanes.v_cmd[lane] = s.v_cmd;
  lanes.i_ff[lane] = s.i_ff;
  lanes.integral[lane] = s.integral;
  lanes.phi[lane] = s.phi;
  lanes.w[lane] = s.w;
  lanes.e[lane] = s.e;
  lanes.i_next[lane] = s.i_next;
  lanes.i_cmd[lane] = s.i_cmd;
  for (std::size_t n = 0; n < s.filters.z.size(); ++n) lanes.filters.z[n][lane] = s.filters.z[n];
}

}  // namespace servomill::controllers
