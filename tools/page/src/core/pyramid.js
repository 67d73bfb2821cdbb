/**
 * Minimum and maximum of a column over buckets of rows, level by level, so that a curve of millions of
 * rows is drawn from a few thousand numbers without losing a peak.
 */

/** Rows of a bucket of the finest level. */
export const BUCKET = 16;
/** Buckets of a level that one bucket of the next level covers. */
export const FACTOR = 2;

/**
 * @typedef {object} Level
 * @property {number} size rows of a bucket
 * @property {Float64Array} min least value of each bucket, NaN where all its rows are
 * @property {Float64Array} max
 */

/** @typedef {{rows: number, levels: Level[]}} Pyramid finest level first */

function extend(level, bucket, low, high) {
  // Comparisons with NaN are false: an empty bucket takes any number, a number never gives way to NaN.
  if (!(level.min[bucket] <= low) && low === low) level.min[bucket] = low;
  if (!(level.max[bucket] >= high) && high === high) level.max[bucket] = high;
}

function emptyLevel(size, rows) {
  const count = Math.ceil(rows / size);
  return { size, min: new Float64Array(count).fill(NaN), max: new Float64Array(count).fill(NaN) };
}

function coarser(level, rows) {
  const next = emptyLevel(level.size * FACTOR, rows);
  for (let i = 0; i < level.min.length; ++i) {
    extend(next, Math.floor(i / FACTOR), level.min[i], level.max[i]);
  }
  return next;
}

/** Builds a pyramid from the values of a column in their order, block by block. */
export class PyramidBuilder {
  /** @param {number} rows of the whole column */
  constructor(rows) {
    this.rows = rows;
    this.row = 0;
    this.level = emptyLevel(BUCKET, rows);
  }

  /** @param {ArrayLike<number>} values the next rows */
  push(values) {
    if (this.row + values.length > this.rows) throw new RangeError("more values than rows");
    const { min, max } = this.level;
    for (let i = 0; i < values.length;) {
      const bucket = Math.floor(this.row / BUCKET);
      const end = Math.min(values.length, i + (bucket + 1) * BUCKET - this.row);
      let low = min[bucket];
      let high = max[bucket];
      this.row += end - i;
      for (; i < end; ++i) {
        const value = values[i];
        if (value !== value) continue;
        if (!(low <= value)) low = value;
        if (!(high >= value)) high = value;
      }
      min[bucket] = low;
      max[bucket] = high;
    }
  }

  /** @returns {Pyramid} */
  finish() {
    if (this.row !== this.rows) throw new RangeError(`${this.row} of ${this.rows} rows`);
    const levels = [this.level];
    while (levels.at(-1).min.length > FACTOR) levels.push(coarser(levels.at(-1), this.rows));
    return { rows: this.rows, levels };
  }
}

/**
 * The finest level that needs at most `buckets` buckets for so many rows.
 * @param {Pyramid} pyramid
 * @param {number} rows
 * @param {number} buckets
 * @returns {Level | undefined} undefined if the rows themselves are few enough
 */
export function levelFor(pyramid, rows, buckets) {
  if (rows <= 2 * buckets) return undefined;
  return pyramid.levels.find((level) => rows / level.size <= buckets) ?? pyramid.levels.at(-1);
}

/**
 * Least and greatest value of a column.
 * @param {Pyramid} pyramid
 * @returns {[number, number]} NaN if it has no number
 */
export function rangeOf(pyramid) {
  const top = emptyLevel(pyramid.rows || 1, 1);
  const { min, max } = pyramid.levels.at(-1);
  for (let i = 0; i < min.length; ++i) extend(top, 0, min[i], max[i]);
  return [top.min[0], top.max[0]];
}

/**
 * Intervals of rows, at most a bucket longer on both sides than needed, whose values lie within limits.
 * @param {Pyramid} pyramid
 * @param {number} low
 * @param {number} high
 * @returns {[number, number][]} first row, row behind the last
 */
export function rowsWithin(pyramid, low, high) {
  const { size, min, max } = pyramid.levels[0];
  /** @type {[number, number][]} */
  const intervals = [];
  for (let i = 0; i < min.length; ++i) {
    if (!(max[i] >= low && min[i] <= high)) continue;
    const from = Math.max(0, (i - 1) * size);
    const to = Math.min(pyramid.rows, (i + 2) * size);
    const last = intervals.at(-1);
    if (last && from <= last[1]) last[1] = to;
    else intervals.push([from, to]);
  }
  return intervals;
}
