// hmesh/placeholder: a picture of 100 to 400 bytes that is seen until an image is there. decode() makes a mesh of the text, toPixels() a small
// soft picture of that, toDataURL() a PNG, and paint() and watch() put it behind images of a page.
//
// Drawn at 40 px, softened, and magnified smoothly by the browser: of the triangles nothing is seen but their colours. No canvas is needed, so
// that servers can do the same.
import { ceil, max, min, readBare, refuseIf, round } from './bare.js';

const LARGEST = 4096;  // characters of a text; of more no mesh of MOST_POINTS is made

// The mesh, or null whatever is wrong with the data: no base64, no bytes, or none of a mesh.
function read(data, size) {
  try {
    const bytes = typeof data === 'string'  // of either alphabet of base64
      ? Uint8Array.from(atob(data.replace(/-/g, '+').replace(/_/g, '/')), (letter) => letter.charCodeAt()) : data;
    refuseIf(bytes?.[Symbol.toStringTag] !== 'Uint8Array' || data.length > LARGEST);  // of any realm, as of a frame
    return readBare(bytes, size);
  } catch (error) {
    if (error && !error.code) throw error;  // no refusal, and none of atob()'s
    return null;
  }
}

export function decode(data, { width, height } = {}) {
  const mesh = read(data, [width, height]);
  return mesh && min(width, height) > 0 && max(width, height) < Infinity
    ? { ...mesh, positions: mesh.positions.map((at, k) => at * (k % 2 ? height / mesh.height : width / mesh.width)), width, height } : mesh;
}

// Light of a stored value, both as shares of 1, and back.
const toLight = (x) => (x > 0.04045 ? ((x + 0.055) / 1.055) ** 2.4 : x / 12.92);
const fromLight = (x) => (x > 0.0031308 ? 1.055 * x ** (1 / 2.4) - 0.055 : x * 12.92);

// The mesh at the centres of width x height pixels: 4 numbers each, premultiplied, shares of 1.
function shade({ positions, colors, indices, channels, premultiplied, linear, width: w, height: h }, width, height) {
  const pixels = new Float32Array(4 * width * height);
  const share = (v, k) => {
    const value = k < channels ? colors[channels * v + k] / 255 : 1;
    return linear && k < 3 ? toLight(value) : value;
  };
  for (let f = 0; f < indices.length; f += 3) {
    const [a, b, c] = [...indices.slice(f, f + 3)].map((v) =>
      [positions[2 * v] * width / w - 0.5, positions[2 * v + 1] * height / h - 0.5, ...[0, 1, 2, 3].map((c) => share(v, c))]);
    const side = (p, q, x, y) => (q[0] - p[0]) * (y - p[1]) - (x - p[0]) * (q[1] - p[1]), area = side(a, b, c[0], c[1]);
    const from = (k) => max(0, ceil(min(a[k], b[k], c[k]))), to = (k, last) => min(last, max(a[k], b[k], c[k]));
    for (let y = from(1); y <= to(1, height - 1); y++)
      for (let x = from(0); x <= to(0, width - 1); x++) {
        const u = side(b, c, x, y) / area, v = side(c, a, x, y) / area, t = 1 - u - v;
        if (min(u, v, t) < -1e-6) continue;  // of a side, a pixel of both faces has one colour: any may be the last
        const mixed = (k) => u * a[2 + k] + v * b[2 + k] + t * c[2 + k], at = 4 * (y * width + x), alpha = pixels[at + 3] = mixed(3);
        for (let k = 0; k < 3; k++) pixels[at + k] = (linear ? fromLight(mixed(k)) : mixed(k)) * (premultiplied ? 1 : alpha);
      }
  }
  return pixels;
}

// Each number becomes the mean of itself, twice, and of those before and behind it along an axis; what is over the end is as the last.
function soften(pixels, count, step) {
  return pixels.map((here, i) => {
    const at = (i / step | 0) % count;
    return (pixels[at > 0 ? i - step : i] + 2 * here + pixels[at < count - 1 ? i + step : i]) / 4;
  });
}

export function toPixels(mesh, { pixels = 40, softness = 2 } = {}) {
  const scale = min(96, pixels) / max(mesh.width, mesh.height), side = (length) => max(1, round(length * scale));
  const width = side(mesh.width), height = side(mesh.height);
  let shaded = shade(mesh, width, height);
  for (let k = 0; k < softness; k++) shaded = soften(soften(shaded, width, 4), height, 4 * width);
  return { data: Uint8ClampedArray.from(shaded, (x, i) => 255 * x / (i % 4 < 3 && shaded[i | 3] || 1)), width, height };
}

// The bytes of 32 bits.
const word = (x) => [24, 16, 8, 0].map((k) => x >>> k & 255);

// A PNG that compresses nothing: so small a picture is not worth the code.
function toPng({ data, width, height }) {
  const rows = [];
  data.forEach((x, i) => {
    if (i % (4 * width) === 0) rows.push(0);
    rows.push(x);
  });
  let a = 1, b = 0;
  for (const byte of rows) b += a += byte;  // 37,000 bytes at most
  const size = rows.length, png = [137, 80, 78, 71, 13, 10, 26, 10];
  const chunk = (...bytes) => {
    let crc = -1;
    for (const byte of bytes) {
      crc ^= byte;
      for (let k = 0; k < 8; k++) crc = crc >>> 1 ^ (crc & 1) * 0xedb88320;
    }
    png.push(...word(bytes.length - 4), ...bytes, ...word(~crc));
  };
  chunk(73, 72, 68, 82, ...word(width), ...word(height), 8, 6, 0, 0, 0);
  chunk(73, 68, 65, 84, 120, 1, 1, ...word(~size << 16 | size).reverse(), ...rows, ...word(b % 65521 * 65536 + a % 65521));
  chunk(73, 69, 78, 68);
  return png;
}

export function toDataURL(data, options) {
  const mesh = read(data);
  return mesh && `data:image/png;base64,${btoa(String.fromCharCode(...toPng(toPixels(mesh, options))))}`;
}

export function paint(image, options) {
  if (image.complete && image.naturalWidth) return true;
  const url = toDataURL(image.dataset.mesh, options);
  if (!url) return false;
  const { objectFit } = getComputedStyle(image), size = { fill: '100% 100%', cover: 'cover' }[objectFit] ?? 'contain';
  // An animation that stays at its end hides the image's own background, and changes none of its styles.
  const shown = image.animate({ background: `url(${url}) 50% / ${size} no-repeat` }, { fill: 'both' });
  image.addEventListener('load', () => shown.cancel());
  return true;
}

export function watch(root = document, options) {
  const idle = window.requestIdleCallback ?? setTimeout;
  let isOver;
  const near = new IntersectionObserver((entries) => entries.forEach((entry) => {
    if (entry.isIntersecting) idle(() => isOver || paint(entry.target, options), { timeout: 100 });
  }), { rootMargin: '50%' });
  const find = () => root.querySelectorAll('img[data-mesh]').forEach((image) => near.observe(image));
  const added = new MutationObserver(find);
  added.observe(root, { childList: true, subtree: true });
  find();
  return () => {
    isOver = true;
    near.disconnect();
    added.disconnect();
  };
}
