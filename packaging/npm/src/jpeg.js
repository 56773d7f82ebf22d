// Reads JPEG files, baseline and progressive (ITU-T T.81), in an eighth, a quarter, a half or all of their size: from as many of the lowest
// frequencies of each block, so that a placeholder of a photo needs one number in 64. For the command; browsers have readers of their own.

const MOST_PIXELS = 2 ** 27;  // 1.5 GB of frequencies
const ZIGZAG = [0, 1, 8, 16, 9, 2, 3, 10, 17, 24, 32, 25, 18, 11, 4, 5, 12, 19, 26, 33, 40, 48, 41, 34, 27, 20, 13, 6, 7, 14, 21, 28,
  35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23, 30, 37, 44, 51, 58, 59, 52, 45, 38, 31, 39, 46, 53, 60, 61, 54, 47, 55, 62, 63];

const refuse = (what) => { throw new Error(`the JPEG file ${what}`); };

// Bits of a scan. Behind its end they are 0.
class Bits {
  constructor(bytes, at) {
    this.bytes = bytes;
    this.at = at;
    this.restart();
  }

  restart() {
    this.bits = this.count = this.missing = 0;
  }

  need(count) {
    while (this.count < count) {
      let byte = this.bytes[this.at] ?? 0xff;
      if (byte < 0xff) this.at++;
      else if (this.bytes[this.at + 1] === 0) this.at += 2;
      else {
        byte = 0;
        this.missing++;
      }
      this.bits = this.bits << 8 | byte;
      this.count += 8;
    }
  }

  take(count) {
    this.need(count);
    this.count -= count;
    return this.bits >>> this.count & ((1 << count) - 1);
  }

  symbol(table) {
    this.need(16);
    const found = table?.[this.bits >>> (this.count - 16) & 0xffff];
    if (!found) refuse('is damaged: it has a code that none of its tables has');
    this.count -= found >> 8;
    return found & 255;
  }

  // A number of so many digits, T.81's EXTEND.
  number(size) {
    const value = this.take(size);
    return value < 1 << (size - 1) ? value - (1 << size) + 1 : value;
  }
}

// For each 16 bits that a code begins its length and, below, what it stands for.
function makeTable(lengths, symbols) {
  const table = new Uint16Array(65536);
  let next = 0, at = 0;
  lengths.forEach((count, k) => {
    for (let i = 0; i < count; i++, next += 1 << (15 - k)) table.fill(k + 1 << 8 | symbols[at++], next, next + (1 << (15 - k)));
  });
  return table;
}

// How a block of a scan is read: 64 frequencies from blocks[at] on.
const readers = {
  all(bits, { blocks, dc, ac }, at, scan, component) {
    const size = bits.symbol(dc);
    blocks[at] = component.last += size ? bits.number(size) : 0;
    for (let k = 1; k < 64; k++) {
      const symbol = bits.symbol(ac), digits = symbol & 15;
      if (!digits && symbol < 0xf0) break;
      k += symbol >> 4;
      if (digits) blocks[at + ZIGZAG[k & 63]] = bits.number(digits);
    }
  },
  firstMean(bits, component, at, { low }) {
    const size = bits.symbol(component.dc);
    component.blocks[at] = (component.last += size ? bits.number(size) : 0) << low;
  },
  nextMean(bits, { blocks }, at, { low }) {
    blocks[at] |= bits.take(1) << low;
  },
  first(bits, { blocks, ac }, at, scan) {
    if (scan.ended > 0) {
      scan.ended--;
      return;
    }
    for (let k = scan.begin; k <= scan.end; k++) {
      const symbol = bits.symbol(ac), run = symbol >> 4, digits = symbol & 15;
      if (!digits && run < 15) {
        scan.ended = (1 << run) - 1 + bits.take(run);
        break;
      }
      k += run;
      if (digits) blocks[at + ZIGZAG[k & 63]] = bits.number(digits) * (1 << scan.low);
    }
  },
  next(bits, { blocks, ac }, at, scan) {
    const one = 1 << scan.low;
    let k = scan.begin;
    // Passes what is known, each with a bit that makes it finer, and so many zeros.
    const pass = (zeros) => {
      for (; k <= scan.end; k++) {
        const place = at + ZIGZAG[k], value = blocks[place];
        if (value === 0) {
          if (zeros-- === 0) return;
        } else if (bits.take(1) && !(Math.abs(value) & one)) {
          blocks[place] += value > 0 ? one : -one;
        }
      }
    };
    for (; scan.ended === 0 && k <= scan.end; k++) {
      const symbol = bits.symbol(ac), run = symbol >> 4;
      if (!(symbol & 15) && run < 15) {
        scan.ended = (1 << run) + bits.take(run);
        break;
      }
      const value = symbol & 15 ? (bits.take(1) ? one : -one) : 0;
      pass(run);
      if (value && k <= scan.end) blocks[at + ZIGZAG[k]] = value;
    }
    if (scan.ended === 0) return;
    pass(64);
    scan.ended--;
  },
};

