/** Table of the comparison; a row highlights its case and sections in the plots. */
import { lookOf } from "../core/palette.js";
import { short } from "../core/ticks.js";
import { unitText, words } from "../core/units.js";
import { comparisonOf } from "../data/model.js";
import { button, html } from "../shell/dom.js";

const HEAD = ["quantity", "sections", "case", "value", "reference"];

export class ComparisonView {
  constructor({ store, client, stack }) {
    Object.assign(this, { store, client, stack, name: "Comparison" });
    /** @type {import("../data/model.js").ComparisonLine[]} */
    this.lines = [];
    this.filter = html("input", { type: "search", placeholder: "filter", "aria-label": "Filter the comparison" });
    this.filter.addEventListener("input", () => this.draw());
    this.body = html("tbody");
    this.table = html(
      "table",
      {},
      html("thead", {}, html("tr", {}, ...HEAD.map((name) => html("th", { class: name === "value" ? "number" : "" }, name)))),
      this.body,
    );
    this.element = html(
      "div",
      { class: "comparison" },
      html(
        "div",
        { class: "controls" },
        this.filter,
        button("Zoom to sections", "Zoom to the highlighted sections (Z)", () => stack.zoomToHighlight()),
        button("Clear", "End the highlight (Esc)", () => store.set({ highlight: undefined })),
      ),
      this.table,
    );
    this.body.addEventListener("click", (event) => this.choose(event.target.closest("tr")));
    this.body.addEventListener("keydown", (event) => this.key(event));
    store.on(["results"], () => this.load());
    store.on(["highlight", "theme", "cases"], () => this.draw());
  }

  available() {
    return this.store.state.results.some((result) => result?.below("/comparison").length > 0);
  }

  async load() {
    const lines = this.store.state.results.filter(Boolean).flatMap(comparisonOf);
    await Promise.all(
      lines.map(async (line) => {
        line.value = await this.client.ask("values", line.file, line.path);
      }),
    );
    this.lines = lines;
    this.draw();
  }

  caseOf(line) {
    return this.store.state.cases.find((one) => one.file === line.file && one.name === line.case);
  }

  shown() {
    const wanted = this.filter.value.trim().toLowerCase();
    return this.lines.filter((line) => this.cells(line).join(" ").toLowerCase().includes(wanted));
  }

  cells(line) {
    const quantity = [words(line.quantity), line.axis, line.statistic].filter(Boolean).join(", ");
    return [
      quantity,
      line.sections.join(", "),
      this.caseOf(line)?.label ?? line.case,
      `${short(line.value)} ${unitText(line.unit)}`.trim(),
      `${unitText(line.reference)}${line.basis && line.reference ? ` (${words(line.basis)})` : words(line.basis)}`,
    ];
  }

  draw() {
    const focused = document.activeElement?.dataset?.line;
    this.body.replaceChildren(...this.shown().map((line) => this.row(line)));
    if (focused) this.body.querySelector(`[data-line="${focused}"]`)?.focus();
  }

  row(line) {
    const { highlight, cases, theme } = this.store.state;
    const key = `${line.file}-${line.number}`;
    const colour = lookOf(Math.max(0, cases.indexOf(this.caseOf(line))), theme).colour;
    const cells = this.cells(line).map((text, i) =>
      html(
        "td",
        { class: i === 3 ? "number" : "", title: i === 3 ? String(line.value) : undefined },
        i === 2 ? html("span", { class: "swatch", style: `--colour: ${colour}` }) : undefined,
        text,
      ),
    );
    return html("tr", { tabindex: 0, "data-line": key, "aria-selected": String(highlight?.line === key) }, ...cells);
  }

  /** Highlights what a row is about; the same row again ends it. */
  choose(row) {
    if (!row) return;
    const key = row.dataset.line;
    const line = this.lines.find((one) => `${one.file}-${one.number}` === key);
    if (this.store.state.highlight?.line === key) {
      this.store.set({ highlight: undefined });
      return;
    }
    const one = this.caseOf(line);
    const visible = new Set(this.store.state.visible);
    if (one) visible.add(one.id);
    this.store.set({ visible, highlight: { cases: new Set(one ? [one.id] : []), sections: new Set(line.sections), line: key } });
  }

  key(event) {
    const row = event.target.closest("tr");
    const move = { ArrowDown: "nextElementSibling", ArrowUp: "previousElementSibling" }[event.key];
    if (move) row[move]?.focus();
    else if (event.key === "Enter" || event.key === " ") this.choose(row);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  /** For export as a table; there is no drawing of it. */
  figures() {
    const rows = this.shown().map((line) => [
      line.quantity,
      line.axis,
      line.statistic,
      line.sections.join(" "),
      line.case,
      line.value,
      line.unit,
      line.reference,
      line.basis,
    ]);
    return [
      {
        title: "comparison",
        table: { head: ["quantity", "axis", "statistic", "sections", "case", "value", "unit", "reference", "basis"], rows },
        drawing: tableDrawing(this.shown().map((line) => this.cells(line))),
      },
    ];
  }
}

const COLUMNS = [0, 280, 470, 610, 720]; // pixels

function tableDrawing(rows) {
  const ns = "http://www.w3.org/2000/svg";
  const drawing = document.createElementNS(ns, "svg");
  const height = 18 * (rows.length + 1) + 12;
  const ink = getComputedStyle(document.documentElement).getPropertyValue("--ink");
  for (const [name, value] of Object.entries({
    xmlns: ns,
    width: 900,
    height,
    viewBox: `0 0 900 ${height}`,
    "font-family": "system-ui, sans-serif",
    "font-size": 11,
    fill: ink,
  }))
    drawing.setAttribute(name, value);
  [HEAD, ...rows].forEach((cells, i) =>
    cells.forEach((cell, j) => {
      const element = document.createElementNS(ns, "text");
      element.setAttribute("x", String(8 + COLUMNS[j]));
      element.setAttribute("y", String(18 * (i + 1)));
      if (i === 0) element.setAttribute("font-weight", "600");
      element.textContent = cell;
      drawing.append(element);
    }),
  );
  return drawing;
}
