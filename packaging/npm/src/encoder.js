// hmesh/placeholder/encoder: the bytes of a placeholder from an image.
//
// The image is shrunk until its pixels are the sites of the file's lattice, about eight between two vertices. The annealed mesh of that is moved to
// the lattice, each vertex to the site around it that is best, and moved and flipped there while that lowers its error.
// The number of vertices is sought that fills the bytes.
import { MOST_POINTS, makeTriangles, readBare } from './bare.js';
import { shrink } from './resample.js';

const SITES = 8;  // of the lattice between two vertices, along each axis
const FLIP_BITS = 3;  // that an edge costs which is not Delaunay's
const COLOR_STEP = [5000, 60, 400];  // of coarse colours, in 16ths: over the root of the bytes, from, to

// A mesh on the sites of an image, whose pixels have their centres between sites.
class Fit {
  // From a mesh of it whose vertices may lie anywhere.
  constructor({ width, height, pixels, channels }, { positions, indices, colors }) {
    const [x, y] = [0, 1].map((axis) => Array.from(positions.filter((_, k) => k % 2 === axis)));
    const [apex, turn, , , flip, , , set, isInside] = makeTriangles(x, y), mesh = { x, y, apex, turn, flip, set, isInside };
    Object.assign(this, { width, height, pixels, channels, mesh, n: x.length, colors: Float64Array.from(colors) });
    for (let f = 0; f < indices.length; f += 3) this.mesh.set(indices[f], indices[f + 1], indices[f + 2], 0);
  }

  // Calls body() with the pixels of a face and how much each corner counts there. Those on a side belong to both of its faces.
  walk(a, b, c, body) {
    const { x, y } = this.mesh, area = this.mesh.turn(a, b, c);
    const left = Math.floor(Math.min(x[a], x[b], x[c])), right = Math.max(x[a], x[b], x[c]), bottom = Math.max(y[a], y[b], y[c]);
    for (let j = Math.floor(Math.min(y[a], y[b], y[c])); j < bottom; j++)
      for (let i = left; i < right; i++) {
        const p = i + 0.5, q = j + 0.5;
        const u = ((x[c] - x[b]) * (q - y[b]) - (p - x[b]) * (y[c] - y[b])) / area;
        const v = ((x[a] - x[c]) * (q - y[c]) - (p - x[c]) * (y[a] - y[c])) / area;
        if (u >= 0 && v >= 0 && u + v <= 1) body(this.channels * (j * this.width + i), u, v, 1 - u - v);
      }
  }

  // The faces around a vertex, by their other two corners.
  star(v) {
    const faces = [];
    for (let u = 0; u < this.n; u++) if (this.mesh.apex(v, u) >= 0) faces.push([u, this.mesh.apex(v, u)]);
    return faces;
  }

  // The best colour of a vertex while others keep theirs, and the squared error that is left around it.
  best(v, star) {
    const { channels, pixels, colors } = this, sums = new Float64Array(channels);
    let squares = 0, error = 0;
    for (const [a, b] of star)
      this.walk(v, a, b, (at, u, s, t) => {
        squares += u * u;
        for (let k = 0; k < channels; k++) {
          const rest = pixels[at + k] - s * colors[channels * a + k] - t * colors[channels * b + k];
          sums[k] += u * rest;
          error += rest * rest;
        }
      });
    const color = sums.map((sum, k) => (squares > 0.05 ? Math.max(0, Math.min(255, sum / squares)) : colors[channels * v + k]));
    color.forEach((value, k) => { error += value * (value * squares - 2 * sums[k]); });
    return { color, error };
  }

  faceError(a, b, c) {
    const { channels, pixels, colors } = this;
    let error = 0;
    this.walk(a, b, c, (at, u, s, t) => {
      for (let k = 0; k < channels; k++)
        error += (pixels[at + k] - u * colors[channels * a + k] - s * colors[channels * b + k] - t * colors[channels * c + k]) ** 2;
    });
    return error;
  }

  error() {
    let error = 0;
    this.forEachFace((a, b, c) => { error += this.faceError(a, b, c); });
    return error;
  }

  forEachFace(body) {
    for (let a = 0; a < this.n; a++) for (let b = a + 1; b < this.n; b++) if (this.mesh.apex(a, b) > a) body(a, b, this.mesh.apex(a, b));
  }

  color(v) { this.colors.set(this.best(v, this.star(v)).color, this.channels * v); }

