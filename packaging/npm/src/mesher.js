// Mesher: a worker that meshes, writes, reads and draws, one job at a time; and bindTo(), which makes the package's functions for a
// platform: where the module is, and how a worker is started.
import { HmeshError, checkImage, checkOptions, checkRange, hasThreads, isAddress } from './engine.js';

// Node's workers share memory with whom they belong to, and a browser's where the page is cross-origin isolated.
export const canShare = () => typeof SharedArrayBuffer === 'function' && globalThis.crossOriginIsolated !== false;
// px of an image of one tile, which is of one thread.
const SMALL = 65536;

// A memory that may grow to so many MiB, or where there is no room for that, as on phones, to less.
function sharedMemory(most) {
  for (let maximum = 16 * most | 0; ; maximum >>= 1)
    try {
      return new WebAssembly.Memory({ initial: 64, maximum, shared: true });
    } catch (error) {
      if (maximum < 1024) throw error;
    }
}

async function last(values) {
  let value;
  for await (value of values);
  return value;
}

class WorkerMesher {
  #platform; #image; #mesh; #worker;
  #crew;  // where the worker's memory is shared: {module, memory, stacks} until its helpers are started, and these
  #sent;  // the image that the worker has
  #jobs = [];  // the first is at work

  constructor(platform) { this.#platform = platform; }

  get mesh() { return this.#mesh; }

  setImage(image) { this.#image = checkImage(image); }

  meshImage(options) { return last(this.#meshes(options, false)); }

  refine(options) { return this.#meshes(options, true); }

  write(format, options) { return this.#ask({ write: format }, options); }

  render(options) { return this.#ask({ render: true }, options); }

  read(bytes, options) { return this.#ask({ read: bytes }, options); }

  close() {
    for (const job of this.#jobs.splice(0)) job.end({ error: new HmeshError('the Mesher was closed', 'cancelled') });
    this.#end();
  }

  #ask(message, given) {
    const { mesh, signal, ...options } = given ?? {};
    return last(this.#answers({ ...message, mesh, options }, signal));
  }

  async* #meshes(given, refine) {
    const { signal, onProgress } = given ?? {}, image = this.#image;
    if (!image) throw new HmeshError('the Mesher has no image: call setImage()');
    yield* this.#answers({ options: checkOptions(given, image), refine }, signal, image, onProgress);
  }

  // What a worker makes of a message, one after another.
  async* #answers(message, signal, image, onProgress) {
    const answers = [];
    let isDone = false, failure, wake = () => {};
    const stop = this.#begin({
      message,
      image,
      hear: ({ progress, mesh, result }) => {
        if (progress) return onProgress?.(progress);
        this.#mesh = mesh ?? ('read' in message ? result : this.#mesh);
        answers.push(mesh ?? result);
        wake();
      },
      end: (failed) => {
        isDone = true;
        failure = failed;
        wake();
      },
    }, signal);
    try {
      while (true) {
        while (answers.length > 0 && !failure) yield answers.shift();
        if (failure) throw failure.error;
        if (isDone) return;
        await new Promise((resolve) => { wake = resolve; });
      }
    } finally {
      stop();  // who leaves the loop wants no more of it
    }
  }

  // Puts a job behind the others. Returns what takes it out again.
  #begin(job, signal) {
    signal?.throwIfAborted();
    const abort = () => this.#drop(job, { error: signal.reason });
    signal?.addEventListener('abort', abort, { once: true });
    job.flag = canShare() && new Int32Array(new SharedArrayBuffer(4));
    this.#jobs.push(job);
    if (this.#jobs.length === 1) this.#next();
    return () => {
      signal?.removeEventListener('abort', abort);
      this.#drop(job);
    };
  }

  // failure: {error}, whatever that is; or none.
  #drop(job, failure) {
    const at = this.#jobs.indexOf(job), { end } = job;
    if (at < 0) return;
    job.hear = job.end = () => {};
    if (job.isPosted && job.flag) Atomics.store(job.flag, 0, 1);  // the worker hears it and says that it is done
    else {
      if (job.isPosted) this.#end();  // it hears nothing before it is done: the next job gets another
      this.#jobs.splice(at, 1);
      if (at === 0) this.#next();
    }
    end(failure);
  }

  async #next() {
    const [job] = this.#jobs;
    if (!job) return this.#worker?.hold(false);
    const { message, image } = job;
    try {
      const module = await this.#platform.module(image && message.options.bytes !== undefined);
      if (this.#jobs[0] !== job) return;
      if (this.#crew?.module !== module) this.#end();  // it has another one
      this.#worker ??= this.#start(module);
      this.#worker.hold(true);
      if (image?.width * image?.height > SMALL) this.#hire();
      const mesh = image || 'read' in message ? undefined : message.mesh ?? this.#mesh;
      this.#worker.post({ ...message, mesh, image: image === this.#sent ? undefined : image, flag: job.flag });
      job.isPosted = true;
      this.#sent = image ?? this.#sent;
    } catch (error) {
      this.#finish(job, { error });
    }
  }

  #start(module) {
    const worker = this.#platform.spawn();
    const ifAtWork = (take) => (told) => { if (worker === this.#worker && this.#jobs.length > 0) take(this.#jobs[0], told); };
    const crew = this.#crew = { module, memory: hasThreads(module) && sharedMemory(this.#platform.maximumMemory()), helpers: [], stacks: [] };
    const take = ifAtWork((job, { done, error, ...answer }) => {
      if (error && crew.memory && ['out_of_memory', 'internal'].includes(error.code)) this.#end();
      if (done) return this.#finish(job, error && { error: error.code ? new HmeshError(error.message, error.code) : new Error(error.message) });
      try {
        job.hear(answer);
      } catch (thrown) {
        this.#drop(job, { error: thrown });  // by onProgress
      }
    });
    worker.listen((answer) => {
      if (!answer.stacks) return take(answer);
      crew.stacks = answer.stacks;
      if (crew === this.#crew && crew.isWanted) this.#hire();
    }, ifAtWork((job, error) => {
      this.#end();
      this.#finish(job, { error: new HmeshError(`the worker failed: ${error?.message ?? 'it could not be loaded'}`, 'internal') });
    }));
    worker.post({ module, maximumMemory: this.#platform.maximumMemory(), memory: crew.memory, helpers: crew.memory ? this.#platform.threads() - 1 : 0 });
    return worker;
  }

  // Starts the helpers, as soon as there are stacks for them.
  #hire() {
    const { module, memory, stacks, helpers } = this.#crew;
    this.#crew.isWanted = true;
    for (const stack of stacks.splice(0)) {
      const helper = this.#platform.spawn();
      helper.listen(() => {}, () => {});  // without it the others do its work
      helper.post({ module, memory, stack });
      helper.hold(false);
      helpers.push(helper);
    }
  }

  #finish(job, failure) {
    if (this.#jobs[0] !== job) return;
    this.#jobs.shift();
    job.end(failure);
    this.#next();
  }

  #end() {
    this.#worker?.end();
    for (const helper of this.#crew?.helpers ?? []) helper.end();
    this.#worker = this.#crew = this.#sent = undefined;
  }
}

// A module that is compiled when it is first wanted, and again where that failed, as two functions: take() says where it comes from, if not from
// the package; get() returns its promise.
function kept(compile) {
  let module, source;
  const take = (given) => {
    if (!given) return;
    module = undefined;
    source = given;
    given.catch?.(() => {});  // of a promise that fails who wants the module will be told
  };
  const get = () => {
    const begun = module ??= compile(source);
    return begun.catch((error) => {
      if (module === begun) {  // it may be there the next time
        module = undefined;
        if (!isAddress(source)) source = undefined;
      }
      throw error;
    });
  };
  return [take, get];
}

// platform: compile(source, canShare), a promise of the module; compileCompact(source), of the one for targets in bytes; threads(), how many run
// at once; spawn(worker), a worker as an object of post(message), listen(onMessage, onError), end() and hold(isHeld), which says whether it
// keeps the process from ending.
export function bindTo({ compile, compileCompact, spawn, threads: mostThreads }) {
  const [takePlain, plain] = kept((source) => compile(source, canShare())), [takeCompact, compact] = kept(compileCompact);
  let start, count, most = 2048;
  const init = async (setup) => {
    const { wasm, compactWasm, worker = start, threads = count, maximumMemory = most } = setup ?? {};
    checkRange('threads', threads ?? 1, 1, 64);
    checkRange('maximumMemory', maximumMemory, 8, 2048);
    [start, count, most] = [worker, threads, maximumMemory];
    takePlain(wasm);
    takeCompact(compactWasm);
    await plain();
  };
  const platform = {
    spawn: () => spawn(start),
    maximumMemory: () => most,
    threads: () => Math.floor(Math.min(count ?? Math.min(8, mostThreads()), 1 + most / 8)),  // helpers' stacks take an eighth of the memory
    module: (isForBytes) => (isForBytes ? compact : plain)(),
  };
  class Mesher extends WorkerMesher {
    constructor() { super(platform); }
  }
  const meshImage = async (image, options) => {
    const mesher = new Mesher();
    try {
      mesher.setImage(image);
      return await mesher.meshImage(options);
    } finally {
      mesher.close();
    }
  };
  return { init, Mesher, meshImage };
}
