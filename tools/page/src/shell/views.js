/** The views of the page, in the order of their tabs. */

/** @param {import("./page.js").Page} page @returns {import("./tabs.js").View[]} */
export function mainViews(page) {
  const { store, stack } = page;
  return [
    { name: "Signals", element: stack.element, available: () => store.state.families.length > 0, show: () => stack.each((plot) => plot.resize()), figures: (width) => stack.figures(width) },
  ];
}

/** @param {import("./page.js").Page} page @returns {import("./tabs.js").View[]} */
export function sideViews(page) {
  return [];
}