  colorAll(rounds) {
    for (let k = 0; k < rounds; k++) for (let v = 0; v < this.n; v++) this.color(v);
  }

  // Moves a vertex to the best of the sites around it where its faces stay faces: those `reach` steps away from the nearest. Says whether it moved.
  move(v, reach) {
    const { x, y } = this.mesh, from = [x[v], y[v]], star = this.star(v);
    const isSide = from[0] === 0 || from[0] === this.width, isEnd = from[1] === 0 || from[1] === this.height;
    if (isSide && isEnd) return false;
    const isSite = Number.isInteger(from[0]) && Number.isInteger(from[1]);
    let found = isSite ? this.best(v, star) : undefined, to = from;
    for (let dy = isEnd ? 0 : -reach; dy <= (isEnd ? 0 : reach); dy++)
      for (let dx = isSide ? 0 : -reach; dx <= (isSide ? 0 : reach); dx++) {
        const at = [Math.round(from[0]) + dx, Math.round(from[1]) + dy];
        if ((!isSide && (at[0] <= 0 || at[0] >= this.width)) || (!isEnd && (at[1] <= 0 || at[1] >= this.height))) continue;
        [x[v], y[v]] = at;
        if (!star.every(([a, b]) => this.mesh.turn(v, a, b) > 0)) continue;
        const other = this.best(v, star);
        if (!found || other.error < found.error) [found, to] = [other, at];
      }
    [x[v], y[v]] = to;
    if (found) this.colors.set(found.color, this.channels * v);
    return to !== from;
  }

  // This without a vertex, whose faces go to the neighbour where that leaves the least error; undefined where none can have them.
  without(v) {
    const { mesh, colors, channels, n } = this, star = this.star(v), area = star.reduce((sum, [a, b]) => sum + mesh.turn(v, a, b), 0);
    let least = Infinity, heir = -1;
    for (const u of new Set(star.flat())) {
      const faces = star.filter((face) => !face.includes(u));
      if (!faces.every(([a, b]) => mesh.turn(u, a, b) > 0)) continue;
      if (Math.abs(faces.reduce((sum, [a, b]) => sum + mesh.turn(u, a, b), 0) - area) > 1e-6) continue;
      const error = faces.reduce((sum, [a, b]) => sum + this.faceError(u, a, b), 0);
      if (error < least) [least, heir] = [error, u];
    }
    if (heir < 0) return undefined;
    const kept = [...Array(n).keys()].filter((u) => u !== v), indices = [];
    this.forEachFace((...face) => {
      const corners = face.map((u) => (u === v ? heir : u));
      if (!face.includes(v) || !face.includes(heir)) indices.push(...corners.map((u) => (u > v ? u - 1 : u)));
    });
    return new Fit(this, {
      positions: kept.flatMap((u) => [mesh.x[u], mesh.y[u]]), indices, colors: kept.flatMap((u) => [...colors.subarray(channels * u, channels * (u + 1))]),
    });
  }

  // This with all vertices on sites, and without those that find none; undefined where that fails.
  snapped() {
    let fit = this;
    for (let round = 0; round < 64; round++) {
      const { x, y } = fit.mesh, left = [...x.keys()].filter((v) => !Number.isInteger(x[v]) || !Number.isInteger(y[v]));
      if (!left.length) return fit;
      let less;
      if (round > 3) for (const v of left) less ??= fit.without(v);
      if (less) fit = less;
      else for (const v of left) fit.move(v, 1 + (round >> 1) % 4);
      // What is in the way are narrow faces.
      if (round > 3 && !less) for (const v of left) for (const [a, b] of fit.star(v)) [[a, b], [v, a]].forEach(([p, q]) => fit.flip(p, q, Infinity));
    }
    return undefined;
  }

  // Flips an edge where that is better, one that then is not Delaunay's by so much.
  flip(a, b, price) {
    const { mesh } = this, c = mesh.apex(a, b), d = mesh.apex(b, a);
    if (c < 0 || d < 0 || mesh.turn(a, d, c) <= 0 || mesh.turn(d, b, c) <= 0) return;
    const toll = mesh.isInside(a, b, c, d) ? price : -price;
    if (this.faceError(a, d, c) + this.faceError(d, b, c) < this.faceError(a, b, c) + this.faceError(b, a, d) + toll) mesh.flip(a, b, c, d, 0);
  }

