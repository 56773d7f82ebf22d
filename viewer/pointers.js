// What mouse, pen and fingers do to a view: drag to pan, wheel or pinch to zoom about the pointer, double click to fit.
//
// pan(dx, dy) moves the picture, and zoom(factor, x, y) makes it larger about a place, all in device px, the place from the
// center of the canvas.
export function listenToPointers(canvas, { pan, zoom, fit }) {
  const pointers = new Map();
  // Device px from the center of the canvas, and how many of them are a px of the page.
  const fromCenter = (x, y) => {
    const box = canvas.getBoundingClientRect();
    const ratio = canvas.width / box.width;
    return [(x - box.left - box.width / 2) * ratio, (y - box.top - box.height / 2) * ratio, ratio];
  };
  const onWheel = (event) => {
    event.preventDefault();
    const lines = { 0: 1, 1: 16, 2: 400 }[event.deltaMode];
    const pinch = event.ctrlKey ? 4 : 1;
    const [x, y] = fromCenter(event.clientX, event.clientY);
    zoom(Math.exp(-0.0018 * lines * pinch * event.deltaY), x, y);
  };
  canvas.addEventListener('wheel', onWheel, { passive: false });
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    canvas.classList.add('drag');
  });
  canvas.addEventListener('pointermove', (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const others = [...pointers].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
    const ratio = fromCenter(0, 0)[2];
    const now = [event.clientX, event.clientY];
    pointers.set(event.pointerId, now);
    if (others.length === 0) pan((now[0] - last[0]) * ratio, (now[1] - last[1]) * ratio);
    if (others.length !== 1) return;
    // Two fingers: what is under them stays there.
    const [still] = others;
    const span = (p) => Math.max(8, Math.hypot(p[0] - still[0], p[1] - still[1]));
    const [x, y] = fromCenter((last[0] + still[0]) / 2, (last[1] + still[1]) / 2);
    zoom(span(now) / span(last), x, y);
    pan(((now[0] - last[0]) / 2) * ratio, ((now[1] - last[1]) / 2) * ratio);
  });
  for (const type of ['pointerup', 'pointercancel'])
    canvas.addEventListener(type, (event) => {
      pointers.delete(event.pointerId);
      if (pointers.size === 0) canvas.classList.remove('drag');
    });
  canvas.addEventListener('dblclick', fit);
}
