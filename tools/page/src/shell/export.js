/** What is seen as SVG, PNG and CSV. */
import { csvText } from "../core/csv.js";
import { chart } from "../plots/chart.js";
import { svg } from "./dom.js";
import { inks } from "./theme.js";

const RESOLUTION = 2; // pixels of a PNG for one of the page

/**
 * @typedef {object} Figure a chart (lines, x, y ...) or a drawing of its own
 * @property {string} title
 * @property {SVGSVGElement} [drawing]
 * @property {{head: string[], rows: unknown[][]}} [table]
 */

function drawingOf(figure) {
  return figure.drawing ? figure.drawing.cloneNode(true) : chart({ ...figure, colours: inks() });
}

/** All figures below each other in one SVG. */
export function combined(figures) {
  const drawings = figures.map(drawingOf);
  const sizes = drawings.map((drawing) => [Number(drawing.getAttribute("width")), Number(drawing.getAttribute("height"))]);
  const width = Math.max(...sizes.map(([w]) => w));
  const height = sizes.reduce((sum, [, h]) => sum + h, 0);
  const all = svg(
    "svg",
    { xmlns: "http://www.w3.org/2000/svg", width, height, viewBox: `0 0 ${width} ${height}` },
    svg("rect", { width, height, fill: inks().paper }),
  );
  let y = 0;
  drawings.forEach((drawing, i) => {
    drawing.setAttribute("y", y);
    all.append(drawing);
    y += sizes[i][1];
  });
  return all;
}

/** Rows of a figure: its table, else the points of its lines. */
function tableOf(figure) {
  if (figure.table) return figure.table;
  const rows = [];
  for (const line of figure.lines) {
    for (let i = 0; i < line.x.length; ++i) rows.push([figure.title, line.label, line.x[i], line.y[i]]);
  }
  return { head: ["plot", "curve", figure.x.label, "value"], rows };
}

function csvOf(figures) {
  const tables = figures.map(tableOf);
  // Tables with the same columns follow each other without a new head.
  return tables
    .map(({ head, rows }, i) => {
      const text = csvText(head, rows);
      return i > 0 && String(tables[i - 1].head) === String(head) ? text.slice(text.indexOf("\n") + 1) : text;
    })
    .join("");
}

function save(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

const svgText = (figures) =>
  `<?xml version="1.0" encoding="UTF-8"?>\n${new XMLSerializer().serializeToString(combined(figures))}\n`;

/** Draws an SVG into a picture. @returns {Promise<Blob>} */
async function pngOf(figures) {
  const drawing = combined(figures);
  const picture = new Image();
  picture.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(new XMLSerializer().serializeToString(drawing))}`;
  await picture.decode();
  const canvas = document.createElement("canvas");
  canvas.width = RESOLUTION * Number(drawing.getAttribute("width"));
  canvas.height = RESOLUTION * Number(drawing.getAttribute("height"));
  canvas.getContext("2d").drawImage(picture, 0, 0, canvas.width, canvas.height);
  return new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
}

/**
 * Saves figures under a name with the ending of the format.
 * @param {Figure[]} figures @param {"svg" | "png" | "csv"} format @param {string} name
 */
export async function exportFigures(figures, format, name) {
  if (figures.length === 0) throw new Error("nothing to export is seen");
  const blob =
    format === "png"
      ? await pngOf(figures)
      : new Blob([format === "svg" ? svgText(figures) : csvOf(figures)], {
          type: format === "svg" ? "image/svg+xml" : "text/csv",
        });
  save(blob, `${name}.${format}`);
  return blob;
}
