// page.js - the page of web/ as its users have it: node page.js FOLDER HMESH PSNR [NAME], see page.sh
//
// Each test opens the page anew and uses its controls. An error of the page, and anything that it asks the network for once it is
// loaded, makes its test fail. No test waits for a time: they wait for what is to be seen.
'use strict';
const { execFileSync, spawn } = require('child_process');
const { mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } = require('fs');
const { tmpdir } = require('os');
const { join, resolve } = require('path');
const { pathToFileURL } = require('url');
const { deflateSync } = require('zlib');
const { chromium } = require('playwright-core');
const validator = require('gltf-validator');

const [folder, command, psnr, part = ''] = process.argv.slice(2);
const work = mkdtempSync(join(tmpdir(), 'hmesh-page-'));
const patience = { timeout: 120000 }; // ms
const DESKTOP = { viewport: { width: 1280, height: 800 } };
const PHONE = { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true };

const expect = (truth, what) => { if (!truth) throw new Error(what); };
const equal = (got, want, what) => expect(got === want, `${what}: ${got}, not ${want}`);

let browser, server, address; // of the page: a server's, or a file's

// --- pictures, drawn by the browser ---

async function picture(width, height, type = 'image/png', isOpaque = true) {
  const page = await browser.newPage();
  try {
    const text = await page.evaluate(([w, h, mime, opaque]) => {
      const canvas = document.createElement('canvas');
      [canvas.width, canvas.height] = [w, h];
      const context = canvas.getContext('2d');
      const sky = context.createLinearGradient(0, 0, w, h);
      sky.addColorStop(0, '#d04020');
      sky.addColorStop(1, '#2050c0');
      context.fillStyle = sky;
      if (opaque) context.fillRect(0, 0, w, h);
      for (let k = 0; k < 40; k++) {
        context.fillStyle = `hsl(${k * 47} 70% ${20 + (k * 13) % 60}%)`;
        context.beginPath();
        context.arc((k * 0.381966 % 1) * w, (k * 0.618034 % 1) * h, (0.02 + (k % 7) * 0.02) * Math.min(w, h), 0, 7);
        context.fill();
      }
      return canvas.toDataURL(mime).split(',')[1];
    }, [width, height, type, isOpaque]);
    return Buffer.from(text, 'base64');
  } finally {
    await page.close();
  }
}
// A JPEG file whose Exif says how it is turned.
function turned(jpeg, orientation) {
  const tiff = [0x4d, 0x4d, 0, 42, 0, 0, 0, 8, 0, 1, 1, 0x12, 0, 3, 0, 0, 0, 1, 0, orientation, 0, 0, 0, 0, 0, 0];
  const exif = [...Buffer.from('Exif\0\0', 'latin1'), ...tiff];
  return Buffer.concat([jpeg.subarray(0, 2), Buffer.from([0xff, 0xe1, 0, exif.length + 2, ...exif]), jpeg.subarray(2)]);
}
// A PNG file of so many grey pixels, dark at the left or above, light at the other end.
function grey(width, height) {
  const crc = (bytes) => {
    let value = ~0;
    for (const byte of bytes) {
      value ^= byte;
      for (let k = 0; k < 8; k++) value = (value >>> 1) ^ (value & 1 ? 0xedb88320 : 0);
    }
    return ~value;
  };
  const chunk = (type, bytes) => {
    const out = Buffer.concat([Buffer.alloc(4), Buffer.from(type), bytes, Buffer.alloc(4)]);
    out.writeUInt32BE(bytes.length);
    out.writeInt32BE(crc(out.subarray(4, -4)), out.length - 4);
    return out;
  };
  const head = Buffer.alloc(13), rows = Buffer.alloc(height * (width + 1));
  head.writeUInt32BE(width);
  head.writeUInt32BE(height, 4);
  head[8] = 8;
  for (let y = 0; y < height; y++)
    for (let x = 0; x < width; x++) rows[y * (width + 1) + 1 + x] = (256 * (x + y)) / (width + height);
  const chunks = [chunk('IHDR', head), chunk('IDAT', deflateSync(rows)), chunk('IEND', Buffer.alloc(0))];
  return Buffer.concat([Buffer.from('\x89PNG\r\n\x1a\n', 'latin1'), ...chunks]);
}
const sizeOfPng = (bytes) => [bytes.readUInt32BE(16), bytes.readUInt32BE(20)].join(' x ');

// --- the page ---

