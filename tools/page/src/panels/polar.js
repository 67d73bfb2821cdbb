/** The polar diagram of a ball bar: deviations from the nominal circle, magnified. */
import { linearTicks, short } from "../core/ticks.js";
import { svg } from "../shell/dom.js";
import { pathData } from "../plots/chart.js";

const SHARE = 0.78; // of the drawing that the nominal circle takes
const SPOKES = 12;
const FONT = { "font-family": "system-ui, sans-serif", "font-size": 11 };

/** Magnification with which the largest deviation is a quarter of the radius. */
export function fittingMagnification(circles) {
  let share = 0;
  for (const { deviation, nominalRadius } of circles) {
    for (const value of deviation) share = Math.max(share, Math.abs(value) / nominalRadius);
  }
  return share > 0 ? 0.25 / share : 1;
}

/**
 * @param {{circles: object[], magnification: number, size: number, colours: Record<string, string>}} drawing
 *   circles: of the worker, each with colour, dash and label
 * @returns {SVGSVGElement}
 */
export function polarDrawing({ circles, magnification, size, colours }) {
  const centre = size / 2;
  const radius = (SHARE * size) / 2;
  const nominal = circles[0]?.nominalRadius ?? 1;
  const plane = circles[0]?.plane ?? "XY";
  const place = (angle, share) => [centre + radius * share * Math.cos(angle), centre - radius * share * Math.sin(angle)];
  const largest = (1000 * nominal * 0.28) / magnification; // um that the rings reach
  const rings = linearTicks(-largest, largest, 6).map((um) => [um, 1 + (um * magnification) / 1000 / nominal]);
  const spokes = Array.from({ length: SPOKES }, (_, i) => {
    const [x, y] = place((2 * Math.PI * i) / SPOKES, 1.3);
    return svg("line", { x1: centre, y1: centre, x2: x, y2: y, stroke: colours.grid });
  });
  const label = (text, [x, y], anchor = "middle") =>
    svg("text", { x, y: y + 4, fill: colours.ink, "text-anchor": anchor, ...FONT }, text);
  return svg(
    "svg",
    {
      xmlns: "http://www.w3.org/2000/svg",
      width: size,
      height: size,
      viewBox: `0 0 ${size} ${size}`,
      role: "img",
      "aria-label": `Radial deviation, magnified ${short(magnification, 2)} times`,
    },
    svg("rect", { width: size, height: size, fill: colours.paper }),
    ...spokes,
    ...rings.map(([um, share]) =>
      svg("circle", {
        cx: centre,
        cy: centre,
        r: radius * share,
        fill: "none",
        stroke: um === 0 ? colours.faint : colours.grid,
        "stroke-width": um === 0 ? 1.5 : 1,
      }),
    ),
    ...circles.map((circle) => curveOf(circle, magnification, place)),
    ...rings.map(([um, share]) => label(`${short(um, 3)}${um === 0 ? " µm" : ""}`, place(Math.PI / 2 - 0.13, share))),
    label(`+${plane[0]}`, place(0, 1.2)),
    label(`+${plane[1]}`, place(Math.PI / 2, 1.2)),
  );
}

function curveOf({ angle, deviation, nominalRadius, colour, dash, label }, magnification, place) {
  const points = Array.from(angle, (a, i) => place(a, 1 + (magnification * deviation[i]) / nominalRadius));
  return svg(
    "path",
    {
      d: pathData(
        points.map(([x]) => x),
        points.map(([, y]) => y),
      ),
      fill: "none",
      stroke: colour,
      "stroke-width": 1.4,
      "stroke-dasharray": dash.length ? dash.join(" ") : undefined,
      "stroke-linejoin": "round",
    },
    svg("title", {}, label),
  );
}
