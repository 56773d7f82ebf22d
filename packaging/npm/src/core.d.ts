// hmesh/core: hmesh in the calling thread, for workers of one's own.

/** How much work goes into a mesh: `draft` shows what there is, `fast` adds some 2 dB, `normal` another 0.6, `fine` 0.1 to 0.5 in four
 * to five times the time of `normal`; `best` takes minutes. Steps are counted, not seconds: the same meshes on any machine. */
export type Effort = 'draft' | 'fast' | 'normal' | 'fine' | 'best';

/** Bytes in an ArrayBuffer: Uint8Array<ArrayBuffer> of TypeScript 5.7 and later, Uint8Array of those before. */
export type Bytes = ReturnType<Uint8Array['slice']>;

/** The files that hmesh writes; `hmc` is its own compact one, which it reads too. */
export type Format = 'ply' | 'glb' | 'svg' | 'html' | 'pdf' | 'obj' | 'hmc';

/** Pixels, row after row from above: an ImageData is one. */
export interface Pixels {
  /** width * height * channels bytes, alpha straight. */
  readonly data: Uint8ClampedArray | Uint8Array;
  /** px, 1 to 65536. */
  readonly width: number;
  /** px, 1 to 65536; at most 2^28 pixels in all. */
  readonly height: number;
  /** 4, RGBA, unless it is 3, RGB. An image whose alpha is 255 throughout is meshed as RGB, in two thirds of the time. */
  readonly channels?: 3 | 4;
}

/** What a mesh is to be like. One of vertices, percent, psnr and bytes may be given; by default it is 1 percent. */
export interface MeshOptions {
  /** Number of vertices, from 4 to the number of pixels; of a fraction the whole number below. */
  vertices?: number;
  /** Vertices in percent of the pixels, above 0, at most 100. */
  percent?: number;
  /** The fewest vertices that reach this PSNR, in dB, as 10 log10(255^2 / MSE), the MSE over pixels and channels. Takes
   * 1.3 to 2.7 times as long as for that number of vertices. */
  psnr?: number;
  /** At most so many bytes of an .hmc file, of which all but some 2 % are used: vertices, their places and colours as coarse as that takes. The
   * mesh is what `file` holds. Knows no weights, and of refine() makes one mesh alone; four times the time of a mesh of as many vertices, in one
   * thread. Needs hmesh.compact.wasm, which a Mesher finds by itself. */
  bytes?: number;
  /** Of bytes: the bare profile, for data in a page, of which a mesh is as large as its lattice: WriteOptions. */
  bare?: boolean;
  /** `normal` by default. */
  effort?: Effort;
  /** Of random numbers, a whole number from 0 to 2^53 - 1; 1 by default. The same image, options and seed give the same bytes. */
  seed?: number;
  /** How much each pixel counts, in PSNRs too: numbers >= 0, not all 0, one a pixel, row after row. Only ratios matter. */
  weights?: Float32Array;
  /** Of images with alpha: the colours are multiplied by it before meshing, and stay so in the mesh, so that edges carry no fringes. */
  premultiplied?: boolean;
}

/** How far the work is. */
export interface Progress {
  /** The stage's name. */
  stage: string;
  /** How much of the stage is done, 0 to 1. */
  fraction: number;
  /** How much of the whole is done, 0 to 1, as a share of its time, estimated. */
  total: number;
  /** The number of vertices now. */
  vertices: number;
  /** Sum of squared differences over pixels and channels; 0 before there is a mesh. */
  energy: number;
}

/** A triangle mesh. Pixel (i, j) is the square [i, i + 1] x [j, j + 1] of its plane, y down. */
export interface Mesh {
  /** x and y of each vertex, in px. */
  positions: Float32Array;
  /** The colour of each vertex: `channels` numbers, as the image stores them. */
  colors: Uint8Array;
  /** Three vertices for each face, clockwise on the screen. */
  indices: Uint32Array;
  /** px of the image. */
  width: number;
  /** px of the image. */
  height: number;
  /** 3, RGB, or 4, RGBA. */
  channels: 3 | 4;
  /** Whether the colours are multiplied by alpha. */
  premultiplied: boolean;
  vertices: number;
  faces: number;
  /** dB: 10 log10(255^2 / MSE), the MSE over pixels, as their weights count, and channels, of the mesh as a GPU draws it at the image's size.
   * NaN of a file. */
  psnr: number;
  /** Of a target in bytes: the .hmc file, which every build of hmesh can read; read(file, { bare: true }) where it is bare. */
  file?: Bytes;
  /** Whether the mesh is what was asked for: false of one on the way to it, of one that was stopped, and where no mesh reached the PSNR. */
  complete: boolean;
}

