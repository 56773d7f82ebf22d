// hmesh in browsers.
import { compileCompact, compileHmesh } from './core.js';
import { bindTo } from './mesher.js';

export { HmeshError } from './engine.js';

function spawn(start = () => new Worker(new URL('./worker.js', import.meta.url), { type: 'module' })) {
  const worker = start();
  return {
    post: (message) => worker.postMessage(message),
    listen(onMessage, onError) {
      worker.onmessage = ({ data }) => onMessage(data);
      worker.onerror = worker.onmessageerror = onError;
    },
    hold() {},
    end: () => worker.terminate(),
  };
}

const compile = (source, canShare) =>
  compileHmesh(source ?? (canShare ? new URL('./hmesh.threads.wasm', import.meta.url) : undefined));
const threads = () => navigator.hardwareConcurrency;

export const { init, Mesher, meshImage } = /* @__PURE__ */ bindTo({ compile, compileCompact, spawn, threads });
