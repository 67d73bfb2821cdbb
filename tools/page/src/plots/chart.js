/** Charts as SVG: of the views that are drawn once, and of all that is exported. */
import { linearTicks, logTicks, short, tickTexts } from "../core/ticks.js";
import { svg } from "../shell/dom.js";

const FONT = { "font-family": "system-ui, sans-serif", "font-size": 11 };
const MARGIN = { left: 64, right: 14, top: 26, bottom: 40 };

/**
 * @typedef {object} Axis
 * @property {string} label
 * @property {number} min
 * @property {number} max
 * @property {boolean} [log]
 */

/**
 * @typedef {object} Line
 * @property {string} label
 * @property {ArrayLike<number>} x
 * @property {ArrayLike<number>} y
 * @property {string} colour
 * @property {number[]} [dash]
 * @property {boolean} [dots] marks instead of a line
 * @property {number} [opacity]
 * @property {number} [width]
 */

/** Place of a value on an axis of so many pixels. */
export function scaleOf({ min, max, log }, pixels) {
  if (log) {
    const [low, span] = [Math.log10(min), Math.log10(max / min) || 1];
    return (value) => ((Math.log10(value) - low) / span) * pixels;
  }
  const span = max - min || 1;
  return (value) => ((value - min) / span) * pixels;
}

