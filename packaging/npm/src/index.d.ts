// hmesh: turns an image into a triangle mesh with one colour a vertex, in a worker.
import type { Bytes, Effort, Format, Mesh, MeshArrays, MeshOptions, Picture, Pixels, Progress, RenderOptions, Source, WriteOptions } from './core.js';

export { HmeshError } from './core.js';
export type { Bytes, Effort, Format, Mesh, MeshArrays, MeshOptions, Picture, Pixels, Progress, RenderOptions, Source, WriteOptions } from './core.js';

/** A mesh, and the effort asked for. */
export type EffortMesh = Mesh & { effort: Effort };

export interface WorkOptions extends MeshOptions {
  /** Stops the work: the call is rejected with the signal's reason at once. */
  signal?: AbortSignal;
  /** Told some 200 times at most for each mesh. What it throws stops the work and rejects the call. */
  onProgress?: (progress: Progress & { effort: Effort }) => void;
}

/** Makes the mesh of an image, in a worker of its own, whose memory is given back when garbage is collected: for many images keep a Mesher. */
export function meshImage(image: Pixels, options?: WorkOptions): Promise<EffortMesh>;

/**
 * A worker that keeps its image. Calls wait for those before them; each may be rejected with an HmeshError, after which the Mesher can be
 * used as before. What was stopped costs nothing but, where no memory is shared (pages that are not cross-origin isolated), a new worker.
 */
export class Mesher {
  /** The mesh made or read last. */
  readonly mesh: EffortMesh | Mesh | undefined;
  /** Takes the image to mesh, whose pixels are read when the first call needs them. Throws an HmeshError. Where they, or the arrays of options,
   * were transferred elsewhere before a call begins, that call is rejected with the platform's DataCloneError. */
  setImage(image: Pixels): void;
  /** Makes a mesh of the image. */
  meshImage(options?: WorkOptions): Promise<EffortMesh>;
  /** Gives the mesh of the image as it grows, some 40 times at most: soon a first one, with up to three times the vertices asked for; last
   * the one that meshImage() makes, which alone may be `complete`. Leaving the loop stops the work. */
  refine(options?: WorkOptions): AsyncGenerator<EffortMesh, void, void>;
  /** The bytes of a file of the last mesh, that of the call before this one, or of another one. */
  write(format: Format, options?: WriteOptions & { mesh?: MeshArrays; signal?: AbortSignal }): Promise<Bytes>;
  /** Draws the last mesh, or another one, pixel for pixel as a GPU does, at any size. */
  render(options?: RenderOptions & { mesh?: MeshArrays; signal?: AbortSignal }): Promise<Picture>;
  /** Reads an .hmc file, whose mesh becomes the last one. */
  read(file: Uint8Array, options?: { bare?: boolean; signal?: AbortSignal }): Promise<Mesh>;
  /** Ends the worker; calls that are not done are rejected. The next call starts another. */
  close(): void;
}

export interface Setup {
  /** hmesh.wasm, where the package's files do not stay together. Of a page that is cross-origin isolated, hmesh.threads.wasm will do too. */
  wasm?: Source | Promise<Source>;
  /** hmesh.compact.wasm, likewise, which is read when the first target in bytes is asked for. */
  compactWasm?: Source | Promise<Source>;
  /** Starts a worker that runs `hmesh/worker`: for bundlers that leave `new URL('./worker.js', import.meta.url)` as it is. */
  worker?: () => unknown;
  /** How many threads mesh an image above 65,536 pixels, 1 to 64: by default as many as the processor runs at once, 8 at most; one, and one
   * more for each 8 MiB of maximumMemory, at most. Only in node and in pages that are cross-origin isolated; the bytes are the same. */
  threads?: number;
  /** MiB that a Mesher may take, 8 to 2048, the default. */
  maximumMemory?: number;
}

/** Sets up what is not to be as it is by default, for the Meshers that work from then on, and compiles the module. What is left out stays
 * as it was set up before. */
export function init(setup?: Setup): Promise<void>;
