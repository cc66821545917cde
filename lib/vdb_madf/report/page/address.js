// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// The state of the page behind the # of its address: a reload or a link shows the same.
import { element } from './decode.js';
import { parseRange, writeRange } from './tables.js';

const kFilters = { f: 'grains', b: 'bonds' };

function round(value) {
  return Number(value.toPrecision(5));
}

export function writeState(selection, camera) {
  const { sample } = selection;
  const parts = new URLSearchParams();
  const set = (key, value, usual) => { if (String(value) !== String(usual)) parts.set(key, value); };
  set('camera', [camera.azimuth, camera.elevation, camera.zoom, ...camera.target].map(round),
    [camera.view.azimuth, camera.view.elevation, 1, 0, 0, 0]);
  set('theme', selection.theme, null);
  set('unit', selection.unit, sample.usualUnit);
  set('strictness', selection.strictness, null);
  set('scan', selection.scan, 0);
  set('grains', [...[...selection.selected].map((row) => sample.ids[row]), ...selection.absent], '');
  for (const [key, kind] of Object.entries(kFilters))
    for (const [name, range] of selection.filters[kind]) parts.append(key, `${name}=${writeRange(range)}`);
  const { only, onlyRows } = selection;
  if (only) set('only', [...[...onlyRows].map((row) => sample.ids[row]), ...only.absent], '');
  set('inside', selection.insideOnly ? 1 : 0, 0);
  set('color', selection.colorBy, '');
  set('bondcolor', selection.bondColorBy, '');
  set('others', selection.others, 'pale');
  set('bonds', selection.bondsAs, 'none');
  set('explode', selection.explode, 0);
  set('cuts', selection.cuts.map((cut, i) => (selection.flips[i] ? '-' : '') + round(cut)), '1,1,1');
  const { size } = sample.about.slices;
  set('slices', selection.slices, size.map((count) => Math.floor(count / 2)));
  set('show', selection.slicesAs, sample.gray ? 'outlines' : 'grains');
  for (const edit of selection.edits) parts.append('edit', edit);
  if (selection.edits.length > 0 && selection.editsAt !== null) parts.set('editsat', selection.editsAt);
  return parts.toString().replace(/%2C/g, ',').replace(/%3A/g, ':');
}

/// What is wrong or unknown in an address is passed over.
export function readState(parts, selection, camera) {
  const { sample } = selection;
  const numbers = (key, count) => {
    const values = (parts.get(key) || '').split(',').map(Number);
    return parts.get(key) && values.length === count && values.every(Number.isFinite) ? values : null;
  };
  const oneOf = (key, values, usual) => (values.includes(parts.get(key)) ? parts.get(key) : usual);
  const strictness = numbers('strictness', 1);
  if (strictness && sample.levels && strictness[0] >= sample.levels.lowest && strictness[0] <= sample.levels.highest)
    selection.setStrictness(strictness[0]);
  const view = numbers('camera', 6);
  if (view) {
    [camera.azimuth, camera.elevation] = view;
    camera.zoom = 1;
    camera.zoomBy(view[2]);
    camera.target = view.slice(3);
  }
  for (const [key, kind] of Object.entries(kFilters))
    for (const filter of parts.getAll(key)) {
      const [name, range] = filter.split('=');
      if (sample.columnOf(kind, name) && parseRange(range || ''))
        selection.filters[kind].set(name, parseRange(range));
    }
  selection.insideOnly = parts.get('inside') === '1';
  selection.colorBy = oneOf('color', sample.grains.columns.map(({ name }) => name), '');
  selection.bondColorBy = oneOf('bondcolor', sample.bonds.columns.map(({ name }) => name), '');
  selection.others = oneOf('others', ['plain', 'hidden'], 'pale');
  selection.bondsAs = oneOf('bonds', ['discs', 'lines'], 'none');
  selection.explode = Math.max(0, Math.min(1.5, (numbers('explode', 1) || [0])[0]));
  const cuts = (parts.get('cuts') || '').split(',');
  if (cuts.length === 3 && cuts.every((cut) => Math.abs(Number(cut)) <= 1)) {
    selection.cuts = cuts.map((cut) => Math.abs(Number(cut)));
    selection.flips = cuts.map((cut) => cut.startsWith('-'));
  }
  const grainsOf = (key) => {
    const ids = (parts.get(key) || '').split(',').map(Number);
    return { rows: ids.filter((id) => sample.rowOf.has(id)).map((id) => sample.rowOf.get(id)),
      absent: element('scans') ? ids.filter((id) => id > 0 && !sample.rowOf.has(id)) : [] };
  };
  const chosen = grainsOf('grains'), only = grainsOf('only');
  selection.selected = new Set(chosen.rows);
  selection.absent = chosen.absent;
  if (only.rows.length + only.absent.length > 0)
    selection.only = { bodies: selection.bodiesOf(only.rows), absent: only.absent };
  const slices = numbers('slices', 3);
  for (const row of selection.selected) selection.goTo(sample.placeOf('grains', row));
  if (slices)
    selection.slices = slices.map((at, i) =>
      Math.max(0, Math.min(sample.about.slices.size[i] - 1, Math.round(at))));
  if (sample.gray) selection.slicesAs = oneOf('show', ['grains', 'scan'], 'outlines');
  selection.edits = parts.getAll('edit');
  if (sample.levels) selection.editsAt = (numbers('editsat', 1) || [sample.levels.own])[0];
}

/// Keeps the address up to date, not with every step of a drag.
export function followState(selection, camera) {
  let due = 0;
  selection.listen(() => {
    clearTimeout(due);
    due = setTimeout(() => {
      const text = writeState(selection, camera);
      history.replaceState(null, '', text ? `#${text}` : location.pathname + location.search);
    }, 300);
  });
}
