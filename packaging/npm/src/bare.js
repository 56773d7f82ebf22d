// Reads the bare profile of compact files, bit for bit what the library's reader makes of it: docs/compact.md has every rule that stands
// here, by the same names. Whole numbers alone, and quotients of them that are made whole at once; none is above 2^53, so that every engine
// decides alike. Parts are handed on in arrays, by their places, since minifiers shorten no names of properties.
//
// Work is O(n^2) in the number of points, n <= MOST_POINTS, and memory 8 n^2 bytes beside 430 kB of contexts: 1 ms and 50 kB of 80 points,
// which 200 bytes hold. Loops that are run for each bit are plain: a page decodes little, and most of it before its engine has compiled this.

export const MOST_POINTS = 1024;  // corners among them
const MOST_PIXELS = 4096;  // of a side: signs of circles are exact up to these
const EDGE = 2048;  // above MOST_POINTS
const ROW = 8192;  // above twice MOST_PIXELS less one

// Where each table of contexts begins in the one array of all, and each part's sets of weights.
const INNER = 48 * 1024, COUNTS = INNER + 96, ANGLES = COUNTS + 32, SHAPES = ANGLES + 3 * 256, NEAR = SHAPES + 3 * 4096;
const COLORS = NEAR + 9 * 1024, SIGNS = COLORS + 64 * 220, DIGITS = SIGNS + 64, CONTEXTS = DIGITS + 256;
const SITE_WEIGHTS = 0, FLIP_WEIGHTS = 96, COLOR_WEIGHTS = 144, WEIGHTS = 208;

export const { max, min, abs, ceil, round, exp, tan, sqrt, PI } = Math;
// Before they are rounded, all of these are 0.002 from a half at least: any engine's exp() and tan() give the numbers of docs/compact.md.
const table = (size, body) => Array.from({ length: size }, (_, k) => round(body(k)));
const LOGISTIC = table(46, (k) => 65536 / (1 + exp(-k / 4)));
const COTANGENTS = table(31, (k) => 64 / tan((k + 1) * PI / 64));
const RATES = table(161, (k) => 16384 / (2 * k + 3) | 0);  // of contexts, by their counts
const digits = (x) => 32 - Math.clz32(x);
const q3 = (count) => (count < 3 ? count : 3);
const grade = (value) => (value < 4 ? value : 2 + grade(value >> 1));  // two of each number of digits
const held = (x, most) => (x > most ? most : x < -most ? -most : x);
// Where this throws, there is no mesh.
export const refuseIf = (isWrong) => { if (isWrong) throw 0; };

// In 65536ths, of a logarithm from -2816 to 2816.
function probability(s) {
  const k = abs(s) >> 6, r = abs(s) & 63, p = LOGISTIC[k] + ((LOGISTIC[k + 1] - LOGISTIC[k]) * r >> 6);
  return s < 0 ? 65536 - p : p;
}

// The least logarithm whose probability is 16 k + 8 at least, from the piece of the curve that gets there; below a half, one above the greatest
// whose opposite has 65528 - 16 k at most.
function logarithm(k) {
  if (k < 2048) return 1 - logarithm(4095.0625 - k);  // that of 65529 - 16 k
  let s = 0;
  while (LOGISTIC[s + 1] < 16 * k + 8) s++;
  return 64 * s + ceil(64 * (16 * k + 8 - LOGISTIC[s]) / (LOGISTIC[s + 1] - LOGISTIC[s]));
}
const logarithms = Array(4096);  // those of k that have been asked for, some hundreds

