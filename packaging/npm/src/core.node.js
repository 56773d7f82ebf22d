// hmesh/core in node and deno: the engine and where its modules are.
import { readFile } from 'node:fs/promises';
import { compile, Hmesh } from './engine.js';

export { Hmesh, HmeshError } from './engine.js';

const fetchFile = (url) => (new URL(url).protocol === 'file:' ? readFile(new URL(url)) : fetch(url));

export const compileHmesh = (source = new URL('./hmesh.wasm', import.meta.url)) => compile(source, fetchFile);
export const compileCompact = (source = new URL('./hmesh.compact.wasm', import.meta.url)) => compile(source, fetchFile);

export const load = async (source, options) => new Hmesh(await compileHmesh(source), options);
