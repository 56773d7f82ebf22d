// How the page is handled, and its start.
//
// Drag to pan, wheel or pinch to zoom about the pointer, double click to fit. Keys: + and - zoom, arrows pan, 0 fits the
// window, 1 shows one pixel to one of the screen, w turns the wireframe on and off, o the original, p folds the panels, which are
// folded at first on small screens, and ? lists all this. With `#native` in the
// address the canvas has the picture's very size and there is nothing else: a page to embed, and to test; with `#original` it
// shows the original so.
//
// The canvas says what it shows by its attribute data-drawn: x, y, scale, whether there are edges, the original's share; see
// drawing.js. It has none before it is drawn.
import { createPainter } from './drawing.js';
import { listenToPointers } from './pointers.js';

const byId = (id) => document.getElementById(id);
const canvas = byId('mesh');
const share = byId('share');
const original = byId('original');
const help = byId('help');
const folds = [...document.querySelectorAll('.fold')]; // the buttons of the panels
const mesh = JSON.parse(byId('data').textContent);
const isNative = ['#native', '#original'].includes(location.hash);

const view = { x: mesh.width / 2, y: mesh.height / 2, scale: 1, wires: false, share: 0, ground: [0, 0, 0] }; // see drawing.js
let isFitted = true; // stays so when the window changes
let isQueued = false; // the next frame will be drawn
let gl = null;
let paint = null;

// --- the view ---

function redraw() {
  if (isQueued) return;
  isQueued = true;
  requestAnimationFrame(() => {
    isQueued = false;
    if (gl.isContextLost()) return;
    view.share = original?.naturalWidth > 0 ? Number(share.value) : 0; // browsers may have restored it
    view.ground = getComputedStyle(document.body)
      .backgroundColor.match(/\d+/g)
      .map((byte) => byte / 255);
    paint(view);
    canvas.dataset.drawn = [view.x, view.y, view.scale, Number(view.wires), view.share].join(' ');
  });
}

function fitScale() {
  return Math.min(canvas.width / mesh.width, canvas.height / mesh.height);
}
function clampScale(scale) {
  return Math.min(1e5, Math.max(Math.min(fitScale(), 1) / 16, scale));
}

function show(x, y, scale, isFit = false) {
  view.scale = clampScale(scale);
  view.x = Math.min(mesh.width, Math.max(0, x));
  view.y = Math.min(mesh.height, Math.max(0, y));
  isFitted = isFit;
  redraw();
}
function fit() {
  show(mesh.width / 2, mesh.height / 2, 0.96 * fitScale(), true);
}
// Whole pixels, so that pixels fall on pixels.
function showNativeSize() {
  const whole = (at, size) => Math.round(at - size / 2) + size / 2;
  show(whole(view.x, canvas.width), whole(view.y, canvas.height), 1);
}
// Zooms by a factor about a place of the window, in device px from its center.
function zoom(factor, dx = 0, dy = 0) {
  const scale = clampScale(view.scale * factor);
  const gain = 1 / view.scale - 1 / scale;
  show(view.x + dx * gain, view.y + dy * gain, scale);
}
function pan(dx, dy) {
  show(view.x - dx / view.scale, view.y - dy / view.scale, view.scale);
}

function toggleWires() {
  view.wires = !view.wires;
  byId('wires').setAttribute('aria-pressed', view.wires);
  redraw();
}
function toggleOriginal() {
  if (!original) return;
  share.value = Number(share.value) > 0.5 ? 0 : 1;
  redraw();
}

// --- panels ---

const isFolded = (button) => button.getAttribute('aria-expanded') === 'false';
function fold(button, folded) {
  button.setAttribute('aria-expanded', !folded);
  byId(button.getAttribute('aria-controls')).hidden = folded;
}
function foldAll() {
  const folded = !folds.every(isFolded);
  for (const button of folds) fold(button, folded);
}
function toggleHelp() {
  if (help.open) help.close();
  else help.showModal();
}

// The canvas has a pixel for each of the device, or in `#native` of the mesh.
function resize() {
  const ratio = window.devicePixelRatio || 1;
  if (isNative) {
    canvas.width = mesh.width;
    canvas.height = mesh.height;
    canvas.style.width = `${mesh.width / ratio}px`;
    canvas.style.height = `${mesh.height / ratio}px`;
    redraw();
    return;
  }
  canvas.width = Math.max(1, Math.round(canvas.clientWidth * ratio));
  canvas.height = Math.max(1, Math.round(canvas.clientHeight * ratio));
  if (isFitted) fit();
  else redraw();
}

// --- what the user does ---

function listenToKeys() {
  const step = () => 0.1 * Math.min(canvas.width, canvas.height);
  const keys = {
    '+': () => zoom(1.25),
    '=': () => zoom(1.25),
    '-': () => zoom(0.8),
    _: () => zoom(0.8),
    0: fit,
    1: showNativeSize,
    ArrowLeft: () => pan(step(), 0),
    ArrowRight: () => pan(-step(), 0),
    ArrowUp: () => pan(0, step()),
    ArrowDown: () => pan(0, -step()),
    w: toggleWires,
    W: toggleWires,
    o: toggleOriginal,
    O: toggleOriginal,
    p: foldAll,
    P: foldAll,
    '?': toggleHelp,
  };
  window.addEventListener('keydown', (event) => {
    const act = keys[event.key];
    if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
    if (help.open && event.key !== '?') return;
    if (event.target === share && event.key.startsWith('Arrow')) return; // they move the slider
    event.preventDefault();
    act();
  });
}

function listenToControls() {
  byId('in').onclick = () => zoom(1.5);
  byId('out').onclick = () => zoom(1 / 1.5);
  byId('fit').onclick = fit;
  byId('one').onclick = showNativeSize;
  byId('wires').onclick = toggleWires;
  share.oninput = redraw;
  byId('keys').onclick = toggleHelp;
  byId('close').onclick = toggleHelp;
  help.onclick = (event) => event.target === help && help.close(); // beside it
  matchMedia('(prefers-color-scheme: dark)').onchange = redraw;
  window.addEventListener('resize', resize);
  canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
  canvas.addEventListener('webglcontextrestored', () => {
    paint = createPainter(gl, mesh, original);
    redraw();
  });
}

function listenToFolds() {
  const isSmall = matchMedia('(max-width: 600px), (max-height: 480px)').matches;
  for (const button of folds) {
    button.onclick = () => fold(button, !isFolded(button));
    fold(button, isSmall);
  }
  folds[0].disabled = !byId('figures').textContent;
}

// --- the start ---

function start() {
  canvas.setAttribute(
    'aria-label',
    `${document.title}: a mesh of ${mesh.vertices} vertices and ${mesh.faces} triangles. ` +
      'The question mark lists the keys.',
  );
  listenToFolds();
  try {
    gl = canvas.getContext('webgl', { alpha: false, antialias: false, depth: false, preserveDrawingBuffer: isNative });
    if (gl) paint = createPainter(gl, mesh, original);
  } catch (error) {
    console.warn(error);
  }
  if (!paint) {
    canvas.hidden = true;
    byId('controls').hidden = true;
    byId('without').hidden = false;
    return;
  }
  for (const part of document.querySelectorAll('.compare')) part.hidden = !original;
  if (location.hash === '#original') share.value = 1;
  document.body.classList.toggle('native', isNative);
  if (original && !original.complete) original.onload = redraw;
  if (!isNative) {
    listenToPointers(canvas, { pan, zoom, fit });
    listenToKeys();
    listenToControls();
  }
  resize();
}
start();
