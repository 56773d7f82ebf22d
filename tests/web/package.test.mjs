// The package as node has it: what it makes, what it refuses, and that it can be used afterwards.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { readFile } from 'node:fs/promises';
import { relative } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { Worker } from 'node:worker_threads';
import { brotliCompressSync } from 'node:zlib';
import { hash, hashOf, picture } from './pictures.mjs';

const folder = pathToFileURL(`${process.env.HMESH_NPM}/`);
const { HmeshError, Mesher, init, meshImage } = await import(new URL('index.node.js', folder));
const { Hmesh, compileCompact, compileHmesh, load } = await import(new URL('core.node.js', folder));
const image = picture(64, 48);

// The error that a call, synchronous or not, ends with.
async function errorOf(call) {
  try {
    await call();
  } catch (error) {
    return error;
  }
  return assert.fail('nothing was thrown');
}

// Whether it is a whole mesh of its picture: its faces, all turned alike, have the picture's area.
function assertMesh(mesh, { width, height }, channels) {
  assert.equal(mesh.width, width);
  assert.equal(mesh.height, height);
  assert.equal(mesh.channels, channels);
  assert.equal(mesh.positions.length, 2 * mesh.vertices);
  assert.equal(mesh.colors.length, channels * mesh.vertices);
  assert.equal(mesh.indices.length, 3 * mesh.faces);
  assert.ok(mesh.positions instanceof Float32Array && mesh.colors instanceof Uint8Array && mesh.indices instanceof Uint32Array);
  let twice = 0;
  for (let f = 0; f < mesh.faces; ++f) {
    const [a, b, c] = [0, 1, 2].map((k) => mesh.indices[3 * f + k]).map((v) => [mesh.positions[2 * v], mesh.positions[2 * v + 1]]);
    const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    assert.ok(area > 0);
    twice += area;
  }
  assert.equal(twice, 2 * width * height);
}

// PSNR of a drawn mesh against its RGB image, in dB.
function psnrOf(drawn, { data }) {
  let sum = 0, count = 0;
  for (let i = 0; i < data.length; ++i)
    if (i % 4 !== 3) {
      sum += (drawn.data[i] - data[i]) ** 2;
      ++count;
    }
  return 10 * Math.log10(255 ** 2 * count / sum);
}

test('meshImage() gives a mesh of so many vertices that covers the image, and its PSNR is that of its picture', async () => {
  const mesh = await meshImage(image, { vertices: 200 });
  assertMesh(mesh, image, 3);
  assert.equal(mesh.vertices, 200);
  assert.equal(mesh.complete, true);
  const drawn = (await load()).render(mesh);
  assert.ok(Math.abs(psnrOf(drawn, image) - mesh.psnr) < 0.05);  // the picture is rounded
});

test('a target is a number of vertices, a percentage, a PSNR, or one percent', async () => {
  const hmesh = await load();
  assert.equal(hmesh.meshImage(image, { percent: 5 }).vertices, Math.round(64 * 48 * 0.05));
  assert.equal(hmesh.meshImage(image).vertices, Math.round(64 * 48 * 0.01));
  const reached = hmesh.meshImage(image, { psnr: 25 });
  assert.ok(reached.psnr >= 25 && reached.complete);
  const missed = hmesh.meshImage(image, { psnr: 90, effort: 'draft' });
  assert.ok(missed.psnr < 90 && !missed.complete);
});

test('an image whose alpha is 255 is meshed as RGB, others as RGBA', async () => {
  const hmesh = await load(), rgb = new Uint8Array(64 * 48 * 3).map((_, k) => image.data[4 * Math.floor(k / 3) + k % 3]);
  assert.equal(hashOf(hmesh.meshImage({ ...image, data: rgb, channels: 3 })), hashOf(hmesh.meshImage(image)));
  const soft = picture(64, 48, { alpha: true });
  const straight = hmesh.meshImage(soft, { vertices: 100 }), multiplied = hmesh.meshImage(soft, { vertices: 100, premultiplied: true });
  assertMesh(straight, soft, 4);
  assertMesh(multiplied, soft, 4);
  assert.deepEqual([straight.premultiplied, multiplied.premultiplied], [false, true]);
  assert.notEqual(hashOf(straight), hashOf(multiplied));
});

