// hmesh - the script with which write_html()'s page is handled, and its start.
//
// Drag to pan, wheel or pinch to zoom about the pointer, double click to fit. Keys: + and - zoom, arrows pan, 0 fits the
// window, 1 shows one pixel to one of the screen, w turns the wireframe on and off, o the original. With `#native` in the
// address the canvas has the picture's very size and there is nothing else: a page to embed, and to test.
#ifndef HMESH_IO_DETAIL_HTML_HANDLING_HPP
#define HMESH_IO_DETAIL_HTML_HANDLING_HPP

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

inline constexpr const char* html_handling = R"html(function redraw() {
  if (wanted) return;
  wanted = true;
  requestAnimationFrame(() => { wanted = false; if (!gl.isContextLost()) draw(); });
}

function fitScale() { return Math.min(canvas.width / mesh.width, canvas.height / mesh.height); }

function show(x, y, scale, isFit) {
  const least = Math.min(fitScale(), 1) / 16;
  view.scale = Math.min(1e5, Math.max(least, scale));
  view.x = Math.min(mesh.width, Math.max(0, x));
  view.y = Math.min(mesh.height, Math.max(0, y));
  fitted = !!isFit;
  redraw();
}
function fit() { show(mesh.width / 2, mesh.height / 2, 0.96 * fitScale(), true); }
function actual() {  // whole pixels, so that pixels fall on pixels
  const whole = (at, size) => Math.round(at - size / 2) + size / 2;
  show(whole(view.x, canvas.width), whole(view.y, canvas.height), 1);
}
// Zoom by a factor about a place of the window, in device px from its centre.
function zoom(factor, dx = 0, dy = 0) {
  const scale = Math.min(1e5, Math.max(Math.min(fitScale(), 1) / 16, view.scale * factor));
  const gain = 1 / view.scale - 1 / scale;
  show(view.x + dx * gain, view.y + dy * gain, scale);
}
function pan(dx, dy) { show(view.x - dx / view.scale, view.y - dy / view.scale, view.scale); }

function resize() {
  const ratio = window.devicePixelRatio || 1;
  if (native) {
    canvas.width = mesh.width;
    canvas.height = mesh.height;
    canvas.style.width = mesh.width / ratio + 'px';
    canvas.style.height = mesh.height / ratio + 'px';
    return redraw();
  }
  canvas.width = Math.max(1, Math.round(canvas.clientWidth * ratio));
  canvas.height = Math.max(1, Math.round(canvas.clientHeight * ratio));
  if (fitted) fit(); else redraw();
}
function toggleWires() {
  wires = !wires;
  byId('wires').setAttribute('aria-pressed', wires);
  redraw();
}
function toggleOriginal() {
  if (!original) return;
  share.value = Number(share.value) > 0.5 ? 0 : 1;
  redraw();
}

function listen() {
  const pointers = new Map();
  const fromCenter = (x, y) => {
    const box = canvas.getBoundingClientRect(), ratio = canvas.width / box.width;
    return [(x - box.left - box.width / 2) * ratio, (y - box.top - box.height / 2) * ratio, ratio];
  };
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : event.deltaMode === 2 ? 400 : 1, pinch = event.ctrlKey ? 4 : 1;
    const [x, y] = fromCenter(event.clientX, event.clientY);
    zoom(Math.exp(-0.0018 * lines * pinch * event.deltaY), x, y);
  }, { passive: false });
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    canvas.classList.add('drag');
  });
  canvas.addEventListener('pointermove', (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const others = [...pointers].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
    const ratio = fromCenter(0, 0)[2], now = [event.clientX, event.clientY];
    pointers.set(event.pointerId, now);
    if (others.length === 0) return pan((now[0] - last[0]) * ratio, (now[1] - last[1]) * ratio);
    if (others.length > 1) return;
    // Two fingers: what is under them stays there.
    const [still] = others, span = (p) => Math.max(8, Math.hypot(p[0] - still[0], p[1] - still[1]));
    const [x, y] = fromCenter((last[0] + still[0]) / 2, (last[1] + still[1]) / 2);
    zoom(span(now) / span(last), x, y);
    pan((now[0] - last[0]) / 2 * ratio, (now[1] - last[1]) / 2 * ratio);
  });
  for (const type of ['pointerup', 'pointercancel']) canvas.addEventListener(type, (event) => {
    pointers.delete(event.pointerId);
    if (pointers.size === 0) canvas.classList.remove('drag');
  });
  canvas.addEventListener('dblclick', fit);
  const step = () => 0.1 * Math.min(canvas.width, canvas.height);
  const keys = {
    '+': () => zoom(1.25), '=': () => zoom(1.25), '-': () => zoom(0.8), '_': () => zoom(0.8), '0': fit, '1': actual,
    ArrowLeft: () => pan(step(), 0), ArrowRight: () => pan(-step(), 0), ArrowUp: () => pan(0, step()),
    ArrowDown: () => pan(0, -step()), w: toggleWires, W: toggleWires, o: toggleOriginal, O: toggleOriginal,
  };
  window.addEventListener('keydown', (event) => {
    const act = keys[event.key];
    if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target === share && event.key.startsWith('Arrow')) return;  // they move the slider
    event.preventDefault();
    act();
  });
  byId('in').onclick = () => zoom(1.5);
  byId('out').onclick = () => zoom(1 / 1.5);
  byId('fit').onclick = fit;
  byId('one').onclick = actual;
  byId('wires').onclick = toggleWires;
  share.oninput = redraw;
  window.addEventListener('resize', resize);
  canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
  canvas.addEventListener('webglcontextrestored', () => { draw = setUp(); redraw(); });
}

function start() {
  canvas.setAttribute('aria-label', document.title + ': a mesh of ' + mesh.vertices + ' vertices and ' + mesh.faces +
    ' triangles. Keys: plus and minus zoom, arrows pan, 0 fits, 1 native size, w wireframe' + (original ? ', o original.' : '.'));
  try {
    gl = canvas.getContext('webgl', { alpha: false, antialias: false, depth: false, preserveDrawingBuffer: native });
    if (gl) draw = setUp();
  } catch (error) {
    console.warn(error);
    draw = null;
  }
  if (!draw) {
    canvas.hidden = byId('controls').hidden = true;
    byId('without').hidden = false;
    return;
  }
  byId('compare').hidden = !original;
  document.body.classList.toggle('native', native);
  if (original && !original.complete) original.onload = redraw;
  if (!native) listen();
  resize();
}
start();
</script>
</body>
</html>
)html";

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_DETAIL_HTML_HANDLING_HPP
