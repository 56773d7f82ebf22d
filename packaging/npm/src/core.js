// hmesh/core in browsers: the engine and where its modules are.
import { compile, Hmesh } from './engine.js';

export { Hmesh, HmeshError } from './engine.js';

export const compileHmesh = (source = new URL('./hmesh.wasm', import.meta.url)) => compile(source);
export const compileCompact = (source = new URL('./hmesh.compact.wasm', import.meta.url)) => compile(source);

export const load = async (source, options) => new Hmesh(await compileHmesh(source), options);
