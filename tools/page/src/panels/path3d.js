/** Path of the tool centre point in space, coloured by its error, which a slider magnifies. */
import * as three from "three";
import { shadeGradient } from "../core/palette.js";
import { short } from "../core/ticks.js";
import { unitText } from "../core/units.js";
import { latestOnly } from "../data/client.js";
import { cursorScale, valuesAtCursor } from "../data/cursor.js";
import { checkbox, html, select, slider, svg } from "../shell/dom.js";
import { inks } from "../shell/theme.js";
import { Orbit } from "./orbit.js";
import { PathLines } from "./path_lines.js";
import { featuresOf, ProbePoints } from "./probe_points.js";

const POINTS = 30_000;
const HEIGHT = 380; // pixels
const COLOURS = [
  ["contour_error", "contour error"],
  ["tool_deviation", "tool deviation"],
];

const NEAR = 12; // pixels between the pointer and a point that it means
const REST = 150; // ms without movement

/** True where there is no graphics card: smooth edges would take most of the time. */
function drawsInSoftware() {
  const gl = document.createElement("canvas").getContext("webgl2");
  const info = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}

export class PathView {
  constructor({ store, client }) {
    Object.assign(this, { store, client, name: "Path", chosen: "", colour: "contour_error", exponent: 2, stale: true, showsProbes: true });
    this.canvas = html("canvas", {
      class: "scene",
      tabindex: 0,
      role: "img",
      "aria-label": "Path of the tool in space; arrows turn it, + and − zoom",
    });
    this.controls = html("div", { class: "controls" });
    this.scale = html("div", { class: "scale" }, html("span"), html("i"), html("span"));
    this.note = html("div", { class: "hint" });
    this.probeScale = html("div", { class: "scale", hidden: true }, html("span"), html("i"), html("span"));
    this.probeNote = html("div", { class: "hint", "aria-live": "polite" });
    this.element = html("div", {}, this.controls, this.canvas, this.scale, this.note, this.probeScale, this.probeNote);
    this.canvas.addEventListener("pointermove", (event) => this.point(event));
    this.load = latestOnly(() => this.loadPath());
    this.follow = latestOnly(() => this.showCursor());
    this.limit = latestOnly(() => this.showRange());
    store.on(["cases", "visible", "highlight", "theme"], () => this.changed());
    store.on(["cursor"], () => this.seen && this.follow());
    store.on(["ranges"], () => this.seen && this.limit());
  }

  get candidates() {
    const { cases, results } = this.store.state;
    return cases.filter(
      (one) =>
        one.servo && ["tool_position_nominal", "tool_deviation"].every((name) => results[one.file].has(`${one.servo}/${name}`)),
    );
  }

  /** Case that is drawn: the highlighted one, else the chosen, else the second visible one: the first often has no errors. */
  get case() {
    const { highlight, visible } = this.store.state;
    const all = this.candidates;
    return (
      all.find((one) => highlight?.cases.has(one.id)) ??
      all.find((one) => one.id === this.chosen) ??
      all
        .filter((one) => visible.has(one.id))
        .slice(0, 2)
        .at(-1) ??
      all[0]
    );
  }

  available() {
    return this.candidates.length > 0;
  }

  show() {
    this.seen = true;
    if (!this.renderer) this.begin();
    this.resize();
    if (this.stale) this.load();
  }

  hide() {
    this.seen = false;
  }

  changed() {
    this.stale = true;
    if (this.seen) this.load();
  }

  begin() {
    this.renderer = new three.WebGLRenderer({ canvas: this.canvas, antialias: !drawsInSoftware() });
    this.camera = new three.PerspectiveCamera(35, 1, 1, 1e5);
    this.scene = new three.Scene();
    this.orbit = new Orbit(this.camera, this.canvas, () => this.redraw());
    this.marker = new three.Mesh(new three.SphereGeometry(1, 12, 8), new three.MeshBasicMaterial());
    this.tool = new three.Line(
      new three.BufferGeometry().setFromPoints([new three.Vector3(), new three.Vector3(0, 0, 1)]),
      new three.LineBasicMaterial(),
    );
    this.tool.frustumCulled = false;
    this.marker.visible = this.tool.visible = false;
    this.scene.add(this.marker, this.tool, new three.AxesHelper(1));
    new ResizeObserver(() => this.resize()).observe(this.element);
  }

