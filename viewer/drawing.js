// Draws a mesh, its edges and the original picture by WebGL 1. It knows neither the window nor its events.
//
// A mesh is {width, height, channels, vertices, faces, points, premultiplied, data}: its size in px, what there is of each,
// whether the original's pixels are samples at whole places, of which the outermost lie half outside, whether colors are stored
// multiplied by alpha, and base64 of positions, faces and colors, as write_html() in io/html.hpp says.
// A view is {x, y, scale, wires, share, ground}: the place in px of the mesh that is in the center of the canvas, how many px of
// the canvas a px of the mesh takes, whether edges are drawn, how much of the picture shows the original, 0 to 1 from the right,
// and the color around the picture.

// Vertices to the canvas. The center is taken from the positions in two parts, so that the 24 bits of a float are enough at any
// zoom: `high` is a float, and `low` what it lacks.
const toCanvas = `
  attribute vec2 at;
  uniform vec2 high, low, scale;
  vec4 place() { return vec4(((at - high) - low) * scale, 0, 1); }`;
export const vertexShaders = {
  mesh: `${toCanvas}
    attribute vec4 stored;
    varying vec4 color;
    void main() { color = stored; gl_Position = place(); }`,
  picture: `${toCanvas}
    uniform vec2 full;
    uniform float margin;
    uniform mat2 turn;
    varying vec2 q;
    void main() { q = turn * ((at + margin) / full - 0.5) + 0.5; gl_Position = place(); }`,
};
export const fragmentShaders = {
  // What is drawn is premultiplied; `straight` is 1 where the mesh is not, else 0.
  faces: `
    varying vec4 color;
    uniform float straight;
    void main() { gl_FragColor = vec4(color.rgb * mix(1.0, color.a, straight), color.a); }`,
  edges: `
    void main() { gl_FragColor = vec4(0.5); }`,
  // What shows through where there is alpha.
  board: `
    void main() {
      vec2 q = floor(gl_FragCoord.xy / 12.0);
      gl_FragColor = vec4(vec3(mod(q.x + q.y, 2.0) < 1.0 ? 0.36 : 0.5), 1);
    }`,
  original: `
    varying vec2 q;
    uniform sampler2D one;
    void main() { gl_FragColor = texture2D(one, q); }`,
};

// The arrays of a mesh: two floats a vertex, three indices a face, RGBA bytes a vertex.
function decode(mesh) {
  const text = atob(mesh.data);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = text.charCodeAt(i);
  const Index = mesh.vertices <= 65535 ? Uint16Array : Uint32Array;
  const positions = new Float32Array(bytes.buffer, 0, 2 * mesh.vertices);
  const faces = new Index(bytes.buffer, positions.byteLength, 3 * mesh.faces);
  const stored = bytes.subarray(positions.byteLength + faces.byteLength);
  const n = mesh.channels;
  const colors = new Uint8Array(4 * mesh.vertices).fill(255);
  for (let v = 0; v < mesh.vertices; v++)
    for (let k = 0; k < (n === 4 ? 4 : 3); k++) colors[4 * v + k] = stored[n * v + (n === 1 ? 0 : k)];
  return { positions, faces, colors };
}

// The two ends of each edge, each edge once.
function edgesOf(faces, vertices) {
  const seen = new Set();
  const ends = [];
  for (let i = 0; i < faces.length; i++) {
    const a = faces[i];
    const b = faces[i % 3 === 2 ? i - 2 : i + 1];
    const key = Math.min(a, b) * vertices + Math.max(a, b);
    if (seen.has(key)) continue;
    seen.add(key);
    ends.push(a, b);
  }
  return new faces.constructor(ends);
}

// A program with the places of its uniforms.
export function compile(gl, vertexShader, fragmentShader) {
  const program = gl.createProgram();
  const sources = [
    [gl.VERTEX_SHADER, vertexShader],
    [gl.FRAGMENT_SHADER, `precision mediump float;${fragmentShader}`],
  ];
  for (const [type, source] of sources) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.bindAttribLocation(program, 0, 'at');
  gl.bindAttribLocation(program, 1, 'stored');
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(gl.getProgramInfoLog(program));
  const where = {};
  for (const name of ['high', 'low', 'scale', 'full', 'margin', 'turn', 'straight'])
    where[name] = gl.getUniformLocation(program, name);
  return { program, where };
}

export function buffer(gl, target, data) {
  const made = gl.createBuffer();
  gl.bindBuffer(target, made);
  gl.bufferData(target, data, gl.STATIC_DRAW);
  return made;
}

// The original as a texture, made smaller where it is larger than textures may be; it stays bound.
function loadPicture(gl, image) {
  let source = image;
  const shrink = gl.getParameter(gl.MAX_TEXTURE_SIZE) / Math.max(image.naturalWidth, image.naturalHeight);
  if (shrink < 1) {
    source = document.createElement('canvas');
    source.width = Math.floor(image.naturalWidth * shrink) || 1;
    source.height = Math.floor(image.naturalHeight * shrink) || 1;
    source.getContext('2d').drawImage(image, 0, 0, source.width, source.height);
  }
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
  gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, true);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, source);
  for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, wrap, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
}

