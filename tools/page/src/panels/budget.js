/** Budgets: each residual as a bar of the parts that its causes add. */
import { lookOf } from "../core/palette.js";
import { linearTicks, short, tickTexts } from "../core/ticks.js";
import { unitText, words } from "../core/units.js";
import { html, select, svg } from "../shell/dom.js";
import { inks } from "../shell/theme.js";

const NOT_A_CAUSE = new Set(["s", "residual"]);
const ROW = 30; // pixels
const LEFT = 300;
const FONT = { "font-family": "system-ui, sans-serif", "font-size": 11 };
const CHOICES = [
  ["at_place", "where the residual is largest"],
  ["rms", "rms along the path"],
];
const text = (x, y, content, more) => svg("text", { x, y, ...FONT, ...more }, content);

/**
 * @typedef {object} Budget
 * @property {string} label
 * @property {string} unit
 * @property {Map<string, {at_place: number, rms: number, meaning: string}>} parts
 * @property {{at_place: number, rms: number} | undefined} residual
 */

/** @returns {Budget[]} of one file */
export function budgetsOf(result) {
  return result.below("/budget").map((group) => {
    const { case: name, quantity, axis, sections } = group.attributes;
    const parts = new Map();
    let residual;
    for (const dataset of group.datasets) {
      const cause = dataset.path.slice(dataset.path.lastIndexOf("/") + 1);
      const { at_place, rms, long_name: meaning } = dataset.attributes;
      if (cause === "residual") residual = { at_place, rms };
      else if (!NOT_A_CAUSE.has(cause) && at_place !== undefined) parts.set(cause, { at_place, rms, meaning });
    }
    const unit = group.datasets.find((dataset) => dataset.path.endsWith("/residual"))?.attributes.units ?? "";
    return { label: [`${name}:`, words(quantity ?? ""), axis, sections].filter(Boolean).join(" "), unit, parts, residual };
  });
}

export class BudgetView {
  constructor({ store }) {
    Object.assign(this, { store, name: "Budget", kind: "at_place" });
    this.controls = html("div", { class: "controls" });
    this.drawing = html("div");
    this.element = html("div", {}, this.controls, this.drawing);
    store.on(["results", "theme"], () => this.seen && this.show());
    new ResizeObserver(() => this.seen && this.draw()).observe(this.element);
  }

  available() {
    return this.store.state.results.some((result) => result?.below("/budget").length > 0);
  }

  show() {
    this.seen = true;
    this.budgets = this.store.state.results.filter(Boolean).flatMap(budgetsOf);
    this.controls.replaceChildren(
      select("parts", CHOICES, this.kind, (kind) => {
        this.kind = kind;
        this.draw();
      }),
    );
    this.draw();
  }

  hide() {
    this.seen = false;
  }

  get causes() {
    return [...new Set(this.budgets.flatMap((budget) => [...budget.parts.keys()]))];
  }

  draw() {
    this.drawing.replaceChildren(...this.drawings(Math.max(600, this.element.clientWidth - 4)));
  }

  /** One drawing for each unit. */
  drawings(width) {
    return [...new Set(this.budgets.map((budget) => budget.unit))].map((unit) =>
      this.bars(
        this.budgets.filter((budget) => budget.unit === unit),
        unit,
        width,
      ),
    );
  }

  bars(budgets, unit, width) {
    const colours = inks();
    const extents = budgets.map((budget) => extentOf(budget, this.kind));
    const [low, high] = [Math.min(0, ...extents.map((e) => e[0])), Math.max(1e-12, ...extents.map((e) => e[1]))];
    const place = (value) => LEFT + ((value - low) / (high - low)) * (width - LEFT - 20);
    const legend = this.legend(width, colours);
    const height = legend.height + 34 + ROW * budgets.length + 30;
    const top = legend.height + 20;
    const ticks = linearTicks(low, high, 8);
    const texts = tickTexts(ticks);
    const bottom = top + ROW * budgets.length;
    return svg(
      "svg",
      {
        xmlns: "http://www.w3.org/2000/svg",
        width,
        height,
        viewBox: `0 0 ${width} ${height}`,
        role: "img",
        "aria-label": "Budgets",
      },
      svg("rect", { width, height, fill: colours.paper }),
      this.hatches(colours),
      legend.group,
      ...ticks.flatMap((tick, i) => [
        svg("line", { x1: place(tick), x2: place(tick), y1: top, y2: bottom, stroke: tick === 0 ? colours.faint : colours.grid }),
        text(place(tick), bottom + 16, texts[i], { fill: colours.ink, "text-anchor": "middle" }),
      ]),
      text((LEFT + width) / 2, bottom + 32, `${CHOICES.find(([key]) => key === this.kind)[1]} (${unitText(unit)})`, {
        fill: colours.ink,
        "text-anchor": "middle",
      }),
      ...budgets.map((budget, i) => this.bar(budget, top + i * ROW, place, colours)),
    );
  }

