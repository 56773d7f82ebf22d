// heights_tile.js - what HERE's decoder reads from a tile of quantized-mesh: node heights_tile.js MODEL.ply TILE.terrain W,S,E,N
//
// MODEL.ply is the same mesh as write_height_ply() makes it (heights_compare.js reads it); W,S,E,N are the tile's degrees. The
// decoder must give the same faces, to half a step of 15 bits, and normals that are the model's turned to the globe; each list of
// side vertices must be those on that side; the bounding sphere must hold all vertices, and the horizon occlusion point be where
// the formula of Cesium's EllipsoidalOccluder has it, evaluated here. Exit status 0, 1, or 2 without the npm module
// @here/quantized-mesh-decoder where NODE_PATH finds it.
'use strict';
const fs = require('fs');
const { readPly } = require('./heights_compare.js');

const radii = [6378137, 6378137, 6356752.3142451793];  // WGS 84
const dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
const minus = (a, b) => a.map((x, k) => x - b[k]);
const length = (a) => Math.hypot(...a);
const unit = (a) => a.map((x) => x / length(a));
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

// East, north and up at a place on the globe, and the place.
function globe(longitude, latitude, height) {
  const [l, p] = [longitude, latitude].map((degrees) => degrees * Math.PI / 180);
  const up = [Math.cos(p) * Math.cos(l), Math.cos(p) * Math.sin(l), Math.sin(p)];
  const east = [-Math.sin(l), Math.cos(l), 0];
  const squares = up.map((x, k) => x * radii[k] ** 2), scale = Math.sqrt(dot(up, squares));
  return { east, north: cross(up, east), up, at: up.map((x, k) => squares[k] / scale + height * x) };
}

// Of two bytes, by the specification's reference (Cigolla et al., "A Survey of Efficient Representations for Independent Unit
// Vectors", 2014).
function octDecoded(a, b) {
  let [x, y] = [a / 255 * 2 - 1, b / 255 * 2 - 1];
  const z = 1 - Math.abs(x) - Math.abs(y);
  if (z < 0) [x, y] = [(1 - Math.abs(y)) * (x < 0 ? -1 : 1), (1 - Math.abs(x)) * (y < 0 ? -1 : 1)];
  return unit([x, y, z]);
}

// The point towards `center` from which on all places are hidden when it is, in units of the radii.
function occlusionPoint(center, places) {
  const scaled = (p) => p.map((x, k) => x / radii[k]);
  const direction = unit(scaled(center));
  let most = 0;
  for (const place of places) {
    const p = scaled(place), square = Math.max(1, dot(p, p)), magnitude = Math.sqrt(square);
    const cosine = dot(unit(p), direction), sine = length(cross(unit(p), direction));
    most = Math.max(most, 1 / (cosine / magnitude - sine * Math.sqrt(square - 1) / magnitude));
  }
  return direction.map((x) => x * most);
}

function main([ply, tile, sides]) {
  if (!sides) throw new Error('usage: heights_tile.js MODEL.ply TILE.terrain W,S,E,N');
  const decode = require('@here/quantized-mesh-decoder').default;
  const [west, south, east, north] = sides.split(',').map(Number);
  const bytes = fs.readFileSync(tile);
  const read = decode(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
  const model = readPly(ply), faults = [], head = read.header, count = read.vertexData.length / 3;
  const grid = Array.from({ length: count }, (_, v) => [0, 1, 2].map((k) => read.vertexData[v + k * count]));
  const low = [0, 1].map((k) => Math.min(...model.positions.map((p) => p[k])));
  const high = [0, 1].map((k) => Math.max(...model.positions.map((p) => p[k])));
  low.push(head.minHeight), high.push(head.maxHeight);
  const places = grid.map(([u, v, h]) => globe(west + (east - west) * u / 32767, south + (north - south) * v / 32767,
                                               head.minHeight + (head.maxHeight - head.minHeight) * h / 32767));

  const faces = read.triangleIndices.length / 3, worst = { step: 0, normal: 0 };
  if (faces !== model.faces.length) faults.push(`${faces} faces, not ${model.faces.length}`);
  for (let f = 0; f < faces && faults.length === 0; ++f) {
    // Faces are in the model's order; which corner is first is the writer's affair.
    const corners = [0, 1, 2].map((k) => read.triangleIndices[3 * f + k]);
    const steps = (from, to) => Math.max(...model.positions[from].map(
        (x, k) => Math.abs((x - low[k]) / (high[k] - low[k]) * 32767 - grid[to][k])));
    const turns = [0, 1, 2].map((turn) => model.faces[f].map((from, k) => [from, corners[(k + turn) % 3]]));
    const off = turns.map((pairs) => Math.max(...pairs.map(([from, to]) => steps(from, to))));
    const best = off.indexOf(Math.min(...off));
    worst.step = Math.max(worst.step, off[best]);
    for (const [from, to] of turns[best]) {
      const [e, n, u] = model.normals[from], { east: x, north: y, up: z } = places[to];
      const normal = unit(x.map((_, k) => e * x[k] + n * y[k] + u * z[k]));
      const stored = octDecoded(read.extensions.vertexNormals[2 * to], read.extensions.vertexNormals[2 * to + 1]);
      worst.normal = Math.max(worst.normal, Math.acos(Math.min(1, dot(normal, stored))) * 180 / Math.PI);
    }
  }
  if (worst.step > 0.51) faults.push(`a vertex is off by ${worst.step} steps`);  // of PLY's floats the hundredth
  // Two bytes take a degree at most; and the tile is 1,719 x 823 m of the globe, where the model has 1,800 x 800.
  if (worst.normal > 2.5) faults.push(`a normal is off by ${worst.normal} degrees`);

  const named = { west: [0, 0], south: [1, 0], east: [0, 32767], north: [1, 32767] };
  for (const [side, [k, value]] of Object.entries(named)) {
    const there = grid.map((p, v) => [p[k], v]).filter(([at]) => at === value).map(([, v]) => v);
    const listed = [...read[`${side}Indices`]].sort((a, b) => a - b);
    if (there.length < 2 || String(there) !== String(listed)) faults.push(`the vertices of the ${side} are not those listed`);
  }

  const center = ['X', 'Y', 'Z'].map((k) => head[`boundingSphereCenter${k}`]), radius = head.boundingSphereRadius;
  const reach = Math.max(...places.map(({ at }) => length(minus(at, center))));
  if (!(reach <= radius && radius < reach + 0.1)) faults.push(`the sphere of ${radius} m is to reach ${reach} m`);
  const point = ['X', 'Y', 'Z'].map((k) => head[`horizonOcclusionPoint${k}`]);
  const away = length(minus(point, occlusionPoint(center, places.map(({ at }) => at))));
  if (!(away < 1e-9)) faults.push(`the horizon occlusion point is off by ${away} radii`);

  console.log(`tile: ${faces} faces, off by ${worst.step} steps, normals by ${worst.normal} degrees, ` +
              `the horizon occlusion point by ${away} radii`);
  for (const fault of faults) console.log(`FAILED: tile: ${fault}`);
  return faults.length > 0 ? 1 : 0;
}

try {
  process.exitCode = main(process.argv.slice(2));
} catch (error) {
  console.error(`heights_tile: ${error.message}`);
  process.exitCode = 2;
}
