/**
 * Times and memory of the page, for comparison between versions on the same machine; no test runs it.
 *
 *     node tests/page/measure.mjs FILE.h5 [--served]     with the page in build/page, built by tools/page/build
 *
 * Prints the load of the machine, the time until the page can read files, that from choosing the file to the first
 * complete plot and to all of them, the memory of all processes of the browser, and frames a second while zooming,
 * moving the cursor and turning the path.
 */
import { execFileSync, spawn } from "node:child_process";
import { readFileSync, statSync } from "node:fs";
import { loadavg } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { launch, newPage, press, settled } from "./browser.mjs";

const SECONDS = 3; // of each movement
const POLLING = { polling: 25 }; // ms; at every frame it would take a share of the time that it measures
const [path, ...options] = process.argv.slice(2);

/** Processes of the browser and their children. */
function family(root) {
  const parents = execFileSync("ps", ["-e", "-o", "pid=,ppid="])
    .toString()
    .trim()
    .split("\n")
    .map((line) => line.trim().split(/\s+/).map(Number));
  const found = new Set([root]);
  for (let before = 0; before !== found.size;) {
    before = found.size;
    for (const [pid, parent] of parents) if (found.has(parent)) found.add(pid);
  }
  return [...found];
}

/** Memory in MB: proportional set size, which counts shared pages once. */
function memory(root) {
  const sizes = family(root).map((pid) => {
    try {
      return Number(/^Pss:\s+(\d+)/m.exec(readFileSync(`/proc/${pid}/smaps_rollup`, "utf8"))?.[1] ?? 0);
    } catch {
      return 0; // it has ended
    }
  });
  return Math.round(sizes.reduce((sum, size) => sum + size, 0) / 1024);
}

const TICK = 100; // of the clock of processes, a second

/** Time of processors that the browser has taken (s): what does not depend on others that use the machine. */
function processorTime(root) {
  return family(root).reduce((sum, pid) => {
    try {
      const fields = readFileSync(`/proc/${pid}/stat`, "utf8")
        .replace(/^.*\) /, "")
        .split(" ");
      return sum + (Number(fields[11]) + Number(fields[12])) / TICK;
    } catch {
      return sum; // it has ended
    }
  }, 0);
}

/** Frames a second while `move` is called before each of them. */
const frames = (page, move) =>
  page.evaluate(
    (text, seconds) =>
      new Promise((done) => {
        const step = eval(text);
        const begin = performance.now();
        let count = 0;
        const next = () => {
          const now = (performance.now() - begin) / 1000;
          if (now > seconds) {
            done(count / now);
            return;
          }
          step(now, count++);
          requestAnimationFrame(next);
        };
        requestAnimationFrame(next);
      }),
    move,
    SECONDS,
  );

async function served() {
  const server = spawn(join(dirname(fileURLToPath(import.meta.url)), "../../tools/view"), [path, "--no-browser"]);
  const text = await new Promise((resolve) => server.stdout.once("data", resolve));
  return { server, url: /http:\S+/.exec(text)[0] };
}

const plotted = (all) => {
  const plots = [...(globalThis.servomill?.stack.plots.values() ?? [])];
  const complete = (plot) => plot.curves.size > 0 && [...plot.curves.values()].every(({ curve }) => curve.overview);
  return plots.length > 0 && (all ? plots.every(complete) : complete(plots[0]));
};

const say = (name, value, unit) => console.log(`${name.padEnd(44)} ${String(value).padStart(8)} ${unit}`);

const browser = await launch(["--disable-web-security"]);
say("size of the file", (statSync(path).size / 1e6).toFixed(0), "MB");
say("load of the machine before", loadavg()[0].toFixed(1), "");
const place = options.includes("--served") ? await served() : undefined;
// The policy of the page refuses eval, which only the measurement needs.
const page = await newPage(browser, { url: "about:blank" });
await page.setBypassCSP(true);
let begin = performance.now();
if (place) {
  await page.goto(place.url);
} else {
  const url = new URL(
    `file://${join(process.env.SERVOMILL_PAGE ?? "build/page", "servomill.html").replace(/^(?!\/)/, `${process.cwd()}/`)}`,
  );
  await page.goto(url.href);
}
const root = browser.process().pid;
let spent = processorTime(root);
const since = () => ((performance.now() - begin) / 1000).toFixed(2);
const taken = () => `s, processors ${(processorTime(root) - spent).toFixed(2)} s`;
if (!place) {
  begin = performance.now();
  await page.waitForFunction(() => globalThis.servomill?.client.isReady, POLLING);
  say("page", since(), taken());
  spent = processorTime(root);
}
begin = performance.now();
if (!place) await (await page.$("#files")).uploadFile(path);
/** Prints frames a second and the time of processors that each of them takes. */
async function sayFrames(name, move, counter) {
  const before = counter ? await counter() : 0;
  spent = processorTime(root);
  const rate = await frames(page, move);
  const count = counter ? (await counter()) - before : rate * SECONDS;
  say(
    name,
    (count / SECONDS).toFixed(0),
    `frames/s, processors ${((1000 * (processorTime(root) - spent)) / count).toFixed(1)} ms a frame`,
  );
}
await page.waitForFunction(plotted, POLLING, false);
say(place ? "page and first plot" : "first plot", since(), taken());
await page.waitForFunction(plotted, POLLING, true);
say("all plots", since(), taken());
await settled(page);
say("memory of the browser", memory(browser.process().pid), "MB");
await sayFrames(
  "zoom and shift of all plots",
  "(t) => { const p = servomill.stack.current; const [a, b] = p.extent(); const w = (b - a) * (0.3 + 0.2 * Math.sin(2 * t)); " +
    "const c = a + (b - a) * (0.5 + 0.2 * Math.sin(t)); servomill.store.setRange(p.key, [c - w / 2, c + w / 2]); }",
);
await settled(page);
await sayFrames(
  "cursor over all plots",
  "(t) => { const p = servomill.stack.current; const [a, b] = p.range(); " +
    "servomill.store.set({ cursor: { key: p.key, value: a + (b - a) * (0.5 + 0.45 * Math.sin(3 * t)) } }); }",
);
await page.evaluate(() => servomill.store.setRange("time", undefined));
if (await page.$("#tab-Path")) {
  begin = performance.now();
  spent = processorTime(root);
  await press(page, "Path", ".tabs.right");
  await page.waitForFunction(() => servomill.side.current.lines);
  say("path in space", since(), taken());
  const drawn = () => page.evaluate(() => servomill.side.current.frames);
  await sayFrames("turning the path (software WebGL)", "() => servomill.side.current.orbit.turn(0.02, 0)", drawn);
  await sayFrames(
    "magnifying the error (software WebGL)",
    "(t) => { const e = servomill.side.current; e.exponent = 2 + Math.sin(t); e.magnify(); }",
    drawn,
  );
}
say("memory of the browser at the end", memory(browser.process().pid), "MB");
say("load of the machine after", loadavg()[0].toFixed(1), "");
place?.server.kill("SIGINT");
await browser.close();
