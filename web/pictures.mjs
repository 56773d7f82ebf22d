// Takes the pictures of the page that docs/ holds: node web/pictures.mjs FOLDER TO
//
// FOLDER is what scripts/web.sh makes; TO gets web-desktop.webp, web-menu.webp and web-phone.webp, and web-placeholders.webp where NODE_PATH
// finds thumbhash and blurhash, to compare with. They show the page's own samples, which are computed, and no photographs. Needs
// playwright-core where NODE_PATH finds it.
import { createRequire } from 'node:module';
import { existsSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const require = createRequire(import.meta.url);
const { chromium } = require('playwright-core');
const [folder, to] = process.argv.slice(2);
if (!to || !existsSync(to)) {
  console.error('usage: node web/pictures.mjs FOLDER TO');
  process.exit(2);
}
const patience = { timeout: 300000 }; // ms

const DESKTOP = { viewport: { width: 1280, height: 800 } };
const PHONE = { viewport: { width: 390, height: 844 }, deviceScaleFactor: 1.5, hasTouch: true, isMobile: true };
const PICTURES = {
  'web-desktop': { options: { ...DESKTOP, colorScheme: 'dark' }, sample: 1, open: '' },
  'web-menu': { options: DESKTOP, sample: 2, open: '#save' },
  'web-phone': { options: PHONE, sample: 1, open: '' },
};

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM || '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--force-color-profile=srgb'],
});
async function take(page, name) {
  const session = await page.context().newCDPSession(page);
  const { data } = await session.send('Page.captureScreenshot', { format: 'webp', quality: 80 });
  writeFileSync(join(to, `${name}.webp`), Buffer.from(data, 'base64'));
  await page.close();
}
for (const [name, { options, sample, open }] of Object.entries(PICTURES)) {
  const page = await browser.newPage({ ...options, reducedMotion: 'reduce' });
  await page.goto(pathToFileURL(resolve(folder, 'hmesh.html')).href);
  await page.click(`#samples button:nth-of-type(${sample})`, patience);
  await page.waitForSelector('body[data-picture][data-state=done]', patience);
  await page.click('#edges');
  if (open) {
    await page.click(open);
    const areSized = () => [...document.querySelectorAll('#files span')].every((size) => /\d/.test(size.textContent));
    await page.waitForFunction(areSized, null, patience);
  }
  await page.evaluate(() => document.activeElement.blur());
  await page.mouse.move(1, 1);
  await page.waitForTimeout(500); // tags have come
  await take(page, name);
}

// The package for JavaScript `name`, or nothing.
async function optional(name) {
  try {
    const found = await import(pathToFileURL(require.resolve(name)).href);
    return found.default ?? found;
  } catch {
    return undefined;
  }
}
// Placeholders of a sample, as words and pixels. Not of the hills: blurhash 2.0.5 scales by the largest coefficient, not the largest size of one,
// and loses 4.5 dB there.
async function placeholders(thumbhash, blurhash) {
  const ours = (file) => import(pathToFileURL(resolve(folder, file)).href);
  const [{ draw }, { Hmesh, compileCompact }, { encode }, { decode, toPixels }] = await Promise.all(
    ['samples.js', 'npm/core.node.js', 'npm/encoder.js', 'npm/placeholder.js'].map(ours));
  const [sample, small] = [[600, 400], [96, 64]].map(([width, height]) => ({ data: draw('balls', width, height), width, height }));
  const hmesh = new Hmesh(await compileCompact()), meshes = [100, 200, 300].map((bytes) => [`mesh, ${bytes} bytes`, toPixels(decode(encode(hmesh, sample, { bytes })))]);
  const hash = thumbhash.rgbaToThumbHash(small.width, small.height, small.data), { w, h, rgba } = thumbhash.thumbHashToRGBA(hash);
  const [few, many] = [[4, 3], [9, 9]].map((components) => blurhash.encode(small.data, small.width, small.height, ...components));
  return [['picture', sample], ...meshes, [`thumbhash, ${hash.length} bytes`, { data: rgba, width: w, height: h }],
    ...[few, many].map((text) => [`blurhash, ${text.length} letters`, { ...small, data: blurhash.decode(text, small.width, small.height) }])];
}
const [thumbhash, blurhash] = await Promise.all(['thumbhash', 'blurhash'].map(optional));
if (thumbhash && blurhash) {
  const all = (await placeholders(thumbhash, blurhash)).map(([said, { data, width, height }]) => [said, [...data], width, height]);
  const page = await browser.newPage({ viewport: { width: 1000, height: 114 } });
  await page.setContent('<style>body { margin: 0; display: grid; grid: auto / repeat(7, 138px); gap: 5px; font: 12px sans-serif }'
    + 'figure { margin: 0 } canvas { display: block; width: 138px; height: 92px } figcaption { height: 22px; line-height: 22px; text-align: center }</style>');
  await page.evaluate((list) => list.forEach(([said, data, width, height]) => {
    const canvas = Object.assign(document.createElement('canvas'), { width, height }), figure = document.createElement('figure');
    canvas.getContext('2d').putImageData(new ImageData(Uint8ClampedArray.from(data), width, height), 0, 0);
    figure.append(canvas, Object.assign(document.createElement('figcaption'), { textContent: said }));
    document.body.append(figure);
  }), all);
  await take(page, 'web-placeholders');
}
await browser.close();
