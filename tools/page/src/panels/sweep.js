/** Sweeps: curves over one parameter, maps over two, parallel coordinates with brushes. */
import { lookOf } from "../core/palette.js";
import { short } from "../core/ticks.js";
import { withUnit } from "../core/units.js";
import { levelsOf, loadSweep, textOf, varying } from "../data/sweep.js";
import { chart, limitsOf } from "../plots/chart.js";
import { button, html, select } from "../shell/dom.js";
import { inks } from "../shell/theme.js";
import { Brushes } from "./brushes.js";
import { mapDrawing } from "./sweep_drawings.js";

const CHART_HEIGHT = 300; // pixels
const MAX_LINES = 12; // of one quantity, for the values of another parameter
const MAX_AXES = 16; // of parallel coordinates
const MODES = [
  ["curves", "curves"],
  ["map", "map"],
  ["parallel", "parallel coordinates"],
];

export class SweepView {
  constructor({ store, client }) {
    Object.assign(this, { store, client, name: "Sweep", mode: "curves" });
    this.controls = html("div", { class: "controls" });
    this.drawings = html("div");
    this.brushes = new Brushes(() => this.draw());
    this.element = html("div", {}, this.controls, this.drawings);
    store.on(["results"], () => {
      this.table = undefined;
      if (this.seen) this.show();
    });
    store.on(["theme"], () => this.table && this.draw());
    new ResizeObserver(() => this.table && this.draw()).observe(this.element);
  }

  get result() {
    return this.store.state.results.find((result) => result?.has("/sweep"));
  }

  available() {
    return this.result !== undefined;
  }

  async show() {
    this.seen = true;
    if (this.table || !this.result) return;
    this.table = await loadSweep(this.client, this.result);
    this.parameters = varying(this.table.columns);
    this.quantities = this.table.columns.filter((column) => column.role === "quantity");
    [this.x, this.y] = this.parameters;
    this.quantity = this.quantities[0];
    this.brushes.clear();
    if (this.parameters.length > 2) this.mode = "parallel";
    else this.mode = this.parameters.length > 1 ? "map" : "curves";
    this.draw();
  }

  hide() {
    this.seen = false;
  }

  /** Points that ran to their end. */
  get rows() {
    const { points, done } = this.table;
    return Array.from({ length: points }, (_, i) => i).filter((i) => done.length === 0 || done[i]);
  }

  /** Parameters beside the abscissa. */
  get others() {
    return this.parameters.filter((one) => one !== this.x);
  }

  /** What a drawing leaves out, in words. */
  get omitted() {
    if (this.mode === "parallel") {
      const all = this.parameters.length + this.quantities.length;
      return all > MAX_AXES ? `the first ${MAX_AXES} of ${all} columns are drawn` : "";
    }
    const joined = this.mode === "curves" ? this.others.filter((one) => !hasFewLevels(one)) : [];
    if (joined.length === 0) return "";
    return `a line joins points of all values of ${joined.map((one) => one.label).join(", ")}: more than ${MAX_LINES} each`;
  }

  showControls() {
    const name = (column) => column?.name ?? "";
    const choice = (label, key, columns) =>
      select(
        label,
        columns.map((one) => [one.name, one.label]),
        name(this[key]),
        (value) => {
          this[key] = columns.find((one) => one.name === value);
          this.draw();
        },
      );
    const parts = [
      select(
        "as",
        MODES.filter(([mode]) => mode !== "map" || this.parameters.length > 1),
        this.mode,
        (mode) => {
          this.mode = mode;
          this.draw();
        },
      ),
    ];
    if (this.mode !== "parallel") parts.push(choice("over", "x", this.parameters));
    if (this.mode === "map") parts.push(choice("and", "y", this.parameters), choice("of", "quantity", this.quantities));
    if (this.mode === "parallel")
      parts.push(
        html(
          "span",
          { class: "hint" },
          `${this.brushes.chosen(this.rows).size} of ${this.rows.length} points; drag along an axis, or choose limits:`,
        ),
        this.brushes.form(),
        button("Clear", "Remove all brushes", () => {
          this.brushes.clear();
          this.draw();
        }),
      );
    if (this.omitted) parts.push(html("span", { class: "hint" }, this.omitted));
    this.controls.replaceChildren(...parts);
  }

