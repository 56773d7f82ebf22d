// The mesh behind the start: a jittered grid of triangles of one soft color each, light or dark as the page is.

const COLORS = {
  light: [[250, 222, 206], [216, 228, 243], [243, 238, 222], [208, 226, 217]],
  dark: [[70, 40, 62], [30, 46, 78], [26, 26, 38], [24, 60, 62]],
};

// The same shares from -0.5 to 0.5 at each start.
function shares() {
  let state = 7;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32 - 0.5;
  };
}

export function groundMesh(width, height, isDark) {
  const CELL = 100; // px
  const columns = Math.round(width / CELL);
  const rows = Math.round(height / CELL);
  const corners = COLORS[isDark ? 'dark' : 'light'];
  const share = shares();
  const points = [];
  for (let row = 0; row <= rows; row++)
    for (let column = 0; column <= columns; column++)
      points.push([
        (column + (column % columns === 0 ? 0 : 0.8 * share())) * CELL,
        (row + (row % rows === 0 ? 0 : 0.8 * share())) * CELL,
      ]);
  const positions = [];
  const colors = [];
  const add = (...face) => {
    const [x, y] = [0, 1].map((k) => face.reduce((sum, v) => sum + points[v][k], 0) / 3);
    const at = [x / width, y / height];
    const light = (isDark ? 14 : 12) * share();
    const color = [0, 1, 2].map((k) => {
      const [top, bottom] = [0, 2].map((c) => corners[c][k] * (1 - at[0]) + corners[c + 1][k] * at[0]);
      return Math.min(255, top * (1 - at[1]) + bottom * at[1] + light);
    });
    for (const v of face) {
      positions.push(...points[v]);
      colors.push(...color);
    }
  };
  for (let row = 0; row < rows; row++)
    for (let column = 0; column < columns; column++) {
      const a = row * (columns + 1) + column;
      const [b, c, d] = [a + 1, a + columns + 1, a + columns + 2];
      if (share() < 0) [[a, c, b], [b, c, d]].forEach((face) => add(...face));
      else [[a, c, d], [a, d, b]].forEach((face) => add(...face));
    }
  return {
    width, height, channels: 3, premultiplied: false, positions: Float32Array.from(positions), colors: Uint8Array.from(colors),
    indices: Uint32Array.from(positions.keys()).subarray(0, positions.length / 2), vertices: positions.length / 2,
    faces: positions.length / 6,
  };
}
