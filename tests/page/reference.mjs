/** Columns of a file read at once, to compare with what the page reads by pieces. */
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { folder } from "./browser.mjs";

const { default: h5wasm, ready } = await import(pathToFileURL(join(folder, "node_modules/h5wasm/dist/node/hdf5_hl.js")).href);
await ready;
const open = new Map();

/** All rows of a column. @returns {Float64Array} */
export function columnOf(path, dataset, index = 0) {
  if (!open.has(path)) open.set(path, new h5wasm.File(path, "r"));
  const { shape, value } = open.get(path).get(dataset);
  return shape.length === 1 ? value : value.filter((_, i) => i % shape[1] === index);
}

/** Value of a signal of a case where an abscissa that rises has a value, linear between the rows. */
export function column(path, name, signal, index, abscissa, at) {
  const x = columnOf(path, `/cases/${name}/servo/${abscissa}`);
  const y = columnOf(path, `/cases/${name}/servo/${signal}`, index);
  const row = x.findLastIndex((value) => value <= at);
  return x[row] === at ? y[row] : y[row] + ((at - x[row]) / (x[row + 1] - x[row])) * (y[row + 1] - y[row]);
}

/** An attribute of a group. */
export function attributeOf(path, group, name) {
  if (!open.has(path)) open.set(path, new h5wasm.File(path, "r"));
  return open.get(path).get(group).attrs[name].value;
}

/** A single number. */
export function valueOf(path, dataset) {
  if (!open.has(path)) open.set(path, new h5wasm.File(path, "r"));
  return open.get(path).get(dataset).value;
}