  resize() {
    const width = this.element.clientWidth;
    if (!this.renderer || width < 50) return;
    this.renderer.setPixelRatio(devicePixelRatio);
    this.renderer.setSize(width, HEIGHT, false);
    this.camera.aspect = width / HEIGHT;
    this.camera.updateProjectionMatrix();
    this.lines?.resize(width, HEIGHT);
    this.redraw();
  }

  showControls() {
    this.controls.replaceChildren(
      select(
        "case",
        this.candidates.map((one) => [one.id, one.label]),
        this.case.id,
        (id) => {
          this.chosen = id;
          this.changed();
        },
      ),
      select(
        "colour",
        COLOURS.filter(([name]) => this.hasSignal(name)),
        this.colour,
        (name) => {
          this.colour = name;
          this.changed();
        },
      ),
      slider("error ×", { min: 0, max: 5, step: 0.05, value: this.exponent, text: (e) => short(10 ** e, 2) }, (e) => {
        this.exponent = e;
        this.magnify();
      }),
      ...(this.features?.length > 0 ? [checkbox("probed points", this.showsProbes, (shown) => this.toggleProbes(shown))] : []),
    );
  }

  hasSignal(name) {
    return this.store.state.results[this.case.file].has(`${this.case.servo}/${name}`);
  }

  unitOf(name) {
    return this.store.state.results[this.case.file].dataset(`${this.case.servo}/${name}`).attributes.units;
  }

  async loadPath() {
    const one = this.case;
    if (!one || !this.renderer) return;
    this.stale = false;
    if (!this.hasSignal(this.colour)) this.colour = "tool_deviation";
    this.features = await featuresOf(this.client, this.store.state.results[one.file], one);
    this.showControls();
    const key = `${one.id}|${this.colour}`;
    if (key !== this.loaded) {
      const has = { axis: this.hasSignal("tool_axis_true"), rapid: this.hasSignal("rapid") };
      this.data = await this.client.ask("path", { file: one.file, servo: one.servo, colour: this.colour, points: POINTS, has });
      this.loaded = key;
    }
    this.rebuild();
    await Promise.all([this.limit(), this.follow()]);
  }

  rebuild() {
    const first = !this.lines;
    if (this.lines) {
      this.scene.remove(this.lines.group);
      this.lines.dispose();
    }
    const dark = this.store.state.theme === "dark";
    this.lines = new PathLines(this.data, dark ? [0.5, 0.53, 0.57] : [0.62, 0.65, 0.69], this.store.state.theme);
    this.lines.resize(this.element.clientWidth, HEIGHT);
    this.scene.add(this.lines.group);
    this.rebuildProbes(dark ? [0.5, 0.53, 0.57] : [0.62, 0.65, 0.69]);
    this.scene.background = new three.Color(inks().paper);
    const accent = new three.Color(dark ? "#ff8c42" : "#d55e00");
    this.marker.material.color = this.tool.material.color = accent;
    const { center, radius } = this.lines.sphere;
    if (first || this.framed !== this.case.file) this.orbit.frame(center.toArray(), radius || 1);
    this.framed = this.case.file;
    const [low, high] = this.lines.range;
    const unit = unitText(this.unitOf(this.colour));
    this.scale.children[1].style.background = shadeGradient(this.store.state.theme);
    this.scale.firstChild.textContent = `${short(low, 3)} ${unit}`;
    this.scale.lastChild.textContent = `${short(high, 3)} ${unit}`;
    this.note.textContent = `${this.case.label}: ${COLOURS.find(([name]) => name === this.colour)[1]}; grey: programmed path and rapid moves`;
    this.magnify();
  }

  rebuildProbes(grey) {
    if (this.probes) {
      this.scene.remove(this.probes.group);
      this.probes.dispose();
    }
    this.probes = undefined;
    this.probeNote.textContent = "";
    this.probeScale.hidden = this.features.length === 0 || !this.showsProbes;
    if (this.features.length === 0) return;
    const { theme } = this.store.state;
    this.probes = new ProbePoints(this.features, grey, theme);
    this.probes.group.visible = this.showsProbes;
    this.scene.add(this.probes.group);
    const largest = short(this.probes.largest, 3);
    this.probeScale.children[1].style.background = shadeGradient(theme);
    this.probeScale.firstChild.textContent = `probed: −${largest} µm`;
    this.probeScale.lastChild.textContent = `+${largest} µm`;
  }

  toggleProbes(shown) {
    this.showsProbes = shown;
    this.probes.group.visible = shown;
    this.probeScale.hidden = !shown;
    this.probeNote.textContent = "";
    this.redraw();
  }

