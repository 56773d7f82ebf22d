// hmesh/core in node and deno: the engine and where its modules are.
import { readFile } from 'node:fs/promises';
import { pathToFileURL } from 'node:url';
import { compile, Hmesh } from './engine.js';

export { Hmesh, HmeshError } from './engine.js';

// A text without a scheme is a path; one of a single letter is a drive's.
const fetchFile = (source) => {
  const url = typeof source === 'string' && !/^[a-z][a-z\d+.-]+:/i.test(source) ? pathToFileURL(source) : new URL(source);
  return url.protocol === 'file:' ? readFile(url) : fetch(url);
};

export const compileHmesh = (source = new URL('./hmesh.wasm', import.meta.url)) => compile(source, fetchFile);
export const compileCompact = (source = new URL('./hmesh.compact.wasm', import.meta.url)) => compile(source, fetchFile);

export const load = async (source, options) => new Hmesh(await compileHmesh(source), options);
