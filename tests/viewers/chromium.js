// chromium.js - what Chromium shows of a picture or a page of hmesh's, as a PNG file: node chromium.js FILE SCREENSHOT
//
// FILE is an .svg, drawn at its own size, or an .html that write_html() wrote, whose canvas is taken as `#native` shows it:
// one pixel of the picture to one of the screen. A page is then opened again and handled by keys, wheel and pointer. Of
// FILE.html#original only the original is taken, which the page holds to compare with. Errors of the page, and anything that it asks the network for, make this fail. chromium.sh says what is needed.
'use strict';
const { chromium } = require('playwright-core');
const { readFileSync, writeFileSync } = require('fs');
const { resolve } = require('path');
const { pathToFileURL } = require('url');

const patience = { timeout: 300000 };  // ms; 200,000 faces take a browser a while

async function handle(page, url) {
  await page.goto('about:blank');
  await page.goto(url, patience);
  await page.waitForSelector('#mesh[data-drawn]', patience);
  const state = () => page.getAttribute('#mesh', 'data-drawn');  // what the canvas shows
  const deeds = {
    'key +': () => page.keyboard.press('+'),
    'key -': () => page.keyboard.press('-'),
    'key left': () => page.keyboard.press('ArrowLeft'),
    'key down': () => page.keyboard.press('ArrowDown'),
    'key 0': () => page.keyboard.press('0'),
    'key 1': () => page.keyboard.press('1'),
    'key w': () => page.keyboard.press('w'),
    'wheel': async () => { await page.mouse.move(300, 300); await page.mouse.wheel(0, -200); },
    'drag': async () => { await page.mouse.down(); await page.mouse.move(340, 350); await page.mouse.up(); },
    'button': () => page.click('#wires'),
  };
  if (await page.isVisible('#share')) deeds['key o'] = () => page.keyboard.press('o');
  for (const name in deeds) {
    const before = await state();
    await deeds[name]();
    await page.waitForFunction((old) => document.querySelector('#mesh').dataset.drawn !== old, before, { timeout: 5000 })
      .catch(() => { throw new Error(name + ' changes nothing'); });
  }
}

async function main([file, screenshot]) {
  if (!screenshot) throw new Error('usage: chromium.js FILE SCREENSHOT');
  const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM || '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--force-color-profile=srgb'],
  });
  try {
    const [path, part] = file.split('#');
    const url = pathToFileURL(resolve(path)).href, is_page = path.endsWith('.html');
    const size = is_page ? null : /viewBox="0 0 (\d+) (\d+)"/.exec(readFileSync(file, 'latin1').slice(0, 1000));
    const viewport = size ? { width: Number(size[1]), height: Number(size[2]) } : { width: 1600, height: 1200 };
    const page = await browser.newPage({ viewport });
    const faults = [];
    page.on('pageerror', (error) => faults.push(String(error)));
    page.on('console', (message) => { if (['error', 'warning'].includes(message.type())) faults.push(message.text()); });
    page.on('request', (request) => { if (!/^(file|data|about):/.test(request.url())) faults.push('asked for ' + request.url()); });
    if (is_page) {
      await page.goto(`${url}#${part || 'native'}`, patience);
      await page.waitForSelector(part ? '#mesh[data-drawn$=" 1"]' : '#mesh[data-drawn]', patience);
      writeFileSync(screenshot, await page.locator('#mesh').screenshot(patience));
      if (!part) await handle(page, url);
    } else {
      await page.goto(url, patience);
      writeFileSync(screenshot, await page.screenshot({ omitBackground: true, ...patience }));
    }
    if (faults.length > 0) throw new Error(faults.join('\n'));
  } finally {
    await browser.close();
  }
}

main(process.argv.slice(2)).catch((error) => {
  console.error(String(error.message || error));
  process.exit(1);
});
