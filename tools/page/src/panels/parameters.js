/** Parameters of an identification: value, expanded uncertainty, and those that the recordings do not determine. */
import { short } from "../core/ticks.js";
import { unitText } from "../core/units.js";
import { html } from "../shell/dom.js";

const HEAD = ["key", "value", "U (k = 2)", "if all samples were independent", "identifiable"];
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
                html("td", { class: "number", title: String(value) }, `${short(value, 5)} ${unitText(unit)}`),
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
      ["value", "half_width", "half_width_counted"]
        .filter((name) => result.has(`/parameters/${name}`))
        .map((name) => this.client.ask("values", result.index, `/parameters/${name}`)),
    );
    return Array.from(columns[0], (_, i) => ({
      key: attributes[numbered("key", i)],
      unit: attributes[numbered("unit", i)] ?? "",
      identifiable: attributes[numbered("identifiable", i)] ?? "",
      values: columns.map((column) => column[i]),
    }));
  }

  figures() {
    return [
      {
        title: "parameters",
        drawing: undefined,
        lines: [],
        x: { label: "", min: 0, max: 1 },
        y: { label: "", min: 0, max: 1 },
        width: 900,
        height: 120,
        table: {
          head: ["key", "unit", "value", "half_width", "half_width_counted", "identifiable"],
          rows: this.rows.map((row) => [row.key, row.unit, ...row.values, row.identifiable]),
        },
      },
    ];
  }
}
