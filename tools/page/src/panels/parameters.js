/** Parameters of an identification: value, expanded uncertainty, and those that the recordings do not determine. */
import { short } from "../core/ticks.js";
import { unitText } from "../core/units.js";
import { tableDrawing } from "../plots/table.js";
import { html } from "../shell/dom.js";
import { inks } from "../shell/theme.js";

const HEAD = ["key", "value", "U (k = 2)", "if all samples were independent", "identifiable"];
const VALUES = ["value", "half_width", "half_width_counted"];
const valueText = (value) => (value === undefined ? "" : short(value, 5));
const numbered = (name, i) => `${name}_${String(i).padStart(2, "0")}`;

export class ParametersView {
  constructor({ store, client }) {
    Object.assign(this, { store, client, name: "Parameters", rows: [] });
    this.element = html("div");
    store.on(["results"], () => this.load());
  }

  get results() {
    return this.store.state.results.filter((result) => result?.has("/parameters/value"));
  }

  available() {
    return this.results.length > 0;
  }

  async load() {
    const tables = await Promise.all(this.results.map((result) => this.rowsOf(result)));
    this.rows = tables.flat();
    this.element.replaceChildren(
      html(
        "table",
        {},
        html("thead", {}, html("tr", {}, ...HEAD.map((name, i) => html("th", { class: i > 0 && i < 4 ? "number" : "" }, name)))),
        html(
          "tbody",
          {},
          ...this.rows.map(({ key, unit, values, identifiable }) =>
            html(
              "tr",
              {},
              html("td", {}, key),
              ...values.map((value) =>
                html("td", { class: "number", title: String(value) }, `${valueText(value)} ${unitText(unit)}`),
              ),
              html("td", {}, identifiable),
            ),
          ),
        ),
      ),
    );
  }

  async rowsOf(result) {
    const { attributes } = result.groups.get("/parameters");
    const columns = await Promise.all(
      VALUES.map((name) => `/parameters/${name}`).map((path) =>
        result.has(path) ? this.client.ask("values", result.index, path) : [],
      ),
    );
    return Array.from(columns[0], (_, i) => ({
      key: attributes[numbered("key", i)],
      unit: attributes[numbered("unit", i)] ?? "",
      identifiable: attributes[numbered("identifiable", i)] ?? "",
      values: columns.map((column) => column[i]),
    }));
  }

  figures() {
    if (this.rows.length === 0) return [];
    const head = ["key", "unit", ...VALUES, "identifiable"];
    const rows = (text) => this.rows.map((row) => [row.key, row.unit, ...row.values.map(text), row.identifiable]);
    return [
      {
        title: "parameters",
        drawing: tableDrawing(head, rows(valueText), inks()),
        table: { head, rows: rows((value) => value ?? "") },
      },
    ];
  }
}
