/** Shortcuts, and the dialogs that list them and the licences. */
import { html } from "./dom.js";

const SHORTCUTS = [
  ["?", "this list"],
  ["O", "open files"],
  ["/", "filter the signals"],
  ["A", "show all cases or none"],
  ["1 … 9", "show or hide a case"],
  ["X", "next abscissa: time, s, positions of axes"],
  ["B", "next baseline: differences at equal s"],
  ["T", "light or dark"],
  ["S, P, C", "export what is seen as SVG, PNG, CSV"],
  ["[ and ]", "view before, next view"],
  ["{ and }", "side view before, next"],
  ["Z", "zoom to the highlighted sections"],
  ["Esc", "end the highlight"],
  ["← →", "move the cursor (with Shift: ten steps)"],
  ["Home, End", "cursor to the left, right end"],
  ["+ − 0", "zoom in, out, show all"],
  [", .", "move to the left, right"],
  ["Del", "remove the plot that has the focus"],
  ["Shift + a signal", "draw it in the last plot, too"],
];

const POINTER = [
  ["drag", "zoom to an interval"],
  ["double click", "show all"],
  ["over a probed point of the path", "its feature and deviation"],
  ["wheel", "zoom, in the plot that has the focus or with Shift or Ctrl"],
];

const rows = (list) => list.map(([key, text]) => html("tr", {}, html("td", {}, html("kbd", {}, key)), html("td", {}, text)));

const dialogOf = (...content) => {
  const dialog = html("dialog", {}, ...content, html("form", { method: "dialog" }, html("button", {}, "Close")));
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
  return dialog;
};

export function showLicences() {
  dialogOf(html("h3", {}, "Licences"), html("pre", {}, document.getElementById("licences").textContent));
}

export function showHelp() {
  dialogOf(
    html("h3", {}, "Keys"),
    html("table", {}, ...rows(SHORTCUTS)),
    html("h3", {}, "Pointer"),
    html("table", {}, ...rows(POINTER)),
    html("p", {}, html("button", { type: "button", onclick: showLicences }, "Licences")),
  );
}

/**
 * Keys of the whole page.
 * @param {Record<string, (key: string) => void>} actions by key; "digit" for 1 to 9
 */
export function listenToKeys(actions) {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
    if (event.target.closest("input[type=search], input[type=text], select")) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const action = /^[1-9]$/.test(key) ? actions.digit : actions[key];
    if (!action) return;
    event.preventDefault();
    action(key);
  });
}
