// Reads the bare profile of compact files, bit for bit what the library's reader makes of it: docs/compact.md has every rule that stands
// here, by the same names. Whole numbers alone; none is above 2^53, so that every engine decides alike.
//
// Work is O(n^2) in the number of points and memory 6 n^2 bytes, n <= MOST_POINTS: 0.7 ms and 30 kB of 70 points, which 200 bytes hold.

export const MOST_POINTS = 1024;  // corners among them
const MOST_PIXELS = 4096;  // of a side: signs of circles are exact up to these
const EDGE = 2048;  // above MOST_POINTS
const ROW = 8192;  // above twice MOST_PIXELS less one

// Where each table of contexts begins in the one array of all, and each part's sets of weights.
const INNER = 48 * 1024, COUNTS = INNER + 96, ANGLES = COUNTS + 32, SHAPES = ANGLES + 3 * 256, NEAR = SHAPES + 3 * 4096;
const COLORS = NEAR + 9 * 1024, SIGNS = COLORS + 64 * 220, DIGITS = SIGNS + 64, CONTEXTS = DIGITS + 256;
const SITE_WEIGHTS = 0, FLIP_WEIGHTS = 96, COLOR_WEIGHTS = 144, WEIGHTS = 208;

export const { max, min, abs, ceil, floor, round, trunc, exp, tan, sqrt, PI } = Math;
// Before they are rounded, all of these are 0.002 from a half at least: any engine's exp() and tan() give the numbers of docs/compact.md.
const table = (size, body) => Array.from({ length: size }, (_, k) => round(body(k)));
const LOGISTIC = table(45, (k) => 65536 / (1 + exp(-k / 4)));
const COTANGENTS = table(31, (k) => 64 / tan((k + 1) * PI / 64));
const digits = (x) => 32 - Math.clz32(x);
const held = (x, most) => max(-most, min(most, x));
const refuse = () => { throw 0; };  // caught by readBare() alone

function probability(s) {
  const size = abs(s), k = size >> 6, r = size & 63;
  const p = size >= 2816 ? 65535 : (LOGISTIC[k] * (64 - r) + LOGISTIC[k + 1] * r) >> 6;
  return s < 0 ? 65536 - p : p;
}

let logarithms;
function makeLogarithms() {
  let s = -2816;
  return Int16Array.from({ length: 4096 }, (_, k) => {
    while (s < 2816 && probability(s) < 16 * k + 8) s++;
    return s;
  });
}

// The arithmetic code from bytes[at] on, with its contexts: a context is its q less 2^21 in units of 256, and its count.
function openCode(bytes, at) {
  const contexts = new Int32Array(CONTEXTS), weights = new Int32Array(4 * WEIGHTS);
  let low = 0, high = 0xffffffff, code = 0, missing = 0;
  const shift = () => {
    low = low << 8 >>> 0;
    high = (high << 8 | 255) >>> 0;
    if (at >= bytes.length && ++missing > 4) refuse();
    code = (code << 8 | (at < bytes.length ? bytes[at++] : 0)) >>> 0;
  };
  const raw = (p) => {
    const range = high - low, middle = low + (range >>> 16) * p + ((range & 65535) * p >>> 16), bit = code <= middle;
    if (bit) high = middle;
    else low = middle + 1;
    while ((low ^ high) >>> 24 === 0) shift();
    return bit ? 1 : 0;
  };
  const q = (context) => 2097152 + (contexts[context] >> 8);
  const learn = (context, bit) => {
    const count = contexts[context] & 255, before = q(context);
    const way = trunc(trunc((bit * 4194303 - before) / 8) * floor(16384 / (2 * count + 3)) / 1024);
    contexts[context] = (before + way - 2097152) * 256 + min(count + 1, 160);
  };
  for (let k = 0; k < 4; k++) shift();
  weights.fill(21845).fill(26000, 4 * FLIP_WEIGHTS, 4 * COLOR_WEIGHTS);
  const bits = (count) => {
    let value = 0;
    while (count-- > 0) value = 2 * value + raw(32768);
    return value;
  };
  const told = (context) => {
    const bit = raw(max(1, q(context) >> 6));
    learn(context, bit);
    return bit;
  };
  const mixed = (set, names) => {
    const logs = names.map((name) => logarithms[q(name) >> 10]);
    const p = probability(held(trunc(logs.reduce((sum, log, k) => sum + weights[4 * set + k] * log, 0) / 65536), 2816)), bit = raw(p);
    names.forEach((name, k) => {
      weights[4 * set + k] = held(weights[4 * set + k] + trunc(logs[k] * (bit * 65536 - p) / 16384), 524288);
      learn(name, bit);
    });
    return bit;
  };
  // Whether the bytes end as their writer ends them.
  const ends = () => {
    for (let size = 0; ; size++) {
      const unit = 2 ** (32 - 8 * size), tail = ceil(low / unit) * unit;
      if (tail <= high) return at === bytes.length && missing + size === 4 && code === tail;
    }
  };
  return [bits, told, mixed, ends];
}

