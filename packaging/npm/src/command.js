#!/usr/bin/env node
// npx hmesh placeholder: each image becomes a line of HTML, or is written into the pages that show it.
import { chmod, readFile, realpath, rename, rm, stat, writeFile } from 'node:fs/promises';
import { dirname, join, relative, resolve } from 'node:path';
import { Hmesh, compileCompact } from './core.node.js';
import { encode, toText } from './encoder.js';
import { readImage } from './images.node.js';
import { tagsOf } from './pages.node.js';

const USAGE = `usage: hmesh placeholder [--bytes N] [--json] FILE...

  FILE        a .jpg or .png, which becomes a line <img src width height data-mesh>; where sharp is installed what that reads, too.
              Or a page (.html, .htm): images of its folder in <img src> are given data-mesh, and width and height if they have none.
  --bytes N   bytes of a placeholder at most, 48 to 2000; as text they are a third more. 200
  --json      prints {"FILE": {"width", "height", "mesh"}} instead of HTML`;

const refuse = (what) => { throw new Error(what); };

function parse(words) {
  const options = { bytes: 200, files: [], isJson: false };
  for (let k = 0; k < words.length; k++) {
    const [, name, value] = /^(--[a-z]+)(?:=(.*))?$/s.exec(words[k]) ?? [];
    if (name === '--bytes') {
      const text = value ?? words[++k] ?? '';
      options.bytes = Number(text);
      if (!/^\d+$/.test(text) || options.bytes < 48 || options.bytes > 2000) refuse(`--bytes must be a whole number from 48 to 2000: ${text}`);
    } else if (words[k] === '--json') options.isJson = true;
    else if (words[k] === '--') options.files.push(...words.splice(k + 1));
    else if (words[k].startsWith('-')) refuse(`there is no option ${words[k]}\n${USAGE}`);
    else options.files.push(words[k]);
  }
  return options.files.length ? options : refuse(`no file was given\n${USAGE}`);
}

// The address of a file, which may have any letters.
const toAddress = (path) => path.split('/').map(encodeURIComponent).join('/');

const isElsewhere = (address) => /^([a-z][a-z\d+.-]*:|\/)/i.test(address);

// As browsers take an address: without white space around it, and without ends of lines.
const trim = (address) => address.replace(/^[\0- ]+|[\0- ]+$|[\t\n\r]/g, '');

// The path that an address beside the page names.
function pathOf(address) {
  const path = address.replace(/[?#].*$/s, '');
  try {
    return decodeURIComponent(path);
  } catch {
    return path;  // as browsers take 100%.png
  }
}
const isImage = (path) => /\.(jpe?g|png|webp|avif|gif|tiff?)$/i.test(path);

// The page with placeholders, how many, and a sentence for each image that could not be read. Images that have one or are elsewhere stay as
// they are.
async function fill(page, folder, make) {
  const parts = [], faults = [];
  let done = 0, count = 0, base;
  for (const { name, attributes, at } of tagsOf(page)) {
    if (name === 'base' && attributes.has('href')) base ??= trim(attributes.get('href'));
    const src = trim(attributes.get('src') ?? ''), path = pathOf(src);
    if (name !== 'img' || attributes.has('data-mesh') || !isImage(path) || isElsewhere(src) || isElsewhere(base ?? '')) continue;
    try {
      const { width, height, mesh } = await make(join(folder, pathOf(base ?? '').replace(/[^/]*$/, ''), path));
      const size = attributes.has('width') || attributes.has('height') ? '' : ` width="${width}" height="${height}"`;
      parts.push(page.slice(done, at), `${size} data-mesh="${mesh}"`);
      done = at;
      count++;
    } catch (error) {
      faults.push(`${src}: ${error.message}`);
    }
  }
  return { page: parts.join('') + page.slice(done), count, faults };
}

// Fills a page in, which keeps its mode; of a symbolic link the page that it names.
async function fillFile(file, make) {
  const { page, count, faults } = await fill(await readFile(file, 'latin1'), dirname(file), make);
  if (count > 0) {
    const whole = await realpath(file), part = `${whole}.hmesh-part`;
    try {
      await writeFile(part, page, 'latin1');
      await chmod(part, (await stat(whole)).mode & 0o7777);
      await rename(part, whole);
    } catch (error) {
      await rm(part, { force: true });
      throw error;
    }
  }
  console.error(`${file}: ${count} placeholder${count === 1 ? '' : 's'}`);
  for (const fault of faults) complain(`${file}: ${fault}`);
}

function complain(what) {
  console.error(`hmesh: ${what}`);
  process.exitCode = 1;
}

async function run([verb, ...words]) {
  if (verb === '--version') return console.log(JSON.parse(await readFile(new URL('package.json', import.meta.url), 'utf8')).version);
  if (verb === '--help' || words.includes('--help')) return console.log(USAGE);
  if (verb !== 'placeholder') refuse(`${verb ? `there is no command ${verb}` : 'no command was given'}\n${USAGE}`);
  const { bytes, files, isJson } = parse(words), hmesh = new Hmesh(await compileCompact()), known = new Map();
  const all = Object.create(null);  // a file may be named __proto__
  const make = async (file) => {
    const name = resolve(file);
    if (!known.has(name)) {
      const { full: [width, height], ...image } = await readImage(file);
      known.set(name, { width, height, mesh: toText(encode(hmesh, image, { bytes })) });
    }
    return known.get(name);
  };
  for (const file of files) {
    try {
      if (/\.html?$/i.test(file)) await fillFile(file, make);
      else {
        const made = await make(file), src = relative('.', file).replaceAll('\\', '/');
        if (isJson) all[src] = made;
        else console.log(`<img src="${toAddress(src)}" width="${made.width}" height="${made.height}" data-mesh="${made.mesh}">`);
      }
    } catch (error) {
      complain(`${file}: ${error.message}`);
    }
  }
  if (isJson) console.log(JSON.stringify(all, null, 2));
}

// Of what is printed; who reads no further wants no more of it, and no words.
process.stdout.on('error', ({ code, message }) => {
  if (code === 'EPIPE') process.exitCode = 1;
  else complain(`standard output: ${message}`);
});
run(process.argv.slice(2)).catch((error) => {
  console.error(`hmesh: ${error.message}`);
  process.exitCode = 2;
});
