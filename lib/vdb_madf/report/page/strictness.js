// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// The slider for the strictness, below a line that says how many grains there are at each.
import { element } from './decode.js';
import { counted, make, makeSvg, written } from './sample.js';

const kSteps = 10;  // to 1

/// Nothing, where the page has no levels.
export function startStrictness(sample, selection) {
  const { levels } = sample;
  if (!levels) return;
  const slider = make('input', { id: 'strictness', type: 'range', step: 1, min: Math.ceil(kSteps * levels.lowest - 1e-9),
    max: Math.floor(kSteps * levels.highest + 1e-9) });
  const value = make('output', { htmlFor: 'strictness' });
  const back = make('button', { type: 'button', onclick: () => selection.setStrictness(null) }, 'As in the labels');
  const note = make('p', { className: 'hint' });
  const { svg, mark } = curve(levels, Number(slider.min), Number(slider.max));
  slider.addEventListener('input', () => {
    const strictness = Number(slider.value) / kSteps;
    selection.setStrictness(strictness === levels.own ? null : strictness);
  });
  const draw = () => {
    const strictness = selection.strictness === null ? levels.own : selection.strictness;
    slider.value = kSteps * strictness;
    value.textContent = `${written(strictness)}: ${counted(sample.count)} grains`;
    back.disabled = sample.isOwn;
    mark(kSteps * strictness);
    note.textContent = sample.isOwn
      ? 'These are the grains of the labels. To the left grains join, to the right they part.'
      : `These are the grains of: vdb_madf remerge LABELS OUT.vdb --strictness ${strictness} --tidy 0. ` +
        `Bodies and numbers are put together from those at ${written(levels.highest)}; what cannot be put together, such as curvatures, is not known.`;
  };
  selection.listen((what) => { if (what === 'strictness') draw(); });
  element('numbers').after(make('section', { id: 'levels', 'aria-label': 'Strictness' },
    make('label', { htmlFor: 'strictness', title: `From ${written(levels.lowest)} to ${written(levels.highest)}` }, 'Strictness ', value), make('div', { className: 'track' }, svg, slider),
    back, note));
  draw();
}

/// Grains at each step of the slider, on a logarithmic scale, and a line to mark one.
function curve(levels, first, last) {
  const counts = Array.from({ length: last - first + 1 }, (_, i) => Math.log(1 + levels.grainsAt((first + i) / kSteps).count));
  const low = Math.min(...counts), high = Math.max(...counts);
  const points = counts.map((count, i) => `${i},${(28 - 26 * (count - low) / (high - low || 1)).toFixed(2)}`);
  const line = makeSvg('line', { y1: 0, y2: 30 });
  const svg = makeSvg('svg', { viewBox: `0 0 ${Math.max(1, last - first)} 30`, preserveAspectRatio: 'none', 'aria-hidden': true },
    makeSvg('polyline', { points: points.join(' ') }), line);
  return { svg, mark: (step) => ['x1', 'x2'].forEach((end) => line.setAttribute(end, step - first)) };
}
