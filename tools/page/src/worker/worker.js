/** Requests of the page: {id, method, args} is answered by {id, result} or {id, fault}. */
import { rangeOf } from "../core/pyramid.js";
import { Columns } from "./columns.js";
import { curve, rowAt, valuesAt } from "./curves.js";
import { libraryReady, ResultFile } from "./hdf5.js";
import { circle, path, sections } from "./sections.js";

/** @type {Map<number, ResultFile>} */
const files = new Map();
let lastReport = 0;

function fileOf(number) {
  const file = files.get(number);
  if (!file) throw new Error("the file is closed");
  return file;
}

function report(done, total, what = "rows") {
  const now = performance.now();
  if (done < total && now - lastReport < 50) return;
  lastReport = now;
  postMessage({ progress: { done, total, what } });
}

const columns = new Columns(fileOf, report);
const pause = () => new Promise((resolve) => setTimeout(resolve));

const methods = {
  async open(number, name, place) {
    const file = await ResultFile.open(name, place);
    files.set(number, file);
    const tree = file.tree((found) => report(found, 0, "groups"));
    report(0, 0);
    return { tree, size: file.paged.size };
  },
  async close(number) {
    columns.forget();
    const file = fileOf(number);
    files.delete(number);
    await file.close();
  },
  values: (file, path_) => fileOf(file).values(path_),
  line: (file, path_, number) => fileOf(file).line(path_, number),
  attribute: (file, path_, name) => fileOf(file).attribute(path_, name),
  column: (file, path_, column) => fileOf(file).read(path_, column, 0, fileOf(file).dataset(path_).shape[0]),
  curve: (request) => curve(columns, request),
  range: async (spec) => rangeOf(await columns.pyramid(spec)),
  rowAt: (spec, value) => rowAt(columns, spec, value),
  valuesAt: (request) => valuesAt(columns, request),
  sections: (request) => sections(columns, request),
  path: (request) =>
    path(columns, request, async (share) => {
      report(share, 1, "path");
      await pause();
    }),
  circle: (request) => circle(columns, request),
};

function buffersOf(result) {
  const values = ArrayBuffer.isView(result) ? [result] : Object.values(result ?? {}).filter((value) => ArrayBuffer.isView(value));
  return [...new Set(values.map((value) => value.buffer))];
}

/** Description of a fault: that of reading the file, if it is the cause. */
function textOf(fault, number) {
  const reading = files.get(number)?.paged.fault;
  return reading?.message ?? fault?.message ?? String(fault);
}

onmessage = async ({ data: { id, method, args } }) => {
  try {
    const result = await methods[method](...args);
    postMessage({ id, result }, buffersOf(result));
  } catch (fault) {
    postMessage({ id, fault: textOf(fault, typeof args[0] === "number" ? args[0] : args[0]?.file) });
  }
};
libraryReady.then(() => postMessage({ ready: true }));
