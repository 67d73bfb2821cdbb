/** One plot: a signal of every visible case over the common abscissa, with zoom and cursor. */
import uPlot from "uplot";
import { lookOf } from "../core/palette.js";
import { short, tickTexts } from "../core/ticks.js";
import { unitText, withUnit, words } from "../core/units.js";
import { button, html } from "../shell/dom.js";
import { inks } from "../shell/theme.js";
import { paintBands, paintWithin, strokeCurve } from "./painting.js";
import { Curve, abscissaSpec, extentWithin, ordinateAt, ordinateSpec } from "./curves.js";

const HEIGHT = 210; // pixels
const FADED = 0.2;
const PART_DASHES = [
  [7, 3],
  [2, 2],
  [9, 2, 2, 2],
]; // of the second signal of a plot and the next ones

/**
 * @typedef {object} Chosen what a plot shows
 * @property {string} family
 * @property {string} signal
 * @property {number | "norm"} column
 * @property {{signal: string, column: number | "norm"}[]} [also] signals drawn with it, with other dashes
 */

export class Plot {
  /**
   * @param {import("../shell/store.js").Store} store
   * @param {import("../data/client.js").Client} client
   * @param {Chosen} chosen
   * @param {{remove: () => void, bands: () => [number, number][], abscissa: (family: object) => object}} context
   */
  constructor(store, client, chosen, context) {
    Object.assign(this, { store, client, chosen, context });
    this.curves = new Map();
    this.title = html("h3");
    this.readout = html("div", { class: "readout" });
    this.area = html("div", { class: "area", tabindex: 0, role: "group" });
    this.element = html(
      "section",
      { class: "plot" },
      html(
        "header",
        {},
        this.title,
        this.readout,
        button("✕", "Remove this plot", () => context.remove()),
      ),
      this.area,
    );
    this.area.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    this.dirty = false;
    this.rebuild();
  }

  get family() {
    return this.store.state.families.find((family) => family.key === this.chosen.family);
  }

  get signal() {
    return this.family?.signals.find((signal) => signal.name === this.chosen.signal);
  }

  /** All signals of the plot with their names, the first one first. */
  get parts() {
    const all = [this.chosen, ...(this.chosen.also ?? [])];
    return all
      .map(({ signal: name, column }) => ({ signal: this.family.signals.find((one) => one.name === name), column }))
      .filter(({ signal }) => signal)
      .map(({ signal, column }) => ({
        signal,
        column,
        name: [words(signal.name), signal.letters[signal.columns.indexOf(column)]].filter(Boolean).join(" "),
      }));
  }

  /** Baseline member of the family, if differences are shown. */
  get baseline() {
    return this.family?.servo ? this.family.members.find((member) => member.case === this.store.state.baseline) : undefined;
  }

  /** Key of the abscissa: plots with the same one are linked. */
  get key() {
    return this.abscissa.key;
  }

  get members() {
    const { visible, baseline } = this.store.state;
    return this.family.members.filter(
      (member) => (!member.case || visible.has(member.case)) && !(this.baseline && member.case === baseline),
    );
  }

  /** Begins anew after a change of the cases, the abscissa or the baseline. */
  rebuild() {
    if (!this.signal) return;
    this.abscissa = this.context.abscissa(this.family);
    const { parts } = this;
    this.name = parts.map((part) => part.name).join(", ") + (this.baseline ? ` − ${this.baseline.label} at equal s` : "");
    this.title.textContent = withUnit(this.name, this.signal.unit);
    this.title.title = this.signal.label;
    this.area.setAttribute("aria-label", `${this.title.textContent} over ${this.abscissa.label}`);
    const wanted = new Map(
      parts.flatMap((part, index) => this.members.map((member) => [this.keyOf(member, part), { member, part, index }])),
    );
    for (const key of this.curves.keys()) if (!wanted.has(key)) this.curves.delete(key);
    for (const [key, one] of wanted) {
      const label = parts.length > 1 ? `${one.member.label} ${one.part.name}` : one.member.label;
      this.curves.set(key, { ...one, label, curve: this.curves.get(key)?.curve ?? this.newCurve(one.member, one.part) });
    }
    this.makeChart();
    this.refresh();
  }

