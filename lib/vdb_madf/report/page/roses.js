// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// Directions: how much of the weight each sector has, over what it had if no direction were preferred.
import { shareDoubts } from './bins.js';
import { lineColors, makeSvg, written } from './sample.js';
import { figureOf } from './save.js';

const kFullSectors = 18;  // of half a turn
const kQuarterSectors = 9;  // of a quarter turn
const middle = 105, unit = 45, most = 84;

class Rose {
  constructor(sample, selection, title, kind, name, weight, sectors, corners) {
    Object.assign(this, { sample, kind, name, weight, sectors, corners });
    this.load();
    this.flags = () => (kind === 'grains' ? selection.visible : selection.visibleBonds);
    this.svg = makeSvg('svg', { viewBox: '-6 4 222 202', role: 'img', 'aria-label': title, class: 'rose' });
    this.figure = figureOf(title, this.svg);
  }

  /// Takes the numbers of the sample as it is now.
  load() {
    const { sample, kind, name, weight } = this;
    this.directions = ['x', 'y', 'z'].map((axis) => sample[kind].column(`${name}_${axis}`));
    this.weights = sample[kind].column(weight);
  }

  draw() {
    const { shares, doubts, starts, step } = this.sectors(this.directions, this.weights, this.flags());
    const highest = Math.max(1, ...shares.map((share, i) => share + doubts[i]));
    const scale = Math.min(unit, most / highest);
    const at = (radius, angle) => `${(middle + radius * Math.cos(angle)).toFixed(2)} ${(middle - radius * Math.sin(angle)).toFixed(2)}`;
    this.svg.replaceChildren();
    shares.forEach((share, i) => {
      const radius = share * scale, begin = starts[i];
      if (radius > 0)
        this.svg.append(makeSvg('path', { class: 'shown',
          d: `M${middle} ${middle}L${at(radius, begin)}A${radius} ${radius} 0 0 0 ${at(radius, begin + step)}Z` }));
    });
    shares.forEach((share, i) => {
      const angle = starts[i] + step / 2;
      if (share > 0)
        this.svg.append(makeSvg('path', { class: 'whisker',
          d: `M${at(Math.max(0, share - doubts[i]) * scale, angle)}L${at((share + doubts[i]) * scale, angle)}` }));
    });
    this.svg.append(makeSvg('circle', { cx: middle, cy: middle, r: scale, class: 'class' }));
    for (const [name, angle] of this.corners)
      this.svg.append(makeSvg('text', { x: middle + 97 * Math.cos(angle), y: middle - 97 * Math.sin(angle) + 4,
        'text-anchor': 'middle' }, name));
  }
}

/// Azimuths of axial directions in the x-y plane, each with its weight times its shadow's length there.
function azimuths([x, y], weights, flags) {
  const step = Math.PI / kFullSectors, sums = new Array(kFullSectors).fill(0), squares = [...sums];
  let total = 0;
  for (let row = 0; row < weights.length; ++row) {
    const share = flags[row] ? weights[row] * Math.hypot(x[row], y[row]) : 0;
    if (!(share > 0)) continue;
    const angle = (Math.atan2(y[row], x[row]) + 2 * Math.PI) % Math.PI;
    const sector = Math.floor(angle / step + 0.5) % kFullSectors;
    sums[sector] += share;
    squares[sector] += share * share;
    total += share;
  }
  const shares = sums.map((sum) => (total ? sum * kFullSectors / total : 0));
  const doubts = shareDoubts(sums, squares).map((doubt) => doubt * kFullSectors);
  return { shares: [...shares, ...shares], doubts: [...doubts, ...doubts], step,
    starts: Array.from({ length: 2 * kFullSectors }, (_, i) => step * (i - 0.5)) };
}

/// Angles to z, upward in the picture; four times the same.
function rises([x, y, z], weights, flags) {
  const step = Math.PI / 2 / kQuarterSectors, sums = new Array(kQuarterSectors).fill(0), squares = [...sums];
  for (let row = 0; row < weights.length; ++row) {
    if (!flags[row] || Number.isNaN(x[row])) continue;
    const angle = Math.atan2(Math.hypot(x[row], y[row]), Math.abs(z[row]));
    const sector = Math.min(kQuarterSectors - 1, Math.floor(angle / step));
    sums[sector] += weights[row];
    squares[sector] += weights[row] ** 2;
  }
  const total = sums.reduce((a, b) => a + b, 0);
  const whole = (quarter) => {
    const even = quarter.map((value, i) => value / (Math.cos(i * step) - Math.cos((i + 1) * step)));
    const half = [...even, ...even.slice().reverse()];
    return [...half, ...half];
  };
  return { shares: whole(sums.map((sum) => (total ? sum / total : 0))), doubts: whole(shareDoubts(sums, squares)), step,
    starts: Array.from({ length: 4 * kQuarterSectors }, (_, i) => Math.PI / 2 - step * (i + 1)) };
}

export function fullRose(sample, selection, title, kind, name, weight) {
  return new Rose(sample, selection, title, kind, name, weight, azimuths,
    [['x', 0], ['y', Math.PI / 2]]);
}

export function quarterRose(sample, selection, title, kind, name, weight) {
  return new Rose(sample, selection, title, kind, name, weight, rises,
    [['z', Math.PI / 2], ['90\u00b0', 0]]);
}

/// What a symmetric tensor has along each direction of the three planes, in percent; the circle is its mean.
export function tensorRose(title, tensor) {
  const names = ['x', 'y', 'z'], planes = [[0, 1], [0, 2], [1, 2]];
  const mean = (tensor[0][0] + tensor[1][1] + tensor[2][2]) / 3;
  const along = ([i, j], angle) => {
    const c = Math.cos(angle), s = Math.sin(angle);
    return c * c * tensor[i][i] + 2 * c * s * tensor[i][j] + s * s * tensor[j][j];
  };
  const angles = Array.from({ length: 121 }, (_, i) => i * Math.PI / 60);
  const highest = Math.max(mean, ...planes.flatMap((plane) => angles.map((angle) => along(plane, angle))));
  const scale = highest > 0 ? most / highest : 0;
  const svg = makeSvg('svg', { viewBox: '-6 4 222 202', role: 'img', 'aria-label': title, class: 'rose' });
  svg.append(makeSvg('circle', { cx: middle, cy: middle, r: mean * scale, class: 'class' }));
  planes.forEach((plane, k) => {
    const places = angles.map((angle) => {
      const radius = along(plane, angle) * scale;
      return `${(middle + radius * Math.cos(angle)).toFixed(2)} ${(middle - radius * Math.sin(angle)).toFixed(2)}`;
    });
    svg.append(makeSvg('path', { class: 'steps', style: `stroke: ${lineColors[k]}; stroke-width: 1.6`, d: `M${places.join('L')}` }),
      makeSvg('text', { x: -2, y: 16 + 12 * k, style: `fill: ${lineColors[k]}` },
        `${names[plane[0]]} \u2192, ${names[plane[1]]} \u2191`));
  });
  svg.append(makeSvg('text', { x: middle, y: 202, 'text-anchor': 'middle' }, `circle: ${written(100 * mean, 3)} %`));
  return figureOf(title, svg);
}
