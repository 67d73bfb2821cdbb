/** Circles of the program as a ball bar draws them: one or several sections, all visible cases. */
import { lookOf } from "../core/palette.js";
import { short } from "../core/ticks.js";
import { latestOnly } from "../data/client.js";
import { html, slider } from "../shell/dom.js";
import { inks } from "../shell/theme.js";
import { fittingMagnification, polarDrawing } from "./polar.js";

const SIZE = 400; // pixels
const CLOCKWISE = [6, 3];

export class CirclesView {
  constructor({ store, client }) {
    Object.assign(this, { store, client, name: "Circles", stale: true, circles: [] });
    /** @type {Map<string, object[]>} circles by case */
    this.known = new Map();
    /** @type {Set<string> | undefined} names of sections */
    this.chosen = undefined;
    this.sections = html("div", { class: "controls", role: "group", "aria-label": "Sections" });
    this.controls = html("div", { class: "controls" });
    this.drawing = html("div");
    this.table = html("div");
    this.element = html("div", {}, this.sections, this.controls, this.drawing, this.table);
    this.load = latestOnly(() => this.find());
    store.on(["cases", "visible", "theme", "highlight"], () => {
      this.stale = true;
      if (this.seen) this.load();
    });
    store.on(["results"], () => {
      this.chosen = undefined;
      this.magnification = undefined;
    });
  }

  get cases() {
    const { cases, visible, results } = this.store.state;
    return cases.filter((one) => one.servo && visible.has(one.id) && results[one.file].has(`${one.servo}/tool_position_true`));
  }

  available() {
    const { cases, results } = this.store.state;
    return cases.some((one) => one.servo && one.sections.length > 1 && results[one.file].has(`${one.servo}/tool_position_true`));
  }

  show() {
    this.seen = true;
    if (this.stale) this.load();
  }

  hide() {
    this.seen = false;
  }

  async find() {
    this.stale = false;
    for (const one of this.cases) {
      if (!this.known.has(one.id)) this.known.set(one.id, await this.circlesOf(one));
    }
    const names = [...new Set(this.cases.flatMap((one) => this.known.get(one.id).map((circle) => circle.section)))];
    const highlighted = names.filter((name) => this.store.state.highlight?.sections.has(name));
    if (highlighted.length > 0) this.chosen = new Set(highlighted);
    this.chosen ??= new Set(names.slice(0, 1));
    this.showSections(names);
    this.draw();
  }

  async circlesOf(one) {
    const passes = await this.client.ask("sections", { file: one.file, servo: one.servo });
    const circles = [];
    for (const pass of passes.filter((candidate) => one.sections[candidate.section])) {
      const circle = await this.client.ask("circle", { file: one.file, servo: one.servo, pass });
      if (circle) circles.push({ ...circle, section: one.sections[pass.section] });
    }
    return circles;
  }

  showSections(names) {
    if (names.length === 0)
      this.sections.replaceChildren(html("p", { class: "hint" }, "No section of the visible cases is a circle."));
    else
      this.sections.replaceChildren(
        ...names.map((name) => {
          const input = html("input", {
            type: "checkbox",
            onchange: () => {
              if (!this.chosen.delete(name)) this.chosen.add(name);
              this.draw();
            },
          });
          input.checked = this.chosen.has(name);
          return html("label", {}, input, ` ${name}`);
        }),
      );
  }

  /** Circles of the chosen sections with the looks of their cases; clockwise ones are dashed. */
  selected() {
    const { cases, theme } = this.store.state;
    return this.cases.flatMap((one) =>
      (this.known.get(one.id) ?? [])
        .filter((circle) => this.chosen.has(circle.section))
        .map((circle) => ({
          ...circle,
          case: one,
          colour: lookOf(cases.indexOf(one), theme).colour,
          dash: circle.sense < 0 ? CLOCKWISE : [],
          label: `${one.label}, ${circle.section}`,
        })),
    );
  }

  draw() {
    this.circles = this.selected();
    const fitting = fittingMagnification(this.circles);
    const value = Math.log10(this.magnification ?? fitting);
    this.controls.replaceChildren(
      slider("magnification", { min: 0, max: 5, step: 0.05, value, text: (e) => `${short(10 ** e, 2)} ×` }, (e) => {
        this.magnification = 10 ** e;
        this.redraw();
      }),
    );
    this.table.replaceChildren(this.tableOf());
    this.redraw();
  }

  redraw() {
    const magnification = this.magnification ?? fittingMagnification(this.circles);
    this.drawing.replaceChildren(polarDrawing({ circles: this.circles, magnification, size: SIZE, colours: inks() }));
  }

  rows() {
    const um = (mm) => 1000 * mm;
    return this.circles.map((c) => [
      c.case.label,
      c.section,
      c.nominalRadius,
      um(c.radius - c.nominalRadius),
      um(c.circularity),
      um(c.cx),
      um(c.cy),
    ]);
  }

  tableOf() {
    const head = ["case", "section", "R (mm)", "R − nom. (µm)", "range (µm)"];
    return html(
      "table",
      {},
      html("thead", {}, html("tr", {}, ...head.map((name, i) => html("th", { class: i > 1 ? "number" : "" }, name)))),
      html(
        "tbody",
        {},
        ...this.rows().map((row, k) =>
          html(
            "tr",
            {},
            ...row
              .slice(0, 5)
              .map((cell, i) =>
                html(
                  "td",
                  { class: i > 1 ? "number" : "" },
                  i === 0 ? html("span", { class: "swatch", style: `--colour: ${this.circles[k].colour}` }) : undefined,
                  typeof cell === "number" ? short(cell) : cell,
                ),
              ),
          ),
        ),
      ),
    );
  }

  figures() {
    if (this.circles.length === 0) return [];
    const rows = this.circles.flatMap((c) =>
      Array.from(c.angle, (angle, i) => [c.case.label, c.section, (angle * 180) / Math.PI, 1000 * c.deviation[i]]),
    );
    return [
      {
        title: "circles",
        drawing: this.drawing.firstChild,
        table: { head: ["case", "section", "angle_deg", "radial_deviation_um"], rows },
      },
    ];
  }
}
