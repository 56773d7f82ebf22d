// The page: what its controls do, and what it says.
//
// The body's data-state is start, reading (a photo), refining (its mesh) or done.
import { Mesher, init } from './npm/index.js';
import { createMeshing } from './meshing.js';
import { createPainter } from './painter.js';
import { packageParts } from './parts.js';
import { createPixels, toImageData } from './pixels.js';
import { createPlainPainter } from './plain_painter.js';
import { SAMPLES } from './samples.js';
import { createSaving } from './saving.js';
import { createStage } from './stage.js';
import { groundMesh } from './ground_mesh.js';

const byId = (id) => document.getElementById(id);
const count = byId('count');
const grouped = (n) => n.toLocaleString('en');

let picture = null; // see painter.js
let name = ''; // the photo's, without ending
let source = null; // what it was read from: {file} or {sample, width, height}
let mesh = null;
let opening = 0; // counts what was opened
let reading = null; // what is read now: {from, title}
let isInterrupted = false; // whether a mesh was at work when what is read now was opened
let range = { least: 4, most: 4 }; // of vertices

// --- what the page says ---

function setState(state) {
  document.body.dataset.state = state;
}
// For who listens; what is seen says the same.
function say(sentence) {
  byId('status').textContent = sentence;
}
function showFault(sentence) {
  byId('fault').firstElementChild.textContent = sentence;
  byId('fault').hidden = false;
}
function hideFault() {
  byId('fault').hidden = true;
}
function showShare(share) {
  byId('progress').style.setProperty('--share', share);
  byId('progress').setAttribute('aria-valuenow', Math.round(100 * share));
}

function showFigures() {
  const { vertices, faces, psnr } = mesh;
  const likeness = `<b title="PSNR over all channels, of the picture that is meshed">${psnr.toFixed(1)}</b> dB`;
  byId('numbers').innerHTML = `<b>${grouped(vertices)}</b> vertices · <b>${grouped(faces)}</b> triangles · `
    + (Number.isFinite(psnr) ? likeness : 'exact');
  byId('view').setAttribute('aria-label', `${name}: a mesh of ${grouped(vertices)} vertices and ${grouped(faces)} triangles`);
}

function showOutcome() {
  byId('doing').textContent = !mesh ? '' : mesh.complete ? `Refined: ${mesh.effort}` : 'Stopped: this mesh is kept';
}

// --- the picture and its mesh ---

const askPixels = createPixels();
const meshing = createMeshing({
  onMesh(next) {
    mesh = next;
    if (!mesh.complete) byId('doing').textContent = 'Refining…';
    stage.setMesh(mesh);
    saving.setMesh(mesh, name);
    if (!byId('files').hidden) saving.prepare();
    showFigures();
  },
  onShare: showShare,
  onEnd(error) {
    setState(mesh ? 'done' : 'start');
    if (!mesh) forget();
    if (error) {
      byId('doing').textContent = mesh ? 'Stopped by an error.' : '';
      return showFault(`The picture cannot be meshed: ${error.message}.`);
    }
    showOutcome();
    say(`${byId('numbers').textContent}, ${mesh.effort}`);
  },
});
const saving = createSaving(byId('files'), {
  encode: async (drawn) => (await askPixels({ encode: drawn })).blob,
  onSaved: (file, size) => say(`Saved ${file}, ${size}`),
  onFault: showFault,
});
const stage = createStage(
  { canvas: byId('view'), divider: byId('divider'), before: byId('before'), after: byId('after'), controls: byId('bar'),
    figures: byId('figures') },
  (percent) => { byId('percent').textContent = `${grouped(percent)} %`; },
);

// Three digits, from few enough vertices that triangles are seen on.
function wanted() {
  const exact = range.least * (range.most / range.least) ** (count.value / count.max);
  const unit = 10 ** Math.max(0, Math.floor(Math.log10(exact)) - 2);
  return Math.min(range.most, Math.max(range.least, Math.round(exact / unit) * unit));
}
function showWanted() {
  byId('wanted').textContent = grouped(wanted());
  count.setAttribute('aria-valuetext', `${grouped(wanted())} vertices`);
  count.style.setProperty('--fill', `${(100 * count.value) / count.max}%`);
}
function remesh() {
  if (!picture) return;
  isInterrupted = false;
  setState('refining');
  byId('doing').textContent = 'Draft…';
  showShare(0);
  const seed = Number(byId('seed').value);
  meshing.start({ vertices: wanted(), effort: byId('effort').value, seed: Number.isSafeInteger(seed) && seed >= 0 ? seed : 1 });
}

