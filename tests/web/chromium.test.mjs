// The package as browsers have it: the same bytes as in node, with and without shared memory, and work that is stopped.
import assert from 'node:assert/strict';
import { after, test } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { openPage, serve, startBrowser } from './browser.mjs';
import { allHashes } from './pictures.mjs';

const npm = process.env.HMESH_NPM, browser = await startBrowser();
const skip = !browser && 'there is no Chromium, or node finds no playwright-core';
const folders = { '/npm/': npm, '/web/': fileURLToPath(new URL('.', import.meta.url)), '/': '/nonexistent' };
after(() => browser?.close());

async function inPage(isolated, run) {
  const server = await serve(folders, isolated), { page, faults } = await openPage(browser, server.url);
  try {
    assert.equal(await page.evaluate('crossOriginIsolated'), isolated);
    const result = await page.evaluate(run);
    assert.deepEqual(faults, []);
    return result;
  } finally {
    await page.close();
    server.close();
  }
}

for (const isolated of [false, true]) {
  const kind = isolated ? 'a page that is cross-origin isolated' : 'a page';

  test(`Chromium makes the bytes that node makes, in ${kind}`, { skip }, async () => {
    const here = await allHashes(await import(new URL('index.node.js', pathToFileURL(`${npm}/`))));
    assert.ok(Object.keys(here).length > 20);
    const there = await inPage(isolated, async () => {
      const { allHashes: all } = await import('/web/pictures.mjs');
      return all(await import('/npm/index.js'));
    });
    assert.deepEqual(there, here);
  });

  test(`stopped work ends at once in ${kind}, ${isolated ? 'by a flag' : 'with its worker'}`, { skip }, async () => {
    const told = await inPage(isolated, async () => {
      const { Mesher, init } = await import('/npm/index.js');
      const { picture } = await import('/web/pictures.mjs');
      let workers = 0;
      await init({ worker: () => ++workers && new Worker('/npm/worker.js', { type: 'module' }) });
      const mesher = new Mesher(), stop = new AbortController();
      mesher.setImage(picture(300, 200));
      let error, meshes = 0;
      try {
        for await (const mesh of mesher.refine({ vertices: 3000, effort: 'best', signal: stop.signal })) {
          meshes += !mesh.complete;
          stop.abort();
        }
      } catch (thrown) {
        error = thrown.name;
      }
      const next = await mesher.meshImage({ vertices: 50, effort: 'draft' });
      for await (const mesh of mesher.refine({ vertices: 3000, effort: 'best' })) if (mesh) break;
      const last = await mesher.meshImage({ vertices: 60, effort: 'draft' });
      mesher.close();
      return { error, meshes, workers, vertices: [next.vertices, last.vertices] };
    });
    assert.deepEqual(told, { error: 'AbortError', meshes: 1, workers: isolated ? 1 : 3, vertices: [50, 60] });
  });
}

test('a worker that is not found, and a module that is none, are said in a sentence', { skip }, async () => {
  const sentences = await inPage(false, async () => {
    const { init, meshImage } = await import('/npm/index.js');
    const { picture } = await import('/web/pictures.mjs');
    const said = async (call) => { try { await call(); return 'nothing'; } catch (error) { return error.message; } };
    const image = picture(40, 30), out = [];
    out.push(await said(() => init({ wasm: new Response('', { status: 404 }) })));
    await init({ worker: () => new Worker('data:text/javascript,throw new Error("no worker of ours")') });
    out.push(await said(() => meshImage(image)));
    await init({ worker: () => new Worker('/npm/worker.js', { type: 'module' }) });
    out.push(String((await meshImage(image, { vertices: 40 })).vertices));
    return out;
  });
  assert.match(sentences[0], /cannot be read .*404/);
  assert.match(sentences[1], /worker failed/);
  assert.equal(sentences[2], '40');
});
