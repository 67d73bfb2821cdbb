import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { BUCKET, PyramidBuilder, levelFor, rangeOf, rowsWithin } from "../../../tools/page/src/core/pyramid.js";

function pyramidOf(values, block = values.length) {
  const builder = new PyramidBuilder(values.length);
  for (let from = 0; from < values.length; from += block) builder.push(values.slice(from, from + block));
  return builder.finish();
}

const wave = (count) => Float64Array.from({ length: count }, (_, i) => Math.sin(i / 37) + 0.3 * Math.sin(i * 1.7));

describe("pyramid", () => {
  it("holds the extremes of every bucket on every level", () => {
    const values = wave(5003);
    for (const level of pyramidOf(values).levels) {
      level.min.forEach((low, i) => {
        const rows = values.slice(i * level.size, (i + 1) * level.size);
        assert.equal(low, Math.min(...rows));
        assert.equal(level.max[i], Math.max(...rows));
      });
    }
  });

  it("does not depend on the blocks that the values come in", () => {
    const values = wave(1000);
    for (const block of [1, 7, BUCKET, 333]) assert.deepEqual(pyramidOf(values, block), pyramidOf(values));
  });

  it("passes over what is not a number, and keeps a bucket without any", () => {
    const values = wave(4 * BUCKET);
    values.fill(NaN, BUCKET, 2 * BUCKET);
    values[0] = NaN;
    const { min, max } = pyramidOf(values).levels[0];
    assert.equal(min[0], Math.min(...values.slice(1, BUCKET)));
    assert.ok(Number.isNaN(min[1]) && Number.isNaN(max[1]));
    assert.ok(rangeOf(pyramidOf(values)).every(Number.isFinite));
    assert.ok(rangeOf(pyramidOf(new Float64Array(40).fill(NaN))).every(Number.isNaN));
  });

  it("refuses more and fewer values than rows", () => {
    const builder = new PyramidBuilder(3);
    builder.push([1, 2]);
    assert.throws(() => builder.finish(), RangeError);
    assert.throws(() => builder.push([3, 4]), RangeError);
  });

  it("chooses rows where they are few and else the finest level that is coarse enough", () => {
    const pyramid = pyramidOf(wave(100_000));
    assert.equal(levelFor(pyramid, 200, 100), undefined);
    const level = levelFor(pyramid, 100_000, 1000);
    assert.ok(100_000 / level.size <= 1000);
    assert.ok((2 * 100_000) / level.size > 1000);
  });

  it("finds the rows of an interval, also where the values return", () => {
    const values = Float64Array.from({ length: 2000 }, (_, i) => Math.abs(1000 - i));
    const intervals = rowsWithin(pyramidOf(values), 100, 200);
    assert.equal(intervals.length, 2);
    values.forEach((value, row) => {
      const found = intervals.some(([from, to]) => row >= from && row < to);
      if (value >= 100 && value <= 200) assert.ok(found, `row ${row}`);
      if (value < 50 || value > 250) assert.ok(!found, `row ${row}`);
    });
    assert.deepEqual(rowsWithin(pyramidOf(values), 5000, 6000), []);
  });
});
