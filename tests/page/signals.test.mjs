/** Signals of a run: what is drawn equals the file, and every way to move through it. */
import assert from "node:assert/strict";
import { after, before, describe, it } from "node:test";
import { column, columnOf } from "./reference.mjs";
import { choose, file, launch, newPage, press, settled } from "./browser.mjs";

let browser;
let page;
before(async () => {
  browser = await launch();
  page = await newPage(browser);
  await choose(page, file("run"));
});
after(() => browser?.close());

const state = (expression) => page.evaluate(`(() => { const { state } = servomill.store; return ${expression}; })()`);
const plots = () =>
  page.evaluate(() =>
    [...servomill.stack.plots.values()].map((plot) => ({
      title: plot.title.textContent,
      key: plot.key,
      range: plot.range(),
      readout: plot.readout.textContent,
      curves: [...plot.curves.values()].map(({ label, curve }) => ({
        label,
        rows: curve.overview?.rows,
        exact: curve.overview?.exact,
        fault: curve.fault,
      })),
    })),
  );
/** Points of one curve as they are drawn. */
const points = (plot, label) =>
  page.evaluate(
    (i, name) => {
      const one = [...servomill.stack.plots.values()][i];
      const { curve } = [...one.curves.values()].find((candidate) => candidate.label === name);
      const { x, y } = curve.points(servomill.store.state.ranges[one.key]);
      return { x: [...x], y: [...y] };
    },
    plot,
    label,
  );
/** Share of the pixels of a plot that have one of these colours, about. */
const painted = (plot, [r, g, b]) =>
  page.evaluate(
    (i, red, green, blue) => {
      const { ctx } = [...servomill.stack.plots.values()][i].u;
      const { data } = ctx.getImageData(0, 0, ctx.canvas.width, ctx.canvas.height);
      let count = 0;
      for (let k = 0; k < data.length; k += 4)
        if (Math.abs(data[k] - red) + Math.abs(data[k + 1] - green) + Math.abs(data[k + 2] - blue) < 40) ++count;
      return count;
    },
    plot,
    r,
    g,
    b,
  );
const set = async (change) => {
  await page.evaluate((text) => servomill.store.set(JSON.parse(text)), JSON.stringify(change));
  await settled(page);
};
const key = async (...names) => {
  for (const name of names) await page.keyboard.press(name);
  await settled(page);
};
const choice = async (label, value) => {
  await page.evaluate(
    (text, wanted) => {
      const select = [...document.querySelectorAll("label")]
        .find((one) => one.textContent.startsWith(text))
        .querySelector("select");
      select.value = wanted;
      select.dispatchEvent(new Event("change"));
    },
    label,
    value,
  );
  await settled(page);
};
const box = (plot) =>
  page.evaluate((i) => {
    const { left, top, width, height } = [...servomill.stack.plots.values()][i].u.over.getBoundingClientRect();
    return { left, top, width, height };
  }, plot);

describe("a run", () => {
  it("shows errors of all cases with units of the file, in their colours", async () => {
    const shown = await plots();
    assert.deepEqual(
      shown.map((plot) => plot.title),
      ["contour error (µm)", "tool deviation ‖·‖ (µm)", "following error linear X (µm)"],
    );
    assert.deepEqual(
      shown[0].curves.map((curve) => curve.label),
      ["nominal", "table", "feedback", "gcode", "gcode_blocks", "feedback_lead"],
    );
    assert.ok((await painted(0, [0xb8, 0x86, 0x0b])) > 200); // the case drawn last
    assert.deepEqual(page.faults, []);
  });

  it("calls each of several equal signals by its own long name", async () => {
    const labels = await page.evaluate(() =>
      servomill.store.state.families[0].signals.filter(({ name }) => /^(ref|cmd)_linear$/.test(name)).map(({ name, label }) => [name, label]),
    );
    assert.equal(labels.length, 2);
    for (const [name, label] of labels) assert.ok(label && !label.includes(" = ") && !label.includes(name), `${name}: ${label}`);
    assert.notEqual(labels[0][1], labels[1][1]);
  });

  it("draws few points with every extreme of the file", async () => {
    const { x, y } = await points(0, "table");
    const rows = columnOf(file("run"), "/cases/table/servo/contour_error");
    assert.equal((await plots())[0].curves[1].rows, rows.length);
    assert.ok(y.length < rows.length);
    assert.equal(Math.max(...y), Math.max(...rows));
    assert.equal(Math.min(...y), Math.min(...rows));
    const time = columnOf(file("run"), "/cases/table/servo/time");
    assert.deepEqual([x[0], Math.max(...x)], [time[0], time.at(-1)]);
  });

  it("draws every row where it is zoomed in", async () => {
    await page.evaluate(() => servomill.store.setRange("time", [20, 21]));
    await settled(page);
    const { x, y } = await points(0, "table");
    const time = columnOf(file("run"), "/cases/table/servo/time");
    const rows = columnOf(file("run"), "/cases/table/servo/contour_error");
    const first = time.indexOf(x[0]);
    assert.ok(time[first] < 20 && x.at(-1) > 21);
    assert.deepEqual(y, [...rows.slice(first, first + y.length)]);
    await key("0");
  });

  it("takes length of a vector and columns, also into one plot, and removes them", async () => {
    await page.click('[data-signal="/cases/*/servo@time|velocity_linear|1"]');
    await page.keyboard.down("Shift");
    await page.click('[data-signal="/cases/*/servo@time|velocity_linear|2"]');
    await page.keyboard.up("Shift");
    await settled(page);
    const added = (await plots()).at(-1);
    assert.equal(added.title, "velocity linear Y, velocity linear Z (mm/s)");
    assert.equal(added.curves.length, 12);
    assert.equal(
      await page.$eval('[data-signal="/cases/*/servo@time|velocity_linear|2"]', (one) => one.getAttribute("aria-pressed")),
      "true",
    );
    await press(page, "✕", ".plot:last-child");
    assert.equal((await plots()).length, 3);
  });
});

