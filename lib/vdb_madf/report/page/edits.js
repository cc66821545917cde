// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// A list of corrections to save, for 'vdb_madf edit'. The page itself changes nothing.
import { element } from './decode.js';
import { make } from './sample.js';
import { saveText } from './tables.js';

export function startEdits(sample, selection) {
  const section = element('edits');
  const list = make('ol');
  const add = (edit) => {
    selection.edits.push(edit);
    selection.changed('edits');
  };
  const ids = () => [...selection.selected].map((row) => sample.ids[row]).sort((a, b) => a - b);
  const button = (title, act) => make('button', { type: 'button', onclick: act }, title);
  const merge = button('Merge the selected', () => add(`merge ${ids().join(' ')}`));
  const drop = button('Drop the selected', () => add(`drop ${ids().join(' ')}`));
  const split = button('Split the selected', () => ids().forEach((id) => add(`split ${id}`)));
  const keep = button('Keep what passes the filters', () =>
    add(`keep ${Array.from(sample.ids.filter((_, row) => selection.visible[row])).join(' ')}`));
  const save = button('Save edits.txt', () => saveText('edits.txt', `${selection.edits.join('\n')}\n`));
  section.append(make('h2', {}, 'Corrections'),
    make('p', { className: 'hint' }, 'A list to save; then: ',
      make('code', {}, 'vdb_madf edit LABELS OUT.vdb --edits edits.txt')),
    make('div', { className: 'bar' }, merge, drop, split, keep, save), list);
  const draw = () => {
    const count = selection.selected.size;
    merge.disabled = !sample.isOwn || count < 2;
    drop.disabled = split.disabled = !sample.isOwn || count === 0;
    keep.disabled = !sample.isOwn || selection.filters.grains.size === 0 && !selection.insideOnly ||
      !selection.visible.includes(1);
    save.disabled = selection.edits.length === 0;
    list.replaceChildren(...selection.edits.map((edit, i) => make('li', {},
      make('code', {}, edit.length > 80 ? `${edit.slice(0, 78)} ...` : edit), ' ',
      button('remove', () => {
        selection.edits.splice(i, 1);
        selection.changed('edits');
      }))));
  };
  selection.listen((what) => { if (['selection', 'filter', 'edits', 'strictness'].includes(what)) draw(); });
  draw();
}