  /** Tells which probed point the pointer is at. */
  point({ offsetX, offsetY, buttons }) {
    if (!this.probes || !this.showsProbes || buttons !== 0) return;
    const found = this.probes.nearest(this.camera, [this.canvas.clientWidth, this.canvas.clientHeight], [offsetX, offsetY]);
    const { feature, number, um } = found?.distance <= NEAR ? found.point : {};
    this.probeNote.textContent = feature === undefined ? "" : `${feature}, point ${number}: ${short(um, 4)} µm along the normal`;
  }

  magnify() {
    this.lines?.magnify(10 ** this.exponent);
    this.probes?.magnify(10 ** this.exponent);
    this.placeMarker();
    this.redraw();
  }

  /** Draws the next frame with thin lines, and with thick ones as soon as nothing moves any more. */
  redraw() {
    clearTimeout(this.rest);
    this.rest = setTimeout(() => this.render(true), REST);
    if (this.drawing || !this.seen) return;
    this.drawing = true;
    requestAnimationFrame(() => {
      this.drawing = false;
      this.render(false);
      this.frames = (this.frames ?? 0) + 1;
    });
  }

  render(isThick) {
    if (!this.seen) return;
    this.lines?.thicken(isThick);
    this.renderer.render(this.scene, this.camera);
  }

  /** The picture, as an address that contains it. */
  picture() {
    this.render(true); // the canvas is empty once it has been shown
    return this.canvas.toDataURL("image/png");
  }

  /** The part of the path that the plots show. */
  async showRange() {
    const { ranges, abscissa } = this.store.state;
    const one = this.case;
    if (!one || !this.lines) return;
    const range = ["time", "s"].includes(abscissa) ? ranges[abscissa] : undefined;
    const spec = { file: one.file, path: `${one.servo}/${abscissa}`, column: 0 };
    const [first, last] = range ? await Promise.all(range.map((value) => this.client.ask("rowAt", spec, value))) : [0, Infinity];
    this.lines.showRows(first, last);
    this.redraw();
  }

  async showCursor() {
    const cursor = cursorScale(this.store.state);
    const one = this.case;
    this.at = undefined;
    if (cursor && one && this.lines) {
      const names = ["tool_position_nominal", "tool_deviation", ...(this.hasSignal("tool_axis_true") ? ["tool_axis_true"] : [])];
      const { values } = await valuesAtCursor(
        this.client,
        one,
        cursor,
        names.flatMap((name) => [0, 1, 2].map((i) => [name, i])),
      );
      if (values.every(Number.isFinite)) this.at = values;
    }
    this.placeMarker();
    this.redraw();
  }

  placeMarker() {
    if (!this.marker) return;
    this.marker.visible = this.tool.visible = Boolean(this.at);
    if (!this.at) return;
    const size = this.lines.sphere.radius;
    const place = [0, 1, 2].map((i) => this.at[i] + (10 ** this.exponent * this.at[3 + i]) / 1000);
    this.marker.position.set(...place);
    this.marker.scale.setScalar(0.018 * size);
    const axis = this.at.length > 6 ? this.at.slice(6) : [0, 0, 1];
    this.tool.geometry.setFromPoints([
      new three.Vector3(...place),
      new three.Vector3(...place.map((p, i) => p + 0.3 * size * axis[i])),
    ]);
  }

  /** What is seen: the picture, and the points for CSV. */
  figures() {
    if (!this.lines) return [];
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    const drawing = svg(
      "svg",
      { xmlns: "http://www.w3.org/2000/svg", width, height, viewBox: `0 0 ${width} ${height}` },
      svg("image", { width, height, href: this.picture() }),
    );
    const { nominal, deviation, colour, row } = this.data;
    const rows = Array.from(row, (r, i) => [
      r,
      ...nominal.slice(3 * i, 3 * i + 3),
      ...deviation.slice(3 * i, 3 * i + 3),
      colour[i],
    ]);
    const probed = {
      title: `probed points of ${this.case.label}`,
      drawing: drawing.cloneNode(true),
      table: {
        head: ["feature", "point", "X_mm", "Y_mm", "Z_mm", "deviation_um"],
        rows: (this.probes?.points ?? []).map(({ feature, number, place, um }) => [feature, number, ...place, um]),
      },
    };
    return [
      ...(this.probes && this.showsProbes ? [probed] : []),
      {
        title: `path of ${this.case.label}`,
        drawing,
        table: {
          head: ["row", "X_mm", "Y_mm", "Z_mm", "deviation_X_um", "deviation_Y_um", "deviation_Z_um", `${this.colour}_um`],
          rows,
        },
      },
    ];
  }
}
