/** A placeholder as bytes, at most 4096, or as base64url or base64. */
export type Placeholder = string | Uint8Array;

/** A mesh in the order of the file, whose vertices have whole numbers of px, unless it is scaled to a size, and colours of 8 bits. */
export interface PlaceholderMesh {
  /** x, y, x, y ... in px, y down. */
  positions: Float32Array;
  /** `channels` a vertex. */
  colors: Uint8Array;
  /** Three a face. */
  indices: Uint32Array;
  /** Of the picture, px: 1 to 4096, or those of the size that decode() was given. */
  width: number;
  height: number;
  /** 3: RGB. 4: RGBA. */
  channels: number;
  /** Whether alpha has been multiplied into RGB. */
  premultiplied: boolean;
  /** Whether colours are for renderers that interpolate linear light. */
  linear: boolean;
  vertices: number;
  faces: number;
}

export interface PictureOptions {
  /** Of the longer side, px, 1 to 96; 40 by default. */
  pixels?: number;
  /** How often it is softened, by the mean of each pixel and its neighbours; 2 by default. */
  softness?: number;
}

/**
 * The mesh, or null of anything that is no placeholder. `size`, where it is given, is that of the image to which the mesh is scaled, and of the
 * mesh where the bytes leave it out. The same numbers as the library's read_bare_compact(), which takes more than 1024 vertices and 4096 px.
 */
export function decode(data: Placeholder, size?: { width?: number; height?: number }): PlaceholderMesh | null;
/** The mesh drawn small and softened: RGBA, alpha straight. */
export function toPixels(mesh: PlaceholderMesh, options?: PictureOptions): { data: Uint8ClampedArray; width: number; height: number };
/** A PNG of it as data: URL, in pages and on servers; null of anything that is no placeholder. */
export function toDataURL(data: Placeholder, options?: PictureOptions): string | null;
/** Shows the placeholder of an image's `data-mesh` as its background until it has loaded. False where it has none. */
export function paint(image: HTMLImageElement, options?: PictureOptions): boolean;
/**
 * Paints the images with `data-mesh` of a page, or of a part of it, when they come near the viewport and the page is idle; those that are
 * added later too. Returns what ends that.
 */
export function watch(root?: Document | Element, options?: PictureOptions): () => void;
