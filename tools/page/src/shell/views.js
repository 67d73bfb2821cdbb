/** The views of the page, in the order of their tabs. */
import { BodeView } from "../panels/bode.js";
import { BudgetView } from "../panels/budget.js";
import { CirclesView } from "../panels/circles.js";
import { ComparisonView } from "../panels/comparison.js";
import { MachineView } from "../panels/machine.js";
import { ParametersView } from "../panels/parameters.js";
import { PathView } from "../panels/path3d.js";
import { SweepView } from "../panels/sweep.js";

/** @param {import("./page.js").Page} page @returns {import("./tabs.js").View[]} */
export function mainViews(page) {
  const { store, stack } = page;
  return [
    {
      name: "Signals",
      element: stack.element,
      available: () => store.state.families.length > 0,
      show: () => stack.each((plot) => plot.resize()),
      figures: (width) => stack.figures(width),
    },
    new SweepView(page),
    new BudgetView(page),
    new BodeView(page),
    new ParametersView(page),
  ];
}

/** @param {import("./page.js").Page} page @returns {import("./tabs.js").View[]} */
export function sideViews(page) {
  return [new ComparisonView(page), new MachineView(page), new PathView(page), new CirclesView(page)];
}