// The matrix, column by column, that takes a place in the upright picture to one in the picture as it is stored, both from their
// centers, for Exif's orientations: from 5 on lines are columns, and some are stored from their ends.
function turnOf(orientation) {
  const along = [2, 3, 7, 8].includes(orientation) ? -1 : 1;
  const across = [3, 4, 6, 7].includes(orientation) ? -1 : 1;
  return orientation < 5 ? [along, 0, 0, across] : [0, across, along, 0];
}

// Loads a mesh into a context and returns the function that draws a view of it. `original` is an <img> or null, with its
// orientation in data-turn; no view may ask for it before it is loaded. Throws what WebGL says where it cannot. To be called
// again when a lost context is restored.
export function createPainter(gl, mesh, original) {
  const canvas = gl.canvas;
  const data = decode(mesh);
  const isWide = data.faces.BYTES_PER_ELEMENT === 4;
  if (isWide && !gl.getExtension('OES_element_index_uint')) throw new Error('no 32-bit indices');
  const programs = {
    faces: compile(gl, vertexShaders.mesh, fragmentShaders.faces),
    edges: compile(gl, vertexShaders.mesh, fragmentShaders.edges),
    board: compile(gl, vertexShaders.picture, fragmentShaders.board),
    original: compile(gl, vertexShaders.picture, fragmentShaders.original),
  };
  const corners = buffer(gl, gl.ARRAY_BUFFER, new Float32Array([0, 0, mesh.width, 0, 0, mesh.height, mesh.width, mesh.height]));
  const positions = buffer(gl, gl.ARRAY_BUFFER, data.positions);
  const colors = buffer(gl, gl.ARRAY_BUFFER, data.colors);
  const faces = { buffer: buffer(gl, gl.ELEMENT_ARRAY_BUFFER, data.faces), count: data.faces.length };
  let edges = null; // made when they are first drawn
  const turn = turnOf(Number(original?.dataset.turn ?? 1));
  const margin = mesh.points ? 0.5 : 0; // px that the original reaches beyond the mesh
  let isLoaded = false;
  gl.enableVertexAttribArray(0);
  gl.disable(gl.DITHER);
  gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);

  const use = ({ program, where }, points, view) => {
    gl.useProgram(program);
    const high = [Math.fround(view.x), Math.fround(view.y)];
    gl.uniform2f(where.high, high[0], high[1]);
    gl.uniform2f(where.low, view.x - high[0], view.y - high[1]);
    gl.uniform2f(where.scale, (2 * view.scale) / canvas.width, (-2 * view.scale) / canvas.height);
    gl.uniform2f(where.full, mesh.width + 2 * margin, mesh.height + 2 * margin);
    gl.uniform1f(where.margin, margin);
    gl.uniformMatrix2fv(where.turn, false, turn);
    gl.uniform1f(where.straight, mesh.premultiplied ? 0 : 1);
    gl.bindBuffer(gl.ARRAY_BUFFER, points);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
  };
  // Over all of the picture.
  const drawPicture = (program, view) => {
    use(program, corners, view);
    gl.disableVertexAttribArray(1);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  };
  const drawElements = (program, elements, mode, view) => {
    use(program, positions, view);
    gl.bindBuffer(gl.ARRAY_BUFFER, colors);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 4, gl.UNSIGNED_BYTE, true, 0, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, elements.buffer);
    gl.drawElements(mode, elements.count, isWide ? gl.UNSIGNED_INT : gl.UNSIGNED_SHORT, 0);
  };
  const drawBoard = (view) => {
    gl.disable(gl.BLEND);
    if (mesh.channels !== 4) return;
    drawPicture(programs.board, view);
    gl.enable(gl.BLEND);
  };
  // At the right, up to the picture's edge.
  const drawOriginal = (view) => {
    if (!isLoaded) loadPicture(gl, original);
    isLoaded = true;
    const left = canvas.width / 2 - view.x * view.scale;
    const edge = left + mesh.width * view.scale * (1 - view.share);
    const from = Math.round(Math.min(canvas.width, Math.max(0, edge)));
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(from, 0, canvas.width - from, canvas.height);
    drawBoard(view);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, view.scale < 2 ? gl.LINEAR : gl.NEAREST);
    drawPicture(programs.original, view);
    gl.disable(gl.SCISSOR_TEST);
  };
  const drawEdges = (view) => {
    if (!edges) {
      const ends = edgesOf(data.faces, mesh.vertices);
      edges = { buffer: buffer(gl, gl.ELEMENT_ARRAY_BUFFER, ends), count: ends.length };
    }
    gl.enable(gl.BLEND);
    drawElements(programs.edges, edges, gl.LINES, view);
  };

  return (view) => {
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...view.ground, 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    drawBoard(view);
    drawElements(programs.faces, faces, gl.TRIANGLES, view);
    if (view.share > 0) drawOriginal(view);
    if (view.wires) drawEdges(view);
  };
}
