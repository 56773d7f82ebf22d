// hmesh in node and deno.
import * as os from 'node:os';
import { Worker } from 'node:worker_threads';
import { compileCompact, compileHmesh } from './core.node.js';
import { bindTo } from './mesher.js';

export { HmeshError } from './engine.js';

function spawn(start = () => new Worker(new URL('./worker.node.js', import.meta.url))) {
  const worker = start();
  return {
    post: (message) => worker.postMessage(message),
    listen(onMessage, onError) {
      worker.on('message', onMessage);
      worker.on('error', onError);
      worker.on('messageerror', onError);
    },
    hold: (isHeld) => (isHeld ? worker.ref() : worker.unref()),
    end: () => worker.terminate(),
  };
}

const compile = (source, canShare) =>
  compileHmesh(source ?? (canShare ? new URL('./hmesh.threads.wasm', import.meta.url) : undefined));
const threads = () => os.availableParallelism?.() ?? os.cpus().length;

export const { init, Mesher, meshImage } = /* @__PURE__ */ bindTo({ compile, compileCompact, spawn, threads });
