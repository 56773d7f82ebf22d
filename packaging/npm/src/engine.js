// hmesh in one thread: a WebAssembly instance and synchronous calls. Knows no page, no worker and no files, so that it runs
// anywhere. Takes and gives what src/core.d.ts says.

export const EFFORTS = ['draft', 'fast', 'normal', 'fine', 'best'];
const FORMATS = ['ply', 'glb', 'svg', 'html', 'pdf', 'obj', 'hmc'];
const SVG_KINDS = ['gradient', 'exact', 'flat'];
// hmesh::Errc
const CODES = ['ok', 'invalid_argument', 'image_too_large', 'target_out_of_range', 'not_finite', 'write_failed', 'cancelled',
  'read_failed'];
// hmesh::Target::Kind, with the names that options have, and what makes a compact file
const TARGETS = ['vertices', 'percent', 'psnr', 'bytes'];
const ANSWER = ['code', 'message', 'width', 'height', 'channels', 'premultiplied', 'vertices', 'faces', 'positions', 'colors',
  'indices', 'bytes', 'size'];
const PAGES = 16;  // of memory in a MiB
const STACK = 1048576;  // bytes; meshing takes a fifth
const ALIGNMENT = 16;  // bytes: what compilers take for granted of a stack

export class HmeshError extends Error {
  constructor(message, code = 'invalid_argument') {
    super(message);
    this.name = 'HmeshError';
    this.code = code;
  }
}

const refuse = (message, code) => { throw new HmeshError(message, code); };
// By their tags, since arrays may come from another realm, such as a frame.
const isTyped = (array, ...types) => types.includes(array?.[Symbol.toStringTag]);

function number(names, name, what) {
  const index = names.indexOf(name);
  return index < 0 ? refuse(`the ${what} is none of ${names.join(', ')}: ${String(name)}`) : index;
}

export function checkRange(what, value, low, high, isWhole) {
  if (!(typeof value === 'number' && value >= low && value <= high && (!isWhole || value % 1 === 0)))
    refuse(`${what} must be ${isWhole ? 'a whole number ' : ''}from ${low} to ${high}: ${String(value)}`);
}

const checkPixels = (what, px) => checkRange(what, px, 1, 65536, true);
const checkChannels = (what, channels) => channels === 3 || channels === 4 || refuse(`${what} must have 3 or 4 channels: ${String(channels)}`);

// The image as an object of what is read of it alone, or an HmeshError.
export function checkImage(image) {
  const { data, width, height, channels = 4 } = image ?? {};
  if (!isTyped(data, 'Uint8Array', 'Uint8ClampedArray')) refuse('the image has no data that are bytes');
  checkPixels("the image's width", width);
  checkPixels("the image's height", height);
  checkChannels('the image', channels);
  const size = width * height * channels;
  if (data.length !== size)
    refuse(`the image has ${data.length} bytes (none where they were transferred), and ${width} x ${height} px of ${channels} `
      + `channels are ${size}`);
  return { data, width, height, channels };
}

// What is read of the options, checked; weights beside them, since they are large.
export function checkOptions(options, image) {
  const { effort = 'normal', seed = 1, premultiplied = false, bare = false, weights } = options ?? {};
  number(EFFORTS, effort, 'effort');
  checkRange('the seed', seed, 0, Number.MAX_SAFE_INTEGER, true);
  const given = TARGETS.filter((name) => options?.[name] != null);
  if (given.length > 1) refuse(`one of ${TARGETS.join(', ')} can be the target: ${given.join(', ')}`);
  const target = given[0] ?? 'percent', value = given.length > 0 ? options[target] : 1;
  if (typeof value !== 'number') refuse(`${target} must be a number: ${String(value)}`);
  if (target === 'bytes') checkRange(target, value, 1, 2 ** 31);
  else if (bare) refuse(`bare is of a target in bytes alone: ${target}`);
  if (weights != null) {
    if (target === 'bytes') refuse('a target in bytes knows no weights');
    if (!isTyped(weights, 'Float32Array') || weights.length !== image.width * image.height)
      refuse(`the weights are no Float32Array of ${image.width} x ${image.height} numbers: ${weights.length}`);
    if (weights.every((weight) => weight === 0)) refuse('the weights are all zero: no pixel would count');
  }
  return { effort, seed, premultiplied: !!premultiplied, bare: !!bare, weights, [target]: value };
}

