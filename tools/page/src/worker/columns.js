/**
 * Columns: what a curve is drawn from. A column has rows, reads any of them, and has a pyramid that is
 * built once, with the progress reported and other requests answered in between.
 */
import { differenceAtEqualS } from "../core/equal_s.js";
import { PyramidBuilder } from "../core/pyramid.js";

const BLOCK = 1 << 18; // rows read at a time

/** Lets other messages be answered. */
const breathe = () =>
  new Promise((resolve) => {
    const { port1, port2 } = new MessageChannel();
    port2.onmessage = () => {
      port2.close();
      resolve();
    };
    port1.postMessage(0);
  });

/**
 * @typedef {object} Column
 * @property {number} rows
 * @property {number} block rows that are read at a time without reading any twice
 * @property {(from: number, to: number) => Float64Array} read
 * @property {() => Promise<void>} [advance] requests what the next rows need
 */

/** @returns {Column} column of a dataset */
function datasetColumn(file, path, index) {
  const rows = file.dataset(path).shape[0] ?? 1;
  const chunk = Math.max(1, file.chunkRows(path));
  return {
    rows,
    block: Math.max(1, Math.round(BLOCK / chunk)) * chunk,
    read: (from, to) => file.read(path, index, from, to),
    advance: () => file.paged.advance(),
  };
}

/** @returns {Column} value of each row by its number */
function computedColumn(rows, valueAt) {
  const read = (from, to) => {
    const values = new Float64Array(to - from);
    for (let i = 0; i < values.length; ++i) values[i] = valueAt(from + i);
    return values;
  };
  return { rows, block: BLOCK, read };
}

/** @returns {Column} length of the vector that the columns are the parts of */
function magnitudeColumn(parts) {
  const read = (from, to) => {
    const sum = new Float64Array(to - from);
    for (const part of parts) {
      const values = part.read(from, to);
      for (let i = 0; i < sum.length; ++i) sum[i] += values[i] * values[i];
    }
    return sum.map(Math.sqrt);
  };
  return { rows: parts[0].rows, block: parts[0].block, read, advance: parts[0].advance };
}

async function readAll(column, report) {
  const out = new Float64Array(column.rows);
  for (let from = 0; from < column.rows; from += column.block) {
    const to = Math.min(column.rows, from + column.block);
    out.set(column.read(from, to), from);
    report(to - from);
    await breathe();
  }
  return out;
}

/** @returns {Promise<Column>} column minus that of a baseline at equal arc length */
async function differenceColumn(column, s, base, sBase, report) {
  const [own, ownS, other, otherS] = [
    await readAll(column, report),
    await readAll(s, report),
    await readAll(base, report),
    await readAll(sBase, report),
  ];
  const difference = Float32Array.from(differenceAtEqualS(ownS, own, otherS, other));
  return { rows: column.rows, block: BLOCK, read: (from, to) => Float64Array.from(difference.subarray(from, to)) };
}

const MAX_DIFFERENCES = 64e6; // rows that stay in memory, 4 bytes each

/**
 * Columns by their description, made once:
 * {file, path, column} a column of a dataset, column "norm" the length of its vector;
 * {file, rows} the number of the row; any of them with base: {file, path, s} and s: the difference to a baseline.
 */
export class Columns {
  /** @param {(file: number) => import("./hdf5.js").ResultFile} fileOf
   *  @param {(rows: number, total: number) => void} report rows read and still to read, of all that is being built */
  constructor(fileOf, report) {
    this.fileOf = fileOf;
    this.report = report;
    this.columns = new Map();
    this.pyramids = new Map();
    this.found = new Map();
    this.wanted = 0;
    this.done = 0;
    this.queue = Promise.resolve();
  }

  /** Forgets what belongs to a file that is closed. */
  forget() {
    this.columns.clear();
    this.pyramids.clear();
    this.found.clear();
  }

  /**
   * The result of a search in a column, which is made once.
   * @template T
   * @param {string} what
   * @param {object} spec
   * @param {() => Promise<T>} search
   * @returns {Promise<T>}
   */
  once(what, spec, search) {
    const key = JSON.stringify([what, spec]);
    let result = this.found.get(key);
    if (!result) {
      result = search();
      this.found.set(key, result);
      result.catch(() => this.found.delete(key));
    }
    return result;
  }

