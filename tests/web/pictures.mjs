// Pictures that any engine makes alike, and a number for what is made of them. For node and browsers.

// A disc and a bar on slopes of colours with some noise, RGBA; `alpha`: transparent outside of the disc, softly.
export function picture(width, height, { alpha = false } = {}) {
  const data = new Uint8ClampedArray(4 * width * height);
  let noise = 1;
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      noise = (Math.imul(noise, 1103515245) + 12345) & 0x7fffffff;
      const dx = 2 * x - width, dy = 2 * y - height, inside = width * height - dx * dx - dy * dy;
      const color = inside > 0 ? [230, 200, 40] : 2 * x > 3 * y ? [40, 90, 160] : [20 + x, 60 + y, 90];
      const at = 4 * (y * width + x);
      for (let k = 0; k < 3; ++k) data[at + k] = color[k] + (noise >> 20) % 16;
      data[at + 3] = alpha ? Math.max(0, Math.min(255, 128 + (inside >> 4))) : 255;
    }
  return { data, width, height };
}

// FNV-1a of the bytes of arrays.
export function hash(...arrays) {
  let value = 0x811c9dc5;
  for (const array of arrays)
    for (const byte of new Uint8Array(array.buffer, array.byteOffset, array.byteLength)) value = Math.imul(value ^ byte, 0x01000193);
  return (value >>> 0).toString(16).padStart(8, '0');
}

export const hashOf = (mesh) => hash(mesh.positions, mesh.colors, mesh.indices);

// Everything that is to be the same everywhere, by name.
export async function allHashes({ Mesher, meshImage }) {
  const all = {};
  for (const alpha of [false, true]) {
    const name = alpha ? 'rgba' : 'rgb', image = picture(120, 90, { alpha });
    for (const effort of ['draft', 'fast', 'normal']) all[`${name} ${effort}`] = hashOf(await meshImage(image, { vertices: 150, effort }));
    all[`${name} psnr`] = hashOf(await meshImage(image, { psnr: 24, effort: 'draft' }));
    const mesher = new Mesher();
    mesher.setImage(image);
    const weights = new Float32Array(120 * 90).map((_, k) => k % 120);
    for await (const mesh of mesher.refine({ percent: 2, seed: 7, weights })) all[`${name} weights`] = hashOf(mesh);
    for (const format of ['ply', 'glb', 'svg', 'html', 'pdf', 'obj', 'hmc']) all[`${name} ${format}`] = hash(await mesher.write(format));
    all[`${name} render`] = hash((await mesher.render({ width: 77, height: 50 })).data);
    mesher.close();
  }
  // Larger than a tile.
  all['tiles'] = hashOf(await meshImage(picture(400, 300), { vertices: 2000, effort: 'fast' }));
  return all;
}
