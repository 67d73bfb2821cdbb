// Opens a result file in H5Web (Chromium) and checks what it shows at once: the default plot over time.
//
//     node h5web.mjs RESULT.h5 FOLDER [CHROMIUM]
//
// In FOLDER are node_modules; a screenshot of the page is written there.
import { createServer } from 'node:http';
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const [result, folder, chromium = 'chromium'] = process.argv.slice(2);
const modules = (name) => import(pathToFileURL(join(folder, 'node_modules', name)).href);
const esbuild = await modules('esbuild/lib/main.js');
const { launch } = await modules('puppeteer-core/lib/esm/puppeteer/puppeteer-core.js');

const kPatience = 60_000; // ms, of a busy machine

async function bundle() {
  const built = await esbuild.build({
    entryPoints: [join(import.meta.dirname, 'page.jsx')],
    nodePaths: [join(folder, 'node_modules')],
    bundle: true,
    format: 'esm',
    jsx: 'automatic',
    outdir: 'page',
    write: false,
    loader: { '.woff2': 'dataurl', '.svg': 'dataurl' },
    define: { 'process.env.NODE_ENV': '"production"' },
  });
  return new Map(built.outputFiles.map((file) => [file.path.endsWith('.css') ? '/page.css' : '/page.js', file.text]));
}

function serve(pages) {
  const types = { js: 'text/javascript', css: 'text/css', h5: 'application/x-hdf5' };
  const server = createServer(async (request, response) => {
    const type = types[request.url.split('.').pop()] ?? 'text/html';
    response.setHeader('Content-Type', type);
    response.end(request.url === '/result.h5' ? await readFile(result) : pages.get(request.url) ?? '');
  });
  return new Promise((done) => server.listen(0, '127.0.0.1', () => done(server)));
}

// Labels of the plot, once its abscissa has a label and numbers.
async function shown(page) {
  await page.waitForFunction(
    () => document.querySelectorAll('figure svg text').length > 6, { timeout: kPatience, polling: 100 });
  return page.evaluate(() => ({
    figure: document.querySelector('figure').getAttribute('aria-label') ?? '',
    texts: [...document.querySelectorAll('figure svg text')].map((text) => text.textContent),
    view: [...document.querySelectorAll('[role=tab][aria-selected=true]')].map((tab) => tab.textContent).join(''),
  }));
}

const pages = await bundle();
pages.set('/', '<!doctype html><link rel="stylesheet" href="/page.css">' +
  '<body style="margin: 0"><div id="root" style="height: 100vh"></div><script type="module" src="/page.js"></script>');
const server = await serve(pages);
const browser = await launch({ executablePath: chromium, args: ['--no-sandbox'] });
try {
  const page = await browser.newPage();
  await page.setViewport({ width: 1200, height: 800 });
  const faults = [];
  page.on('pageerror', (fault) => faults.push(String(fault)));
  await page.goto(`http://127.0.0.1:${server.address().port}/`);
  try {
    console.log(JSON.stringify({ ...(await shown(page)), faults }));
  } finally {
    await page.screenshot({ path: join(folder, 'h5web.png') });
  }
} finally {
  await browser.close();
  server.closeAllConnections();
  server.close();
}
