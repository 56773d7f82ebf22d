// Placeholders: the mesh that the library reads from the same bytes, whatever the bytes; pictures of it; files that are read for them; the
// command that writes them, and the page that shows them.
import assert from 'node:assert/strict';
import { execFile, spawn } from 'node:child_process';
import { chmod, lstat, mkdtemp, open, readFile, rm, stat, symlink, writeFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { promisify } from 'node:util';
import { runInNewContext } from 'node:vm';
import { deflateSync } from 'node:zlib';
import { jpegs } from './jpegs.mjs';
import { openPage, serve, startBrowser } from './browser.mjs';
import { picture } from './pictures.mjs';

const npm = process.env.HMESH_NPM, from = (file) => import(new URL(file, pathToFileURL(`${npm}/`)));
const { decode, toDataURL, toPixels } = await from('placeholder.js');
const { MOST_POINTS } = await from('bare.js');
const { encode, toText } = await from('encoder.js');
const { readPng } = await from('png.js');
const { readJpeg } = await from('jpeg.js');
const { shrink } = await from('resample.js');
const { Hmesh, compileCompact, load } = await from('core.node.js');
const hmesh = await load(), encoder = new Hmesh(await compileCompact());

// What C++ makes of the bytes, or null.
function readByLibrary(bytes) {
  try {
    return hmesh.read(bytes, { bare: true });
  } catch (error) {
    assert.equal(error.name, 'HmeshError');
    return null;
  }
}

function assertSame(bytes, told) {
  const here = decode(bytes), there = readByLibrary(bytes);
  assert.equal(here === null, there === null, `${told}: ${Buffer.from(bytes).toString('base64')}`);
  if (!here) return false;
  for (const name of ['positions', 'colors', 'indices', 'width', 'height', 'channels', 'premultiplied', 'vertices', 'faces'])
    assert.deepEqual(here[name], there[name], `${told}, ${name}`);
  return true;
}

// Files of the C++ writer: from 4 vertices to hundreds, sides from 1 px, any step of the lattice and of colours, with and without alpha.
function* manyFiles() {
  const sizes = [[1, 1], [2, 9], [7, 3], [16, 16], [40, 30], [61, 83], [200, 128]], steps = [0, 1, 60, 300, 4095];
  for (const [width, height] of sizes)
    for (const alpha of [false, true])
      for (const share of [0, 0.01, 0.05]) {
        const vertices = Math.max(4, Math.min(500, Math.round(share * width * height)));
        const mesh = hmesh.meshImage(picture(width, height, { alpha }), { vertices, effort: 'draft' });
        for (const colorStep of steps)
          for (const lattice of [1, 3]) {
            try {
              yield [hmesh.write(mesh, 'hmc', { bare: true, lattice, colorStep }), `${width} x ${height}, ${vertices}, ${lattice}, ${colorStep}`];
            } catch (error) {
              assert.match(error.message, /lattice is too coarse/);
            }
          }
      }
}
const files = [...manyFiles()];
for (const bytes of [300, 1000]) files.push([encode(encoder, picture(200, 128), { bytes }), `200 x 128 in ${bytes} bytes`]);

test('decode() gives the mesh that the library reads, bit for bit, from hundreds of files of the library', () => {
  assert.ok(files.length >= 300, `${files.length} files`);
  for (const [bytes, told] of files) assert.ok(assertSame(bytes, told), told);
  const most = Math.max(...files.map(([bytes]) => decode(bytes).vertices));
  assert.ok(most > 300, `${most} vertices at most`);
});

test('bytes that are cut, lengthened, flipped or random are a mesh where the library has that mesh, and else null', () => {
  let state = 1, meshes = 0;
  const random = (below) => {
    state = (Math.imul(state, 1103515245) + 12345) & 0x7fffffff;
    return (state >> 8) % below;
  };
  for (const [bytes, told] of files.filter((_, k) => k % 12 === 0)) {
    for (let k = 0; k < bytes.length; k += 1 + (bytes.length >> 6)) assertSame(bytes.slice(0, k), `${told}, cut at ${k}`);
    assertSame(Uint8Array.of(...bytes, 0), `${told}, and a zero`);
    for (let k = 0; k < 40; k++) {
      const other = bytes.slice();
      other[random(other.length)] ^= 1 << random(8);
      meshes += assertSameOrLarge(other, `${told}, a bit flipped`);
    }
  }
  for (let k = 0; k < 3000; k++) {
    const bytes = Uint8Array.from({ length: random(60) }, () => random(256));
    bytes.set([0x10 + random(16), 1 + random(90), 1 + random(90), 1, random(128)].slice(0, bytes.length));
    assertSameOrLarge(bytes, 'random bytes');
  }
  assert.ok(meshes > 10, `${meshes} meshes of flipped bits`);
});

// As assertSame(), but for what is larger than a placeholder may be.
function assertSameOrLarge(bytes, told) {
  const there = readByLibrary(bytes);
  if (there && (there.vertices > MOST_POINTS || there.width > 4096 || there.height > 4096)) {
    assert.equal(decode(bytes), null);
    return false;
  }
  return assertSame(bytes, told);
}

test('bytes of another realm, such as a frame, are as good, and so is a Buffer', () => {
  for (const make of [(bytes) => Buffer.from(bytes), (bytes) => runInNewContext('Uint8Array').from(bytes)]) {
    assert.deepEqual(decode(make(files[20][0])), decode(files[20][0]));
    assert.equal(toDataURL(make(files[20][0])), toDataURL(files[20][0]));
  }
});

test('anything that is no placeholder is null, and nothing is thrown', () => {
  const good = toText(files[20][0]);
  assert.ok(decode(good));
  assert.deepEqual(decode(good), decode(files[20][0]));
  assert.deepEqual(decode(Buffer.from(files[20][0]).toString('base64')), decode(good));
  const texts = ['', ' ', 'a', '=', '====', '\0', 'null', '\u{1F600}', '\ud800', 'ä'.repeat(50), '<img>', 'A'.repeat(4096), 'A'.repeat(1e6), `${good}é`,
    `${good}!`, '-_-_', '////'];
  for (const text of texts) assert.equal(decode(text), null, text.slice(0, 20));
  for (let k = 0; k < good.length; k++) assert.doesNotThrow(() => toDataURL(good.slice(0, k)));
  for (const value of [undefined, null, 42, NaN, true, {}, [], [16, 1, 1], { length: 4 }, { length: NaN }, Symbol.iterator, () => 0, new Float32Array(9),
    new Uint8Array(0), new Uint8Array(4097), new ArrayBuffer(20)]) {
    assert.equal(decode(value), null);
    assert.equal(toDataURL(value), null);
  }
});

test('a mesh of more points than a placeholder may have is null', () => {
  const columns = 40, positions = [], indices = [];
  for (let y = 0; y <= columns; y++) for (let x = 0; x <= columns; x++) positions.push(x, y);
  for (let y = 0; y < columns; y++)
    for (let x = 0; x < columns; x++) {
      const a = y * (columns + 1) + x, b = a + columns + 1;
      indices.push(a, a + 1, b, a + 1, b + 1, b);
    }
  const mesh = { positions: Float32Array.from(positions), colors: new Uint8Array(positions.length / 2 * 3), indices: Uint32Array.from(indices), width: columns,
    height: columns };
  const bytes = hmesh.write(mesh, 'hmc', { bare: true });
  assert.equal(readByLibrary(bytes).vertices, 1681);
  assert.ok(1681 > MOST_POINTS && bytes.length < 1000);
  assert.equal(decode(bytes), null);
});

test('a size scales the mesh, and one that is none is not heeded', () => {
  const [bytes] = files[20], mesh = decode(bytes), large = decode(bytes, { width: 10 * mesh.width, height: 3 * mesh.height });
  assert.deepEqual([large.width, large.height], [10 * mesh.width, 3 * mesh.height]);
  assert.deepEqual([...large.positions], [...mesh.positions].map((at, k) => at * (k % 2 ? 3 : 10)));
  for (const size of [{}, { width: NaN, height: 1 }, { width: -1, height: 5 }, { width: Infinity, height: 5 }, { width: '', height: 5 }])
    assert.deepEqual(decode(bytes, size), mesh);
});

// Two faces over 8 x 8 px, of one colour each corner.
const flat = (colors, channels, more = {}) => ({ positions: Float32Array.of(0, 0, 8, 0, 8, 8, 0, 8), indices: Uint32Array.of(0, 1, 2, 0, 2, 3),
  colors: Uint8Array.from(colors), channels, width: 8, height: 8, premultiplied: false, linear: false, ...more });

test('toPixels() draws what the library draws, softened or not, and knows alpha and linear light', () => {
  const mesh = decode(files.find(([, told]) => told.startsWith('40 x 30, 60') || told.startsWith('40 x 30, 12'))[0]), drawn = hmesh.render(mesh, { width: 40, height: 30 }).data;
  const here = toPixels(mesh, { pixels: 40, softness: 0 });
  assert.deepEqual([here.width, here.height], [40, 30]);
  let off = 0;
  here.data.forEach((value, i) => { off += Math.abs(value - drawn[i]) > 1; });
  assert.ok(off < drawn.length / 50, `${off} differ`);  // of sides that pass centres of pixels any face may be drawn last
  const of = (one, softness = 2) => [...toPixels(one, { pixels: 8, softness }).data.slice(0, 4)];
  assert.deepEqual(of(flat([...Array(4)].flatMap(() => [10, 20, 30]), 3)), [10, 20, 30, 255]);
  assert.deepEqual(of(flat([...Array(4)].flatMap(() => [100, 50, 0, 128]), 4)), [100, 50, 0, 128]);
  assert.deepEqual(of(flat([...Array(4)].flatMap(() => [100, 50, 0, 200]), 4, { premultiplied: true })), [128, 64, 0, 200]);
  const slope = [0, 0, 0, 255, 255, 255, 255, 255, 255, 0, 0, 0];
  const middle = (more) => toPixels(flat(slope, 3, more), { pixels: 8, softness: 0 }).data[4 * 4];
  assert.equal(middle({}), 143);  // 9/16
  assert.equal(middle({ linear: true }), 198);  // of which the sRGB curve has this stored value
});

test('toDataURL() is a PNG of these pixels', () => {
  for (const [bytes] of files.filter((_, k) => k % 9 === 0))
    for (const options of [undefined, { pixels: 1 }, { pixels: 96, softness: 0 }, { pixels: 1e9 }]) {
      const [head, text] = toDataURL(bytes, options).split(','), png = readPng(Buffer.from(text, 'base64')), pixels = toPixels(decode(bytes), options);
      assert.equal(head, 'data:image/png;base64');
      assert.deepEqual([png.width, png.height], [pixels.width, pixels.height]);
      png.data.forEach((value, i) => { assert.ok(value === pixels.data[i], `${i}`); });
    }
});

test('encode() refuses what is no image of RGBA', () => {
  const { data } = picture(20, 10);
  for (const bad of [null, {}, { data, width: 100, height: 100 }, { data, width: 0, height: 0 }, { data: data.slice(0, 600), width: 20, height: 10, channels: 3 }])
    assert.throws(() => encode(encoder, bad), { name: 'HmeshError' });
});

test('encode() fills the bytes and does not pass them, and what it keeps looks like the image', () => {
  const image = picture(160, 120);
  let last = Infinity;
  for (const bytes of [48, 100, 200, 400]) {
    const made = encode(encoder, image, { bytes });
    assert.ok(made.length <= bytes && made.length > 0.94 * bytes, `${made.length} of ${bytes}`);
    const { data } = hmesh.render(decode(made, image), image);
    let error = 0;
    data.forEach((value, i) => { error += i % 4 < 3 ? (value - image.data[i]) ** 2 : 0; });
    assert.ok(error < last);
    last = error;
  }
  assert.deepEqual(encode(encoder, image, { bytes: 100 }), encode(encoder, image, { bytes: 100 }));
  for (const [width, height] of [[1, 1], [1, 90], [3000, 2]]) assert.ok(decode(encode(encoder, picture(width, height), { bytes: 48 })));
  assert.equal(decode(encode(encoder, picture(90, 60, { alpha: true }))).channels, 4);
  // Of a pattern 2000 bytes hold more vertices than a placeholder may have.
  const pattern = { data: new Uint8ClampedArray(4 * 64 * 64).map((_, i) => (i % 4 > 2 || (i >> 3) + (i >> 9) & 1 ? 255 : 0)), width: 64, height: 64 };
  assert.ok(encoder.meshImage(pattern, { bytes: 2000, bare: true, effort: 'draft' }).vertices > MOST_POINTS);
  assert.ok(decode(encode(encoder, pattern, { bytes: 2000, effort: 'draft' })).vertices > 0.8 * MOST_POINTS);
  for (const bytes of [47, 2001, NaN, '']) assert.throws(() => encode(encoder, image, { bytes }), { name: 'HmeshError' });
  assert.throws(() => encode(hmesh, image), /hmesh\.compact\.wasm/);
});

// By long division, ISO 3309.
function crc32(bytes) {
  let crc = -1;
  for (const byte of bytes) for (let k = 0; k < 8; k++) crc = crc >>> 1 ^ ((crc ^ byte >> k) & 1 ? 0xedb88320 : 0);
  return ~crc >>> 0;
}

// A PNG of rows of numbers, of a kind of pixels.
function makePng(width, height, depth, kind, rowsOf, { isInterlaced = false, palette, clear } = {}) {
  const chunk = (name, data) => {
    const body = Buffer.concat([Buffer.from(name), Buffer.from(data)]), out = Buffer.alloc(8 + body.length);
    out.writeUInt32BE(body.length - 4);
    body.copy(out, 4);
    out.writeUInt32BE(crc32(body), 4 + body.length);
    return out;
  };
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width);
  head.writeUInt32BE(height, 4);
  head.set([depth, kind, 0, 0, isInterlaced ? 1 : 0], 8);
  return Buffer.concat([Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]), chunk('IHDR', head), ...(palette ? [chunk('PLTE', palette)] : []),
    ...(clear ? [chunk('tRNS', clear)] : []), chunk('IDAT', deflateSync(Buffer.from(rowsOf))), chunk('IEND', [])]);
}

