/** Table of a sweep: parameters and quantities of every point. */

/**
 * @typedef {object} SweepColumn
 * @property {string} name
 * @property {string} label
 * @property {string} unit
 * @property {"parameter" | "quantity"} role
 * @property {string} case
 * @property {Float64Array} values numbers; of texts, the index into texts
 * @property {string[]} [texts]
 */

const baseName = (path) => path.slice(path.lastIndexOf("/") + 1);

/** "case.gcode.strategy.max_block_mm" without what all keys of a machine or a case have in common. */
function shortLabel(label) {
  return label.replace(/^machine\./, "").replace(/^case\./, "");
}

/** @returns {Promise<{columns: SweepColumn[], points: number, done: boolean[]}>} */
export async function loadSweep(client, result) {
  const group = result.groups.get("/sweep");
  const wanted = group.datasets.filter(
    (dataset) => dataset.numeric && ["parameter", "quantity"].includes(dataset.attributes.role),
  );
  const columns = await Promise.all(
    wanted.map(async (dataset) => {
      const { role, units = "", values: lines, long_name: label = "" } = dataset.attributes;
      return {
        name: baseName(dataset.path),
        label: shortLabel(label || baseName(dataset.path)),
        unit: units,
        role,
        case: dataset.attributes.case ?? "",
        values: await client.ask("values", result.index, dataset.path),
        texts: lines ? String(lines).split("\n") : undefined,
      };
    }),
  );
  const status = result.has("/sweep/status") ? await client.ask("values", result.index, "/sweep/status") : [];
  return { columns, points: columns[0]?.values.length ?? 0, done: Array.from(status, (value) => value === 1) };
}

/** Distinct numbers of a column in their order. */
export const levelsOf = (column) => [...new Set(column.values)].filter((value) => !Number.isNaN(value)).sort((a, b) => a - b);

/** Parameters that vary; of those that vary together, the first. */
export function varying(columns) {
  const seen = new Set();
  return columns.filter((column) => {
    if (column.role !== "parameter" || levelsOf(column).length < 2) return false;
    const ranks = new Map();
    const pattern = Array.from(column.values, (value) => {
      if (!ranks.has(value)) ranks.set(value, ranks.size);
      return ranks.get(value);
    }).join();
    if (seen.has(pattern)) return false;
    seen.add(pattern);
    return true;
  });
}

/** Text of a value of a column. */
export const textOf = (column, value, format) => (column.texts ? (column.texts[value] ?? "") : format(value));