function readScan(bytes, at, frame, components, scan) {
  const bits = new Bits(bytes, at), { begin, high, isProgressive } = scan;
  const read = readers[!isProgressive ? 'all' : begin ? (high ? 'next' : 'first') : high ? 'nextMean' : 'firstMean'];
  const [only] = components, isAlone = components.length === 1;
  const columns = isAlone ? Math.ceil(only.width / 8) : frame.columns, rows = isAlone ? Math.ceil(only.height / 8) : frame.rows;
  const put = (component, x, y) => read(bits, component, 64 * (y * component.columns + x), scan, component);
  for (const component of components) component.last = 0;
  scan.ended = 0;
  for (let unit = 0; unit < columns * rows && bits.missing < 64; unit++) {
    if (scan.restart && unit && unit % scan.restart === 0) {
      bits.restart();
      while (bits.at < bytes.length && !(bytes[bits.at] === 0xff && (bytes[bits.at + 1] & 0xf8) === 0xd0)) bits.at++;
      bits.at += 2;
      for (const component of components) component.last = 0;
      scan.ended = 0;
    }
    const x = unit % columns, y = (unit - x) / columns;
    if (isAlone) put(only, x, y);
    else
      for (const component of components)
        for (let j = 0; j < component.v; j++)
          for (let i = 0; i < component.h; i++) put(component, x * component.h + i, y * component.v + j);
  }
  return bits.at;
}

// Samples of a component, n x n of each block, 1 <= n <= 8: n-point transforms of its n x n lowest frequencies.
function transform({ blocks, columns, rows, quantization }, n) {
  const width = columns * n, samples = new Float32Array(width * rows * n), half = new Float64Array(64);
  const wave = Array.from({ length: 64 }, (_, k) => (k & 7 ? 0.5 : Math.SQRT1_2 / 2) * Math.cos((2 * (k >> 3) + 1) * (k & 7) * Math.PI / 2 / n));
  for (let block = 0; block < columns * rows; block++) {
    const at = 64 * block, to = Math.floor(block / columns) * n * width + block % columns * n;
    for (let v = 0; v < n; v++)
      for (let x = 0; x < n; x++) {
        let sum = 0;
        for (let u = 0; u < n; u++) sum += wave[8 * x + u] * blocks[at + 8 * v + u] * quantization[8 * v + u];
        half[8 * v + x] = sum;
      }
    for (let y = 0; y < n; y++)
      for (let x = 0; x < n; x++) {
        let sum = 128;
        for (let v = 0; v < n; v++) sum += wave[8 * y + v] * half[8 * v + x];
        samples[to + y * width + x] = sum;
      }
  }
  return { samples, width };
}

// The orientation that Exif says, 1 to 8.
function readOrientation(bytes) {
  if (String.fromCharCode(...bytes.subarray(0, 6)) !== 'Exif\0\0' || bytes.length < 14) return 1;
  const view = new DataView(bytes.buffer, bytes.byteOffset + 6, bytes.length - 6), isLittle = bytes[6] === 0x49;
  const at = view.getUint32(4, isLittle), has = (size) => size <= view.byteLength;
  for (let k = at + 2; has(at + 2) && k < at + 2 + 12 * view.getUint16(at, isLittle) && has(k + 10); k += 12)
    if (view.getUint16(k, isLittle) === 0x112) return Math.max(1, Math.min(8, view.getUint16(k + 8, isLittle)));
  return 1;
}

