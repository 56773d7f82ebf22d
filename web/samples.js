// Pictures to try the page with, computed pixel by pixel: draw(name, width, height) gives their RGBA.

const mix = (a, b, t) => a.map((x, k) => x + (b[k] - x) * t);
const clamp = (x) => Math.min(1, Math.max(0, x));
const smooth = (from, to, x) => {
  const t = clamp((x - from) / (to - from));
  return t * t * (3 - 2 * t);
};
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const along = (a, d, t) => [a[0] + d[0] * t, a[1] + d[1] * t, a[2] + d[2] * t];
const unit = (a) => {
  const length = Math.hypot(...a);
  return a.map((x) => x / length);
};

// Hills behind hills before an evening sky. x and y from 0 to 1, y down.
const HILLS = [
  { at: 0.55, high: 0.09, waves: 1.3, seed: 1.3, color: [0.79, 0.53, 0.55] },
  { at: 0.63, high: 0.1, waves: 1.7, seed: 4.1, color: [0.62, 0.38, 0.5] },
  { at: 0.72, high: 0.09, waves: 1.4, seed: 8.6, color: [0.42, 0.27, 0.45] },
  { at: 0.82, high: 0.08, waves: 1.9, seed: 2.2, color: [0.24, 0.18, 0.36] },
  { at: 0.93, high: 0.07, waves: 1.6, seed: 6.5, color: [0.09, 0.09, 0.2] },
];
const SUN = [0.66, 0.36];
function ridge(x, { high, waves, seed }) {
  let sum = 0;
  for (let k = 0, f = waves, a = 1; k < 6; k++, f *= 2.07, a *= 0.45) sum += a * Math.sin(6.283 * f * x + seed * (k + 1) * 2.4);
  return 0.6 * high * sum;
}
function hills(x, y) {
  const sun = Math.hypot((x - SUN[0]) * 1.5, y - SUN[1]);
  let color = mix([0.13, 0.2, 0.44], [0.98, 0.64, 0.44], smooth(-0.05, 0.6, y));
  color = mix(color, [1, 0.9, 0.68], 0.75 * Math.exp(-5 * sun));
  color = mix(color, [1, 0.97, 0.86], smooth(0.0755, 0.0745, sun));
  for (const hill of HILLS) {
    const below = y - hill.at + ridge(x, hill);
    if (below < 0) continue;
    const rim = 0.22 * Math.exp(-40 * below) * Math.exp(-3 * Math.abs(x - SUN[0]));
    const mist = 0.8 * smooth(0, 0.24, below) * (1 - hill.at);
    color = mix(mix(hill.color, [1, 0.8, 0.6], rim), [0.93, 0.66, 0.6], mist);
  }
  return color;
}

// Glass balls on a table, each followed through one reflection.
const BALLS = [
  { center: [-1.55, 0.85, 0.5], radius: 0.85, color: [0.86, 0.2, 0.16] },
  { center: [0.2, 1.1, 1.2], radius: 1.1, color: [0.1, 0.36, 0.7] },
  { center: [1.85, 0.7, 0.1], radius: 0.7, color: [0.96, 0.7, 0.16] },
  { center: [-0.45, 0.42, -0.95], radius: 0.42, color: [0.16, 0.56, 0.36] },
  { center: [0.8, 0.34, -1.15], radius: 0.34, color: [0.92, 0.88, 0.82] },
];
const LIGHT = unit([-0.55, 0.85, -0.6]);
const sky = (d) => mix([0.95, 0.93, 0.9], [0.42, 0.55, 0.68], clamp(0.1 + 0.9 * d[1]));
function nearest(from, d) {
  let best = { t: Infinity };
  for (const ball of BALLS) {
    const to = along(from, ball.center, -1);
    const b = dot(to, d);
    const root = b * b - dot(to, to) + ball.radius ** 2;
    const t = -b - Math.sqrt(root);
    if (root > 0 && t > 1e-3 && t < best.t) best = { t, ball };
  }
  const table = -from[1] / d[1];
  return table > 1e-3 && table < best.t ? { t: table } : best;
}
function trace(from, d, depth) {
  const { t, ball } = nearest(from, d);
  if (t === Infinity) return sky(d);
  const at = along(from, d, t);
  if (!ball) {
    const isDark = (Math.floor(at[0] * 0.8 + 40) + Math.floor(at[2] * 0.8 + 40)) % 2 === 0;
    let light = 1;
    for (const one of BALLS) {
      const to = along(at, one.center, -1);
      const b = -dot(to, LIGHT);
      const off = Math.sqrt(Math.max(0, dot(to, to) - b * b));
      if (b > 0) light *= 1 - 0.72 * smooth(1.25, 0.75, off / one.radius);
      light *= 1 - 0.4 * Math.exp(-3 * (Math.hypot(to[0], to[2]) / one.radius) ** 2);
    }
    const color = isDark ? [0.68, 0.62, 0.56] : [0.87, 0.83, 0.77];
    return mix(color.map((x) => x * (0.25 + 0.75 * light)), sky([0, 0.02, 0]), smooth(6, 22, t));
  }
  const normal = along(at, ball.center, -1).map((x) => x / ball.radius);
  const turned = along(d, normal, -2 * dot(d, normal));
  const facing = clamp(-dot(d, normal));
  const shade = 0.3 + 0.7 * clamp(dot(normal, LIGHT)) * (nearest(along(at, normal, 0.01), LIGHT).ball ? 0.3 : 1);
  const gloss = 0.07 + 0.75 * (1 - facing) ** 4;
  const seen = depth > 0 ? trace(along(at, normal, 0.002), turned, depth - 1) : sky(turned);
  const color = mix(ball.color.map((x) => x * shade), seen, gloss);
  return mix(color, [1, 1, 1], 0.9 * clamp(dot(turned, LIGHT)) ** 90);
}
function balls(x, y) {
  const [right, up, ahead] = unit([(x - 0.5) * 1.5, 0.74 - y, 1.62]);
  const [c, s] = [Math.cos(0.36), Math.sin(0.36)]; // the eye looks down
  return trace([0.1, 2.5, -5.6], [right, up * c - ahead * s, ahead * c + up * s], 1);
}

const PICTURES = { hills, balls };
export const SAMPLES = { hills: 'Hills in the evening', balls: 'Balls on a table' };

// A sample a pixel, and four where it differs from its neighbours.
export function draw(name, width, height) {
  const data = new Uint8ClampedArray(4 * width * height);
  const put = (at, color) => color.forEach((value, k) => { data[at + k] = 255 * value; });
  const color = (x, y) => PICTURES[name](x / width, y / height);
  for (let i = 0, y = 0; y < height; y++)
    for (let x = 0; x < width; x++, i += 4) {
      put(i, color(x + 0.5, y + 0.5));
      data[i + 3] = 255;
    }
  const once = data.slice();
  const differs = (a, b) => [0, 1, 2].some((k) => Math.abs(once[a + k] - once[b + k]) > 6);
  for (let i = 0, y = 0; y < height; y++)
    for (let x = 0; x < width; x++, i += 4) {
      const around = [x > 0 && i - 4, x + 1 < width && i + 4, y > 0 && i - 4 * width, y + 1 < height && i + 4 * width];
      if (!around.some((at) => at !== false && differs(i, at))) continue;
      const four = [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]].map(([dx, dy]) => color(x + dx, y + dy));
      put(i, [0, 1, 2].map((k) => four.reduce((sum, one) => sum + Math.min(1, one[k]), 0) / 4));
    }
  return data;
}
