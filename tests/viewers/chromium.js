// chromium.js - a picture or a page of hmesh's, as Chromium shows it: node chromium.js FILE SCREENSHOT.png [WIDTH HEIGHT]
//
// FILE is an .svg, drawn at WIDTH x HEIGHT px, or an .html that write_html() wrote, whose canvas is taken as `#native` shows
// it: one pixel of the picture to one of the screen. The module playwright-core must be where NODE_PATH finds it; the
// browser is $CHROMIUM, else /usr/bin/chromium.
'use strict';
const { chromium } = require('playwright-core');
const path = require('path');
const { pathToFileURL } = require('url');

async function main([file, screenshot, width, height]) {
  if (!screenshot) throw new Error('usage: chromium.js FILE SCREENSHOT.png [WIDTH HEIGHT]');
  const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM || '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--force-color-profile=srgb', '--allow-file-access-from-files'],
  });
  try {
    const viewport = { width: Number(width) || 1600, height: Number(height) || 1200 };
    const page = await browser.newPage({ viewport });
    const faults = [];
    page.on('pageerror', (error) => faults.push(String(error)));
    page.on('console', (message) => { if (message.type() === 'error') faults.push(message.text()); });
    page.on('request', (request) => { if (/^(https?|wss?):/.test(request.url())) faults.push('asked for ' + request.url()); });
    const url = pathToFileURL(path.resolve(file)).href;
    if (/\.html$/.test(file)) {
      await page.goto(url + '#native');
      await page.waitForSelector('#mesh[data-drawn]', { timeout: 60000 });
      await page.locator('#mesh').screenshot({ path: screenshot });
    } else {
      await page.goto(url, { timeout: 120000 });
      await page.screenshot({ path: screenshot, omitBackground: true, clip: { x: 0, y: 0, ...viewport }, timeout: 120000 });
    }
    if (faults.length > 0) throw new Error(faults.join('\n'));
  } finally {
    await browser.close();
  }
}

main(process.argv.slice(2)).catch((error) => { console.error(String(error.message || error)); process.exit(1); });
