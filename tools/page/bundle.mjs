/**
 * Bundles the page into one file: node bundle.mjs FOLDER, with the installed packages in FOLDER/node_modules.
 * Writes FOLDER/servomill.html.
 */
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const folder = resolve(process.argv[2]);
const packages = join(folder, "node_modules");
const { build } = createRequire(join(folder, "package.json"))("esbuild");

const LICENCES = [
  ["h5wasm", "LICENSE.txt"],
  ["uplot", "LICENSE"],
  ["three", "LICENSE"],
];

async function bundle(entry, more = {}) {
  const { outputFiles } = await build({
    entryPoints: [join(here, "src", entry)],
    bundle: true,
    write: false,
    format: "iife",
    target: "es2022",
    minify: true,
    // Charset utf8 keeps texts readable; the library's branches for node are never taken in a browser.
    charset: "utf8",
    legalComments: "none",
    nodePaths: [packages],
    logLevel: "warning",
    external: ["node:*", "module"],
    define: { "import.meta.url": '""' },
    ...more,
  });
  return outputFiles[0].text;
}

function licences() {
  return LICENCES.map(([name, file]) => {
    const { version } = JSON.parse(readFileSync(join(packages, name, "package.json"), "utf8"));
    return `${name} ${version}\n\n${readFileSync(join(packages, name, file), "utf8").trim()}`;
  })
    .concat(`servomill\n\n${readFileSync(join(here, "../../LICENSE"), "utf8").trim()}`)
    .join(`\n\n${"-".repeat(80)}\n\n`);
}

/** A text inside of a script element ends at the first "</script". */
const inside = (text) => text.replaceAll("</script", "<\\/script");

const worker = await bundle("worker/worker.js");
const script = await bundle("main.js", { define: { WORKER_SOURCE: JSON.stringify(worker) } });
const parts = {
  "/*STYLE*/": readFileSync(join(here, "src/style.css"), "utf8"),
  "/*LICENCES*/": inside(licences()),
  "/*SCRIPT*/": inside(script),
};
let page = readFileSync(join(here, "src/index.html"), "utf8");
for (const [mark, text] of Object.entries(parts)) page = page.replace(mark, () => text);
writeFileSync(join(folder, "servomill.html"), page);
console.log(`${join(folder, "servomill.html")}: ${(page.length / 1e6).toFixed(1)} MB`);
