// Puts the page together: node web/build.mjs FOLDER
//
// FOLDER/npm holds the files of the package. FOLDER/index.html with what it loads is for servers; FOLDER/hmesh.html is the same
// page as one file, which works from a file:// address too. The same files give the same bytes.
//
// In the one file modules are functions that return what they export, in the order in which they need each other, without
// comments. The module of WebAssembly is text whose characters are its bytes, but for three that HTML does not keep, which have
// 256 more: compressed, it is three quarters of what base64 is.
import { cpSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const viewer = join(here, '..', 'viewer');
const SHARED = ['drawing.js', 'pointers.js']; // of the page of write_html()

const POLICY = "default-src 'none'; base-uri 'none'; form-action 'none'; img-src data:; ";
const POLICIES = {
  folder: `${POLICY}script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; worker-src 'self'; connect-src 'self'`,
  file: `${POLICY}script-src 'unsafe-inline' 'wasm-unsafe-eval'; style-src 'unsafe-inline'; worker-src blob:`,
};

const fail = (text) => {
  throw new Error(text);
};
// Without lines that are empty or nothing but comment, and what lines are indented by.
const bare = (text) => text.replace(/^\s*\/\*[^]*?\*\/\n/gm, '').replace(/^\s*\/\/.*\n/gm, '').replace(/^\s+/gm, '');

// A module and those that it imports as one script.
function bundle(entry) {
  const names = new Map();
  const parts = [];
  function add(file) {
    if (names.has(file)) return names.get(file);
    const name = `module${names.size}`;
    names.set(file, name);
    const exported = [];
    const pairs = (list) => list.split(',').map((one) => one.trim().split(/\s+as\s+/)).filter(([from]) => from);
    const from = (path) => add(resolve(dirname(file), path));
    const body = bare(readFileSync(file, 'utf8'))
      .replace(/^import\s*\{([^}]*)\}\s*from\s*'(\.[^']*)';$/gm, (_, list, path) =>
        `const { ${pairs(list).map(([a, b = a]) => `${a}: ${b}`).join(', ')} } = ${from(path)};`)
      .replace(/^export\s*\{([^}]*)\}\s*from\s*'(\.[^']*)';$/gm, (_, list, path) => {
        const other = from(path);
        for (const [a, b = a] of pairs(list)) exported.push(`${b}: ${other}.${a}`);
        return '';
      })
      .replace(/^export\s*\{([^}]*)\};$/gm, (_, list) => {
        for (const [a, b = a] of pairs(list)) exported.push(`${b}: ${a}`);
        return '';
      })
      .replace(/^export\s+(const\s*\{([^}]*)\})/gm, (_, kept, list) => {
        for (const [a] of pairs(list)) exported.push(a);
        return kept;
      })
      .replace(/^export\s+((?:async\s+)?function\*?|class|const|let)\s+(\w+)/gm, (_, kind, what) => {
        exported.push(what);
        return `${kind} ${what}`;
      });
    const left = /^(?:import|export)\b.*/m.exec(body);
    if (left) fail(`${file}: a form that web/build.mjs does not know: ${left[0]}`);
    parts.push(`const ${name} = (() => {\n${body}return { ${exported.join(', ')} };\n})();\n`);
    return name;
  }
  add(entry);
  const text = parts.join('');
  return /<\/script|<!--/i.test(text) ? fail(`${entry}: holds what ends a script`) : text;
}

const character = (byte) => String.fromCharCode([0, 13, 60].includes(byte) ? 256 + byte : byte);
const textOf = (bytes) => Array.from(bytes, character).join('');

const [folder] = process.argv.slice(2);
if (!folder) fail('usage: node web/build.mjs FOLDER');
const page = readFileSync(join(here, 'index.html'), 'utf8').replace(/^<!--[^]*?-->\n/m, '');
const modules = readdirSync(here).filter((file) => /\.(js|css)$/.test(file));

for (const file of modules) cpSync(join(here, file), join(folder, file));
for (const file of SHARED) cpSync(join(viewer, file), join(folder, file));
writeFileSync(join(folder, 'index.html'), page.replace('{{policy}}', POLICIES.folder));

const script = (id, type, text) => `<script id="${id}" type="${type}">${text}</script>\n`;
const inlined = [
  script('pixels-worker', 'text/plain', bundle(join(folder, 'pixels_worker.js'))),
  script('hmesh-worker', 'text/plain', bundle(join(folder, 'npm', 'worker.js'))),
  script('hmesh-wasm', 'application/octet-stream', textOf(readFileSync(join(folder, 'npm', 'hmesh.wasm')))),
  `<script type="module">\n${bundle(join(folder, 'page.js'))}</script>\n`,
].join('');
writeFileSync(join(folder, 'hmesh.html'), page
  .replace('{{policy}}', POLICIES.file)
  .replace(/<link rel="stylesheet".*\n/, () => `<style>\n${bare(readFileSync(join(here, 'page.css'), 'utf8'))}</style>\n`)
  .replace(/<script type="module" src.*\n/, () => inlined));
