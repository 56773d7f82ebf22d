// The package as others get it: packed, installed into a folder of its own, used by node, deno and TypeScript, and built into pages by
// vite, webpack and esbuild, which Chromium shows. Each is skipped where node does not find it through NODE_PATH.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { execFileSync } from 'node:child_process';
import { copyFileSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { gzipSync } from 'node:zlib';
import { openPage, serve, startBrowser } from './browser.mjs';
import { hashOf, picture } from './pictures.mjs';

const npm = process.env.HMESH_NPM, require = createRequire(import.meta.url);
const found = (module) => {
  try {
    return require.resolve(module);
  } catch {
    return undefined;
  }
};
const browser = await startBrowser();
const lacks = (...modules) => (!browser && 'there is no Chromium') || modules.filter((one) => !found(one)).map((one) => `node finds no ${one}`)[0];
const { load } = await import(new URL('core.node.js', pathToFileURL(`${npm}/`)));
const image = picture(120, 90), expected = hashOf((await load()).meshImage(image, { vertices: 100, effort: 'draft' }));

// What users write: a mesh by a worker, the same without one, a file, and one of so many bytes.
const use = `
import { hashOf, picture } from './pictures.mjs';
export async function use({ Mesher, HmeshError }, load) {
  const mesher = new Mesher(), image = picture(120, 90);
  mesher.setImage(image);
  const mesh = await mesher.meshImage({ vertices: 100, effort: 'draft' });
  const file = await mesher.write('ply'), { length } = (await mesher.meshImage({ bytes: 500, effort: 'draft' })).file;
  mesher.close();
  let isError = false;
  try { mesher.setImage({}); } catch (error) { isError = error instanceof HmeshError; }
  return [hashOf(mesh), hashOf((await load()).meshImage(image, { vertices: 100, effort: 'draft' })), file.length > 1000, length > 400 && length <= 500,
    isError].join();
}
`;
const told = [expected, expected, true, true, true].join();
let folder;

before(() => {
  folder = mkdtempSync(join(tmpdir(), 'hmesh-npm-'));
  const quiet = { cwd: folder, encoding: 'utf8', env: { ...process.env, NODE_PATH: '' } };
  const [packed] = JSON.parse(execFileSync('npm', ['pack', npm, '--json', '--silent'], quiet));
  writeFileSync(join(folder, 'package.json'), '{ "type": "module", "private": true }');
  execFileSync('npm', ['install', join(folder, packed.filename), '--offline', '--no-audit', '--no-fund', '--silent'], quiet);
  writeFileSync(join(folder, 'use.mjs'), use);
  copyFileSync(fileURLToPath(new URL('pictures.mjs', import.meta.url)), join(folder, 'pictures.mjs'));
  const page = "import * as hmesh from 'hmesh';\nimport { load } from 'hmesh/core';\nimport { use } from './use.mjs';\n";
  writeFileSync(join(folder, 'main.mjs'), `${page}console.log(await use(hmesh, load));\n`);
  writeFileSync(join(folder, 'page.js'), `${page}globalThis.told = use(hmesh, load);\n`);
  // esbuild leaves new URL(..., import.meta.url) as it is: its users say where the files are.
  writeFileSync(join(folder, 'page.esbuild.js'), `${page}globalThis.told = hmesh.init({ wasm: './hmesh.wasm', compactWasm: './hmesh.compact.wasm',
    worker: () => new Worker('./worker.js', { type: 'module' }) }).then(() => use(hmesh, () => load('./hmesh.wasm')));\n`);
  writeFileSync(join(folder, 'index.html'), '<!doctype html><link rel="icon" href="data:,"><script type="module" src="./page.js"></script>');
});
after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true });
});

async function show(built, page = 'index.html') {
  const server = await serve({ '/': built }), { page: tab, faults } = await openPage(browser, server.url + page);
  try {
    await tab.waitForFunction('globalThis.told');
    assert.equal(await tab.evaluate('told'), told);
    assert.deepEqual(faults, []);
  } finally {
    await tab.close();
    server.close();
  }
}

test('the tarball holds the package, has no dependency, and serves node from a fresh folder', () => {
  const installed = join(folder, 'node_modules', 'hmesh');
  assert.deepEqual(readdirSync(join(folder, 'node_modules')).filter((name) => !name.startsWith('.')), ['hmesh']);
  assert.deepEqual(readdirSync(installed).sort(), readdirSync(npm).sort());
  assert.equal(JSON.parse(readFileSync(join(installed, 'package.json'))).dependencies, undefined);
  assert.equal(execFileSync(process.execPath, ['main.mjs'], { cwd: folder, encoding: 'utf8' }).trim(), told);
});

test('deno has it from node_modules', { skip: !found('deno/package.json') && 'node finds no deno' }, () => {
  const { bin } = require('deno/package.json'), start = join(dirname(found('deno/package.json')), bin.deno ?? bin);
  const args = [start, 'run', '--quiet', '--no-remote', '--allow-read', '--allow-env', 'main.mjs'];
  assert.equal(execFileSync(process.execPath, args, { cwd: folder, encoding: 'utf8', env: { ...process.env, DENO_NO_UPDATE_CHECK: '1' } }).trim(), told);
});