// The arithmetic code from bytes[at] on, with its contexts: what each is, less 2^21, and its count.
function openCode(bytes, at) {
  const contexts = new Int32Array(CONTEXTS), seen = new Uint8Array(CONTEXTS), weights = new Int32Array(4 * WEIGHTS), logs = new Int32Array(4);
  let low = 0, high = 0xffffffff, code = 0;
  const shift = () => {
    low = low << 8 >>> 0;
    high = (high << 8 | 255) >>> 0;
    code = (code << 8 | bytes[at++]) >>> 0;  // zeros behind the end
    refuseIf(at > bytes.length + 4);
  };
  const raw = (p) => {
    const middle = low + ((high - low) * p / 65536 >>> 0), bit = code <= middle ? 1 : 0;
    if (bit) high = middle;
    else low = middle + 1;
    while (!((low ^ high) >>> 24)) shift();
    return bit;
  };
  const learn = (context, bit) => {
    const way = (bit ? 2097151 : -2097152) - contexts[context], step = (abs(way) >> 3) * RATES[seen[context]] >>> 10;
    contexts[context] += bit ? step : -step;
    if (seen[context] < 160) seen[context]++;
  };
  shift();
  shift();
  shift();
  shift();
  weights.fill(21845).fill(26000, 4 * FLIP_WEIGHTS, 4 * COLOR_WEIGHTS);
  const bits = (count, value = 0) => {
    while (count-- > 0) value = 2 * value + raw(32768);
    return value;
  };
  const told = (context) => {
    const bit = raw(max(1, 32768 + (contexts[context] >> 6)));
    learn(context, bit);
    return bit;
  };
  // A bit by all contexts `base` + name, of which each counts by its weight in the set.
  const mixed = (set, base, ...names) => {
    let sum = 0;
    for (let k = 0; k < names.length; k++) {
      const q = 2048 + (contexts[names[k] += base] >> 10);
      sum += weights[4 * set + k] * (logs[k] = logarithms[q] ??= logarithm(q));
    }
    const p = probability(held(sum / 65536 | 0, 2816)), bit = raw(p), error = bit * 65536 - p;
    for (let k = 0; k < names.length; k++) {
      weights[4 * set + k] = held(weights[4 * set + k] + (logs[k] * error / 16384 | 0), 524288);
      learn(names[k], bit);
    }
    return bit;
  };
  // Whether the bytes end as their writer ends them.
  const ends = () => {
    let unit = 2 ** 32;
    for (; ceil(low / unit) * unit > high; unit /= 256) at++;
    return at === bytes.length + 4 && code === ceil(low / unit) * unit;
  };
  return [bits, told, mixed, ends];
}

// n sites of width x height. A site is named ROW x + y, and a cell by its first site; it has 2^p x 2^q, those outside too.
function readSites(bits, told, mixed, width, height, n) {
  const room = (cell, p, q) => max(0, min(1 << p, width - (cell / ROW | 0))) * max(0, min(1 << q, height - cell % ROW));
  // Asks how many of a cell's n points its first half has, and gives the halves that have some, with their p and q.
  const halve = (cell, n, p, q, ask, give) => {
    const axis = q > p ? 1 : 0;
    q -= axis;
    p -= 1 - axis;
    const other = cell + (axis ? 1 << q : ROW << p);
    let least = max(0, n - room(other, p, q)), most = min(n, room(cell, p, q));
    for (let node = 1; least < most;) {
      const middle = (least + most) >> 1;
      const bit = ask(n < 2 ? 0 : n < 4 ? 3 * n - 6 + min(3, node) : 8 + 8 * min(4, digits(n) - 3) + min(7, node));
      if (bit) least = middle + 1;
      else most = middle;
      node += node + bit;
    }
    if (least) give(cell, least, p, q);
    if (n > least) give(other, n - least, p, q);
  };
  let cells = new Map([[0, n]]), p = digits(width - 1), q = digits(height - 1);
  for (let dense = digits(n) + 2; dense-- && p + q;) {
    const deeper = min(31, p + q), axis = q > p ? 1 : 0, along = axis ? 1 << q : ROW << p, across = axis ? ROW << p : 1 << q;
    const halves = new Map(), whole = (cell) => cells.get(cell) | 0, half = (cell) => halves.get(cell) | 0, give = (cell, n) => halves.set(cell, n);
    for (const [cell, n] of cells) {
      const beside = cell - across, next = cell + along, last = cell - along, s1 = half(beside), s2 = half(beside + along / 2);
      const far = whole(last + across) + whole(next + across) + whole(next - across);
      const near = q3(half(cell - along / 2)) << 6 | q3(whole(next)) << 4 | q3(s1) << 2 | q3(s2);
      const wide = min(7, whole(last)) << 5 | min(7, whole(next)) << 2 | (min(4, deeper) - 1);
      const others = q3(s1 + s2) << 6 | q3(whole(cell + across)) << 4 | q3(half(beside - along / 2)) << 2 | q3((far + 1) >> 1);
      halve(cell, n, p, q, (kind) => mixed(SITE_WEIGHTS + 2 * kind + (deeper < 4 ? 1 : 0), kind * 1024, near, 256 + wide, 512 + others,
        768 + axis * 32 + deeper), give);
    }
    cells = halves;
    q -= axis;
    p -= 1 - axis;
  }
  const sites = [], split = (cell, n, p, q) => {
    if (p + q) halve(cell, n, p, q, (kind) => (kind ? told(INNER + 2 * kind + (q > p ? 1 : 0)) : bits(1)), split);
    else sites.push(cell);
  };
  for (const [cell, n] of cells) split(cell, n, p, q);
  return sites;
}

