// What the page asks of pixels_worker.js.
import { startPixelsWorker } from './parts.js';

// For a canvas: an ImageData takes no memory that is shared, which a picture of the worker may have.
export const toImageData = ({ data, width, height }) => new ImageData(new Uint8ClampedArray(data), width, height);

// A function of a question that gives a promise of its answer.
export function createPixels() {
  let worker = null;
  let count = 0;
  const waiting = new Map();

  const end = () => {
    worker.terminate();
    worker = null;
    for (const { reject } of waiting.values())
      reject(new Error('The browser ended the reading of the picture: it may lack the memory.'));
    waiting.clear();
  };
  const start = () => {
    worker = startPixelsWorker();
    worker.onerror = end;
    worker.onmessage = ({ data: { id, error, ...made } }) => {
      const { resolve, reject } = waiting.get(id);
      waiting.delete(id);
      if (error) reject(new Error(error));
      else resolve(made);
    };
  };

  return (question) =>
    new Promise((resolve, reject) => {
      if (!worker) start();
      waiting.set(++count, { resolve, reject });
      worker.postMessage({ id: count, ...question });
    });
}
