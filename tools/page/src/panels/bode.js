/** Frequency responses: magnitude and phase, exact as lines and measured as dots, with the margins. */
import { lookOf } from "../core/palette.js";
import { short } from "../core/ticks.js";
import { words } from "../core/units.js";
import { latestOnly } from "../data/client.js";
import { chart, limitsOf } from "../plots/chart.js";
import { html, select } from "../shell/dom.js";
import { inks } from "../shell/theme.js";

const HEIGHT = 330; // pixels
const baseName = (path) => path.slice(path.lastIndexOf("/") + 1);

export class BodeView {
  constructor({ store, client }) {
    Object.assign(this, { store, client, name: "Bode", curves: [] });
    this.hidden = new Set();
    this.controls = html("div", { class: "controls" });
    this.drawing = html("div");
    this.margins = html("div");
    this.element = html("div", {}, this.controls, this.drawing, this.margins);
    this.load = latestOnly(() => this.read());
    store.on(["results"], () => {
      this.axis = undefined;
      if (this.seen) this.load();
    });
    store.on(["theme"], () => this.seen && this.draw());
    new ResizeObserver(() => this.seen && this.draw()).observe(this.element);
  }

  get axes() {
    return this.store.state.results.filter(Boolean).flatMap((result) =>
      result.below("/bode").map((group) => ({
        key: `${result.index}${group.path}`,
        label: `${baseName(group.path)} of ${result.name}`,
        result,
        group,
      })),
    );
  }

  available() {
    return this.axes.length > 0;
  }

  show() {
    this.seen = true;
    if (!this.axis) this.load();
  }

  hide() {
    this.seen = false;
  }

  async read() {
    const axes = this.axes;
    this.axis = axes.find((one) => one.key === this.axis?.key) ?? axes[0];
    if (!this.axis) return;
    const { result, group } = this.axis;
    const curves = result.below(group.path).filter((one) => result.has(`${one.path}/frequency`));
    this.curves = await Promise.all(
      curves.map(async (one) => {
        const read = (name) =>
          result.has(`${one.path}/${name}`) ? this.client.ask("values", result.index, `${one.path}/${name}`) : [];
        const names = ["frequency", "magnitude", "phase", "measured_frequency", "measured_magnitude", "measured_phase"];
        const values = await Promise.all(names.map(read));
        return {
          name: baseName(one.path),
          label: one.attributes.long_name ?? "",
          unit: result.dataset(`${one.path}/magnitude`)?.attributes.units ?? "1",
          ...Object.fromEntries(names.map((name, i) => [name, values[i]])),
        };
      }),
    );
    this.showControls(axes);
    this.showMargins();
    this.draw();
  }

  showControls(axes) {
    this.controls.replaceChildren(
      ...(axes.length > 1
        ? [
            select(
              "axis",
              axes.map((one) => [one.key, one.label]),
              this.axis.key,
              (key) => {
                this.axis = axes.find((one) => one.key === key);
                this.load();
              },
            ),
          ]
        : []),
      ...this.curves.map((curve) => {
        const input = html("input", {
          type: "checkbox",
          onchange: () => {
            if (!this.hidden.delete(curve.name)) this.hidden.add(curve.name);
            this.draw();
          },
        });
        input.checked = !this.hidden.has(curve.name);
        return html("label", { title: curve.label }, input, ` ${words(curve.name)}`);
      }),
    );
  }

  /** Figures of the loops: margins, bandwidth ... */
  showMargins() {
    const { result, group } = this.axis;
    const loops = result.below(group.path).filter((one) => one.path.endsWith("_loop"));
    const names = [...new Set(loops.flatMap((one) => Object.keys(one.attributes)))].sort();
    this.margins.replaceChildren(
      ...(loops.length === 0
        ? []
        : [
            html(
              "table",
              {},
              html(
                "thead",
                {},
                html(
                  "tr",
                  {},
                  html("th", {}, ""),
                  ...loops.map((one) => html("th", { class: "number" }, words(baseName(one.path)))),
                ),
              ),
              html(
                "tbody",
                {},
                ...names.map((name) =>
                  html(
                    "tr",
                    {},
                    html("td", {}, words(name)),
                    ...loops.map((one) =>
                      html(
                        "td",
                        { class: "number" },
                        typeof one.attributes[name] === "number" ? short(one.attributes[name]) : (one.attributes[name] ?? ""),
                      ),
                    ),
                  ),
                ),
              ),
            ),
          ]),
    );
  }

  /** Charts of magnitude, one for each unit, and of phase. */
  charts(width) {
    const shown = this.curves.filter((curve) => !this.hidden.has(curve.name));
    const [min, max] = limitsOf(
      shown.map((curve) => curve.frequency),
      true,
    );
    const x = { label: "frequency (Hz)", min, max, log: true };
    const lines = (curves, kind) =>
      curves.flatMap((curve) => {
        const { colour } = lookOf(this.curves.indexOf(curve), this.store.state.theme);
        const measured = curve[`measured_${kind}`];
        return [
          { label: words(curve.name), colour, x: curve.frequency, y: curve[kind] },
          ...(measured.length ? [{ label: "", colour, dots: true, x: curve.measured_frequency, y: measured }] : []),
        ];
      });
    const magnitudes = [...new Set(shown.map((curve) => curve.unit))].map((unit) => {
      const curves = lines(
        shown.filter((curve) => curve.unit === unit),
        "magnitude",
      );
      const [low, high] = limitsOf(
        curves.map((line) => line.y),
        true,
      );
      return {
        title: unit === "1" ? "magnitude" : `magnitude (${unit})`,
        width,
        height: HEIGHT,
        x,
        y: { label: "", min: low, max: high, log: true },
        lines: curves,
      };
    });
    const phases = lines(shown, "phase");
    const [low, high] = limitsOf(phases.map((line) => line.y));
    return [
      ...magnitudes,
      {
        title: "phase (°); lines: exact, dots: simulated",
        width,
        height: HEIGHT,
        x,
        y: { label: "", min: low, max: high },
        lines: phases,
      },
    ];
  }

  draw() {
    if (!this.axis) return;
    const width = Math.max(500, this.element.clientWidth - 4);
    this.drawing.replaceChildren(...this.charts(width).map((one) => chart({ ...one, colours: inks() })));
  }

  figures(width) {
    return this.axis ? this.charts(width) : [];
  }
}
