/** All plots, one below the other: what they share and how keys move them. */
import { abscissaeOf } from "../data/model.js";
import { html } from "../shell/dom.js";
import { Plot } from "./plot.js";

const CURSOR_STEP = 0.005; // of what is seen
const PAN = 0.2;
const ZOOM = 1.25;

export class PlotStack {
  /** @param {import("../shell/store.js").Store} store @param {import("../data/client.js").Client} client */
  constructor(store, client) {
    Object.assign(this, { store, client });
    /** @type {Map<string, Plot>} */
    this.plots = new Map();
    /** @type {Map<string, object[]>} passes of the sections of each case */
    this.passes = new Map();
    this.empty = html("p", { class: "hint" }, "Choose a signal on the left.");
    this.element = html("div", { class: "plots", id: "plots" }, this.empty);
    document.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.each((plot) => plot.resize())).observe(this.element);
    store.on(["plots"], () => this.update());
    store.on(["visible", "abscissa", "baseline", "families", "theme", "cases"], () => this.each((plot) => plot.rebuild()));
    store.on(["ranges"], () => this.each((plot) => plot.refresh()));
    store.on(["highlight"], () => this.loadPasses());
    store.on(["cursor"], () => this.each((plot) => plot.showCursor()));
  }

  each(action) {
    for (const plot of this.plots.values()) action(plot);
  }

  /** Adds and removes plots as the state lists them. */
  update() {
    const wanted = new Map(this.store.state.plots.map((chosen) => [JSON.stringify(chosen), chosen]));
    for (const [key, plot] of this.plots) {
      if (wanted.has(key)) continue;
      plot.destroy();
      this.plots.delete(key);
    }
    for (const [key, chosen] of wanted) {
      if (this.plots.has(key)) continue;
      const plot = new Plot(this.store, this.client, chosen, {
        remove: () => this.toggle(chosen),
        bands: (one) => this.bands(one),
        abscissa: (family) => this.abscissa(family),
      });
      this.plots.set(key, plot);
      this.element.append(plot.element);
      plot.resize();
    }
    const ordered = [...wanted.keys()].map((key) => this.plots.get(key).element);
    if (ordered.some((element, i) => this.element.children[i + 1] !== element)) this.element.append(...ordered);
    this.empty.hidden = this.plots.size > 0;
  }

  /**
   * Shows a signal in a plot of its own, or removes it from where it is.
   * @param {{family: string, signal: string, column: number | "norm"}} chosen
   * @param {boolean} [together] in the last plot of its family instead
   */
  toggle(chosen, together = false) {
    const { plots } = this.store.state;
    const same = (one) => one.signal === chosen.signal && one.column === chosen.column;
    const owner = plots.find((plot) => plot.family === chosen.family && [plot, ...(plot.also ?? [])].some(same));
    const host = together ? plots.findLast((plot) => plot.family === chosen.family) : undefined;
    const replace = (plot, also) =>
      plots.map((one) =>
        one === plot ? { family: plot.family, signal: plot.signal, column: plot.column, ...(also.length ? { also } : {}) } : one,
      );
    if (owner && same(owner)) this.store.set({ plots: plots.filter((one) => one !== owner) });
    else if (owner)
      this.store.set({
        plots: replace(
          owner,
          owner.also.filter((one) => !same(one)),
        ),
      });
    else if (host)
      this.store.set({ plots: replace(host, [...(host.also ?? []), { signal: chosen.signal, column: chosen.column }]) });
    else this.store.set({ plots: [...plots, chosen] });
  }

  /** What the curves of a family are drawn over. Differences are over s unless over time or s already. */
  abscissa(family) {
    const { results, abscissa } = this.store.state;
    if (family.servo) {
      const choices = abscissaeOf(family, results);
      return choices.find((one) => one.key === abscissa) ?? choices[0];
    }
    const member = family.members[0];
    const attributes = results[member.file].dataset(`${member.path}/${family.scale}`)?.attributes ?? {};
    const label = family.scale ? attributes.long_name || family.scale : "row";
    return { key: `${label}|${attributes.units ?? ""}`, label, unit: attributes.units ?? "1", monotone: true };
  }

  /** Parts of the abscissa of a plot that belong to the highlighted sections. */
  bands(plot) {
    const { highlight } = this.store.state;
    if (!highlight || highlight.sections.size === 0 || !plot.family.servo || !["time", "s"].includes(plot.key)) return [];
    return this.passesOf(highlight).map((pass) => pass[plot.key]);
  }

  /** Passes of the highlighted sections: of the highlighted case, else of the first. */
  passesOf({ cases, sections }) {
    const one = this.store.state.cases.find((candidate) => candidate.servo && (cases.size === 0 || cases.has(candidate.id)));
    return (this.passes.get(one?.id) ?? []).filter((pass) => sections.has(one.sections[pass.section]));
  }

  async loadPasses() {
    const { highlight, cases } = this.store.state;
    const one =
      highlight &&
      cases.find((candidate) => candidate.servo && (highlight.cases.size === 0 || highlight.cases.has(candidate.id)));
    if (one && highlight.sections.size > 0 && !this.passes.has(one.id)) {
      this.passes.set(one.id, await this.client.ask("sections", { file: one.file, servo: one.servo }));
    }
    this.each((plot) => {
      plot.redraw();
    });
  }

  /** Shows only the highlighted sections. */
  zoomToHighlight() {
    const { highlight, abscissa } = this.store.state;
    const passes = highlight ? this.passesOf(highlight) : [];
    const key = abscissa === "s" ? "s" : "time";
    if (passes.length === 0 || abscissa !== key) return;
    const [low, high] = [Math.min(...passes.map((pass) => pass[key][0])), Math.max(...passes.map((pass) => pass[key][1]))];
    const room = 0.03 * (high - low);
    this.store.setRange(key, [low - room, high + room]);
  }

  /** Plot that has the focus, or the first. */
  get current() {
    const plots = [...this.plots.values()];
    return plots.find((plot) => plot.element.contains(document.activeElement)) ?? plots[0];
  }

  /** Moves the cursor by a share of what is seen. */
  moveCursor(plot, share) {
    const [low, high] = plot.range();
    const { cursor } = this.store.state;
    const value = cursor?.key === plot.key ? cursor.value : (low + high) / 2;
    this.store.set({ cursor: { key: plot.key, value: Math.min(high, Math.max(low, value + share * (high - low))) } });
  }

  key(event) {
    const plot = this.current;
    if (!plot || !this.element.isConnected || event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target.closest("button, input, select, dialog, canvas.scene, tr")) return;
    const large = event.shiftKey;
    const { cursor } = this.store.state;
    const about = cursor?.key === plot.key ? cursor.value : undefined;
    const actions = {
      ArrowLeft: () => this.moveCursor(plot, -CURSOR_STEP * (large ? 10 : 1)),
      ArrowRight: () => this.moveCursor(plot, CURSOR_STEP * (large ? 10 : 1)),
      "+": () => plot.zoom(1 / ZOOM, about),
      "=": () => plot.zoom(1 / ZOOM, about),
      "-": () => plot.zoom(ZOOM, about),
      ",": () => plot.pan(-PAN),
      ".": () => plot.pan(PAN),
      0: () => this.store.setRange(plot.key, undefined),
      Home: () => this.moveCursor(plot, -1),
      End: () => this.moveCursor(plot, 1),
      Delete: () => plot.context.remove(),
    };
    if (!actions[event.key]) return;
    event.preventDefault();
    actions[event.key]();
  }

  /** Plots as they are seen, for export. */
  figures(width) {
    return [...this.plots.values()].map((plot) => plot.figure(width));
  }
}