test('a target in bytes gives a compact file of no more, nearly all of them, and the mesh that it holds', async () => {
  for (const alpha of [false, true]) {
    const large = picture(200, 150, { alpha }), mesher = new Mesher(), told = [];
    mesher.setImage(large);
    const before = await mesher.meshImage({ vertices: 100, effort: 'draft' });
    const mesh = await mesher.meshImage({ bytes: 1500, effort: 'fast', onProgress: ({ total }) => told.push(total) });
    assertMesh(mesh, large, alpha ? 4 : 3);
    assert.ok(mesh.file.length <= 1500 && mesh.file.length >= 1470, `${mesh.file.length} bytes`);
    assert.deepEqual([mesh.complete, mesh.effort, told.at(-1)], [true, 'fast', 1]);
    assert.deepEqual(told, [...told].sort((a, b) => a - b));
    const drawn = await mesher.render({ mesh });
    if (!alpha) assert.ok(Math.abs(psnrOf(drawn, large) - mesh.psnr) < 1e-6);
    assert.equal(hashOf(await mesher.read(mesh.file)), hashOf(mesh));  // by another worker, of another module
    assert.equal(hash((await mesher.meshImage({ bytes: 1500, effort: 'fast' })).file), hash(mesh.file));
    assert.equal(hashOf(await mesher.meshImage({ vertices: 100, effort: 'draft' })), hashOf(before));
    mesher.close();
  }
});

test('of the bare profile, and stopped or with too few bytes', async () => {
  const hmesh = new Hmesh(await compileCompact()), reader = await load();
  const mesh = hmesh.meshImage(image, { bytes: 300, bare: true, effort: 'draft' });
  assert.equal(hashOf(reader.read(mesh.file, { bare: true })), hashOf(mesh));
  assert.ok(mesh.file.length <= 300);
  assert.equal((await errorOf(() => hmesh.meshImage(image, { bytes: 300, onProgress: () => false }))).code, 'cancelled');
  const thrown = new Error('no more');
  assert.equal(await errorOf(() => hmesh.meshImage(image, { bytes: 300, onProgress() { throw thrown; } })), thrown);
  const few = await errorOf(() => hmesh.meshImage(image, { bytes: 20 }));
  assert.equal(few.code, 'target_out_of_range');
  assert.match(few.message, /even of 4 vertices \(.*20\)/);
  assert.match((await errorOf(() => reader.meshImage(image, { bytes: 300 }))).message, /hmesh\.compact\.wasm/);
  assert.match((await errorOf(() => hmesh.write(mesh, 'ply'))).message, /hmesh\.wasm does/);
  const bound = new AbortController(), mesher = new Mesher();
  mesher.setImage(picture(300, 200));
  const stopped = errorOf(() => mesher.meshImage({ bytes: 3000, effort: 'best', signal: bound.signal, onProgress() { bound.abort(); } }));
  assert.equal((await stopped).name, 'AbortError');
  assert.equal((await mesher.meshImage({ vertices: 70, effort: 'draft' })).vertices, 70);
  mesher.close();
});

test('weights move vertices to where they are large, and a seed gives another mesh', async () => {
  const hmesh = await load();
  const weights = new Float32Array(64 * 48).map((_, k) => (k % 64 < 32 ? 1 : 0));
  const left = (mesh) => Array.from({ length: mesh.vertices }, (_, v) => mesh.positions[2 * v] < 32).filter(Boolean).length / mesh.vertices;
  assert.ok(left(hmesh.meshImage(image, { vertices: 100, weights })) > 0.85);
  assert.ok(left(hmesh.meshImage(image, { vertices: 100 })) < 0.7);
  assert.notEqual(hashOf(hmesh.meshImage(image, { seed: 2 })), hashOf(hmesh.meshImage(image, { seed: 1 })));
});

test('refine() gives valid meshes and last, alone complete, the one of meshImage()', async () => {
  const mesher = new Mesher(), large = picture(200, 150), meshes = [];
  mesher.setImage(large);
  for await (const mesh of mesher.refine({ vertices: 600 })) meshes.push(mesh);
  assert.ok(meshes.length >= 5 && meshes.length <= 40, `${meshes.length} meshes`);
  for (const mesh of meshes) assertMesh(mesh, large, 3);
  assert.deepEqual(meshes.map((mesh) => mesh.complete), meshes.map((_, k) => k + 1 === meshes.length));
  assert.equal(hashOf(meshes.at(-1)), hashOf(await meshImage(large, { vertices: 600 })));
  assert.equal(mesher.mesh, meshes.at(-1));
  const drawn = [];
  for (const mesh of [meshes[0], meshes.at(-1)]) drawn.push(psnrOf(await mesher.render({ mesh }), large));
  assert.ok(Math.abs(drawn[0] - meshes[0].psnr) < 0.2 && drawn[0] > 15);  // its colours are not the last ones, and rounded
  mesher.close();
});

