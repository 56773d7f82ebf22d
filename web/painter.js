// Draws a picture and its mesh, one beside the other at a cut, by WebGL 2, with the shaders of the page of write_html().
//
// A picture is {width, height, data, isOpaque}: RGBA, alpha straight. A mesh is what the package gives, of the picture's size. A
// view is {x, y, scale, edges, cut, ground}: the place in px of the picture that is in the center of the canvas, how many px of
// the canvas a px of the picture takes, whether edges are drawn, the column of the canvas where the mesh begins, the original
// being left of it, and the color around the picture, three numbers from 0 to 1.
//
// A new mesh is blended over the one before. The picture is loaded in bands, a task for each, so that no task is long.
import { buffer, compile, fragmentShaders, vertexShaders } from './drawing.js';

const FADE = 320; // ms from one mesh to the next
const BAND = 1 << 20; // bytes of a picture that are loaded at once

const facesShader = `
  varying vec4 color;
  uniform float straight, opacity;
  void main() { gl_FragColor = vec4(color.rgb * mix(1.0, color.a, straight), color.a) * opacity; }`;
// White on what is dark and black on what is light.
const edgesShader = `
  varying vec4 color;
  uniform float opacity;
  void main() {
    float light = dot(color.rgb, vec3(0.299, 0.587, 0.114));
    gl_FragColor = vec4(vec3(1.0 - step(0.62, light)), 1) * opacity;
  }`;

// Both ends of each edge, once: faces have an edge of theirs in opposite directions, but for edges along the picture's sides,
// which have one face.
export function edgesOf({ positions, indices, width, height }) {
  const isAlong = (a, b, k, side) => positions[2 * a + k] === side && positions[2 * b + k] === side;
  const isBorder = (a, b) => isAlong(a, b, 0, 0) || isAlong(a, b, 0, width) || isAlong(a, b, 1, 0) || isAlong(a, b, 1, height);
  const ends = new Uint32Array(2 * indices.length);
  let count = 0;
  for (let i = 0; i < indices.length; i++) {
    const a = indices[i];
    const b = indices[i % 3 === 2 ? i - 2 : i + 1];
    if (a > b && !isBorder(a, b)) continue;
    ends[count++] = a;
    ends[count++] = b;
  }
  return ends.subarray(0, count);
}

// How strongly edges are drawn: less where they are so close that they would hide the picture.
export function edgeOpacity(mesh, scale) {
  const length = scale * Math.sqrt((2 * mesh.width * mesh.height) / Math.max(1, mesh.faces));
  return Math.min(0.5, 0.08 + length / 50);
}

const nextTask = () => new Promise((resolve) => setTimeout(resolve));

