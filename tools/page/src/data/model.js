/**
 * The contents of result files as the page shows them: cases, and families of signals. A family is the
 * same group in several cases (`/cases/NAME/servo`), or a group of its own (`/errors/imposed/X`).
 */

/**
 * @typedef {object} Case
 * @property {string} id unique among all open files
 * @property {number} file
 * @property {string} name
 * @property {string} label with the file where there are several
 * @property {string} path
 * @property {string} servo path of its signals over time, "" without
 * @property {string[]} sections names by their number
 * @property {boolean} finished
 * @property {string} outcome
 */

/**
 * @typedef {object} Signal
 * @property {string} name
 * @property {string} label long name
 * @property {string} unit
 * @property {(number | "norm")[]} columns columns that can be drawn
 * @property {string[]} letters of the columns, [""] for a single one
 */

/**
 * @typedef {object} Member
 * @property {number} file
 * @property {string} path of the group
 * @property {string} case id of its case, "" without
 * @property {string} label
 * @property {number} rows
 */

/**
 * @typedef {object} Family
 * @property {string} key
 * @property {string} label
 * @property {boolean} servo the signals of the run itself
 * @property {string} scale name of the abscissa, "" for the number of the row
 * @property {Member[]} members
 * @property {Signal[]} signals
 */

const HIDDEN_GROUPS = /^\/(comparison|sweep|inputs|bode|parameters|unfinished)/;
const CASE = /^\/cases\/([^/]+)(\/.*)?$/;
/** Signals at the head of the tree: errors; the others as the file has them. */
const WANTED_FIRST = /^(contour_error|tool_deviation|following_error)/;
const MAX_COLUMNS = 9; // of a dataset whose columns are signals

/** One open file. */
export class Result {
  /** @param {number} index @param {string} name @param {import("../worker/hdf5.js").GroupNode[]} tree */
  constructor(index, name, tree, size) {
    this.index = index;
    this.name = name;
    this.size = size;
    this.groups = new Map(tree.map((group) => [group.path, group]));
    this.attributes = this.groups.get("/").attributes;
    this.title = this.attributes.title || this.attributes.name || name;
  }

  /** @returns {import("../worker/hdf5.js").DatasetNode | undefined} */
  dataset(path) {
    const group = this.groups.get(path.slice(0, path.lastIndexOf("/")) || "/");
    return group?.datasets.find((dataset) => dataset.path === path);
  }

  has(path) {
    return this.groups.has(path) || this.dataset(path) !== undefined;
  }

  /** Groups directly below one. */
  below(path) {
    return (this.groups.get(path)?.groups ?? []).map((child) => this.groups.get(child));
  }
}

const baseName = (path) => path.slice(path.lastIndexOf("/") + 1);

/** @param {Result[]} results @returns {Case[]} */
export function casesOf(results) {
  const several = results.filter((result) => result.has("/cases")).length > 1;
  return results.flatMap((result) =>
    result.below("/cases").map((group) => {
      const name = baseName(group.path);
      const { sections = "", finished = 1, outcome = "" } = group.attributes;
      return {
        id: `${result.index}:${name}`,
        file: result.index,
        name,
        path: group.path,
        label: several ? `${name} (${result.name})` : name,
        servo: result.has(`${group.path}/servo/time`) ? `${group.path}/servo` : "",
        sections: String(sections).split("\n"),
        finished: Boolean(finished),
        outcome,
      };
    }),
  );
}

function columnsOf(dataset) {
  const width = dataset.shape[1] ?? 1;
  if (dataset.shape.length < 2) return { columns: [0], letters: [""] };
  const letters = String(dataset.attributes.columns ?? "");
  const names = Array.from({ length: width }, (_, i) => letters[i] ?? String(i + 1));
  const columns = Array.from({ length: width }, (_, i) => i);
  return width > 1 && letters.startsWith("XYZ")
    ? { columns: [...columns, "norm"], letters: [...names, "‖·‖"] }
    : { columns, letters: names };
}

function signalOf(dataset) {
  const { long_name: label = "", units = "", channel = "" } = dataset.attributes;
  return { name: baseName(dataset.path), label: channel || label, unit: units, ...columnsOf(dataset) };
}

const drawable = (dataset) =>
  dataset.numeric &&
  dataset.shape.length > 0 &&
  dataset.shape.length <= 2 &&
  dataset.shape[0] > 1 &&
  (dataset.shape[1] ?? 1) <= MAX_COLUMNS;

