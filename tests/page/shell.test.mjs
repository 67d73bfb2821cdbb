/** Frame of the page: exports, themes, keys, faults; and tools/view, which serves it. */
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { copyFileSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { request } from "node:http";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { after, before, describe, it } from "node:test";
import { fileURLToPath } from "node:url";
import { choose, exported, file, launch, newPage, press, settled } from "./browser.mjs";
import { columnOf } from "./reference.mjs";

const VIEW = join(dirname(fileURLToPath(import.meta.url)), "../../tools/view");

let browser;
before(async () => {
  browser = await launch();
});
after(() => browser?.close());

describe("export", () => {
  let page;
  before(async () => {
    page = await newPage(browser);
    await choose(page, file("circle"));
  });
  after(() => page.close());

  it("writes what is seen as SVG with the curves, axes and names", async () => {
    const text = (await exported(page, "SVG")).toString();
    const found = await page.evaluate((source) => {
      const drawing = new DOMParser().parseFromString(source, "image/svg+xml");
      return {
        faults: drawing.querySelectorAll("parsererror").length,
        curves: drawing.querySelectorAll(".lines path").length,
        texts: drawing.documentElement.textContent,
      };
    }, text);
    assert.equal(found.faults, 0);
    assert.equal(found.curves, 9);
    for (const part of ["contour error (µm)", "time (s)", "table", "learnt"]) assert.ok(found.texts.includes(part), part);
  });

  it("writes PNG of twice the size", async () => {
    const bytes = await exported(page, "PNG");
    assert.equal(bytes.subarray(1, 4).toString(), "PNG");
    assert.deepEqual([bytes.readUInt32BE(16), bytes.readUInt32BE(20)], [1800, 3 * 2 * 260]);
  });

  it("writes CSV with the points that are drawn", async () => {
    await page.evaluate(() => servomill.store.setRange("time", [1, 1.2]));
    await settled(page);
    const [head, ...rows] = (await exported(page, "CSV")).toString().trim().split("\n");
    assert.equal(head, "plot,curve,time (s),value");
    const time = columnOf(file("circle"), "/cases/none/servo/time");
    const errors = columnOf(file("circle"), "/cases/none/servo/contour_error");
    const mine = rows
      .map((row) => row.split(","))
      .filter(([plot, curve, at]) => plot.startsWith("contour") && curve === "none" && at >= 1 && at <= 1.2);
    assert.equal(mine.length, time.filter((at) => at >= 1 && at <= 1.2).length);
    for (const [, , at, value] of mine) assert.equal(Number(value), errors[time.indexOf(Number(at))]);
  });

  it("writes the side view that has the focus", async () => {
    await page.focus(".comparison tbody tr");
    await page.keyboard.press("c");
    await page.waitForFunction(() => servomill.lastExport?.type.includes("csv"));
    await settled(page);
    const text = await page.evaluate(() => servomill.lastExport.text());
    assert.match(
      text,
      /^quantity,axis,statistic,sections,case,value,unit,reference,basis\ncircular_error_least_squares,,,circle,none,/,
    );
    await press(page, "Path", ".tabs.right");
    await page.focus("canvas.scene");
    const picture = (await exported(page, "PNG")).length;
    assert.ok(picture > 5000, `${picture} bytes`);
  });
});

describe("looks and keys", () => {
  let page;
  before(async () => {
    page = await newPage(browser);
    await choose(page, file("circle"));
  });
  after(() => page.close());
  const paper = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);

  it("follow the system between light and dark, and the user", async () => {
    await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "dark" }]);
    await settled(page);
    const dark = await paper();
    const colour = await page.evaluate(
      () => [...servomill.stack.plots.values()][0].lookOf([...[...servomill.stack.plots.values()][0].curves.values()][0]).colour,
    );
    await page.keyboard.press("t");
    await settled(page);
    assert.equal(await paper(), "rgb(255, 255, 255)");
    assert.notEqual(dark, "rgb(255, 255, 255)");
    assert.equal(colour, "#f2f2f2"); // black would not be seen
  });

  it("are listed under ?, with the licences of all that is in the page", async () => {
    await page.keyboard.press("?");
    assert.match(await page.$eval("dialog", (one) => one.textContent), /next abscissa.*move the cursor.*double click/s);
    await press(page, "Licences", "dialog");
    const texts = await page.$eval("dialog:last-of-type pre", (one) => one.textContent);
    for (const part of ["h5wasm 0.", "HDF5", "NIST", "uplot 1.", "Leon Sorokin", "three 0.", "three.js authors", "BSD 3-Clause"])
      assert.ok(texts.includes(part), part);
    await page.keyboard.press("Escape");
    await page.keyboard.press("Escape");
    await page.waitForSelector("dialog", { hidden: true }); // a browser tells of a closed dialog in a task of its own
    assert.equal(await page.$("dialog"), null);
  });

  it("reach everything: controls have names and none is left out by Tab", async () => {
    // Few signals: all of them are buttons of the same kind.
    await page.type("#filter", "tool_deviation");
    await page.evaluate(() => document.activeElement.blur());
    const seen = new Set();
    const next = () =>
      page.evaluate(() => {
        const one = document.activeElement;
        const again = one.dataset.visited === "1";
        one.dataset.visited = "1";
        return again ? "" : one.tagName;
      });
    for (let name = "BODY"; name !== ""; name = await next()) {
      seen.add(name);
      await page.keyboard.press("Tab");
    }
    const missed = await page.$$eval("button, select, input, canvas.scene, .area, tbody tr[tabindex]", (all) =>
      all
        .filter((one) => one.checkVisibility() && !one.dataset.visited && one.tabIndex >= 0)
        .map((one) => one.outerHTML.slice(0, 80)),
    );
    assert.deepEqual(missed, []);
    const nameless = await page.$$eval("button, select, input", (all) =>
      all
        .filter(
          (one) =>
            one.checkVisibility() &&
            !(one.textContent.trim() || one.getAttribute("aria-label") || one.labels?.[0]?.textContent.trim()),
        )
        .map((one) => one.outerHTML.slice(0, 80)),
    );
    assert.deepEqual(nameless, []);
    assert.ok(
      ["BUTTON", "SELECT", "INPUT", "DIV", "TR", "SUMMARY"].every((name) => seen.has(name)),
      [...seen].join(),
    );
  });
});