// use(page, faults) is a test's body.
async function withPage(options, use, prepare = async () => {}) {
  const context = await browser.newContext({ acceptDownloads: true, ...options });
  const page = await context.newPage();
  const faults = [];
  let isLoaded = false;
  page.on('pageerror', (error) => faults.push(String(error)));
  page.on('console', (message) => { if (['error', 'warning'].includes(message.type())) faults.push(message.text()); });
  context.on('request', (request) => {
    const url = request.url();
    if (isLoaded && !/^(blob|data):/.test(url) && url !== 'about:blank') faults.push(`asked for ${url} once it was loaded`);
    if (!url.startsWith('http://127.0.0.1:') && !/^(file|blob|data|about):/.test(url)) faults.push(`asked for ${url}`);
  });
  try {
    await prepare(page);
    await page.goto(address, patience);
    await page.waitForSelector('#samples button:nth-of-type(2)', patience);
    await page.waitForLoadState('networkidle', patience);
    isLoaded = true;
    await use(page);
    expect(faults.length === 0, faults.join('\n'));
  } finally {
    await context.close();
  }
}
const state = (page) => page.getAttribute('body', 'data-state');
const text = (page, id) => page.locator(`#${id}`).innerText();
const drawn = async (page) => (await page.getAttribute('#view', 'data-drawn')).split(' ').map(Number); // x, y, scale, edges, cut
const refined = (page) => page.waitForSelector('body[data-picture][data-state=done]', patience);
const vertices = async (page) => Number((await text(page, 'numbers')).split(' vertices')[0].replace(/\D/g, ''));
// Waits for a mesh of so many vertices, in the page's words.
const counted = (page, wanted) => page.waitForFunction(
  (want) => document.getElementById('numbers').textContent.startsWith(`${want} vertices`), wanted, patience);
const choose = (page, name, buffer, mimeType = 'image/png') => page.setInputFiles('#file', { name, mimeType, buffer });
const fault = async (page) => {
  await page.waitForSelector('#fault:not([hidden])', patience);
  return page.locator('#fault span').innerText();
};
async function opened(page, buffer, name = 'photo.png') {
  await choose(page, name, buffer);
  await refined(page);
}
// Another drawing than before() gave.
async function changes(page, act, what) {
  const before = await page.getAttribute('#view', 'data-drawn');
  await act();
  await page.waitForFunction((old) => document.getElementById('view').dataset.drawn !== old, before, { timeout: 20000 })
    .catch(() => { throw new Error(`${what} changes nothing`); });
}
// What the canvas shows, as PNG.
const shot = (page) => page.screenshot({ clip: { x: 200, y: 100, width: 800, height: 500 } });

async function saved(page, format) {
  if (await page.isHidden('#files')) await page.click('#save');
  const isSized = (one) => /\d/.test(document.querySelector(`#files [value=${one}] span`).textContent);
  await page.waitForFunction(isSized, format, patience);
  const size = await page.locator(`#files [value=${format}] span`).innerText();
  const [download] = await Promise.all([page.waitForEvent('download', patience), page.click(`#files [value=${format}]`)]);
  const file = join(work, download.suggestedFilename());
  await download.saveAs(file);
  return { file, size };
}

// What a program prints, and a space; nothing, which is said, where there is none.
function run(program, args) {
  try {
    return `${execFileSync(program || 'nothing', args)} `;
  } catch (error) {
    if (error.code !== 'ENOENT') throw error;
    console.log(`skipped: ${args.join(' ')}, for there is no ${program || 'such program'}`);
    return '';
  }
}

// --- tests: their names are what they show ---