test('readPng() reads every kind of pixels, every filter, and Adam7', () => {
  const of = (...rest) => [...readPng(makePng(...rest)).data];
  assert.deepEqual(of(2, 1, 8, 2, [0, 1, 2, 3, 4, 5, 6]), [1, 2, 3, 255, 4, 5, 6, 255]);
  assert.deepEqual(of(2, 1, 8, 2, [0, 1, 2, 3, 4, 5, 6], { clear: [0, 4, 0, 5, 0, 6] }), [1, 2, 3, 255, 4, 5, 6, 0]);
  assert.deepEqual(of(1, 1, 8, 6, [0, 1, 2, 3, 4]), [1, 2, 3, 4]);
  assert.deepEqual(of(1, 1, 8, 4, [0, 9, 4]), [9, 9, 9, 4]);
  assert.deepEqual(of(1, 1, 16, 0, [0, 255, 255]), [255, 255, 255, 255]);
  assert.deepEqual(of(3, 1, 1, 0, [0, 0b10100000]), [255, 255, 255, 255, 0, 0, 0, 255, 255, 255, 255, 255]);
  assert.deepEqual(of(2, 1, 4, 0, [0, 0x3f]), [51, 51, 51, 255, 255, 255, 255, 255]);
  assert.deepEqual(of(2, 1, 2, 3, [0, 0b01000000], { palette: [1, 2, 3, 4, 5, 6], clear: [7] }), [4, 5, 6, 255, 1, 2, 3, 7]);
  // Rows of a grey picture by filters 0 to 4, as the specification has them: 10 20 / 11 22 / 12 24 / 13 26 / 14 28.
  const red = of(2, 5, 8, 0, [0, 10, 20, 1, 11, 11, 2, 1, 2, 3, 7, 8, 4, 1, 2]).filter((_, i) => i % 4 === 0);
  assert.deepEqual(red, [10, 20, 11, 22, 12, 24, 13, 26, 14, 28]);
  // 3 x 3 px in passes 1, 4 (px 2 0), 5 (row 2), 6 (column 1 of rows 0 and 2), 7 (row 1).
  const woven = of(3, 3, 8, 0, [0, 1, 0, 3, 0, 7, 9, 0, 2, 0, 8, 0, 4, 5, 6], { isInterlaced: true }).filter((_, i) => i % 4 === 0);
  assert.deepEqual(woven, [1, 2, 3, 4, 5, 6, 7, 8, 9]);
  // Bytes behind the pixels, and behind the last chunk, are nothing.
  const longer = Buffer.concat([makePng(2, 1, 8, 2, [0, 1, 2, 3, 4, 5, 6, ...Array(99).fill(7)]), Buffer.alloc(40, 1)]);
  assert.deepEqual([...readPng(longer).data], [1, 2, 3, 255, 4, 5, 6, 255]);
  for (const bad of [makePng(2, 1, 8, 2, Array(2 ** 21).fill(0)), makePng(2, 1, 3, 2, [0]), makePng(0, 1, 8, 2, [0]), makePng(2, 2, 8, 2, [0, 1]), makePng(65536, 65536, 8, 2, [0]), Buffer.alloc(9),
    makePng(4, 3, 8, 0, Array(15).fill(7)).subarray(0, 50)])
    assert.throws(() => readPng(bad), /^Error: the PNG file /);
});

