/** Views behind tabs: those that the open files have something for. */
import { html } from "./dom.js";

/**
 * @typedef {object} View
 * @property {string} name
 * @property {HTMLElement} element
 * @property {() => boolean} available
 * @property {() => void} [show] called when it comes into view
 * @property {() => void} [hide]
 * @property {(width: number) => object[]} [figures] for export
 */

export class Tabs {
  /** @param {string} label @param {View[]} views @param {HTMLElement} area @param {(view: View | undefined) => void} [onChange] */
  constructor(label, views, area, onChange = () => {}) {
    Object.assign(this, { views, area, onChange });
    this.element = html("div", { class: "tabs", role: "tablist", "aria-label": label });
    this.element.addEventListener("keydown", (event) => this.key(event));
    /** @type {View | undefined} */
    this.current = undefined;
  }

  /** Shows the tabs of what there is, and keeps the one that is open. */
  update() {
    const views = this.views.filter((view) => view.available());
    this.element.replaceChildren(
      ...views.map((view) =>
        html(
          "button",
          {
            type: "button",
            role: "tab",
            id: `tab-${view.name}`,
            "aria-selected": view === this.current,
            tabindex: view === this.current ? 0 : -1,
            onclick: () => this.open(view),
          },
          view.name,
        ),
      ),
    );
    if (!views.includes(this.current)) this.open(views[0]);
    else this.current?.show?.();
  }

  /** @param {View | string | undefined} wanted */
  open(wanted) {
    const view = typeof wanted === "string" ? this.views.find((one) => one.name === wanted && one.available()) : wanted;
    if (view !== this.current) {
      this.current?.hide?.();
      this.current = view;
      this.area.replaceChildren(...(view ? [view.element] : []));
    }
    for (const tab of this.element.children) {
      const selected = tab.textContent === view?.name;
      tab.setAttribute("aria-selected", String(selected));
      tab.tabIndex = selected ? 0 : -1;
    }
    view?.show?.();
    this.onChange(view);
  }

  key(event) {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!step) return;
    const tabs = [...this.element.children];
    const next = tabs[(tabs.indexOf(document.activeElement) + step + tabs.length) % tabs.length];
    next?.click();
    next?.focus();
  }
}
