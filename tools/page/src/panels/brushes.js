/** Brushes of parallel coordinates: intervals of columns, set by dragging along an axis or by numbers. */
import { short } from "../core/ticks.js";
import { html, select } from "../shell/dom.js";
import { parallelDrawing, parallelScales } from "./sweep_drawings.js";

const HEIGHT = 460; // pixels
const NEAR = 22; // pixels from an axis that still belong to it

export class Brushes {
  /** @param {() => void} onChange */
  constructor(onChange) {
    this.onChange = onChange;
    /** @type {Map<string, [number, number]>} */
    this.intervals = new Map();
    this.scales = [];
    this.column = "";
  }

  clear() {
    this.intervals.clear();
  }

  /** Rows within all brushes. */
  chosen(rows) {
    const columns = this.scales.map((axis) => axis.column);
    const within = (row) =>
      [...this.intervals].every(([name, [low, high]]) => {
        const value = columns.find((one) => one.name === name)?.values[row];
        return value === undefined || (value >= low && value <= high);
      });
    return new Set(rows.filter(within));
  }

  drawing(columns, rows, width, look) {
    this.scales = parallelScales(columns, width, HEIGHT);
    return parallelDrawing({
      scales: this.scales,
      rows,
      chosen: this.chosen(rows),
      brushes: this.intervals,
      width,
      height: HEIGHT,
      ...look,
    });
  }

  /** Column and its two limits, for those who do not drag. */
  form() {
    const axis = this.scales.find((one) => one.column.name === this.column) ?? this.scales[0];
    if (!axis) return html("span");
    const [low, high] = this.intervals.get(axis.column.name) ?? [axis.min, axis.max];
    const limit = (label, value, index) =>
      html("input", {
        type: "number",
        step: "any",
        value: Number(value.toPrecision(6)),
        "aria-label": label,
        "data-brush": label,
        style: "width: 90px",
        onchange: (event) => {
          const limits = [low, high];
          limits[index] = Number(event.target.value);
          this.set(axis, limits);
        },
      });
    const choice = select(
      "",
      this.scales.map((one) => [one.column.name, one.column.label]),
      axis.column.name,
      (name) => {
        this.column = name;
        this.onChange();
      },
    );
    return html("span", {}, choice, " from ", limit("least", low, 0), " to ", limit("greatest", high, 1));
  }

  set(axis, [a, b]) {
    this.intervals.set(axis.column.name, [Math.min(a, b), Math.max(a, b)]);
    this.column = axis.column.name;
    this.onChange();
  }

  /** Drags along the axes of a drawing. */
  listen(drawing) {
    let start;
    const place = (event) => {
      const box = drawing.getBoundingClientRect();
      const scale = Number(drawing.getAttribute("width")) / box.width;
      return [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
    };
    const valueAt = (axis, y) => axis.min + ((axis.top + axis.tall - y) / axis.tall) * (axis.max - axis.min);
    drawing.addEventListener("pointerdown", (event) => {
      const [x, y] = place(event);
      const axis = this.scales.find((one) => Math.abs(one.x - x) < NEAR);
      if (!axis) return;
      start = { axis, y };
      event.preventDefault();
    });
    drawing.addEventListener("pointerup", (event) => {
      if (!start) return;
      const { axis, y } = start;
      const end = place(event)[1];
      start = undefined;
      if (Math.abs(end - y) < 3) {
        this.intervals.delete(axis.column.name);
        this.onChange();
      } else this.set(axis, [valueAt(axis, y), valueAt(axis, end)]);
    });
  }

  /** "3 to 5" of each brush. */
  get text() {
    return [...this.intervals].map(([name, [low, high]]) => `${name} ${short(low)} to ${short(high)}`).join(", ");
  }
}
