/** Views of what belongs to a run or a study: comparison, path, machine, circles, sweep, budget, frequency responses. */
import assert from "node:assert/strict";
import { after, before, describe, it } from "node:test";
import { choose, exported, file, launch, newPage, press, settled } from "./browser.mjs";
import { attributeOf, column, columnOf, valueOf } from "./reference.mjs";

let browser;
before(async () => {
  browser = await launch();
});
after(() => browser?.close());

async function opened(name) {
  const page = await newPage(browser);
  await choose(page, file(name));
  return page;
}
const set = async (page, change) => {
  await page.evaluate((text) => servomill.store.set(JSON.parse(text)), JSON.stringify(change));
  await settled(page);
};
const side = (page, name) => press(page, name, ".tabs.right");
const slide = async (page, index, value) => {
  await page.evaluate(
    (i, wanted) => {
      const input = document.querySelectorAll(".side input[type=range]")[i];
      input.value = wanted;
      input.dispatchEvent(new Event("input"));
    },
    index,
    value,
  );
  await settled(page);
};
const count = (page, selector) => page.$$eval(selector, (all) => all.length);

describe("comparison", () => {
  let page;
  before(async () => {
    page = await opened("run");
  });
  after(() => page.close());

  it("lists the values of the file with their units", async () => {
    const rows = await page.$$eval(".comparison tbody tr", (all) =>
      all.map((row) => [...row.children].map((cell) => cell.textContent)),
    );
    const value = valueOf(file("run"), "/comparison/000/value");
    assert.deepEqual(rows[0], [
      "imposed error residual, Y, max",
      "flank",
      "table",
      `${Number(value.toPrecision(4))} µm`,
      "20 µm (fitted)",
    ]);
  });

  it("highlights case and sections of a row in all plots, zooms to them, and lets go", async () => {
    await page.focus(".comparison tbody tr");
    await page.keyboard.press("Enter");
    await settled(page);
    const bands = await page.evaluate(() => [...servomill.stack.plots.values()].map((plot) => servomill.stack.bands(plot)));
    const [section, time] = ["section", "time"].map((name) => columnOf(file("run"), `/cases/table/servo/${name}`));
    const first = time[section.indexOf(4)];
    assert.equal(bands[0].length, 1);
    assert.equal(bands[2][0][0], first);
    const looks = await page.evaluate(
      () => [...servomill.stack.plots.values()][0].lookOf([...[...servomill.stack.plots.values()][0].curves.values()][0]).opacity,
    );
    assert.ok(looks < 1); // nominal fades
    const orange = await page.evaluate(() => {
      const { ctx, bbox } = [...servomill.stack.plots.values()][0].u;
      const x = [...servomill.stack.plots.values()][0].u.valToPos(
        servomill.stack.bands([...servomill.stack.plots.values()][0])[0][0],
        "x",
        true,
      );
      return [...ctx.getImageData(x + 3, bbox.top + 3, 1, 1).data];
    });
    assert.ok(orange[2] < orange[0] - 20, String(orange));
    await page.keyboard.press("z");
    await settled(page);
    const range = await page.evaluate(() => servomill.store.state.ranges.time);
    assert.ok(range[0] < first && range[0] > first - 1);
    await page.keyboard.press("Escape");
    await settled(page);
    assert.equal(await page.evaluate(() => servomill.store.state.highlight ?? null), null);
  });

  it("is filtered", async () => {
    await page.type(".comparison input[type=search]", "lag time");
    assert.equal(await count(page, ".comparison tbody tr"), 5);
  });
});

describe("a program above 1 MB", () => {
  it("has its line at the cursor, too", async () => {
    const page = await opened("long");
    await side(page, "Machine");
    await set(page, { cursor: { key: "time", value: 0.2 } });
    assert.equal(await page.$eval(".side pre", (one) => one.textContent), "line 50008: G1 X10");
    await page.close();
  });
});

