// hmesh - the script with which write_html()'s page draws: the mesh, its edges and the original, by WebGL 1.
//
// It reads `mesh`, which html.hpp writes before it, and the view that html_handling.hpp changes. The vertex shader takes the
// view's centre from the positions in two parts, high and low, so that 24 bits are enough at any zoom. No anti-aliasing:
// neighbouring faces meet without a seam and colours are continuous. Colours with alpha lie over a checkerboard. Once the
// picture is drawn the canvas has the attribute data-drawn.
#ifndef HMESH_IO_DETAIL_HTML_DRAWING_HPP
#define HMESH_IO_DETAIL_HTML_DRAWING_HPP

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

inline constexpr const char* html_drawing = R"html(const byId = (id) => document.getElementById(id);
const canvas = byId('mesh'), share = byId('share'), original = byId('original');
const native = location.hash === '#native';
const view = { x: mesh.width / 2, y: mesh.height / 2, scale: 1 };  // the centre in the mesh's px; device px a px
let wires = false, fitted = true, wanted = false, gl, draw;

function decode() {
  const text = atob(mesh.data), bytes = new Uint8Array(text.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = text.charCodeAt(i);
  const Index = mesh.vertices <= 65535 ? Uint16Array : Uint32Array;
  const positions = new Float32Array(bytes.buffer, 0, 2 * mesh.vertices);
  const faces = new Index(bytes.buffer, positions.byteLength, 3 * mesh.faces);
  const stored = bytes.subarray(positions.byteLength + faces.byteLength), n = mesh.channels;
  const colors = new Uint8Array(4 * mesh.vertices).fill(255);
  for (let v = 0; v < mesh.vertices; v++)
    for (let k = 0; k < (n === 4 ? 4 : 3); k++) colors[4 * v + k] = stored[n * v + (n === 1 ? 0 : k)];
  return { positions, faces, colors };
}

function edgesOf({ faces }) {  // each once
  const seen = new Set(), edges = [];
  for (let i = 0; i < faces.length; i++) {
    const a = faces[i], b = faces[i % 3 === 2 ? i - 2 : i + 1], key = Math.min(a, b) * mesh.vertices + Math.max(a, b);
    if (!seen.has(key)) { seen.add(key); edges.push(a, b); }
  }
  return new faces.constructor(edges);
}

function compile(vertex, fragment) {
  const program = gl.createProgram();
  for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, 'precision mediump float;' + fragment]]) {
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
  for (const name of ['high', 'low', 'scale', 'full', 'straight', 'one']) where[name] = gl.getUniformLocation(program, name);
  return { program, where };
}

function buffer(target, data) {
  const made = gl.createBuffer();
  gl.bindBuffer(target, made);
  gl.bufferData(target, data, gl.STATIC_DRAW);
  return made;
}

function loadOriginal() {
  const texture = gl.createTexture(), most = gl.getParameter(gl.MAX_TEXTURE_SIZE);
  let source = original;
  const shrink = most / Math.max(source.naturalWidth, source.naturalHeight);
  if (shrink < 1) {
    source = document.createElement('canvas');
    source.width = Math.floor(original.naturalWidth * shrink) || 1;
    source.height = Math.floor(original.naturalHeight * shrink) || 1;
    source.getContext('2d').drawImage(original, 0, 0, source.width, source.height);
  }
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
  gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, true);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, source);
  for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, wrap, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
}