const both = { // from a server, and from a file
  async 'a photo that is chosen is seen as draft, then refined'(page) {
    equal(await state(page), 'start', 'the state at first');
    expect(await page.isVisible('#choose') && await page.isHidden('#save'), 'the start shows no start');
    const efforts = await page.evaluate(() => {
      window.seen = [];
      new MutationObserver(() => window.seen.push(document.getElementById('doing').textContent))
        .observe(document.getElementById('doing'), { childList: true, characterData: true, subtree: true });
    }).then(() => opened(page, small)).then(() => page.evaluate(() => window.seen.join(' ')));
    for (const effort of ['Draft…', 'Refining…', 'Refined: normal'])
      expect(efforts.includes(effort), `${effort} was not seen, but: ${efforts}`);
    equal(await vertices(page), Number((await text(page, 'wanted')).replace(/\D/g, '')), 'vertices');
    expect(/^[\d,]+ vertices · [\d,]+ triangles · \d+\.\d dB$/.test(await text(page, 'numbers')), await text(page, 'numbers'));
    const name = await page.getAttribute('#view', 'aria-label');
    expect(/^photo: a mesh of [\d,]+ vertices/.test(name), `the picture is called ${name}`);
    const said = await page.locator('#status').textContent();
    expect(/vertices.*normal$/.test(said), `it was said: ${said}`);
    expect(await page.isHidden('#start') && await page.isVisible('#save'), 'the start stays');
  },

  async 'a photo can be dropped and pasted'(page) {
    const give = (type, name, id) => page.evaluate(([kind, file, base64, to]) => {
      const data = new DataTransfer();
      const bytes = Uint8Array.from(atob(base64), (one) => one.charCodeAt(0));
      if (file) data.items.add(new File([bytes], file, { type: 'image/png' }));
      const options = { bubbles: true, cancelable: true };
      const event = kind === 'paste' ? new ClipboardEvent(kind, { ...options, clipboardData: data })
        : new DragEvent(kind, { ...options, dataTransfer: data });
      (document.getElementById(to) ?? document.body).dispatchEvent(event);
      return event.defaultPrevented;
    }, [type, name, small.toString('base64'), id]);
    expect(await give('dragover', 'dropped.png'), 'the browser would open what is dropped');
    expect(await page.isVisible('#over'), 'where to drop it is not shown');
    await give('drop', 'dropped.png');
    expect(await page.isHidden('#over'), 'where to drop it stays');
    await refined(page);
    expect((await page.getAttribute('#view', 'aria-label')).startsWith('dropped:'), 'what was dropped is not shown');
    await give('paste', 'pasted.png');
    await page.waitForSelector('#view[aria-label^="pasted: a mesh"]', patience);
    await refined(page);
    await give('paste', '');
    equal(await fault(page), 'What was pasted holds no picture.', 'of text it is said');
    expect((await page.getAttribute('#view', 'aria-label')).startsWith('pasted: a mesh'), 'the mesh has gone');
    expect(await give('paste', 'count.png', 'count'), 'the slider takes what is pasted'); // it has the focus once it was dragged
    await page.waitForSelector('#view[aria-label^="count: a mesh"]', patience);
    await refined(page);
    expect(!await give('paste', '', 'seed'), 'no seed can be pasted');
    await give('drop', '.png');
    await page.waitForSelector('#view[aria-label^="photo: a mesh"]', { timeout: 20000 });
  },

  async 'a photo that cannot be read leaves the one before as it would have been'(page) {
    const good = await picture(1000, 750);
    // While the good one has no mesh yet, and with the slider moved while the bad one is read.
    for (const isMoved of [false, true]) {
      await page.evaluate((moved) => {
        const seen = new MutationObserver(() => {
          if (document.body.dataset.state !== 'refining') return;
          seen.disconnect();
          const data = new DataTransfer();
          data.items.add(new File(['no photo'], 'bad.txt'));
          document.body.dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true }));
          if (moved) document.getElementById('count').dispatchEvent(new Event('input'));
        });
        seen.observe(document.body, { attributeFilter: ['data-state'] });
      }, isMoved);
      await choose(page, 'good.png', good);
      await fault(page);
      expect(['refining', 'done'].includes(await state(page)), `it is ${await state(page)}`);
      await page.waitForSelector('#view[aria-label^="good: a mesh"]', patience);
      await refined(page);
      equal(await text(page, 'doing'), 'Refined: normal', 'the page says');
      await page.keyboard.press('Escape');
    }
  },

  async 'the slider sets the number of vertices'(page) {
    await opened(page, small);
    let last = await vertices(page);
    for (const [key, isMore] of [['End', true], ['Home', false], ['PageUp', true], ['ArrowRight', true]]) {
      await page.focus('#count');
      await page.keyboard.press(key);
      const wanted = await text(page, 'wanted');
      await counted(page, wanted);
      const now = Number(wanted.replace(/\D/g, ''));  // what is shown goes on changing: meshes on the way have others
      expect(isMore ? now > last : now < last, `${key} makes ${now} vertices of ${last}`);
      equal(await page.getAttribute('#count', 'aria-valuetext'), `${wanted} vertices`, 'the slider says');
      last = now;
    }
    await page.locator('#count').evaluate((slider) => { // dragged: many places at once
      for (let k = 20; k <= 120; k++) {
        slider.value = k;
        slider.dispatchEvent(new Event('input'));
      }
    });
    const wanted = await text(page, 'wanted');
    await counted(page, wanted);
    await refined(page);
  },

  async 'edges, zoom, pan and divider change what is drawn'(page) {
    await opened(page, small);
    await page.waitForTimeout(400); // the last mesh has been faded in
    const plain = await shot(page);
    await changes(page, () => page.click('#edges'), 'Edges');
    equal(await page.getAttribute('#edges', 'aria-pressed'), 'true', 'aria-pressed');
    expect(!plain.equals(await shot(page)), 'there are no edges to be seen');
    await changes(page, () => page.keyboard.press('w'), 'w');
    expect(plain.equals(await shot(page)), 'edges stay');
    const fitted = (await drawn(page)).slice(0, 3).join();
    for (const key of ['+', '-', '1', 'ArrowLeft', 'ArrowUp', 'ArrowRight', 'ArrowDown', 'o', '0'])
      await changes(page, () => page.keyboard.press(key), `the key ${key}`);
    equal((await drawn(page)).slice(0, 3).join(), fitted, '0 fits');
    for (const id of ['in', 'out', 'in']) await changes(page, () => page.click(`#${id}`), `the button ${id}`);
    await page.mouse.move(640, 300);
    await changes(page, () => page.mouse.wheel(0, -300), 'the wheel');
    await changes(page, async () => {
      await page.mouse.move(400, 300);
      await page.mouse.down();
      await page.mouse.move(460, 340);
      await page.mouse.up();
    }, 'dragging');
    await changes(page, () => page.click('#fit'), 'the button fit');
    equal((await drawn(page)).slice(0, 3).join(), fitted, 'the button fits');
  },

  async 'the divider can be dragged and moved by keys, and its tags never overlap'(page) {
    await opened(page, small);
    const boxes = () => page.evaluate(() => Object.fromEntries(['before', 'after', 'divider'].map((id) => {
      const element = document.getElementById(id);
      const { left, right } = element.getBoundingClientRect();
      return [id, { left, right, isShown: !element.classList.contains('away') }];
    })));
    await page.focus('#divider');
    const seen = new Set();
    await changes(page, () => page.keyboard.press('Home'), 'Home');
    for (let k = 0; k <= 50; k++) {
      const { before, after } = await boxes();
      expect(!before.isShown || !after.isShown || before.right < after.left, `tags overlap at step ${k}`);
      seen.add(`${before.isShown} ${after.isShown}`);
      equal(await page.getAttribute('#divider', 'aria-valuenow'), String(2 * k), 'the divider says');
      if (k < 50) await changes(page, () => page.keyboard.press('ArrowRight'), 'an arrow key');
    }
    expect(seen.has('false true') && seen.has('true true') && seen.has('true false'), `of tags are shown: ${[...seen]}`);
    const at = await page.locator('#divider').boundingBox();
    await page.mouse.move(at.x + at.width / 2, at.y + at.height / 2);
    await page.mouse.down();
    await changes(page, () => page.mouse.move(640, 300), 'dragging the divider');
    await page.mouse.up();
    const [, , , , cut] = await drawn(page);
    expect(Math.abs(cut - 640) <= 2, `the divider is at ${cut}, not at 640`);
  },

  async 'every file that is saved is read by another program, and as large as the menu says'(page) {
    await opened(page, small, 'a photo.png');
    await page.click('#save');
    equal(await page.getAttribute('#save', 'aria-expanded'), 'true', 'aria-expanded');
    const files = {};
    for (const format of ['hmc', 'glb', 'svg', 'pdf', 'html', 'ply', 'png']) {
      const { file, size } = await saved(page, format);
      equal(file, join(work, `a photo.${format}`), 'the name');
      const bytes = statSync(file).size;
      const [, value, unit] = /^([\d.]+) (B|kB|MB)$/.exec(size) ?? [];
      const said = Number(value) * { B: 1, kB: 1e3, MB: 1e6 }[unit];
      expect(Math.abs(said - bytes) <= 0.06 * bytes, `of ${bytes} bytes the menu says ${size}`);
      files[format] = file;
    }
    const [wide, high] = [320, 240];
    equal(sizeOfPng(readFileSync(files.png)), `${wide} x ${high}`, 'the picture');
    // dB against the picture that the page draws; poppler and librsvg paint more of a face than its pixels (docs/formats.md).
    const likeness = (other, least) => run(psnr, [join(work, other), files.png, String(least)]);
    if (run(command, [files.hmc, '--render', join(work, 'hmc.png')])) likeness('hmc.png', 45); // rounded positions and colors
    if (run('pdftoppm', ['-r', '72', '-singlefile', files.pdf, join(work, 'pdf')])) likeness('pdf.ppm', 28);
    if (run('rsvg-convert', ['--unlimited', '--output', join(work, 'svg.png'), files.svg])) likeness('svg.png', 28);
    const { issues } = await validator.validateBytes(new Uint8Array(readFileSync(files.glb)));
    equal(issues.numErrors + issues.numWarnings, 0, 'faults of the .glb');
    const info = run('assimp', ['info', files.ply]);
    if (info) equal(Number(/^Vertices:\s+(\d+)/m.exec(info)[1]), await vertices(page), 'vertices of the .ply');
    const shown = await browser.newPage();
    await shown.goto(`${pathToFileURL(files.html).href}#native`, patience);
    await shown.waitForSelector('#mesh[data-drawn]', patience);
    writeFileSync(join(work, 'html.png'), await shown.locator('#mesh').screenshot());
    await shown.close();
    likeness('html.png', 45);
  },

  async 'what cannot be read is refused with a sentence, and what was there stays'(page) {
    const refusals = [
      ['notes.png', Buffer.from('no picture at all'), 'notes.png is not a picture that this browser can read, or it is damaged.'],
      ['empty.jpg', Buffer.alloc(0), 'empty.jpg is empty.'],
      ['IMG_1.HEIC', Buffer.from('\0\0\0\x24ftypheic\0\0\0\0mif1heic', 'latin1'),
        'IMG_1.HEIC is a HEIC photo, which this browser cannot read: save it as JPEG or PNG first.'],
      ['half.png', small.subarray(0, 60), 'half.png is not a picture that this browser can read, or it is damaged.'],
    ];
    for (const [name, bytes, sentence] of refusals) {
      await choose(page, name, bytes);
      await page.waitForFunction((want) => document.querySelector('#fault span').textContent === want, sentence, patience)
        .catch(async () => { throw new Error(`of ${name} it is said: ${await fault(page)}`); });
      equal(await state(page), 'start', 'the state');
      expect(await page.isVisible('#choose'), 'the start has gone');
    }
    await opened(page, small);
    expect(await page.isHidden('#fault'), 'the sentence stays');
    const before = await text(page, 'numbers');
    await choose(page, ...refusals[0]);
    equal(await fault(page), refusals[0][2], 'it is said');
    equal(await text(page, 'numbers'), before, 'the figures');
    equal(await state(page), 'done', 'the state');
    await page.keyboard.press('Escape');
    expect(await page.isHidden('#fault'), 'Escape does not close the sentence');
    expect((await saved(page, 'ply')).size, 'the mesh cannot be saved');
  },

  async 'refining can be stopped, and begun anew'(page) {
    await page.evaluate(() => { document.getElementById('effort').value = 'best'; });
    await choose(page, 'photo.png', small);
    await page.waitForFunction(() => /vertices/.test(document.getElementById('numbers').textContent), null, patience);
    await page.click('#stop');
    equal(await state(page), 'done', 'the state');
    equal(await text(page, 'doing'), 'Stopped: this mesh is kept', 'it is said');
    const kept = await text(page, 'numbers');
    expect((await saved(page, 'glb')).size, 'what is kept cannot be saved');
    equal(await text(page, 'numbers'), kept, 'the figures');
    await page.click('#more');
    await page.selectOption('#effort', 'fast');
    await refined(page);
    await page.waitForFunction(() => document.getElementById('doing').textContent === 'Refined: fast', null, patience);
  },

  async 'what is stopped before there is a draft leads back to the start'(page) {
    await choose(page, 'large.png', large);
    await page.waitForSelector('body[data-state=reading], body[data-state=refining]', patience);
    await page.keyboard.press('Escape');
    await page.waitForSelector('body[data-state=start], body[data-state=done]', patience);
    if (await state(page) === 'start') expect(await page.isVisible('#choose'), 'there is no start');
    await opened(page, small);
  },

  async 'it is all done by keys'(page) {
    const active = () => page.evaluate(() => {
      const { id, value, tagName } = document.activeElement;
      return id || value || tagName;
    });
    await page.keyboard.press('Tab');
    equal(await active(), 'choose', 'first comes');
    const chosen = page.waitForEvent('filechooser', patience);
    await page.evaluate(() => {}); // the browser has heard that it is waited for
    await page.keyboard.press('Enter');
    const chooser = await chosen;
    await chooser.setFiles({ name: 'keys.png', mimeType: 'image/png', buffer: small });
    await refined(page);
    await page.evaluate(() => document.activeElement.blur());
    const reached = new Set();
    for (let k = 0; k < 24; k++) {
      await page.keyboard.press('Tab');
      reached.add(await active());
    }
    reached.delete('BODY');
    equal([...reached].sort().join(), 'count,divider,edges,fit,in,more,new,out,save,view', 'the keys reach');
    await page.focus('#save');
    await page.keyboard.press('Enter');
    equal(await active(), 'hmc', 'the menu begins at');
    await page.keyboard.press('ArrowUp');
    equal(await active(), 'png', 'and ends at');
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('ArrowDown');
    const [download] = await Promise.all([page.waitForEvent('download', patience), page.keyboard.press('Enter')]);
    equal(download.suggestedFilename(), 'keys.glb', 'saved is');
    equal(await active(), 'save', 'the menu leaves the focus at');
    for (const [key, popup, button] of [['m', 'settings', 'more'], ['s', 'files', 'save']]) {
      await page.keyboard.press(key);
      expect(await page.isVisible(`#${popup}`), `${key} does not open`);
      await page.keyboard.press('Escape');
      expect(await page.isHidden(`#${popup}`), `Escape does not close after ${key}`);
      equal(await active(), button, 'Escape leaves the focus at');
    }
  },

  async 'the accessibility tree has the controls by role and name, in the order of the keys'(page) {
    const session = await page.context().newCDPSession(page);
    const controls = async () => {
      const { nodes } = await session.send('Accessibility.getFullAXTree');
      const isFocusable = ({ properties = [] }) => properties.some(({ name, value }) => name === 'focusable' && value.value);
      return nodes.filter((node) => !node.ignored && isFocusable(node) && node.role.value !== 'RootWebArea')
        .map(({ role, name, value }) => [role.value, name.value, value?.value].filter((word) => word !== undefined && word !== '').join(' '));
    };
    equal((await controls()).join('; '), 'image No picture yet; button Choose a photo; button Hills in the evening; button Balls on a table', 'the start has');
    await opened(page, small);
    await page.waitForSelector('#divider', { state: 'visible', ...patience });
    const [view, ...others] = await controls(), bar = ['button Edges', 'button More', 'button New', 'button Save'];
    const zoom = ['button Zoom out', 'button Fit the window', 'button Zoom in'];
    expect(/^image photo: a mesh of \d+ vertices and \d+ triangles$/.test(view), `the view is ${view}`);
    const withoutValues = (list) => list.map((line) => line.replace(/ \d+$/, '')).join('; ');
    equal(withoutValues(others), ['slider Original or mesh', ...zoom, 'slider Vertices', ...bar].join('; '), 'the work has');
    await page.focus('#view');
    const order = [];
    for (let k = 0; k < 9; k++) {
      await page.keyboard.press('Tab');
      order.push(await page.evaluate(() => document.activeElement.id));
    }
    equal(order.join(), 'divider,out,fit,in,count,edges,more,new,save', 'the keys go by');
    await page.keyboard.press('Enter');
    const menu = (await controls()).filter((line) => line.startsWith('menuitem')).map((line) => line.split(' ')[1]);
    equal(menu.join(), '.hmc,.glb,.svg,.pdf,.html,.ply,.png', 'the menu has');
    await page.keyboard.press('Escape');
    await page.click('#more');
    const more = (await controls()).filter((line) => /Refine up to|Scale photos to|Seed/.test(line)).map((line) => line.split(' ')[0]);
    equal(more.join(), 'combobox,combobox,spinbutton', 'more has');
  },

  async 'everything has a name, and is 44 px high'(page) {
    await opened(page, small);
    await page.click('#more');
    await faultlessLayout(page);
    await page.keyboard.press('Escape');
    await page.click('#save');
    await faultlessLayout(page);
  },
};

