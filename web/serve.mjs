// Serves a folder to this machine alone: node web/serve.mjs FOLDER [PORT]. Pages are cross-origin isolated, so that a run of the
// mesher is stopped by a word and not by the end of its worker.
import { createReadStream, existsSync, statSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, normalize, resolve } from 'node:path';

const TYPES = { '.html': 'text/html; charset=utf-8', '.js': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm' };
const [folder = 'build/web', port = '8080'] = process.argv.slice(2);

const server = createServer((request, response) => {
  let path;
  try {
    path = decodeURIComponent(new URL(request.url, 'http://localhost').pathname);
  } catch {
    return response.writeHead(400).end('This is no address.\n');
  }
  const file = join(resolve(folder), normalize(path.endsWith('/') ? `${path}index.html` : path));
  if (!existsSync(file) || !statSync(file).isFile()) return response.writeHead(404).end('There is no such file.\n');
  response.writeHead(200, {
    'Content-Type': TYPES[extname(file)] ?? 'application/octet-stream',
    'Cache-Control': 'no-cache',
    'Cross-Origin-Opener-Policy': 'same-origin',
    'Cross-Origin-Embedder-Policy': 'require-corp',
  });
  createReadStream(file).pipe(response);
});
server.on('error', (error) => {
  console.error(`port ${port}: ${error.message}`);
  process.exit(1);
});
server.listen(Number(port), '127.0.0.1', () => console.log(`http://127.0.0.1:${server.address().port}/`));
