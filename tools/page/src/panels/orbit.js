/** A camera about a target: turned by dragging or arrows, moved with Shift, nearer with the wheel or + and −. */

const TURN = 0.008; // rad a pixel
const KEY_TURN = 0.1; // rad
const NEARER = 1.15;
const POLE = 0.01; // rad

export class Orbit {
  /** @param {import("three").PerspectiveCamera} camera @param {HTMLElement} element @param {() => void} onChange */
  constructor(camera, element, onChange) {
    Object.assign(this, { camera, onChange, azimuth: -0.9, polar: 1.0, distance: 1, target: [0, 0, 0] });
    element.addEventListener("pointerdown", (event) => element.setPointerCapture(event.pointerId));
    element.addEventListener("pointermove", (event) => this.drag(event));
    element.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.zoom(Math.exp(0.001 * event.deltaY));
      },
      { passive: false },
    );
    element.addEventListener("keydown", (event) => this.key(event));
  }

  drag(event) {
    if (event.buttons === 0) return;
    if (event.shiftKey || event.buttons === 2) this.shift(-event.movementX, event.movementY);
    else this.turn(-TURN * event.movementX, -TURN * event.movementY);
  }

  turn(azimuth, polar) {
    this.azimuth += azimuth;
    this.polar = Math.min(Math.PI - POLE, Math.max(POLE, this.polar + polar));
    this.apply();
  }

  /** Moves the target by pixels in the plane of the screen. */
  shift(right, up) {
    const scale = this.distance * 0.0016;
    const e = this.camera.matrixWorld.elements;
    for (let i = 0; i < 3; ++i) this.target[i] += scale * (right * e[i] + up * e[4 + i]);
    this.apply();
  }

  zoom(factor) {
    this.distance *= factor;
    this.apply();
  }

  key(event) {
    const { key, shiftKey } = event;
    const turns = { ArrowLeft: [-KEY_TURN, 0], ArrowRight: [KEY_TURN, 0], ArrowUp: [0, -KEY_TURN], ArrowDown: [0, KEY_TURN] };
    const shifts = { ArrowLeft: [-30, 0], ArrowRight: [30, 0], ArrowUp: [0, 30], ArrowDown: [0, -30] };
    if (shiftKey && shifts[key]) this.shift(...shifts[key]);
    else if (turns[key]) this.turn(...turns[key]);
    else if (key === "+" || key === "=") this.zoom(1 / NEARER);
    else if (key === "-") this.zoom(NEARER);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  /** Looks at a sphere so that all of it is seen. */
  frame(centre, radius) {
    this.target = [...centre];
    this.distance = (1.15 * radius) / Math.sin((this.camera.fov * Math.PI) / 360);
    this.camera.near = radius / 1000;
    this.camera.far = radius * 100;
    this.apply();
  }

  apply() {
    const { azimuth, polar, distance, target, camera } = this;
    camera.position.set(
      target[0] + distance * Math.sin(polar) * Math.cos(azimuth),
      target[1] + distance * Math.sin(polar) * Math.sin(azimuth),
      target[2] + distance * Math.cos(polar),
    );
    camera.up.set(0, 0, 1);
    camera.lookAt(...target);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    this.onChange();
  }
}
