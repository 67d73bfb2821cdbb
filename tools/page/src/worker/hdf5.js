/** Result files, read through h5wasm: the tree of groups and datasets, and hyperslabs of columns. */
import * as h5wasm from "h5wasm";
import { LongText } from "../core/long_text.js";
import { pagedFile, pageReader } from "./source.js";

const SIGNATURE = [0x89, 0x48, 0x44, 0x46, 0x0d, 0x0a, 0x1a, 0x0a];
// Attributes that hold references of the library between datasets, not what people read.
const INTERNAL = new Set(["DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME"]);
const SIGNALS = /^\/cases\/[^/]+\/servo$/;
const LONG_TEXT = 4096; // characters of an attribute that are part of the tree; longer ones are read on demand

/** Fulfilled once the HDF5 library is compiled. */
export const libraryReady = h5wasm.ready;

let mounted = 0;

/**
 * @typedef {object} DatasetNode
 * @property {string} path
 * @property {number[]} shape
 * @property {boolean} numeric
 * @property {Record<string, any>} attributes
 * @property {boolean} isScale marked as an abscissa of others, which there need not be
 * @property {string} scale name of the dataset that is its abscissa, "" if it has none
 */

/** @typedef {{path: string, attributes: Record<string, any>, groups: string[], datasets: DatasetNode[]}} GroupNode */

function attributeValue(value) {
  if (typeof value === "bigint") return Number(value);
  if (typeof value === "string") return value;
  if (value && value.length === 1) return attributeNumber(value[0]);
  return value && typeof value === "object" ? Array.from(value, attributeNumber) : value;
}

const attributeNumber = (value) => (typeof value === "bigint" ? Number(value) : value);

function attributesOf(node) {
  const out = {};
  for (const name of Object.keys(node.attrs)) {
    if (INTERNAL.has(name)) continue;
    const value = attributeValue(node.get_attribute(name));
    out[name] =
      typeof value === "string" && value.length > LONG_TEXT && name !== "sections" && name !== "values" ? undefined : value;
  }
  return out;
}

/** What NeXus viewers draw has its unit behind its long name, too. */
function unlabelled(attributes) {
  const { units, long_name: label } = attributes;
  const unit = ` [${units}]`;
  return typeof label === "string" && label.endsWith(unit) ? { ...attributes, long_name: label.slice(0, -unit.length) } : attributes;
}

/** Signals that are equal are one dataset, whose long name says what each of its names is: "a: this = b: that". */
function own(attributes, name) {
  const { long_name: label } = attributes;
  const part = typeof label === "string" ? label.split(" = ").find((one) => one.startsWith(`${name}: `)) : undefined;
  return part === undefined ? attributes : { ...attributes, long_name: part.slice(name.length + 2) };
}

/** One open result file. */
export class ResultFile {
  /** @param {string} name @param {{blob?: Blob, url?: string, size?: number}} place */
  static async open(name, place) {
    const { FS } = await h5wasm.ready;
    const paged = pagedFile(place);
    const head = paged.size >= 8 ? paged.read(0, 8) : [];
    if (!SIGNATURE.every((byte, i) => head[i] === byte)) throw new Error("is not an HDF5 file");
    const { WORKERFS } = FS.filesystems;
    WORKERFS.reader = pageReader;
    const folder = `/file_${++mounted}`;
    FS.mkdir(folder);
    FS.mount(WORKERFS, { blobs: [{ name: "result.h5", data: paged }] }, folder);
    const file = new h5wasm.File(`${folder}/result.h5`, "r");
    if (file.file_id < 0n) throw paged.fault ?? new Error("is damaged, cut short, or still being written");
    return new ResultFile(name, file, paged, folder);
  }

  constructor(name, file, paged, folder) {
    Object.assign(this, { name, file, paged, folder });
    this.datasets = new Map();
    this.texts = new Map();
  }

  async close() {
    const { FS } = await h5wasm.ready;
    this.file.close();
    FS.unmount(this.folder);
  }

  /**
   * Every group with its datasets, from the root down.
   * @param {(found: number) => void} report
   * @returns {GroupNode[]}
   */
  tree(report) {
    /** @type {GroupNode[]} */
    const nodes = [];
    /** @type {GroupNode | undefined} */
    let signals;
    const walk = (group, path) => {
      const node = { path, attributes: attributesOf(group), groups: [], datasets: [] };
      nodes.push(node);
      if (nodes.length % 50 === 0) report(nodes.length);
      if (SIGNALS.test(path)) {
        if (signals && this.likeFirst(node, signals, group.keys())) return;
        signals ??= node;
      }
      for (const key of group.keys()) {
        const child = group.get(key);
        const childPath = path === "/" ? `/${key}` : `${path}/${key}`;
        if (child instanceof h5wasm.Group) {
          node.groups.push(childPath);
          walk(child, childPath);
        } else if (child instanceof h5wasm.Dataset) {
          node.datasets.push(this.datasetNode(child, childPath));
        }
      }
    };
    walk(this.file, "/");
    return nodes;
  }

