import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { bestFitCircle, planeOfCircle, radialDeviation } from "../../../tools/page/src/core/circle.js";

const angles = (count, turn = 2 * Math.PI) => Array.from({ length: count }, (_, i) => (turn * i) / count);
const near = (actual, expected, tolerance) => assert.ok(Math.abs(actual - expected) < tolerance, `${actual} is not ${expected}`);

describe("best-fit circle", () => {
  it("finds centre and radius of points on a circle, also of an arc", () => {
    for (const turn of [2 * Math.PI, 1.2]) {
      const { cx, cy, radius } = bestFitCircle(
        angles(300, turn).map((a) => 12 + 50 * Math.cos(a)),
        angles(300, turn).map((a) => -7 + 50 * Math.sin(a)),
      );
      near(cx, 12, 1e-9);
      near(cy, -7, 1e-9);
      near(radius, 50, 1e-9);
    }
  });

  it("finds none of points on a line", () => {
    assert.equal(bestFitCircle([0, 1, 2, 3], [0, 1, 2, 3]), undefined);
  });

  it("takes an eccentricity out of the deviation and leaves an ellipse, with its axes along the diagonals", () => {
    // A squareness of beta makes an ellipse: dr = R beta / 2 sin(2 a).
    const [R, beta] = [50, 100e-6];
    const x = angles(720).map((a) => 3e-3 + R * (Math.cos(a) + beta * Math.sin(a)));
    const y = angles(720).map((a) => R * Math.sin(a));
    const { circularity, cx, angle, deviation } = radialDeviation(x, y, R);
    near(circularity, R * beta, 1e-6);
    near(cx, 3e-3, 1e-6);
    const largest = deviation.indexOf(Math.max(...deviation));
    near(Math.abs(Math.sin(2 * angle[largest])), 1, 1e-3);
  });
});

describe("plane of a circle", () => {
  const circle = (turn, sense = 1) => [
    angles(400, turn).map((a) => 20 * Math.cos(a)),
    angles(400, turn).map((a) => sense * 20 * Math.sin(a)),
    angles(400).map(() => 5),
  ];

  it("is found with the sense of the path", () => {
    const found = planeOfCircle(circle(2 * Math.PI, -1));
    assert.deepEqual([found.first, found.second], [0, 1]);
    near(found.circle.radius, 20, 1e-9);
    assert.ok(found.angle < 0);
  });

  it("is right-handed in every plane", () => {
    const [x, y, z] = circle(2 * Math.PI);
    const yz = planeOfCircle([z, x, y]);
    assert.deepEqual([yz.first, yz.second, Math.sign(yz.angle)], [1, 2, 1]);
    const zx = planeOfCircle([y, z, x]);
    assert.deepEqual([zx.first, zx.second, Math.sign(zx.angle)], [2, 0, 1]);
  });

  it("is none of a line, a short arc, a square, a helix, or a standstill", () => {
    const [x, y, z] = circle(2 * Math.PI);
    assert.equal(planeOfCircle([x, x.map(() => 0), z]), undefined);
    assert.equal(planeOfCircle(circle(1.5)), undefined);
    assert.equal(planeOfCircle([x.map(Math.sign), y.map(Math.sign), z]), undefined);
    assert.equal(planeOfCircle([x, y, z.map((_, i) => i / 100)]), undefined);
    assert.equal(planeOfCircle([z, z, z]), undefined);
  });
});