test('readJpeg() reads baseline and progressive files in any of four sizes, and damaged ones end', () => {
  for (const [name, text] of Object.entries(jpegs)) {
    const bytes = Buffer.from(text, 'base64');
    for (const [wanted, n] of [[4, 1], [7, 2], [20, 4], [48, 8]]) {
      const { data, width, height, orientation, full } = readJpeg(bytes, wanted);
      assert.deepEqual([width, height], [6 * n, 4 * n]);
      assert.equal(orientation, name === 'baseline' ? 6 : 1);
      assert.deepEqual(full, name === 'baseline' ? [32, 48] : [48, 32]);
      let off = 0;
      for (let i = 0; i < data.length; i += 4) {
        const x = (i / 4 % width + 0.5) * 8 / n - 0.5, y = (Math.floor(i / 4 / width) + 0.5) * 8 / n - 0.5;
        [5 * x, 7 * y, 240 - 4 * x - 2 * y].forEach((value, k) => { off += Math.abs(value - data[i + k]); });
      }
      const least = name === 'baseline' ? 20 : 3;  // chroma of 6 px, and at 1/8 of 16, is not made smooth
      assert.ok(off / (3 * width * height) < least, `${name} ${n}: ${off / (3 * width * height)}`);
    }
    for (let k = 0; k < bytes.length; k++)
      for (const other of [bytes.subarray(0, k), bytes.map((byte, i) => (i === k ? byte ^ (1 << k % 8) : byte))]) {
        try {
          readJpeg(other, 8);
        } catch (error) {
          assert.match(error.message, /^the JPEG file /);
        }
      }
  }
});

