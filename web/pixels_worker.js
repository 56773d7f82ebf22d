// The worker that turns photos into pixels, and pixels into PNG files, so that no task of the page is long.
//
// Takes {id, file, limit}: a photo, made smaller where it has more than `limit` pixels or longer sides than a canvas; {id, sample,
// width, height}: a picture of samples.js; {id, encode}: {data, width, height}. Answers {id, picture}, {id, blob} or {id, error},
// a sentence. A picture is as painter.js says, with `full`, the photo's own size.
import { draw } from './samples.js';

const MOST_SIDE = 65535; // px, of a canvas: Chromium draws nothing on larger ones, and says nothing

const TYPES = [
  [/^....ftyp(heic|heix|heim|heis|hevc|hevx|mif1|msf1)/s, 'a HEIC photo'],
  [/^....ftypavi[fs]/s, 'an AVIF picture'],
  [/^%PDF/, 'a PDF file'],
  [/^(II\*\0|MM\0\*)/s, 'a TIFF or raw photo'],
  [/^\0\0\0\x0cJXL |^\xff\x0a/s, 'a JPEG XL picture'],
];

async function refusal(file) {
  const name = file.name || 'What was given';
  if (file.size === 0) return `${name} is empty.`;
  const head = String.fromCharCode(...new Uint8Array(await file.slice(0, 16).arrayBuffer()));
  const [, type] = TYPES.find(([pattern]) => pattern.test(head)) ?? [];
  if (type) return `${name} is ${type}, which this browser cannot read: save it as JPEG or PNG first.`;
  return `${name} is not a picture that this browser can read, or it is damaged.`;
}

async function read(file, limit) {
  const bitmap = await createImageBitmap(file, { imageOrientation: 'from-image' }) // turned as Exif says
    .catch(async () => { throw new Error(await refusal(file)); });
  const full = { width: bitmap.width, height: bitmap.height };
  const scale = Math.min(1, Math.sqrt(limit / (full.width * full.height)), MOST_SIDE / Math.max(full.width, full.height));
  const width = Math.max(1, Math.round(full.width * scale));
  const height = Math.max(1, Math.round(full.height * scale));
  try {
    const context = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true });
    context.imageSmoothingQuality = 'high';
    context.drawImage(bitmap, 0, 0, width, height);
    return { data: context.getImageData(0, 0, width, height).data, width, height, full };
  } catch {
    throw new Error(`${file.name || 'The picture'} has ${width} x ${height} px, for which this browser lacks the memory.`);
  } finally {
    bitmap.close();
  }
}

// The same bytes, shared where they can be: others are copied for each worker that is told of them, which holds the page.
function shared(data) {
  if (!self.crossOriginIsolated) return data;
  const copy = new Uint8ClampedArray(new SharedArrayBuffer(data.length));
  copy.set(data);
  return copy;
}

const isOpaque = (data) => new Uint32Array(data.buffer).every((pixel) => pixel >>> 24 === 255);

async function encode({ data, width, height }) {
  const canvas = new OffscreenCanvas(width, height);
  canvas.getContext('2d').putImageData(new ImageData(data, width, height), 0, 0);
  return canvas.convertToBlob({ type: 'image/png' });
}

async function answer({ file, limit, sample, width, height, encode: pixels }) {
  if (pixels) return { blob: await encode(pixels) };
  const picture = file ? await read(file, limit) : { data: draw(sample, width, height), width, height, full: { width, height } };
  return { picture: { ...picture, data: shared(picture.data), isOpaque: isOpaque(picture.data) } };
}

self.onmessage = async ({ data }) => {
  try {
    const made = await answer(data);
    const buffer = made.picture?.data.buffer;
    self.postMessage({ id: data.id, ...made }, buffer instanceof ArrayBuffer ? [buffer] : []);
  } catch (error) {
    self.postMessage({ id: data.id, error: error.message });
  }
};
