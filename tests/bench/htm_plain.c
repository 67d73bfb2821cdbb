#include "htm_plain.h"

static double cubic(const double c[4], double s) {
  return ((c[3] * s + c[2]) * s + c[1]) * s + c[0];
}

static void transform(const htm_machine* m, int axis, double s, double H[4][4]) {
  double e[6];
  for (int n = 0; n < 6; n++) e[n] = cubic(m->cubic[axis][n], s);
  e[axis] += s;
  if (axis == 1) e[0] -= m->xy * s;
  if (axis == 2) {
    e[0] += m->xz * s;
    e[1] -= m->yz * s;
  }
  const double rows[4][4] = {
      {1, -e[5], e[4], e[0]}, {e[5], 1, -e[3], e[1]}, {-e[4], e[3], 1, e[2]}, {0, 0, 0, 1}};
  for (int i = 0; i < 4; i++) {
    for (int j = 0; j < 4; j++) H[i][j] = rows[i][j];
  }
}

static void product(double A[4][4], double B[4][4], double AB[4][4]) {
  for (int i = 0; i < 4; i++) {
    for (int j = 0; j < 4; j++) {
      AB[i][j] = 0;
      for (int k = 0; k < 4; k++) AB[i][j] += A[i][k] * B[k][j];
    }
  }
}

void htm_error(const htm_machine* m, const double q[3], double error[3]) {
  double X[4][4], Y[4][4], Z[4][4], XY[4][4], XYZ[4][4];
  transform(m, 0, q[0], X);
  transform(m, 1, q[1], Y);
  transform(m, 2, q[2], Z);
  product(X, Y, XY);
  product(XY, Z, XYZ);
  for (int i = 0; i < 3; i++) {
    error[i] = XYZ[i][3] - q[i] - m->tool[i];
    for (int j = 0; j < 3; j++) error[i] += XYZ[i][j] * m->tool[j];
  }
}
