// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// A list of corrections to save, for 'vdb_madf edit'. The page itself changes nothing.
import { element } from './decode.js';
import { make } from './sample.js';
import { saveText } from './save.js';

/// The first line makes other labels than those that the list is of refuse it.
function textOf({ edits, editsAt }) {
  return [...(editsAt === null ? [] : [`strictness ${editsAt}`]), ...edits, ''].join('\n');
}

function commands({ levels }, strictness) {
  const isOwn = !levels || strictness === levels.own, labels = isOwn ? 'LABELS' : 'CUT.vdb';
  const lines = [...(isOwn ? [] : [`vdb_madf remerge LABELS CUT.vdb --strictness ${strictness} --tidy 0`]),
    `vdb_madf edit ${labels} OUT.vdb --edits edits.txt`];
  return lines.flatMap((line, i) => [i > 0 ? ' and ' : '', make('code', {}, line)]);
}

export function startEdits(sample, selection) {
  const section = element('edits');
  const list = make('ol');
  const ids = () => [...selection.selected].map((row) => sample.ids[row]).sort((a, b) => a - b);
  const button = (title, act) => make('button', { type: 'button', onclick: act }, title);
  const merge = button('Merge the selected', () => selection.addEdits(`merge ${ids().join(' ')}`));
  const drop = button('Drop the selected', () => selection.addEdits(`drop ${ids().join(' ')}`));
  const split = button('Split the selected', () => selection.addEdits(...ids().map((id) => `split ${id}`)));
  const keep = button('Keep what passes the filters', () =>
    selection.addEdits(`keep ${Array.from(sample.ids.filter((_, row) => selection.visible[row])).join(' ')}`));
  const save = button('Save edits.txt', () => saveText('edits.txt', textOf(selection)));
  const clear = button('Clear the list', () => {
    selection.edits = [];
    selection.changed('edits');
  });
  const how = make('p', { className: 'hint' }), elsewhere = make('p', { className: 'warning' });
  section.append(make('h2', {}, 'Corrections'),
    how, make('div', { className: 'bar' }, merge, drop, split, keep, save, clear), elsewhere, list);
  const draw = () => {
    const count = selection.selected.size;
    const { mayEdit, edits, editsAt } = selection;
    merge.disabled = !mayEdit || count < 2;
    drop.disabled = split.disabled = !mayEdit || count === 0;
    keep.disabled = !mayEdit || selection.grainFilterCount === 0 || !selection.visible.includes(1);
    save.disabled = clear.disabled = edits.length === 0;
    how.replaceChildren('A list to save; then: ', ...commands(sample, edits.length > 0 ? editsAt : selection.shownStrictness));
    elsewhere.hidden = mayEdit;
    elsewhere.textContent = mayEdit ? ''
      : `These are of the grains at the strictness ${editsAt}, which have other numbers: go back there, or clear the list.`;
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
