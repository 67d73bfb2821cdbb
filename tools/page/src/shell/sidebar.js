/** The tree on the left: files, cases with their colours, and signals by family. */
import { lookOf } from "../core/palette.js";
import { withUnit } from "../core/units.js";
import { button, html } from "./dom.js";

const OPEN_SIGNALS = 40; // a family with more signals begins folded, unless it is that of the run

const keyOf = (family, { signal, column }) => `${family}|${signal}|${column}`;

export class Sidebar {
  /** @param {import("./store.js").Store} store @param {{toggle: (chosen: object) => void, close: (file: number) => void}} actions */
  constructor(store, actions) {
    Object.assign(this, { store, actions });
    this.files = html("ul", { class: "files" });
    this.cases = html("ul", { class: "cases" });
    this.filter = html("input", { type: "search", id: "filter", placeholder: "filter signals", "aria-label": "Filter signals" });
    this.filter.addEventListener("input", () => this.showSignals());
    this.signals = html("div", { class: "signals" });
    this.caseHead = html(
      "h2",
      {},
      "Cases ",
      button("all", "Show all cases (A)", () => this.showAll()),
    );
    this.element = html(
      "nav",
      { class: "sidebar", "aria-label": "Cases and signals" },
      html("h2", {}, "Files"),
      this.files,
      this.caseHead,
      this.cases,
      html("h2", {}, "Signals"),
      this.filter,
      this.signals,
    );
    this.folded = new Map();
    store.on(["results"], () => this.showFiles());
    store.on(["cases", "visible", "theme", "highlight"], () => this.showCases());
    store.on(["families"], () => this.showSignals());
    store.on(["plots"], () => this.showChosen());
  }

  showAll() {
    const { cases, visible } = this.store.state;
    const all = new Set(cases.map((one) => one.id));
    this.store.set({ visible: visible.size === all.size ? new Set() : all });
  }

  showFiles() {
    this.files.replaceChildren(
      ...this.store.state.results.filter(Boolean).map((result) =>
        html(
          "li",
          {},
          html(
            "span",
            {
              title: `${result.title}\n${(result.size / 1e6).toFixed(1)} MB, servomill ${result.attributes.servomill_build ?? ""}`,
            },
            result.name,
          ),
          button("✕", `Close ${result.name}`, () => this.actions.close(result.index)),
        ),
      ),
    );
  }

  showCases() {
    const { cases, visible, theme, highlight } = this.store.state;
    const focused = document.activeElement?.dataset?.case;
    this.caseHead.hidden = cases.length === 0;
    this.cases.replaceChildren(
      ...cases.map((one, i) => {
        const input = html("input", { type: "checkbox", "data-case": one.id, onchange: () => this.toggleCase(one.id) });
        input.checked = visible.has(one.id);
        const dim = highlight?.cases.size > 0 && !highlight.cases.has(one.id);
        return html(
          "li",
          { class: dim ? "dim" : "", style: `--colour: ${lookOf(i, theme).colour}` },
          html("label", {}, input, html("i"), one.label, one.finished ? "" : ` (stopped: ${one.outcome})`),
        );
      }),
    );
    if (focused) this.cases.querySelector(`[data-case="${CSS.escape(focused)}"]`)?.focus();
  }

  toggleCase(id) {
    const visible = new Set(this.store.state.visible);
    if (!visible.delete(id)) visible.add(id);
    this.store.set({ visible });
  }

  showSignals() {
    const wanted = this.filter.value.trim().toLowerCase();
    const { chosen } = this;
    const focused = document.activeElement?.dataset?.signal;
    this.signals.replaceChildren(
      ...this.store.state.families.map((family) => this.familyElement(family, wanted, chosen)).filter(Boolean),
    );
    if (focused) this.signals.querySelector(`[data-signal="${CSS.escape(focused)}"]`)?.focus();
  }

  /** Signals that are in a plot. */
  get chosen() {
    return new Set(this.store.state.plots.flatMap((plot) => [plot, ...(plot.also ?? [])].map((one) => keyOf(plot.family, one))));
  }

  showChosen() {
    const { chosen } = this;
    for (const one of this.signals.querySelectorAll("[data-signal]"))
      one.setAttribute("aria-pressed", String(chosen.has(one.dataset.signal)));
  }

  familyElement(family, wanted, chosen) {
    const signals = family.signals.filter((signal) =>
      `${family.label} ${signal.name} ${signal.label}`.toLowerCase().includes(wanted),
    );
    if (signals.length === 0) return undefined;
    const few = family.servo || this.store.state.families.length <= 4;
    const open = wanted !== "" || (this.folded.get(family.key) ?? (few && (family.servo || signals.length <= OPEN_SIGNALS)));
    const details = html(
      "details",
      { open },
      html("summary", {}, family.servo ? "over time, s and axes" : family.label),
      html("ul", {}, ...signals.map((signal) => this.signalElement(family, signal, chosen))),
    );
    details.addEventListener("toggle", () => this.folded.set(family.key, details.open));
    return details;
  }

  signalElement(family, signal, chosen) {
    const buttons = signal.columns.map((column, i) => {
      const one = { family: family.key, signal: signal.name, column };
      const name = signal.letters[i];
      const pressed = chosen.has(keyOf(family.key, one));
      return button(
        name || withUnit(signal.name, signal.unit),
        `${signal.label}${name ? `, ${name}` : ""} (Shift: into the last plot)`,
        (event) => this.actions.toggle(one, event.shiftKey),
        {
          class: "signal",
          "aria-pressed": String(pressed),
          "data-signal": keyOf(family.key, one),
          "aria-label": `${signal.name} ${name}`.trim(),
        },
      );
    });
    if (signal.letters[0] === "") return html("li", {}, ...buttons);
    return html(
      "li",
      { class: "vector" },
      html("span", { title: signal.label }, withUnit(signal.name, signal.unit)),
      html("span", {}, ...buttons),
    );
  }
}
