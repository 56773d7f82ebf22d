// Reads an image file for the command: PNG and JPEG by this package, others by sharp where the project has that. Small is enough for a
// placeholder, so that what is returned is shrunk.
import { readFile, stat } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { pathToFileURL } from 'node:url';
import { SIDE } from './encoder.js';
import { readJpeg } from './jpeg.js';
import { readPng } from './png.js';
import { shrink } from './resample.js';

// The sharp of the project that the command is run in.
async function readBySharp(bytes, kind) {
  let sharp;
  try {
    const found = createRequire(pathToFileURL(`${process.cwd()}/`)).resolve('sharp');
    sharp = (await import(pathToFileURL(found))).default;
  } catch {
    throw new Error(`it is ${kind}: npm install sharp, and it is read`);
  }
  const turned = await sharp(bytes).rotate().ensureAlpha().raw().toBuffer({ resolveWithObject: true });
  const { data, info: { width, height } } = turned;
  return { data, width, height, orientation: 1, full: [width, height] };
}

// {data, width, height} of RGBA with sides of SIDE px at most, and `full`, the sides of the file's picture.
export async function readImage(file) {
  const kind = await stat(file);
  if (kind.isCharacterDevice() || kind.isBlockDevice()) throw new Error('it is a device, not a file');  // as /dev/zero, which never ends
  const bytes = await readFile(file), begins = (text, at = 0) => bytes.toString('latin1', at, at + text.length) === text;
  if (bytes.length === 0) throw new Error('the file is empty');
  const picture = begins('\x89PNG\r\n\x1a\n') ? readPng(bytes)
    : begins('\xff\xd8') ? readJpeg(bytes, SIDE)
      : await readBySharp(bytes, begins('WEBP', 8) ? 'a WebP file' : begins('ftypavif', 4) ? 'an AVIF file' : begins('GIF8') ? 'a GIF file'
        : 'neither a PNG nor a JPEG file');
  return { ...shrink(picture, SIDE), full: picture.full };
}