function usePicture(next) {
  const { width, height, full } = next;
  picture = next;
  mesh = null;
  document.body.dataset.picture = '';
  byId('view').tabIndex = 0;
  const area = width * height;
  const most = Math.min(60000, Math.max(60, Math.floor(area / 10)), area);
  range = { least: Math.max(4, Math.min(60, area)), most: Math.max(4, most) };
  const start = Math.max(range.least, (source.sample ? 0.001 : 0.003) * area); // smooth pictures show triangles only so
  count.disabled = range.most === range.least;
  count.value = count.disabled ? 0 : Math.round((count.max * Math.log(start / range.least)) / Math.log(range.most / range.least));
  byId('scaled').hidden = full.width === width && full.height === height;
  const sizeText = (size) => `${grouped(size.width)} × ${grouped(size.height)}`;
  byId('scaled').textContent = `Scaled from ${sizeText(full)} to ${sizeText(next)} px`;
  byId('scaled').title = 'Large photos: see More';
  byId('numbers').textContent = name;
  byId('view').setAttribute('aria-label', `${name}: no mesh yet`);
  meshing.setPicture(picture);
  saving.setMesh(null, name);
  if (!byId('files').hidden) closePopups(); // it was opened meanwhile, and is of the picture before
  showWanted();
  stage.setPicture(picture);
  remesh();
}

// Back to the start.
function forget() {
  picture = source = null;
  delete document.body.dataset.picture;
  byId('view').tabIndex = -1;
  stage.showGround();
}

// Reads a photo, or draws a sample; what was there before stays if it cannot be read.
async function open(from, title) {
  const mine = ++opening;
  reading = { from, title };
  isInterrupted = meshing.stop() || isInterrupted;
  hideFault();
  closePopups();
  setState('reading');
  byId('doing').textContent = `Reading ${title}…`;
  if (!picture) byId('numbers').textContent = '';
  showShare(0);
  say(`Reading ${title}`);
  try {
    const made = await askPixels({ ...from, limit: 1e6 * Number(byId('limit').value) });
    if (mine !== opening) return;
    source = from;
    name = title;
    usePicture(made.picture);
  } catch (error) {
    if (mine !== opening) return;
    if (isInterrupted || document.body.dataset.state === 'refining') remesh(); // as the slider may have wanted meanwhile
    else {
      setState(picture ? 'done' : 'start');
      showOutcome();
    }
    showFault(error.message);
  } finally {
    if (mine === opening) reading = null;
  }
}
const openFile = (file) => open({ file }, file.name.replace(/\.[^.]*$/, '') || 'photo');

function stop() {
  const { state } = document.body.dataset;
  if (state !== 'reading' && state !== 'refining') return;
  opening++; // what is read now is not opened
  reading = null;
  isInterrupted = false;
  meshing.stop();
  setState(mesh ? 'done' : 'start');
  if (!mesh) forget();
  showOutcome();
  say(byId('doing').textContent || 'Stopped');
}

// --- what opens ---

const popups = [[byId('more'), byId('settings')], [byId('save'), byId('files')]];
function closePopups(isFocusKept = true) {
  for (const [button, popup] of popups) {
    if (popup.hidden) continue;
    if (!isFocusKept || popup.contains(document.activeElement)) button.focus();
    popup.hidden = true;
    button.setAttribute('aria-expanded', false);
  }
}
function toggle(button, popup) {
  const isOpen = !popup.hidden;
  closePopups();
  if (isOpen || (popup === byId('files') && !mesh)) return;
  document.body.style.setProperty('--bar', `${byId('bar').offsetHeight}px`);
  popup.hidden = false;
  button.setAttribute('aria-expanded', true);
  if (popup === byId('files')) saving.prepare();
  popup.querySelector('button, select').focus();
}

