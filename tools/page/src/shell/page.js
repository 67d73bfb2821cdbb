/** Frame of the page: what the parts share, and the files that are open. */
import { Client } from "../data/client.js";
import { Result, abscissaeOf, casesOf, familiesOf } from "../data/model.js";
import { PlotStack } from "../plots/stack.js";
import { button, html, select } from "./dom.js";
import { exportFigures } from "./export.js";
import { listenToKeys, showHelp } from "./help.js";
import { mainViews, sideViews } from "./views.js";
import { Sidebar } from "./sidebar.js";
import { Store } from "./store.js";
import { Tabs } from "./tabs.js";
import { followTheme, toggleTheme } from "./theme.js";

/** Signals that are shown first, those that the file has. */
const FIRST = [
  ["contour_error", 0],
  ["tool_deviation", "norm"],
  ["following_error_linear", 0],
  ["following_error_linear", 1],
];
const FIRST_PLOTS = 3;
const ENDING = /\.(h5|hdf5|hdf|nc)$/i;

export class Page {
  constructor(root) {
    this.root = root;
    this.store = new Store();
    followTheme(this.store); // first, for the others to draw with its colours
    this.client = new Client((progress) => this.showProgress(progress));
    this.client.onFault = (text) => this.say(text);
    this.stack = new PlotStack(this.store, this.client);
    this.sidebar = new Sidebar(this.store, {
      toggle: (chosen, together) => {
        this.main.open("Signals");
        this.stack.toggle(chosen, together);
      },
      close: (file) => this.close(file),
    });
    this.build();
    this.store.on(["families", "abscissa", "baseline", "cases"], () => this.showChoices());
    this.store.on(["results", "families"], () => this.showViews());
  }

  build() {
    this.heading = html("h1", {}, "servomill results");
    this.choices = html("span", { class: "tools" });
    this.progress = html("progress", { max: 1, hidden: true, "aria-label": "Progress" });
    this.statusText = html("span", { role: "status" });
    this.message = html("div", { class: "message", role: "alert", hidden: true });
    this.input = html("input", { type: "file", multiple: true, accept: ".h5,.hdf5,.nc", hidden: true, id: "files" });
    this.input.addEventListener("change", () =>
      this.openFiles([...this.input.files]).then(() => {
        this.input.value = "";
      }),
    );
    const formats = ["svg", "png", "csv"].map((format) =>
      button(format.toUpperCase(), `Export what is seen as ${format.toUpperCase()} (${format[0].toUpperCase()})`, () =>
        this.export(format),
      ),
    );
    const top = html(
      "header",
      { class: "top" },
      button("Open", "Open result files (O)", () => this.input.click()),
      this.input,
      this.heading,
      html("span", { class: "status" }, this.progress, this.statusText),
      this.choices,
      html("span", { class: "tools", role: "group", "aria-label": "Export" }, ...formats),
      button("◐", "Light or dark (T)", () => toggleTheme(this.store), { "aria-label": "Light or dark" }),
      button("?", "Keys (?)", showHelp, { "aria-label": "Keys" }),
    );
    this.mainArea = html("main", { class: "main" });
    this.sideArea = html("aside", { class: "side" });
    this.work = html("div", { class: "work" });
    this.main = new Tabs("Views", mainViews(this), this.mainArea, (view) => this.showSide(view));
    this.side = new Tabs("Side views", sideViews(this), this.sideArea);
    this.side.element.classList.add("right");
    this.work.append(this.main.element, this.side.element, this.mainArea, this.sideArea);
    this.root.append(top, this.message, this.sidebar.element, this.work);
    this.welcome();
    this.listen();
  }

  welcome() {
    this.drop = html(
      "div",
      { class: "drop" },
      html("h3", {}, "Drop result files of servomill here"),
      html(
        "p",
        { class: "hint" },
        "Files of servomill run, sweep, budget, bode, step, identify and recording. Nothing leaves this computer.",
      ),
      button("Choose files", "Open result files (O)", () => this.input.click()),
    );
    this.mainArea.replaceChildren(this.drop);
    this.work.classList.add("wide");
    this.side.element.hidden = true;
  }

