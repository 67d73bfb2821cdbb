/** A table as a drawing, for the export of views that show text. */
import { svg } from "../shell/dom.js";

const ROW = 20; // pixels
const LETTER = 7.2; // pixels, about the mean width of a letter at this size
const GAP = 24;

/**
 * @param {string[]} head @param {unknown[][]} rows
 * @returns {SVGSVGElement}
 */
export function tableDrawing(head, rows, colours) {
  const texts = [head, ...rows].map((row) => row.map(String));
  const widths = head.map((_, i) => GAP + LETTER * Math.max(...texts.map((row) => row[i].length)));
  const lefts = widths.map((_, i) => GAP / 2 + widths.slice(0, i).reduce((sum, width) => sum + width, 0));
  const width = Math.ceil(GAP / 2 + widths.reduce((sum, one) => sum + one, 0));
  const height = ROW * (texts.length + 1);
  const cells = texts.flatMap((row, n) =>
    row.map((text, i) =>
      svg("text", { x: lefts[i], y: ROW * (n + 1), fill: n === 0 ? colours.faint : colours.ink, "font-size": 12, "font-family": "sans-serif" }, text),
    ),
  );
  return svg("svg", { width, height, viewBox: `0 0 ${width} ${height}` }, ...cells);
}
