import type { Bytes, Effort, Hmesh, Pixels } from './core.js';

/** The bytes of a placeholder of an image: at most `bytes`, 48 to 2000, 200 by default. Of RGBA alone, and by an instance of compileCompact()'s
 * module. Takes half a second with the default effort, `normal`. Throws an HmeshError. */
export function encode(hmesh: Hmesh, image: Pixels, options?: { bytes?: number; effort?: Effort }): Bytes;
/** As `data-mesh` has it: base64url. */
export function toText(bytes: Uint8Array): string;
