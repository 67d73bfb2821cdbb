/** Positions of the machine's axes, and where the program is, at the cursor. */
import { lookOf } from "../core/palette.js";
import { short } from "../core/ticks.js";
import { unitText, withUnit } from "../core/units.js";
import { latestOnly } from "../data/client.js";
import { cursorScale, valuesAtCursor } from "../data/cursor.js";
import { chainOf } from "../core/chain.js";
import { html } from "../shell/dom.js";
import { colourOf, MachineScene } from "./machine_scene.js";

const SMALLEST = 100; // mm, travel by which the bodies are drawn
const LONG_PROGRAM = "/inputs/program";
const POSITIONS = ["true_linear", "true_rotary"];

export class MachineView {
  constructor({ store, client }) {
    Object.assign(this, { store, client, name: "Machine" });
    this.place = html("p", { class: "hint" }, "Move the cursor over a plot over time or arc length.");
    this.line = html("pre");
    this.axes = html("div");
    this.scene = new MachineScene();
    this.element = html("div", {}, this.place, this.line, this.scene.canvas, this.axes);
    new ResizeObserver(() => this.scene.resize(this.element.clientWidth)).observe(this.element);
    this.programs = new Map();
    this.ranges = new Map();
    this.follow = latestOnly(() => this.update());
    store.on(["cursor", "visible", "theme", "cases"], () => this.seen && this.follow());
  }

  get cases() {
    const { cases, visible } = this.store.state;
    return cases.filter((one) => one.servo && visible.has(one.id));
  }

  available() {
    return this.store.state.cases.some((one) => one.servo);
  }

  show() {
    this.seen = true;
    this.follow();
  }

  hide() {
    this.seen = false;
  }

  /** Axes of a case as [dataset, column, letter, unit]. */
  axesOf(one) {
    const result = this.store.state.results[one.file];
    return POSITIONS.flatMap((name) => {
      const dataset = result.dataset(`${one.servo}/${name}`);
      return dataset
        ? Array.from(dataset.attributes.columns ?? "", (letter, i) => [name, i, letter, dataset.attributes.units])
        : [];
    });
  }

  async update() {
    const cursor = cursorScale(this.store.state);
    const cases = this.cases;
    if (!cursor || cases.length === 0) return;
    const found = await Promise.all(
      cases.map(async (one) => {
        const axes = this.axesOf(one);
        const wanted = [...axes.map(([name, i]) => [name, i]), ["time", 0], ["s", 0], ["line", 0], ["section", 0]];
        const { values } = await valuesAtCursor(this.client, one, cursor, wanted);
        return { one, axes, values };
      }),
    );
    await this.showAxes(found);
    await this.showPlace(found[0]); // last: the first line of a long program takes a reading of all of it
  }

  async showPlace({ one, axes, values }) {
    const [time, s, line, section] = values.slice(axes.length);
    const number = Math.floor(line);
    const name = one.sections[Math.round(section)] ?? "";
    this.place.textContent = `${one.label}: ${short(time, 6)} s, s = ${short(s, 6)} mm${name ? `, section ${name}` : ""}`;
    const text = await this.lineOf(one.file, number);
    this.line.textContent = text === undefined ? `line ${number}` : `line ${number}: ${text.trim()}`;
  }

  /** A line of the program; undefined where the file has none. Programs above 1 MB are a dataset. */
  async lineOf(file, number) {
    if (this.store.state.results[file].dataset(LONG_PROGRAM)) return this.client.ask("line", file, LONG_PROGRAM, number);
    return (await this.programOf(file))[number - 1];
  }

  async programOf(file) {
    if (!this.programs.has(file)) {
      const text = this.store.state.results[file].has("/inputs")
        ? await this.client.ask("attribute", file, "/inputs", "program").catch(() => "")
        : "";
      this.programs.set(file, String(text ?? "").split("\n"));
    }
    return this.programs.get(file);
  }

  /** Range of an axis over the run. */
  async rangeOf(one, name, column) {
    const key = `${one.id}|${name}|${column}`;
    if (!this.ranges.has(key))
      this.ranges.set(key, await this.client.ask("range", { file: one.file, path: `${one.servo}/${name}`, column }));
    return this.ranges.get(key);
  }

  async showAxes(found) {
    const { cases, theme } = this.store.state;
    const rows = [];
    const [first] = found;
    const joints = await this.showBodies(first);
    for (const [k, [name, column, letter, unit]] of first.axes.entries()) {
      const [low, high] = await this.rangeOf(first.one, name, column);
      const share = (value) => (high > low ? Math.min(100, Math.max(0, (100 * (value - low)) / (high - low))) : 50);
      const marks = found.map(({ one, values }) =>
        html("i", {
          style: `left: calc(${share(values[k])}% - 1px); --colour: ${lookOf(cases.indexOf(one), theme).colour}`,
          title: one.label,
        }),
      );
      rows.push(
        html(
          "tr",
          {},
          html("th", {}, ...this.chip(joints, letter), withUnit(letter, unit)),
          html("td", { class: "number" }, short(first.values[k], 7)),
          html("td", { style: "width: 60%" }, html("div", { class: "axisbar" }, ...marks)),
          html("td", { class: "number" }, `${short(low, 4)} … ${short(high, 4)} ${unitText(unit)}`),
        ),
      );
    }
    this.axes.replaceChildren(html("table", {}, html("tbody", {}, ...rows)));
    this.positions = found.map(({ one, axes, values }) => ({
      case: one.label,
      values: Object.fromEntries(axes.map(([, , letter], k) => [letter, values[k]])),
    }));
  }

  /** Moves the bodies of a case; its joints, [] of files without them. */
  async showBodies({ one, axes, values }) {
    const result = this.store.state.results[one.file];
    const joints = chainOf(result.groups.get(one.path).attributes);
    this.scene.canvas.hidden = joints.length === 0;
    if (joints.length === 0) return joints;
    const positions = Object.fromEntries(axes.map(([, , letter], k) => [letter, values[k]]));
    const travels = await Promise.all(
      axes.filter(([name]) => name === "true_linear").map(([name, column]) => this.rangeOf(one, name, column)),
    );
    this.scene.begin();
    this.scene.resize(this.element.clientWidth);
    this.scene.build(joints, Math.max(...travels.flatMap(([low, high]) => [high - low, 0.5 * high, -0.5 * low]), SMALLEST), this.store.state.theme);
    this.scene.move(joints, positions);
    return joints;
  }

  /** Colour of the body that an axis moves. */
  chip(joints, letter) {
    const index = joints.findIndex((joint) => joint.letter === letter);
    return index < 0 ? [] : [html("i", { class: "chip", style: `--colour: ${colourOf(index, this.store.state.theme)}` })];
  }

  figures() {
    return [];
  }
}
