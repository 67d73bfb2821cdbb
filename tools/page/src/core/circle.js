/** Circles as a ball bar draws them: radial deviation over the angle about the best-fit centre. */

const ITERATIONS = 20;
const CONVERGED = 1e-12; // of the radius

/** Solves a symmetric system of three equations by Cramer's rule. */
function solve3(a, b) {
  const [[a00, a01, a02], [, a11, a12], [, , a22]] = a;
  const c00 = a11 * a22 - a12 * a12;
  const c01 = a02 * a12 - a01 * a22;
  const c02 = a01 * a12 - a02 * a11;
  const det = a00 * c00 + a01 * c01 + a02 * c02;
  const c11 = a00 * a22 - a02 * a02;
  const c12 = a01 * a02 - a00 * a12;
  const c22 = a00 * a11 - a01 * a01;
  return [
    (c00 * b[0] + c01 * b[1] + c02 * b[2]) / det,
    (c01 * b[0] + c11 * b[1] + c12 * b[2]) / det,
    (c02 * b[0] + c12 * b[1] + c22 * b[2]) / det,
  ];
}

/** Change of centre and radius of one step of Gauss and Newton. */
function correction(x, y, { cx, cy, radius }) {
  const a = [
    [0, 0, 0],
    [0, 0, 0],
    [0, 0, 0],
  ];
  const b = [0, 0, 0];
  for (let i = 0; i < x.length; ++i) {
    const dx = x[i] - cx;
    const dy = y[i] - cy;
    const rho = Math.hypot(dx, dy);
    const row = [dx / rho, dy / rho, 1];
    for (let j = 0; j < 3; ++j) {
      b[j] += row[j] * (rho - radius);
      for (let k = j; k < 3; ++k) a[j][k] += row[j] * row[k];
    }
  }
  return solve3(a, b);
}

/**
 * Circle with the smallest sum of squared radial distances.
 * @param {ArrayLike<number>} x at least three points that are not on a line
 * @param {ArrayLike<number>} y
 * @returns {{cx: number, cy: number, radius: number} | undefined} undefined where there is none
 */
export function bestFitCircle(x, y) {
  const mean = (values) => Array.prototype.reduce.call(values, (sum, v) => sum + v, 0) / values.length;
  const circle = { cx: mean(x), cy: mean(y), radius: 0 };
  for (let i = 0; i < x.length; ++i) circle.radius += Math.hypot(x[i] - circle.cx, y[i] - circle.cy) / x.length;
  for (let i = 0; i < ITERATIONS; ++i) {
    const [dx, dy, dr] = correction(x, y, circle);
    circle.cx += dx;
    circle.cy += dy;
    circle.radius += dr;
    if (!Number.isFinite(circle.radius) || circle.radius <= 0) return undefined;
    if (Math.hypot(dx, dy, dr) < CONVERGED * circle.radius) return circle;
  }
  return undefined;
}

/** Least angle about its centre that makes an arc a circle to be drawn; a ball bar measures 220 degrees at least. */
const MIN_SWEEP = (200 * Math.PI) / 180;

/** Angle from the first point to the last, turn by turn. */
function sweep(x, y, { cx, cy }) {
  let sum = 0;
  for (let i = 1; i < x.length; ++i) {
    const [ax, ay, bx, by] = [x[i - 1] - cx, y[i - 1] - cy, x[i] - cx, y[i] - cy];
    sum += Math.atan2(ax * by - ay * bx, ax * bx + ay * by);
  }
  return sum;
}

/**
 * Coordinates of the plane of a circle, or undefined if the nominal points are none.
 * @param {ArrayLike<number>[]} nominal X, Y and Z (mm)
 * @param {number} [flat] how far the path may leave its plane or its circle (mm)
 * @returns {{first: number, second: number, circle: {cx: number, cy: number, radius: number}, angle: number} | undefined}
 *   angle (rad) that the path turns by, counter-clockwise positive
 */
export function planeOfCircle(nominal, flat = 0.01) {
  if (nominal[0].length < 10) return undefined;
  const extent = nominal.map((values) => {
    let [low, high] = [Infinity, -Infinity];
    for (let i = 0; i < values.length; ++i) {
      if (values[i] < low) low = values[i];
      if (values[i] > high) high = values[i];
    }
    return high - low;
  });
  const normal = extent.indexOf(Math.min(...extent));
  const first = (normal + 1) % 3;
  const second = (normal + 2) % 3;
  const largest = Math.max(...extent);
  if (extent[normal] > flat || Math.min(extent[first], extent[second]) < Math.max(0.5 * largest, 10 * flat)) return undefined;
  const circle = bestFitCircle(nominal[first], nominal[second]);
  if (!circle) return undefined;
  for (let i = 0; i < nominal[0].length; ++i) {
    const rho = Math.hypot(nominal[first][i] - circle.cx, nominal[second][i] - circle.cy);
    if (Math.abs(rho - circle.radius) > flat) return undefined;
  }
  const angle = sweep(nominal[first], nominal[second], circle);
  return Math.abs(angle) >= MIN_SWEEP ? { first, second, circle, angle } : undefined;
}

/**
 * Radial deviation from the nominal radius, about the best-fit centre; outward is positive.
 * @param {ArrayLike<number>} x
 * @param {ArrayLike<number>} y
 * @param {number} nominalRadius
 * @returns {{angle: Float64Array, deviation: Float64Array, cx: number, cy: number, radius: number,
 *   circularity: number} | undefined} angle in rad, the rest in the unit of x; circularity is the range of the deviation
 */
export function radialDeviation(x, y, nominalRadius) {
  const circle = bestFitCircle(x, y);
  if (!circle) return undefined;
  const angle = new Float64Array(x.length);
  const deviation = new Float64Array(x.length);
  let [low, high] = [Infinity, -Infinity];
  for (let i = 0; i < x.length; ++i) {
    angle[i] = Math.atan2(y[i] - circle.cy, x[i] - circle.cx);
    deviation[i] = Math.hypot(x[i] - circle.cx, y[i] - circle.cy) - nominalRadius;
    low = Math.min(low, deviation[i]);
    high = Math.max(high, deviation[i]);
  }
  return { angle, deviation, ...circle, circularity: high - low };
}