test('TypeScript finds the types, and what is wrong by them', { skip: !found('typescript/package.json') && 'node finds no typescript' }, () => {
  writeFileSync(join(folder, 'types.ts'), `
import { Mesher, meshImage, init, HmeshError, type Mesh, type Progress, type EffortMesh } from 'hmesh';
import { load, Hmesh, compileCompact, compileHmesh } from 'hmesh/core';
import { encode } from 'hmesh/placeholder/encoder';
export async function good(image: ImageData, signal: AbortSignal): Promise<Float32Array> {
  await init({ wasm: new URL('x', 'y:'), compactWasm: './x', worker: () => new Worker('w') });
  const mesh: EffortMesh = await meshImage(image, { vertices: 5, effort: 'fine', seed: 2, weights: new Float32Array(4), signal,
    onProgress: ({ total, stage }) => console.log(total.toFixed(), stage.length) });
  const mesher = new Mesher();
  mesher.setImage({ data: new Uint8Array(12), width: 2, height: 2, channels: 3 });
  for await (const one of mesher.refine({ psnr: 30 })) if (one.complete) console.log(one.effort);
  const picture = await mesher.render({ width: 4, mesh });
  console.log(new ImageData(picture.data, picture.width), new Blob([await mesher.write('svg', { kind: 'flat', mesh })]));
  const hmesh: Hmesh = await load(compileHmesh()), made: Mesh = hmesh.meshImage(image, { onProgress: (p: Progress) => p.total < 0.5 });
  try { hmesh.read(hmesh.write(made, 'hmc')); } catch (error) { if (error instanceof HmeshError) console.log(error.code); }
  const { file, complete } = await meshImage(image, { bytes: 300, bare: true });
  console.log(file?.length, complete, encode(new Hmesh(await compileCompact()), image, { bytes: 200, effort: 'fast' }).length);
  return made.positions;
}
// @ts-expect-error
meshImage({ data: [1, 2, 3, 4], width: 1, height: 1 });
// @ts-expect-error
new Mesher().refine({ effort: 'hard' });
// @ts-expect-error
new Mesher().write('bmp');
`);
  const tsc = join(dirname(found('typescript/package.json')), 'bin', 'tsc');
  const run = (...args) => execFileSync(process.execPath, [tsc, '--noEmit', '--strict', '--target', 'es2022', '--lib', 'es2022,dom', ...args, 'types.ts'],
    { cwd: folder, encoding: 'utf8', stdio: 'pipe' });
  try {
    run('--module', 'nodenext');
    run('--module', 'esnext', '--moduleResolution', 'bundler');
  } catch (error) {
    assert.fail(error.stdout);
  }
});

test('a page built by vite shows it', { skip: lacks('vite') }, async () => {
  const { build } = await import(pathToFileURL(found('vite')));
  await build({ root: folder, base: './', logLevel: 'error', configFile: false, build: { outDir: 'vite', target: 'es2022' } });
  await show(join(folder, 'vite'));
});

test('a page built by webpack shows it', { skip: lacks('webpack') }, async () => {
  const webpack = require('webpack'), path = join(folder, 'webpack');
  const stats = await new Promise((resolve, reject) => {
    webpack({ mode: 'production', context: folder, entry: './page.js', output: { path, filename: 'page.js', publicPath: './' } },
      (error, result) => (error ? reject(error) : resolve(result)));
  });
  assert.ok(!stats.hasErrors(), stats.toString('errors-only'));
  copyFileSync(join(folder, 'index.html'), join(path, 'index.html'));
  await show(path);
});

test('a page built by esbuild shows it', { skip: lacks('esbuild') }, async () => {
  const outdir = join(folder, 'esbuild');
  mkdirSync(outdir);
  await require('esbuild').build({
    absWorkingDir: folder, entryPoints: { page: './page.esbuild.js', worker: 'hmesh/worker' }, bundle: true, minify: true, format: 'esm',
    target: 'es2022', outdir, logLevel: 'error', nodePaths: [],
  });
  copyFileSync(join(folder, 'index.html'), join(outdir, 'index.html'));
  for (const name of ['hmesh.wasm', 'hmesh.compact.wasm']) copyFileSync(join(folder, 'node_modules', 'hmesh', name), join(outdir, name));
  await show(outdir);
});

test('what pages load is small: placeholders with their painter 5.0 kB, hmesh 3.2, its worker 4.0, hmesh/core 3.8', { skip: !found('esbuild') && 'node finds no esbuild' }, async () => {
  const most = { 'hmesh/placeholder/auto': 5000, 'hmesh/placeholder': 5150, hmesh: 3250, 'hmesh/worker': 4000, 'hmesh/core': 3850 };
  for (const [name, bytes] of Object.entries(most)) {
    const { outputFiles } = await require('esbuild').build({
      stdin: { contents: `export * from '${name}';`, resolveDir: folder }, bundle: true, minify: true, format: 'esm', target: 'es2022', write: false,
      logLevel: 'error', nodePaths: [],
    });
    const size = gzipSync(outputFiles[0].contents, { level: 9 }).length;
    assert.ok(size <= bytes, `${name}: ${size} bytes`);
    assert.ok(size > bytes / 2, `${name}: ${size} bytes`);
  }
});
