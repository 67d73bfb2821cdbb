/* The yardstick: the reference problem as a straightforward loop in C, one axis after the other,
   one base tick after the other. Speeds are stated as ratios to it, taken in the same run. */
#ifndef SERVOMILL_BENCH_PLAIN_H
#define SERVOMILL_BENCH_PLAIN_H
#ifdef __cplusplus
extern "C" {
#endif

enum { PLAIN_AXES = 5, PLAIN_SIGNALS = 40 };

/* One axis; SI, names as in tests/known_answers/reference_problem/README.txt. */
typedef struct {
  double L, R, Kt, Ke, Jm, Bm, r, mt, k, c, b;
  double Fc, Fs, vs, v0;
  double Kv, kvf, kaf, Jt;
  double Kp, Ki_Tv, i_max;  /* velocity loop; gain of the integral for one period */
  double Kpi, Ki_Ti, u_max; /* current loop */
  double Ad[5][5], Bd[5];   /* linear drive over one tick: x+ = Ad x + Bd u */
} PlainAxis;

/* Displacement of the tool tip (m) by the 21 errors `vol` at x, y, z (m). */
void plain_volumetric(const double vol[21][4], double x, double y, double z, double e[3]);

/* Runs `ticks` ticks of 10 us; 40 signals every 100 ticks go to `log`. `friction` chooses N. */
void plain_run(const PlainAxis axes[PLAIN_AXES], const double vol[21][4], int friction, long ticks,
               double* log);

#ifdef __cplusplus
}
#endif
#endif
