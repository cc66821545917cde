// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// What 'vdb_madf sweep' found for other options: lines against strictness or theta.
import { bytes, element } from './decode.js';
import { Plot } from './plot.js';
import { lineColors, make } from './sample.js';

const plots = [
  { name: 'grains', title: 'Grains', isLog: true },
  { name: 'median_voxels', title: 'Median size (voxels)', isLog: true },
  { name: 'small_grains_share', title: 'Share of small grains' },
];

/// Rows as objects; texts stay texts.
function rowsOf(csv) {
  const lines = csv.trim().split('\n');
  const names = lines[0].split(',');
  return lines.slice(1).map((line) => Object.fromEntries(line.split(',').map((cell, i) => [names[i], cell])));
}

/// Rows of equal options but strictness or theta.
function linesOf(rows) {
  const lines = new Map();
  for (const row of rows) {
    const name = `gamma ${row.gamma}, ${row.merge}` + (row.delta ? `, delta ${row.delta}` : '');
    if (!lines.has(name)) lines.set(name, []);
    lines.get(name).push(row);
  }
  return [...lines].map(([name, its], i) => {
    const axis = its[0].merge === 'score' ? 'strictness' : 'theta';
    return { name, axis, color: lineColors[i % lineColors.length], isDashed: i >= lineColors.length,
      rows: its.sort((a, b) => a[axis] - b[axis]) };
  });
}

function draw(lines, axis, { name, title, isLog }, used) {
  const height = (row) => (isLog ? Math.log10(Number(row[name])) : Number(row[name]));
  const places = lines.map(({ rows }) => rows.map((row) => [Number(row[axis]), height(row)])
    .filter((place) => place.every(Number.isFinite)));
  const all = places.flat();
  if (all.length === 0) return make('span');
  const range = (values, margin) => {
    const low = Math.min(...values), high = Math.max(...values), more = margin * (high - low) || 0.05;
    return [low - more, high + more];
  };
  const y = range(all.map((place) => place[1]), 0.06);
  if (!isLog) y[0] = 0;
  const plot = new Plot(title, axis, '', { x: range(all.map((place) => place[0]), 0.03), y, isLog });
  plot.clear(1);
  plot.upright(used);
  lines.forEach(({ color, isDashed }, i) => plot.line(places[i], color, isDashed));
  return plot.figure;
}

export async function startSweep(sample) {
  const packed = await bytes('sweep');
  if (!packed) return;
  const lines = linesOf(rowsOf(new TextDecoder().decode(packed)));
  element('charts').append(make('h2', {}, 'With other options'),
    make('p', { className: 'hint' }, 'What a sweep found for other strictness, or theta, gamma, delta and ways of merging. Dashed: that of these labels.'),
    make('ul', { className: 'legend' }, ...lines.map(({ name, color, isDashed }) => {
      const line = make('i');
      line.style.borderTop = `4px ${isDashed ? 'dotted' : 'solid'} ${color}`;
      return make('li', {}, line, name);
    })), ...['strictness', 'theta'].filter((axis) => lines.some((line) => line.axis === axis)).map((axis) =>
      make('div', { className: 'panels' }, ...plots.map((spec) =>
        draw(lines.filter((line) => line.axis === axis), axis, spec, Number(sample.numbers.segmentation[axis]))))));
}