  get width() {
    return Math.max(400, this.element.clientWidth - 4);
  }

  draw() {
    if (this.parameters.length === 0) {
      this.drawings.replaceChildren(html("p", { class: "hint" }, "No parameter of this sweep varies."));
      return;
    }
    const focused = document.activeElement?.dataset?.brush;
    const drawings = {
      curves: () => this.charts(this.width).map((one) => chart({ ...one, colours: inks() })),
      map: () => [this.map(this.width)],
      parallel: () => [this.parallel(this.width)],
    }[this.mode]();
    this.drawings.replaceChildren(...drawings);
    if (this.mode === "parallel") this.brushes.listen(drawings[0]);
    this.showControls();
    if (focused) this.controls.querySelector(`[data-brush="${CSS.escape(focused)}"]`)?.focus();
  }

  /** Quantities of the same kind share a chart: one line for each case and each value of the other parameters. */
  charts(width) {
    const kinds = groupBy(this.quantities, kindOf);
    const x = this.x;
    const [min, max] = limitsOf([x.values]);
    return [...kinds.values()].map((quantities) => {
      const lines = quantities
        .flatMap((quantity) => this.linesOf(quantity))
        .map((line, i) => ({ ...lookOf(i, this.store.state.theme), ...line }));
      const [low, high] = limitsOf(lines.map((line) => line.y));
      return {
        title: withUnit(kindOf(quantities[0]), quantities[0].unit),
        width,
        height: CHART_HEIGHT,
        lines,
        x: { label: withUnit(x.label, x.unit), min, max },
        y: { label: "", min: low, max: high },
      };
    });
  }

  linesOf(quantity) {
    const others = this.others.filter(hasFewLevels);
    const groups = groupBy(this.rows, (row) =>
      others.map((one) => `${one.label} ${textOf(one, one.values[row], short)}`).join(", "),
    );
    return [...groups].map(([label, rows]) => {
      const sorted = [...rows].sort((a, b) => this.x.values[a] - this.x.values[b]);
      return {
        label: [quantity.case || quantity.label, label].filter(Boolean).join(": "),
        x: sorted.map((row) => this.x.values[row]),
        y: sorted.map((row) => quantity.values[row]),
      };
    });
  }

  map(width) {
    const { x, quantity, rows } = this;
    const y = this.y === x ? this.parameters.find((one) => one !== x) : this.y;
    this.y = y;
    return mapDrawing({
      x,
      y,
      quantity,
      rows,
      width,
      height: Math.min(560, 120 + 60 * levelsOf(y).length),
      colours: inks(),
      theme: this.store.state.theme,
    });
  }

  parallel(width) {
    const columns = [...this.parameters, ...this.quantities].slice(0, MAX_AXES);
    return this.brushes.drawing(columns, this.rows, width, { colours: inks(), theme: this.store.state.theme });
  }

  figures(width) {
    if (!this.table) return [];
    const rows = this.mode === "parallel" ? this.rows.filter((row) => this.brushes.chosen(this.rows).has(row)) : this.rows;
    const columns = this.table.columns;
    const table = {
      head: columns.map((one) => withUnit(one.label, one.unit)),
      rows: rows.map((row) => columns.map((one) => textOf(one, one.values[row], (v) => v))),
    };
    if (this.mode === "curves") return this.charts(width);
    return [{ title: "sweep", drawing: this.mode === "map" ? this.map(width) : this.parallel(width), table }];
  }
}

/** A line for each value of such a parameter can be distinguished. */
function hasFewLevels(parameter) {
  return levelsOf(parameter).length <= MAX_LINES;
}

/** Label of a quantity without its case. */
function kindOf(quantity) {
  return quantity.label.replace(` of ${quantity.case}`, "");
}

function groupBy(items, key) {
  const groups = new Map();
  for (const item of items) {
    const name = key(item);
    if (!groups.has(name)) groups.set(name, []);
    groups.get(name).push(item);
  }
  return groups;
}
