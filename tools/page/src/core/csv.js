/** Tables as text, after RFC 4180. */

const cell = (value) => {
  const text = typeof value === "number" && Number.isNaN(value) ? "" : String(value ?? "");
  return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
};

/**
 * @param {string[]} head
 * @param {Iterable<unknown[]>} rows
 * @returns {string}
 */
export function csvText(head, rows) {
  const lines = [head.map(cell).join(",")];
  for (const row of rows) lines.push(row.map(cell).join(","));
  return `${lines.join("\n")}\n`;
}
