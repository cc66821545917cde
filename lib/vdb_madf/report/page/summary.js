// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// What stands at the top: where the sample comes from, its numbers, and what to be wary of.
import { element } from './decode.js';
import { counted, make, written } from './sample.js';

const kDustVoxels = 100;  // as in the summaries of the command

function percent(share) {
  return `${written(100 * share, 3)} %`;
}

export function originOf(sample) {
  const { numbers } = sample;
  const size = numbers.box_max.map((high, i) => high - numbers.box_min[i] + 1);
  const edges = sample.edges.map((edge) => sample.length(edge));
  const cubes = new Set(edges).size === 1;
  const voxel = sample.shownUnit === 'voxel' && sample.about.voxelSizeKnown ? 'lengths are in voxels' : sample.about.voxelSizeKnown
    ? `voxels of ${cubes ? edges[0] : edges.join(' \u00d7 ')}`
    : 'voxels of unknown size: lengths are in voxels';
  const made = ['merge', 'strictness', 'gamma', 'theta', 'delta'].filter((key) => key in numbers.segmentation)
    .map((key) => `${key} ${numbers.segmentation[key]}`).join(', ');
  return [numbers.labels, `${size.join(' \u00d7 ')} voxels`, voxel, made].filter(Boolean).join('; ');
}

/// Titles and values of the numbers of a sample, or of its grains and bonds whose flags are set.
export function tiles(sample, visible = new Uint8Array(sample.count).fill(1),
  passingBonds = new Uint8Array(sample.bonds.rows).fill(1)) {
  const numbers = sample.summary(visible, passingBonds);
  const result = [
    ['Grains', counted(numbers.grains)],
    ['Bonds', counted(numbers.bonds)],
    ['Bonds a grain', written(numbers.coordination, 3)],
    ['Solid fraction', percent(numbers.solidFraction)],
    ['Median diameter, by volume', sample.length(numbers.diameterByVolume, 3)],
    ['Median diameter, by number', sample.length(numbers.diameterByNumber, 3)],
    ['Specific surface', `${written(numbers.surface, 3)} ${sample.unit(-1)}`],
    ['Bond radius / grain radius', written(numbers.ratio, 3)],
  ];
  if ('specific_surface_m2_per_kg' in sample.numbers)
    result.push(['Specific surface, by mass', `${written(numbers.surfaceOfMass, 3)} m\u00b2/kg`]);
  if ('bulk_density_kg_per_m3' in sample.numbers)
    result.push(['Density', `${written(numbers.density, 3)} kg/m\u00b3`]);
  const across = (name) => ['x', 'y', 'z'].map((axis) => written(100 * (sample.numbers[`${name}_${axis}`] ?? NaN), 3)).join(', ');
  if ('bond_conductivity_x' in sample.numbers)
    result.push(['Bonds conduct along x, y, z, % of the full box', across('bond_conductivity')],
      ['Minimum cut across x, y, z, % of the section', across('minimum_cut_share')]);
  return result;
}

function drawTiles(sample, selection) {
  const all = selection.filterCount > 0 ? tiles(sample) : [];
  element('numbers').replaceChildren(...tiles(sample, selection.visible, selection.passingBonds).map(([title, value], i) => {
    const whole = make('small', {}, all.length > 0 ? `of all ${all[i][1]}` : '');
    return make('div', { className: 'tile' }, make('b', {}, value, whole), make('span', {}, title));
  }));
}

export function warnings(sample) {
  const { grains, numbers, about } = sample;
  const voxels = grains.column('voxels'), atFace = grains.column('at_domain_face');
  const sum = (test) => voxels.reduce((total, value, row) => total + (test(row) ? value : 0), 0);
  const count = (test) => voxels.reduce((total, _, row) => total + (test(row) ? 1 : 0), 0);
  const all = sum(() => true);
  const found = [];
  const say = (test, text) => {
    const rows = count(test);
    if (rows > 0)
      found.push(`${counted(rows)} of ${counted(grains.rows)} grains (${percent(sum(test) / all)} of their volume) ${text}`);
  };
  if (grains.rows === 0) found.push('There are no grains.');
  if (grains.rows === 1) found.push('There is one grain alone: if this is a mask, segment it first.');
  if (!about.voxelSizeKnown) found.push('The voxel size is not known: all lengths are in voxels.');
  if (numbers.box === 'grains') found.push('The domain is not known: fractions refer to the box of the grains.');
  if (numbers.boundary === 'open')
    say((row) => atFace[row], 'are cut by the faces of the scan: their sizes and shapes are those of what is left.');
  say((row) => voxels[row] < kDustVoxels, `are dust, of fewer than ${kDustVoxels} voxels.`);
  if (numbers.bonds_without_curvature > 0)
    found.push(`${counted(numbers.bonds_without_curvature)} of ${counted(numbers.bonds)} bonds have so few voxel faces that no curvature can be fitted.`);
  if (!sample.isOwn && Object.keys(sample.own.numbers.expected_bias_percent || {}).length > 0)
    found.push('How far numbers are off because grains are small is said of the grains of the labels alone.');
  const biases = Object.entries(numbers.expected_bias_percent || {}).map(([name, bias]) =>
    `${name.replace('_', ' ')} ${bias > 0 ? '+' : '\u2212'}${Math.abs(bias)} %`);
  if (biases.length > 0)
    found.push(`Grains or bonds are so small that numbers are off, as far as packs of balls tell, by about: ${biases.join(', ')}.`);
  return found;
}

export function startSummary(sample, selection) {
  const draw = () => {
    element('origin').textContent = originOf(sample);
    drawTiles(sample, selection);
    const list = warnings(sample);
    element('warnings').replaceChildren(
      ...(list.length > 0 ? [make('ul', {}, ...list.map((text) => make('li', {}, text)))] : []));
  };
  selection.listen((what) => {
    if (what === 'strictness') draw();
    if (what === 'filter') drawTiles(sample, selection);
  });
  draw();
  // What lies below must not move away under the slider for the strictness.
  if (sample.levels) element('warnings').style.minHeight = `${element('warnings').offsetHeight}px`;
  tellMaker(sample.about.version, [sample.numbers.labels_digest]);
}

export function tellMaker(version, digests) {
  element('made').textContent = `Written by vdb_madf ${version}. Labels: ${digests.join(', ')}. ` +
    'This file asks for nothing from the network.';
}
