// assbin.js - a mesh as `assimp export FILE READ.assbin -fassbin` dumps it: floats as they are in assimp's memory.
'use strict';
const fs = require('fs');

// Of assimp's dump: a header of 512 bytes, then chunks of a number, a length and contents. The scene, 0x1239, holds seven
// counts and chunks, of which 0x1237 is a mesh.
function readAssbin(file) {
  const bytes = fs.readFileSync(file);
  const meshes = [];
  if (bytes.readUInt32LE(512) !== 0x1239) throw new Error(`${file} is no dump of assimp's`);
  for (let at = 520 + 28; at + 8 <= bytes.length; at += 8 + bytes.readUInt32LE(at + 4))
    if (bytes.readUInt32LE(at) === 0x1237) meshes.push(readAssbinMesh(bytes, at + 8));
  if (meshes.length !== 1) throw new Error(`assimp found ${meshes.length} meshes`);
  return meshes[0];
}

function readAssbinMesh(bytes, start) {
  const [, vertices, count, bones, , parts] = [0, 1, 2, 3, 4, 5].map((k) => bytes.readUInt32LE(start + 4 * k));
  let at = start + 24;
  const floats = (n) => {
    const read = [];
    for (let i = 0; i < n; ++i, at += 4) read.push(bytes.readFloatLE(at));
    return read;
  };
  const vectors = (size) => Array.from({ length: vertices }, () => floats(size));
  const mesh = { positions: vectors(3), normals: [], colors: [], places: [], faces: [] };
  if (bones > 0 || (parts & 1) === 0) throw new Error('assimp found no plain mesh');
  if (parts & 2) mesh.normals = vectors(3);
  if (parts & 4) vectors(3), vectors(3);   // tangents and bitangents
  if (parts & 0x10000) mesh.colors = vectors(4);
  if (parts & 0x100) at += 4, mesh.places = vectors(3);  // behind how many of the three count
  if (parts & ~0x10107) throw new Error(`assimp found more than it should: ${parts.toString(16)}`);
  for (let f = 0; f < count; ++f) {
    const face = [];
    const size = bytes.readUInt16LE(at);
    at += 2;
    for (let k = 0; k < size; ++k, at += vertices < 65536 ? 2 : 4)
      face.push(vertices < 65536 ? bytes.readUInt16LE(at) : bytes.readUInt32LE(at));
    mesh.faces.push(face);
  }
  return mesh;
}

module.exports = { readAssbin };
