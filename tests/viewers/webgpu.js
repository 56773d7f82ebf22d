// webgpu.js - what WebGPU draws of every layout of pack_for_gpu(): node webgpu.js LAYOUTS.json LEAST
//
// LAYOUTS.json is what gpu_layouts.hpp writes. Each layout is drawn in Chromium as docs/textures.md says, and compared with
// render()'s picture of 8 bits. Prints a line for each layout and the least PSNR, 10 log10(255^2 / MSE) over pixels and channels.
// Exit status 1 where one is below LEAST dB or WebGPU finds fault; 77 where the browser has none. needs_chromium.sh says what it
// needs.
'use strict';
const { chromium } = require('playwright-core');
const { readFileSync } = require('fs');

const shader = `
struct Layout { scale: vec2f, offset: vec2f, size: vec2f, gray: f32 }
@group(0) @binding(0) var<uniform> l: Layout;
struct Shade { @builtin(position) at: vec4f, @location(0) color: vec4f }
@vertex fn vertex(@location(0) position: vec2f, @location(1) color: vec4f) -> Shade {
    let at = (l.offset + l.scale * position) / l.size;
    return Shade(vec4f(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, 0.0, 1.0), select(color, color.rrrg, l.gray > 0.0));
}
@fragment fn fragment(shade: Shade) -> @location(0) vec4f { return shade.color; }`;

// In the page: the PSNR of each layout, or a word in place of all.
async function draw({ pictures, layouts, shader }) {
  const adapter = await navigator.gpu?.requestAdapter();
  if (!adapter) return 'none';
  const device = await adapter.requestDevice();
  const faults = [];
  device.onuncapturederror = ({ error }) => faults.push(error.message);
  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const references = pictures.map(bytes);
  const module = device.createShaderModule({ code: shader });
  const buffer = (data, usage) => {
    const out = device.createBuffer({ size: data.byteLength, usage: usage | GPUBufferUsage.COPY_DST });
    device.queue.writeBuffer(out, 0, data);
    return out;
  };
  const psnrs = [];
  for (const layout of layouts) {
    const [width, height] = layout.size, isStrip = layout.topology === 'triangle-strip', isGray = layout.color.format.endsWith('2');
    const pipeline = device.createRenderPipeline({
      layout: 'auto',
      vertex: { module, entryPoint: 'vertex', buffers: [{ arrayStride: layout.stride, attributes: [
        { shaderLocation: 0, format: layout.position.format, offset: layout.position.offset },
        { shaderLocation: 1, format: layout.color.format, offset: layout.color.offset }] }] },
      fragment: { module, entryPoint: 'fragment', targets: [{ format: 'rgba8unorm' }] },
      primitive: { topology: layout.topology, frontFace: 'cw', cullMode: 'back',
        ...(isStrip ? { stripIndexFormat: layout.index } : {}) },
    });
    const numbers = new Float32Array([...layout.scale, ...layout.offset, ...layout.size, isGray ? 1 : 0, 0]);
    const group = device.createBindGroup({ layout: pipeline.getBindGroupLayout(0),
      entries: [{ binding: 0, resource: { buffer: buffer(numbers, GPUBufferUsage.UNIFORM) } }] });
    const target = device.createTexture({ size: [width, height], format: 'rgba8unorm',
      usage: GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC });
    const row = Math.ceil(4 * width / 256) * 256;
    const read = device.createBuffer({ size: row * height, usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ });
    const commands = device.createCommandEncoder();
    const pass = commands.beginRenderPass({ colorAttachments: [
      { view: target.createView(), loadOp: 'clear', clearValue: [0, 0, 0, 0], storeOp: 'store' }] });
    pass.setPipeline(pipeline);
    pass.setBindGroup(0, group);
    pass.setVertexBuffer(0, buffer(bytes(layout.vertices), GPUBufferUsage.VERTEX));
    pass.setIndexBuffer(buffer(bytes(layout.indices), GPUBufferUsage.INDEX), layout.index);
    for (const [count, firstIndex, firstVertex] of layout.chunks) pass.drawIndexed(count, 1, firstIndex, firstVertex);
    pass.end();
    commands.copyTextureToBuffer({ texture: target }, { buffer: read, bytesPerRow: row }, [width, height]);
    device.queue.submit([commands.finish()]);
    await read.mapAsync(GPUMapMode.READ);
    const drawn = new Uint8Array(read.getMappedRange()), reference = references[isGray ? 1 : 0];
    let squares = 0;
    for (let y = 0; y < height; ++y)
      for (let i = 0; i < 4 * width; ++i) squares += (drawn[y * row + i] - reference[4 * width * y + i]) ** 2;
    psnrs.push(10 * Math.log10(255 ** 2 * 4 * width * height / squares));
    read.unmap();
  }
  return faults.length > 0 ? faults.join('\n') : psnrs;
}

async function main([file, least]) {
  if (!least) throw new Error('usage: webgpu.js LAYOUTS.json LEAST');
  const data = JSON.parse(readFileSync(file, 'utf8'));
  const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM || '/usr/bin/chromium',
    args: ['--no-sandbox', '--enable-unsafe-webgpu', '--enable-features=Vulkan', '--use-vulkan=swiftshader',
      '--use-webgpu-adapter=swiftshader'],
  });
  try {
    const page = await browser.newPage();
    await page.route('**/*', (route) => route.fulfill({ contentType: 'text/html', body: '<!doctype html>' }));
    await page.goto('https://localhost/');  // a secure context, which WebGPU asks for; nothing is fetched
    const psnrs = await page.evaluate(draw, { ...data, shader });
    if (psnrs === 'none') {
      console.log('skipped: the browser has no WebGPU');
      return 77;
    }
    if (typeof psnrs === 'string') throw new Error(psnrs);
    if (psnrs.length === 0) throw new Error('there is no layout');
    data.layouts.forEach((layout, i) => console.log(
      `${layout.position.format} ${layout.color.format} ${layout.topology} ${layout.index}, ` +
      `${layout.chunks.length} chunks: ${psnrs[i].toFixed(2)} dB`));
    const worst = Math.min(...psnrs);
    console.log(`${psnrs.length} layouts, at least ${worst.toFixed(2)} dB (${least} wanted)`);
    return worst >= Number(least) ? 0 : 1;
  } finally {
    await browser.close();
  }
}

main(process.argv.slice(2)).then((status) => process.exit(status), (error) => {
  console.error(String(error.message || error));
  process.exit(1);
});
