// Draws as painter.js does where there is no WebGL: the mesh as pixels that the package makes of it, as large as the picture.
import { edgeOpacity, edgesOf } from './painter.js';
import { toImageData } from './pixels.js';

const MOST_EDGES = 60000; // more take a browser longer than it takes to say so

function canvasOf(picture) {
  const canvas = document.createElement('canvas');
  canvas.width = picture.width;
  canvas.height = picture.height;
  canvas.getContext('2d').putImageData(toImageData(picture), 0, 0);
  return canvas;
}

// render(mesh): a promise of the mesh as a picture.
export function createPlainPainter(canvas, redraw, render) {
  const context = canvas.getContext('2d', { alpha: false });
  let picture = null;
  let drawn = null; // the mesh as pixels
  let mesh = null;
  let edges = null;

  const path = () => {
    const made = new Path2D();
    const ends = edgesOf(mesh).subarray(0, 2 * MOST_EDGES);
    const at = (k) => [mesh.positions[2 * ends[k]], mesh.positions[2 * ends[k] + 1]];
    for (let k = 0; k < ends.length; k += 2) {
      made.moveTo(...at(k));
      made.lineTo(...at(k + 1));
    }
    return made;
  };

  return {
    setPicture(next) {
      picture = canvasOf(next);
      drawn = mesh = edges = null;
      redraw();
    },
    async setMesh(next) {
      mesh = next;
      const pixels = await render(next).catch(() => null); // another mesh has come
      if (!pixels || mesh !== next) return;
      drawn = { mesh, canvas: canvasOf(pixels) };
      edges = null;
      redraw();
    },
    paint(view) {
      const { width, height } = canvas;
      context.setTransform(1, 0, 0, 1, 0, 0);
      context.fillStyle = `rgb(${view.ground.map((share) => Math.round(255 * share))})`;
      context.fillRect(0, 0, width, height);
      if (!picture) return;
      const cut = drawn ? Math.round(view.cut) : width;
      const draw = (left, right, act) => {
        context.save();
        context.beginPath();
        context.rect(left, 0, Math.max(0, right - left), height);
        context.clip();
        context.translate(width / 2, height / 2);
        context.scale(view.scale, view.scale);
        context.translate(-view.x, -view.y);
        context.imageSmoothingEnabled = view.scale < 2;
        act();
        context.restore();
      };
      draw(0, cut, () => context.drawImage(picture, 0, 0));
      if (!drawn) return;
      draw(cut, width, () => {
        context.drawImage(drawn.canvas, 0, 0);
        if (!view.edges) return;
        edges ??= path();
        context.lineWidth = 1 / view.scale;
        context.strokeStyle = `rgba(255, 255, 255, ${edgeOpacity(drawn.mesh, view.scale)})`;
        context.stroke(edges);
      });
    },
  };
}
