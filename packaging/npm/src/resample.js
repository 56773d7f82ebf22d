// shrink(): the means of the pixels that lie in each of fewer pixels.

// Which of `count` are in part k of `parts`, and with what share of themselves.
const spans = (count, parts) => Array.from({ length: parts }, (_, k) => {
  const from = k * count / parts, to = (k + 1) * count / parts, span = [];
  for (let i = Math.floor(from); i < to && i < count; i++) span.push([i, Math.min(to, i + 1) - Math.max(from, i)]);
  return span;
});

// RGBA with a longer side of `side` px at most, alpha straight, turned as Exif's orientation 1 to 8 says that it is seen. Colours are weighted by
// alpha.
export function shrink({ data, width, height, orientation = 1 }, side) {
  const scale = Math.min(1, side / Math.max(width, height)), isTurned = orientation > 4;
  const columns = Math.max(1, Math.round(width * scale)), rows = Math.max(1, Math.round(height * scale));
  // Mirrored along x, along y: as seen of 5 and above, whose axes are exchanged, in the file else.
  const isLeft = [2, 3, 7, 8].includes(orientation), isUp = [3, 4, 6, 7].includes(orientation);
  const out = new Uint8ClampedArray(4 * columns * rows), across = spans(width, columns), down = spans(height, rows);
  for (let y = 0; y < rows; y++)
    for (let x = 0; x < columns; x++) {
      let r = 0, g = 0, b = 0, a = 0, total = 0;
      for (const [j, tall] of down[y])
        for (const [i, wide] of across[x]) {
          const at = 4 * (j * width + i), weight = tall * wide, alpha = weight * data[at + 3];
          r += alpha * data[at];
          g += alpha * data[at + 1];
          b += alpha * data[at + 2];
          a += alpha;
          total += weight;
        }
      const u = isLeft ? columns - 1 - x : x, v = isUp ? rows - 1 - y : y;
      out.set([r / (a || 1), g / (a || 1), b / (a || 1), a / total], 4 * (isTurned ? u * rows + v : v * columns + u));
    }
  return isTurned ? { data: out, width: rows, height: columns } : { data: out, width: columns, height: rows };
}
