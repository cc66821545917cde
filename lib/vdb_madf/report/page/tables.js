// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// The tables of grains and bonds: sorted by a click, filtered by ranges, linked to the selection.
import jQuery from 'jquery';
import addDataTables from 'datatables';
import { element } from './decode.js';
import { counted, make, written } from './sample.js';
import { saveText } from './save.js';

const shownAtFirst = {
  grains: ['id', 'voxels', 'equivalent_diameter', 'inscribed_radius', 'coordination', 'sphericity',
    'aspect_2_to_1', 'aspect_3_to_2', 'free_area', 'shared_area', 'at_domain_face', 'stability'],
  bonds: ['first', 'second', 'area', 'radius', 'radius_ratio', 'distance', 'cos_alpha', 'mean_curvature', 'vanishes'],
};

/// "0.2:0.5", ":3", "4:" or "7" as a range; null if it is none.
export function parseRange(text) {
  const parts = text.trim().split(':').map((part) => part.trim());
  if (parts.length > 2 || parts.join('') === '') return null;
  const number = (part, empty) => (part === '' ? empty : Number(part));
  const range = parts.length === 1 ? [Number(parts[0]), Number(parts[0])]
    : [number(parts[0], -Infinity), number(parts[1], Infinity)];
  return range.some(Number.isNaN) ? null : range;
}

export function writeRange([low, high]) {
  const text = (value) => (Number.isFinite(value) ? String(value) : '');
  return low === high ? text(low) : `${text(low)}:${text(high)}`;
}

const kTableDelay = 150;  // milliseconds

export function startTables(sample, selection) {
  addDataTables(jQuery, window);
  const tables = ['grains', 'bonds'].map((kind) => new SampleTable(sample, selection, kind));
  const section = element('tables');
  const tabs = make('div', { className: 'tabs', role: 'tablist' });
  const show = (chosen) => tables.forEach((table, i) => {
    table.panel.hidden = i !== chosen;
    tabs.children[i].setAttribute('aria-selected', i === chosen);
  });
  tables.forEach((table, i) => tabs.append(make('button', { type: 'button', role: 'tab', onclick: () => show(i) },
    table.heading)));
  section.append(make('h2', {}, 'Tables'), tabs, filterBar(sample, selection),
    ...tables.map((table) => table.panel));
  tables.forEach((table) => table.start());
  show(0);
}

/// Of filters that no value passes, as of a range in another unit, what values there are.
function missed(sample, selection) {
  return ['grains', 'bonds'].flatMap((kind) => Array.from(selection.filters[kind], ([name, [low, high]]) => {
    const values = Array.from(sample[kind].column(name)).filter((value) => !Number.isNaN(value)).sort((a, b) => a - b);
    return values.length === 0 || values.some((value) => value >= low && value <= high) ? ''
      : `; ${sample.titleWithUnit(kind, name)} goes from ${written(values[0])} to ${written(values[values.length - 1])}`;
  })).join('');
}

/// Makes what is selected a filter.
export function onlySwitch(selection) {
  const box = make('input', { type: 'checkbox' }), text = make('span');
  box.addEventListener('change', () => selection.setOnly(box.checked));
  const show = () => {
    const { only, selected, onlyRows } = selection;
    box.checked = only !== null;
    box.disabled = !only && selected.size === 0;
    text.textContent = only ? ` only the selected (${counted(onlyRows.size)})` : ' only the selected';
  };
  selection.listen((what) => { if (['selection', 'filter', 'strictness'].includes(what)) show(); });
  show();
  return make('label', { className: 'only', title: 'Also when others are selected; the strictness takes the largest piece of each along' },
    box, text);
}

function filterBar(sample, selection) {
  const inside = make('input', { type: 'checkbox', id: 'inside' });
  inside.addEventListener('change', () => {
    selection.insideOnly = inside.checked;
    selection.changed('filter');
  });
  const clear = make('button', { type: 'button', onclick: () => selection.clearFilters() }, 'Clear filters');
  const status = make('span', { id: 'shown', role: 'status' });
  const tell = () => {
    inside.checked = selection.insideOnly;
    clear.disabled = selection.filterCount === 0;
    const grains = selection.visible.reduce((sum, flag) => sum + flag, 0);
    const bonds = selection.visibleBonds.reduce((sum, flag) => sum + flag, 0);
    status.textContent = `${counted(grains)} of ${counted(sample.count)} grains, ` +
      `${counted(bonds)} of ${counted(sample.bonds.rows)} bonds${missed(sample, selection)}`;
  };
  selection.listen((what) => { if (what === 'filter' || what === 'strictness') tell(); });
  tell();
  return make('div', { className: 'bar' }, status,
    make('label', {}, inside, ' only grains that no face of the scan cuts'), onlySwitch(selection), clear);
}

class SampleTable {
  constructor(sample, selection, kind) {
    Object.assign(this, { sample, selection, kind });
    this.flags = () => (kind === 'grains' ? selection.visible : selection.visibleBonds);
    this.heading = kind === 'grains' ? 'Grains' : 'Bonds';
    this.columns = this.table.columns.map(({ name }) => name);
    this.inputs = new Map();
    this.node = make('table', { id: `table-${kind}`, className: 'table' }, this.head());
    const all = make('input', { type: 'checkbox' });
    all.addEventListener('change', () => this.showColumns(all.checked));
    this.panel = make('div', { className: 'panel', role: 'tabpanel' },
      make('div', { className: 'bar' }, make('label', {}, all, ' all columns'),
        this.button('Copy numbers', () => this.copy()), this.button('Save as CSV', () => this.save())),
      this.node);
  }