  flipAll(price) {
    for (let a = 0; a < this.n; a++) for (let b = a + 1; b < this.n; b++) this.flip(a, b, price);
  }

  relax(price) {
    this.colorAll(4);
    for (let k = 0, moved = true; k < 12 && moved; k++) {
      moved = false;
      for (let v = 0; v < this.n; v++) if (this.move(v, 1)) moved = true;
      this.flipAll(price);
    }
    this.colorAll(6);
  }

  arrays(premultiplied) {
    const { x, y } = this.mesh, indices = [];
    this.forEachFace((a, b, c) => indices.push(a, b, c));
    return {
      positions: Float32Array.from({ length: 2 * this.n }, (_, k) => (k % 2 ? y : x)[k >> 1]), colors: Uint8Array.from(this.colors, Math.round),
      indices: Uint32Array.from(indices), width: this.width, height: this.height, channels: this.channels, premultiplied,
    };
  }
}

// What is meshed: pixels of 3 channels, or of 4 and premultiplied where something shines through.
function prepare(image, side) {
  const { data, width, height } = shrink(image, side), isOpaque = data.every((value, k) => k % 4 < 3 || value === 255), channels = isOpaque ? 3 : 4;
  const pixels = new Uint8Array(channels * width * height);
  for (let i = 0; i < width * height; i++)
    for (let k = 0; k < channels; k++) pixels[channels * i + k] = k < 3 ? Math.round(data[4 * i + k] * data[4 * i + 3] / 255) : data[4 * i + 3];
  return { data: pixels, pixels, width, height, channels };
}

// The mesh of so many vertices, less those that find no site; undefined where there is none.
function meshWith(hmesh, image, vertices) {
  const longer = Math.max(image.width, image.height), shorter = Math.min(image.width, image.height);
  const side = Math.max(2, Math.min(longer, 256, Math.round(SITES * Math.sqrt(vertices * longer / shorter))));
  const target = prepare(image, side), premultiplied = target.channels === 4;
  const wanted = Math.max(4, Math.min(vertices, target.width * target.height));
  const fit = new Fit(target, hmesh.meshImage(target, { vertices: wanted, premultiplied })).snapped();
  if (!fit) return undefined;
  fit.relax(FLIP_BITS * fit.error() / (16 * fit.n));  // a vertex takes some 16 bits, and its error for them
  const arrays = fit.arrays(premultiplied);
  return {
    write: (colorStep) => hmesh.write(arrays, 'hmc', { bare: true, colorStep }),
    error: (bytes) => new Fit(target, readBare(bytes)).error() / (target.width * target.height),
  };
}

// The placeholder of an image, RGBA with alpha straight, of so many bytes at most: the best that a few tries find. `hmesh` is that of hmesh/core.
export function encode(hmesh, image, { bytes = 200 } = {}) {
  if (!(bytes >= 48 && bytes <= 2000)) throw new RangeError(`bytes must be from 48 to 2000: ${bytes}`);
  const [scale, finest, coarsest] = COLOR_STEP, coarse = Math.max(finest, Math.min(coarsest, Math.round(scale / Math.sqrt(bytes))));
  let least = 3, most = MOST_POINTS + 1, vertices = Math.round((bytes - 8) * 8 / 24), best;
  for (let k = 0; k < 8 && most - least > 1; k++) {
    vertices = Math.max(least + 1, Math.min(most - 1, vertices));
    const mesh = meshWith(hmesh, image, vertices), full = mesh?.write(coarse);
    if (!mesh || full.length > bytes) most = vertices;
    else {
      least = vertices;
      // What is left of the bytes goes into finer colours.
      let step = coarse, file = full;
      for (let less = 128; less >= 1; less /= 2) {
        if (step - less < 1) continue;
        const finer = mesh.write(step - less);
        if (finer.length <= bytes) [file, step] = [finer, step - less];
      }
      const error = mesh.error(file);
      if (!best || error < best.error) best = { file, error };
      if (full.length > 0.97 * bytes) break;
    }
    vertices = mesh ? Math.floor(vertices * (bytes - 4.5) / (full.length - 4)) : Math.floor(0.93 * vertices);
  }
  return best?.file ?? meshWith(hmesh, image, 4).write(coarsest);
}

// base64url, as data-mesh has it.
export const toText = (bytes) => btoa(String.fromCharCode(...bytes)).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