describe("path and machine", () => {
  let page;
  before(async () => {
    page = await opened("circle");
  });
  after(() => page.close());
  const picture = () => page.evaluate(() => servomill.side.current.picture());

  it("shows positions of the axes and the line of the program at the cursor", async () => {
    await side(page, "Machine");
    await set(page, { cursor: { key: "time", value: 2.3456 } });
    const [none] = await page.evaluate(() => servomill.side.current.positions);
    for (const [letter, signal, index] of [
      ["X", "true_linear", 0],
      ["Y", "true_linear", 1],
      ["C", "true_rotary", 1],
    ]) {
      const expected = column(file("circle"), "none", signal, index, "time", 2.3456);
      assert.ok(Math.abs(none.values[letter] - expected) < 1e-9, letter);
    }
    assert.match(await page.$eval(".side pre", (one) => one.textContent), /line 14: G3 X#103 Y#103/);
    assert.equal(await count(page, ".axisbar i"), 5 * 3);
    assert.equal(await count(page, ".side .chip"), 5);
    // the table turns about its axis against the counting of C, and X goes where the scale says
    const places = await page.evaluate(() => Object.fromEntries([..."XYZBC"].map((one) => [one, servomill.side.current.scene.placeOf(one)])));
    const { X, Y, Z } = none.values;
    assert.equal(await page.evaluate(() => servomill.side.current.scene.key.includes('"carriesWorkpiece":true')), true);
    const last = Object.values(places).find((place) => Math.abs(place[1] - Y) < 1e-9 && Math.abs(place[2] - Z) < 1e-9);
    assert.ok(last, JSON.stringify({ places, X, Y, Z }));
    await set(page, { cursor: { key: "s", value: 100 } });
    const [there] = await page.evaluate(() => servomill.side.current.positions);
    assert.ok(Math.abs(there.values.X - column(file("circle"), "none", "true_linear", 0, "s", 100)) < 1e-9);
  });

  it("draws the path with its error magnified by the slider, in the colours chosen", async () => {
    await side(page, "Path");
    await page.evaluate(() => servomill.store.set({ cursor: undefined })); // its mark would move with the slider, too
    await settled(page);
    const pictures = [await picture()];
    await slide(page, 0, 3);
    pictures.push(await picture());
    await page.select(".side .controls label:nth-child(2) select", "tool_deviation");
    await settled(page);
    pictures.push(await picture());
    await page.focus("canvas.scene");
    await page.keyboard.press("ArrowLeft");
    await settled(page);
    pictures.push(await picture());
    assert.equal(new Set(pictures).size, 4);
  });

  it("has a marker at the cursor, where the magnified path is", async () => {
    await set(page, { cursor: { key: "time", value: 2.0 } });
    const { place, visible } = await page.evaluate(() => ({
      place: servomill.side.current.marker.position.toArray(),
      visible: servomill.side.current.marker.visible,
    }));
    assert.ok(visible);
    const one = await page.evaluate(() => servomill.side.current.case.name);
    place.forEach((value, i) => {
      const expected =
        column(file("circle"), one, "tool_position_nominal", i, "time", 2) +
        column(file("circle"), one, "tool_deviation", i, "time", 2);
      assert.ok(Math.abs(value - expected) < 1e-6, `${value} is not ${expected}`); // 1000 times: um are shown as mm
    });
  });

  it("draws only what the plots show", async () => {
    const drawn = () => page.evaluate(() => servomill.side.current.lines.nominal.geometry.drawRange.count);
    const all = await drawn();
    await page.evaluate(() => servomill.store.setRange("time", [1, 2]));
    await settled(page);
    assert.ok((await drawn()) < 0.3 * all);
    await page.evaluate(() => servomill.store.setRange("time", undefined));
  });

  it("draws circles as a ball bar does, with the deviation that the comparison holds", async () => {
    await side(page, "Circles");
    assert.equal(await count(page, ".side svg path"), 3);
    const deviations = await page.evaluate(() => servomill.side.current.rows().map((row) => [row[0], row[4]]));
    deviations.forEach(([name, range], i) => {
      assert.equal(name, ["none", "table", "learnt"][i]);
      const expected = valueOf(file("circle"), `/comparison/00${i}/value`);
      assert.ok(Math.abs(range - expected) < 0.01 * expected, `${name}: ${range} is not ${expected}`);
    });
    const before_ = await page.$eval(".side svg path", (one) => one.getAttribute("d"));
    await slide(page, 0, 1);
    assert.notEqual(await page.$eval(".side svg path", (one) => one.getAttribute("d")), before_);
  });

  it("draws what strategies have learnt, and errors over the travel", async () => {
    for (const [family, signal, rows] of [
      ["/cases/*/learnt/precompensation@run", "rms", 4],
      ["/errors/machine/X@position", "EXX", 1601],
    ]) {
      await set(page, { plots: [{ family, signal, column: 0 }] });
      const curves = await page.evaluate(() =>
        [...[...servomill.stack.plots.values()][0].curves.values()].map(({ curve }) => curve.overview.rows),
      );
      assert.deepEqual(curves, [rows]);
    }
    assert.deepEqual(page.faults, []);
  });
});

describe("a probed part", () => {
  let page;
  before(async () => {
    page = await opened("part");
    await side(page, "Path");
  });
  after(() => page.close());
  const view = (text) => page.evaluate(text);
  const FEATURE = "/cases/as_it_is/probes";

  it("has its points where the file has them, displaced along their normals by their magnified deviation", async () => {
    await page.select(".side .controls label:nth-child(1) select", await view("servomill.store.state.cases[1].id"));
    await settled(page);
    assert.equal(await view("servomill.side.current.case.name"), "as_it_is");
    await slide(page, 0, 2);
    const points = await view("servomill.side.current.probes.points");
    const feature = points[0].feature;
    const origin = attributeOf(file("part"), FEATURE, "work_origin_mm");
    const deviation = columnOf(file("part"), `${FEATURE}/${feature}/deviation`);
    assert.deepEqual([...attributeOf(file("part"), FEATURE, "work_axes")], [1, 0, 0, 0, 1, 0, 0, 0, 1]);
    for (const k of [0, 1]) {
      const shown = await view(
        `servomill.side.current.probes.placeOf(servomill.side.current.probes.points[${k}]).toArray()`,
      );
      shown.forEach((value, i) => {
        const nominal = columnOf(file("part"), `${FEATURE}/${feature}/nominal`, i)[k] + origin[i];
        const expected = nominal + 0.1 * deviation[k] * columnOf(file("part"), `${FEATURE}/${feature}/normal`, i)[k]; // um x 100
        assert.ok(Math.abs(value - expected) < 1e-6, `${value} is not ${expected}`);
      });
    }
    // the tool went there: each point lies within the box of its path, grown by the radius of the cutter
    const { center, radius } = await view("servomill.side.current.lines.sphere");
    for (const { place } of points) {
      assert.ok(Math.hypot(place[0] - center.x, place[1] - center.y, place[2] - center.z) < radius + 20);
    }
  });

  it("tells of a point under the pointer what it is", async () => {
    const [x, y] = await view(`(() => {
      const { probes, camera, canvas } = servomill.side.current;
      const seen = probes.placeOf(probes.points[3]).project(camera);
      const box = canvas.getBoundingClientRect();
      return [box.left + ((seen.x + 1) / 2) * box.width, box.top + ((1 - seen.y) / 2) * box.height];
    })()`);
    await page.mouse.move(x, y);
    assert.match(await view("servomill.side.current.probeNote.textContent"), /^\w+, point \d+: .* µm along the normal$/);
    await page.mouse.move(5, 5);
  });

  it("is shown with its scale, hidden, and exported as numbers", async () => {
    const picture = () => view("servomill.side.current.picture()");
    const [shown, figures] = [await picture(), await view("servomill.side.current.figures().map((one) => one.title)")];
    assert.equal(figures.length, 2);
    assert.match(await view("servomill.side.current.probeScale.textContent"), /^probed: −[\d.]+ µm\+[\d.]+ µm$/);
    await page.click(".side .controls input[type=checkbox]");
    await settled(page);
    assert.notEqual(await picture(), shown);
    assert.ok(await view("servomill.side.current.probeScale.hidden"));
    assert.equal(await view("servomill.side.current.figures().length"), 1);
    await page.click(".side .controls input[type=checkbox]");
    await settled(page);
    assert.deepEqual(page.faults, []);
  });
});

describe("studies", () => {
  it("of a sweep are curves, a map, and parallel coordinates with brushes", async () => {
    const page = await opened("sweep");
    assert.equal(await count(page, ".main svg .cell"), 20);
    const as = async (mode) => {
      await page.select(".main .controls select", mode);
      await settled(page);
    };
    await as("curves");
    assert.equal(await count(page, ".main svg"), 2);
    assert.equal(await count(page, ".main svg:first-child .lines path"), 4); // one for each friction
    await as("parallel");
    assert.equal(await count(page, "path.chosen"), 20);
    const axis = await page.evaluate(() => {
      const { x, top, tall } = servomill.main.current.brushes.scales[0];
      const { left, top: above } = document.querySelector(".main svg").getBoundingClientRect();
      return { x: left + x, from: above + top + 0.5 * tall, to: above + top + tall };
    });
    await page.mouse.move(axis.x, axis.from);
    await page.mouse.down();
    await page.mouse.move(axis.x, axis.to, { steps: 3 });
    await page.mouse.up();
    await settled(page);
    assert.equal(await count(page, "path.chosen"), 12); // blocks of 0.5, 1 and 2 mm
    await page.$eval("[data-brush=least]", (one) => {
      one.value = "0.7";
      one.dispatchEvent(new Event("change"));
    });
    assert.equal(await count(page, "path.chosen"), 8);
    await press(page, "Clear");
    assert.equal(await count(page, "path.chosen"), 20);
    assert.deepEqual(page.faults, []);
    await page.close();
  });

  it("of a budget are bars that add up to the residual", async () => {
    const page = await opened("budget");
    const bars = await page.evaluate(() =>
      servomill.main.current.budgets.map((budget) => [
        [...budget.parts.values()].reduce((sum, part) => sum + part.at_place, 0),
        budget.residual.at_place,
      ]),
    );
    assert.equal(bars.length, await count(page, ".main svg g > path"));
    for (const [sum, residual] of bars)
      assert.ok(Math.abs(sum - residual) < 1e-6 * Math.max(1, Math.abs(residual)), `${sum} is not ${residual}`);
    const widths = () => page.$$eval("rect.part", (all) => all.map((one) => one.getAttribute("width")).join());
    const before_ = await widths();
    await page.select(".main .controls select", "rms");
    assert.notEqual(await widths(), before_);
    assert.deepEqual(page.faults, []);
    await page.close();
  });

  it("of loops are magnitude and phase, with dots where they were simulated", async () => {
    const page = await opened("bode");
    const curves = await page.evaluate(() => servomill.main.current.curves.length);
    assert.equal(await count(page, ".main svg"), 2);
    assert.equal(await count(page, ".main svg:first-child .lines > path"), curves);
    assert.ok((await count(page, ".main svg:first-child .lines circle")) > 20);
    await page.click(".main .controls input[type=checkbox]");
    assert.equal(await count(page, ".main svg:first-child .lines > path"), curves - 1);
    assert.match(await page.$eval(".main table", (one) => one.textContent), /phase margin/);
    assert.deepEqual(page.faults, []);
    await page.close();
  });

  it("of an identification are its parameters, and the recording beside its simulation", async () => {
    const page = await opened("identified");
    await press(page, "Parameters", ".tabs");
    const values = columnOf(file("identified"), "/parameters/value");
    const rows = await page.$$eval(".main tbody tr", (all) => all.map((row) => [...row.children].map((cell) => cell.textContent)));
    assert.equal(rows.length, values.length);
    assert.deepEqual(rows[0].slice(0, 2), ["axis.Y.moving_mass", `${Number(values[0].toPrecision(5))} kg`]);
    const [head, first] = (await exported(page, "CSV")).toString().split("\n");
    assert.equal(head, "key,unit,value,half_width,half_width_counted,identifiable");
    assert.equal(Number(first.split(",")[2]), values[0]);
    assert.match((await exported(page, "SVG")).toString(), /<text[^>]*>axis\.Y\.moving_mass<\/text>/);
    await set(page, {
      plots: [
        { family: "/recording_001@time", signal: "feedback", column: 0 },
        { family: "/recording_001@time", signal: "simulated_feedback", column: 0 },
      ],
    });
    const curves = await page.evaluate(() =>
      [...servomill.stack.plots.values()].map((plot) => [...plot.curves.values()][0].curve.overview.y.length),
    );
    assert.ok(curves.length === 2 && curves.every((points) => points > 100), `${curves}`);
    assert.deepEqual(page.faults, []);
    await page.close();
  });

  it("of a day are drift and temperatures over hours", async () => {
    const page = await opened("day");
    await set(page, {
      plots: [
        { family: "/cases/*/day/drift/datum@time", signal: "Z", column: 0 },
        { family: "/cases/*/day@time", signal: "temperature_spindle", column: 0 },
      ],
    });
    const shown = await page.evaluate(() =>
      [...servomill.stack.plots.values()].map((plot) => [
        plot.title.textContent,
        plot.abscissa.unit,
        [...plot.curves.values()][0].curve.overview.y.length,
      ]),
    );
    assert.deepEqual(
      shown.map(([title, unit]) => [title, unit]),
      [
        ["Z (µm)", "h"],
        ["temperature spindle (°C)", "h"],
      ],
    );
    assert.ok(shown.every(([, , points]) => points > 100));
    assert.deepEqual(page.faults, []);
    await page.close();
  });
});
