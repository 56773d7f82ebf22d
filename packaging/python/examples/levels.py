"""Meshes a picture of its own with more and more vertices, and draws them side by side with their edges.

usage: levels.py OUT.png
"""

import sys

import hmesh
import numpy as np
from PIL import Image, ImageDraw

# A scene of soft light and hard edges, (height, width, 3) of 0 to 255.
y, x = np.mgrid[0:240, 0:320].astype(float)
sky = np.stack([90 + y * 0.5, 140 + y * 0.3, 230 - y * 0.2], -1)
hills = y > 150 + 20 * np.sin(x / 40) + 8 * np.sin(x / 13)
sky[hills] = np.stack([60 + 40 * np.sin(x / 60), 120 - (y - 150) * 0.4, 50 + 0 * x], -1)[hills]
sun = (x - 230) ** 2 + (y - 70) ** 2
sky += np.where(sun < 900, 1.0, 0.6 * np.exp(-sun / 4000))[..., np.newaxis] * np.array([160, 120, 10])
image = np.clip(sky, 0, 255).astype(np.uint8)

panels = []
for vertices in (40, 120, 400):
    mesh = hmesh.mesh_image(image, vertices=vertices)
    print(f"{vertices:5} vertices: {mesh.report.psnr:.2f} dB, compact file of {len(mesh.tobytes('hmc'))} bytes")
    # Drawn twice as large as the image, and the upper half with edges.
    panel = Image.fromarray(mesh.render(640, 480, dtype=np.uint8))
    draw = ImageDraw.Draw(panel)
    corners = mesh.positions[mesh.faces]
    for a, b, c in corners[corners[:, :, 1].max(axis=1) < 120] * 2:
        draw.line([*a, *b, *c, *a], fill=(255, 255, 255))
    panels.append(panel.resize((320, 240), Image.LANCZOS))

sheet = Image.new("RGB", (320 * len(panels), 240))
for k, panel in enumerate(panels):
    sheet.paste(panel, (320 * k, 0))
sheet.save(sys.argv[1])
