// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// A sample through time: a slider from scan to scan, and how its grains and bonds change. Grains
// have one number in all scans.
import { writeState } from './address.js';
import { element, json } from './decode.js';
import { Plot } from './plot.js';
import { lineColors, make, Sample } from './sample.js';

const ofSample = [['grains', 'Grains'], ['coordination', 'Bonds a grain'],
  ['diameterByVolume', 'Median diameter, by volume', 1], ['surface', 'Specific surface', -1]];
const ofGrain = [['volume', 'Volume'], ['free_area', 'Free area'], ['shared_area', 'Area of its bonds'],
  ['coordination', 'Its bonds']];

function all(sample) {
  return sample.summary(new Uint8Array(sample.count).fill(1), new Uint8Array(sample.bonds.rows).fill(1));
}

/// Which scan of how many an address asks for; null, where the page has but one.
export function scanOf(state) {
  if (!element('scans')) return null;
  const count = json('scans');
  const at = Math.round(Number(state.get('scan')));
  return { count, at: at >= 0 && at < count ? at : 0 };
}

/// Another scan is the page opened anew.
export function startScans(scan, selection, camera) {
  if (!scan) return;
  const titles = Array.from({ length: scan.count }, (_, i) => json(`about-${i}`).title);
  const slider = make('input', { id: 'scan', type: 'range', step: 1, min: 0, max: scan.count - 1, value: scan.at });
  const value = make('output', { htmlFor: 'scan' }, titles[scan.at]);
  slider.addEventListener('input', () => { value.textContent = titles[slider.value]; });
  const go = (at) => {
    selection.scan = at;
    history.replaceState(null, '', `#${writeState(selection, camera)}`);
    location.reload();
  };
  slider.addEventListener('change', () => go(Number(slider.value)));
  const button = (title, by) => make('button', { type: 'button', onclick: () => go(scan.at + by),
    disabled: scan.at + by < 0 || scan.at + by >= scan.count }, title);
  const missing = make('p', { className: 'hint' });
  const draw = () => {
    missing.textContent = selection.absent.length === 0 ? ''
      : `Grain ${selection.absent.join(', ')} is not in this scan.`;
  };
  selection.listen((what) => { if (what === 'selection') draw(); });
  element('numbers').after(make('section', { id: 'levels', 'aria-label': 'Scans' },
    make('label', { htmlFor: 'scan' }, `Scan ${scan.at + 1} of ${scan.count} `, value),
    make('div', { className: 'track' }, slider),
    make('div', { className: 'bar' }, button('Earlier', -1), button('Later', 1)), missing));
  draw();
}

/// Curves of the grain that is selected, else of the sample.
export async function startHistory(scan, shown, selection) {
  if (!scan) return;
  const samples = [];
  for (let i = 0; i < scan.count; ++i)
    samples.push(i === scan.at ? shown : await Sample.load(`-${i}`, shown.shownUnit));
  const summaries = samples.map(all);
  const panels = make('div', { className: 'panels', id: 'history' });
  const title = make('h2');
  element('charts').prepend(title, panels);
  const curve = (name, unit, values) => {
    const known = values.filter(Number.isFinite);
    const plot = new Plot(name, 'scan', unit, { x: [0.5, scan.count + 0.5], y: rangeOf(known) });
    plot.clear(1);
    plot.upright(scan.at + 1);
    for (const places of runsOf(values)) {
      plot.line(places, lineColors[0]);
      plot.points(places, 'shown');
    }
    return plot.figure;
  };
  const draw = () => {
    const ids = [...[...selection.selected].map((row) => shown.ids[row]), ...selection.absent];
    const [id] = ids;
    title.textContent = ids.length === 1 ? `Grain ${id} through time` : 'The sample through time';
    panels.replaceChildren(...(ids.length === 1
      ? ofGrain.map(([name, called]) => curve(called, shown.unit(shown.columnOf('grains', name).power),
        samples.map((sample) => (sample.rowOf.has(id) ? sample.grains.column(name)[sample.rowOf.get(id)] : NaN))))
      : ofSample.map(([name, called, power]) => curve(called, power ? shown.unit(power) : '',
        summaries.map((summary) => summary[name])))));
  };
  selection.listen((what) => { if (what === 'selection') draw(); });
  draw();
}

/// From 0 on, unless all is far from it.
function rangeOf(values) {
  if (values.length === 0) return [0, 1];
  const low = Math.min(...values), high = Math.max(...values);
  const more = 0.08 * (high - low) || 0.05 * Math.abs(high) || 1;
  return [low > 0 && low < 0.5 * high ? 0 : low - more, high + more];
}

/// Places without a gap between them, scans from 1 on.
function runsOf(values) {
  const runs = [[]];
  values.forEach((value, i) => {
    if (Number.isFinite(value)) runs[runs.length - 1].push([i + 1, value]); else runs.push([]);
  });
  return runs.filter((run) => run.length > 0);
}
