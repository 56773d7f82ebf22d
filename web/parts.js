// Where the page's other parts are: files beside it, or, where the page is one file, elements of it, which web/build.mjs makes.

const inline = (id) => document.getElementById(id)?.textContent;

function start(name, url) {
  const text = inline(name);
  if (!text) return new Worker(url, { type: 'module' });
  const blob = URL.createObjectURL(new Blob([text], { type: 'text/javascript' }));
  const worker = new Worker(blob); // no module: browsers start none from files
  setTimeout(() => URL.revokeObjectURL(blob), 60000); // it is loaded by then
  return worker;
}

export const startPixelsWorker = () => start('pixels-worker', new URL('./pixels_worker.js', import.meta.url));

// What init() of the package takes. The module's bytes are the low ones of the text's characters.
export function packageParts() {
  const text = inline('hmesh-wasm');
  if (!text) return {};
  const wasm = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) wasm[i] = text.charCodeAt(i);
  return { wasm, worker: () => start('hmesh-worker') };
}