test('shrink() takes means by alpha and turns as Exif says', () => {
  const pixel = (value, alpha = 255) => [value, value, value, alpha];
  const image = { data: Uint8ClampedArray.from([...pixel(0, 0), ...pixel(90), ...pixel(30), ...pixel(60)]), width: 2, height: 2 };
  assert.deepEqual([...shrink(image, 1).data], [60, 60, 60, 191]);
  // 1 2 3 / 4 5 6 as each orientation shows it.
  const data = Uint8ClampedArray.from([1, 2, 3, 4, 5, 6].flatMap((value) => pixel(value)));
  const shown = ['123456', '321654', '654321', '456123', '142536', '415263', '635241', '362514'];
  shown.forEach((text, k) => {
    const turned = shrink({ data, width: 3, height: 2, orientation: k + 1 }, 100);
    assert.equal([...turned.data].filter((_, i) => i % 4 === 0).join(''), text, `orientation ${k + 1}`);
    assert.deepEqual([turned.width, turned.height], k < 4 ? [3, 2] : [2, 3]);
  });
});

const run = async (cwd, ...words) => {
  try {
    return { code: 0, ...await promisify(execFile)(process.execPath, [join(npm, 'command.js'), ...words], { cwd }) };
  } catch ({ code, stdout, stderr }) {
    return { code, stdout, stderr };
  }
};

