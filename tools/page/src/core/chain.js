/**
 * Bodies of a machine at positions of its axes, from the chain that the file of a run has (sim/run/store_chain.h).
 * Matrices are 4 x 4, row by row; lengths in mm, angles in degrees.
 */

/**
 * @typedef {object} Joint
 * @property {string} letter
 * @property {boolean} rotary
 * @property {boolean} carriesWorkpiece it stands between bed and workpiece
 * @property {number[]} direction unit vector in the machine frame
 * @property {number[]} point of a rotary axis
 */

const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

/** @param {Record<string, any>} attributes of the group of a case @returns {Joint[]} [] of files without a chain */
export function chainOf(attributes) {
  const { chain_axes: letters, chain_carries_workpiece: sides, chain_directions: directions, chain_points_mm: points } = attributes;
  if (!letters || !directions) return [];
  return Array.from(letters, (letter, k) => ({
    letter,
    rotary: letter < "X",
    carriesWorkpiece: [sides].flat()[k] === 1,
    direction: directions.slice(3 * k, 3 * k + 3),
    point: points.slice(3 * k, 3 * k + 3),
  }));
}

export function product(a, b) {
  return IDENTITY.map((_, at) => {
    const [i, j] = [Math.floor(at / 4), at % 4];
    return [0, 1, 2, 3].reduce((sum, k) => sum + a[4 * i + k] * b[4 * k + j], 0);
  });
}

/** Inverse of a rotation and a translation. */
export function inverse(m) {
  const out = [...IDENTITY];
  for (let i = 0; i < 3; ++i) {
    for (let j = 0; j < 3; ++j) out[4 * i + j] = m[4 * j + i];
    out[4 * i + 3] = -[0, 1, 2].reduce((sum, k) => sum + m[4 * k + i] * m[4 * k + 3], 0);
  }
  return out;
}

/** Motion of a joint: along its direction, or about the line through its point (Rodrigues' formula). */
export function motion({ rotary, direction: [x, y, z], point }, position) {
  const out = [...IDENTITY];
  if (!rotary) {
    [x, y, z].forEach((part, i) => {
      out[4 * i + 3] = part * position;
    });
    return out;
  }
  const angle = (position * Math.PI) / 180;
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const d = [x, y, z];
  const cross = [0, -z, y, z, 0, -x, -y, x, 0];
  for (let i = 0; i < 3; ++i) {
    for (let j = 0; j < 3; ++j) out[4 * i + j] = (i === j ? c : 0) + (1 - c) * d[i] * d[j] + s * cross[3 * i + j];
  }
  for (let i = 0; i < 3; ++i) out[4 * i + 3] = point[i] - [0, 1, 2].reduce((sum, j) => sum + out[4 * i + j] * point[j], 0);
  return out;
}

/**
 * The bodies that move, seen from the bed: each with the joint that moves it against the next body towards the bed.
 * @param {Joint[]} joints from the workpiece to the tool
 * @param {Record<string, number>} positions by letter
 * @returns {{joint: Joint, pose: number[]}[]}
 */
export function bodiesOf(joints, positions) {
  const onWorkpiece = joints.filter((joint) => joint.carriesWorkpiece).length;
  const motions = joints.map((joint) => motion(joint, positions[joint.letter] ?? 0));
  const frames = [inverse(motions.slice(0, onWorkpiece).reduce(product, IDENTITY))];
  for (const one of motions) frames.push(product(frames.at(-1), one));
  return joints.map((joint, k) => ({ joint, pose: frames[joint.carriesWorkpiece ? k : k + 1] }));
}
