// What shows picture and mesh: the canvas with its view, which is zoomed and moved by pointers and keys, and the divider over it.
//
// The canvas says what it shows by its attribute data-drawn: x, y, scale, whether there are edges, the cut; see painter.js.
import { listenToPointers } from './pointers.js';

const STEP = 0.02; // of the picture's visible width that an arrow key moves the divider by

// elements: {canvas, divider, before, after, controls, figures}, the divider, its two tags, and panels that a fitted picture
// leaves free. onView(percent): the zoom has changed.
export function createStage({ canvas, divider, before, after, controls, figures }, onView) {
  const view = { x: 0, y: 0, scale: 1, edges: false, cut: 0, ground: [0, 0, 0] };
  let size = null; // of the picture, in px
  let ground = null; // a mesh that fills the window before there is a picture
  let hasMesh = false;
  let share = 0.5; // of the picture's visible part that shows the original
  let isFitted = true; // stays so when the window changes
  let isQueued = false;
  let painter = null;

  const ratio = () => window.devicePixelRatio || 1;

  // The picture's visible part in px of the canvas.
  function visible() {
    const left = canvas.width / 2 - view.x * view.scale;
    const top = canvas.height / 2 - view.y * view.scale;
    const clamp = (at, most) => Math.min(most, Math.max(0, at));
    const bottom = Math.round(controls.getBoundingClientRect().top * ratio());
    return {
      left: clamp(left, canvas.width),
      right: clamp(left + size.width * view.scale, canvas.width),
      top: clamp(top, bottom),
      bottom: clamp(top + size.height * view.scale, bottom),
    };
  }

  function placeDivider(part) {
    const px = 1 / ratio();
    const x = view.cut * px;
    divider.hidden = !hasMesh;
    divider.style.left = `${x}px`;
    divider.style.top = `${part.top * px}px`;
    divider.style.height = `${Math.max(0, part.bottom - part.top) * px}px`;
    const percent = Math.round(100 * share);
    divider.setAttribute('aria-valuenow', percent);
    divider.setAttribute('aria-valuetext', `original ${percent} %, mesh ${100 - percent} %`);
    // A tag is shown where its side is wide enough for it, and for the handle.
    const GAP = 30;
    for (const [tag, room] of [[before, x - part.left * px], [after, part.right * px - x]]) {
      tag.classList.toggle('away', !hasMesh || room < tag.offsetWidth + GAP + 8);
      tag.style.top = `${part.bottom * px - tag.offsetHeight - 10}px`;
    }
    before.style.left = `${x - GAP - before.offsetWidth}px`;
    after.style.left = `${x + GAP}px`;
  }

  function redraw() {
    if (isQueued) return;
    isQueued = true;
    requestAnimationFrame(() => {
      isQueued = false;
      view.ground = getComputedStyle(document.body).backgroundColor.match(/\d+/g).slice(0, 3).map((byte) => byte / 255);
      if (size) {
        const part = visible();
        view.cut = part.left + share * (part.right - part.left);
        placeDivider(part);
      } else if (ground) {
        const scale = Math.max(canvas.width / ground.width, canvas.height / ground.height);
        Object.assign(view, { x: ground.width / 2, y: ground.height / 2, scale, cut: 0 });
      }
      painter?.paint(view);
      if (size) canvas.dataset.drawn = [view.x, view.y, view.scale, Number(view.edges), Math.round(view.cut)].join(' ');
    });
  }

  // What the panels leave of the canvas: {width, height, dx, dy}, the last two its center from the canvas', in px of the canvas.
  function free() {
    const box = controls.getBoundingClientRect();
    const isNarrow = canvas.clientWidth < 700;
    const gap = isNarrow ? 8 : 16;
    const top = isNarrow ? figures.getBoundingClientRect().bottom + gap : gap;
    const height = Math.max(40, box.top - gap - top);
    return {
      width: Math.max(40, canvas.clientWidth - 2 * gap) * ratio(),
      height: height * ratio(),
      dx: 0,
      dy: (top + height / 2 - canvas.clientHeight / 2) * ratio(),
    };
  }
  const fitScale = (room) => Math.min(room.width / size.width, room.height / size.height);
  const clampScale = (scale) => Math.min(1e4, Math.max(Math.min(fitScale(free()), 1) / 8, scale));

  function show(x, y, scale, isFit = false) {
    if (!size) return;
    view.scale = clampScale(scale);
    view.x = Math.min(size.width, Math.max(0, x));
    view.y = Math.min(size.height, Math.max(0, y));
    isFitted = isFit;
    onView(Math.round((100 * view.scale) / ratio()));
    redraw();
  }
  function fit() {
    if (!size) return;
    const room = free();
    const scale = fitScale(room);
    view.scale = clampScale(scale);
    view.x = size.width / 2 - room.dx / view.scale;
    view.y = size.height / 2 - room.dy / view.scale; // may be outside a flat picture
    isFitted = true;
    onView(Math.round((100 * view.scale) / ratio()));
    redraw();
  }
  // Zooms by a factor about a place of the canvas, in its px from its center.
  function zoom(factor, dx = 0, dy = 0) {
    const scale = clampScale(view.scale * factor);
    const gain = 1 / view.scale - 1 / scale;
    show(view.x + dx * gain, view.y + dy * gain, scale);
  }
  const pan = (dx, dy) => show(view.x - dx / view.scale, view.y - dy / view.scale, view.scale);
  const step = () => 0.1 * Math.min(canvas.width, canvas.height);

  function setShare(next) {
    share = Math.min(1, Math.max(0, next));
    redraw();
  }

  function listenToDivider() {
    let grab = null; // of the pointer from the divider, in px of the page
    divider.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      divider.setPointerCapture(event.pointerId);
      grab = event.clientX - view.cut / ratio();
      divider.focus({ preventScroll: true });
      event.preventDefault();
    });
    divider.addEventListener('pointermove', (event) => {
      if (grab === null) return;
      const { left, right } = visible();
      setShare(((event.clientX - grab) * ratio() - left) / Math.max(1, right - left));
    });
    for (const type of ['pointerup', 'pointercancel']) divider.addEventListener(type, () => { grab = null; });
    const keys = {
      ArrowLeft: () => setShare(share - STEP),
      ArrowDown: () => setShare(share - STEP),
      ArrowRight: () => setShare(share + STEP),
      ArrowUp: () => setShare(share + STEP),
      PageDown: () => setShare(share - 5 * STEP),
      PageUp: () => setShare(share + 5 * STEP),
      Home: () => setShare(0),
      End: () => setShare(1),
    };
    divider.addEventListener('keydown', (event) => {
      if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      event.stopPropagation();
      keys[event.key]();
    });
  }

  function resize() {
    canvas.width = Math.max(1, Math.round(canvas.clientWidth * ratio()));
    canvas.height = Math.max(1, Math.round(canvas.clientHeight * ratio()));
    if (isFitted) fit();
    redraw();
  }

  listenToPointers(canvas, { pan, zoom, fit });
  listenToDivider();
  new ResizeObserver(resize).observe(canvas);
  const panels = new ResizeObserver(() => isFitted && fit());
  for (const panel of [controls, figures]) panels.observe(panel);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw);

  return {
    redraw,
    fit,
    zoom,
    // make(canvas, redraw): a painter, or null.
    usePainter(make) {
      painter = make(canvas, redraw);
      return painter !== null;
    },
    setGround(mesh) {
      ground = mesh;
      if (!size) this.showGround();
    },
    // Forgets the picture.
    showGround() {
      size = null;
      painter.setMesh(ground);
      redraw();
    },
    setPicture(picture) {
      size = { width: picture.width, height: picture.height };
      hasMesh = false;
      painter.setPicture(picture);
      fit();
    },
    setMesh(mesh) {
      hasMesh = true;
      painter.setMesh(mesh);
      redraw();
    },
    toggleEdges() {
      view.edges = !view.edges;
      redraw();
      return view.edges;
    },
    // The original alone, or the mesh alone.
    toggleOriginal: () => setShare(share > 0.5 ? 0 : 1),
    // Whole pixels, so that pixels fall on pixels.
    showNativeSize() {
      const whole = (at, length) => Math.round(at - length / 2) + length / 2;
      show(whole(view.x, canvas.width), whole(view.y, canvas.height), 1);
    },
    panBy: (right, down) => pan(-right * step(), -down * step()),
  };
}
