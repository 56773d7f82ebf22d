// models_compare.js - what assimp read from a model against the mesh: node models_compare.js MESH.ply KIND READ.assbin
//
// MESH.ply is as write_ply() makes it by default, and is read here; READ.assbin is what `assimp export FILE READ.assbin
// -fassbin` makes of the file in question: floats as they are in assimp's memory. KIND is that file's: ply, obj or glb. Faces
// are compared corner by corner, since assimp gives each corner of an OBJ a vertex of its own. Positions must be equal and
// colours within 1/255; those of a glb must be the PLY's in linear light, within 1/65535, for which the mesh's colours must
// have been rounded to 8 bits, as they are when it comes from such an image. Exit status 0, 1 or 2.
'use strict';
const fs = require('fs');
const { readAssbin } = require('./assbin.js');

// -> { positions: [x, y, z]..., colors: [r, g, b, a]... in [0, 1], faces: [a, b, c]... }
function readPly(file) {
  const bytes = fs.readFileSync(file);
  const end = bytes.indexOf('end_header\n') + 11;
  const header = bytes.toString('latin1', 0, end);
  if (!header.startsWith('ply\nformat binary_little_endian 1.0\n')) throw new Error(`${file} is no binary PLY file`);
  const vertices = Number(/element vertex (\d+)/.exec(header)[1]), count = Number(/element face (\d+)/.exec(header)[1]);
  const channels = (header.match(/property uchar/g) || []).length;
  const mesh = { channels, positions: [], colors: [], faces: [] };
  let at = end;
  for (let v = 0; v < vertices; ++v, at += 12 + channels) {
    mesh.positions.push([0, 4, 8].map((k) => bytes.readFloatLE(at + k)));
    const stored = [...bytes.subarray(at + 12, at + 12 + channels)].map((value) => value / 255);
    mesh.colors.push(channels === 1 ? [stored[0], stored[0], stored[0], 1] : channels === 3 ? [...stored, 1] : stored);
  }
  for (let f = 0; f < count; ++f, at += 13) mesh.faces.push([1, 5, 9].map((k) => bytes.readInt32LE(at + k)));
  if (at !== bytes.length) throw new Error(`${file} has ${bytes.length} bytes, not ${at}`);
  return mesh;
}

// IEC 61966-2-1.
const linear = (share) => (share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4);

function main([ply, kind, dump]) {
  if (!dump || !['ply', 'obj', 'glb'].includes(kind))
    throw new Error('usage: models_compare.js MESH.ply ply|obj|glb READ.assbin');
  const mesh = readPly(ply), read = readAssbin(dump);
  if (read.places.length > 0) throw new Error('assimp found more than colours');
  const wanted = kind === 'glb' ? mesh.colors.map(([r, g, b, a]) => [linear(r), linear(g), linear(b), a]) : mesh.colors;
  const channels = kind === 'obj' ? 3 : 4;  // OBJ has no alpha
  // assimp knows no `intensity`.
  const hasColors = kind !== 'ply' || mesh.channels > 1;
  const faults = [];
  const vertices = kind === 'obj' ? 3 * mesh.faces.length : mesh.positions.length;
  if (read.positions.length !== vertices) faults.push(`${read.positions.length} vertices, not ${vertices}`);
  if (read.faces.length !== mesh.faces.length) faults.push(`${read.faces.length} faces, not ${mesh.faces.length}`);
  if (hasColors && read.colors.length !== vertices) faults.push(`${read.colors.length} colours, not ${vertices}`);
  let moved = 0, worst = 0;
  for (let f = 0; f < mesh.faces.length && faults.length === 0; ++f)
    for (let k = 0; k < 3; ++k) {
      const to = mesh.faces[f][k], from = read.faces[f][k];
      if (kind !== 'obj' && to !== from) faults.push(`face ${f} has corner ${from}, not ${to}`);
      if (mesh.positions[to].some((x, i) => x !== read.positions[from][i])) ++moved;
      for (let c = 0; c < channels && hasColors; ++c) worst = Math.max(worst, Math.abs(wanted[to][c] - read.colors[from][c]));
    }
  if (moved > 0) faults.push(`${moved} corners have another position`);
  const steps = kind === 'glb' ? 65535 : 255;
  if (worst * steps > 1) faults.push(`a colour is off by ${worst}`);
  const colors = hasColors ? `colours off by ${(worst * steps).toFixed(4)} / ${steps} at most` : 'no colours asked for';
  console.log(`${kind}: ${mesh.positions.length} vertices, ${read.faces.length} faces, ${moved} corners moved, ${colors}`);
  for (const fault of faults) console.log(`FAILED: ${kind}: ${fault}`);
  return faults.length > 0 ? 1 : 0;
}

try {
  process.exitCode = main(process.argv.slice(2));
} catch (error) {
  console.error(`models_compare: ${error.message}`);
  process.exitCode = 2;
}
