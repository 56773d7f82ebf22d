// hmesh/placeholder/encoder: the bytes of a placeholder from an image.
import { MOST_POINTS } from './bare.js';
import { HmeshError, checkImage, checkRange } from './engine.js';
import { shrink } from './resample.js';

// px of the longer side that are enough: with more a placeholder of 300 bytes is hardly better, and takes longer.
export const SIDE = 256;

// The placeholder of an image, RGBA with alpha straight, of so many bytes at most. `hmesh` is one of compileCompact()'s module.
export function encode(hmesh, image, { bytes = 200, effort } = {}) {
  checkRange('bytes', bytes, 48, 2000);
  if (checkImage(image).channels !== 4) throw new HmeshError('a placeholder is made of RGBA: the image has 3 channels');
  const small = shrink(image, SIDE);
  for (let most = bytes; ;) {
    const { file, vertices } = hmesh.meshImage(small, { bytes: most, bare: true, premultiplied: true, effort });
    if (vertices <= MOST_POINTS) return file;
    most = Math.floor(0.95 * most * MOST_POINTS / vertices);  // vertices of patterns take few bits
  }
}

// base64url, as data-mesh has it.
export const toText = (bytes) => btoa(String.fromCharCode(...bytes)).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