// Names of what can be used, its size, and that nothing is cut off.
async function faultlessLayout(page) {
  const used = 'button, input, select, [role=slider]';
  const faults = await page.evaluate((selector) => [...document.querySelectorAll(selector)].flatMap((one) => {
    const box = one.getBoundingClientRect();
    if (!one.checkVisibility({ visibilityProperty: true }) || one.id === 'file') return [];
    const who = one.id || one.value || one.outerHTML;
    const hasName = one.ariaLabel || one.innerText?.trim() || one.labels?.[0]?.innerText.trim();
    return [
      hasName ? '' : `${who} has no name`,
      box.width >= 44 && box.height >= 44 ? '' : `${who} is ${box.width} x ${box.height} px`,
      box.left >= 0 && box.right <= innerWidth && box.top >= 0 && box.bottom <= innerHeight ? '' : `${who} is cut off`,
    ].filter(Boolean);
  }), used);
  expect(faults.length === 0, faults.join('; '));
  const [figures, zoom] = await Promise.all(['#figures', '#zoom'].map((id) => page.locator(id).boundingBox()));
  const right = figures.x + figures.width;
  expect(right <= zoom.x, `figures up to ${right} px are under the zoom from ${zoom.x} px on`);
  const isWide = await page.evaluate(() => document.documentElement.scrollWidth > innerWidth || visualViewport.scale !== 1);
  expect(!isWide, 'the page is wider than the window');
}