describe("files", () => {
  it("that are chosen while others open do not take their place", async () => {
    const page = await newPage(browser);
    const input = await page.$("#files");
    await input.uploadFile(file("circle"));
    await input.uploadFile(file("sweep"));
    await page.waitForFunction(() => servomill.store.state.results.filter(Boolean).length === 2);
    const indices = await page.evaluate(() => servomill.store.state.results.map((one) => one.index));
    assert.deepEqual(indices, [0, 1]);
    assert.deepEqual(page.faults, []);
    await page.close();
  });

  it("that cannot be read are named with the reason; the others open", async () => {
    const page = await newPage(browser);
    await choose(page, file("text"), file("circle"), file("cut"));
    const message = await page.$eval(".message", (one) => one.textContent);
    assert.equal(message, "text.h5: is not an HDF5 file\ncut.h5: is damaged, cut short, or still being written");
    assert.deepEqual(await page.evaluate(() => servomill.store.state.results.filter(Boolean).map((one) => one.name)), ["circle"]);
    assert.deepEqual(
      page.faults.filter((text) => !/HDF5-DIAG|^\s+(#|major|minor)/.test(text)),
      [],
    ); // the library reports, too
    await page.close();
  });
});

/** Answer of a server: status, headers and body. */
const fetched = (url, headers = {}, method = "GET") =>
  new Promise((resolve, reject) => {
    request(url, { headers, method }, (answer) => {
      const parts = [];
      answer
        .on("data", (part) => parts.push(part))
        .on("end", () => resolve({ status: answer.statusCode, headers: answer.headers, body: Buffer.concat(parts) }));
    })
      .on("error", reject)
      .end();
  });

describe("tools/view", () => {
  let own;
  let server;
  let address;
  before(async () => {
    own = mkdtempSync(join(tmpdir(), "view-"));
    copyFileSync(file("circle"), join(own, "mine.h5"));
    writeFileSync(join(own, "other.h5"), "of nobody's business");
    server = spawn(VIEW, [join(own, "mine.h5"), "--no-browser"], { stdio: ["ignore", "pipe", "inherit"] });
    address = await new Promise((resolve, reject) => {
      server.stdout.once("data", (text) => resolve(/http:\S+/.exec(text)[0]));
      server.once("exit", (status) => reject(new Error(`status ${status}`)));
    });
  });
  after(() => {
    server?.kill("SIGKILL");
    rmSync(own, { recursive: true });
  });

  it("opens its files in the page, and nothing comes from elsewhere", async () => {
    const page = await browser.newPage();
    const asked = [];
    page.on("request", (one) => asked.push(one.url()));
    await page.goto(address);
    await page.waitForFunction(() => globalThis.servomill?.store.state.results.length === 1);
    await settled(page);
    assert.equal(
      await page.evaluate(() => [...[...servomill.stack.plots.values()][0].curves.values()][0].curve.overview.rows),
      columnOf(file("circle"), "/cases/none/servo/time").length,
    );
    for (const url of asked) assert.ok(url.startsWith(address) || /^(blob|data):/.test(url), url);
    await page.close();
  });

  it("answers ranges of the files, and nothing without the token or of another host", async () => {
    const [{ url, size }] = JSON.parse((await fetched(`${address}files.json`)).body);
    const whole = readFileSync(join(own, "mine.h5"));
    assert.equal(size, whole.length);
    const part = await fetched(address + url, { Range: "bytes=1000-1999" });
    assert.equal(part.status, 206);
    assert.equal(part.headers["content-range"], `bytes 1000-1999/${size}`);
    assert.ok(part.body.equals(whole.subarray(1000, 2000)));
    assert.equal((await fetched(address + url, { Range: `bytes=${size}-` })).status, 416);
    const head = await fetched(address + url, {}, "HEAD");
    assert.deepEqual([head.status, Number(head.headers["content-length"]), head.body.length], [200, size, 0]);
    const root = new URL("/", address).href;
    for (const wrong of [
      root,
      `${root}files.json`,
      `${address}../files.json`,
      `${address}other.h5`,
      `${address}file/1/x`,
      `${address}file/0/../../other.h5`,
      `${address}%2e%2e/other.h5`,
    ]) {
      assert.equal((await fetched(wrong)).status, 404, wrong);
    }
    assert.equal((await fetched(address, { Host: "evil.example" })).status, 404);
  });

  it("does not mix a file with the one that replaced it", async () => {
    const [{ url }] = JSON.parse((await fetched(`${address}files.json`)).body);
    copyFileSync(file("bode"), join(own, "mine.h5"));
    assert.equal((await fetched(address + url)).status, 410);
    const [now] = JSON.parse((await fetched(`${address}files.json`)).body);
    assert.equal((await fetched(address + now.url)).body.length, readFileSync(file("bode")).length);
  });

  it("ends with Ctrl-C, and refuses what is not HDF5", async () => {
    const ended = new Promise((resolve) => {
      server.once("exit", (status) => resolve(status));
    });
    server.kill("SIGINT");
    assert.equal(await ended, 0);
    const run = (...args) =>
      new Promise((resolve) => {
        const child = spawn(VIEW, args, { stdio: ["ignore", "pipe", "pipe"] });
        let [out, faults] = ["", ""];
        child.stdout.on("data", (text) => {
          out += text;
        });
        child.stderr.on("data", (text) => {
          faults += text;
        });
        child.on("close", (status) => resolve({ status, out, faults }));
      });
    assert.deepEqual(await run(join(own, "other.h5")), {
      status: 2,
      out: "",
      faults: `${join(own, "other.h5")}: error: not an HDF5 file\n`,
    });
    assert.deepEqual(await run(join(own, "none.h5")), {
      status: 2,
      out: "",
      faults: `${join(own, "none.h5")}: error: cannot be read: No such file or directory\n`,
    });
    assert.match((await run("--help")).out, /Shows result files/);
  });
});
