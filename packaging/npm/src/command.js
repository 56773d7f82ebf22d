#!/usr/bin/env node
// npx hmesh placeholder: each image becomes a line of HTML, or is written into the pages that show it.
import { readFile, rename, writeFile } from 'node:fs/promises';
import { dirname, join, relative, resolve } from 'node:path';
import { Hmesh, compileCompact } from './core.node.js';
import { encode, toText } from './encoder.js';
import { readImage } from './images.node.js';

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

const escape = (text) => text.replace(/[&"<>]/g, (letter) => ({ '&': '&amp;', '"': '&quot;', '<': '&lt;', '>': '&gt;' })[letter]);
const unescape = (text) =>
  text.replace(/&(amp|quot|lt|gt|#39);/g, (_, name) => ({ amp: '&', quot: '"', lt: '<', gt: '>', '#39': "'" })[name]);

// The page with placeholders, and how many. Comments, scripts, and images that have one or are elsewhere stay as they are.
async function fill(html, folder, make) {
  const parts = html.split(/(<!--.*?-->|<script\b.*?<\/script\s*>|<img\b(?:"[^"]*"|'[^']*'|[^"'>])*>)/gis);
  let count = 0;
  for (let k = 1; k < parts.length; k += 2) {
    if (!/^<img\b/i.test(parts[k])) continue;
    const found = parts[k].slice(4).matchAll(/([^\s"'>/=]+)(?:\s*=\s*("[^"]*"|'[^']*'|[^\s"'>]+))?/g);
    const attributes = new Map([...found].map(([, name, value = '']) => [name.toLowerCase(), unescape(value.replace(/^(["'])(.*)\1$/s, '$2'))]));
    const src = attributes.get('src')?.replace(/[?#].*$/s, '');
    if (!src || attributes.has('data-mesh') || /^([a-z][a-z\d+.-]*:|\/)/i.test(src) || !/\.(jpe?g|png|webp|avif|gif|tiff?)$/i.test(src)) continue;
    const { width, height, mesh } = await make(join(folder, decodeURIComponent(src)));
    const size = attributes.has('width') || attributes.has('height') ? '' : ` width="${width}" height="${height}"`;
    parts[k] = parts[k].replace(/\s*\/?>$/, (end) => `${size} data-mesh="${mesh}"${end}`);
    count++;
  }
  return { html: parts.join(''), count };
}

async function run([verb, ...words]) {
  if (verb === '--version') return console.log(JSON.parse(await readFile(new URL('package.json', import.meta.url), 'utf8')).version);
  if (verb === '--help' || words.includes('--help')) return console.log(USAGE);
  if (verb !== 'placeholder') refuse(`${verb ? `there is no command ${verb}` : 'no command was given'}\n${USAGE}`);
  const { bytes, files, isJson } = parse(words), hmesh = new Hmesh(await compileCompact()), known = new Map(), all = {};
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
      if (/\.html?$/i.test(file)) {
        const { html, count } = await fill(await readFile(file, 'utf8'), dirname(file), make);
        if (count) {
          await writeFile(`${file}.hmesh-part`, html);
          await rename(`${file}.hmesh-part`, file);
        }
        console.error(`${file}: ${count} placeholder${count === 1 ? '' : 's'}`);
      } else {
        const made = await make(file), src = relative('.', file).replaceAll('\\', '/');
        if (isJson) all[src] = made;
        else console.log(`<img src="${escape(encodeURI(src))}" width="${made.width}" height="${made.height}" data-mesh="${made.mesh}">`);
      }
    } catch (error) {
      console.error(`hmesh: ${file}: ${error.message}`);
      process.exitCode = 1;
    }
  }
  if (isJson) console.log(JSON.stringify(all, null, 2));
}

run(process.argv.slice(2)).catch((error) => {
  console.error(`hmesh: ${error.message}`);
  process.exitCode = 2;
});