export const isAddress = (source) => typeof source === 'string' || source instanceof URL || isTyped(source, 'URL');

// Makes a module of bytes, a Response, what fetchFile() takes, or a promise of one of these.
export async function compile(source, fetchFile = fetch) {
  let given = await source;
  if (given instanceof WebAssembly.Module) return given;
  if (isAddress(given)) given = await fetchFile(given);
  if (isTyped(given, 'ArrayBuffer') || ArrayBuffer.isView(given)) return WebAssembly.compile(given);
  if (!given?.ok) refuse(`hmesh.wasm cannot be read from ${given?.url ?? String(given)}: ${given?.status ?? 'no Response'}`, 'read_failed');
  return given.headers.get('content-type')?.startsWith('application/wasm')
    ? WebAssembly.compileStreaming(given) : WebAssembly.compile(await given.arrayBuffer());
}

// What an instance imports.
const imports = (memory, hmesh) => ({
  env: { memory, emscripten_notify_memory_growth() {} },
  wasi_snapshot_preview1: { proc_exit: hmesh.out_of_memory },
  hmesh,
});

// What some modules lack.
const lacking = () => refuse('this module neither writes nor reads files, nor draws: hmesh.wasm does');
const LACKING = {
  hmesh_write: lacking, hmesh_write_bare: lacking, hmesh_read: lacking, hmesh_render: lacking,
  hmesh_compact_image: () => refuse('this module knows no target in bytes: hmesh.compact.wasm does'),
};

// Whether a module is that of threads.
export const hasThreads = (module) => WebAssembly.Module.exports(module).some(({ name }) => name === 'hmesh_help');

// The life of a helper of an Hmesh with threads: never returns unless something goes wrong, which its Hmesh then hears.
export function help(module, memory, stack) {
  const out_of_memory = () => refuse('out of memory', 'out_of_memory');
  const wasm = new WebAssembly.Instance(module, imports(memory, { out_of_memory, progress: () => 1, show() {} })).exports;
  wasm.stackRestore(stack);
  try {
    wasm.hmesh_help();
  } catch (error) {
    wasm.hmesh_fail(error.code === 'out_of_memory' ? 1 : 2);  // Failure of binding/crew.hpp
  }
}

export class Hmesh {
  #module; #most; #memory; #wasm; #shared;
  #watch;  // what is told of the call at work, and what that threw

  // memory: of a module of threads, where its helpers are too.
  constructor(module, options) {
    const { maximumMemory = 2048, memory } = options ?? {};
    if (!isTyped(module, 'WebAssembly.Module')) refuse(`this is no WebAssembly.Module: ${String(module)}`);
    checkRange('maximumMemory', maximumMemory, 8, 2048);
    this.#module = module;
    this.#most = Math.floor(PAGES * maximumMemory);
    this.#shared = memory;
  }

