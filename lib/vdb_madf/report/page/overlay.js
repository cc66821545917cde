// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// What is written over the view: axes, a scale bar, a color bar.
import { ramp, rangeOf, unknownColor } from './looks.js';
import { makeSvg, written } from './sample.js';

const axisColors = ['var(--x)', 'var(--y)', 'var(--z)'];

function text(x, y, content, anchor = 'start', fill = 'var(--text)') {
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
  if (selection.colorBy) drawColorBar(svg, sample, 'grains', selection.colorBy, width, height);
  if (selection.bondsAs !== 'none' && selection.bondColorBy)
    drawColorBar(svg, sample, 'bonds', selection.bondColorBy, width, height);
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
  const perUnit = scale / Math.min(...sample.edges);
  const length = roundLength(Math.min(150, width / 4) / perUnit);
  const pixels = length * perUnit, x = width - 16 - pixels, y = height - 16;
  svg.append(makeSvg('rect', { x, y, width: pixels, height: 4, fill: 'var(--text)' }),
    text(x + pixels / 2, y - 5, sample.length(length), 'middle'));
}

/// That of grains on the right, that of bonds on the left.
function drawColorBar(svg, sample, kind, name, width, height) {
  const isRight = kind === 'grains', anchor = isRight ? 'end' : 'start';
  const [low, high] = rangeOf(sample[kind], name);
  const tall = Math.min(160, height - 150), x = isRight ? width - 26 : 14, y = 42, steps = 32;
  const tick = isRight ? x - 5 : x + 17;
  const box = (top, high_, color) => svg.append(makeSvg('rect', { x, y: top, width: 12, height: high_, fill: `rgb(${color})` }));
  for (let i = 0; i < steps; ++i) box(y + tall * i / steps, tall / steps + 0.5, ramp(1 - (i + 0.5) / steps));
  svg.append(text(isRight ? x + 12 : x, y - 20, (isRight ? '' : 'bonds: ') + sample.titleWithUnit(kind, name), anchor));
  for (const share of high > low ? [0, 0.5, 1] : [0])
    svg.append(text(tick, y + tall * (1 - share) + 4, written(low + share * (high - low), 3), anchor));
  if (!sample[kind].column(name).some(Number.isNaN)) return;
  box(y + tall + 12, 12, unknownColor);
  svg.append(text(tick, y + tall + 23, 'none', anchor));
}