describe("zoom and cursor", () => {
  it("links all plots: drag zooms, a double click shows all", async () => {
    const { left, top, width, height } = await box(1);
    await page.mouse.move(left + 0.25 * width, top + height / 2);
    await page.mouse.down();
    await page.mouse.move(left + 0.5 * width, top + height / 2, { steps: 4 });
    await page.mouse.up();
    await settled(page);
    const all = (await plots()).map((plot) => plot.range);
    const end = columnOf(file("run"), "/cases/gcode/servo/time").at(-1);
    assert.deepEqual(all[0], all[2]);
    assert.ok(Math.abs(all[0][0] - 0.25 * end) < 0.01 * end && Math.abs(all[0][1] - 0.5 * end) < 0.01 * end, String(all[0]));
    await page.mouse.click(left + 0.5 * width, top + height / 2, { count: 2 });
    await settled(page);
    assert.equal(await state("state.ranges.time ?? null"), null);
  });

  it("zooms with the wheel about the pointer, and with keys", async () => {
    const { left, top, width } = await box(0);
    await page.mouse.move(left + 0.5 * width, top + 20);
    await page.keyboard.down("Shift");
    await page.mouse.wheel({ deltaY: -300 });
    await page.keyboard.up("Shift");
    await settled(page);
    const [low, high] = await state("state.ranges.time");
    assert.ok(low > 5 && high < 57);
    await page.focus(".area");
    await key("+");
    const [closer] = await state("state.ranges.time");
    assert.ok(closer > low);
    await key(".");
    assert.ok((await state("state.ranges.time"))[0] > closer);
    await key("-", "-", "-", "-", "-", "-", "-", "-", "-");
    assert.equal(await state("state.ranges.time ?? null"), null);
  });

  it("shows the values of all plots at the cursor, as they are in the file", async () => {
    await set({ cursor: { key: "time", value: 21.5 } });
    await page.focus(".area");
    const before_ = (await plots()).map((plot) => plot.readout);
    for (const readout of before_) assert.match(readout, /nominal [−\d.]+.*µm.*feedback_lead/);
    await page.evaluate(() => servomill.store.setRange("time", [21, 22]));
    await settled(page);
    const value = column(file("run"), "table", "following_error_linear", 0, "time", 21.5);
    const shown = /table ([−\d.e]+) µm/.exec((await plots())[2].readout)[1].replace("−", "-");
    assert.ok(Math.abs(Number(shown) - value) <= 1e-3 * Math.abs(value), `${shown} is not ${value}`);
    await key("ArrowRight");
    assert.ok(Math.abs((await state("state.cursor.value")) - 21.505) < 1e-9);
    await key("End");
    assert.equal(await state("state.cursor.value"), 22);
    await page.focus(".area");
    await key("0");
  });

  it("follows the pointer in all plots", async () => {
    const { left, top, width } = await box(0);
    await page.mouse.move(left + width / 2, top + 30);
    await settled(page);
    const end = columnOf(file("run"), "/cases/gcode/servo/time").at(-1);
    assert.ok(Math.abs((await state("state.cursor.value")) - end / 2) < 0.01 * end);
    const lines = await page.$$eval(".u-cursor-x", (all) => all.map((one) => one.getBoundingClientRect().left));
    assert.ok(
      lines.every((x) => Math.abs(x - lines[0]) < 1.5),
      String(lines),
    );
  });
});