  get table() {
    return this.sample[this.kind];
  }
  rows() {
    return Array.from({ length: this.table.rows }, (_, row) => row);
  }

  button(title, act) {
    return make('button', { type: 'button', onclick: act }, title);
  }

  /// Titles, and below each a field for its range.
  head() {
    const titles = make('tr'), fields = make('tr', { className: 'ranges' });
    for (const name of this.columns) {
      const title = this.sample.titleWithUnit(this.kind, name);
      const input = make('input', { type: 'text', placeholder: 'a:b', size: 6, 'aria-label': `Range of ${title}`,
        title: 'A range: 0.2:0.5, 4: or :3' });
      input.addEventListener('change', () => {
        const range = parseRange(input.value);
        input.classList.toggle('wrong', !range && input.value.trim() !== '');
        this.selection.setFilter(this.kind, name, range);
      });
      this.inputs.set(name, input);
      titles.append(make('th', { scope: 'col', title: this.sample.hintOf(name) }, title));
      fields.append(make('td', {}, input));
    }
    return make('thead', {}, titles, fields);
  }

  start() {
    jQuery.fn.dataTable.ext.search.push((settings, data, row) =>
      settings.nTable !== this.node || this.flags()[row] === 1);
    this.data = jQuery(this.node).DataTable({
      data: this.rows(), deferRender: true, autoWidth: false, orderCellsTop: true, pageLength: 12, dom: '<"scroll"t>ip',
      order: this.kind === 'grains' ? [[this.columns.indexOf('equivalent_diameter'), 'desc']]
        : [[this.columns.indexOf('area'), 'desc']],
      columns: this.columns.map((name) => ({ data: null, searchable: false,
        visible: shownAtFirst[this.kind].includes(name), orderSequence: ['desc', 'asc'], className: 'number',
        render: (row, type) => {
          const value = this.table.column(name)[row];
          return type === 'display' ? written(value) : value;
        } })),
      createdRow: (tr, row) => {
        tr.tabIndex = 0;
        tr.dataset.row = row;
        tr.classList.toggle('chosen', this.isChosen(row));
      },
      language: { emptyTable: `no ${this.kind}`, zeroRecords: `no ${this.kind} pass the filters`,
        info: '_START_ to _END_ of _TOTAL_', infoEmpty: '', infoFiltered: '' },
    });
    const choose = (event) => {
      const tr = event.target.closest('tbody tr[data-row]');
      if (!tr || (event.type === 'keydown' && event.key !== 'Enter')) return;
      this.choose(Number(tr.dataset.row), event.shiftKey || event.ctrlKey);
    };
    this.node.addEventListener('click', choose);
    this.node.addEventListener('keydown', choose);
    this.selection.listen((what) => this.follow(what));
    this.follow('filter');
  }

  /// Rows of the grains that a row is about.
  grainsOf(row) {
    const { first, second } = this.sample.bondEnds;
    return this.kind === 'grains' ? [row] : [first[row], second[row]];
  }
  isChosen(row) {
    return this.grainsOf(row).every((grain) => this.selection.selected.has(grain));
  }
  choose(row, more) {
    this.isOwn = true;
    this.selection.select(this.grainsOf(row), more);
    this.isOwn = false;
  }

  follow(what) {
    // Filling a table of thousands of rows takes longer than all else: it waits for the last step.
    if (what === 'strictness') {
      clearTimeout(this.due);
      this.due = setTimeout(() => {
        this.data.clear().rows.add(this.rows());
        this.follow('filter');
      }, kTableDelay);
    }
    if (what === 'filter') {
      for (const [name, input] of this.inputs) {
        const range = this.selection.filters[this.kind].get(name);
        if (range) input.value = writeRange(range);
        else if (!input.classList.contains('wrong')) input.value = '';
      }
      this.data.draw();
    }
    if (what !== 'selection') return;
    if (!this.isOwn) this.turnToChosen();
    for (const tr of this.node.tBodies[0].rows)
      if (tr.dataset.row) tr.classList.toggle('chosen', this.isChosen(Number(tr.dataset.row)));
  }

  turnToChosen() {
    const order = this.data.rows({ order: 'applied', search: 'applied' }).indexes().toArray();
    const place = order.findIndex((row) => this.isChosen(row));
    if (place < 0) return;
    this.data.page(Math.floor(place / this.data.page.len())).draw('page');
  }

  showColumns(all) {
    this.columns.forEach((name, i) =>
      this.data.column(i).visible(all || shownAtFirst[this.kind].includes(name), false));
    this.data.draw(false);
  }

  shownRows() {
    const flags = this.flags();
    return Array.from(flags.keys()).filter((row) => flags[row]);
  }

  copy() {
    const numbers = this.shownRows().map((row) => this.grainsOf(row).map((grain) => this.sample.ids[grain]).join(','));
    const area = make('textarea', { value: numbers.join('\n') });
    document.body.append(area);
    area.select();
    document.execCommand('copy');
    area.remove();
  }

  /// The lines of the table as 'vdb_madf measure' writes them.
  save() {
    const { lines } = this.table;
    saveText(`${this.kind}.csv`, [lines[0], ...this.shownRows().map((row) => lines[row + 1]), ''].join('\n'));
  }
}
