/** Curves of one plot: what the worker is asked for, and what has come. */
import { latestOnly } from "../data/client.js";

const MARGIN = 0.15; // of the range on both sides, for the curve to be there when it is moved

/** What a member is drawn over: specification for the worker. */
export function abscissaSpec(family, member, abscissa) {
  if (family.servo) return { file: member.file, path: `${member.path}/${abscissa.name}`, column: abscissa.column };
  return family.scale
    ? { file: member.file, path: `${member.path}/${family.scale}`, column: 0 }
    : { file: member.file, rows: member.rows };
}

/** What is drawn of a member: the signal, or its difference to the baseline at equal s. */
export function ordinateSpec(family, member, signal, column, baseline) {
  const own = { file: member.file, path: `${member.path}/${signal.name}`, column };
  if (!baseline) return own;
  return {
    ...own,
    s: `${member.path}/s`,
    base: { file: baseline.file, path: `${baseline.path}/${signal.name}`, s: `${baseline.path}/s` },
  };
}

/** The curve of one case in one plot. */
export class Curve {
  /** @param {import("../data/client.js").Client} client @param {object} request x, y, monotone, gaps */
  constructor(client, request, onChange) {
    this.client = client;
    this.request = request;
    this.onChange = onChange;
    /** @type {{x: Float64Array, y: Float64Array, rows: number, exact: boolean, extent: [number, number]} | undefined} */
    this.overview = undefined;
    this.detail = undefined;
    this.ask = latestOnly((wanted) => this.load(wanted));
  }

  async load({ range, pixels }) {
    try {
      if (!this.overview) {
        this.overview = await this.client.ask("curve", { ...this.request, pixels });
        this.onChange();
      }
      if (!range || this.overview.exact) {
        this.detail = undefined;
        return;
      }
      const room = MARGIN * (range[1] - range[0]);
      const wide = [range[0] - room, range[1] + room];
      const detail = await this.client.ask("curve", {
        ...this.request,
        range: wide,
        pixels: Math.round(pixels * (1 + 2 * MARGIN)),
      });
      this.detail = { ...detail, range: wide };
    } catch (fault) {
      this.fault = fault.message;
    }
    this.onChange();
  }

  /** Points for what is seen: the detail where it covers it. */
  points(range) {
    if (range && this.detail && this.detail.range[0] <= range[0] && this.detail.range[1] >= range[1]) return this.detail;
    return this.overview;
  }
}

/** Least and greatest ordinate of points within a range of the abscissa. */
export function extentWithin({ x, y }, [low, high]) {
  let [least, greatest] = [Infinity, -Infinity];
  for (let i = 0; i < x.length; ++i) {
    if (x[i] < low || x[i] > high) continue;
    if (y[i] < least) least = y[i];
    if (y[i] > greatest) greatest = y[i];
  }
  return [least, greatest];
}

/** Ordinate of points at an abscissa that does not fall; NaN outside and in gaps. */
export function ordinateAt({ x, y }, at) {
  let [low, high] = [0, x.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (x[middle] <= at) low = middle + 1;
    else high = middle;
  }
  if (low === 0 || (low === x.length && x[low - 1] < at)) return NaN;
  if (low === x.length) return y[low - 1];
  const share = (at - x[low - 1]) / (x[low] - x[low - 1]);
  return y[low - 1] + share * (y[low] - y[low - 1]);
}
