// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// The switches beside the title: light or dark, and the unit of lengths.
import { writeState } from './address.js';
import { element } from './decode.js';
import { make } from './sample.js';

const names = { nm: 'nm', um: '\u00b5m', mm: 'mm', voxel: 'voxels' };

/// As the system says, or as chosen. Paper is light (page.css).
export function startTheme(chosen, changed = () => {}) {
  const { dataset } = document.documentElement;
  const system = matchMedia('(prefers-color-scheme: dark)');
  const button = make('button', { type: 'button', id: 'theme' });
  const show = () => {
    dataset.theme = chosen || (system.matches ? 'dark' : 'light');
    button.textContent = dataset.theme === 'dark' ? 'Light' : 'Dark';
  };
  button.addEventListener('click', () => {
    chosen = dataset.theme === 'dark' ? 'light' : 'dark';
    show();
    changed(chosen);
  });
  system.addEventListener('change', show);
  element('switches').append(button);
  show();
}

/// All that is written has the unit in it: the page is opened anew.
export function startUnits(sample, selection, camera) {
  if (sample.units.length < 2) return;
  const select = make('select', { id: 'unit' });
  for (const unit of sample.units)
    select.append(make('option', { value: unit, selected: unit === sample.shownUnit }, names[unit]));
  select.addEventListener('change', () => {
    selection.useUnit(select.value);
    history.replaceState(null, '', `#${writeState(selection, camera)}`);
    location.reload();
  });
  element('switches').prepend(make('label', {}, 'Lengths in ', select));
}
