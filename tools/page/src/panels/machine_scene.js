/** The bodies of the machine in space, moved to the positions of its axes. */
import * as three from "three";
import { bodiesOf } from "../core/chain.js";
import { lookOf } from "../core/palette.js";
import { html } from "../shell/dom.js";
import { inks } from "../shell/theme.js";
import { Orbit } from "./orbit.js";

const HEIGHT = 380; // pixels
const SHARP = 30; // degrees between faces whose edge is drawn
const THICK = 0.12; // of the size of the machine

/** Colour of the body that an axis moves. */
export const colourOf = (index, theme) => lookOf(index + 1, theme).colour;

export class MachineScene {
  constructor() {
    this.canvas = html("canvas", {
      class: "scene",
      tabindex: 0,
      role: "img",
      "aria-label": "Bodies of the machine, each in the colour of the axis that moves it; arrows turn the view, + and − zoom",
    });
    this.bodies = new Map();
  }

  begin() {
    if (this.renderer) return;
    this.renderer = new three.WebGLRenderer({ canvas: this.canvas, antialias: true });
    this.camera = new three.PerspectiveCamera(35, 1, 1, 1e5);
    this.scene = new three.Scene();
    this.orbit = new Orbit(this.camera, this.canvas, () => this.draw());
    this.light = new three.DirectionalLight(0xffffff, 2);
    this.light.position.set(1, -2, 3);
    this.scene.add(this.light, new three.AmbientLight(0xffffff, 1.2));
  }

  /** Boxes and discs; built anew where the chain or the theme is another. @param {number} size mm, of the travel of linear axes */
  build(joints, size, theme) {
    const key = JSON.stringify([joints, size, theme]);
    if (key === this.key) return;
    const isAnother = this.machine !== JSON.stringify([joints, size]);
    Object.assign(this, { key, size, machine: JSON.stringify([joints, size]), isUnframed: isAnother || this.isUnframed });
    for (const body of this.bodies.values()) this.scene.remove(body);
    this.bodies.clear();
    this.scene.background = new three.Color(inks().paper);
    joints.forEach((joint, k) => {
      const body = bodyOf(joint, k, joints, size, theme);
      body.matrixAutoUpdate = false;
      this.bodies.set(joint.letter, body);
      this.scene.add(body);
    });
  }

  /** @param {Record<string, number>} positions by letter */
  move(joints, positions) {
    for (const { joint, pose } of bodiesOf(joints, positions)) this.bodies.get(joint.letter).matrix.set(...pose);
    if (this.isUnframed) this.frame();
    this.draw();
  }

  /** Looks at all bodies. */
  frame() {
    this.isUnframed = false;
    this.scene.updateMatrixWorld(true);
    const box = new three.Box3();
    for (const body of this.bodies.values()) box.expandByObject(body);
    const sphere = box.getBoundingSphere(new three.Sphere());
    this.orbit.frame(sphere.center.toArray(), sphere.radius);
  }

  resize(width) {
    if (!this.renderer || width < 50) return;
    this.renderer.setPixelRatio(devicePixelRatio);
    this.renderer.setSize(width, HEIGHT, false);
    this.camera.aspect = width / HEIGHT;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  draw() {
    if (this.drawing || !this.renderer) return;
    this.drawing = true;
    requestAnimationFrame(() => {
      this.drawing = false;
      this.renderer.render(this.scene, this.camera);
    });
  }

  /** Place of a body's own origin, seen from the bed; mm. */
  placeOf(letter) {
    return new three.Vector3().setFromMatrixPosition(this.bodies.get(letter).matrix).toArray();
  }
}

/**
 * A disc about the axis that turns it, or a box along the direction in which it slides. Bodies of the tool side stand above the
 * spindle nose, that of the axis next to the tool lowest; those of the workpiece side below the table, that next to the
 * workpiece highest.
 */
function bodyOf(joint, index, joints, size, theme) {
  const colour = new three.MeshLambertMaterial({ color: colourOf(index, theme) });
  const thick = THICK * size;
  const steps = joint.carriesWorkpiece
    ? -(1 + joints.slice(0, index).filter((one) => one.carriesWorkpiece).length)
    : 1 + joints.length - 1 - index;
  const group = new three.Group();
  const direction = new three.Vector3(...joint.direction);
  const shape = joint.rotary
    ? new three.CylinderGeometry(0.22 * size, 0.22 * size, 0.7 * thick, 40)
    : new three.BoxGeometry(0.7 * size, 0.9 * thick, 0.9 * thick);
  const mesh = new three.Mesh(shape, colour);
  mesh.quaternion.setFromUnitVectors(joint.rotary ? new three.Vector3(0, 1, 0) : new three.Vector3(1, 0, 0), direction);
  mesh.position.set(0, 0, 1.1 * thick * (steps - Math.sign(steps) * 0.5));
  if (joint.rotary) mesh.position.add(new three.Vector3(...joint.point));
  else mesh.position.z += Math.sign(steps) * 0.35 * size * Math.abs(direction.z); // it ends at the spindle nose, or at the table
  mesh.add(new three.LineSegments(new three.EdgesGeometry(shape, SHARP), new three.LineBasicMaterial({ color: inks().ink })));
  group.add(mesh);
  if (index === joints.length - 1 && !joint.carriesWorkpiece) {
    const tool = new three.Mesh(new three.CylinderGeometry(0.03 * size, 0.015 * size, 0.25 * size, 20), colour);
    tool.rotation.x = Math.PI / 2;
    tool.position.set(0, 0, -0.125 * size);
    group.add(tool);
  }
  return group;
}