function readCounts([bits, told]) {
  const rest = (size) => (size ? 2 ** (size - 1) + bits(size - 1) : 0), inside = rest(bits(5)), counts = [];
  while (counts.length < 4) {
    let size = 0;
    while (size < 31 && told(COUNTS + size)) size++;
    counts.push(rest(size));
  }
  return [...counts, inside];
}

// n sites of width x height, as [x, y]. A cell is named by ROW x + y of its level.
function readSites([bits, told, mixed], width, height, n) {
  const left = [digits(width - 1), digits(height - 1)], axes = [], sides = [[...left]], sites = [];
  while (left[0] + left[1]) {
    const a = left[1] > left[0] ? 1 : 0;
    axes.push(a);
    left[a]--;
    sides.push([...left]);
  }
  const inside = (side, at, size) => max(0, min(1 << side, size - (at << side)));
  const room = (level, cell) => inside(sides[level][0], floor(cell / ROW), width) * inside(sides[level][1], cell % ROW, height);
  const first = (level, cell) => cell + (axes[level] ? cell % ROW : cell - cell % ROW), unit = (level) => (axes[level] ? 1 : ROW);
  // The two halves of a cell, and how many of its points each has.
  const halve = (level, [cell, n], ask) => {
    const one = first(level, cell), two = one + unit(level++);
    let least = max(0, n - room(level, two)), most = min(n, room(level, one));
    for (let node = 1; least < most;) {
      const middle = (least + most) >> 1;
      const bit = ask(n < 2 ? 0 : n < 4 ? 3 * n - 6 + min(3, node) : 8 + 8 * min(4, digits(n) - 3) + min(7, node));
      if (bit) least = middle + 1;
      else most = middle;
      node = min(8, 2 * node + bit);
    }
    return [[one, least], [two, n - least]].filter((half) => half[1]);
  };
  const dense = min(axes.length, digits(n) + 2);
  let cells = new Map([[0, n]]);
  for (let level = 0; level < dense; level++) {
    const deeper = min(31, axes.length - level), along = unit(level), across = ROW + 1 - along, halves = new Map();
    for (const cell of cells) {
      const q3 = (count) => min(3, count), whole = (k, l) => cells.get(cell[0] + k * along + l * across) | 0;
      const half = (k, l) => halves.get(first(level, cell[0]) + k * along + l * across) | 0;
      const s1 = half(0, -1), s2 = half(1, -1), far = whole(-1, 1) + whole(1, 1) + whole(1, -1);
      const near = q3(half(-1, 0)) << 6 | q3(whole(1, 0)) << 4 | q3(s1) << 2 | q3(s2);
      const wide = min(7, whole(-1, 0)) << 5 | min(7, whole(1, 0)) << 2 | (min(4, deeper) - 1);
      const others = q3(s1 + s2) << 6 | q3(whole(0, 1)) << 4 | q3(half(-1, -1)) << 2 | q3((far + 1) >> 1);
      halve(level, cell, (kind) => mixed(SITE_WEIGHTS + 2 * kind + (deeper < 4 ? 1 : 0),
        [near, 256 + wide, 512 + others, 768 + axes[level] * 32 + deeper].map((name) => kind * 1024 + name)))
        .forEach((part) => halves.set(...part));
    }
    cells = halves;
  }
  const split = (level, cell) => {
    if (level === axes.length) sites.push([floor(cell[0] / ROW), cell[0] % ROW]);
    else halve(level, cell, (kind) => (kind ? told(INNER + 2 * kind + axes[level]) : bits(1))).forEach((part) => split(level + 1, part));
  };
  for (const cell of cells) split(dense, cell);
  return sites;
}

