// Reads PNG files of every kind (ISO/IEC 15948) as RGBA of 8 bits: for the command; browsers have readers of their own.
import { inflateSync } from 'node:zlib';

const MOST_PIXELS = 2 ** 27;
const MOST_SURPLUS = 2 ** 20;  // bytes behind the pixels, which other readers pass over
const CHANNELS = { 0: 1, 2: 3, 3: 1, 4: 2, 6: 4 };
const DEPTHS = { 0: [1, 2, 4, 8, 16], 2: [8, 16], 3: [1, 2, 4, 8], 4: [8, 16], 6: [8, 16] };
// Adam7: first column and row, and steps.
const PASSES = [[0, 0, 8, 8], [4, 0, 8, 8], [0, 4, 4, 8], [2, 0, 4, 4], [0, 2, 2, 4], [1, 0, 2, 2], [0, 1, 1, 2]];

const refuse = (what) => { throw new Error(`the PNG file ${what}`); };

// Undoes the filter of a row, of which `before` is the one above.
function unfilter(kind, row, before, step) {
  for (let i = 0; i < row.length; i++) {
    const left = i < step ? 0 : row[i - step], up = before[i], corner = i < step ? 0 : before[i - step];
    if (kind === 1) row[i] += left;
    else if (kind === 2) row[i] += up;
    else if (kind === 3) row[i] += (left + up) >> 1;
    else if (kind === 4) {
      const a = Math.abs(up - corner), b = Math.abs(left - corner), c = Math.abs(left + up - 2 * corner);
      row[i] += a <= b && a <= c ? left : b <= c ? up : corner;
    }
  }
}

// The picture. Throws where it cannot be read.
export function readPng(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength), parts = [];
  let palette = new Uint8Array(0), transparent, width = 0, height = 0, depth = 0, kind = -1, isInterlaced = 0;
  for (let at = 8; at + 12 <= bytes.length;) {
    const size = view.getUint32(at), name = String.fromCharCode(...bytes.subarray(at + 4, at + 8)), part = bytes.subarray(at + 8, at + 8 + size);
    if (name === 'IHDR' && size === 13) {
      [width, height] = [view.getUint32(at + 8), view.getUint32(at + 12)];
      [depth, kind, , , isInterlaced] = part.subarray(8);
    } else if (name === 'PLTE') palette = part;
    else if (name === 'tRNS') transparent = part;
    else if (name === 'IDAT') parts.push(part);
    else if (name === 'IEND') break;
    at += 12 + size;
  }
  if (!DEPTHS[kind]?.includes(depth)) refuse('is damaged: it has no kind of pixels');
  if (!width || !height || width * height > MOST_PIXELS) refuse(`has ${width} x ${height} px, and 1 to 2^27 px are read`);
  const channels = CHANNELS[kind], bits = channels * depth, largest = 2 ** depth - 1;
  const passes = (isInterlaced ? PASSES : [[0, 0, 1, 1]]).map(([x, y, dx, dy]) =>
    ({ x, y, dx, dy, columns: Math.ceil((width - x) / dx), rows: Math.ceil((height - y) / dy) })).filter((pass) => pass.columns > 0 && pass.rows > 0);
  const rowSize = ({ columns }) => Math.ceil(columns * bits / 8);
  const size = passes.reduce((sum, pass) => sum + pass.rows * (1 + rowSize(pass)), 0);
  let packed;
  try {
    packed = inflateSync(Buffer.concat(parts), { maxOutputLength: size + MOST_SURPLUS });
  } catch (error) {
    refuse(`is damaged: ${error.message}`);
  }
  if (packed.length < size) refuse('is damaged: it ends early');
  const data = new Uint8ClampedArray(4 * width * height), isGray = kind === 0 || kind === 4;
  const hasAlpha = channels % 2 === 0, scale = 255 / largest;
  let at = 0;
  for (const pass of passes) {
    let before = new Uint8Array(rowSize(pass));
    for (let j = 0; j < pass.rows; j++) {
      const row = packed.subarray(at + 1, at + 1 + before.length);
      unfilter(packed[at], row, before, Math.max(1, bits >> 3));
      before = row;
      at += 1 + row.length;
      const sample = (i) => (depth === 8 ? row[i] : depth === 16 ? row[2 * i] << 8 | row[2 * i + 1]
        : row[i * depth >> 3] >> (8 - depth - i * depth % 8) & largest);
      for (let i = 0; i < pass.columns; i++) {
        const to = 4 * ((pass.y + j * pass.dy) * width + pass.x + i * pass.dx), from = channels * i;
        if (kind === 3) {
          const color = sample(i);
          for (let k = 0; k < 3; k++) data[to + k] = palette[3 * color + k];
          data[to + 3] = transparent?.[color] ?? 255;
          continue;
        }
        let isClear = !hasAlpha && transparent;
        for (let k = 0; k < 3; k++) {
          const value = sample(from + (isGray ? 0 : k)), at = isGray ? 0 : 2 * k;
          data[to + k] = value * scale;
          isClear &&= value === (transparent[at] << 8 | transparent[at + 1]);
        }
        data[to + 3] = isClear ? 0 : hasAlpha ? sample(from + channels - 1) * scale : 255;
      }
    }
  }
  return { data, width, height, orientation: 1, full: [width, height] };
}
