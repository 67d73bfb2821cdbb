/** Values of a case where the cursor is: exact, from the rows next to it. */

/** What the cursor is over, if it is time or arc length: the others may meet a place more than once. */
export function cursorScale(state) {
  const { cursor } = state;
  return cursor && ["time", "s"].includes(cursor.key) ? cursor : undefined;
}

/**
 * @param {import("./client.js").Client} client
 * @param {import("./model.js").Case} one a case with signals
 * @param {{key: string, value: number}} cursor
 * @param {[string, number][]} columns datasets of the servo group with their columns
 * @returns {Promise<{row: number, values: number[]}>}
 */
export function valuesAtCursor(client, one, cursor, columns) {
  const spec = (name, column) => ({ file: one.file, path: `${one.servo}/${name}`, column });
  return client.ask("valuesAt", {
    x: spec(cursor.key, 0),
    ys: columns.map(([name, column]) => spec(name, column)),
    at: cursor.value,
  });
}
