// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
import { followState, readState } from './address.js';
import { startCharts } from './charts.js';
import { startComparison } from './comparison.js';
import { element, json } from './decode.js';
import { startEdits } from './edits.js';
import { startGrain } from './grain.js';
import { scanOf, startHistory, startScans } from './history.js';
import { make, Sample } from './sample.js';
import { Selection } from './selection.js';
import { startSlices } from './slices.js';
import { startStrictness } from './strictness.js';
import { startSummary } from './summary.js';
import { startSweep } from './sweep.js';
import { startTheme, startUnits } from './switches.js';
import { startTables } from './tables.js';
import { newCamera, startView } from './view.js';

async function start() {
  if (element('samples')) {
    startTheme(null);
    await startComparison(json('samples'));
  } else {
    await startSample();
  }
  document.documentElement.dataset.ready = 'yes';
}

async function startSample() {
  const state = new URLSearchParams(location.hash.slice(1));
  const scan = scanOf(state);
  const sample = await Sample.load(scan ? `-${scan.at}` : '', state.get('unit'));
  await sample.loadVoxels();
  const selection = new Selection(sample);
  if (scan) selection.scan = scan.at;
  const camera = newCamera(sample);
  selection.theme = ['light', 'dark'].find((theme) => theme === state.get('theme')) || null;
  startTheme(selection.theme, (theme) => {
    selection.theme = theme;
    selection.changed('theme');
  });
  startUnits(sample, selection, camera);
  readState(state, selection, camera);
  selection.applyFilters();
  selection.changed('looks');
  startSummary(sample, selection);
  startStrictness(sample, selection);
  startScans(scan, selection, camera);
  startGrain(sample, selection);
  startSlices(sample, selection);
  startCharts(sample, selection);
  await startSweep(sample);
  startTables(sample, selection);
  startEdits(sample, selection);
  const scene = await startView(sample, selection, camera);
  selection.changed('filter', 'selection', 'looks', 'cuts');
  await startHistory(scan, sample, selection);
  followState(selection, camera);
  document.addEventListener('keydown', (event) => {
    if (event.key === 'Escape' && selection.selected.size + selection.absent.length > 0) selection.select([]);
  });
  // In a frame the view comes first. (scrollIntoView would move the page around the frame, too.)
  if (window.parent !== window)
    window.scrollBy(0, (element('levels') || element('view')).getBoundingClientRect().top);
  // For tests, and for a reader's console.
  window.report = { sample, selection, camera, scene };
}

start().catch((error) => {
  document.documentElement.dataset.ready = 'no';
  element('warnings').append(make('p', {},
    'DecompressionStream' in window ? `This page cannot be shown: ${error}`
      : 'This browser is too old for this page: Chrome or Edge 88, Firefox 113 or Safari 16.4 show it.'));
  throw error;
});