const single = { // each with a context of its own
  async 'on a phone it fits, and fingers move and zoom'() {
    for (const colorScheme of ['light', 'dark'])
      await withPage({ ...PHONE, colorScheme }, async (page) => {
        await faultlessLayout(page);
        await opened(page, small);
        await page.focus('#count');
        await page.keyboard.press('End'); // figures of four digits
        await counted(page, await text(page, 'wanted'));
        await refined(page);
        await faultlessLayout(page);
        for (const id of ['more', 'save']) {
          await page.tap(`#${id}`);
          await faultlessLayout(page);
          await page.tap(`#${id}`);
          expect(await page.isHidden('.popup'), `a second tap does not close ${id}`);
        }
        const session = await page.context().newCDPSession(page);
        const move = async (from, to) => {
          const send = (type, touchPoints) => session.send('Input.dispatchTouchEvent', { type, touchPoints });
          await send('touchStart', from);
          for (const share of [0.25, 0.5, 0.75, 1])
            await send('touchMove', from.map((at, id) => (
              { id, x: at.x + share * (to[id].x - at.x), y: at.y + share * (to[id].y - at.y) })));
          await send('touchEnd', []);
        };
        const before = await drawn(page);
        await changes(page, () => move([{ id: 0, x: 100, y: 420 }], [{ id: 0, x: 160, y: 440 }]), 'a finger');
        await page.waitForFunction((x) => Number(document.getElementById('view').dataset.drawn.split(' ')[0]) < x, before[0]);
        await changes(page, () => move([{ id: 0, x: 60, y: 420 }, { id: 1, x: 120, y: 420 }],
          [{ id: 0, x: 30, y: 420 }, { id: 1, x: 150, y: 420 }]), 'two fingers');
        const isTwice = (scale) => Math.abs(Number(document.getElementById('view').dataset.drawn.split(' ')[2]) / scale - 2) < 0.1;
        await page.waitForFunction(isTwice, before[2], { timeout: 20000 })
          .catch(async () => { throw new Error(`two fingers zoom by ${(await drawn(page))[2] / before[2]}, not by 2`); });
        await faultlessLayout(page);
      });
  },

  async 'a large photo is scaled, which is said, or not where that is asked for'() {
    await withPage(DESKTOP, async (page) => {
      await page.evaluate(() => { document.getElementById('effort').value = 'draft'; });
      await opened(page, large, 'large.png');
      equal(await text(page, 'scaled'), 'Scaled from 2,400 × 1,800 to 1,633 × 1,225 px', 'it is said');
      equal(sizeOfPng(readFileSync((await saved(page, 'png')).file)), '1633 x 1225', 'the picture');
      await page.click('#more');
      await page.selectOption('#limit', 'Infinity');
      await page.waitForSelector('#scaled', { state: 'hidden', ...patience });
      await refined(page);
      equal(sizeOfPng(readFileSync((await saved(page, 'png')).file)), '2400 x 1800', 'the picture');
    });
  },

  async 'the size that photos are scaled to is that of the photo which is read just then, too'() {
    await withPage(DESKTOP, async (page) => {
      await page.evaluate(() => { document.getElementById('effort').value = 'draft'; });
      await opened(page, small, 'small.png');
      await page.evaluate(() => {
        const seen = new MutationObserver(() => {
          seen.disconnect();
          const limit = document.getElementById('limit');
          limit.value = '0.5';
          limit.dispatchEvent(new Event('change'));
        });
        seen.observe(document.body, { attributeFilter: ['data-state'] });
      });
      await choose(page, 'large.png', large);
      await refined(page);
      expect((await page.getAttribute('#view', 'aria-label')).startsWith('large: a mesh'), 'the one before is shown again');
      equal(await text(page, 'scaled'), 'Scaled from 2,400 × 1,800 to 816 × 612 px', 'it is said');
    });
  },

  async 'a menu that is opened while a photo is read closes when that is there, before it has a mesh'() {
    await withPage(DESKTOP, async (page) => {
      await opened(page, small, 'small.png');
      await page.evaluate(() => {
        const [view, files] = ['view', 'files'].map((id) => document.getElementById(id));
        new MutationObserver((_, seen) => {
          seen.disconnect();
          document.getElementById('save').click();
          window.wasOpen = !files.hidden;
        }).observe(document.body, { attributeFilter: ['data-state'] });
        new MutationObserver((_, seen) => {
          if (view.ariaLabel !== 'large: no mesh yet') return;
          seen.disconnect();
          window.isOpen = !files.hidden;
        }).observe(view, { attributeFilter: ['aria-label'] });
      });
      await choose(page, 'large.png', large);
      await refined(page);
      expect(await page.evaluate('wasOpen'), 'it does not open');
      expect(await page.evaluate('!isOpen'), 'it stays open');
    });
  },

  async 'of a photo with longer sides than a canvas may have a smaller one is meshed, which is said'() {
    await withPage(DESKTOP, async (page) => {
      await page.evaluate(() => { document.getElementById('effort').value = 'draft'; });
      const photos = [[65536, 2, 'Scaled from 65,536 × 2 to 65,535 × 2 px'], [2, 70000, 'Scaled from 2 × 70,000 to 2 × 65,535 px']];
      for (const [width, height, sentence] of photos) {
        await opened(page, grey(width, height), `long${width}.png`);
        await page.waitForSelector(`#view[aria-label^="long${width}: a mesh"]`, { timeout: 20000 });
        equal(await page.isVisible('#scaled') && await text(page, 'scaled'), sentence, 'it is said');
        const figures = await text(page, 'numbers');
        expect(/ dB$/.test(figures), `it is not drawn: ${figures}`); // nothing would be met exactly
      }
    });
  },

  async 'pictures are turned as Exif says, may have alpha, and may be tiny'() {
    await withPage(DESKTOP, async (page) => {
      const jpeg = await picture(60, 40, 'image/jpeg');
      for (const [orientation, size] of [[1, '60 x 40'], [6, '40 x 60'], [3, '60 x 40'], [8, '40 x 60']]) {
        await choose(page, `turned${orientation}.jpg`, turned(jpeg, orientation), 'image/jpeg');
        await page.waitForSelector(`#view[aria-label^="turned${orientation}: a mesh"]`, patience);
        await refined(page);
        equal(sizeOfPng(readFileSync((await saved(page, 'png')).file)), size, `orientation ${orientation}`);
      }
      await opened(page, await picture(160, 120, 'image/png', false), 'alpha.png');
      await page.waitForSelector('#view[aria-label^="alpha: a mesh"]', patience);
      const { issues } = await validator.validateBytes(new Uint8Array(readFileSync((await saved(page, 'glb')).file)));
      equal(issues.numErrors + issues.numWarnings, 0, 'faults of the .glb with alpha');
      for (const [width, height] of [[1, 1], [2, 1], [3, 200]]) {
        await choose(page, `tiny${width}.png`, await picture(width, height));
        await page.waitForSelector(`#view[aria-label^="tiny${width}: a mesh"]`, patience);
        await refined(page);
        equal(sizeOfPng(readFileSync((await saved(page, 'png')).file)), `${width} x ${height}`, 'a tiny picture');
      }
    });
  },

  async 'the samples are drawn and meshed'() {
    await withPage(DESKTOP, async (page) => {
      await page.click('#samples button:nth-of-type(2)');
      await refined(page);
      expect(await vertices(page) > 0, 'there is no mesh');
    });
  },

  async 'without WebGL pixels are drawn'() {
    await withPage(DESKTOP, async (page) => {
      await opened(page, small);
      await changes(page, () => page.click('#edges'), 'Edges');
      await page.waitForFunction(() => {
        const view = document.getElementById('view');
        const [, , , , cut] = view.dataset.drawn.split(' ').map(Number);
        const row = view.getContext('2d').getImageData(cut + 4, Math.round(view.height / 3), 200, 1).data;
        return new Set(new Uint32Array(row.buffer)).size > 20; // not the ground alone
      }, null, patience);
    }, (page) => page.addInitScript(() => {
      const { getContext } = HTMLCanvasElement.prototype;
      HTMLCanvasElement.prototype.getContext = function only(kind, ...rest) {
        return kind === '2d' ? getContext.call(this, kind, ...rest) : null;
      };
    }));
  },

  async 'a lost context of WebGL is restored'() {
    await withPage({ ...DESKTOP, reducedMotion: 'reduce' }, async (page) => {
      await opened(page, small);
      const before = await shot(page);
      await page.evaluate(async () => {
        const view = document.getElementById('view');
        const loss = view.getContext('webgl2').getExtension('WEBGL_lose_context');
        await new Promise((resolve) => {
          view.addEventListener('webglcontextlost', resolve, { once: true });
          loss.loseContext();
        });
        await new Promise((resolve) => {
          view.addEventListener('webglcontextrestored', resolve, { once: true });
          setTimeout(() => loss.restoreContext());
        });
      });
      for (let k = 0; k < 200 && !before.equals(await shot(page)); k++);
      expect(before.equals(await shot(page)), 'another picture is drawn');
    });
  },
};