/** The part of a mesh that is written and drawn. Meshes of one's own will do: their numbers are checked. */
export type MeshArrays = Pick<Mesh, 'positions' | 'colors' | 'indices' | 'width' | 'height'>
  & Partial<Pick<Mesh, 'channels' | 'premultiplied'>>;

export interface WriteOptions {
  /** Of svg: how faces are filled. `gradient`, the default, is near, `exact` is what a GPU draws in 1.8 times the bytes, `flat` is small. */
  kind?: 'gradient' | 'exact' | 'flat';
  /** Of svg: draws the edges too. */
  wireframe?: boolean;
  /** Of html: the page's title. */
  title?: string;
  /** Of html: the bytes of a picture's file to compare with. */
  original?: Uint8Array;
  /** The media type of `original`, `image/png` by default. */
  originalType?: string;
  /** Of hmc: the bare profile, for data in a page: a few bytes of head, no checksum. Positions must be whole px unless there is a lattice. */
  bare?: boolean;
  /** Of the bare profile: the step of the lattice that vertices are moved to, px; 0, the default: they stay. */
  lattice?: number;
  /** Of the bare profile: the step of coarse colours, in 16ths of a 255th, 0 to 4095; 0, the default: they are exact. */
  colorStep?: number;
}

export interface RenderOptions {
  /** px, 1 to 65536; the mesh's own by default. */
  width?: number;
  /** px, 1 to 65536; the mesh's own by default. At most 2^28 pixels in all. */
  height?: number;
}

/** RGBA, alpha straight: `new ImageData(picture.data, picture.width)` takes it. */
export interface Picture {
  data: ReturnType<Uint8ClampedArray['slice']>;
  width: number;
  height: number;
}

/** What is wrong, in a sentence that names the value and its bound. */
export class HmeshError extends Error {
  constructor(message: string, code?: string);
  /** `internal` is a mistake of hmesh's own. */
  code: 'invalid_argument' | 'image_too_large' | 'target_out_of_range' | 'not_finite' | 'cancelled' | 'read_failed' | 'out_of_memory'
    | 'internal' | (string & {});
}

/** Where hmesh.wasm comes from: its bytes, a module, an address (in node and deno also a path), or the answer of fetch(). hmesh.meshing.wasm, two
 * thirds as large, makes the same meshes and refuses to write(), read() and render(); hmesh.compact.wasm refuses that too, and knows targets in
 * bytes. */
export type Source = WebAssembly.Module | BufferSource | URL | string | Response;

/** One instance of hmesh. All calls are synchronous, and all of them may throw an HmeshError, after which it can be used as before. */
export class Hmesh {
  /** `maximumMemory`: MiB, 8 to 2048, the default. Meshing takes 32 bytes a pixel of RGB and 0.7 kB a vertex, at most. */
  constructor(module: WebAssembly.Module, options?: { maximumMemory?: number });
  /** Makes a mesh. What onProgress or onMesh throws stops the work and is thrown. */
  meshImage(image: Pixels, options?: MeshOptions & {
    /** Called every few milliseconds; where it returns false, the mesh reached so far is the result, of a target in bytes an HmeshError. */
    onProgress?: (progress: Progress) => boolean | void;
    /** Called with the mesh so far, some 40 times at most: where one can be had after a quarter more of the work, or a twentieth of the
     * whole. The first have up to three times the vertices. Their `psnr` is that before colours are rounded. Costs some percent. */
    onMesh?: (mesh: Mesh) => void;
  }): Mesh;
  /** The bytes of a file. */
  write(mesh: MeshArrays, format: Format, options?: WriteOptions): Bytes;
  /** The mesh of an .hmc file; grey becomes RGB, 16 bits become 8, and a periodic mesh one that covers its picture and stands
   * out of it, of which write() makes no .hmc. Files with a start table, as the command's --bytes makes them without --no-table, and of
   * samples that are points are refused, and that colours are for linear light is not told. */
  read(file: Uint8Array, options?: { bare?: boolean }): Mesh;
  /** Draws a mesh pixel for pixel as a GPU does, at any size. */
  render(mesh: MeshArrays, options?: RenderOptions): Picture;
  /** Gives the memory back; the next call takes it anew. Within onProgress or onMesh that ends the call at work. */
  free(): void;
}

/** Compiles hmesh.wasm, by default that beside this file. */
export function compileHmesh(source?: Source | Promise<Source>): Promise<WebAssembly.Module>;

/** Compiles hmesh.compact.wasm, for targets in bytes, by default that beside this file. */
export function compileCompact(source?: Source | Promise<Source>): Promise<WebAssembly.Module>;

/** Compiles hmesh.wasm and makes an instance. */
export function load(source?: Source | Promise<Source>, options?: { maximumMemory?: number }): Promise<Hmesh>;
