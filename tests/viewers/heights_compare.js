// heights_compare.js - what assimp read from a model of heights: node heights_compare.js MODEL.ply KIND READ.assbin
//
// MODEL.ply is as write_height_ply() makes it, and is read here; READ.assbin is assimp's dump of the file in question (assbin.js).
// KIND is that file's: ply, obj, glb or stl. Each corner of each face must be at the same place, have the same normal and the same
// texture coordinates (not of STL, which has the normals of faces); glb has y up, and v down, which assimp turns. Exit status 0, 1 or 2.
'use strict';
const fs = require('fs');
const { readAssbin } = require('./assbin.js');

// -> { positions, normals: [x, y, z]..., places: [u, v]..., faces: [a, b, c]... }
function readPly(file) {
  const bytes = fs.readFileSync(file);
  const end = bytes.indexOf('end_header\n') + 11;
  const head = bytes.toString('latin1', 0, end);
  const names = [...head.matchAll(/property float (\w+)/g)].map((match) => match[1]).join(' ');
  if (names !== 'x y z nx ny nz s t') throw new Error(`${file} has vertices of ${names}`);
  const vertices = Number(/element vertex (\d+)/.exec(head)[1]), count = Number(/element face (\d+)/.exec(head)[1]);
  const model = { positions: [], normals: [], places: [], faces: [] };
  let at = end;
  const floats = (n) => Array.from({ length: n }, () => bytes.readFloatLE((at += 4) - 4));
  for (let v = 0; v < vertices; ++v) {
    model.positions.push(floats(3));
    model.normals.push(floats(3));
    model.places.push(floats(2));
  }
  for (let f = 0; f < count; ++f, at += 13) model.faces.push([1, 5, 9].map((k) => bytes.readInt32LE(at + k)));
  if (at !== bytes.length) throw new Error(`${file} has ${bytes.length} bytes, not ${at}`);
  return model;
}

const distance = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));

function main([ply, kind, dump]) {
  if (!dump || !['ply', 'obj', 'glb', 'stl'].includes(kind))
    throw new Error('usage: heights_compare.js MODEL.ply ply|obj|glb|stl READ.assbin');
  const model = readPly(ply), read = readAssbin(dump);
  const inFile = ([x, y, z]) => (kind === 'glb' ? [x, z, -y] : [x, y, z]);
  const faults = [];
  if (read.faces.length !== model.faces.length) faults.push(`${read.faces.length} faces, not ${model.faces.length}`);
  if (read.normals.length !== read.positions.length) faults.push(`${read.normals.length} normals`);
  if (kind !== 'stl' && read.places.length !== read.positions.length) faults.push(`${read.places.length} texture coordinates`);
  const worst = { position: 0, normal: 0, place: 0 };
  for (let f = 0; f < model.faces.length && faults.length === 0; ++f) {
    const [a, b, c] = model.faces[f].map((v) => model.positions[v]);
    const edge = (from, to) => to.map((x, k) => x - from[k]), p = edge(a, b), q = edge(a, c);
    const cross = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
    for (let k = 0; k < 3; ++k) {
      const to = model.faces[f][k], from = read.faces[f][k];
      const normal = kind === 'stl' ? cross.map((x) => x / Math.hypot(...cross)) : model.normals[to];
      worst.position = Math.max(worst.position, distance(inFile(model.positions[to]), read.positions[from]));
      worst.normal = Math.max(worst.normal, distance(inFile(normal), read.normals[from]));
      if (kind !== 'stl') worst.place = Math.max(worst.place, distance(model.places[to], read.places[from].slice(0, 2)));
    }
  }
  if (worst.position > 1e-4) faults.push(`a position is off by ${worst.position}`);  // OBJ has nine digits
  if (worst.normal > 1e-5) faults.push(`a normal is off by ${worst.normal}`);
  if (worst.place > 1e-6) faults.push(`a texture coordinate is off by ${worst.place}`);
  console.log(`${kind}: ${read.faces.length} faces, off by ${worst.position}, normals by ${worst.normal}, ` +
              `texture coordinates by ${worst.place} at most`);
  for (const fault of faults) console.log(`FAILED: ${kind}: ${fault}`);
  return faults.length > 0 ? 1 : 0;
}

module.exports = { readPly };

if (require.main === module) {
  try {
    process.exitCode = main(process.argv.slice(2));
  } catch (error) {
    console.error(`heights_compare: ${error.message}`);
    process.exitCode = 2;
  }
}
