#include "plain.h"

#include <math.h>
#include <string.h>

typedef struct {
  double x[5]; /* i, w, th, v, x */
  double u, y, ref, ref_1, ref_2, v_cmd, T_ff, i_cmd, I_v, I_i, th_1;
} Axis;

static const double kPi = 3.14159265358979323846, kTick = 1e-5;

static double cubic(const double c[4], double s) {
  return c[0] + s * (c[1] + s * (c[2] + s * c[3]));
}

static void multiply(double out[4][4], double a[4][4], double b[4][4]) {
  for (int i = 0; i < 4; i++) {
    for (int j = 0; j < 4; j++) {
      double sum = 0.0;
      for (int k = 0; k < 4; k++) sum += a[i][k] * b[k][j];
      out[i][j] = sum;
    }
  }
}

void plain_volumetric(const double vol[21][4], double x, double y, double z, double e[3]) {
  const double q[3] = {x, y, z}, tool[3] = {0.0, 0.0, -0.15};
  double T[3][4][4], XY[4][4], XYZ[4][4];
  for (int axis = 0; axis < 3; axis++) {
    double d[3], r[3];
    for (int i = 0; i < 3; i++) {
      d[i] = cubic(vol[6 * axis + i], q[axis]);
      r[i] = cubic(vol[6 * axis + 3 + i], q[axis]);
    }
    d[axis] += q[axis];
    if (axis == 1) d[0] -= cubic(vol[18], y) * y;
    if (axis == 2) {
      d[0] += cubic(vol[19], z) * z;
      d[1] -= cubic(vol[20], z) * z;
    }
    const double M[4][4] = {{1.0, -r[2], r[1], d[0]},
                            {r[2], 1.0, -r[0], d[1]},
                            {-r[1], r[0], 1.0, d[2]},
                            {0.0, 0.0, 0.0, 1.0}};
    memcpy(T[axis], M, sizeof M);
  }
  multiply(XY, T[0], T[1]);
  multiply(XYZ, XY, T[2]);
  for (int i = 0; i < 3; i++) {
    e[i] = XYZ[i][0] * tool[0] + XYZ[i][1] * tool[1] + XYZ[i][2] * tool[2] + XYZ[i][3] -
           (q[i] + tool[i]);
  }
}

static double cycloid(double q) { return q - sin(2.0 * kPi * q) / (2.0 * kPi); }

static void reference(double t, double q[PLAIN_AXES]) {
  const double tau = t < 1.0 ? 0.5 * t - sin(kPi * t) / (2.0 * kPi) : t - 0.5;
  const double s = 2.0 * kPi * tau, p = t - 2.0 * floor(t / 2.0);
  q[0] = 0.05 * (1.0 - cos(0.5 * s));
  q[1] = 0.05 * sin(0.5 * s);
  q[2] = 0.0;
  if (p < 0.6)
    q[2] = 0.12 * cycloid(p / 0.6);
  else if (p < 1.0)
    q[2] = 0.12;
  else if (p < 1.6)
    q[2] = 0.12 * (1.0 - cycloid((p - 1.0) / 0.6));
  q[3] = 0.03 * sin(0.8 * s);
  q[4] = 0.02 * sin(s) + 0.001 * sin(7.0 * s);
}

static double friction_force(const PlainAxis* p, double v) {
  const double q = v / p->vs;
  return (p->Fc + (p->Fs - p->Fc) * exp(-q * q)) * tanh(v / p->v0);
}

static void derivative(const PlainAxis* p, double u, const double x[5], double dx[5]) {
  const double screw = p->k * (p->r * x[2] - x[4]) + p->c * (p->r * x[1] - x[3]);
  dx[0] = (u - p->R * x[0] - p->Ke * x[1]) / p->L;
  dx[1] = (p->Kt * x[0] - p->r * screw - p->Bm * x[1]) / p->Jm;
  dx[2] = x[1];
  dx[3] = (screw - p->b * x[3] - friction_force(p, x[3])) / p->mt;
  dx[4] = x[3];
}