// Triangles between points: of each directed edge from a to b, at a n + b, EDGE times the round of flips that has made the triangle on its
// left, and one more than the point across from it there; 0 beside the border.
export function makeTriangles(x, y) {
  const n = x.length, edges = new Int32Array(n * n);
  // The point across from an edge, or -1, and its round.
  const apex = (a, b) => (edges[a * n + b] & EDGE - 1) - 1;
  const since = (a, b) => trunc(edges[a * n + b] / EDGE);
  const set = (a, b, c, round) => {
    edges[a * n + b] = EDGE * round + c + 1;
    edges[b * n + c] = EDGE * round + a + 1;
    edges[c * n + a] = EDGE * round + b + 1;
  };
  // Twice the area of a triangle, positive where c is to the left.
  const turn = (a, b, c) => (x[b] - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (y[b] - y[a]);
  // Whether d counts as inside of the circle of the positive a, b, c.
  const isInside = (a, b, c, d) => {
    const p = x[a] - x[d], q = y[a] - y[d], s = x[b] - x[d], t = y[b] - y[d], v = x[c] - x[d], w = y[c] - y[d];
    const value = (p * p + q * q) * (s * w - t * v) + (s * s + t * t) * (v * q - w * p) + (v * v + w * w) * (p * t - q * s);
    if (value) return value > 0;
    const least = min(a, b, c, d), other = (point) => (point === least ? d : point);
    return least === d || turn(other(a), other(b), other(c)) < 0;
  };
  // Makes them Delaunay's, each from a side of another; the first from an edge of the border.
  const begin = (a, b) => {
    if (apex(a, b) >= 0) return;
    const p = x[a], q = y[a], s = x[b] - p, t = y[b] - q;
    let c = -1;
    for (let d = 0; d < n; d++) if (s * (y[d] - q) > (x[d] - p) * t && (c < 0 || isInside(a, b, c, d))) c = d;
    if (c < 0) return;
    set(a, b, c, 0);
    begin(a, c);
    begin(c, b);
  };
  // The angle at p between q and r, in 64ths of a half turn.
  const angle = (p, q, r) => {
    const area = turn(p, q, r), t = 64 * ((x[q] - x[p]) * (x[r] - x[p]) + (y[q] - y[p]) * (y[r] - y[p]));
    let k = 0;
    while (k < 31 && abs(t) < COTANGENTS[k] * area) k++;
    return t < 0 ? 63 - k : k;
  };
  const flip = (a, b, c, d, round) => {
    edges[a * n + b] = edges[b * n + a] = 0;
    set(a, d, c, round);
    set(d, b, c, round);
  };
  return { x, y, n, apex, since, set, turn, isInside, begin, angle, flip };
}

function readFlips([, , mixed], { n, apex, since, turn, angle, flip }) {
  let asked = new Set(), left = 64 * n;
  const ask = (a, b) => asked.add(min(a, b) * n + max(a, b));
  for (let a = 0; a < n; a++) for (let b = a + 1; b < n; b++) if (apex(a, b) >= 0 || apex(b, a) >= 0) ask(a, b);
  for (let now = 1; asked.size; now++) {
    const edges = asked;
    asked = new Set();
    for (const edge of edges) {
      const a = floor(edge / n), b = edge % n, c = apex(a, b), d = apex(b, a), made = [since(a, b), since(b, a)];
      if (c < 0 || d < 0 || made.includes(now) || turn(a, d, c) <= 0 || turn(d, b, c) <= 0) continue;
      const g = angle(c, a, b), h = angle(d, b, a), i = angle(a, d, c), j = angle(b, c, d);
      const phase = min(3, now) - 1, slack = max(0, min(63, 79 - g - h)), pair = (u, v) => (min(u, v) >> 2) * 16 + (max(u, v) >> 2);
      const sides = [[a, c], [c, b], [b, d], [d, a]], fresh = made.filter((at) => at === now - 1).length, shape = phase * 16 + (slack >> 2);
      let near = 0;
      for (const [u, v] of sides) near += since(u, v) === now ? 6 : min(1, since(u, v));
      if (!mixed(FLIP_WEIGHTS + shape,
        [ANGLES + phase * 256 + pair(g, h), SHAPES + shape * 256 + pair(i, j), NEAR + (phase * 3 + fresh) * 1024 + (slack >> 1) * 32 + near])) continue;
      if (left-- === 0) refuse();
      flip(a, b, c, d, now);
      for (const [u, v] of sides) ask(u, v);
    }
  }
}

// Of all points, `channels` colours each, 0 to 255. `step` is that of coarse colours, 0 of exact ones; `mean` is 1536 times the mean area of points.
function readColors([bits, told, mixed], mesh, channels, step, mean) {
  const { n, x, y } = mesh, planes = new Int32Array(n * channels), missed = new Int32Array(n * channels);
  const colors = new Int32Array(n * channels), isRgb = channels > 2, hasAlpha = channels % 2 === 0;
  for (let v = 0; v < n; v++) {
    let area = 0;
    for (let u = 0; u < n; u++) if (mesh.apex(v, u) >= 0) area += mesh.turn(v, u, mesh.apex(v, u));
    const fineness = floor(sqrt(max(16, min(4096, floor(mean / area)))));
    let near = [], nearest = 2 ** 26, total = 0;
    for (let u = 0; u < v; u++) {
      if (mesh.apex(u, v) < 0 && mesh.apex(v, u) < 0) continue;
      const dx = 256 * abs(x[u] - x[v]), dy = 256 * abs(y[u] - y[v]), distance = max(dx, dy) + floor(3 * min(dx, dy) / 8);
      near.push([u, distance]);
      nearest = min(nearest, distance);
    }
    near = near.map(([u, distance]) => [u, max(1, floor(4096 * nearest / distance))]);
    if (!near.length && v) near.push([v - 1, 1]);
    for (const [, weight] of near) total += weight;
    let size1 = 0, size2 = 0, sign1 = 0, sign2 = 0;  // of the two channels before
    for (let k = 0; k < channels; k++) {
      const channel = hasAlpha ? (k || channels) - 1 : k, isDifference = isRgb && (channel === 1 || channel === 2);
      const top = step ? 16383 : isDifference ? 510 : 255, first = isDifference ? 8192 : 2048;
      const unit = step ? max(1, floor(step * fineness * (isRgb ? [10, 12, 7, 17][channel] : 17) / 256)) : 1;
      const weigh = (value) => near.reduce((sum, [u, weight]) => sum + weight * value(u * channels + channel), 0);
      const level = (sum) => {
        if (!near.length) return 19;
        const value = floor(sum / (floor(total * unit / 4) + 1)), size = digits(value);
        return min(18, value < 2 ? value : 2 * size - 2 + (value >> (size - 2) & 1));
      };
      const guess = near.length ? floor((weigh((at) => planes[at]) + floor(total / 2)) / total) : step ? first : (top + 1) >> 1;
      const spread = level(weigh((at) => abs(planes[at] - guess))), off = level(weigh((at) => missed[at]));
      const other = min(9, size1) + (size2 > size1 ? 10 : 0), place = min(19, digits(nearest)) * 8 + min(7, near.length);
      let size = 0, value = 0, sign = 0;
      for (const largest = digits(floor(max(guess, top - guess) / unit)); size < largest; size++) {
        const set = channel * 16 + size, at = COLORS + set * 220;
        if (!mixed(COLOR_WEIGHTS + set, [at + spread, at + 20 + off, at + 40 + other, at + 60 + place])) break;
      }
      if (size) {
        sign = 1 + told(SIGNS + channel * 9 + sign1 * 3 + sign2);
        value = 1;
        for (let left = size - 1; left--;) value = 2 * value + (value < 4 ? told(DIGITS + (channel * 16 + size) * 4 + value) : bits(1));
      }
      value *= unit;
      const number = sign > 1 ? guess - value : guess + value, at = v * channels + channel;
      if (number < 0 || number > top) refuse();
      planes[at] = colors[at] = number;
      missed[at] = value;
      [size2, size1, sign2, sign1] = [size1, size, sign1, sign];
    }
    const at = v * channels;
    if (isRgb) {
      const zero = step ? 8192 : 255, o = planes[at + 1] - zero, green = planes[at + 2] - zero;
      const m = planes[at] - (step ? -2 * green : green >> 1), b = step ? planes[at] - o - green : m - (o >> 1);
      colors.set([step ? b + 2 * o : b + o, step ? m : green + m, b], at);
    }
    for (let k = at; k < at + channels; k++) {
      if (step) colors[k] = min(255, (max(0, colors[k]) + 8) >> 4);
      else if (colors[k] < 0 || colors[k] > 255) refuse();
    }
  }
  return colors;
}

function read(bytes, told) {
  let at = 1;
  const varint = () => {
    for (let value = 0, k = 0; k < 3; k++) {
      const byte = bytes[at++];
      value += (byte & 127) * 128 ** k;
      if (byte < 128) return byte || !k ? value : refuse();
    }
    return refuse();
  };
  const [first] = bytes, version = first >> 4;
  if (version !== 1 && version !== 2) return null;
  const [width, height] = version < 2 ? [varint(), varint()] : told, step = varint(), colorStep = varint();
  if (!(width >= 1 && width <= MOST_PIXELS && height >= 1 && height <= MOST_PIXELS && step >= 1 && step <= 65536 && colorStep < 4096)) return null;
  const columns = ceil(width / step), rows = ceil(height / step);
  const channels = (first & 3) + 1, code = openCode(bytes, at), counts = readCounts(code);
  const room = [columns - 1, rows - 1, columns - 1, rows - 1, (columns - 1) * (rows - 1)];
  const n = counts.reduce((sum, count, k) => (count > room[k] ? refuse() : sum + count), 4);
  if (n > MOST_POINTS) return null;
  const sites = [[0, 0], [columns, 0], [columns, rows], [0, rows]];
  counts.forEach((count, k) => {
    if (!count) return;
    for (const [x, y] of k < 4 ? readSites(code, room[k], 1, count) : readSites(code, columns - 1, rows - 1, count))
      sites.push([[x + 1, 0], [columns, x + 1], [x + 1, rows], [0, x + 1], [x + 1, y + 1]][k]);
  });
  const mesh = makeTriangles(...[width, height].map((size, axis) => sites.map((site) => min(size, step * site[axis]))));
  mesh.begin(0, counts[0] ? 4 : 1);
  readFlips(code, mesh);
  const numbers = readColors(code, mesh, channels, colorStep, floor(1536 * width * height / n));
  if (!code[3]()) return null;
  const indices = [];
  for (let a = 0; a < n; a++)
    for (let b = a + 1; b < n; b++) if (mesh.apex(a, b) > a) indices.push(a, b, mesh.apex(a, b));
  const more = channels < 3 ? 2 : 0, to = channels + more;  // gray is three channels
  const colors = Uint8Array.from({ length: to * n }, (_, k) => numbers[floor(k / to) * channels + max(0, k % to - more)]);
  return {
    positions: Float32Array.from(mesh.x.flatMap((x, v) => [x, mesh.y[v]])), colors, indices: Uint32Array.from(indices),
    width, height, channels: to,
    premultiplied: (first & 4) > 0, linear: (first & 8) > 0, vertices: n, faces: indices.length / 3,
  };
}

// The mesh of the bytes of a bare compact file, or null where they are none. `told`: width and height, px, where the bytes leave them out.
export function readBare(bytes, told = []) {
  logarithms ??= makeLogarithms();
  try {
    return read(bytes, told);
  } catch (error) {
    if (error) throw error;
    return null;
  }
}
