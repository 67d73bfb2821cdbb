/** Lines of a path in space: the programmed one, and the actual one with its deviation magnified on the graphics card. */
import * as three from "three";
import { shadeOf } from "../core/palette.js";

const VERTEX = `
  attribute vec3 deviation;
  attribute vec3 shade;
  uniform float magnification;
  uniform vec2 offset;
  uniform float size;
  varying vec3 vShade;
  void main() {
    vShade = shade;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position + magnification * deviation, 1.0);
    gl_Position.xy += offset * gl_Position.w;
    gl_PointSize = size;
  }`;
const FRAGMENT = `
  uniform float opacity;
  varying vec3 vShade;
  void main() { gl_FragColor = vec4(vShade, opacity); }`;

/** Of lines and points that are displaced by their deviation; size of points in pixels. */
export const material = (opacity, size = 1) =>
  new three.ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    transparent: opacity < 1,
    uniforms: { magnification: { value: 0 }, opacity: { value: opacity }, offset: { value: new three.Vector2() }, size: { value: size } },
  });

/** Pixels by which a line is drawn again: lines of WebGL are one pixel wide. */
const STROKES = [
  [0, 0],
  [1, 0],
  [0, 1],
  [1, 1],
];

/** Share of the values that are beyond the ends of the scale, so that one peak does not make all others equal. */
const CUT = 0.002;

/** Range of a scale of colours. */
export function shadeRange(values, rapid) {
  const sorted = Float32Array.from(values.filter((value, i) => Number.isFinite(value) && !rapid[i])).sort();
  if (sorted.length === 0) return [0, 1];
  const high = sorted[Math.min(sorted.length - 1, Math.floor((1 - CUT) * sorted.length))];
  return [Math.min(0, sorted[0]), high > 0 ? high : 1];
}

function shades(path, [low, high], grey, theme) {
  const out = new Float32Array(3 * path.colour.length);
  path.colour.forEach((value, i) => out.set(path.rapid[i] ? grey : shadeOf((value - low) / (high - low), theme), 3 * i));
  return out;
}

export class PathLines {
  /** @param {object} path of the worker @param {number[]} grey colour of rapid moves and of the programmed path @param {"light" | "dark"} theme */
  constructor(path, grey, theme) {
    this.path = path;
    this.range = shadeRange(path.colour, path.rapid);
    const geometry = new three.BufferGeometry();
    geometry.setAttribute("position", new three.BufferAttribute(path.nominal, 3));
    geometry.setAttribute(
      "deviation",
      new three.BufferAttribute(
        path.deviation.map((um) => um / 1000),
        3,
      ),
    );
    geometry.setAttribute("shade", new three.BufferAttribute(shades(path, this.range, grey, theme), 3));
    geometry.computeBoundingSphere();
    const plain = geometry.clone();
    plain.setAttribute(
      "shade",
      new three.BufferAttribute(
        Float32Array.from({ length: path.nominal.length }, (_, i) => grey[i % 3]),
        3,
      ),
    );
    this.actual = STROKES.map(() => new three.Line(geometry, material(1)));
    this.nominal = new three.Line(plain, material(0.55));
    this.group = new three.Group().add(this.nominal, ...this.actual);
    for (const line of this.group.children) line.frustumCulled = false;
  }

  get sphere() {
    return this.nominal.geometry.boundingSphere;
  }

  /** Draws lines of two pixels, or of one while they move. */
  thicken(isThick) {
    this.actual.forEach((line, i) => {
      line.visible = isThick || i === 0;
    });
  }

  magnify(factor) {
    for (const line of this.actual) line.material.uniforms.magnification.value = factor;
  }

  /** Sets the size of the picture, in pixels of the page. */
  resize(width, height) {
    this.actual.forEach((line, i) =>
      line.material.uniforms.offset.value.set((2 * STROKES[i][0]) / width, (2 * STROKES[i][1]) / height),
    );
  }

  /** Draws only points of these rows. */
  showRows(first, last) {
    const { row } = this.path;
    let from = row.findIndex((one) => one >= first);
    if (from < 0) from = row.length;
    let to = from;
    while (to < row.length && row[to] <= last) ++to;
    for (const line of this.group.children) line.geometry.setDrawRange(from, to - from);
  }

  dispose() {
    for (const line of this.group.children) {
      line.geometry.dispose();
      line.material.dispose();
    }
  }
}
