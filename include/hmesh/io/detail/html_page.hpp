// hmesh - the markup and the style of write_html()'s page, in the order in which they are written.
//
// A dark page that is all canvas; the title and the figures in the lower left corner, the controls in the upper right one.
// The scripts of html_drawing.hpp and html_handling.hpp follow.
#ifndef HMESH_IO_DETAIL_HTML_PAGE_HPP
#define HMESH_IO_DETAIL_HTML_PAGE_HPP

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

// Then the title.
inline constexpr const char* html_head = R"html(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="dark">
<meta http-equiv="Content-Security-Policy"
  content="default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:">
<title>)html";

// Then the title again.
inline constexpr const char* html_style = R"html(</title>
<style>
html, body { margin: 0; height: 100%; overflow: hidden; background: #1b1b1d; color: #e8e8ea;
  font: 14px/1.45 system-ui, sans-serif; }
canvas { position: fixed; inset: 0; width: 100%; height: 100%; touch-action: none; cursor: grab; outline: none; }
canvas.drag { cursor: grabbing; }
canvas:focus-visible { box-shadow: inset 0 0 0 2px #7ab7ff; }
.panel { position: fixed; box-sizing: border-box; max-width: calc(100vw - 24px); padding: 8px 12px; border-radius: 8px;
  background: rgba(20, 20, 22, .72);
  backdrop-filter: blur(6px); }
#about { left: 12px; bottom: 12px; max-width: min(28em, 80vw); pointer-events: none; }
h1 { margin: 0; font-size: 1em; font-weight: 600; overflow-wrap: anywhere; }
#figures { margin: 0; color: #b8b8bd; white-space: pre-line; font-variant-numeric: tabular-nums; }
#figures:empty { display: none; }
#controls { right: 12px; top: 12px; display: flex; flex-wrap: wrap; align-items: center; gap: 4px; padding: 4px; }
button { min-width: 2.4em; height: 2.4em; padding: 0 .7em; border: 0; border-radius: 6px; background: none; color: inherit;
  font: inherit; cursor: pointer; }
button:hover { background: rgba(255, 255, 255, .1); }
button[aria-pressed=true] { background: #e8e8ea; color: #1b1b1d; }
button:focus-visible, input:focus-visible { outline: 2px solid #7ab7ff; outline-offset: 1px; }
label { display: flex; align-items: center; gap: 6px; padding: 0 .7em; color: #b8b8bd; }
input { width: 9em; accent-color: #e8e8ea; }
#without { display: grid; place-items: center; height: 100%; margin: 0 2em; text-align: center; }
[hidden], .native .panel { display: none !important; }
</style>
</head>
<body>
<canvas id="mesh" tabindex="0" role="img"></canvas>
<p id="without" hidden>This browser does not offer WebGL, so the mesh cannot be drawn here.</p>
<noscript><p class="panel">The mesh is drawn by a script, and scripts are turned off.</p></noscript>
<div class="panel" id="about">
<h1>)html";

// Then the figures.
inline constexpr const char* html_figures = R"html(</h1>
<p id="figures">)html";

// Then the original, if there is one, and the mesh.
inline constexpr const char* html_controls = R"html(</p>
</div>
<div class="panel" id="controls" role="toolbar" aria-label="View">
<button id="in" title="Zoom in (+)" aria-label="Zoom in">+</button>
<button id="out" title="Zoom out (-)" aria-label="Zoom out">&minus;</button>
<button id="fit" title="Fit the window (0)">Fit</button>
<button id="one" title="One pixel to one of the screen (1)" aria-label="Native size">1:1</button>
<button id="wires" title="Wireframe (w)" aria-pressed="false">Wireframe</button>
<label id="compare" title="Original (o)" hidden>Original
  <input id="share" type="range" min="0" max="1" step="any" value="0"></label>
</div>
)html";

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_DETAIL_HTML_PAGE_HPP
