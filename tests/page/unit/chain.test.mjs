import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { bodiesOf, chainOf, inverse, motion, product } from "../../../tools/page/src/core/chain.js";

const near = (actual, expected) =>
  expected.forEach((value, i) => assert.ok(Math.abs(actual[i] - value) < 1e-12, `${actual} is not ${expected}`));
const at = (m, [x, y, z]) => [0, 1, 2].map((i) => m[4 * i] * x + m[4 * i + 1] * y + m[4 * i + 2] * z + m[4 * i + 3]);

// [w C' B' b X Z t]: B about an inclined axis through a point
const r = Math.SQRT1_2;
const chain = chainOf({
  chain_axes: "CBXZ",
  chain_carries_workpiece: [1, 1, 0, 0],
  chain_directions: [0, 0, 1, 0, r, r, 1, 0, 0, 0, 0, 1],
  chain_points_mm: [0, 0, 0, 10, 0, 5, 0, 0, 0, 0, 0, 0],
});
const positions = { C: 30, B: 40, X: 100, Z: -20 };

describe("bodies of a machine", () => {
  it("are none where the file has no chain", () => {
    assert.deepEqual(chainOf({ finished: 1 }), []);
  });

  it("turn about the line through their point, by the angle", () => {
    const m = motion(chain[1], 180);
    near(at(m, [10, 0, 5]), [10, 0, 5]);
    near(at(m, [10 + 3, 0, 5]), [10 - 3, 0, 5]); // across the axis
    near(at(m, [10, r, 5 + r]), [10, r, 5 + r]); // along it
    near(product(m, inverse(m)), [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
  });

  it("of the workpiece side move against the counting of their axes, as seen from the bed", () => {
    const [{ joint, pose }] = bodiesOf(chain, { C: 30 });
    assert.equal(joint.letter, "C");
    near(at(pose, [1, 0, 0]), [Math.cos(Math.PI / 6), -Math.sin(Math.PI / 6), 0]);
  });

  it("put the tool, seen from the workpiece, where the product of all motions does", () => {
    const bodies = bodiesOf(chain, positions);
    const seen = product(inverse(bodies[0].pose), bodies[3].pose);
    near(seen, chain.map((joint) => motion(joint, positions[joint.letter])).reduce(product));
    near(at(bodies[3].pose, [0, 0, 0]), [100, 0, -20]);
    near(at(bodies[2].pose, [0, 0, 0]), [100, 0, 0]);
    near(at(bodies[1].pose, [10, 0, 5]), [10, 0, 5]); // B turns about its own line
  });
});
