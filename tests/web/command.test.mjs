// The package makes, byte for byte, the files that the native command makes of the same pixels. $HMESH_COMMAND is the command.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { deflateSync } from 'node:zlib';
import { hash, picture } from './pictures.mjs';

const command = process.env.HMESH_COMMAND;
const { Hmesh, compileCompact, load } = await import(new URL('core.node.js', pathToFileURL(`${process.env.HMESH_NPM}/`)));

// RGB where all is opaque, as the package then meshes it, else RGBA.
function pngOf({ data, width, height }) {
  const crc = (bytes) => {
    let value = ~0;
    for (const byte of bytes) {
      value ^= byte;
      for (let k = 0; k < 8; ++k) value = (value >>> 1) ^ (value & 1 ? 0xedb88320 : 0);
    }
    return ~value >>> 0;
  };
  const chunk = (type, bytes) => {
    const body = Buffer.concat([Buffer.from(type), bytes]), out = Buffer.alloc(body.length + 8);
    out.writeUInt32BE(bytes.length);
    body.copy(out, 4);
    out.writeUInt32BE(crc(body), body.length + 4);
    return out;
  };
  const isOpaque = data.every((value, k) => k % 4 < 3 || value === 255), channels = isOpaque ? 3 : 4;
  const samples = data.filter((_, k) => k % 4 < channels);
  const head = Buffer.from([0, 0, 0, 0, 0, 0, 0, 0, 8, isOpaque ? 2 : 6, 0, 0, 0]);
  head.writeUInt32BE(width);
  head.writeUInt32BE(height, 4);
  const rows = Array.from({ length: height }, (_, y) => Buffer.from([0, ...samples.subarray(channels * width * y, channels * width * (y + 1))]));
  return Buffer.concat([Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]), chunk('IHDR', head), chunk('IDAT', deflateSync(Buffer.concat(rows))),
    chunk('IEND', Buffer.alloc(0))]);
}

test('files are those of the native command, byte for byte', { skip: !command && 'HMESH_COMMAND names no command' }, async () => {
  const hmesh = await load(), encoder = new Hmesh(await compileCompact()), folder = mkdtempSync(join(tmpdir(), 'hmesh-web-'));
  try {
    for (const [name, image] of [['rgb', picture(120, 90)], ['rgba', picture(120, 90, { alpha: true })], ['tiles', picture(400, 300)]]) {
      writeFileSync(join(folder, `${name}.png`), pngOf(image));
      for (const effort of ['draft', 'fast', 'normal']) {
        const formats = effort === 'normal' ? ['ply', 'obj', 'glb', 'svg', 'hmc'] : ['ply'];
        execFileSync(command, [`${name}.png`, '--vertices', '700', '--effort', effort, '--seed', '3',
          ...formats.flatMap((format) => ['-o', `${name}.${format}`])], { cwd: folder, stdio: ['ignore', 'ignore', 'inherit'] });
        const mesh = hmesh.meshImage(image, { vertices: 700, effort, seed: 3 });
        for (const format of formats)
          assert.equal(hash(hmesh.write(mesh, format)), hash(readFileSync(join(folder, `${name}.${format}`))), `${name} ${effort} ${format}`);
      }
      execFileSync(command, [`${name}.png`, '--bytes', '900', '--no-table', '--effort', 'fast', '--seed', '3', '-o', 'bytes.hmc'],
        { cwd: folder, stdio: ['ignore', 'ignore', 'inherit'] });
      const { file } = encoder.meshImage(image, { bytes: 900, effort: 'fast', seed: 3 });
      assert.equal(hash(file), hash(readFileSync(join(folder, 'bytes.hmc'))), `${name} in 900 bytes`);
    }
  } finally {
    rmSync(folder, { recursive: true });
  }
});