  /**
   * Signals of a case with the names of the first one: the program gives them the same units and columns in every case
   * of a file, and reading them again would take most of the time that opening takes.
   */
  likeFirst(node, first, names) {
    const namesOfFirst = first.datasets.map(({ path }) => path.slice(first.path.length + 1));
    if (names.join() !== namesOfFirst.join()) return false;
    const [rowsOfFirst] = first.datasets[names.indexOf("time")]?.shape ?? [];
    const rows = this.dataset(`${node.path}/time`).shape[0];
    node.datasets = first.datasets.map((dataset, i) => ({
      ...dataset,
      path: `${node.path}/${names[i]}`,
      shape: dataset.shape[0] === rowsOfFirst ? [rows, ...dataset.shape.slice(1)] : dataset.shape,
    }));
    return true;
  }

  datasetNode(dataset, path) {
    const { shape, type } = dataset.metadata;
    const scales = shape?.length > 0 ? dataset.get_attached_scales(0) : [];
    const isScale = Object.keys(dataset.attrs).includes("CLASS");
    return {
      isScale,
      path,
      shape: shape ?? [],
      numeric: type === 0 || type === 1, // H5T_INTEGER, H5T_FLOAT
      attributes: own(unlabelled(attributesOf(dataset)), path.split("/").at(-1)),
      scale: scales.length > 0 ? scales[0].split("/").at(-1) : "",
    };
  }

  dataset(path) {
    let dataset = this.datasets.get(path);
    if (!dataset) {
      dataset = this.file.get(path);
      this.datasets.set(path, dataset);
    }
    return dataset;
  }

  /** Text of an attribute too long for the tree. */
  attribute(path, name) {
    return attributeValue(this.file.get(path).get_attribute(name));
  }

  /** A line, counted from 1, of a text that is stored as the list of its characters; undefined behind the last one. */
  line(path, number) {
    let text = this.texts.get(path);
    if (!text) {
      text = new LongText(this.dataset(path).shape[0], (from, to) => this.bytes(path, from, to));
      this.texts.set(path, text);
    }
    return text.line(number);
  }

  /** Characters of a list, as bytes: the library makes a string of each, a hundred times as large. */
  bytes(path, from, to) {
    const { Module } = h5wasm;
    const place = Module._malloc(to - from);
    try {
      Module.get_dataset_data(this.file.file_id, path, [BigInt(to - from)], [BigInt(from)], [1n], BigInt(place));
      return Module.HEAPU8.slice(place, place + to - from);
    } catch (fault) {
      throw this.paged.fault ?? new Error(`${path}: ${fault.message ?? fault}`);
    } finally {
      Module._free(place);
    }
  }

  /** Ticks from row to row, if these are times that all rows have from 0 on; undefined of others and of signals. */
  evenTimes(path) {
    const dataset = this.dataset(path);
    if (!Object.keys(dataset.attrs).includes("sampling_ticks")) return undefined;
    const [ticks, tick] = ["sampling_ticks", "tick"].map((name) => attributeValue(dataset.get_attribute(name)));
    return { ticks, tick };
  }

  /** Rows of one chunk of a dataset, or all of them. */
  chunkRows(path) {
    const { chunks, shape } = this.dataset(path).metadata;
    return chunks ? chunks[0] : shape[0];
  }

  /**
   * Rows of a column.
   * @param {string} path
   * @param {number} column
   * @param {number} from
   * @param {number} to
   * @returns {Float64Array}
   */
  read(path, column, from, to) {
    const dataset = this.dataset(path);
    const ranges =
      dataset.shape.length > 1
        ? [
            [from, to],
            [column, column + 1],
          ]
        : [[from, to]];
    let values;
    try {
      values = dataset.slice(ranges);
    } catch (fault) {
      throw this.paged.fault ?? new Error(`${path}: ${fault.message ?? fault}`);
    }
    if (values instanceof Float64Array) return values;
    return Float64Array.from(values, Number);
  }

  /** All values of a small dataset: numbers or texts. */
  values(path) {
    const dataset = this.dataset(path);
    const value = dataset.value;
    if (value === null || typeof value === "number" || typeof value === "string") return value;
    if (typeof value === "bigint") return Number(value);
    if (typeof value[0] === "string") return Array.from(value);
    return Float64Array.from(value, Number);
  }
}
