/** Probed points of a part in space: where they should be, and displaced along their normals by their deviation. */
import * as three from "three";
import { shadeOf } from "../core/palette.js";
import { material } from "./path_lines.js";

const POINT = 6; // pixels

/**
 * @typedef {object} Feature
 * @property {string} name
 * @property {Float64Array} nominal mm, three for each point, in the frame of the workpiece
 * @property {Float64Array} normal
 * @property {Float64Array} deviation um; NaN: nothing was met
 */

/** A place or, with an origin of zero, a direction of the work frame in the frame of the workpiece. */
function inWorkpiece(values, axes, origin) {
  return values.map((_, n) => {
    const [first, i] = [n - (n % 3), n % 3];
    return origin[i] + [0, 1, 2].reduce((sum, j) => sum + axes[3 * i + j] * values[first + j], 0);
  });
}

/**
 * Features of a case; [] where the file has none, or does not say where the work frame is.
 * @param {import("../data/client.js").Client} client @param {import("../data/model.js").Result} result
 * @param {{file: number, path: string}} one @returns {Promise<Feature[]>}
 */
export async function featuresOf(client, result, one) {
  const path = `${one.path}/probes`;
  const { work_axes: axes, work_origin_mm: origin } = result.groups.get(path)?.attributes ?? {};
  if (!axes) return [];
  const read = (group, name) => client.ask("values", one.file, `${group.path}/${name}`);
  return Promise.all(
    result.below(path).map(async (group) => {
      const [nominal, normal, deviation] = await Promise.all(["nominal", "normal", "deviation"].map((name) => read(group, name)));
      return {
        name: group.path.slice(path.length + 1),
        nominal: inWorkpiece(nominal, axes, origin),
        normal: inWorkpiece(normal, axes, [0, 0, 0]),
        deviation,
      };
    }),
  );
}

export class ProbePoints {
  /** @param {Feature[]} features @param {number[]} grey @param {"light" | "dark"} theme */
  constructor(features, grey, theme) {
    this.points = features.flatMap(({ name, nominal, normal, deviation }) =>
      Array.from(deviation, (um, k) => ({
        feature: name,
        number: k,
        um,
        place: [...nominal.slice(3 * k, 3 * k + 3)],
        offset: [...normal.slice(3 * k, 3 * k + 3)].map((n) => (n * um) / 1000),
      })),
    ).filter(({ um }) => Number.isFinite(um));
    this.largest = Math.max(0, ...this.points.map(({ um }) => Math.abs(um))) || 1;
    const shade = ({ um }) => shadeOf(0.5 + (0.5 * um) / this.largest, theme);
    this.marks = new three.Points(
      geometryOf(this.points.map((point) => [point.place, point.offset, shade(point)])),
      material(1, POINT),
    );
    this.stalks = new three.LineSegments(
      geometryOf(this.points.flatMap((point) => [[point.place, [0, 0, 0], grey], [point.place, point.offset, shade(point)]])),
      material(1),
    );
    const outlines = features.flatMap(({ nominal }) => {
      const places = Array.from({ length: nominal.length / 3 }, (_, k) => [...nominal.slice(3 * k, 3 * k + 3)]);
      return places.slice(1).flatMap((place, k) => [[places[k], [0, 0, 0], grey], [place, [0, 0, 0], grey]]);
    });
    this.outline = new three.LineSegments(geometryOf(outlines), material(0.8));
    this.group = new three.Group().add(this.outline, this.stalks, this.marks);
    for (const child of this.group.children) child.frustumCulled = false;
  }

  magnify(factor) {
    this.magnification = factor;
    for (const { material: one } of this.group.children) one.uniforms.magnification.value = factor;
  }

  /** Where a point is drawn. */
  placeOf({ place, offset }) {
    return new three.Vector3(...place.map((p, i) => p + this.magnification * offset[i]));
  }

  /** The point nearest to a place on the screen, and its distance in pixels. */
  nearest(camera, [width, height], [x, y]) {
    let found;
    for (const point of this.points) {
      const seen = this.placeOf(point).project(camera);
      if (seen.z > 1) continue;
      const distance = Math.hypot(((seen.x + 1) / 2) * width - x, ((1 - seen.y) / 2) * height - y);
      if (!found || distance < found.distance) found = { point, distance };
    }
    return found;
  }

  dispose() {
    for (const child of this.group.children) {
      child.geometry.dispose();
      child.material.dispose();
    }
  }
}

/** @param {[number[], number[], number[]][]} vertices place, deviation and colour of each */
function geometryOf(vertices) {
  const geometry = new three.BufferGeometry();
  ["position", "deviation", "shade"].forEach((name, k) =>
    geometry.setAttribute(name, new three.BufferAttribute(Float32Array.from(vertices.flatMap((vertex) => vertex[k])), 3)),
  );
  return geometry;
}