// The painter, or null where there is no WebGL 2. redraw() is called when there is something new to draw.
export function createPainter(canvas, redraw) {
  const gl = canvas.getContext('webgl2', { alpha: false, antialias: true, depth: false, powerPreference: 'low-power' });
  if (!gl) return null;
  const isStill = matchMedia('(prefers-reduced-motion: reduce)');
  let programs, texture, corners;
  let picture = null;
  let isLoaded = false; // the picture's texture is whole
  let layers = []; // at most two: the mesh before and the mesh, with their buffers
  let fadeStart = 0;

  const build = (vertices, fragments) => {
    const made = compile(gl, vertices, fragments);
    made.where.opacity = gl.getUniformLocation(made.program, 'opacity');
    return made;
  };
  const start = () => {
    programs = {
      faces: build(vertexShaders.mesh, facesShader),
      edges: build(vertexShaders.mesh, edgesShader),
      board: build(vertexShaders.picture, fragmentShaders.board),
      original: build(vertexShaders.picture, fragmentShaders.original),
    };
    gl.enableVertexAttribArray(0);
    gl.disable(gl.DITHER);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    texture = corners = null;
    isLoaded = false;
  };

  const makeLayer = (mesh) => ({
    mesh,
    positions: buffer(gl, gl.ARRAY_BUFFER, mesh.positions),
    colors: buffer(gl, gl.ARRAY_BUFFER, mesh.colors),
    faces: { buffer: buffer(gl, gl.ELEMENT_ARRAY_BUFFER, mesh.indices), count: mesh.indices.length },
    edges: null, // made when they are first drawn
  });
  const drop = ({ positions, colors, faces, edges }) => {
    for (const one of [positions, colors, faces.buffer, edges?.buffer]) if (one) gl.deleteBuffer(one);
  };

  // Only the picture that was given last is loaded to its end.
  async function load() {
    const { width, height, data, isOpaque } = picture;
    const mine = picture;
    isLoaded = false;
    gl.deleteTexture(texture);
    texture = gl.createTexture();
    gl.deleteBuffer(corners);
    corners = buffer(gl, gl.ARRAY_BUFFER, new Float32Array([0, 0, width, 0, 0, height, width, height]));
    // Every k-th pixel where textures cannot be as large.
    const step = Math.ceil(Math.max(width, height) / gl.getParameter(gl.MAX_TEXTURE_SIZE));
    const columns = Math.floor((width - 1) / step) + 1;
    const rows = Math.floor((height - 1) / step) + 1;
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, Math.floor(Math.log2(Math.max(columns, rows))) + 1, gl.RGBA8, columns, rows);
    const pixels = new Uint32Array(data.buffer, data.byteOffset, width * height);
    const atOnce = Math.max(1, Math.floor(BAND / (4 * columns)));
    for (let row = 0; row < rows; row += atOnce) {
      const count = Math.min(atOnce, rows - row);
      let band;
      if (step === 1) band = pixels.slice(row * width, (row + count) * width); // WebGL takes none that is shared
      else {
        band = new Uint32Array(count * columns);
        for (let i = 0, y = row; y < row + count; y++)
          for (let x = 0; x < columns; x++) band[i++] = pixels[y * step * width + x * step];
      }
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, !isOpaque);
      gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, row, columns, count, gl.RGBA, gl.UNSIGNED_BYTE,
        new Uint8Array(band.buffer, band.byteOffset, band.byteLength));
      await nextTask();
      if (mine !== picture || gl.isContextLost()) return;
    }
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.generateMipmap(gl.TEXTURE_2D);
    for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, wrap, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
    isLoaded = true;
    redraw();
  }

  const use = ({ program, where }, points, size, view, opacity) => {
    const high = [Math.fround(view.x), Math.fround(view.y)];
    gl.useProgram(program);
    gl.uniform2f(where.high, high[0], high[1]);
    gl.uniform2f(where.low, view.x - high[0], view.y - high[1]);
    gl.uniform2f(where.scale, (2 * view.scale) / canvas.width, (-2 * view.scale) / canvas.height);
    gl.uniform2f(where.full, size.width, size.height);
    gl.uniformMatrix2fv(where.turn, false, [1, 0, 0, 1]);
    gl.uniform1f(where.straight, size.premultiplied ? 0 : 1);
    gl.uniform1f(where.opacity, opacity);
    gl.bindBuffer(gl.ARRAY_BUFFER, points);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
  };
  const drawPicture = (program, view) => {
    use(program, corners, picture, view, 1);
    gl.disableVertexAttribArray(1);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  };
  const drawBoard = (view) => {
    if (!picture || picture.isOpaque) return;
    gl.disable(gl.BLEND);
    drawPicture(programs.board, view);
    gl.enable(gl.BLEND);
  };
  const drawElements = (program, layer, elements, mode, view, opacity) => {
    use(program, layer.positions, layer.mesh, view, opacity);
    gl.bindBuffer(gl.ARRAY_BUFFER, layer.colors);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, layer.mesh.channels, gl.UNSIGNED_BYTE, true, 0, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, elements.buffer);
    gl.drawElements(mode, elements.count, gl.UNSIGNED_INT, 0);
  };
  const drawLayer = (layer, view, opacity) => {
    drawElements(programs.faces, layer, layer.faces, gl.TRIANGLES, view, opacity);
    if (!view.edges) return;
    if (!layer.edges) {
      const ends = edgesOf(layer.mesh);
      layer.edges = { buffer: buffer(gl, gl.ELEMENT_ARRAY_BUFFER, ends), count: ends.length };
    }
    drawElements(programs.edges, layer, layer.edges, gl.LINES, view, opacity * edgeOpacity(layer.mesh, view.scale));
  };

  start();
  canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
  canvas.addEventListener('webglcontextrestored', () => {
    start();
    layers = layers.slice(-1).map(({ mesh }) => makeLayer(mesh));
    if (picture) load();
    redraw();
  });

  return {
    // Forgets the mesh.
    setPicture(next) {
      layers.forEach(drop);
      layers = [];
      picture = next;
      load();
    },
    setMesh(mesh) {
      // What is half transparent would show what is below it.
      const isBlended = !isStill.matches && mesh.channels === 3 && layers.length > 0;
      while (layers.length > (isBlended ? 1 : 0)) drop(layers.shift());
      layers.push(makeLayer(mesh));
      fadeStart = performance.now();
      redraw();
    },
    paint(view) {
      if (gl.isContextLost()) return;
      const { width, height } = canvas;
      const cut = layers.length > 0 ? Math.min(width, Math.max(0, Math.round(view.cut))) : width;
      gl.viewport(0, 0, width, height);
      gl.disable(gl.SCISSOR_TEST);
      gl.clearColor(...view.ground, 1);
      gl.clear(gl.COLOR_BUFFER_BIT);
      gl.enable(gl.SCISSOR_TEST);
      gl.enable(gl.BLEND);
      if (isLoaded && cut > 0) {
        gl.scissor(0, 0, cut, height);
        drawBoard(view);
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, view.scale < 2 ? gl.LINEAR : gl.NEAREST);
        drawPicture(programs.original, view);
      }
      if (cut === width) return;
      gl.scissor(cut, 0, width - cut, height);
      drawBoard(view);
      const share = Math.min(1, (performance.now() - fadeStart) / FADE);
      if (share === 1 && layers.length > 1) drop(layers.shift());
      layers.forEach((layer, k) => drawLayer(layer, view, k === 0 ? 1 : share));
      if (layers.length > 1) redraw();
    },
  };
}
