/** Curves of a window: as many points as a screen shows, with every peak. */
import { levelFor, rangeOf, rowsWithin } from "../core/pyramid.js";

const BLOCK = 1 << 18; // rows read at a time where the rows themselves are needed

/** Points of a curve, grown as they come. */
class Points {
  constructor() {
    this.x = [];
    this.y = [];
  }

  add(x, y) {
    this.x.push(x);
    this.y.push(y);
  }

  /** A gap, through which no line is drawn. */
  lift() {
    if (this.y.length > 0 && !Number.isNaN(this.y.at(-1))) this.add(this.x.at(-1), NaN);
  }

  arrays() {
    return { x: Float64Array.from(this.x), y: Float64Array.from(this.y) };
  }
}

/** First rows behind a gap of a recording of windows. */
const gapRows = (columns, spec) => columns.once("gaps", spec, () => findGaps(columns, spec));

async function findGaps(columns, spec) {
  const [column, pyramid] = [await columns.column(spec), await columns.pyramid(spec)];
  const rows = [];
  const { size, min, max } = pyramid.levels[0];
  for (let i = 0; i < min.length; ++i) {
    if (min[i] === max[i] && (i === 0 || min[i - 1] === min[i])) continue;
    const from = Math.max(0, i * size - 1);
    const values = column.read(from, Math.min(column.rows, (i + 1) * size));
    for (let j = 1; j < values.length; ++j) if (values[j] !== values[j - 1]) rows.push(from + j);
  }
  return rows;
}

/** Intervals of rows, cut at the gaps. */
function cutAt(intervals, gaps) {
  if (gaps.length === 0) return intervals;
  return intervals.flatMap(([from, to]) => {
    const cuts = [from, ...gaps.filter((row) => row > from && row < to), to];
    return cuts.slice(1).map((end, i) => [cuts[i], end]);
  });
}

function addBuckets(points, [from, to], level, xLevel) {
  const last = Math.min(level.min.length, Math.ceil(to / level.size));
  for (let i = Math.floor(from / level.size); i < last; ++i) {
    // From the end that is nearer to the bucket before: exact where the curve rises or falls all through it.
    const rising = i === 0 || !(Math.abs(level.min[i] - points.y.at(-1)) > Math.abs(level.max[i] - points.y.at(-1)));
    points.add(xLevel.min[i], rising ? level.min[i] : level.max[i]);
    points.add(xLevel.max[i], rising ? level.max[i] : level.min[i]);
  }
}

function addRows(points, [from, to], x, y) {
  for (let at = from; at < to; at += BLOCK) {
    const end = Math.min(to, at + BLOCK);
    const [xs, ys] = [x.read(at, end), y.read(at, end)];
    for (let i = 0; i < xs.length; ++i) points.add(xs[i], ys[i]);
  }
}

/** The rows with the least and the greatest value of every so many: for an abscissa that returns. */
function addExtremes(points, [from, to], x, y, step) {
  const block = Math.ceil(BLOCK / step) * step;
  for (let at = from; at < to; at += block) {
    const end = Math.min(to, at + block);
    const [xs, ys] = [x.read(at, end), y.read(at, end)];
    for (let i = 0; i < xs.length; i += step) {
      let [low, high] = [i, i];
      for (let j = i + 1; j < Math.min(i + step, xs.length); ++j) {
        if (ys[j] < ys[low]) low = j;
        if (ys[j] > ys[high]) high = j;
      }
      points.add(xs[Math.min(low, high)], ys[Math.min(low, high)]);
      if (low !== high) points.add(xs[Math.max(low, high)], ys[Math.max(low, high)]);
    }
  }
}

/** Whole buckets of an interval, and the extremes of the rows before and behind them: a bucket may contain a gap. */
function addBetweenGaps(points, [from, to], level, xLevel, x, y) {
  const first = Math.min(to, Math.ceil(from / level.size) * level.size);
  const last = Math.max(first, Math.floor(to / level.size) * level.size);
  addEnds(points, [from, first], x, y);
  if (last > first) addBuckets(points, [first, last], level, xLevel);
  addEnds(points, [last, to], x, y);
}

