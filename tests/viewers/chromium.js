// chromium.js - what Chromium shows of pictures and pages of hmesh's, as PNG files:
// node chromium.js FOLDER (FILE REFERENCE LEAST)...
//
// Screenshot n of FOLDER, 0.png and so on, is that of the n-th FILE; what it is compared with is for chromium.sh alone. FILE is an
// .svg, drawn at its own size and without the GPU, whose stand-in takes three times as long, or an .html that write_html() wrote,
// whose canvas is taken as `#native` shows it: one pixel of the picture to one of the screen. A page is then opened again and handled
// by keys, wheel and pointer, and by fingers on the screen of a phone; FILE.html#native is not, nor FILE.html#original, of which the
// original is taken that the page holds to compare with.
// Errors of the page, and anything that it asks the network for, make this fail. needs_chromium.sh says what is needed.
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
    'drag': async () => { await page.mouse.down(); await page.mouse.move(260, 250); await page.mouse.up(); },
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

// Panels, the list of keys and their names, by keys alone.
async function unfold(page, isSmall) {
  const expect = (truth, what) => { if (!truth) throw new Error(`${isSmall ? 'small' : 'large'} screen: ${what}`); };
  const shown = (id) => page.isVisible(id);
  const hasTexts = await page.isEnabled('[aria-controls=figures]');  // pages may be without
  const parts = hasTexts ? ['tools', 'figures'] : ['tools'];
  const folded = async () => (await Promise.all(parts.map((part) => shown('#' + part)))).every((is) => !is);
  expect(await folded() === isSmall, isSmall ? 'panels are not folded' : 'panels are folded');
  const expanded = () => page.$$eval('.fold', (buttons) => buttons.map((button) => button.ariaExpanded).join());
  expect(await expanded() === (isSmall ? 'false,false' : 'true,true'), 'aria-expanded is ' + await expanded());
  if (!isSmall) await page.keyboard.press('p');
  expect(await folded() && await expanded() === 'false,false', 'p does not fold');
  await page.keyboard.press('p');
  expect(await shown('#tools') && !await folded(), 'p does not unfold');
  for (const part of parts) {
    await page.focus(`[aria-controls=${part}]`);
    await page.keyboard.press('Enter');
    expect(!await shown('#' + part), part + ' do not fold');
    await page.keyboard.press('Enter');
    expect(await shown('#' + part), part + ' do not unfold');
  }
  for (const close of ['Escape', '?', 'Enter']) {  // of which the last is the button's
    await page.keyboard.press('?');
    expect(await shown('#help') && await shown('#notes') === hasTexts, '? lists no keys');
    await page.keyboard.press(close);
    expect(!await shown('#help'), close + ' does not close the list');
  }
  await page.click('#keys');
  expect(await shown('#help'), 'the button ? lists no keys');
  const box = await page.locator('#help').boundingBox(), view = page.viewportSize();
  expect(box.x >= 0 && box.y >= 0 && box.x + box.width <= view.width && box.y + box.height <= view.height, 'keys are cut off');
  await page.keyboard.press('Escape');
  const nameless = await page.$$eval('button', (all) => all.filter((one) => !(one.ariaLabel || one.innerText).trim()).length);
  expect(nameless === 0, 'a button has no name');
  const wide = await page.$$eval('.panel', (all) => all.some((one) => one.scrollWidth > one.clientWidth));
  const outside = await page.$$eval('.panel button, .panel input', (all) => all.some((one) => {
    const at = one.getBoundingClientRect();
    return at.width > 0 && (at.left < 0 || at.top < 0 || at.right > innerWidth || at.bottom > innerHeight);
  }));
  expect(!wide && !outside, 'a panel is cut off');
}