test('hmesh placeholder prints images with placeholders, and writes them into pages', async () => {
  const folder = await mkdtemp(join(tmpdir(), 'hmesh-placeholder-'));
  try {
    await writeFile(join(folder, 'a b.png'), makePng(40, 20, 8, 0, Array.from({ length: 20 * 41 }, (_, i) => (i % 41 ? i % 41 * 6 : 0))));
    await writeFile(join(folder, 'turned.jpg'), Buffer.from(jpegs.baseline, 'base64'));
    await writeFile(join(folder, 'other.webp'), 'RIFF....WEBPVP8 ');
    const { code, stdout } = await run(folder, 'placeholder', '--bytes', '100', 'a b.png', 'turned.jpg');
    const lines = stdout.trim().split('\n').map((line) => /^<img src="(.*)" width="(\d+)" height="(\d+)" data-mesh="([\w-]+)">$/.exec(line).slice(1));
    assert.deepEqual([code, ...lines.map((line) => line.slice(0, 3))], [0, ['a%20b.png', '40', '20'], ['turned.jpg', '32', '48']]);
    for (const [, width, height, mesh] of lines) {
      assert.ok(mesh.length <= 134);
      const { width: w, height: h } = decode(mesh);
      assert.ok(Math.abs(w / h - width / height) < 0.1 && toDataURL(mesh));
    }
    const json = JSON.parse((await run(folder, 'placeholder', '--json', '--bytes=100', 'turned.jpg')).stdout);
    assert.deepEqual(json, { 'turned.jpg': { width: 32, height: 48, mesh: lines[1][3] } });
    await writeFile(join(folder, '__proto__'), Buffer.from(jpegs.baseline, 'base64'));
    assert.match((await run(folder, 'placeholder', '--json', '__proto__')).stdout, /"__proto__": \{\s*"width": 32/);

    const page = '<!-- <img src="a b.png"> --><IMG alt="a > b" src=\'a%20b.png?1\'><script>"<img src=turned.jpg>"</script>\n'
      + '<img height=9 src=turned.jpg /><img src="https://x.example/turned.jpg"><img src="a b.png" data-mesh="x"><img src="/a.png"><img src="x.svg">';
    await writeFile(join(folder, 'page.html'), page);
    const told = await run(folder, 'placeholder', '--bytes', '100', 'page.html');
    assert.deepEqual([told.code, told.stdout, told.stderr], [0, '', 'page.html: 2 placeholders\n']);
    const filled = page.replace('<IMG', `<IMG width="40" height="20" data-mesh="${lines[0][3]}"`)
      .replace('<img height=9', `<img data-mesh="${lines[1][3]}" height=9`);
    assert.equal(await readFile(join(folder, 'page.html'), 'utf8'), filled);
    assert.equal((await run(folder, 'placeholder', 'page.html')).stderr, 'page.html: 0 placeholders\n');

    const bad = await run(folder, 'placeholder', 'no.png', 'other.webp', 'turned.jpg');
    assert.equal(bad.code, 1);
    assert.match(bad.stderr, /no\.png: ENOENT.*\n.*other\.webp: it is a WebP file: npm install sharp/);
    assert.match(bad.stdout, /turned/);
    const endless = await run(folder, 'placeholder', '/dev/zero', 'turned.jpg');
    assert.deepEqual([endless.code, /turned/.test(endless.stdout)], [1, true]);
    if (process.platform !== 'win32') assert.equal(endless.stderr, 'hmesh: /dev/zero: it is a device, not a file\n');
    for (const words of [[], ['placeholder'], ['paint'], ['placeholder', '--bytes', '47', 'x'], ['placeholder', '--bytes'], ['placeholder', '--x', 'y']]) {
      const { code: wrong, stderr } = await run(folder, ...words);
      assert.deepEqual([wrong, stderr.startsWith('hmesh: ')], [2, true], words.join(' '));
    }
  } finally {
    await rm(folder, { recursive: true });
  }
});

test('hmesh placeholder says that what it prints finds no room, and ends in silence where nobody reads it', async () => {
  const folder = await mkdtemp(join(tmpdir(), 'hmesh-output-'));
  try {
    const image = join(folder, 'a.png'), words = [join(npm, 'command.js'), 'placeholder', '--bytes', '48', image, image];
    await writeFile(image, makePng(4, 3, 8, 0, new Array(12 + 3).fill(0)));
    const end = (child) => new Promise((resolve) => {
      let told = '';
      child.stderr.on('data', (text) => { told += text; });
      child.on('close', (code) => resolve([code, told]));
    });
    const unread = spawn(process.execPath, words, { stdio: ['ignore', 'pipe', 'pipe'] });
    unread.stdout.destroy();
    assert.deepEqual(await end(unread), [1, '']);
    const full = await open('/dev/full', 'w').catch(() => null);
    if (!full) return;
    const [code, told] = await end(spawn(process.execPath, words, { stdio: ['ignore', full.fd, 'pipe'] }));
    await full.close();
    assert.equal(code, 1);
    assert.match(told, /^hmesh: standard output: ENOSPC.*\n$/);
  } finally {
    await rm(folder, { recursive: true });
  }
});

test('hmesh placeholder changes nothing of a page but its images, whatever the page is like', async () => {
  const folder = await mkdtemp(join(tmpdir(), 'hmesh-pages-'));
  try {
    const grey = (width, height) => makePng(width, height, 8, 0, new Array(height * (width + 1)).fill(0));
    for (const name of ['a.png', '100%.png', 'ä.png', 'a#b.png', 'n:x.png', 'cut.png', 'voilà.png']) await writeFile(join(folder, name), grey(4, 3));
    await writeFile(join(folder, 'cut.png'), grey(4, 3).subarray(0, 50));
    await writeFile(join(folder, 'none.png'), '');
    const { stdout } = await run(folder, 'placeholder', 'a#b.png', './n:x.png');
    assert.match(stdout, /^<img src="a%23b\.png".*\n<img src="n%3Ax\.png"/);
    const [, added] = /( width="4" height="3" data-mesh="[\w-]+")>/.exec(stdout);
    // Where ^ is, an image is given a placeholder.
    const pages = [
      '<meta charset="iso-8859-1">caf\xe9 <img^ src="a.png">', 'caf\xc3\xa9 <img^ src="\xc3\xa4.png">', 'caf\xe9 <img^ src="\xe4.png" >',
      '<img^ src=a.png alt=\xc3\xa0><img^ alt=\xa0x src=voil\xc3\xa0.png>', '<img^ src=a.png alt=><img^ alt= x src=a.png>', '<img^\tsrc=a.png />',
      `<div data-html="<img src='a.png'>">x</div><iframe srcdoc='<img src="a.png">'><img src=a.png></iframe></p title="<img src=a.png>">`,
      `<img^ src=a.png alt=it's><p>don't <img^ src='100%.png' /></p>`, '<style>/* <img src=a.png> */</style><textarea><img src=a.png></textarea><IMG^ SRC=a.png>',
      '<noscript><img src=a.png></noscript><title><img src=a.png></title><img src=a.png', '<img^ src=a.png src=b.png>', '<img data-src=a.png><img^ alt src = a.png>',
      '<!-- <img src=a.png>', '<!--><img^ src=a.png><!-- x --!><img^ src=a.png><!-- -->', '<svg><style/></svg><img^ src=a.png>', '<script><img src=a.png>',
      '<base href="https://x.example/"><img src=a.png>', '<base href="x/../"><base href="https://x.example/"><img^ src=a.png>', '<base href="data:x"><img src=a.png>',
      '<base href="sub%20folder/b.html?q=/"><img^ src=../a.png>', '<script>x = "</script ><img^ src=a.png>"', '<imgs src=a.png><img-x src=a.png>',
      `<img^ alt="a > b 'c" src="./a.png?x=1#y">`, '<img^ src=" a.pn\ng\t"><img^ src="sub&#47;..&#x2F;&#97;.png"><img^ src="&#xE4;.png">',
      '<?php "<img src=a.png>" ?><!x <img src=a.png></ <img src=a.png></><img^ src=a.png>',
      '<base href=" sub/\n"><img^ src="../a.png">', '<img src="&#1114112;.png#"><img src="&nope;">', '', '<', '<img', '<img src="a.png',
    ];
    const files = pages.map((_, k) => `${k}.html`);
    for (const [k, wanted] of pages.entries()) await writeFile(join(folder, files[k]), wanted.replaceAll('^', ''), 'latin1');
    const all = await run(folder, 'placeholder', ...files);
    assert.equal(all.code, 0, all.stderr);
    assert.deepEqual(all.stderr.split('\n').map((line) => line.split(':')[0]), [...files, '']);  // a line of each
    for (const [k, wanted] of pages.entries())
      assert.equal(await readFile(join(folder, files[k]), 'latin1'), wanted.replaceAll('^', added), wanted);
    // Images that cannot be read are named, and the others are filled in; the page keeps its mode, and a link stays one.
    await writeFile(join(folder, 'page.html'), '<img src=no.png><img src=cut.png><img src=none.png><img src=a.png>');
    await chmod(join(folder, 'page.html'), 0o640);
    await symlink('page.html', join(folder, 'link.html'));
    const { code, stderr } = await run(folder, 'placeholder', 'link.html');
    assert.equal(code, 1);
    assert.match(stderr, /^link\.html: 1 placeholder\nhmesh: link\.html: no\.png: ENOENT.*\nhmesh: link\.html: cut\.png: .+\nhmesh: link\.html: none\.png: the file is empty\n$/);
    assert.equal(await readFile(join(folder, 'page.html'), 'latin1'), `<img src=no.png><img src=cut.png><img src=none.png><img${added} src=a.png>`);
    assert.equal((await stat(join(folder, 'page.html'))).mode & 0o777, 0o640);
    assert.ok((await lstat(join(folder, 'link.html'))).isSymbolicLink());
  } finally {
    await rm(folder, { recursive: true });
  }
});

const browser = await startBrowser(), skip = !browser && 'there is no Chromium, or node finds no playwright-core';
after(() => browser?.close());

test('watch() paints images that come near, until they have loaded, and lets others be', { skip }, async () => {
  const mesh = toText(encode(encoder, picture(90, 60), { bytes: 100 })), waiting = [];
  const slow = createServer((_, response) => waiting.push(response)), server = await serve({ '/npm/': npm, '/': '/nonexistent' });
  await new Promise((resolve) => { slow.listen(0, '127.0.0.1', resolve); });
  try {
    const { page, faults } = await openPage(browser, server.url);
    const src = `http://127.0.0.1:${slow.address().port}/`;
    await page.evaluate(([text, base]) => {
      const add = (id, data, top = 0) => {
        const image = Object.assign(new Image(90, 60), { id, style: `display:block;margin-top:${top}px` });
        image.dataset.mesh = data;
        image.src = base + id;
        document.body.append(image);
      };
      Object.assign(window, { add });
      add('first', text);
      document.getElementById('first').style.background = 'rgb(1, 2, 3)';
      add('bad', '!');
      add('far', text, 20000);
    }, [mesh, src]);
    await page.evaluate(async () => {
      const { watch } = await import('/npm/placeholder.js');
      window.stop = watch();
    });
    const background = (id) => page.$eval(`#${id}`, (image) => getComputedStyle(image).backgroundImage);
    const painted = (id) => page.waitForFunction((name) => getComputedStyle(document.getElementById(name)).backgroundImage.includes('data:image/png'), id);
    await painted('first');
    assert.equal(await background('bad'), 'none');
    assert.equal(await background('far'), 'none');
    await page.evaluate((text) => window.add('later', text), mesh);
    await page.$eval('#far', (image) => image.scrollIntoView());
    await painted('far');
    await painted('later');
    // What is seen is the picture of the mesh: its mean.
    await page.$eval('#first', (image) => image.scrollIntoView());
    const seen = readPng(await page.locator('#first').screenshot()), pixels = toPixels(decode(mesh));
    const mean = ({ data }, k) => data.filter((_, i) => i % 4 === k).reduce((a, b) => a + b, 0) / (data.length / 4);
    for (let k = 0; k < 3; k++) assert.ok(Math.abs(mean(seen, k) - mean(pixels, k)) < 6);
    // Loaded images have none.
    const png = makePng(1, 1, 8, 2, [0, 1, 2, 3]);
    for (const response of waiting.splice(0)) response.writeHead(200, { 'content-type': 'image/png' }).end(png);
    await page.waitForFunction(() => ['first', 'far', 'later'].every((id) => getComputedStyle(document.getElementById(id)).backgroundImage === 'none'));
    assert.equal(await page.$eval('#first', (image) => getComputedStyle(image).background), await page.evaluate(() => {
      const image = Object.assign(new Image(), { style: 'background: rgb(1, 2, 3)' });
      document.body.append(image);
      return getComputedStyle(image).background;
    }));  // as its author wants it
    await page.evaluate((text) => {
      window.stop();
      window.add('after', text);
    }, mesh);
    await page.$eval('#after', (image) => image.scrollIntoView());
    await page.waitForTimeout(300);
    assert.equal(await background('after'), 'none');
    assert.deepEqual(faults, []);
    await page.close();
  } finally {
    for (const response of waiting) response.destroy();
    server.close();
    slow.close();
    slow.closeAllConnections();
  }
});
