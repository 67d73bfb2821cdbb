/** State of the page, and who is to know of its changes. */

/**
 * @typedef {object} State
 * @property {import("../data/model.js").Result[]} results by number; closed files leave a gap
 * @property {import("../data/model.js").Case[]} cases
 * @property {import("../data/model.js").Family[]} families
 * @property {Set<string>} visible ids of the cases that are drawn
 * @property {string} abscissa key of that of the servo signals
 * @property {Record<string, [number, number] | undefined>} ranges what is seen of each abscissa; all without
 * @property {{key: string, value: number} | undefined} cursor
 * @property {import("../plots/plot.js").Chosen[]} plots
 * @property {string} baseline id of the case that the others are compared with, "" for the signals themselves
 * @property {{cases: Set<string>, sections: Set<string>, line: string} | undefined} highlight
 * @property {"light" | "dark"} theme
 */

export class Store {
  constructor() {
    /** @type {State} */
    this.state = {
      results: [],
      cases: [],
      families: [],
      visible: new Set(),
      abscissa: "time",
      ranges: {},
      cursor: undefined,
      plots: [],
      baseline: "",
      highlight: undefined,
      theme: "light",
    };
    this.listeners = [];
    this.changed = new Set();
  }

  /**
   * @param {(keyof State)[]} keys
   * @param {(state: State) => void} listener called once a frame if one of them has changed
   */
  on(keys, listener) {
    this.listeners.push({ keys, listener });
  }

  /** @param {Partial<State>} change */
  set(change) {
    Object.assign(this.state, change);
    if (this.changed.size === 0) requestAnimationFrame(() => this.publish());
    for (const key of Object.keys(change)) this.changed.add(key);
  }

  publish() {
    const changed = this.changed;
    this.changed = new Set();
    for (const { keys, listener } of this.listeners) if (keys.some((key) => changed.has(key))) listener(this.state);
  }

  /** @param {string} key @param {[number, number] | undefined} range */
  setRange(key, range) {
    this.set({ ranges: { ...this.state.ranges, [key]: range } });
  }
}