function listenToMenu() {
  const menu = byId('files');
  menu.addEventListener('click', (event) => {
    const item = event.target.closest('button');
    if (!item) return;
    saving.save(item.value);
    closePopups();
  });
  menu.addEventListener('keydown', (event) => {
    const items = [...menu.children];
    const at = items.indexOf(document.activeElement);
    const to = { ArrowDown: at + 1, ArrowUp: at - 1 + items.length, Home: 0, End: items.length - 1 }[event.key];
    if (event.key === 'Tab') closePopups();
    if (to === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    items[to % items.length].focus();
  });
}

// --- what the user does ---

function listenToFiles() {
  const input = byId('file');
  input.onchange = () => {
    if (input.files.length > 0) openFile(input.files[0]);
    input.value = ''; // the same one may be chosen again
  };
  byId('choose').onclick = byId('new').onclick = () => input.click();
  const take = (files, sentence) => {
    if (files.length > 0) openFile([...files].find((file) => file.type.startsWith('image/')) ?? files[0]);
    else showFault(sentence);
  };
  addEventListener('paste', (event) => {
    if (event.target === byId('seed')) return;
    event.preventDefault();
    take(event.clipboardData?.files ?? [], 'What was pasted holds no picture.');
  });
  const over = (is) => (event) => {
    event.preventDefault();
    byId('over').hidden = !is;
  };
  addEventListener('dragover', over(true));
  addEventListener('dragleave', (event) => event.relatedTarget === null && over(false)(event));
  addEventListener('drop', (event) => {
    over(false)(event);
    take(event.dataTransfer.files, 'What was dropped is no file: save the picture first, then drop it.');
  });
}

function listenToControls() {
  byId('in').onclick = () => stage.zoom(1.5);
  byId('out').onclick = () => stage.zoom(1 / 1.5);
  byId('fit').onclick = stage.fit;
  byId('edges').onclick = () => byId('edges').setAttribute('aria-pressed', stage.toggleEdges());
  for (const [button, popup] of popups) button.onclick = () => toggle(button, popup);
  byId('stop').onclick = stop;
  byId('fault').lastElementChild.onclick = hideFault;
  count.oninput = () => {
    showWanted();
    remesh();
  };
  byId('effort').onchange = byId('seed').onchange = remesh;
  byId('limit').onchange = () => {
    const { from, title } = reading ?? { from: source, title: name };
    if (from) open(from, title);
  };
  addEventListener('pointerdown', (event) => {
    if (!popups.some((pair) => pair.some((part) => part.contains(event.target)))) closePopups();
  });
}

function listenToKeys() {
  const keys = {
    '+': () => stage.zoom(1.25),
    '=': () => stage.zoom(1.25),
    '-': () => stage.zoom(0.8),
    _: () => stage.zoom(0.8),
    0: stage.fit,
    1: stage.showNativeSize,
    ArrowLeft: () => stage.panBy(-1, 0),
    ArrowRight: () => stage.panBy(1, 0),
    ArrowUp: () => stage.panBy(0, -1),
    ArrowDown: () => stage.panBy(0, 1),
    w: () => byId('edges').click(),
    o: stage.toggleOriginal,
    s: () => byId('save').click(),
    m: () => byId('more').click(),
  };
  addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === 'Escape') {
      if (popups.some(([, popup]) => !popup.hidden)) closePopups(false);
      else if (!byId('fault').hidden) hideFault();
      else stop();
      return;
    }
    const act = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act || !picture || event.target.matches('input, select')) return; // they have keys of their own
    event.preventDefault();
    act();
  });
}

// --- the start ---

async function addSamples() {
  const [width, height] = [192, 128];
  for (const [sample, what] of Object.entries(SAMPLES)) {
    const button = document.createElement('button');
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [width, height];
    button.setAttribute('aria-label', what);
    button.title = what;
    button.onclick = () => open({ sample, width: 960, height: 640 }, sample);
    button.append(canvas);
    byId('samples').append(button);
    const small = (await askPixels({ sample, width, height })).picture;
    canvas.getContext('2d').putImageData(toImageData(small), 0, 0);
  }
}

// What the browser lacks, as a sentence, or nothing.
function lack() {
  if (typeof WebAssembly !== 'object') return 'This browser has no WebAssembly, which the page needs.';
  if (typeof OffscreenCanvas !== 'function') return 'This browser has no OffscreenCanvas, which the page needs.';
  return '';
}

function start() {
  const lacking = lack();
  if (lacking) {
    byId('choose').disabled = true;
    return showFault(lacking);
  }
  const render = (drawn) => painting.render({ mesh: drawn });
  const painting = new Mesher();
  if (!stage.usePainter(createPainter)) stage.usePainter((canvas, redraw) => createPlainPainter(canvas, redraw, render));
  listenToFiles();
  listenToControls();
  listenToMenu();
  listenToKeys();
  const dark = matchMedia('(prefers-color-scheme: dark)');
  const makeGround = () => stage.setGround(groundMesh(1600, 1000, dark.matches));
  dark.addEventListener('change', makeGround);
  makeGround();
  addSamples();
  init(packageParts()).then(() => [meshing.warmUp(), saving.warmUp()])
    .catch((error) => showFault(`The page could not be loaded whole: ${error.message}.`));
}
start();