// One finger moves the picture, two zoom it.
async function touch(page) {
  const session = await page.context().newCDPSession(page);
  const state = async () => (await page.getAttribute('#mesh', 'data-drawn')).split(' ').map(Number);
  const move = async (from, to) => {
    const before = await state();
    const send = (type, touchPoints) => session.send('Input.dispatchTouchEvent', { type, touchPoints });
    await send('touchStart', from);
    for (const share of [0.25, 0.5, 0.75, 1])
      await send('touchMove', from.map((at, k) => ({
        x: at.x + share * (to[k].x - at.x), y: at.y + share * (to[k].y - at.y), id: k })));
    await send('touchEnd', []);
    await page.waitForFunction((old) => document.querySelector('#mesh').dataset.drawn !== old, before.join(' '), { timeout: 5000 })
      .catch(() => { throw new Error('fingers change nothing'); });
    await page.waitForTimeout(200);  // all of them drawn
    return [before, await state()];
  };
  const { width, height } = page.viewportSize(), x = width / 2, y = height / 2;
  let [before, after] = await move([{ x, y, id: 0 }], [{ x: x + 60, y: y + 20, id: 0 }]);
  if (!(after[0] < before[0] && after[1] < before[1] && after[2] === before[2])) throw new Error('a finger does not move it');
  [before, after] = await move([{ x: x - 40, y, id: 0 }, { x: x + 40, y, id: 1 }],
    [{ x: x - 80, y, id: 0 }, { x: x + 80, y, id: 1 }]);
  if (Math.abs(after[2] / before[2] - 2) > 0.05) throw new Error(`two fingers zoom by ${after[2] / before[2]}, not by 2`);
  if (await page.evaluate(() => window.visualViewport.scale) !== 1) throw new Error('the browser zooms the page');
}

// One page for all files, and one on a phone: to open a page takes a second. Their faults are kept: what they say of errors, and what
// they ask the network for.
class Pages {
  constructor(browser) {
    this.browser = browser;
    this.faults = [];
  }

  async open(options) {
    const page = await this.browser.newPage(options);
    page.on('pageerror', (error) => this.faults.push(String(error)));
    page.on('console', (message) => { if (['error', 'warning'].includes(message.type())) this.faults.push(message.text()); });
    page.on('request', (request) => {
      if (!/^(file|data|about):/.test(request.url())) this.faults.push('asked for ' + request.url());
    });
    return page;
  }

  // On a large screen, and on a phone's, upright and on its side.
  async handleOnScreens(url) {
    await this.page.setViewportSize({ width: 1000, height: 750 });  // what has fewer pixels is drawn sooner
    await handle(this.page, url);
    await unfold(this.page, false);
    this.phone ??= await this.open({ hasTouch: true, isMobile: true, colorScheme: 'dark' });
    for (const [width, height] of [[390, 844], [844, 390]]) {
      await this.phone.goto('about:blank');
      await this.phone.setViewportSize({ width, height });
      await this.phone.goto(url, patience);
      await this.phone.waitForSelector('#mesh[data-drawn]', patience);
      await touch(this.phone);
      await unfold(this.phone, true);
    }
  }

  async show(file, screenshot) {
    const page = this.page ??= await this.open();
    const [path, part] = file.split('#');
    const url = pathToFileURL(resolve(path)).href;
    await page.goto('about:blank');
    if (path.endsWith('.html')) {
      await page.setViewportSize({ width: 1600, height: 1200 });
      await page.goto(`${url}#${part || 'native'}`, patience);
      await page.waitForSelector(part === 'original' ? '#mesh[data-drawn$=" 1"]' : '#mesh[data-drawn]', patience);
      writeFileSync(screenshot, await page.locator('#mesh').screenshot(patience));
      if (!part) await this.handleOnScreens(url);
    } else {
      const [, width, height] = /viewBox="0 0 (\d+) (\d+)"/.exec(readFileSync(file, 'latin1').slice(0, 1000));
      await page.setViewportSize({ width: Number(width), height: Number(height) });
      await page.goto(url, patience);
      writeFileSync(screenshot, await page.screenshot({ omitBackground: true, ...patience }));
    }
    if (this.faults.length > 0) throw new Error(this.faults.join('\n'));
  }
}

async function main([folder, ...words]) {
  if (words.length === 0 || words.length % 3 !== 0) throw new Error('usage: chromium.js FOLDER (FILE REFERENCE LEAST)...');
  const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM || '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-gpu-rasterization',
      '--force-color-profile=srgb'],
  });
  try {
    const pages = new Pages(browser);
    for (let n = 0; 3 * n < words.length; ++n) {
      const file = words[3 * n];
      await pages.show(file, `${folder}/${n}.png`).catch((error) => { throw new Error(`${file}: ${error.message || error}`); });
    }
  } finally {
    await browser.close();
  }
}

main(process.argv.slice(2)).catch((error) => {
  console.error(String(error.message || error));
  process.exit(1);
});