  listen() {
    for (const type of ["dragenter", "dragover"])
      document.addEventListener(type, (event) => {
        event.preventDefault();
        this.root.classList.add("dropping");
      });
    document.addEventListener("dragleave", (event) => {
      if (!event.relatedTarget) this.root.classList.remove("dropping");
    });
    document.addEventListener("drop", (event) => {
      event.preventDefault();
      this.root.classList.remove("dropping");
      this.openFiles([...event.dataTransfer.files]);
    });
    const step = (tabs, by) => {
      const views = tabs.views.filter((view) => view.available());
      if (views.length) tabs.open(views[(views.indexOf(tabs.current) + by + views.length) % views.length]);
    };
    addEventListener("unhandledrejection", (event) => {
      event.preventDefault();
      console.error(event.reason);
      this.say(event.reason?.message ?? String(event.reason));
    });
    listenToKeys({
      "?": showHelp,
      o: () => this.input.click(),
      "/": () => this.sidebar.filter.focus(),
      a: () => this.sidebar.showAll(),
      digit: (key) => {
        const one = this.store.state.cases[Number(key) - 1];
        if (one) this.sidebar.toggleCase(one.id);
      },
      x: () => this.nextAbscissa(),
      b: () => this.nextBaseline(),
      t: () => toggleTheme(this.store),
      s: () => this.export("svg"),
      p: () => this.export("png"),
      c: () => this.export("csv"),
      "[": () => step(this.main, -1),
      "]": () => step(this.main, 1),
      "{": () => step(this.side, -1),
      "}": () => step(this.side, 1),
      z: () => this.stack.zoomToHighlight(),
      Escape: () => this.store.set({ highlight: undefined }),
    });
  }

  /** Opens what `tools/view` serves, if it does. */
  async start() {
    if (!location.protocol.startsWith("http")) return;
    const answer = await fetch("files.json").catch(() => undefined);
    if (!answer?.ok) return;
    const served = await answer.json();
    await this.openPlaces(
      served.map(({ name, url, size }) => ({ name, place: { url: new URL(url, location.href).href, size } })),
    );
  }

  openFiles(files) {
    return this.openPlaces(files.map((file) => ({ name: file.name, place: { blob: file } })));
  }

  /** Changes of the list of files, one after another: each begins with the list that the one before has left. */
  queued(change) {
    const done = (this.changes ?? Promise.resolve()).then(change);
    this.changes = done.catch(() => {});
    return done;
  }

  openPlaces(places) {
    return this.queued(() => this.openNow(places));
  }

  async openNow(places) {
    this.say("");
    const results = [...this.store.state.results];
    const faults = [];
    for (const { name, place } of places) {
      const index = results.length;
      results.push(undefined);
      try {
        this.statusText.textContent = `opening ${name}`;
        const { tree, size } = await this.client.ask("open", index, name, place);
        results[index] = new Result(index, name.replace(ENDING, ""), tree, size);
      } catch (fault) {
        faults.push(`${name}: ${fault.message}`);
      }
    }
    this.statusText.textContent = "";
    this.say(faults.join("\n"));
    this.opened = true;
    this.adopt(results);
  }

  close(index) {
    return this.queued(() => this.closeNow(index));
  }

  async closeNow(index) {
    const results = [...this.store.state.results];
    results[index] = undefined;
    this.adopt(results);
    await this.client.ask("close", index);
  }

  /** Takes over a new list of files. */
  adopt(results) {
    const open = results.filter(Boolean);
    const cases = casesOf(open);
    const families = familiesOf(open, cases);
    const known = new Set(this.store.state.cases.map((one) => one.id));
    const visible = new Set(
      cases.filter((one) => !known.has(one.id) || this.store.state.visible.has(one.id)).map((one) => one.id),
    );
    const has = ({ family, signal }) =>
      families.some((one) => one.key === family && one.signals.some((other) => other.name === signal));
    const kept = this.store.state.plots.filter(has);
    const { baseline } = this.store.state;
    this.store.set({
      results,
      cases,
      families,
      visible,
      highlight: undefined,
      baseline: cases.some((one) => one.id === baseline) ? baseline : "",
      plots: kept.length > 0 ? kept : this.firstPlots(families),
    });
    this.heading.textContent = open.map((result) => result.title).join(" · ") || "servomill results";
    document.title = this.heading.textContent;
  }