test('who leaves the loop of refine() stops it, and can go on with the Mesher', async () => {
  const mesher = new Mesher();
  mesher.setImage(picture(300, 200));
  for await (const mesh of mesher.refine({ vertices: 2000, effort: 'best' })) {
    assert.equal(mesh.complete, false);
    break;
  }
  assert.equal((await mesher.meshImage({ vertices: 50, effort: 'draft' })).vertices, 50);
  mesher.close();
});

test('progress rises to 1, and what it throws ends the call', async () => {
  const told = [], thrown = new Error('no more');
  await meshImage(image, { vertices: 100, onProgress: (progress) => told.push(progress) });
  const totals = told.map(({ total }) => total);
  assert.deepEqual(totals, [...totals].sort((a, b) => a - b));
  assert.equal(totals.at(-1), 1);
  assert.ok(new Set(told.map(({ stage }) => stage)).size > 3);
  assert.equal(await errorOf(() => meshImage(image, { onProgress() { throw thrown; } })), thrown);
  const hmesh = await load();
  assert.equal(await errorOf(() => hmesh.meshImage(image, { onProgress() { throw thrown; } })), thrown);
  assert.equal(await errorOf(() => hmesh.meshImage(image, { onMesh() { throw thrown; } })), thrown);
  for (const what of [new RangeError('mine'), null, undefined]) {  // whatever it is
    assert.equal(await errorOf(() => hmesh.meshImage(image, { onProgress() { throw what; } })), what);
    assert.equal(await errorOf(() => meshImage(image, { onProgress() { throw what; } })), what);
  }
  const stopped = hmesh.meshImage(image, { onProgress: ({ total }) => total < 0.5 });
  assertMesh(stopped, image, 3);
  assert.equal(stopped.complete, false);
  // A mesh made meanwhile leaves the one on its way its callbacks.
  let heard = 0;
  const outer = hmesh.meshImage(image, { vertices: 100, onMesh() {
    if (heard++ === 0) assert.equal(hmesh.meshImage(image, { vertices: 40, effort: 'draft' }).vertices, 40);
  } });
  assert.ok(heard > 1, `${heard} meshes`);
  assert.equal(hashOf(outer), hashOf(hmesh.meshImage(image, { vertices: 100 })));
});

test('an AbortSignal ends what is at work and what waits, by a flag, and the same worker goes on', async () => {
  let workers = 0;
  await init({ worker: () => ++workers && new Worker(new URL('worker.node.js', folder)) });
  const mesher = new Mesher();
  mesher.setImage(picture(300, 200));
  const atWork = new AbortController(), waiting = new AbortController();
  const first = errorOf(() => mesher.meshImage({ vertices: 5000, effort: 'best', signal: atWork.signal, onProgress() { atWork.abort(); } }));
  const second = errorOf(() => mesher.meshImage({ vertices: 60, signal: waiting.signal }));
  const third = mesher.meshImage({ vertices: 70, effort: 'draft' });
  waiting.abort(new Error('not that one'));
  assert.equal((await second).message, 'not that one');
  assert.equal((await first).name, 'AbortError');
  assert.equal((await third).vertices, 70);
  assert.equal(workers, 1);
  for (const why of [null, 0, '']) {  // a reason is one, whatever it is
    const controller = new AbortController();
    const stopped = errorOf(() => mesher.meshImage({ vertices: 5000, effort: 'best', signal: controller.signal, onProgress() { controller.abort(why); } }));
    assert.equal(await stopped, why);
  }
  const reason = new Error('at once');
  assert.equal(await errorOf(() => mesher.write('ply', { signal: AbortSignal.abort(reason) })), reason);
  assert.equal(await errorOf(() => mesher.meshImage({ signal: AbortSignal.abort(reason) })), reason);
  assert.match((await errorOf(() => mesher.meshImage({ vertices: 5000, effort: 'best', onProgress() { mesher.close(); } }))).message, /closed/);
  assert.equal((await mesher.meshImage({ vertices: 70, effort: 'draft' })).vertices, 70);
  assert.equal(workers, 2);
  mesher.close();
});

