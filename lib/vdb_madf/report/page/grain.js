// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// The card of what is selected: its numbers, its bonds, what to do with it.
import { element } from './decode.js';
import { counted, make, written } from './sample.js';
import { onlySwitch } from './tables.js';

const shown = ['equivalent_diameter', 'voxels', 'coordination', 'inscribed_radius', 'sphericity',
  'axis1_length', 'axis2_length', 'axis3_length', 'free_area', 'shared_area'];

export function startGrain(sample, selection) {
  const card = element('grain');
  const only = onlySwitch(selection);
  const draw = () => {
    const diameters = sample.grains.column('equivalent_diameter');
    const bySize = Array.from(diameters.keys()).sort((a, b) => diameters[b] - diameters[a] || a - b);
    const rows = [...selection.selected];
    card.replaceChildren(make('h2', {}, 'Grain'), finder(sample, selection, bySize, only));
    if (rows.length === 0) {
      card.append(make('p', { className: 'hint' }, 'Click a grain in the view, in a slice or in the table.'));
    } else if (rows.length === 1) {
      card.append(...describe(sample, selection, rows[0]));
    } else {
      card.append(make('p', {}, `${rows.length} grains: `, ...links(sample, selection, rows)));
    }
  };
  selection.listen((what) => { if (['selection', 'filter', 'strictness', 'edits'].includes(what)) draw(); });
  draw();
}

/// By number, the largest, and the next ones by size.
function finder(sample, selection, bySize, only) {
  const field = make('input', { type: 'number', min: 1, id: 'find', placeholder: 'number' });
  field.addEventListener('change', () => {
    const row = sample.rowOf.get(Number(field.value));
    field.classList.toggle('wrong', row === undefined && field.value !== '');
    if (row !== undefined) selection.select([row]);
  });
  const [row] = [...selection.selected].slice(-1);
  if (row !== undefined) field.value = sample.ids[row];
  const candidates = () => bySize.filter((one) => selection.visible[one]);
  const step = (by) => {
    const list = candidates();
    const place = list.indexOf(row);
    const next = list[place < 0 ? 0 : Math.max(0, Math.min(list.length - 1, place + by))];
    if (next !== undefined) selection.select([next]);
  };
  const button = (title, act) => make('button', { type: 'button', onclick: act }, title);
  return make('div', { className: 'bar' }, make('label', {}, 'Number ', field),
    button('Largest', () => { const [first] = candidates(); if (first !== undefined) selection.select([first]); }),
    button('Next smaller', () => step(1)), button('Next larger', () => step(-1)),
    button('None (Esc)', () => selection.select([])), only);
}

function describe(sample, selection, row) {
  const list = make('dl');
  for (const name of shown) {
    const unit = sample.unit(sample.columnOf('grains', name).power);
    list.append(make('dt', {}, sample.titleOf(name)),
      make('dd', {}, `${written(sample.grains.column(name)[row])} ${unit}`));
  }
  return [make('h3', {}, `Grain ${sample.ids[row]}${sample.isCut(row) ? ', cut by a face of the scan' : ''}`),
    ...partList(sample, selection, row), list, ...bondList(sample, selection, row)];
}

/// What it was made of, to see and to part.
function partList(sample, selection, row) {
  const { parts } = selection;
  if (!parts) return [];
  const show = make('input', { type: 'checkbox', id: 'parts', checked: selection.showsParts });
  show.addEventListener('change', () => {
    selection.showsParts = show.checked;
    selection.changed('looks');
  });
  const split = make('button', { type: 'button', disabled: !selection.mayEdit,
    onclick: () => selection.addEdits(`split ${sample.ids[row]}`) }, 'Split it so');
  return [make('p', {}, `Two parts, of ${parts.parts.map((part) => counted(part.voxels)).join(' and ')} voxels, ` +
    `are one up to the strictness ${written(parts.strictness)}.`),
  make('div', { className: 'bar' }, make('label', {}, show, ' show them'), split)];
}

function bondList(sample, selection, row) {
  const bonds = sample.bondsOf[row];
  if (bonds.length === 0) return [make('p', {}, 'It has no bonds.')];
  const { first, second } = sample.bondEnds;
  const area = sample.bonds.column('area'), radius = sample.bonds.column('radius');
  const body = make('tbody');
  for (const bond of [...bonds].sort((a, b) => area[b] - area[a])) {
    const other = first[bond] === row ? second[bond] : first[bond];
    body.append(make('tr', {}, make('td', {}, ...links(sample, selection, [other])),
      make('td', {}, written(area[bond])), make('td', {}, written(radius[bond]))));
  }
  return [make('h3', {}, `Its ${bonds.length === 1 ? 'bond' : `${bonds.length} bonds`}`),
    make('div', { className: 'short' }, make('table', { className: 'table' },
      make('thead', {}, make('tr', {}, make('th', { scope: 'col' }, 'with grain'),
        make('th', { scope: 'col' }, sample.titleWithUnit('bonds', 'area')),
        make('th', { scope: 'col' }, sample.titleWithUnit('bonds', 'radius')))), body))];
}

function links(sample, selection, rows) {
  return rows.flatMap((row) => [make('button', { type: 'button', className: 'link',
    onclick: () => selection.select([row]) }, String(sample.ids[row])), ' ']);
}