/** Datasets of a group by their abscissa. */
function byScale(group) {
  const scales = new Set(group.datasets.map((dataset) => dataset.scale).filter(Boolean));
  const found = new Map();
  for (const dataset of group.datasets.filter(drawable)) {
    if (scales.has(baseName(dataset.path)) || (scales.size > 0 && dataset.isScale)) continue;
    const own = group.datasets.some((other) => baseName(other.path) === dataset.scale) ? dataset.scale : "";
    const key = own || `rows ${dataset.shape[0]}`;
    if (!found.has(key)) found.set(key, { scale: own, datasets: [] });
    found.get(key).datasets.push(dataset);
  }
  return [...found.values()];
}

function labelOf({ path, attributes }, scale, several) {
  if (path.startsWith("/budget/")) {
    const within = path.split("/").slice(3).map((child) => ` › ${child}`); // pairs, shares
    return `budget of ${[attributes.case, attributes.quantity, attributes.axis, attributes.sections].filter(Boolean).join(" ")}${within.join("")}`;
  }
  const inCase = CASE.exec(path);
  const name = (inCase ? (inCase[2] ?? "") : path).slice(1).replaceAll("/", " › ") || "case";
  return several ? `${name} over ${scale || "rows"}` : name;
}

/**
 * Families of all files; that of the signals over time is the first.
 * @param {Result[]} results
 * @param {Case[]} cases
 * @returns {Family[]}
 */
export function familiesOf(results, cases) {
  /** @type {Map<string, Family>} */
  const families = new Map();
  for (const result of results) {
    for (const group of result.groups.values()) {
      if (HIDDEN_GROUPS.test(group.path)) continue;
      const parts = byScale(group);
      for (const { scale, datasets } of parts) {
        const inCase = CASE.exec(group.path);
        const key = `${inCase ? `/cases/*${inCase[2] ?? ""}` : group.path}@${scale}`;
        const owner = inCase && cases.find((one) => one.file === result.index && one.name === inCase[1]);
        if (!families.has(key)) {
          families.set(key, {
            key,
            scale,
            label: labelOf(group, scale, parts.length > 1),
            servo: key === "/cases/*/servo@time",
            members: [],
            signals: [],
          });
        }
        const family = families.get(key);
        family.members.push({
          file: result.index,
          path: group.path,
          case: owner?.id ?? "",
          label: owner?.label ?? result.name,
          rows: datasets[0].shape[0],
        });
        const known = new Set(family.signals.map((signal) => signal.name));
        family.signals.push(...datasets.map(signalOf).filter((signal) => !known.has(signal.name)));
      }
    }
  }
  for (const family of families.values()) {
    if (family.servo) family.signals.sort((a, b) => Number(WANTED_FIRST.test(b.name)) - Number(WANTED_FIRST.test(a.name)));
  }
  const rank = (family) => (family.servo ? 0 : family.scale === "time" ? 1 : 2);
  return [...families.values()].sort((a, b) => rank(a) - rank(b));
}

/**
 * What the curves of servo signals can be drawn over: time, arc length, positions of axes.
 * @param {Family | undefined} family
 * @param {Result[]} results
 */
export function abscissaeOf(family, results) {
  if (!family?.servo) return [];
  const member = family.members[0];
  const out = [
    { key: "time", name: "time", column: 0, label: "time", unit: "s", monotone: true },
    { key: "s", name: "s", column: 0, label: "arc length s", unit: "mm", monotone: true },
  ];
  for (const name of ["ref_linear", "ref_rotary"]) {
    const dataset = results[member.file]?.dataset(`${member.path}/${name}`);
    if (!dataset) continue;
    columnsOf(dataset).letters.forEach((letter, column) => {
      if (letter !== "‖·‖")
        out.push({ key: letter, name, column, label: `position of ${letter}`, unit: dataset.attributes.units, monotone: false });
    });
  }
  return out.filter((one) => results[member.file].dataset(`${member.path}/${one.name}`));
}

/** @typedef {{file: number, number: string, quantity: string, axis: string, statistic: string, sections: string[], case: string,
 *   reference: string, basis: string, unit: string, path: string, value?: number}} ComparisonLine */

/** Lines of the comparison of a file, without their values. @returns {ComparisonLine[]} */
export function comparisonOf(result) {
  return result.below("/comparison").map((group) => ({
    file: result.index,
    number: baseName(group.path),
    path: `${group.path}/value`,
    quantity: group.attributes.quantity ?? "",
    axis: group.attributes.axis ?? "",
    statistic: group.attributes.statistic ?? "",
    sections: String(group.attributes.sections ?? "")
      .split(", ")
      .filter(Boolean),
    case: group.attributes.case ?? "",
    reference: group.attributes.reference ?? "",
    basis: group.attributes.basis ?? "",
    unit: result.dataset(`${group.path}/value`)?.attributes.units ?? "",
  }));
}