test('files begin as their formats do, and those of .hmc come back', async () => {
  const mesher = new Mesher();
  mesher.setImage(image);
  const mesh = await mesher.meshImage({ vertices: 100 });
  const text = async (format, options) => Buffer.from(await mesher.write(format, options)).toString('latin1');
  assert.match(await text('ply'), /^ply\nformat binary_little_endian 1\.0\n(.*\n)*element vertex 100\n/);
  assert.match(await text('obj'), /^(#.*\n)*v /);
  assert.match(await text('pdf'), /^%PDF-1\.4/);
  assert.match(await text('svg'), /^<svg [^]*linearGradient[^]*<\/svg>\n$/);
  assert.doesNotMatch(await text('svg', { kind: 'flat' }), /linearGradient|vector-effect/);
  assert.match(await text('svg', { kind: 'flat', wireframe: true }), /vector-effect/);
  assert.match(await text('html', { title: 'a < b' }), /<title>a &lt; b<\/title>/);
  assert.match(await text('html', { title: 'a\0b' }), /<title>ab<\/title>/);  // a NUL is no letter of a page
  assert.match(await text('html', { original: new Uint8Array([1, 2, 3]), originalType: 'image/x' }), /data:image\/x;base64,AQID/);
  const glb = Buffer.from(await mesher.write('glb'));
  assert.equal(glb.toString('latin1', 0, 4), 'glTF');
  assert.equal(glb.readUInt32LE(8), glb.length);
  // Those that wait take the mesh of the call before them.
  const [other, file, drawn] = await Promise.all([mesher.meshImage({ vertices: 60 }), mesher.write('ply'), mesher.render()]);
  assert.equal(other.vertices, 60);
  assert.match(Buffer.from(file).toString('latin1'), /element vertex 60\n/);
  assert.equal(hash(drawn.data), hash((await mesher.render({ mesh: other })).data));
  const made = await mesher.meshImage({ bytes: 300, bare: true }), bare = await mesher.read(made.file, { bare: true });
  assert.equal(hashOf(bare), hashOf(made));
  assert.equal(mesher.mesh, bare);
  const back = await mesher.read(await mesher.write('hmc', { mesh }));
  assert.equal(mesher.mesh, back);
  assert.equal(hash((await mesher.render()).data), hash((await mesher.render({ mesh })).data));  // vertices come in another order
  assertMesh(back, image, 3);
  mesher.close();
});

test('what is no image, no option and no mesh is refused with a sentence that names it, and the next call is served', async () => {
  const hmesh = await load(), mesher = new Mesher(), { data } = image;
  const gone = new Uint8Array(64 * 48 * 4);
  structuredClone(gone, { transfer: [gone.buffer] });
  const images = [
    [undefined, /no data/], [null, /no data/], [42, /no data/], [{}, /no data/], [{ data: [1, 2, 3, 4], width: 1, height: 1 }, /no data/],
    [{ data: new Float32Array(4), width: 1, height: 1 }, /no data/], [{ data: new Int8Array(4), width: 1, height: 1 }, /no data/],
    [{ data, width: NaN, height: 48 }, /width .*NaN/], [{ data, width: 64, height: '48' }, /height .*48/],
    [{ data, width: 64.5, height: 48 }, /64\.5/], [{ data, width: -64, height: -48 }, /-64/], [{ data, width: Infinity, height: 1 }, /Infinity/],
    [{ data: new Uint8Array(0), width: 0, height: 0 }, /width .*0$/], [{ data, width: 65537, height: 1 }, /65537/],
    [{ data, width: 64, height: 47 }, /12288 bytes .*12032/], [{ data: gone, width: 64, height: 48 }, /has 0 bytes/],
    [{ data, width: 65536, height: 65536 }, /12288 bytes/], [{ data, width: 64, height: 48, channels: 1 }, /channels.*1$/],
    [{ data, width: Symbol('x'), height: 48 }, /Symbol/], [{ data, width: 10n, height: 48 }, /width/],
  ];
  for (const [bad, sentence] of images)
    for (const call of [() => hmesh.meshImage(bad), () => mesher.setImage(bad), () => meshImage(bad)]) {
      const error = await errorOf(call);
      assert.ok(error instanceof HmeshError, String(error));
      assert.match(error.message, sentence);
      assert.equal(error.code, 'invalid_argument');
    }
  mesher.setImage(image);
  const options = [
    [{ vertices: 3 }, /at least 4 vertices \(3/], [{ vertices: 1e6 }, /at most one vertex a pixel \(1000000, limit 3072\)/],
    [{ vertices: Infinity }, /at most one vertex a pixel/],
    [{ vertices: NaN }, /not finite/], [{ vertices: '100' }, /vertices must be a number: 100/], [{ percent: 0 }, /above 0/], [{ percent: 101 }, /101/],
    [{ psnr: -1 }, /positive/], [{ psnr: Infinity }, /finite/], [{ vertices: 10, psnr: 30 }, /vertices, psnr/], [{ vertices: 10n }, /number: 10/],
    [{ effort: 'hard' }, /effort .*hard/], [{ effort: Symbol('x') }, /effort .*Symbol/], [{ seed: -1 }, /seed .*-1/], [{ seed: 0.5 }, /seed .*0\.5/],
    [{ seed: 2 ** 53 }, /seed/], [{ weights: [1] }, /Float32Array/], [{ weights: new Float32Array(5) }, /64 x 48 numbers: 5/],
    [{ bytes: 0 }, /bytes must be from 1 to .*: 0/], [{ bytes: NaN }, /NaN/], [{ bytes: '300' }, /bytes must be a number: 300/],
    [{ bytes: 300, vertices: 10 }, /vertices, bytes/], [{ bytes: 300, weights: new Float32Array(64 * 48) }, /knows no weights/],
    [{ bare: true }, /bare is of a target in bytes alone: percent/],
    [{ weights: new Float32Array(64 * 48).fill(-1) }, /negative/], [{ weights: new Float32Array(64 * 48).fill(NaN) }, /NaN/],
    [{ weights: new Float32Array(64 * 48) }, /all zero/],
  ];
  for (const [bad, sentence] of options)
    for (const call of [() => hmesh.meshImage(image, bad), () => mesher.meshImage(bad)]) {
      const error = await errorOf(call);
      assert.ok(error instanceof HmeshError, String(error));
      assert.match(error.message, sentence);
    }
  const mesh = hmesh.meshImage(image, { vertices: 50 });
  const meshes = [
    [undefined, /no mesh/], [{}, /positions/], [{ ...mesh, positions: [] }, /positions/], [{ ...mesh, colors: new Uint8Array(3) }, /fit together/],
    [{ ...mesh, indices: new Uint32Array(4) }, /fit together/], [{ ...mesh, positions: mesh.positions.slice(1) }, /fit together/],
    [{ ...mesh, indices: mesh.indices.map(() => 50) }, /names no vertex/], [{ ...mesh, positions: mesh.positions.map(() => NaN) }, /NaN/],
    [{ ...mesh, width: 0 }, /width/], [{ ...mesh, height: 1e9 }, /height/], [{ ...mesh, channels: 2 }, /channels/],
    [{ ...mesh, positions: new Float32Array(0), colors: new Uint8Array(0) }, /no vertices/],
    [{ ...mesh, positions: new Float32Array(2003), colors: new Uint8Array(4006), channels: 4 }, /fit together/],  // 1001.5 vertices
  ];
  for (const [bad, sentence] of meshes)
    for (const call of [() => hmesh.write(bad, 'ply'), () => mesher.write('ply', { mesh: bad }), () => hmesh.render(bad, { width: 5, height: 5 })])
      assert.match((await errorOf(call)).message, sentence);
  assert.match((await errorOf(() => hmesh.write(mesh, 'bmp'))).message, /format .*bmp/);
  assert.match((await errorOf(() => hmesh.write(mesh, 'svg', { kind: 'oil' }))).message, /oil/);
  for (const lattice of [-1, 0.001, 'x', 2 ** 24, 1n, Symbol('x')]) assert.match((await errorOf(() => hmesh.write(mesh, 'hmc', { bare: true, lattice }))).message, /lattice/);
  for (const colorStep of [-1, 0.5, 'x', 4096])
    assert.match((await errorOf(() => hmesh.write(mesh, 'hmc', { bare: true, lattice: 1, colorStep }))).message, /colorStep/);
  assert.match((await errorOf(() => hmesh.write(mesh, 'html', { original: new Uint8Array(1), originalType: 'a b' }))).message, /media type/);
  assert.match(new TextDecoder().decode(hmesh.write(mesh, 'html', { title: Symbol('x') })), /<title>Symbol\(x\)<\/title>/);
  assert.match((await errorOf(() => hmesh.render(mesh, { width: 1e6 }))).message, /1000000/);
  for (const file of [undefined, 'text', new Uint8Array(0), new Uint8Array(100)]) assert.ok((await errorOf(() => hmesh.read(file))) instanceof HmeshError);
  const file = hmesh.write(mesh, 'hmc');
  for (let k = 0; k < file.length; ++k) {
    const damaged = file.slice();
    damaged[k] ^= 1 << (k % 8);
    assert.ok((await errorOf(() => hmesh.read(damaged))) instanceof HmeshError);
  }
  assert.match((await errorOf(() => new Mesher().meshImage())).message, /no image/);
  for (const call of [() => new Mesher().write('ply'), () => new Mesher().render()]) assert.match((await errorOf(call)).message, /no mesh/);
  for (const call of [() => mesher.write(undefined, { mesh }), () => mesher.write('', { mesh })]) assert.match((await errorOf(call)).message, /format .*none of/);
  assert.match((await errorOf(() => mesher.read())).message, /bytes of a file/);
  assert.equal(hashOf(hmesh.meshImage(image, { vertices: 50 })), hashOf(mesh));
  assert.equal(hashOf(await mesher.meshImage({ vertices: 50 })), hashOf(mesh));
  mesher.close();
});

test('null for options is none, and what is no module is refused by its name', async () => {
  const module = await compileHmesh(), hmesh = new Hmesh(module, null), mesher = new Mesher();
  const mesh = hmesh.meshImage(image, null), file = hmesh.write(mesh, 'hmc', null), read = hashOf(hmesh.read(file));
  assert.equal(hashOf(hmesh.read(file, null)), read);
  const drawn = hash(hmesh.render(mesh, null).data);
  mesher.setImage(image);
  assert.equal(hashOf(await mesher.meshImage(null)), hashOf(mesh));
  assert.equal(hash(await mesher.write('hmc', null)), hash(file));
  assert.equal(hash((await mesher.render(null)).data), drawn);
  assert.equal(hashOf(await mesher.read(file, null)), read);
  mesher.close();
  for (const bad of [undefined, null, {}, 42, new Uint8Array(8), compileHmesh()]) {
    const error = await errorOf(() => new Hmesh(bad));
    assert.match(error.message, /no WebAssembly\.Module: /);
    assert.equal(error.code, 'invalid_argument');
  }
});

test('what was transferred before the worker was sent it, or cannot be sent, fails that call alone', async () => {
  const mesher = new Mesher(), late = picture(64, 48), weights = new Float32Array(64 * 48).fill(1);
  const transfer = ({ buffer }) => structuredClone(buffer, { transfer: [buffer] });
  const isRefused = async (call) => assert.equal((await errorOf(() => call)).name, 'DataCloneError');
  mesher.setImage(late);
  transfer(late.data);
  await isRefused(mesher.meshImage({ vertices: 50 }));
  mesher.setImage(image);
  const weighted = mesher.meshImage({ vertices: 50, weights });
  transfer(weights);
  await isRefused(weighted);
  const mesh = await mesher.meshImage({ vertices: 50 });
  await isRefused(mesher.write('ply', { mesh: { ...mesh, draw() {} } }));
  transfer(mesh.positions);
  await isRefused(mesher.write('ply'));
  await isRefused(mesher.render());
  assert.equal((await mesher.meshImage({ vertices: 50 })).vertices, 50);
  mesher.close();
});

test('out of memory is said in a sentence, and the instance serves the next call', async () => {
  const hmesh = await load(undefined, { maximumMemory: 8 });
  for (const side of [1400, 1800, 3000]) {  // while it works, and before it begins
    const error = await errorOf(() => hmesh.meshImage({ data: new Uint8Array(3 * side * side), width: side, height: side, channels: 3 }));
    assert.ok(error instanceof HmeshError, String(error));
    assert.match(error.message, /out of memory: .*8 MiB/);
    assert.equal(error.code, 'out_of_memory');
    assert.equal(hmesh.meshImage(image, { vertices: 50 }).vertices, 50);
  }
  assert.equal((await errorOf(() => hmesh.render(hmesh.meshImage(image), { width: 3000, height: 3000 }))).code, 'out_of_memory');
  hmesh.free();
  assert.equal(hmesh.meshImage(image, { vertices: 50 }).vertices, 50);
  // A call within another one's callback that runs out of it takes the other one along, with a sentence.
  const large = { data: new Uint8Array(3 * 3000 * 3000), width: 3000, height: 3000, channels: 3 };
  let tries = 0;
  const outer = await errorOf(() => hmesh.meshImage(image, { onProgress() {
    if (tries++ === 0) assert.throws(() => hmesh.meshImage(large), { code: 'out_of_memory' });
  } }));
  assert.ok(outer instanceof HmeshError && /stopped/.test(outer.message), String(outer));
  // And so it does where calls after that one find memory again: what they make is not taken for the other one's.
  for (const name of ['onProgress', 'onMesh'])
    for (const giveBack of [() => hmesh.free(), () => assert.throws(() => hmesh.meshImage(large), { code: 'out_of_memory' })]) {
      let made;
      const lost = await errorOf(() => hmesh.meshImage(image, { vertices: 300, [name]() {
        if (made) return;
        giveBack();
        made = hmesh.meshImage(image, { vertices: 50 });
      } }));
      assert.ok(lost instanceof HmeshError && /stopped: a callback gave its memory back/.test(lost.message), String(lost));
      assert.equal(lost.code, 'cancelled');
      assert.equal(hashOf(made), hashOf(hmesh.meshImage(image, { vertices: 50 })));
    }
  assert.equal(hmesh.meshImage(image, { vertices: 50 }).vertices, 50);
  const module = await compileHmesh();
  for (const maximumMemory of [0, NaN, 4096, 'much']) assert.match((await errorOf(() => new Hmesh(module, { maximumMemory }))).message, /maximumMemory/);
});

test('threads give the bytes of one thread, and running out of memory ends none of them for good', async () => {
  let workers = 0;
  const worker = () => ++workers && new Worker(new URL('worker.node.js', folder)), large = picture(500, 400), mesher = new Mesher();
  mesher.setImage(large);
  const expected = hashOf((await load()).meshImage(large, { vertices: 3000 }));
  for (const threads of [1, 2, 5]) {
    await init({ worker, threads, maximumMemory: 64 });
    workers = 0;
    assert.equal(hashOf(await mesher.meshImage({ vertices: 3000 })), expected);
    assert.equal(workers, threads);
    mesher.setImage({ data: new Uint8Array(4000 * 4000 * 3), width: 4000, height: 4000, channels: 3 });
    assert.equal((await errorOf(() => mesher.meshImage({ vertices: 3000 }))).code, 'out_of_memory');
    mesher.setImage(large);
    assert.equal(hashOf(await mesher.meshImage({ vertices: 3000 })), expected);
    mesher.close();
  }
  for (const maximumMemory of [8, 16, 64]) {  // what helpers take leaves enough
    await init({ threads: 64, maximumMemory });
    assert.equal((await meshImage(image, { vertices: 50 })).vertices, 50);
  }
  for (const threads of [0, NaN, 65, 2n, Symbol('two')])
    assert.match((await errorOf(() => init({ threads }))).message, /threads must be from 1 to 64: (0|NaN|65|2|Symbol)/);
  for (const nothing of [undefined, null, { threads: null }]) await init(nothing);
  await init({ threads: 2, maximumMemory: 2048 });
});

test('a helper that fails in its part fails the call', async () => {
  const module = await compileHmesh(new URL('hmesh.threads.wasm', folder));
  const memory = new WebAssembly.Memory({ initial: 64, maximum: 640, shared: true }), hmesh = new Hmesh(module, { memory });
  const helpers = hmesh.stacks(3).map((stack) => {
    assert.equal(stack % 16, 0); // else the helper's code reads and writes beside its variables
    const helper = new Worker(new URL('worker.node.js', folder));
    helper.unref();
    helper.postMessage({ module, memory, stack });
    return helper;
  });
  const large = picture(500, 400), expected = hashOf((await load()).meshImage(large, { vertices: 3000 }));
  for (let k = 0; k < 3; ++k) assert.equal(hashOf(hmesh.meshImage(large, { vertices: 3000 })), expected);
  assert.equal((await errorOf(() => hmesh.meshImage(picture(2400, 1600), { percent: 10 }))).code, 'out_of_memory');
  assert.match((await errorOf(() => hmesh.meshImage(large))).message, /stopped before/);
  for (const helper of helpers) await helper.terminate();
});

test('a helper that traps ends the call, which does not tell of memory', async () => {
  const module = await compileHmesh(new URL('hmesh.threads.wasm', folder));
  const memory = new WebAssembly.Memory({ initial: 64, maximum: 4096, shared: true }), hmesh = new Hmesh(module, { memory });
  hmesh.stacks(0);  // the instance sets the memory up, which a helper finds
  const helper = new Worker(new URL('worker.node.js', folder));
  helper.unref();
  helper.postMessage({ module, memory, stack: 16 });  // no room for any variable
  const large = picture(500, 400), error = await errorOf(() => { for (let k = 0; k < 200; ++k) hmesh.meshImage(large, { vertices: 3000 }); });
  assert.equal(error.code, 'internal');
  assert.match(error.message, /hmesh stopped/);
  await helper.terminate();
});

test('the module comes from bytes, an address, an answer or a promise, and what is none is refused', async () => {
  const url = new URL('hmesh.wasm', folder), bytes = await readFile(url);
  const answer = new Response(bytes, { headers: { 'content-type': 'application/wasm' } }), plain = new Response(bytes);
  const path = fileURLToPath(url), paths = [path, relative(process.cwd(), path)];
  for (const source of [bytes, new Uint8Array(bytes).buffer, url, url.href, ...paths, answer, plain, Promise.resolve(bytes)])
    assert.equal((await load(source)).meshImage(image, { vertices: 50 }).vertices, 50);
  assert.match((await errorOf(() => load(new Response('', { status: 404 })))).message, /404/);
  assert.ok(await errorOf(() => load(new URL('none.wasm', folder))));
  assert.match((await errorOf(() => load('none.wasm'))).message, /none\.wasm/);
  assert.ok(await errorOf(() => load(new Uint8Array(8))));
  assert.match((await errorOf(() => load(42))).message, /42/);
});

test('an address that failed is asked again, and what else failed is forgotten', async () => {
  const { bindTo } = await import(new URL('mesher.js', folder));
  let asked = 0;
  const compile = async (source) => {
    asked++;
    if (source) throw new Error(`not there: ${source}`);
  };
  const { init: setUp } = bindTo({ compile, compileCompact: compile, spawn() {}, threads: () => 1 });
  for (const wasm of ['a.wasm', new URL('http://127.0.0.1/a.wasm')]) {
    for (const given of [{ wasm }, {}, {}]) assert.match((await errorOf(() => setUp(given))).message, /not there/);
  }
  assert.match((await errorOf(() => setUp({ wasm: Promise.resolve(1) }))).message, /not there/);
  await setUp();
  assert.equal(asked, 8);
});

test('a promise of a module that fails is told to who wants the module, and to nobody else', async () => {
  const told = [], tell = (error) => told.push(error);
  process.on('unhandledRejection', tell);
  await init({ compactWasm: Promise.reject(new Error('not there')) });
  await new Promise(setImmediate);
  assert.equal((await meshImage(image, { vertices: 50 })).vertices, 50);
  process.off('unhandledRejection', tell);
  assert.deepEqual(told, []);
  assert.match((await errorOf(() => meshImage(image, { bytes: 300 }))).message, /not there/);
  assert.ok((await meshImage(image, { bytes: 300, effort: 'draft' })).file.length <= 300);
});

test('hmesh.meshing.wasm makes the same meshes, and refuses with a sentence what it lacks', async () => {
  const small = await load(new URL('hmesh.meshing.wasm', folder)), mesh = small.meshImage(image, { vertices: 200 });
  assert.equal(hashOf(mesh), hashOf((await load()).meshImage(image, { vertices: 200 })));
  for (const call of [() => small.write(mesh, 'glb'), () => small.write(mesh, 'hmc', { bare: true }), () => small.read(new Uint8Array(9)),
    () => small.render(mesh)])
    assert.match((await errorOf(call)).message, /hmesh\.wasm does/);
  assert.equal(hashOf(small.meshImage(image, { vertices: 200 })), hashOf(mesh));
});

test('the modules are no larger than is promised', async () => {
  for (const [name, most] of [['hmesh', 160000], ['hmesh.threads', 160000], ['hmesh.compact', 160000], ['hmesh.meshing', 110000]]) {
    const { length } = brotliCompressSync(await readFile(new URL(`${name}.wasm`, folder)));
    assert.ok(length <= most, `${name}.wasm has ${length} bytes by brotli, of ${most}`);
  }
});

test('a worker that cannot be started fails the call', async () => {
  await init({ worker: () => new Worker(new URL('none.js', folder)) });
  assert.match((await errorOf(() => meshImage(image))).message, /worker failed/);
  await init({ worker: () => { throw new Error('forbidden here'); } });
  assert.match((await errorOf(() => meshImage(image))).message, /forbidden here/);
  await init({ worker: () => new Worker(new URL('worker.node.js', folder)) });
  assert.equal((await meshImage(image, { vertices: 50 })).vertices, 50);
});