// The picture as RGBA, of which the longer side has `wanted` px if the file's has, and up to twice as many; `full` are the file's sides,
// turned as Exif says, which the picture is not yet: `orientation`. Throws where it cannot be read.
export function readJpeg(bytes, wanted) {
  const quantizations = [], dc = [], ac = [];
  let frame, at = 2, restart = 0, orientation = 1, adobe = -1;
  while (at < bytes.length) {
    if (bytes[at] !== 0xff || bytes[at + 1] === 0xff || bytes[at + 1] === 0) {
      at++;
      continue;
    }
    const marker = bytes[at + 1];
    at += 2;
    if (marker === 0xd9) break;
    if (marker >= 0xd0 && marker <= 0xd8 || marker === 1) continue;
    const part = bytes.subarray(at + 2, at + (bytes[at] << 8 | bytes[at + 1])), word = (k) => part[k] << 8 | part[k + 1];
    at += part.length + 2;
    if (marker === 0xdb) {
      for (let k = 0; k < part.length;) {
        const isWide = part[k] >> 4, table = new Uint16Array(64), id = part[k++] & 15;
        for (let i = 0; i < 64; i++, k += isWide ? 2 : 1) table[ZIGZAG[i]] = isWide ? word(k) : part[k];
        quantizations[id] = table;
      }
    } else if (marker === 0xc4) {
      for (let k = 0; k < part.length;) {
        const lengths = [...part.subarray(k + 1, k + 17)], count = lengths.reduce((a, b) => a + b, 0), id = part[k] & 15;
        (part[k] >> 4 ? ac : dc)[id] = makeTable(lengths, part.subarray(k + 17, k + 17 + count));
        k += 17 + count;
      }
    } else if (marker === 0xdd) {
      restart = word(0);
    } else if (marker === 0xe1) {
      if (orientation === 1) orientation = readOrientation(part);
    } else if (marker === 0xee) {
      if (String.fromCharCode(...part.subarray(0, 5)) === 'Adobe') adobe = part[11];
    } else if (marker >= 0xc0 && marker <= 0xcf && marker !== 0xc8 && marker !== 0xcc) {
      if (frame || marker > 0xc2) refuse('is of a kind that is not read: neither baseline nor progressive with Huffman codes');
      if (part[0] !== 8) refuse(`has ${part[0]} bits a sample, and 8 are read`);
      const height = word(1), width = word(3), count = part[5];
      if (!width || !height || width * height > MOST_PIXELS) refuse(`has ${width} x ${height} px, and 1 to 2^27 px are read`);
      if (count !== 1 && count !== 3) refuse(`has ${count} components, and 1 or 3 are read: no CMYK`);
      const components = Array.from({ length: count }, (_, k) => {
        const [id, factors, table] = part.subarray(6 + 3 * k, 9 + 3 * k);
        return { id, h: factors >> 4, v: factors & 15, table };
      });
      const [h, v] = ['h', 'v'].map((side) => Math.max(...components.map((component) => component[side])));
      if (components.some((c) => !(c.h >= 1 && c.h <= 4 && c.v >= 1 && c.v <= 4))) refuse('is damaged: its sampling is none');
      frame = { width, height, h, v, components, columns: Math.ceil(width / 8 / h), rows: Math.ceil(height / 8 / v), isProgressive: marker === 0xc2 };
      for (const c of components) {
        Object.assign(c, { width: Math.ceil(width * c.h / h), height: Math.ceil(height * c.v / v), columns: frame.columns * c.h, rows: frame.rows * c.v });
        c.blocks = new Int16Array(64 * c.columns * c.rows);
      }
    } else if (marker === 0xda) {
      if (!frame) refuse('is damaged: it has pixels before it has a size');
      const components = Array.from({ length: part[0] }, (_, k) => {
        const component = frame.components.find(({ id }) => id === part[1 + 2 * k]) ?? refuse('is damaged: a scan is of no component');
        const tables = part[2 + 2 * k];
        return Object.assign(component, { dc: dc[tables >> 4], ac: ac[tables & 15], quantization: quantizations[component.table] });
      });
      const [begin, end, bits] = part.subarray(1 + 2 * part[0]);
      if (!components.length || end > 63) refuse('is damaged: a scan is of no frequencies');
      at = readScan(bytes, at, frame, components, { begin, end, high: bits >> 4, low: bits & 15, restart, isProgressive: frame.isProgressive });
    }
  }
  if (!frame || frame.components.some(({ quantization }) => !quantization)) refuse('has no picture');
  let n = 1;
  while (n < 8 && Math.max(frame.width, frame.height) * n / 8 < wanted) n *= 2;
  const width = Math.ceil(frame.width * n / 8), height = Math.ceil(frame.height * n / 8), data = new Uint8ClampedArray(4 * width * height);
  const planes = frame.components.map((component) => ({ ...component, ...transform(component, n) }));
  const isRgb = adobe === 0 || (adobe < 0 && planes.map(({ id }) => String.fromCharCode(id)).join('') === 'RGB');
  for (let y = 0; y < height; y++)
    for (let x = 0; x < width; x++) {
      const [a, b = 128, c = 128] = planes.map((plane) =>
        plane.samples[Math.floor(y * plane.v / frame.v) * plane.width + Math.floor(x * plane.h / frame.h)]);
      const color = isRgb && planes.length > 1 ? [a, b, c]
        : [a + 1.402 * (c - 128), a - 0.344136 * (b - 128) - 0.714136 * (c - 128), a + 1.772 * (b - 128)];
      data.set([...color, 255], 4 * (y * width + x));
    }
  return { data, width, height, orientation, full: orientation > 4 ? [frame.height, frame.width] : [frame.width, frame.height] };
}
