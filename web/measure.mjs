// How fast the page is: node web/measure.mjs FOLDER IMAGE... [--rounds N]
//
// FOLDER is what scripts/web.sh makes, the images are photographs, of which the first is the photo of 0.4 Mpx, and all of which
// make a mosaic of 12 Mpx. Prints the medians of N rounds, by default 3, and their least and largest: what a user waits for,
// counted by the page's own clock from the event to the frame that shows it, how long the page's main thread is held, and how much
// memory its process has had, which Linux tells. Needs playwright-core where NODE_PATH finds it, and a machine that does nothing else.
import { createRequire } from 'node:module';
import { spawn } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { loadavg } from 'node:os';
import { basename, dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { brotliCompressSync, constants } from 'node:zlib';

const { chromium } = createRequire(import.meta.url)('playwright-core');
const patience = { timeout: 600000 }; // ms
const here = dirname(fileURLToPath(import.meta.url));

const args = process.argv.slice(2);
const at = args.indexOf('--rounds');
const rounds = at < 0 ? 3 : Number(args.splice(at, 2)[1]);
const [folder, ...images] = args;
if (!(images.length > 0 && rounds > 0)) {
  console.error('usage: node web/measure.mjs FOLDER IMAGE... [--rounds N]');
  process.exit(2);
}

const found = new Map(); // name: values
const note = (name, value, unit = 'ms') => found.set(name, { unit, values: [...(found.get(name)?.values ?? []), value] });

// In the page: a clock that notes when what is shown changes.
function watch() {
  const times = { drafts: [], ends: [] };
  window.times = times;
  const isMesh = () => /vertices/.test(document.getElementById('numbers').textContent);
  const afterFrame = (then) => requestAnimationFrame(() => setTimeout(then));
  new MutationObserver(() => isMesh() && afterFrame(() => times.drafts.push(performance.now())))
    .observe(document.getElementById('numbers'), { childList: true, subtree: true, characterData: true });
  new MutationObserver(() => document.body.dataset.state === 'done' && times.ends.push(performance.now()))
    .observe(document.body, { attributes: true, attributeFilter: ['data-state'] });
}

// Drops the file and waits until it is refined: ms to the first draft, ms to the end, and from the browser's trace the longest task
// of the page's main thread, by the clock and by the processor's time.
async function drop(page, base64, name) {
  await page.evaluate(([text, file]) => {
    const bytes = Uint8Array.from(atob(text), (one) => one.charCodeAt(0));
    window.dropped = new DataTransfer();
    window.dropped.items.add(new File([bytes], file, { type: 'image/jpeg' }));
  }, [base64, name]);
  await page.waitForTimeout(1000); // all is quiet
  await browser.startTracing(page, { categories: ['disabled-by-default-devtools.timeline', '__metadata'] });
  await page.evaluate(() => {
    Object.assign(window.times, { drafts: [], ends: [], from: performance.now() });
    setTimeout(() => document.body.dispatchEvent(new DragEvent('drop', { bubbles: true, dataTransfer: window.dropped })));
  });
  const isDone = () => window.times.drafts.length > 0 && window.times.ends.length > 0;
  await page.waitForFunction(isDone, null, { ...patience, polling: 250 });
  const { traceEvents } = JSON.parse(await browser.stopTracing());
  const main = traceEvents.filter((event) => event.name === 'thread_name' && event.args?.name === 'CrRendererMain');
  const tasks = traceEvents.filter(({ name: what, pid, tid }) => what === 'RunTask'
    && main.some((thread) => thread.pid === pid && thread.tid === tid));
  const longest = tasks.reduce((one, other) => (other.dur > one.dur ? other : one), { dur: 0, tdur: 0 });
  const times = await page.evaluate(() => window.times);
  return { draft: times.drafts[0] - times.from, end: times.ends[0] - times.from, longest: longest.dur / 1000,
    busiest: Math.max(...tasks.map(({ tdur = 0 }) => tdur)) / 1000 };
}
// The most memory that a page's process has had, MiB: of the largest one, since each page has its own.
async function peakMemory() {
  const session = await browser.newBrowserCDPSession();
  const { processInfo } = await session.send('SystemInfo.getProcessInfo');
  const peaks = processInfo.filter(({ type }) => type === 'renderer').map(({ id }) => {
    const told = /VmHWM:\s*(\d+) kB/.exec(readFileSync(`/proc/${id}/status`, 'latin1'));
    return told ? told[1] / 1024 : NaN;
  });
  await session.detach();
  return Math.max(...peaks);
}
async function slide(page, value) {
  await page.waitForTimeout(500); // all is drawn
  return page.evaluate(async (to) => {
    const slider = document.getElementById('count');
    Object.assign(window.times, { drafts: [], ends: [], from: performance.now() });
    slider.value = to;
    slider.dispatchEvent(new Event('input'));
    while (window.times.drafts.length === 0) await new Promise((resolve) => setTimeout(resolve, 2));
    const draft = window.times.drafts[0] - window.times.from;
    while (document.body.dataset.state !== 'done') await new Promise((resolve) => setTimeout(resolve, 20));
    return { draft, vertices: document.getElementById('wanted').textContent };
  }, value);
}

const server = spawn(process.execPath, [join(here, 'serve.mjs'), folder, '0'], { stdio: ['ignore', 'pipe', 'inherit'] });
const address = String(await new Promise((resolve) => server.stdout.once('data', resolve))).trim();
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM || '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
console.log(`Chromium ${browser.version()}, load ${loadavg()[0].toFixed(1)} at the start`);

// JPEG files, made by the browser.
const maker = await browser.newPage();
const typeOf = (image) => (image.endsWith('.png') ? 'image/png' : 'image/jpeg');
const files = images.map((image) => `data:${typeOf(image)};base64,${readFileSync(image, 'base64')}`);
const make = (urls, width, height) => maker.evaluate(async ([all, w, h]) => {
  const canvas = new OffscreenCanvas(w, h);
  const context = canvas.getContext('2d');
  const pictures = await Promise.all(all.map(async (url) => {
    const picture = new Image();
    picture.src = url;
    await picture.decode();
    return picture;
  }));
  const [wide, high] = pictures.length === 1 ? [w, h] : [768, 512];
  for (let k = 0, y = 0; y < h; y += high)
    for (let x = 0; x < w; x += wide, k++) context.drawImage(pictures[k % pictures.length], x, y, wide, high);
  const bytes = new Uint8Array(await (await canvas.convertToBlob({ type: 'image/jpeg', quality: 0.92 })).arrayBuffer());
  let text = '';
  for (let i = 0; i < bytes.length; i += 32768) text += String.fromCharCode(...bytes.subarray(i, i + 32768));
  return btoa(text);
}, [urls, width, height]);
const photos = { '0.4 Mpx': await make(files.slice(0, 1), 768, 512), '12 Mpx': await make(files, 4000, 3000) };
await maker.close();

for (let round = 0; round < rounds; round++)
  for (const [size, photo] of Object.entries(photos))
    for (const limit of size === '12 Mpx' ? ['2', 'Infinity'] : ['2']) {
      const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
      const page = await context.newPage();
      await page.goto(address);
      await page.waitForLoadState('networkidle');
      await page.evaluate(watch);
      note('no photo yet: memory of the page\'s process at most', await peakMemory(), 'MiB');
      await page.evaluate((value) => { document.getElementById('limit').value = value; }, limit);
      const what = limit === '2' ? size : `${size}, not scaled`;
      const opened = await drop(page, photo, 'photo.jpg');
      note(`${what}: dropped to draft`, opened.draft);
      note(`${what}: dropped to normal`, opened.end);
      note(`${what}: longest task of the main thread`, opened.longest);
      note(`${what}: its tasks' most time of a processor`, opened.busiest);
      note(`${what}: memory of the page's process at most`, await peakMemory(), 'MiB');
      if (limit === '2')
        for (const place of [40, 70, 100, 130]) {
          const { draft, vertices } = await slide(page, place);
          note(`${what}: slider to draft of ${vertices}`, draft);
        }
      await context.close();
    }
console.log(`load ${loadavg()[0].toFixed(1)} at the end; median (least to largest) of ${rounds} rounds`);
for (const [name, { unit, values }] of found) {
  values.sort((a, b) => a - b);
  const [least, median, most] = [values[0], values[values.length >> 1], values.at(-1)].map(Math.round);
  console.log(`${name.padEnd(52)} ${median} ${unit} (${least} to ${most})`);
}
const page = readFileSync(join(folder, 'hmesh.html'));
const brotli = (bytes) => brotliCompressSync(bytes, { params: { [constants.BROTLI_PARAM_LGWIN]: 24 } }).length;
console.log(`${basename(folder)}/hmesh.html: ${page.length} bytes, ${brotli(page)} by brotli`);
await browser.close();
server.kill();
