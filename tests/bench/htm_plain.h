/* The volumetric error of three linear axes as products of homogeneous matrices, in plain C: what
   speed is measured against. */
#ifndef SERVOMILL_HTM_PLAIN_H
#define SERVOMILL_HTM_PLAIN_H
#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  double cubic[3][6][4]; /* [axis][along x y z, about x y z][power]; m, rad */
  double xy, xz, yz;     /* squareness, rad */
  double tool[3];        /* m */
} htm_machine;

/* E(q) = T_X T_Y T_Z tool - (q + tool), T with 1 + [e]x as its rotation */
void htm_error(const htm_machine* m, const double q[3], double error[3]);

#ifdef __cplusplus
}
#endif
#endif
