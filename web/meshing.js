// Meshes of a picture, a draft first, then the same as it grows better, as the page's controls ask for them.
//
// Who drags the slider sees a draft for each place where a draft is done: one at work is finished if it is quick, and then the
// next is begun with what is wanted by then; what comes after a draft gives way at once.
import { Mesher } from './npm/index.js';

const PATIENCE = 250; // ms that a draft may take before it gives way
// told: {onMesh(mesh), onShare(share), onEnd(error)}, of which onEnd has no error where all is done.
export function createMeshing(told) {
  const mesher = new Mesher();
  let run = null; // {controller, options, began, isDraft}
  let next = null; // the options of the run to begin when this draft is done

  async function begin(options) {
    const mine = { controller: new AbortController(), options, began: performance.now(), isDraft: true };
    run = mine;
    next = null;
    try {
      const { signal } = mine.controller;
      const onProgress = ({ total }) => run === mine && told.onShare(total);
      for await (const mesh of mesher.refine({ ...options, signal, onProgress })) {
        if (run !== mine) return;
        mine.isDraft = false;
        told.onMesh(mesh);
        if (next) break;
      }
      if (run !== mine) return;
      run = null;
      if (next) begin(next);
      else told.onEnd();
    } catch (error) {
      if (run !== mine) return;
      run = null;
      told.onEnd(error);
    }
  }

  return {
    // Starts the workers, all of them as for a photo, and has their code compiled while nobody waits for it.
    warmUp() {
      if (run) return;
      const SIDE = 260; // px; what is below 65,536 px has one worker
      const data = new Uint8Array(3 * SIDE * SIDE).map((_, k) => (k * k) % 251);
      mesher.setImage({ data, width: SIDE, height: SIDE, channels: 3 });
      mesher.meshImage({ vertices: 60, effort: 'draft' }).catch(() => {}); // who opens a photo meanwhile will be told
    },
    // Forgets what was asked before.
    setPicture(picture) {
      this.stop();
      mesher.setImage(picture);
    },
    start(options) {
      if (run?.isDraft && performance.now() - run.began < PATIENCE) {
        next = options;
        return;
      }
      this.stop();
      begin(options);
    },
    // Whether there was something to stop.
    stop() {
      const stopped = run;
      run = next = null;
      stopped?.controller.abort();
      return stopped !== null;
    },
  };
}
