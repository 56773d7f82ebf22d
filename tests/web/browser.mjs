// A Chromium and servers of folders for tests; undefined where one of what they need is not there: $CHROMIUM, else
// /usr/bin/chromium, and playwright-core where NODE_PATH finds it.
import { createServer } from 'node:http';
import { existsSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join, normalize } from 'node:path';

const types = { html: 'text/html', js: 'text/javascript', mjs: 'text/javascript', wasm: 'application/wasm', json: 'application/json' };

export async function startBrowser() {
  const executablePath = process.env.CHROMIUM || '/usr/bin/chromium';
  let playwright;
  try {
    playwright = createRequire(import.meta.url)('playwright-core');
  } catch {
    return undefined;
  }
  return existsSync(executablePath) ? playwright.chromium.launch({ executablePath, args: ['--no-sandbox'] }) : undefined;
}

// Serves {'/': folder, ...}; `isolated`: with the headers that let pages share memory with their workers.
export async function serve(folders, isolated = false) {
  const server = createServer((request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, 'http://x').pathname));
    const prefix = Object.keys(folders).sort((a, b) => b.length - a.length).find((one) => path.startsWith(one));
    const file = join(folders[prefix], path.slice(prefix.length) || 'index.html');
    if (path === '/' && !existsSync(file)) {
      response.writeHead(200, { 'content-type': 'text/html', ...headers });
      return response.end('<!doctype html><link rel="icon" href="data:,">');
    }
    if (!existsSync(file)) return response.writeHead(404).end();
    response.writeHead(200, { 'content-type': types[file.split('.').pop()] ?? 'application/octet-stream', ...headers });
    return response.end(readFileSync(file));
  });
  const headers = isolated ? { 'cross-origin-opener-policy': 'same-origin', 'cross-origin-embedder-policy': 'require-corp' } : {};
  await new Promise((resolve) => { server.listen(0, '127.0.0.1', resolve); });
  return { url: `http://127.0.0.1:${server.address().port}/`, close: () => server.close() };
}

// A page whose errors make the test fail.
export async function openPage(browser, url) {
  const page = await browser.newPage(), faults = [];
  page.on('pageerror', (error) => faults.push(String(error)));
  page.on('console', (message) => { if (message.type() === 'error') faults.push(message.text()); });
  await page.goto(url);
  return { page, faults };
}
