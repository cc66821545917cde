// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// Colors: of the labels, or by a number from dark blue over green to yellow.

const stops = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141],
  [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37]];
export const unknownColor = [150, 150, 150];
const bondColor = [199, 33, 28];
export const selectedColor = [255, 196, 0], secondColor = [255, 110, 30];

/// Of a share from 0 to 1.
export function ramp(share) {
  const place = Math.max(0, Math.min(1, share)) * (stops.length - 1);
  const below = Math.min(stops.length - 2, Math.floor(place));
  return stops[below].map((value, i) =>
    Math.round(value + (place - below) * (stops[below + 1][i] - value)));
}

/// A grain that is the same this much farther is as sure as any.
const ranges = { __proto__: null, stability: [0, 1] };

/// What the ramp spans: the values without the outermost 1 % at either end.
export function rangeOf(table, name) {
  if (ranges[name]) return ranges[name];
  const values = table.column(name);
  const sorted = values.filter((value) => !Number.isNaN(value)).sort();
  if (sorted.length === 0) return [0, 1];
  const at = (share) => sorted[Math.round(share * (sorted.length - 1))];
  const low = at(0.01), high = at(0.99);
  return [low, high];
}

/// Three bytes a grain. Each has the color of its largest leaf in the labels, unless a larger one
/// beside it has that: then the next one of the palette that is free.
export function colorsOfUnions({ count, grains, bondsOf, bondEnds, rowOfBody, levels, own }) {
  const palette = [], indexOf = new Map();
  const indexOfColor = (color) => {
    const key = String(color);
    if (!indexOf.has(key)) indexOf.set(key, palette.push(color) - 1);
    return indexOf.get(key);
  };
  levels.palette.forEach(indexOfColor);
  const preferred = new Array(count), largest = new Float64Array(count);
  rowOfBody.forEach((row, body) => {
    if (levels.leaf.voxels[body] <= largest[row]) return;
    largest[row] = levels.leaf.voxels[body];
    const ownRow = own.rowOfBody[body];
    preferred[row] = indexOfColor(Array.from(own.colors.subarray(3 * ownRow, 3 * ownRow + 3)));
  });
  const voxels = grains.column('voxels'), chosen = new Int32Array(count).fill(-1);
  const colors = new Uint8Array(3 * count);
  for (const row of Array.from(voxels.keys()).sort((a, b) => voxels[b] - voxels[a] || a - b)) {
    const taken = new Set(bondsOf[row].map((bond) =>
      chosen[bondEnds.first[bond] === row ? bondEnds.second[bond] : bondEnds.first[bond]]));
    let color = preferred[row];
    for (let i = 0; i < palette.length && taken.has(color); ++i) color = (color + 1) % palette.length;
    chosen[row] = color;
    colors.set(palette[chosen[row]], 3 * row);
  }
  return colors;
}

/// Three bytes a grain, or a bond, by a column or without one.
export function colorsOf(sample, kind, name) {
  if (!name && kind === 'grains') return sample.colors;
  const table = sample[kind];
  const values = name && table.column(name);
  const [low, high] = name ? rangeOf(table, name) : [];
  const colors = new Uint8Array(3 * table.rows);
  for (let row = 0; row < table.rows; ++row)
    colors.set(!name ? bondColor : Number.isNaN(values[row]) ? unknownColor
      : ramp((values[row] - low) / (high - low || 1)), 3 * row);
  return colors;
}
