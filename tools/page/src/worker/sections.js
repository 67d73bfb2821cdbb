/** Sections of a case, its path in space, and its circles. */
import { planeOfCircle, radialDeviation } from "../core/circle.js";

const BLOCK = 1 << 18; // rows
const MAX_CIRCLE_ROWS = 400_000;
const CIRCLE_POINTS = 7200; // of a circle that is drawn

/**
 * Passes of the sections of a case, in their order.
 * @param {import("./columns.js").Columns} columns
 * @param {{file: number, servo: string}} request
 * @returns {Promise<{section: number, from: number, to: number, time: [number, number], s: [number, number]}[]>}
 */
export const sections = (columns, request) => columns.once("passes", request, () => findPasses(columns, request));

async function findPasses(columns, { file, servo }) {
  const spec = (name) => ({ file, path: `${servo}/${name}`, column: 0 });
  const [column, pyramid] = [await columns.column(spec("section")), await columns.pyramid(spec("section"))];
  const passes = [];
  const { size, min, max } = pyramid.levels[0];
  const add = (section, from, to) => {
    const last = passes.at(-1);
    if (last && last.section === section) last.to = to;
    else passes.push({ section, from, to });
  };
  for (let i = 0; i < min.length; ++i) {
    const [from, to] = [i * size, Math.min(column.rows, (i + 1) * size)];
    if (min[i] === max[i]) add(min[i], from, to);
    else column.read(from, to).forEach((section, j) => add(section, from + j, from + j + 1));
  }
  for (const name of ["time", "s"]) {
    const values = await columns.column(spec(name));
    for (const pass of passes) pass[name] = [values.read(pass.from, pass.from + 1)[0], values.read(pass.to - 1, pass.to)[0]];
  }
  return passes;
}

function deviationOf(i, deviation) {
  return Math.hypot(deviation[0][i], deviation[1][i], deviation[2][i]);
}

/**
 * Path of the tool centre point with at most about so many points; of the rows between, that with the
 * largest deviation is one of them.
 * @returns {Promise<{nominal: Float32Array, deviation: Float32Array, axis: Float32Array, colour: Float32Array, row: Uint32Array,
 *   rapid: Uint8Array}>} nominal in mm, deviation in um, colour in the unit of the chosen signal
 */
export async function path(columns, { file, servo, colour, points, has }, report) {
  const spec = (name, column = 0) => ({ file, path: `${servo}/${name}`, column });
  const three = async (name) => Promise.all([0, 1, 2].map((i) => columns.column(spec(name, i))));
  const nominal = await three("tool_position_nominal");
  const deviation = await three("tool_deviation");
  const axis = has.axis ? await three("tool_axis_true") : [];
  const shade = await columns.column(
    spec(colour === "tool_deviation" ? "tool_deviation" : colour, colour === "tool_deviation" ? "norm" : 0),
  );
  const rapid = has.rapid ? await columns.column(spec("rapid")) : undefined;
  const rows = shade.rows;
  const step = Math.max(1, Math.ceil((2 * rows) / points));
  const count = Math.ceil(rows / step) * (step > 1 ? 2 : 1);
  const out = {
    nominal: new Float32Array(3 * count),
    deviation: new Float32Array(3 * count),
    axis: new Float32Array(axis.length ? 3 * count : 0),
    colour: new Float32Array(count),
    row: new Uint32Array(count),
    rapid: new Uint8Array(count),
  };
  let n = 0;
  const block = Math.ceil(BLOCK / step) * step;
  for (let from = 0; from < rows; from += block) {
    const to = Math.min(rows, from + block);
    const read = (parts) => parts.map((part) => part.read(from, to));
    const [p, d, k, c] = [read(nominal), read(deviation), read(axis), shade.read(from, to)];
    const r = rapid?.read(from, to);
    const put = (i) => {
      for (let j = 0; j < 3; ++j) {
        out.nominal[3 * n + j] = p[j][i];
        out.deviation[3 * n + j] = d[j][i];
        if (k.length) out.axis[3 * n + j] = k[j][i];
      }
      out.colour[n] = c[i];
      out.row[n] = from + i;
      out.rapid[n++] = r ? r[i] : 0;
    };
    for (let i = 0; i < c.length; i += step) {
      const end = Math.min(i + step, c.length);
      let peak = i;
      for (let j = i + 1; j < end; ++j) if (deviationOf(j, d) > deviationOf(peak, d)) peak = j;
      put(i);
      if (step > 1) put(peak);
    }
    await report(to / rows);
  }
  if (n < count)
    for (const [name, width] of [
      ["nominal", 3],
      ["deviation", 3],
      ["axis", 3],
      ["colour", 1],
      ["row", 1],
      ["rapid", 1],
    ]) {
      if (out[name].length) out[name] = out[name].slice(0, width * n);
    }
  return out;
}

/** Rows of a pass without the standstills at its ends, where the tool waits for the next block. */
function moving(s) {
  let [from, to] = [0, s.length];
  while (from + 1 < to && s[from + 1] - s[from] < 1e-7) ++from;
  while (to - 1 > from && s[to - 1] - s[to - 2] < 1e-7) --to;
  return [from, to];
}

const thinned = (values, step) => (step === 1 ? values : values.filter((_, i) => i % step === 0));

/**
 * A pass of a section as a circle, or undefined if its nominal path is none.
 * @param {{file: number, servo: string, pass: {from: number, to: number}}} request
 * @returns {Promise<{plane: string, nominalRadius: number, sense: number, angle: Float64Array, deviation: Float64Array, cx: number,
 *   cy: number, radius: number, circularity: number} | undefined>} mm
 */
export async function circle(columns, { file, servo, pass }) {
  if (pass.to - pass.from > MAX_CIRCLE_ROWS) return undefined;
  const s = (await columns.column({ file, path: `${servo}/s`, column: 0 })).read(pass.from, pass.to);
  const [from, to] = moving(s).map((row) => row + pass.from);
  const step = Math.max(1, Math.ceil((to - from) / CIRCLE_POINTS));
  const read = async (name) => {
    const out = [];
    for (let i = 0; i < 3; ++i) {
      const column = await columns.column({ file, path: `${servo}/${name}`, column: i });
      out.push(thinned(column.read(from, to), step));
    }
    return out;
  };
  const nominal = await read("tool_position_nominal");
  const plane = planeOfCircle(nominal);
  if (!plane) return undefined;
  const { first, second } = plane;
  const actual = await read("tool_position_true");
  const found = radialDeviation(actual[first], actual[second], plane.circle.radius);
  if (!found) return undefined;
  return { plane: "XYZ"[first] + "XYZ"[second], nominalRadius: plane.circle.radius, sense: Math.sign(plane.angle), ...found };
}