  // Addresses from which the stacks of so many helpers grow down.
  stacks(count) {
    return this.#run((wasm) => Array.from({ length: count }, () => {
      const end = wasm.hmesh_allocate(STACK) + STACK;
      return end - end % ALIGNMENT;
    }));
  }

  meshImage(image, options) {
    image = checkImage(image);
    const { onProgress, onMesh } = options ?? {};
    const { effort, seed, premultiplied, bare, weights, ...target } = checkOptions(options, image);
    const { data, width, height } = image, isOpaque = image.channels === 3 || isAllOpaque(data);
    const channels = isOpaque ? 3 : 4, [[kind, value]] = Object.entries(target);
    const watch = { onProgress, onMesh, shown: 0 };
    const made = this.#run((wasm) => {
      this.#watch = watch;
      const at = wasm.hmesh_allocate(width * height * channels);
      this.#strip(data, image.channels, this.#bytes(at, width * height * channels), channels);
      const weightsAt = weights && this.#put(weights);
      const given = [at, width, height, channels, premultiplied && !isOpaque], recipe = [value, EFFORTS.indexOf(effort), seed];
      const answerAt = kind === 'bytes' ? wasm.hmesh_compact_image(...given, ...recipe, bare)
        : wasm.hmesh_mesh_image(...given, TARGETS.indexOf(kind), ...recipe, weightsAt);
      wasm.hmesh_release(at);
      wasm.hmesh_release(weightsAt);
      if (watch.thrown) return 0;
      const answer = this.#read(answerAt);
      if (answer.faces === 0) refuse(answer.message, CODES[answer.code]);
      const mesh = this.#mesh(answer, answer.code === 0);
      return kind === 'bytes' ? { ...mesh, file: this.#bytes(answer.bytes, answer.size).slice() } : mesh;
    });
    if (watch.thrown) throw watch.thrown[0];  // whatever it is
    return made;
  }

  write(mesh, format, options) {
    number(FORMATS, format, 'format');
    const { kind = 'gradient', wireframe = false, title = 'Triangle mesh', original, originalType = 'image/png', bare = false,
      lattice = 0, colorStep = 0 } = options ?? {};
    if (bare && format !== 'hmc') refuse(`bare is of hmc alone: ${format}`);
    if (bare) {
      checkRange('lattice', lattice, 0, 65536);
      checkRange('256 times the lattice', 256 * lattice, 0, 2 ** 24, true);
      checkRange('colorStep', colorStep, 0, 4095, true);
    }
    number(SVG_KINDS, kind, 'kind of SVG');
    if (original != null && !isTyped(original, 'Uint8Array')) refuse('the original is no Uint8Array');
    return this.#run((wasm) => {
      this.#hold(mesh);
      if (bare) return this.#take(wasm.hmesh_write_bare(256 * lattice, colorStep));
      const texts = [title, originalType].map((text) => this.#put(new TextEncoder().encode(String(text).replace(/\0/g, '') + '\0')));
      const originalAt = original && this.#put(original);
      const answer = wasm.hmesh_write(FORMATS.indexOf(format), SVG_KINDS.indexOf(kind), !!wireframe, texts[0], originalAt,
        original?.length, texts[1]);
      for (const at of [...texts, originalAt]) wasm.hmesh_release(at);
      return this.#take(answer);
    });
  }

  read(bytes, options) {
    if (!isTyped(bytes, 'Uint8Array')) refuse('the bytes of a file are no Uint8Array');
    return this.#run((wasm) => {
      const at = this.#put(bytes), answer = wasm.hmesh_read(at, bytes.length, options?.bare);
      wasm.hmesh_release(at);
      return { ...this.#mesh(this.#heed(answer), true), psnr: NaN };
    });
  }

  render(mesh, options) {
    const { width = mesh?.width, height = mesh?.height } = options ?? {};
    return this.#run((wasm) => {
      this.#hold(mesh);
      checkPixels("the picture's width", width);
      checkPixels("the picture's height", height);
      return { data: new Uint8ClampedArray(this.#take(wasm.hmesh_render(width, height)).buffer), width, height };
    });
  }

  // Gives the memory back; the next call takes it anew.
  free() {
    this.#wasm = undefined;
    this.#memory = null;
  }

  // Calls body() with the functions of C. What leaves them by force (no memory, a trap) leaves the instance in no known state.
  #run(body) {
    const watch = this.#watch;  // of the call within whose onProgress or onMesh this one is made
    try {
      if (!this.#wasm) this.#start();
      return body(this.#wasm);
    } catch (error) {
      if (error instanceof WebAssembly.RuntimeError || error instanceof RangeError || (!this.#wasm && !error?.code)) {
        this.free();
        throw new HmeshError(`hmesh stopped: ${error.message}`, 'internal');
      }
      if (error?.code === 'out_of_memory') this.free();
      throw error;
    } finally {
      this.#watch = watch;
    }
  }

  #start() {
    const outOfMemory = () => refuse(`out of memory: hmesh may take ${this.#most / PAGES} MiB`, 'out_of_memory');
    if (this.#shared && this.#memory === null) refuse('hmesh stopped before, and its threads with it', 'internal');
    const memory = this.#shared || new WebAssembly.Memory({ initial: 64, maximum: this.#most });
    const wasm = new WebAssembly.Instance(this.#module, imports(memory, {
      out_of_memory: outOfMemory,
      progress: (stage, fraction, total, vertices, energy, isMesh) => this.#guard(memory, (watch) => {
        const { onProgress, onMesh } = watch;
        if (onProgress?.({ stage: this.#text(stage), fraction, total, vertices, energy }) === false) return 0;
        if (!isMesh || !onMesh || total < Math.min(1.25 * watch.shown, watch.shown + 0.05) || total === 1) return 1;
        watch.shown = total;
        return 2;
      }),
      show: (answer) => this.#guard(memory, ({ onMesh }) => onMesh(this.#mesh(this.#read(answer), false))),
    })).exports;
    this.#memory = memory;
    wasm._initialize();
    this.#wasm = { ...LACKING, ...wasm };
  }

  // Calls what is told by an instance of this memory; what it throws stops the work, and is thrown by the call. Another memory means that a
  // call within this one gave it back: what the call at work goes on to say lies where nobody looks any more.
  #guard(memory, tell) {
    const watch = this.#watch;
    if (watch.thrown) return 0;
    try {
      const answer = tell(watch);
      if (memory !== this.#memory) refuse('hmesh stopped: a callback gave its memory back', 'cancelled');
      return answer;
    } catch (error) {
      watch.thrown = [error];
      return 0;
    }
  }

  #bytes(at, size) { return new Uint8Array(this.#memory.buffer, at, size); }

  #text(at) {
    const bytes = new Uint8Array(this.#memory.buffer);
    return new TextDecoder().decode(bytes.slice(at, bytes.indexOf(0, at)));
  }

  #put(array) {
    const at = this.#wasm.hmesh_allocate(array.byteLength);
    this.#bytes(at, array.byteLength).set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
    return at;
  }

  #read(at) {
    const words = new Uint32Array(this.#memory.buffer, at + 8);
    const answer = Object.fromEntries(ANSWER.map((name, k) => [name, words[k]]));
    answer.psnr = new Float64Array(this.#memory.buffer, at, 1)[0];
    answer.message = this.#text(answer.message);
    return answer;
  }

  // An answer, or what it refuses.
  #heed(at) {
    const answer = this.#read(at);
    if (answer.code) refuse(answer.message, CODES[answer.code]);
    return answer;
  }

  #take(at) {
    const { bytes, size } = this.#heed(at);
    return this.#bytes(bytes, size).slice();
  }

  #mesh({ width, height, channels, premultiplied, vertices, faces, positions, colors, indices, psnr }, complete) {
    const { buffer } = this.#memory;
    return {
      positions: new Float32Array(buffer, positions, 2 * vertices).slice(),
      colors: new Uint8Array(buffer, colors, channels * vertices).slice(),
      indices: new Uint32Array(buffer, indices, 3 * faces).slice(),
      width, height, channels, premultiplied: premultiplied !== 0, vertices, faces, psnr, complete,
    };
  }

  // Hands a mesh to the functions of C, which check its numbers.
  #hold(mesh) {
    if (mesh == null) refuse('there is no mesh: meshImage() or read() makes one');
    const { positions, colors, indices, width, height, channels = 3, premultiplied = false } = mesh;
    for (const [array, type, name] of [[positions, 'Float32Array', 'positions'], [colors, 'Uint8Array', 'colors'],
      [indices, 'Uint32Array', 'indices']])
      if (!isTyped(array, type)) refuse(`the mesh's ${name} are no ${type}`);
    checkPixels("the mesh's width", width);
    checkPixels("the mesh's height", height);
    checkChannels('the mesh', channels);
    const vertices = positions.length / 2, faces = indices.length / 3;
    if (colors.length !== channels * vertices || vertices % 1 || faces % 1)
      refuse(`the mesh has ${positions.length} coordinates, ${colors.length} numbers of colours of ${channels} channels and `
        + `${indices.length} indices, which do not fit together`);
    const answer = this.#read(this.#wasm.hmesh_hold(width, height, channels, premultiplied && channels === 4, vertices, faces));
    const { buffer } = this.#memory;
    new Float32Array(buffer, answer.positions, positions.length).set(positions);
    new Uint8Array(buffer, answer.colors, colors.length).set(colors);
    new Uint32Array(buffer, answer.indices, indices.length).set(indices);
  }

  #strip(from, channels, to, wanted) {
    if (channels === wanted) to.set(from);
    else for (let i = 0, j = 0; j < to.length; i += 4, j += 3) {
      to[j] = from[i];
      to[j + 1] = from[i + 1];
      to[j + 2] = from[i + 2];
    }
  }
}

function isAllOpaque(rgba) {
  for (let i = 3; i < rgba.length; i += 4) if (rgba[i] !== 255) return false;
  return true;
}