  keyOf(member, { name }) {
    return [member.file, member.path, name, this.abscissa.key, this.baseline?.path, this.baseline?.file].join("|");
  }

  newCurve(member, { signal, column }) {
    const { family, abscissa } = this;
    const y = ordinateSpec(family, member, signal, column, this.baseline);
    const result = this.store.state.results[member.file];
    const gaps = result.has(`${member.path}/window`)
      ? { file: member.file, path: `${member.path}/window`, column: 0 }
      : undefined;
    return new Curve(this.client, { x: abscissaSpec(family, member, abscissa), y, monotone: abscissa.monotone, gaps }, () =>
      this.redraw(),
    );
  }

  makeChart() {
    this.u?.destroy();
    const colours = inks();
    const axis = {
      stroke: colours.ink,
      grid: { stroke: colours.grid, width: 1 },
      ticks: { stroke: colours.grid, width: 1 },
      font: "11px system-ui, sans-serif",
    };
    this.u = new uPlot(
      {
        width: Math.max(200, this.area.clientWidth || 600),
        height: HEIGHT,
        legend: { show: false },
        scales: { x: { time: false, range: () => this.range() }, y: { range: () => this.yRange() } },
        series: [{}, { paths: () => null, points: { show: false } }], // the curves have an abscissa each: drawCurves
        axes: [
          {
            ...axis,
            label: withUnit(this.abscissa.label, this.abscissa.unit),
            labelSize: 18,
            labelFont: axis.font,
            size: 26,
            values: (_, ticks) => tickTexts(ticks),
          },
          { ...axis, size: 66, values: (_, ticks) => tickTexts(ticks) },
        ],
        cursor: {
          drag: { x: true, y: false, setScale: false },
          points: { show: false },
          y: false,
          bind: { dblclick: () => () => this.store.setRange(this.key, undefined) },
        },
        hooks: {
          drawAxes: [(u) => paintBands(u, this.context.bands(this), inks().band)],
          draw: [() => this.drawCurves()],
          setSelect: [(u) => this.selected(u)],
        },
      },
      [
        [0, 1],
        [0, 1],
      ],
      this.area,
    );
    this.u.over.addEventListener("mousemove", (event) => this.moved(event.offsetX));
  }

  /** What is seen of the abscissa. @returns {[number, number]} */
  range() {
    return this.store.state.ranges[this.key] ?? this.extent();
  }

  /** All of the abscissa that is known yet. */
  extent() {
    const known = [...this.curves.values()]
      .map(({ curve }) => curve.overview?.extent)
      .filter((extent) => extent && Number.isFinite(extent[0]));
    if (known.length === 0) return [0, 1];
    const [low, high] = [Math.min(...known.map((e) => e[0])), Math.max(...known.map((e) => e[1]))];
    return low === high ? [low - 1, high + 1] : [low, high];
  }

  yRange() {
    const range = this.range();
    let [low, high] = [Infinity, -Infinity];
    for (const { curve } of this.curves.values()) {
      const points = curve.points(this.store.state.ranges[this.key]);
      if (!points) continue;
      const [least, greatest] = extentWithin(points, range);
      low = Math.min(low, least);
      high = Math.max(high, greatest);
    }
    if (low > high) return [0, 1];
    const room = high > low ? 0.06 * (high - low) : Math.abs(high) * 0.1 || 1;
    return [low - room, high + room];
  }

  /** Asks for what is seen. */
  refresh() {
    const pixels = Math.max(200, this.u.bbox.width / devicePixelRatio);
    const range = this.store.state.ranges[this.key];
    for (const { curve } of this.curves.values()) curve.ask({ range, pixels });
    this.redraw();
  }

  redraw() {
    if (this.dirty) return;
    this.dirty = true;
    requestAnimationFrame(() => {
      this.dirty = false;
      if (!this.element.isConnected) return;
      this.u.setData(this.u.data, true);
      this.showCursor();
    });
  }

  resize() {
    const width = this.area.clientWidth;
    if (width > 100 && width !== this.u.width) {
      this.u.setSize({ width, height: HEIGHT });
      this.refresh();
    }
  }

