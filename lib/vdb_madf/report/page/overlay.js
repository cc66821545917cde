// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// What is written over the view: axes, a scale bar, a color bar.
import { ramp, rangeOf } from './looks.js';
import { makeSvg, written } from './sample.js';

const axisColors = ['#b3261e', '#1b7f3b', '#1f5fbf'];

function text(x, y, content, anchor = 'start', fill = '#222') {
  return makeSvg('text', { x, y, 'text-anchor': anchor, fill }, content);
}

/// The largest of 1, 2, 5, 10 ... that is at most so long.
export function roundLength(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  return [5, 2, 1].find((factor) => factor * power <= most) * power;
}

export function drawOverlay(svg, scene, sample, selection) {
  const { width, height } = scene;
  svg.replaceChildren();
  svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
  drawAxes(svg, scene.camera.axes(), height);
  drawScale(svg, sample, scene.scale, width, height);
  if (selection.colorBy) drawColorBar(svg, sample, selection.colorBy, width, height);
}

function drawAxes(svg, { right, up }, height) {
  const x = 40, y = height - 40, length = 26;
  ['x', 'y', 'z'].forEach((name, axis) => {
    const dx = right[axis], dy = -up[axis];
    svg.append(makeSvg('line', { x1: x, y1: y, x2: x + length * dx, y2: y + length * dy,
      stroke: axisColors[axis], 'stroke-width': 2 }));
    if (Math.hypot(dx, dy) > 0.2)
      svg.append(text(x + (length + 9) * dx, y + (length + 9) * dy + 4, name, 'middle', axisColors[axis]));
  });
}

function drawScale(svg, sample, scale, width, height) {
  const perUnit = scale / Math.min(...sample.about.edges);
  const length = roundLength(Math.min(150, width / 4) / perUnit);
  const pixels = length * perUnit, x = width - 16 - pixels, y = height - 16;
  svg.append(makeSvg('rect', { x, y, width: pixels, height: 4, fill: '#222' }),
    text(x + pixels / 2, y - 5, sample.length(length), 'middle'));
}

function drawColorBar(svg, sample, name, width, height) {
  const [low, high] = rangeOf(sample.grains.column(name));
  const tall = Math.min(160, height - 130), x = width - 26, y = 42, steps = 32;
  for (let i = 0; i < steps; ++i)
    svg.append(makeSvg('rect', { x, y: y + tall * i / steps, width: 12, height: tall / steps + 0.5,
      fill: `rgb(${ramp(1 - (i + 0.5) / steps)})` }));
  svg.append(text(x + 12, y - 20, sample.titleWithUnit('grains', name), 'end'));
  for (const share of [0, 0.5, 1])
    svg.append(text(x - 5, y + tall * (1 - share) + 4, written(low + share * (high - low), 3), 'end'));
}
