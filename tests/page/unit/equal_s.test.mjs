import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { differenceAtEqualS } from "../../../tools/page/src/core/equal_s.js";

const EXACT = 1e-12;
const near = (actual, expected) => assert.ok(Math.abs(actual - expected) < EXACT, `${actual} is not ${expected}`);

describe("difference at equal s", () => {
  it("of a case with itself is zero, also in its standstills", () => {
    const s = [0, 1, 1, 1, 2, 3, 3];
    const y = [5, 4, 3, 8, 1, 0, 7];
    assert.deepEqual([...differenceAtEqualS(s, y, s, y)], [0, 0, 0, 0, 0, 0, 0]);
  });

  it("compares the same place at different times", () => {
    const f = (s) => 3 + 2 * s;
    const s = Float64Array.from({ length: 50 }, (_, i) => i * 0.37);
    const sBase = Float64Array.from({ length: 90 }, (_, i) => (i / 80) ** 2 * 20);
    const difference = differenceAtEqualS(
      s,
      s.map((x) => f(x) + 0.25 * x),
      sBase,
      sBase.map(f),
    );
    difference.forEach((value, i) => near(value, 0.25 * s[i]));
  });

  it("compares a standstill at equal fractions of it, with any number of rows", () => {
    const difference = differenceAtEqualS([0, 1, 1, 1, 2], [0, 10, 20, 30, 0], [0, 1, 1, 1, 1, 1, 2], [0, 0, 1, 2, 3, 4, 0]);
    [0, 10, 18, 26, 0].forEach((value, i) => near(difference[i], value));
  });

  it("compares a single row with the end of the standstill of the baseline", () => {
    near(differenceAtEqualS([0, 1, 2], [0, 5, 0], [0, 1, 1, 1, 2], [0, 1, 2, 3, 0])[1], 2);
  });

  it("has no value beyond the path of the baseline", () => {
    const difference = differenceAtEqualS([0, 1, 2, 3], [1, 1, 1, 1], [1, 2], [0, 0]);
    assert.deepEqual([...difference].map(Number.isNaN), [true, false, false, true]);
  });
});
