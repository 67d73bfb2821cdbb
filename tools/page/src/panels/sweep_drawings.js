/** Drawings of a sweep: map over two parameters, and parallel coordinates. */
import { shadeText } from "../core/palette.js";
import { linearTicks, short, tickTexts } from "../core/ticks.js";
import { withUnit } from "../core/units.js";
import { levelsOf, textOf } from "../data/sweep.js";
import { limitsOf, pathData, scaleOf } from "../plots/chart.js";
import { svg } from "../shell/dom.js";

const FONT = { "font-family": "system-ui, sans-serif", "font-size": 11 };
const text = (x, y, content, more) => svg("text", { x, y, ...FONT, ...more }, content);

/** Mean of a quantity at each pair of values of two parameters. */
export function gridOf(x, y, quantity, rows) {
  const [xs, ys] = [levelsOf(x), levelsOf(y)];
  const sums = ys.map(() => xs.map(() => ({ sum: 0, count: 0 })));
  for (const row of rows) {
    const cell = sums[ys.indexOf(y.values[row])]?.[xs.indexOf(x.values[row])];
    if (!cell || Number.isNaN(quantity.values[row])) continue;
    cell.sum += quantity.values[row];
    cell.count += 1;
  }
  return { xs, ys, cells: sums.map((line) => line.map(({ sum, count }) => (count ? sum / count : NaN))) };
}

/** @returns {SVGSVGElement} colours and numbers of a quantity over two parameters */
export function mapDrawing({ x, y, quantity, rows, width, height, colours, theme }) {
  const { xs, ys, cells } = gridOf(x, y, quantity, rows);
  const [left, top, bottom] = [110, 28, 44];
  const [cw, ch] = [(width - left - 20) / xs.length, (height - top - bottom) / ys.length];
  const finite = cells.flat().filter(Number.isFinite);
  const [low, high] = [Math.min(...finite), Math.max(...finite)];
  const share = (value) => (high > low ? (value - low) / (high - low) : 0.5);
  const boxes = cells.flatMap((line, j) =>
    line.map((value, i) => {
      const [bx, by] = [left + i * cw, top + (ys.length - 1 - j) * ch];
      const label = `${textOf(x, xs[i], short)}, ${textOf(y, ys[j], short)}: ${short(value)}`;
      const dark = theme === "dark" ? share(value) < 0.35 : share(value) < 0.6;
      return svg(
        "g",
        { class: "cell" },
        svg(
          "rect",
          {
            x: bx,
            y: by,
            width: cw,
            height: ch,
            fill: Number.isFinite(value) ? shadeText(share(value), theme) : colours.grid,
            stroke: colours.paper,
          },
          svg("title", {}, label),
        ),
        cw > 44 && ch > 16
          ? text(bx + cw / 2, by + ch / 2 + 4, short(value, 3), {
              "text-anchor": "middle",
              fill: dark ? "#fff" : "#000",
              "pointer-events": "none",
            })
          : undefined,
      );
    }),
  );
  return svg(
    "svg",
    {
      xmlns: "http://www.w3.org/2000/svg",
      width,
      height,
      viewBox: `0 0 ${width} ${height}`,
      role: "img",
      "aria-label": quantity.label,
    },
    svg("rect", { width, height, fill: colours.paper }),
    text(left, 16, withUnit(quantity.label, quantity.unit), { fill: colours.ink, "font-weight": 600 }),
    ...boxes,
    ...xs.map((value, i) =>
      text(
        left + (i + 0.5) * cw,
        height - bottom + 16,
        textOf(x, value, (v) => short(v, 3)),
        { fill: colours.ink, "text-anchor": "middle" },
      ),
    ),
    ...ys.map((value, j) =>
      text(
        left - 6,
        top + (ys.length - 0.5 - j) * ch + 4,
        textOf(y, value, (v) => short(v, 3)),
        { fill: colours.ink, "text-anchor": "end" },
      ),
    ),
    text(left + (width - left) / 2, height - 8, withUnit(x.label, x.unit), { fill: colours.ink, "text-anchor": "middle" }),
    text(0, 0, withUnit(y.label, y.unit), {
      fill: colours.ink,
      "text-anchor": "middle",
      transform: `translate(14 ${height / 2}) rotate(-90)`,
    }),
  );
}

/** Places of the axes of parallel coordinates. */
export function parallelScales(columns, width, height) {
  const [left, right, top, bottom] = [60, 60, 62, 20];
  return columns.map((column, i) => {
    const [min, max] = limitsOf([column.values]);
    const place = scaleOf({ min, max }, height - top - bottom);
    return {
      column,
      min,
      max,
      top,
      line: i % 3,
      isLast: i > 0 && i === columns.length - 1,
      tall: height - top - bottom,
      x: left + (i * (width - left - right)) / Math.max(1, columns.length - 1),
      y: (value) => height - bottom - place(value),
    };
  });
}

/** Label above an axis; that of the last axes ends there, for it to stay inside. */
function axisLabel({ column, x, top, line, isLast }, colours) {
  return text(x, top - 10 - 15 * line, withUnit(column.label, column.unit), {
    fill: colours.ink,
    "text-anchor": isLast ? "end" : "start",
    "font-weight": column.role === "parameter" ? 600 : 400,
  });
}

function axisElement(axis, colours, brush) {
  const { column, x, top, tall } = axis;
  const ticks = column.texts ? levelsOf(column) : linearTicks(axis.min, axis.max, 5);
  const texts = column.texts ? ticks.map((value) => column.texts[value]) : tickTexts(ticks);
  return svg(
    "g",
    { class: "axis" },
    svg("line", { x1: x, x2: x, y1: top, y2: top + tall, stroke: colours.ink }),
    ...ticks.map((tick, i) => text(x - 5, axis.y(tick) + 4, texts[i], { fill: colours.ink, "text-anchor": "end" })),
    axisLabel(axis, colours),
    brush
      ? svg("rect", {
          class: "brush",
          x: x - 7,
          width: 14,
          y: axis.y(brush[1]),
          height: Math.max(2, axis.y(brush[0]) - axis.y(brush[1])),
          fill: colours.accent,
          opacity: 0.3,
        })
      : undefined,
  );
}

/** @returns {SVGSVGElement} a line for each point, those within all brushes in colour of the last axis */
export function parallelDrawing({ scales, rows, chosen, brushes, width, height, colours, theme }) {
  const points = (row) =>
    pathData(
      scales.map((axis) => axis.x),
      scales.map((axis) => axis.y(axis.column.values[row])),
    );
  const others = rows
    .filter((row) => !chosen.has(row))
    .map(points)
    .join("");
  const last = scales.at(-1);
  const lines = rows
    .filter((row) => chosen.has(row))
    .map((row) => {
      const share = last ? (last.column.values[row] - last.min) / (last.max - last.min) : 0;
      return svg("path", { class: "chosen", d: points(row), fill: "none", stroke: shadeText(share, theme), "stroke-width": 1.4 });
    });
  return svg(
    "svg",
    {
      xmlns: "http://www.w3.org/2000/svg",
      width,
      height,
      viewBox: `0 0 ${width} ${height}`,
      role: "img",
      "aria-label": "Parallel coordinates",
    },
    svg("rect", { width, height, fill: colours.paper }),
    svg("path", { d: others, fill: "none", stroke: colours.faint, opacity: 0.3 }),
    ...lines,
    ...scales.map((axis, i) => axisElement(axis, colours, brushes.get(scales[i].column.name))),
  );
}