static void runge_kutta(const PlainAxis* p, double u, double x[5], double h) {
  double k1[5], k2[5], k3[5], k4[5], at[5];
  derivative(p, u, x, k1);
  for (int i = 0; i < 5; i++) at[i] = x[i] + 0.5 * h * k1[i];
  derivative(p, u, at, k2);
  for (int i = 0; i < 5; i++) at[i] = x[i] + 0.5 * h * k2[i];
  derivative(p, u, at, k3);
  for (int i = 0; i < 5; i++) at[i] = x[i] + h * k3[i];
  derivative(p, u, at, k4);
  for (int i = 0; i < 5; i++) x[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
}

static void exact_step(const PlainAxis* p, double u, double x[5]) {
  double next[5];
  for (int i = 0; i < 5; i++) {
    double sum = p->Bd[i] * u;
    for (int j = 0; j < 5; j++) sum += p->Ad[i][j] * x[j];
    next[i] = sum;
  }
  memcpy(x, next, sizeof next);
}

static double clamp(double value, double limit) {
  return value > limit ? limit : value < -limit ? -limit : value;
}

static void position_loop(const PlainAxis* p, Axis* a, double q) {
  const double Tp = 120.0 * kTick;
  a->ref = q;
  a->v_cmd = p->Kv * (q - a->y) + p->kvf * (q - a->ref_1) / Tp;
  a->T_ff = p->kaf * p->Jt / p->r * (q - 2.0 * a->ref_1 + a->ref_2) / (Tp * Tp);
  a->ref_2 = a->ref_1;
  a->ref_1 = q;
}

static void velocity_loop(const PlainAxis* p, Axis* a, int limits) {
  const double w = (a->x[2] - a->th_1) / (20.0 * kTick), e = a->v_cmd / p->r - w;
  const double i = (p->Kp * e + a->I_v + a->T_ff) / p->Kt;
  a->th_1 = a->x[2];
  a->i_cmd = limits ? clamp(i, p->i_max) : i;
  if (a->i_cmd == i) a->I_v += p->Ki_Tv * e;
}

static void current_loop(const PlainAxis* p, Axis* a, int limits) {
  const double e = a->i_cmd - a->x[0], u = p->Kpi * e + a->I_i;
  a->u = limits ? clamp(u, p->u_max) : u;
  if (a->u == u) a->I_i += p->Ki_Ti * e;
}

void plain_run(const PlainAxis axes[PLAIN_AXES], const double vol[21][4], int friction, long ticks,
               double* log) {
  Axis state[PLAIN_AXES];
  double offset[PLAIN_AXES] = {0}, next[3] = {0}, q[PLAIN_AXES];
  memset(state, 0, sizeof state);
  for (long n = 0;; n++) {
    if (n % 6 == 0) {
      for (int i = 0; i < 3; i++) offset[i] = next[i];
      plain_volumetric(vol, state[0].x[4], state[1].x[4], state[2].x[4], next);
    }
    if (n % 120 == 0) reference((double)n * kTick, q);
    for (int i = 0; i < PLAIN_AXES; i++) {
      Axis* a = &state[i];
      const PlainAxis* p = &axes[i];
      a->y = a->x[4] + offset[i];
      if (n % 120 == 0) position_loop(p, a, q[i]);
      if (n % 20 == 0) velocity_loop(p, a, friction);
      if (n % 10 == 0) current_loop(p, a, friction);
    }
    if (n % 100 == 0) {
      for (int i = 0; i < PLAIN_AXES; i++) {
        const Axis* a = &state[i];
        const double row[8] = {a->ref, a->y, a->x[4], a->x[3], a->x[2], a->x[1], a->x[0], a->u};
        memcpy(log, row, sizeof row);
        log += 8;
      }
    }
    if (n == ticks) return;
    for (int i = 0; i < PLAIN_AXES; i++) {
      if (friction)
        runge_kutta(&axes[i], state[i].u, state[i].x, kTick);
      else
        exact_step(&axes[i], state[i].u, state[i].x);
    }
  }
}