  bar(budget, y, place, colours) {
    let [positive, negative] = [0, 0];
    const boxes = [...budget.parts].map(([cause, part]) => {
      const value = part[this.kind];
      const from = value >= 0 ? positive : negative;
      if (value >= 0) positive += value;
      else negative += value;
      const [a, b] = [place(from), place(from + value)].sort((p, q) => p - q);
      return svg(
        "rect",
        { class: "part", "data-cause": cause, x: a, width: b - a, y: y + 5, height: ROW - 10, fill: this.fillOf(cause) },
        svg("title", {}, `${words(cause)}: ${short(value)} ${unitText(budget.unit)}, ${part.meaning}`),
      );
    });
    const residual = budget.residual?.[this.kind];
    const at = residual === undefined ? undefined : place(residual);
    return svg(
      "g",
      {},
      text(LEFT - 8, y + ROW / 2 + 4, budget.label.length > 52 ? `${budget.label.slice(0, 51)}…` : budget.label, {
        fill: colours.ink,
        "text-anchor": "end",
      }),
      ...boxes,
      at === undefined
        ? undefined
        : svg(
            "path",
            { d: `M${at} ${y + 2}V${y + ROW - 2}`, stroke: colours.ink, "stroke-width": 2 },
            svg("title", {}, `residual: ${short(residual)} ${unitText(budget.unit)}`),
          ),
    );
  }

  /** Colour of a cause, hatched where colours repeat. */
  fillOf(cause) {
    const { colour, dash } = lookOf(this.causes.indexOf(cause) + 1, this.store.state.theme);
    return dash.length ? `url(#hatch-${cause})` : colour;
  }

  hatches(colours) {
    return svg(
      "defs",
      {},
      ...this.causes
        .filter((cause) => this.fillOf(cause).startsWith("url"))
        .map((cause) =>
          svg(
            "pattern",
            { id: `hatch-${cause}`, width: 6, height: 6, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" },
            svg("rect", { width: 6, height: 6, fill: colours.paper }),
            svg("rect", { width: 4, height: 6, fill: lookOf(this.causes.indexOf(cause) + 1, this.store.state.theme).colour }),
          ),
        ),
    );
  }

  legend(width, colours) {
    const group = svg("g", { transform: "translate(8 14)" });
    let [x, y] = [0, 0];
    for (const cause of [...this.causes, "residual"]) {
      const needed = 26 + 6.6 * cause.length;
      if (x + needed > width - 16) [x, y] = [0, y + 16];
      group.append(
        svg(
          "rect",
          cause === "residual"
            ? { x: x + 4, y: y - 10, width: 2, height: 12, fill: colours.ink }
            : { x, y: y - 9, width: 10, height: 10, fill: this.fillOf(cause) },
        ),
        text(x + 14, y, words(cause), { fill: colours.ink }),
      );
      x += needed;
    }
    return { group, height: y + 22 };
  }

  figures(width) {
    const causes = this.causes;
    const rows = this.budgets.map((budget) => [
      budget.label,
      budget.residual?.[this.kind],
      ...causes.map((cause) => budget.parts.get(cause)?.[this.kind]),
    ]);
    const table = { head: ["residual of", "residual", ...causes], rows };
    return this.drawings(width).map((drawing, i) => ({
      title: "budget",
      drawing,
      table: i === 0 ? table : { head: table.head, rows: [] },
    }));
  }
}

/** Sums of the negative and of the positive parts, the residual included. */
function extentOf(budget, kind) {
  let [low, high] = [Math.min(0, budget.residual?.[kind] ?? 0), Math.max(0, budget.residual?.[kind] ?? 0)];
  let [negative, positive] = [0, 0];
  for (const part of budget.parts.values()) {
    if (part[kind] < 0) negative += part[kind];
    else positive += part[kind];
  }
  return [Math.min(low, negative), Math.max(high, positive)];
}