  lookOf({ member, index: part }) {
    const { cases, theme, highlight } = this.store.state;
    // Signals without cases have the colours for themselves.
    const alone = !member.case && this.family.members.length === 1;
    const index = member.case
      ? cases.findIndex((one) => one.id === member.case)
      : this.family.members.indexOf(member) + (alone ? part : 0) + 1;
    const faded = highlight && member.case && highlight.cases.size > 0 && !highlight.cases.has(member.case);
    const look = lookOf(index, theme);
    return {
      ...look,
      dash: part > 0 && !alone ? PART_DASHES[(part - 1) % PART_DASHES.length] : look.dash,
      opacity: faded ? FADED : 1,
      width: highlight && !faded ? 2 : 1.25,
    };
  }

  drawCurves() {
    paintWithin(this.u, () => {
      for (const one of this.curves.values()) {
        const points = one.curve.points(this.store.state.ranges[this.key]);
        if (points) strokeCurve(this.u, points, this.lookOf(one));
      }
    });
  }

  moved(left) {
    this.store.set({ cursor: { key: this.key, value: this.u.posToVal(left, "x") } });
  }

  selected(u) {
    if (u.select.width < 4) return;
    const range = [u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x")];
    u.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
    this.store.setRange(this.key, range);
  }

  wheel(event) {
    if (!event.ctrlKey && !event.shiftKey && document.activeElement !== this.area) return;
    event.preventDefault();
    const left = event.clientX - this.u.over.getBoundingClientRect().left;
    this.zoom(Math.exp(0.0015 * (event.deltaY || event.deltaX)), this.u.posToVal(left, "x"));
  }

  /** Changes what is seen by a factor about a place. */
  zoom(factor, about) {
    const [low, high] = this.range();
    const [least, greatest] = this.extent();
    const place = about ?? (low + high) / 2;
    const range = [Math.max(least, place - factor * (place - low)), Math.min(greatest, place + factor * (high - place))];
    this.store.setRange(this.key, range[0] <= least && range[1] >= greatest ? undefined : range);
  }

  /** Moves what is seen by a share of it. */
  pan(share) {
    const [low, high] = this.range();
    const [least, greatest] = this.extent();
    const shift = Math.min(greatest - high, Math.max(least - low, share * (high - low)));
    this.store.setRange(this.key, [low + shift, high + shift]);
  }

  showCursor() {
    const { cursor } = this.store.state;
    const shown = cursor?.key === this.key;
    if (shown) this.u.setCursor({ left: this.u.valToPos(cursor.value, "x"), top: 10 }, false);
    this.showValues(shown ? cursor.value : undefined);
  }

  showValues(at) {
    this.readout.replaceChildren(
      ...[...this.curves.values()].map((one) => {
        const { label, member, curve } = one;
        const look = this.lookOf(one);
        const points = curve.points(this.store.state.ranges[this.key]);
        const value =
          at !== undefined && this.abscissa.monotone && points
            ? ` ${short(ordinateAt(points, at))} ${unitText(this.signal.unit)}`
            : "";
        return html(
          "span",
          {
            class: curve.fault ? "fault" : "",
            title: curve.fault ?? member.label,
            style: `--colour: ${look.colour}; opacity: ${look.opacity === 1 ? 1 : 0.5}`,
          },
          html("i"),
          `${label || member.path}${value}`,
          curve.fault ? ` ${curve.fault}` : "",
        );
      }),
    );
  }

  /** What is seen, for export. */
  figure(width) {
    const state = this.store.state;
    const [min, max] = this.range();
    const [low, high] = this.yRange();
    const lines = [...this.curves.values()].flatMap((one) => {
      const points = one.curve.points(state.ranges[this.key]);
      return points ? [{ ...this.lookOf(one), label: one.label, x: points.x, y: points.y, exact: points.exact }] : [];
    });
    return {
      title: this.title.textContent,
      width,
      height: 260,
      lines,
      bands: this.context.bands(this),
      x: { label: withUnit(this.abscissa.label, this.abscissa.unit), min, max },
      y: { label: unitText(this.signal.unit), min: low, max: high },
    };
  }

  destroy() {
    this.u?.destroy();
    this.element.remove();
  }
}