function setUp() {
  const data = decode();
  if (data.faces.BYTES_PER_ELEMENT === 4 && !gl.getExtension('OES_element_index_uint')) throw new Error('no 32-bit indices');
  const indexType = data.faces.BYTES_PER_ELEMENT === 4 ? gl.UNSIGNED_INT : gl.UNSIGNED_SHORT;
  const place = 'attribute vec2 at; attribute vec4 stored; uniform vec2 high, low, scale; varying vec4 color;' +
    'void main() { color = stored; gl_Position = vec4(((at - high) - low) * scale, 0, 1); }';
  const shade = compile(place, 'varying vec4 color; uniform float straight;' +
    'void main() { gl_FragColor = vec4(color.rgb * mix(1.0, color.a, straight), color.a); }');
  const line = compile(place, 'void main() { gl_FragColor = vec4(0.5); }');
  const board = compile(place, 'void main() { vec2 q = floor(gl_FragCoord.xy / 12.0);' +
    'gl_FragColor = vec4(vec3(mod(q.x + q.y, 2.0) < 1.0 ? 0.36 : 0.5), 1); }');
  const picture = compile('attribute vec2 at; uniform vec2 high, low, scale, full; varying vec2 q;' +
    'void main() { q = at / full; gl_Position = vec4(((at - high) - low) * scale, 0, 1); }',
    'varying vec2 q; uniform sampler2D one; void main() { gl_FragColor = texture2D(one, q); }');
  const positions = buffer(gl.ARRAY_BUFFER, data.positions), colors = buffer(gl.ARRAY_BUFFER, data.colors);
  const corners = buffer(gl.ARRAY_BUFFER, new Float32Array([0, 0, mesh.width, 0, 0, mesh.height, mesh.width, mesh.height]));
  const faces = buffer(gl.ELEMENT_ARRAY_BUFFER, data.faces);
  let edges = null, edgeCount = 0, loaded = false;

  const use = ({ program, where }, points) => {
    gl.useProgram(program);
    const high = [Math.fround(view.x), Math.fround(view.y)];
    gl.uniform2f(where.high, high[0], high[1]);
    gl.uniform2f(where.low, view.x - high[0], view.y - high[1]);
    gl.uniform2f(where.scale, 2 * view.scale / canvas.width, -2 * view.scale / canvas.height);
    gl.uniform2f(where.full, mesh.width, mesh.height);
    gl.uniform1f(where.straight, mesh.premultiplied ? 0 : 1);
    gl.bindBuffer(gl.ARRAY_BUFFER, points);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
  };
  const quad = (program) => {
    use(program, corners);
    gl.disableVertexAttribArray(1);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  };
  const mapped = (program, elements, mode, count) => {
    use(program, positions);
    gl.bindBuffer(gl.ARRAY_BUFFER, colors);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 4, gl.UNSIGNED_BYTE, true, 0, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, elements);
    gl.drawElements(mode, count, indexType, 0);
  };
  gl.enableVertexAttribArray(0);
  gl.disable(gl.DITHER);
  gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);

  return () => {
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.disable(gl.SCISSOR_TEST);
    gl.disable(gl.BLEND);
    gl.clearColor(27 / 255, 27 / 255, 29 / 255, 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    if (mesh.channels === 4) { quad(board); gl.enable(gl.BLEND); }
    mapped(shade, faces, gl.TRIANGLES, data.faces.length);
    if (original && Number(share.value) > 0 && original.naturalWidth > 0) {
      if (!loaded) { loadOriginal(); loaded = true; }
      // The original's part is at the right, up to the picture's edge.
      const left = canvas.width / 2 - view.x * view.scale, wide = mesh.width * view.scale;
      const from = Math.round(Math.min(canvas.width, Math.max(0, left + wide * (1 - Number(share.value)))));
      gl.enable(gl.SCISSOR_TEST);
      gl.scissor(from, 0, canvas.width - from, canvas.height);
      gl.disable(gl.BLEND);
      if (mesh.channels === 4) { quad(board); gl.enable(gl.BLEND); }
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, view.scale < 2 ? gl.LINEAR : gl.NEAREST);
      quad(picture);
      gl.disable(gl.SCISSOR_TEST);
    }
    if (wires) {
      if (!edges) { const list = edgesOf(data); edges = buffer(gl.ELEMENT_ARRAY_BUFFER, list); edgeCount = list.length; }
      gl.enable(gl.BLEND);
      mapped(line, edges, gl.LINES, edgeCount);
    }
    canvas.dataset.drawn = '';
  };
}
)html";

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_DETAIL_HTML_DRAWING_HPP