  /** @returns {Promise<Column>} */
  column(spec) {
    const key = JSON.stringify(spec);
    let found = this.columns.get(key);
    if (!found) {
      if (spec.base) this.dropDifferences();
      found = this.make(spec);
      this.columns.set(key, found);
      found.catch(() => this.columns.delete(key));
    }
    return found;
  }

  async dropDifferences() {
    const differences = [...this.columns].filter(([key]) => key.includes('"base":'));
    let rows = 0;
    for (const [key, promise] of differences.reverse()) {
      rows += (await promise).rows;
      if (rows > MAX_DIFFERENCES) this.columns.delete(key);
    }
  }

  async make(spec) {
    if (spec.base) {
      const { base, s, ...own } = spec;
      const parts = await Promise.all([
        this.column(own),
        this.column({ file: spec.file, path: s, column: 0 }),
        this.column({ file: base.file, path: base.path, column: spec.column }),
        this.column({ file: base.file, path: base.s, column: 0 }),
      ]);
      return this.counted(
        parts.reduce((sum, part) => sum + part.rows, 0),
        (report) => differenceColumn(...parts, report),
      );
    }
    if (spec.path === undefined) return computedColumn(spec.rows, (row) => row + 1);
    const file = this.fileOf(spec.file);
    // The times of all cases would be as much to read as what is drawn over them.
    const even = file.evenTimes(spec.path);
    if (even) return computedColumn(file.dataset(spec.path).shape[0], (row) => row * even.ticks * even.tick);
    if (spec.column !== "norm") return datasetColumn(file, spec.path, spec.column ?? 0);
    const width = file.dataset(spec.path).shape[1];
    return magnitudeColumn(Array.from({ length: width }, (_, i) => datasetColumn(file, spec.path, i)));
  }

  /** @returns {Promise<import("../core/pyramid.js").Pyramid>} */
  async pyramid(spec) {
    return (await this.pyramidsOf([spec]))[0];
  }

  /**
   * Pyramids of columns that are wanted together: the file holds their rows next to each other.
   * @returns {Promise<import("../core/pyramid.js").Pyramid[]>}
   */
  pyramidsOf(specs) {
    const fresh = specs.map((spec) => ({ spec, key: JSON.stringify(spec) })).filter(({ key }) => !this.pyramids.has(key));
    if (fresh.length > 0) {
      const built = Promise.all(fresh.map(({ spec }) => this.column(spec))).then((columns) =>
        this.counted(
          columns.reduce((sum, column) => sum + column.rows, 0),
          (report) => build(columns, report),
        ),
      );
      fresh.forEach(({ key }, i) => {
        const own = built.then((all) => all[i]);
        this.pyramids.set(key, own);
        own.catch(() => this.pyramids.delete(key));
      });
    }
    return Promise.all(specs.map((spec) => this.pyramids.get(JSON.stringify(spec))));
  }

  /**
   * Runs a task that reads so many rows, after those that were asked for before it, so that the first plot is
   * complete first; reports its progress with that of all others.
   */
  async counted(rows, task) {
    this.wanted += rows;
    let own = 0;
    const before = this.queue;
    let end;
    this.queue = new Promise((resolve) => {
      end = resolve;
    });
    await before;
    try {
      return await task((read) => {
        own += read;
        this.done += read;
        this.report(this.done, this.wanted);
      });
    } finally {
      this.done += rows - own;
      if (this.done >= this.wanted) this.done = this.wanted = 0;
      this.report(this.done, this.wanted);
      end();
    }
  }
}

/** Pyramids of columns, all read at the same rows before the next ones. */
async function build(columns, report) {
  const builders = columns.map((column) => new PyramidBuilder(column.rows));
  const rows = Math.max(...columns.map((column) => column.rows));
  const block = columns[0].block;
  for (let from = 0; from < rows; from += block) {
    for (const [i, column] of columns.entries()) {
      const to = Math.min(column.rows, from + block);
      if (to <= from) continue;
      builders[i].push(column.read(from, to));
      report(to - from);
      await breathe();
    }
    if (from + block < rows) await columns.at(-1).advance?.();
  }
  return builders.map((builder) => builder.finish());
}