  firstPlots(families) {
    const [family] = families;
    if (!family) return [];
    if (!family.servo)
      return family.signals
        .slice(0, FIRST_PLOTS)
        .map((signal) => ({ family: family.key, signal: signal.name, column: signal.columns[0] }));
    return FIRST.filter(([name, column]) => family.signals.find((signal) => signal.name === name)?.columns.includes(column))
      .slice(0, FIRST_PLOTS)
      .map(([signal, column]) => ({ family: family.key, signal, column }));
  }

  showViews() {
    const any = this.store.state.results.some(Boolean);
    if (!any) {
      this.main.current = undefined;
      this.welcome();
      this.main.element.replaceChildren();
      return;
    }
    this.main.update();
    const special = { sweep: "Sweep", budget: "Budget", bode: "Bode" }[
      this.store.state.results.filter(Boolean).at(-1).attributes.kind
    ];
    if (special && this.opened) this.main.open(special);
    this.opened = false;
    this.side.update();
    this.showSide(this.main.current);
  }

  /** The side views belong to the signals of a run. */
  showSide(view) {
    const wanted = view?.name === "Signals" && this.side.views.some((one) => one.available());
    this.work.classList.toggle("wide", !wanted);
    this.side.element.hidden = !wanted;
  }

  showChoices() {
    const { families, results, cases, abscissa, baseline } = this.store.state;
    const choices = abscissaeOf(families[0], results).map((one) => [one.key, one.label]);
    this.choices.replaceChildren(
      ...(choices.length
        ? [
            select("over", choices, abscissa, (key) => this.setAbscissa(key)),
            select(
              "difference to",
              [["", "–"], ...cases.filter((one) => one.servo).map((one) => [one.id, one.label])],
              baseline,
              (id) => this.store.set({ baseline: id }),
            ),
          ]
        : []),
    );
  }

  setAbscissa(key) {
    this.store.set({ abscissa: key, cursor: undefined });
  }

  nextAbscissa() {
    const { families, results, abscissa } = this.store.state;
    const keys = abscissaeOf(families[0], results).map((one) => one.key);
    if (keys.length) this.setAbscissa(keys[(keys.indexOf(abscissa) + 1) % keys.length]);
  }

  nextBaseline() {
    const { cases, baseline } = this.store.state;
    const ids = ["", ...cases.filter((one) => one.servo).map((one) => one.id)];
    this.store.set({ baseline: ids[(ids.indexOf(baseline) + 1) % ids.length] });
  }

  showProgress({ done, total, what }) {
    const busy = total > 0 && done < total;
    this.progress.hidden = !busy;
    this.progress.value = busy ? done / total : 0;
    this.statusText.textContent = busy ? `reading ${what === "rows" ? `${(total / 1e6).toFixed(1)} million rows` : what}` : "";
  }

  /** @param {string} text a fault, or nothing */
  say(text) {
    this.message.textContent = text;
    this.message.hidden = text === "";
  }

  /** Saves what is seen: the main view, and the side view where there is one. */
  async export(format) {
    try {
      const name = (this.store.state.results.find(Boolean)?.name ?? "servomill").replace(/\W+/g, "_");
      const width = 900;
      const focusInSide = this.sideArea.contains(document.activeElement);
      const view = focusInSide ? this.side.current : this.main.current;
      this.lastExport = await exportFigures(
        view?.figures?.(width) ?? [],
        format,
        `${name}-${(view?.name ?? "").toLowerCase().replace(/\W+/g, "_")}`,
      );
    } catch (fault) {
      this.say(`export: ${fault.message}`);
    }
  }
}
