// The menu of files: what each is for, how large it is, and the file, which is made when the menu opens.
import { Mesher } from './npm/index.js';

const FORMATS = [
  ['hmc', "hmesh's own, the smallest", 'application/octet-stream'],
  ['glb', 'for Blender, three.js, games', 'model/gltf-binary'],
  ['svg', 'a drawing, for screens', 'image/svg+xml'],
  ['pdf', 'a drawing, for print', 'application/pdf'],
  ['html', 'a page that shows the mesh', 'text/html'],
  ['ply', 'a model, for MeshLab and Python', 'application/octet-stream'],
  ['png', 'the mesh as pixels', 'image/png'],
];

export function sizeText(bytes) {
  if (bytes < 1000) return `${bytes} B`;
  const [value, unit] = bytes < 999500 ? [bytes / 1e3, 'kB'] : [bytes / 1e6, 'MB'];
  return `${value < 9.95 ? value.toFixed(1) : Math.round(value)} ${unit}`;
}

// menu: an element with role menu. encode(pixels): a promise of a PNG file. onSaved(name, size), onFault(sentence): what became
// of it.
export function createSaving(menu, { encode, onSaved, onFault }) {
  const mesher = new Mesher(); // another than that which meshes, since each does one thing at a time
  let mesh = null;
  let name = 'mesh';
  let files = new Map(); // format: a promise of its Blob, of this mesh
  let controller = new AbortController();

  async function make(format, type, signal) {
    if (format === 'png') return encode(await mesher.render({ mesh, signal }));
    return new Blob([await mesher.write(format, { mesh, signal, title: name })], { type });
  }
  const sizeOf = (format) => menu.querySelector(`[value=${format}] span`);

  async function save(format) {
    try {
      const blob = await files.get(format);
      const link = document.createElement('a');
      link.href = URL.createObjectURL(blob);
      link.download = `${name}.${format}`;
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 60000); // browsers may still read it
      onSaved(link.download, sizeText(blob.size));
    } catch (error) {
      if (error.name !== 'AbortError') onFault(`${name}.${format} cannot be made: ${error.message}.`);
    }
  }

  for (const [format, what] of FORMATS) {
    const button = document.createElement('button');
    button.value = format;
    button.setAttribute('role', 'menuitem');
    button.tabIndex = -1;
    button.innerHTML = `<b>.${format}</b><small>${what}</small><span></span>`;
    menu.append(button);
  }

  return {
    save,
    // Makes the files of the mesh shown, if they are not made yet.
    prepare() {
      if (files.size > 0) return;
      const { signal } = controller;
      for (const [format, , type] of FORMATS) {
        const file = make(format, type, signal);
        files.set(format, file);
        sizeOf(format).textContent = '…';
        file.then((blob) => blob.size, () => NaN).then((size) => {
          if (!signal.aborted) sizeOf(format).textContent = size >= 0 ? sizeText(size) : 'not possible';
        });
      }
    },
    setMesh(next, title) {
      controller.abort();
      controller = new AbortController();
      mesh = next;
      name = title;
      files = new Map();
    },
    // Starts the worker, so that the page need not ask for it later.
    warmUp() {
      const [positions, colors] = [Float32Array.of(0, 0, 1, 0, 0, 1, 1, 1), new Uint8Array(12)];
      const square = { positions, colors, indices: Uint32Array.of(0, 2, 1, 1, 2, 3), width: 1, height: 1, channels: 3 };
      mesher.render({ mesh: square }).catch(() => {}); // who saves will be told
    },
  };
}