describe("a recording of windows", () => {
  it("is drawn with its gaps, and moves through them", async () => {
    const other = await newPage(browser);
    await choose(other, file("windows"));
    const window = columnOf(file("windows"), "/cases/table/servo/window");
    const time = columnOf(file("windows"), "/cases/table/servo/time");
    const gaps = window.filter((value, row) => row > 0 && value !== window[row - 1]).length;
    const drawn = () =>
      other.evaluate(() => {
        const [plot] = servomill.stack.plots.values();
        const { curve } = [...plot.curves.values()].find(({ label }) => label === "table");
        const { x, y } = curve.points(servomill.store.state.ranges.time);
        return { x: [...x], y: [...y] };
      });
    const all = await drawn();
    assert.equal(all.y.filter((value) => value === null).length, gaps); // NaN in the page
    assert.ok(all.x.every((value, i) => i === 0 || value >= all.x[i - 1]));
    const row = window.findIndex((value, i) => i > 0 && value !== window[i - 1]);
    await other.evaluate((low, high) => servomill.store.setRange("time", [low, high]), time[row - 1] - 0.05, time[row] + 0.05);
    await settled(other);
    const near = await drawn();
    const gap = near.y.indexOf(null);
    assert.deepEqual([near.x[gap - 1], near.x[gap + 1]], [time[row - 1], time[row]]);
    assert.deepEqual(other.faults, []);
    await other.close();
  });
});

describe("abscissa, cases and differences", () => {
  it("is time, arc length, or the position of an axis, where curves return", async () => {
    await choice("over", "s");
    assert.deepEqual(
      (await plots()).map((plot) => plot.key),
      ["s", "s", "s"],
    );
    const s = columnOf(file("run"), "/cases/table/servo/s");
    assert.equal(Math.max(...(await points(0, "table")).x), s.at(-1));
    await key("x");
    assert.equal((await plots())[0].key, "X");
    const { x, y } = await points(0, "table");
    assert.ok(x.some((value, i) => value < x[i - 1]) && x.some((value, i) => value > x[i - 1]));
    assert.equal(Math.max(...y), Math.max(...columnOf(file("run"), "/cases/table/servo/contour_error")));
    await choice("over", "time");
  });

  it("hides and shows cases by their boxes and by keys", async () => {
    await page.click('[data-case="0:table"]');
    await key("1");
    assert.deepEqual(
      (await plots())[0].curves.map((curve) => curve.label),
      ["feedback", "gcode", "gcode_blocks", "feedback_lead"],
    );
    await key("a");
    assert.equal((await plots())[0].curves.length, 6);
  });

  it("shows differences to a case at equal s", async () => {
    await choice("over", "s");
    await choice("difference to", "0:nominal");
    const [{ title, curves }] = await plots();
    assert.equal(title, "contour error − nominal at equal s (µm)");
    assert.deepEqual(
      curves.map((curve) => curve.label),
      ["table", "feedback", "gcode", "gcode_blocks", "feedback_lead"],
    );
    await page.evaluate(() => servomill.store.setRange("s", [1300, 1302]));
    await settled(page);
    const { x, y } = await points(2, "gcode");
    const i = x.findIndex((value) => value > 1301);
    const expected =
      column(file("run"), "gcode", "following_error_linear", 0, "s", x[i]) -
      column(file("run"), "nominal", "following_error_linear", 0, "s", x[i]);
    assert.ok(Math.abs(y[i] - expected) < 1e-6 * Math.max(1, Math.abs(expected)), `${y[i]} is not ${expected}`);
    await key("b");
    assert.equal(await state("state.baseline"), "0:table");
    await choice("difference to", "");
    await page.focus(".area");
    await key("0");
    await choice("over", "time");
  });

  it("overlays cases of several files, and closes them", async () => {
    await choose(page, file("circle"));
    const labels = (await plots())[0].curves.map((curve) => curve.label);
    assert.equal(labels.length, 9);
    assert.ok(labels.includes("table (run)") && labels.includes("table (circle)"));
    await press(page, "✕", ".files li:last-child");
    assert.equal((await plots())[0].curves.length, 6);
    assert.deepEqual(page.faults, []);
  });
});
