/** The page in headless Chromium: opened from file://, with files chosen as a user does. */
import { existsSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

/** Folder with the built page and its packages. */
export const folder = resolve(process.env.SERVOMILL_PAGE ?? "build/page");
const puppeteer = createRequire(join(folder, "package.json"))("puppeteer-core");
const PATIENCE = 60_000; // ms, on a machine that others use, too

const CHROMIUM = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find((path) => existsSync(path));

export function launch(options = []) {
  if (!CHROMIUM) throw new Error("no Chromium: apt-get install chromium");
  return puppeteer.launch({
    executablePath: CHROMIUM,
    headless: true,
    protocolTimeout: 3 * PATIENCE,
    args: [
      "--no-sandbox",
      "--disable-dev-shm-usage",
      "--disable-gpu",
      "--enable-unsafe-swiftshader",
      "--hide-scrollbars",
      ...options,
    ],
  });
}

/** A page whose faults and console errors are collected in page.faults. */
export async function newPage(
  browser,
  { width = 1400, height = 900, url = pathToFileURL(join(folder, "servomill.html")).href } = {},
) {
  const page = await browser.newPage();
  page.setDefaultTimeout(PATIENCE);
  page.faults = [];
  page.on("pageerror", (fault) => page.faults.push(String(fault)));
  page.on("console", (message) => {
    if (message.type() === "error") page.faults.push(message.text());
  });
  await page.setViewport({ width, height });
  await page.goto(url);
  return page;
}

/** Chooses files and waits until all that is shown has been read. */
export async function choose(page, ...files) {
  const input = await page.$("#files");
  await input.uploadFile(...files);
  await page.waitForFunction(
    (names) =>
      globalThis.servomill.store.state.results.filter(Boolean).length >= names || !document.querySelector(".message").hidden,
    {},
    files.length,
  );
  await settled(page);
}

/** Waits until no request is under way and two frames have been drawn. */
export async function settled(page) {
  await page.waitForFunction(
    () =>
      new Promise((done) => {
        let quiet = 0;
        const look = () => {
          const { client, store } = globalThis.servomill;
          quiet = client.busy || store.changed.size > 0 ? 0 : quiet + 1;
          if (quiet > 3) done(true);
          else requestAnimationFrame(look);
        };
        look();
      }),
  );
}

/** Clicks the button with this text or accessible name. */
export async function press(page, name, within = "body") {
  const found = await page.evaluateHandle(
    (text, scope) =>
      [...document.querySelectorAll(`${scope} button`)].find(
        (one) => one.getAttribute("aria-label") === text || one.textContent === text,
      ),
    name,
    within,
  );
  const element = found.asElement();
  if (!element) throw new Error(`no button ${name} within ${within}`);
  await element.evaluate((one) => one.click());
  await settled(page);
}

/** A file that files.py has made. */
export const file = (name) => join(resolve(process.env.SERVOMILL_PAGE_FILES ?? "build/dev/tests/page/files"), `${name}.h5`);

/** What the page would save: its name is not seen, its content is. */
export async function exported(page, format) {
  await press(page, format);
  await page.waitForFunction((type) => servomill.lastExport?.type.includes(type), {}, format.toLowerCase());
  const bytes = await page.evaluate(async () => [...new Uint8Array(await servomill.lastExport.arrayBuffer())]);
  return Buffer.from(bytes);
}