// Triangles between points: of each directed edge, at [a][b], EDGE times the round of flips that has made the triangle on its left, and one more
// than the point across from it there; 0 or nothing beside the border and where there is no edge.
function makeTriangles(x, y) {
  const edges = x.map(() => Array(x.length));
  // The point across from an edge, or -1, and its round.
  const apex = (a, b) => (edges[a][b] & EDGE - 1) - 1;
  const since = (a, b) => edges[a][b] >> 11;  // over EDGE
  const set = (a, b, c, round) => {
    edges[a][b] = EDGE * round + c + 1;
    edges[b][c] = EDGE * round + a + 1;
    edges[c][a] = EDGE * round + b + 1;
  };
  // Calls body() with every triangle at a point, by its other two in the order of the first.
  const star = (a, body) => edges[a].forEach((edge, b) => edge && body(b, apex(a, b)));
  // Twice the area of a triangle, positive where c is to the left.
  const turn = (a, b, c) => (x[b] - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (y[b] - y[a]);
  // The scalar product of the sides from e to a and b.
  const product = (a, b, e) => (x[a] - x[e]) * (x[b] - x[e]) + (y[a] - y[e]) * (y[b] - y[e]);
  // Whether d counts as inside of the circle of the positive a, b, c: the product from a point to a and b, over the area, is the same all along
  // a circle, and less inside.
  const isInside = (a, b, c, d) => {
    const value = product(a, b, c) * turn(a, b, d) - product(a, b, d) * turn(a, b, c), least = min(a, b, c, d);
    const other = (point) => (point === least ? d : point);
    return value > 0 || (!value && (least === d || turn(other(a), other(b), other(c)) < 0));
  };
  // Of points to the left of an edge, the one whose product over its area is least, or -1; rounded, quotients that differ may be equal, but are
  // never the other way.
  const across = (a, b) => {
    const dx = x[b] - x[a], dy = y[b] - y[a];
    let c = -1, least = Infinity;
    for (let d = 0; d < x.length; d++) {
      const u = x[d] - x[a], v = y[d] - y[a], area = dx * v - dy * u;
      if (area > 0) {
        const value = (u * (u - dx) + v * (v - dy)) / area;
        if (value < least || (value === least && isInside(a, b, c, d))) {
          c = d;
          least = value;
        }
      }
    }
    return c;
  };
  // Makes them Delaunay's, each from a side of another; the first from an edge of the border.
  const begin = (a, b) => {
    const c = edges[a][b] ? -1 : across(a, b);
    if (c < 0) return;
    set(a, b, c, 0);
    begin(a, c);
    begin(c, b);
  };
  // The angle at p between q and r, in 64ths of a half turn.
  const angle = (p, q, r) => {
    const area = turn(p, q, r), along = product(q, r, p), t = 64 * abs(along);
    let k = 0;
    for (let step = 16; step; step >>= 1) if (t < COTANGENTS[k + step - 1] * area) k += step;
    return along < 0 ? 63 - k : k;
  };
  const flip = (a, b, c, d, round) => {
    edges[a][b] = edges[b][a] = 0;
    set(a, d, c, round);
    set(d, b, c, round);
  };
  return [apex, turn, star, begin, flip, since, angle];
}

function readFlips(mixed, n, [apex, turn, star, , flip, since, angle]) {
  let asked = new Set(), left = 64 * n, now = 1;
  const ask = (a, b) => asked.add(min(a, b) * n + max(a, b)), side = (a, b) => (since(a, b) < now ? min(1, since(a, b)) : 6);
  const pair = (u, v) => (min(u, v) >> 2) * 16 + (max(u, v) >> 2);
  for (let a = 0; a < n; a++) star(a, (b) => ask(a, b));
  for (; asked.size; now++) {
    const edges = asked;
    asked = new Set();
    for (const edge of edges) {
      const a = edge / n | 0, b = edge % n, c = apex(a, b), madeC = since(a, b), d = apex(b, a), madeD = since(b, a);
      if (c < 0 || d < 0 || madeC === now || madeD === now || turn(a, d, c) <= 0 || turn(d, b, c) <= 0) continue;
      const g = angle(c, a, b), h = angle(d, b, a);
      const phase = min(3, now) - 1, slack = max(0, min(63, 79 - g - h));
      const fresh = (madeC > now - 2) + (madeD > now - 2), shape = phase * 16 + (slack >> 2);
      const near = side(a, c) + side(c, b) + side(b, d) + side(d, a);
      if (!mixed(FLIP_WEIGHTS + shape, 0, ANGLES + phase * 256 + pair(g, h), SHAPES + shape * 256 + pair(angle(a, d, c), angle(b, c, d)),
        NEAR + (phase * 3 + fresh) * 1024 + (slack >> 1) * 32 + near)) continue;
      refuseIf(!left--);
      flip(a, b, c, d, now);
      ask(a, c);
      ask(c, b);
      ask(b, d);
      ask(d, a);
    }
  }
}

// Of all points, colours of three channels, or of four with alpha. `channels` are those of the file; `step` is that of coarse colours, 0 of exact
// ones; `mean` is 1536 times the mean area of points.
function readColors(bits, told, mixed, x, y, [, turn, star], channels, step, mean) {
  const n = x.length, planes = new Int32Array(n * channels), missed = new Int32Array(n * channels);
  const colors = [], isRgb = channels > 2, hasAlpha = channels % 2 === 0;
  for (let v = 0; v < n; v++) {
    const known = new Set();
    let area = 0;
    star(v, (u, w) => {
      area += turn(v, u, w);
      if (u < v) known.add(u);
      if (w < v) known.add(w);
    });
    const near = [...known], distances = near.map((u) => {
      const dx = abs(x[u] - x[v]), dy = abs(y[u] - y[v]);
      return 256 * max(dx, dy) + 96 * min(dx, dy);
    });
    const nearest = min(2 ** 26, ...distances), weights = distances.map((distance) => max(1, 4096 * nearest / distance | 0));
    if (!near.length && v) {
      near.push(v - 1);
      weights.push(1);
    }
    let total = 0;
    for (const weight of weights) total += weight;
    const fineness = sqrt(max(16, min(4096, mean / area))) | 0;
    let size1 = 0, size2 = 0, sign1 = 0, sign2 = 0;  // of the two channels before
    for (let k = 0; k < channels; k++) {
      const channel = hasAlpha ? (k || channels) - 1 : k, isDifference = isRgb && channel % 3 > 0;
      const top = step ? 16383 : isDifference ? 510 : 255;
      const unit = max(1, step * fineness * [10, 12, 7, 17][isRgb ? channel : 3] >> 8);
      const weigh = (numbers, from) => {
        let sum = 0;
        for (let k = 0; k < near.length; k++) sum += weights[k] * abs(numbers[near[k] * channels + channel] - from);
        return sum;
      };
      const level = (sum) => (v ? min(18, grade(sum / ceil((total * unit + 1) / 4) | 0)) : 19);
      const guess = v ? round(weigh(planes, 0) / total) : step && !isDifference ? 2048 : (top + 1) >> 1;
      const spread = level(weigh(planes, guess)), off = level(weigh(missed, 0));
      const other = min(9, size1) + (size2 > size1 ? 10 : 0), place = min(19, digits(nearest)) * 8 + min(7, near.length);
      const largest = digits(max(guess, top - guess) / unit);
      let size = 0, sign = 0, set = channel * 16;
      while (size < largest && mixed(COLOR_WEIGHTS + set, COLORS + set * 220, spread, 20 + off, 40 + other, 60 + place)) {
        size++;
        set++;
      }
      if (size) sign = 1 + told(SIGNS + channel * 9 + sign1 * 3 + sign2);
      let value = min(1, size);
      for (let k = 1; k < size; k++) value += value + (value < 4 ? told(DIGITS + set * 4 + value) : bits(1));
      const at = v * channels + channel;
      missed[at] = value *= unit;
      planes[at] = sign > 1 ? guess - value : guess + value;
      refuseIf(planes[at] < 0 || planes[at] > top);
      size2 = size1;
      size1 = size;
      sign2 = sign1;
      sign1 = sign;
    }
    const at = v * channels, zero = step ? 8192 : 255, luma = planes[at], o = planes[at + 1] - zero, green = planes[at + 2] - zero;
    const m = luma - (green >> 1), blue = m - (o >> 1);
    const color = !isRgb ? [luma, luma, luma] : step ? [luma + o - green, luma + 2 * green, luma - o - green] : [blue + o, m + green, blue];
    if (hasAlpha) color.push(planes[at + channels - 1]);
    for (const number of color) {
      const value = step ? min(255, (max(0, number) + 8) >> 4) : number;
      refuseIf(value >> 8);  // below 0 or above 255
      colors.push(value);
    }
  }
  return colors;
}

// The mesh of the bytes of a bare compact file; throws where they are none. `told`: width and height, px, where the bytes leave them out.
export function readBare(bytes, told = []) {
  let at = 1;
  const varint = (place = 1) => {
    const byte = bytes[at++];
    refuseIf(place > 16384 || (place > 1 && !byte));
    return place * (byte & 127) + (byte < 128 ? 0 : varint(128 * place));
  };
  const first = bytes[0], version = first >> 4;
  refuseIf(version < 1 || version > 2);
  const [width, height] = version < 2 ? [varint(), varint()] : told, step = varint(), colorStep = varint();
  refuseIf(!(min(width, height, step) >= 1 && max(width, height) <= MOST_PIXELS && step <= 65536 && colorStep < 4096));
  const columns = ceil(width / step) - 1, rows = ceil(height / step) - 1, x = [0, width, width, 0], y = [0, 0, height, height];
  const [bits, tell, mixed, ends] = openCode(bytes, at);
  // Numbers of points: inside, which are first in the code and last here, and along each side.
  const rest = (size) => size && bits(size - 1, 1), inside = rest(bits(5)), sizes = [[columns, 1], [rows, 1], [columns, 1], [rows, 1], [columns, rows]];
  const counts = [0, 1, 2, 3].map(() => {
    let size = 0;
    while (size < 31 && tell(COUNTS + size)) size++;
    return rest(size);
  });
  counts.push(inside);
  let n = 4;
  counts.forEach((count, k) => {
    refuseIf(count > sizes[k][0] * sizes[k][1] || (n += count) > MOST_POINTS);
    if (!count) return;
    for (const site of readSites(bits, tell, mixed, ...sizes[k], count)) {
      const i = step * (1 + site / ROW | 0), j = step * (1 + site % ROW);
      x.push([i, width, i, 0, i][k]);
      y.push([0, i, height, i, j][k]);
    }
  });
  const mesh = makeTriangles(x, y), [, , star, begin] = mesh, indices = [];
  begin(0, counts[0] ? 4 : 1);
  readFlips(mixed, n, mesh);
  const channels = (first & 3) + 1, colors = readColors(bits, tell, mixed, x, y, mesh, channels, colorStep, 1536 * width * height / n);
  refuseIf(!ends());
  for (let a = 0; a < n; a++) star(a, (b, c) => a < min(b, c) && indices.push(a, b, c));
  return {
    positions: Float32Array.from(x.flatMap((x, v) => [x, y[v]])), colors: Uint8Array.from(colors), indices: Uint32Array.from(indices),
    width, height, channels: colors.length / n,
    premultiplied: (first & 4) > 0, linear: (first & 8) > 0, vertices: n, faces: indices.length / 3,
  };
}
