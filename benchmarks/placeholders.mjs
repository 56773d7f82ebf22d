// What placeholders of images are worth: PSNR at full size and at an eighth of it, beside thumbhash and blurhash where node finds them.
//
// usage: node benchmarks/placeholders.mjs IMAGE.png...     after scripts/web.sh; NODE_PATH: where thumbhash and blurhash are, or not
// PSNR in dB over pixels and channels of RGB, of pictures rounded to 8 bits; what is smaller is magnified bilinearly.
import { createRequire } from 'node:module';
import { readFileSync } from 'node:fs';

const built = new URL('../build/web/npm/', import.meta.url);
const { Hmesh, compileCompact, load } = await import(new URL('core.node.js', built));
const { encode } = await import(new URL('encoder.js', built));
const { decode, toPixels } = await import(new URL('placeholder.js', built));
const { readPng } = await import(new URL('png.js', built));
const hmesh = await load(), encoder = new Hmesh(await compileCompact());

const optional = async (name) => {
  try {
    const found = await import(createRequire(import.meta.url).resolve(name));
    return found.default ?? found;
  } catch {
    return undefined;
  }
};
const thumbhash = await optional('thumbhash'), blurhash = await optional('blurhash');

// The mean of each width/w x height/h px, or between the centres of pixels where it is magnified.
function scaled({ data, width, height }, w, h) {
  const out = new Uint8ClampedArray(4 * w * h);
  const weights = (from, to) => Array.from({ length: to }, (_, i) => {
    const step = from / to, list = [];
    if (step > 1) {
      const begin = i * step, end = (i + 1) * step;
      for (let k = Math.floor(begin); k < Math.min(from, end); k++) list.push([k, Math.min(k + 1, end) - Math.max(k, begin)]);
    } else {
      const at = Math.max(0, Math.min(from - 1, (i + 0.5) * step - 0.5)), k = Math.floor(at);
      list.push([k, 1 - at + k], [Math.min(k + 1, from - 1), at - k]);
    }
    const sum = list.reduce((all, [, weight]) => all + weight, 0);
    return list.map(([k, weight]) => [k, weight / sum]);
  });
  const across = weights(width, w), down = weights(height, h);
  for (let y = 0; y < h; y++)
    for (let x = 0; x < w; x++)
      for (let k = 0; k < 4; k++) {
        let sum = 0;
        for (const [j, p] of down[y]) for (const [i, q] of across[x]) sum += p * q * data[4 * (j * width + i) + k];
        out[4 * (y * w + x) + k] = sum;
      }
  return { data: out, width: w, height: h };
}

function psnr(a, b) {
  let squares = 0;
  for (let i = 0; i < a.data.length; i++) if (i % 4 < 3) squares += (a.data[i] - b.data[i]) ** 2;
  return 10 * Math.log10(255 ** 2 * 3 * a.width * a.height / squares);
}

function report(name, bytes, full, picture, more = '') {
  const { width, height } = full, large = picture.width === width ? picture : scaled(picture, width, height);
  const small = [Math.max(1, width >> 3), Math.max(1, height >> 3)];
  const [at1, at8] = [psnr(large, full), psnr(scaled(large, ...small), scaled(full, ...small))].map((db) => db.toFixed(2));
  console.log(`  ${name.padEnd(16)} ${String(bytes).padStart(4)} bytes  ${at1} dB, at an eighth ${at8} dB${more}`);
}

for (const file of process.argv.slice(2)) {
  const full = readPng(readFileSync(file)), longer = Math.max(full.width, full.height);
  const thumb = scaled(full, ...[full.width, full.height].map((side) => Math.max(1, Math.round(100 * side / longer))));
  console.log(file);
  for (const budget of [100, 200, 300]) {
    const before = performance.now(), bytes = encode(encoder, full, { bytes: budget }), encoded = performance.now();
    for (let k = 0; k < 20; k++) decode(bytes);
    const times = `, made in ${(encoded - before).toFixed(0)} ms, decoded in ${((performance.now() - encoded) / 20).toFixed(2)} ms`;
    report('mesh', bytes.length, full, hmesh.render(decode(bytes, full), full), times);
    report('mesh, softened', bytes.length, full, toPixels(decode(bytes)));
  }
  if (thumbhash) {
    const hash = thumbhash.rgbaToThumbHash(thumb.width, thumb.height, thumb.data), { w, h, rgba } = thumbhash.thumbHashToRGBA(hash);
    report('thumbhash', hash.length, full, { data: rgba, width: w, height: h });
  }
  for (const [x, y] of blurhash ? [[4, 3], [9, 9]] : []) {
    const hash = blurhash.encode(thumb.data, thumb.width, thumb.height, x, y);
    const height = Math.max(1, Math.round(64 * full.height / full.width));
    report(`blurhash ${x} x ${y}`, hash.length, full, { data: blurhash.decode(hash, 64, height), width: 64, height });
  }
}
