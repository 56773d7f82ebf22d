// Takes the pictures of the page that docs/ holds: node web/pictures.mjs FOLDER TO
//
// FOLDER is what scripts/web.sh makes; TO gets web-desktop.webp, web-menu.webp and web-phone.webp. They show the page's own
// samples, which are computed, and no photographs. Needs playwright-core where NODE_PATH finds it.
import { createRequire } from 'node:module';
import { existsSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const { chromium } = createRequire(import.meta.url)('playwright-core');
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
  const session = await page.context().newCDPSession(page);
  const { data } = await session.send('Page.captureScreenshot', { format: 'webp', quality: 80 });
  writeFileSync(join(to, `${name}.webp`), Buffer.from(data, 'base64'));
  await page.close();
}
await browser.close();