/** Limits of values with some room; whole decades have none. @returns {[number, number]} */
export function limitsOf(arrays, log = false) {
  let [low, high] = [Infinity, -Infinity];
  for (const values of arrays) {
    for (let i = 0; i < values.length; ++i) {
      const value = values[i];
      if (!Number.isFinite(value) || (log && value <= 0)) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (low > high) return log ? [0.1, 10] : [0, 1];
  if (log) return low === high ? [low / 2, high * 2] : [low, high];
  const room = low === high ? Math.abs(low) * 0.05 || 1 : 0.05 * (high - low);
  return [low - room, high + room];
}

const text = (x, y, content, more = {}) => svg("text", { x, y, ...FONT, ...more }, content);

function axisX(axis, place, width, height, colours) {
  const ticks = axis.log ? logTicks(axis.min, axis.max) : linearTicks(axis.min, axis.max, width / 80);
  const texts = axis.log ? ticks.map((tick) => short(tick, 3)) : tickTexts(ticks);
  return svg(
    "g",
    {},
    ...ticks.flatMap((tick, i) => {
      const x = place(tick).toFixed(1);
      return [
        svg("line", { x1: x, x2: x, y1: 0, y2: height, stroke: colours.grid }),
        text(x, height + 15, texts[i], { fill: colours.ink, "text-anchor": "middle" }),
      ];
    }),
    text(width / 2, height + 32, axis.label, { fill: colours.ink, "text-anchor": "middle" }),
  );
}

function axisY(axis, place, width, height, colours) {
  const ticks = axis.log ? logTicks(axis.min, axis.max) : linearTicks(axis.min, axis.max, height / 40);
  const texts = axis.log ? ticks.map((tick) => short(tick, 3)) : tickTexts(ticks);
  return svg(
    "g",
    {},
    ...ticks.flatMap((tick, i) => {
      const y = (height - place(tick)).toFixed(1);
      return [
        svg("line", { x1: 0, x2: width, y1: y, y2: y, stroke: colours.grid }),
        text(-6, Number(y) + 4, texts[i], { fill: colours.ink, "text-anchor": "end" }),
      ];
    }),
    text(0, 0, axis.label, { fill: colours.ink, "text-anchor": "middle", transform: `translate(-50 ${height / 2}) rotate(-90)` }),
  );
}

/** Data of a path through points; NaN lifts the pen. */
export function pathData(x, y) {
  let data = "";
  let down = false;
  let before = "";
  for (let i = 0; i < x.length; ++i) {
    if (!Number.isFinite(x[i]) || !Number.isFinite(y[i])) {
      down = false;
      continue;
    }
    const point = `${x[i].toFixed(1)} ${y[i].toFixed(1)}`;
    if (down && point === before) continue;
    data += (down ? "L" : "M") + point;
    down = true;
    before = point;
  }
  return data;
}

function lineElement(line, placeX, placeY, height) {
  const x = Array.from(line.x, placeX);
  const y = Array.from(line.y, (value) => height - placeY(value));
  const look = { opacity: line.opacity ?? 1 };
  if (!line.dots) {
    return svg("path", {
      d: pathData(x, y),
      fill: "none",
      stroke: line.colour,
      "stroke-width": line.width ?? 1.5,
      "stroke-dasharray": line.dash?.length ? line.dash.join(" ") : undefined,
      "stroke-linejoin": "round",
      ...look,
    });
  }
  return svg(
    "g",
    { fill: line.colour, ...look },
    ...x
      .map((at, i) => [at, y[i]])
      .filter((point) => point.every(Number.isFinite))
      .map(([cx, cy]) => svg("circle", { cx: cx.toFixed(1), cy: cy.toFixed(1), r: 2.6 })),
  );
}

/** Names of the lines with their strokes, in rows of the width. */
function legend(lines, width, colours) {
  const named = lines.filter((line) => line.label);
  const group = svg("g", {});
  let [x, y] = [0, 0];
  for (const line of named) {
    const needed = 34 + 6.4 * line.label.length;
    if (x > 0 && x + needed > width) [x, y] = [0, y + 15];
    group.append(
      line.dots
        ? svg("circle", { cx: x + 11, cy: y - 4, r: 3, fill: line.colour })
        : svg("line", {
            x1: x,
            x2: x + 22,
            y1: y - 4,
            y2: y - 4,
            stroke: line.colour,
            "stroke-width": 2,
            "stroke-dasharray": line.dash?.length ? line.dash.join(" ") : undefined,
          }),
      text(x + 27, y, line.label, { fill: colours.ink }),
    );
    x += needed;
  }
  return { group, height: named.length ? y + 15 : 0 };
}

let clips = 0;

/**
 * @param {{width: number, height: number, title?: string, x: Axis, y: Axis, lines: Line[], bands?: [number, number][],
 *   colours: Record<string, string>, legend?: boolean}} chart
 * @returns {SVGSVGElement}
 */
export function chart({ width, height, title = "", x, y, lines, bands = [], colours, legend: withLegend = true }) {
  const inner = width - MARGIN.left - MARGIN.right;
  const names = withLegend ? legend(lines, inner, colours) : { group: undefined, height: 0 };
  const tall = height - MARGIN.top - MARGIN.bottom - names.height;
  const [placeX, placeY] = [scaleOf(x, inner), scaleOf(y, tall)];
  const clip = `clip-${++clips}`;
  names.group?.setAttribute("transform", `translate(0 ${tall + MARGIN.bottom + 9})`);
  return svg(
    "svg",
    { xmlns: "http://www.w3.org/2000/svg", width, height, viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": title },
    svg("rect", { width, height, fill: colours.paper }),
    text(MARGIN.left, 16, title, { fill: colours.ink, "font-weight": 600, "font-size": 12 }),
    svg("clipPath", { id: clip }, svg("rect", { width: inner, height: tall })),
    svg(
      "g",
      { transform: `translate(${MARGIN.left} ${MARGIN.top})` },
      ...bands.map(([from, to]) =>
        svg("rect", {
          x: Math.max(0, placeX(from)),
          width: Math.max(1, Math.min(inner, placeX(to)) - Math.max(0, placeX(from))),
          height: tall,
          fill: colours.band,
        }),
      ),
      axisX(x, placeX, inner, tall, colours),
      axisY(y, placeY, inner, tall, colours),
      svg("rect", { width: inner, height: tall, fill: "none", stroke: colours.faint }),
      svg("g", { "clip-path": `url(#${clip})`, class: "lines" }, ...lines.map((line) => lineElement(line, placeX, placeY, tall))),
      names.group,
    ),
  );
}