// --- the run ---

let small, large;
const serve = () => new Promise((found, lost) => {
  const program = join(__dirname, '../../web/serve.mjs');
  server = spawn(process.execPath, [program, folder, '0'], { stdio: ['ignore', 'pipe', 'inherit'] });
  server.on('exit', () => lost(new Error('the server ended')));
  server.stdout.once('data', (line) => found(String(line).trim()));
});

async function main() {
  browser = await chromium.launch({
    executablePath: process.env.CHROMIUM || '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--force-color-profile=srgb'],
  });
  small = await picture(320, 240);
  large = await picture(2400, 1800);
  const places = { server: await serve(), file: pathToFileURL(resolve(folder, 'hmesh.html')).href };
  let failures = 0;
  const attempt = async (name, test) => {
    if (!name.includes(part)) return;
    try {
      await test();
      console.log(`passed: ${name}`);
    } catch (error) {
      failures++;
      console.log(`FAILED: ${name}: ${error.message}`);
    }
  };
  for (const [place, url] of Object.entries(places)) {
    address = url;
    for (const [name, test] of Object.entries(both)) await attempt(`${place}: ${name}`, () => withPage(DESKTOP, test));
  }
  address = places.server;
  for (const [name, test] of Object.entries(single)) await attempt(name, test);
  return failures;
}

main().catch((error) => {
  console.error(error);
  return 1;
}).then(async (failures) => {
  await browser?.close();
  server?.kill();
  rmSync(work, { recursive: true, force: true });
  process.exitCode = failures > 0 ? 1 : 0;
});