/** First and last row of an interval and, between them, those of its extremes. */
function addEnds(points, [from, to], x, y) {
  if (to <= from) return;
  addRows(points, [from, from + 1], x, y);
  if (to > from + 2) addExtremes(points, [from + 1, to - 1], x, y, to - from);
  if (to > from + 1) addRows(points, [to - 1, to], x, y);
}

/**
 * A curve as it is seen.
 * @param {import("./columns.js").Columns} columns
 * @param {{x: object, y: object, monotone: boolean, gaps?: object, range?: [number, number], pixels: number}} request
 * @returns {Promise<{x: Float64Array, y: Float64Array, rows: number, exact: boolean, extent: [number, number]}>}
 *   extent is that of the whole abscissa; exact if every row is a point
 */
export async function curve(columns, { x, y, monotone, gaps, range, pixels }) {
  const [xColumn, yColumn] = await Promise.all([columns.column(x), columns.column(y)]);
  const isLong = yColumn.rows > 2 * pixels;
  const [xPyramid] = await columns.pyramidsOf(isLong && monotone ? [x, y] : [x]);
  const extent = rangeOf(xPyramid);
  const [low, high] = range ?? extent;
  let intervals = rowsWithin(xPyramid, low, high);
  if (gaps) intervals = cutAt(intervals, await gapRows(columns, gaps));
  const rows = intervals.reduce((sum, [from, to]) => sum + to - from, 0);
  const points = new Points();
  if (rows <= 2 * pixels) {
    for (const interval of intervals) {
      points.lift();
      addRows(points, interval, xColumn, yColumn);
    }
    return { ...points.arrays(), rows, exact: true, extent };
  }
  if (!monotone) {
    const step = Math.max(1, Math.ceil(rows / (4 * pixels)));
    for (const interval of intervals) {
      points.lift();
      addExtremes(points, interval, xColumn, yColumn, step);
    }
    return { ...points.arrays(), rows, exact: step === 1, extent };
  }
  const yPyramid = await columns.pyramid(y);
  const level = levelFor(yPyramid, rows, pixels);
  const xLevel = xPyramid.levels.find((one) => one.size === level.size);
  for (const interval of intervals) {
    points.lift();
    if (gaps) addBetweenGaps(points, interval, level, xLevel, xColumn, yColumn);
    else addBuckets(points, interval, level, xLevel);
  }
  return { ...points.arrays(), rows, exact: false, extent };
}

/**
 * The row at which an abscissa that does not fall reaches a value: the last row not beyond it.
 * @returns {Promise<number>} -1 before the first
 */
export async function rowAt(columns, spec, value) {
  const [column, pyramid] = [await columns.column(spec), await columns.pyramid(spec)];
  const { size, min } = pyramid.levels[0];
  let [low, high] = [0, min.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (min[middle] <= value) low = middle + 1;
    else high = middle;
  }
  if (low === 0) return -1;
  const from = (low - 1) * size;
  const values = column.read(from, Math.min(column.rows, from + size));
  let row = 0;
  while (row + 1 < values.length && values[row + 1] <= value) ++row;
  return from + row;
}

/**
 * Values of columns where an abscissa that does not fall has a value, linear between rows.
 * @returns {Promise<{row: number, values: number[]}>} NaN outside of the rows
 */
export async function valuesAt(columns, { x, ys, at }) {
  const row = await rowAt(columns, x, at);
  const xColumn = await columns.column(x);
  if (row < 0) return { row: 0, values: ys.map(() => NaN) };
  const end = Math.min(row + 2, xColumn.rows);
  const xs = xColumn.read(row, end);
  if (xs.length === 1 && at > xs[0] + 1e-9 * Math.abs(xs[0])) return { row, values: ys.map(() => NaN) };
  const share = xs.length > 1 && xs[1] > xs[0] ? Math.min(1, Math.max(0, (at - xs[0]) / (xs[1] - xs[0]))) : 0;
  const values = [];
  for (const y of ys) {
    const pair = (await columns.column(y)).read(row, end);
    values.push(share > 0 ? pair[0] + share * (pair[1] - pair[0]) : pair[0]);
  }
  return { row, values };
}
