// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// Three slices through the labels, with what is selected and filtered as in the view.
import { element } from './decode.js';
import { secondColor, selectedColor } from './looks.js';
import { make, makeSvg } from './sample.js';
import { kHidden, kPale, kSelected } from './selection.js';
import { bind, choice, labelled } from './view.js';

const names = ['x', 'y', 'z'];
const hiddenColor = [128, 136, 144];
// How much of the page, or of the scan, a color covers.
const kNothing = 0, kTintCover = 48, kHiddenCover = 62, kPaleCover = 90, kFullCover = 255;

/// The planes x-y, x-z and y-z: what goes to the right and what goes down; z goes up.
const planes = [[0, 1], [0, 2], [1, 2]];

export function startSlices(sample, selection) {
  const section = element('slices');
  section.append(make('h2', {}, 'Slices'));
  const { gray } = sample.about;
  if (gray) {
    const shown = choice('slices-as', { outlines: 'scan with outlines of grains', grains: 'grains', scan: 'scan' });
    bind(shown, selection, 'slicesAs', 'slices');
    section.append(make('div', { className: 'bar' }, labelled('Show', shown)));
  }
  const panels = planes.map(([right, down]) => new Panel(sample, selection, right, down));
  section.append(make('div', { className: 'panels' }, ...panels.map((panel) => panel.figure)));
  const { factor } = sample.about.slices;
  const notes = [
    factor > 1 && `A pixel stands for ${factor} \u00d7 ${factor} \u00d7 ${factor} voxels: ` +
      `the label that most of them have${gray ? ', and the mean of the scan' : ''}.`,
    gray && `Scan: ${gray.scan}, in ${gray.levels} grays; half a percent is black, half a percent white.`];
  section.append(make('p', { className: 'hint' }, notes.filter(Boolean).join(' ')));
  const drawAll = () => panels.forEach((panel) => panel.draw());
  selection.listen((what) => {
    if (!['camera', 'cuts', 'edits', 'theme'].includes(what)) drawAll();
  });
  drawAll();
}

class Panel {
  constructor(sample, selection, right, down) {
    const fixed = 3 - right - down;
    const { size } = sample.about.slices;
    Object.assign(this, { sample, selection, right, down, fixed, width: size[right], height: size[down] });
    const { edges } = sample.about;
    this.canvas = make('canvas', { width: this.width, height: this.height });
    this.image = this.canvas.getContext('2d').createImageData(this.width, this.height);
    this.rows = new Int32Array(this.width * this.height);  // grains; -1: none
    this.strides = [1, size[0], size[0] * size[1]];  // of the volume
    this.cross = makeSvg('svg', { viewBox: `0 0 ${this.width} ${this.height}`, preserveAspectRatio: 'none' });
    this.frame = make('div', { className: 'slice' }, this.canvas, this.cross);
    this.frame.style.aspectRatio = `${this.width * edges[right]} / ${this.height * edges[down]}`;
    this.slider = make('input', { type: 'range', min: 0, max: size[fixed] - 1, step: 1,
      'aria-label': `Place of the slice along ${names[fixed]}` });
    this.place = make('output');
    this.figure = make('figure', {},
      make('figcaption', {}, `${names[right]} \u2192, ${names[down]} ${down === 2 ? '\u2191' : '\u2193'} at ${names[fixed]} = `, this.place), this.frame, this.slider);
    this.slider.addEventListener('input', () => this.moveTo(Number(this.slider.value)));
    this.frame.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.moveTo(selection.slices[fixed] + (event.deltaY < 0 ? 1 : -1));
    }, { passive: false });
    this.frame.addEventListener('click', (event) => this.click(event));
    this.frame.addEventListener('pointermove', (event) => this.hover(event));
  }

  moveTo(layer) {
    const { size } = this.sample.about.slices;
    this.selection.slices[this.fixed] = Math.max(0, Math.min(size[this.fixed] - 1, layer));
    this.selection.changed('slices');
  }

  /// The voxel of the slices at a column and a line from above.
  voxel(column, line) {
    const p = [...this.selection.slices];
    p[this.right] = column;
    p[this.down] = this.down === 2 ? this.height - 1 - line : line;
    return p;
  }

  voxelAt(event) {
    const box = this.frame.getBoundingClientRect();
    const share = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
    const within = (value, count) => Math.max(0, Math.min(count - 1, Math.floor(value * count)));
    return this.voxel(within(share[0], this.width), within(share[1], this.height));
  }

  click(event) {
    const voxel = this.voxelAt(event);
    const more = event.shiftKey || event.ctrlKey;
    const row = this.sample.rowAt(...voxel);
    if (row >= 0) {
      this.selection.select([row], more);
    } else if (!more) {
      this.selection.select([]);
    }
    this.selection.slices = voxel;
    this.selection.changed('slices');
  }

  hover(event) {
    const row = this.sample.rowAt(...this.voxelAt(event));
    this.frame.title = row < 0 ? '' : `grain ${this.sample.ids[row]}`;
  }

  /// call(pixel, place in the volume, column, line)
  forEachPixel(call) {
    const { right, down, fixed, width, height, strides } = this;
    const first = this.selection.slices[fixed] * strides[fixed];
    for (let line = 0, pixel = 0; line < height; ++line) {
      let cell = first + (down === 2 ? height - 1 - line : line) * strides[down];
      for (let column = 0; column < width; ++column, ++pixel, cell += strides[right]) call(pixel, cell, column, line);
    }
  }

  draw() {
    const { selection, sample, rows } = this;
    const { colors, states, bondsAs, bondColors, secondPart, slicesAs } = selection;
    const { volume, rowOfBody, gray } = sample;
    const { data } = this.image;
    const brightness = gray && 255 / (sample.about.gray.levels - 1);
    this.forEachPixel((pixel, cell) => { rows[pixel] = volume[cell] > 0 ? rowOfBody[volume[cell] - 1] : -1; });
    this.forEachPixel((pixel, cell, column, line) => {
      const row = rows[pixel];
      const state = row < 0 ? -1 : states[row];
      const bond = bondsAs === 'none' ? -1 : this.bondAt(row, column, line);
      let source = colors, at = 3 * row, cover = kFullCover;
      if (state < 0) cover = kNothing;
      else if (bond >= 0) [source, at] = [bondColors, 3 * bond];
      else if (state === kHidden) [source, at, cover] = [hiddenColor, 0, kHiddenCover];
      else if (state === kSelected) {
        const isSecond = secondPart.size > 0 && secondPart.has(volume[cell] - 1);
        [source, at] = [isSecond ? secondColor : selectedColor, 0];
      }
      else if (state === kPale) cover = kPaleCover;
      let base = 0;
      if (slicesAs !== 'grains') {
        base = brightness * gray[cell];
        if (slicesAs === 'scan') cover = kNothing;
        else if (bond < 0 && !this.isOutline(pixel, column, line)) cover = state === kSelected ? kTintCover : kNothing;
      }
      const share = slicesAs === 'grains' ? 1 : cover / 255;
      for (let k = 0; k < 3; ++k) data[4 * pixel + k] = cover > 0 ? base + share * (source[at + k] - base) : base;
      data[4 * pixel + 3] = slicesAs === 'grains' ? cover : 255;
    });
    this.canvas.getContext('2d').putImageData(this.image, 0, 0);
    this.drawCross();
    const layer = selection.slices[this.fixed];
    this.slider.value = layer;
    const { factor, min } = sample.about.slices;
    const index = (layer + min[this.fixed]) * factor + (factor - 1) / 2;
    this.place.textContent = sample.length(index * sample.edges[this.fixed]);
  }

  /// Whether a neighbor of a pixel is of another grain, or of none.
  isOutline(pixel, column, line) {
    const { rows, width, height } = this, row = rows[pixel];
    return (column > 0 && rows[pixel - 1] !== row) || (column + 1 < width && rows[pixel + 1] !== row) ||
      (line > 0 && rows[pixel - width] !== row) || (line + 1 < height && rows[pixel + width] !== row);
  }

  /// The bond of a grain with that of the pixel to the right or below, if it is shown; -1: none.
  bondAt(row, column, line) {
    const { selected, visibleBonds } = this.selection;
    if (row < 0) return -1;
    for (const [right, down] of [[1, 0], [0, 1]]) {
      if (column + right >= this.width || line + down >= this.height) continue;
      const other = this.rows[(line + down) * this.width + column + right];
      if (other < 0 || other === row) continue;
      const bond = this.sample.bondBetween(row, other);
      if (bond >= 0 && visibleBonds[bond] && (selected.size === 0 || selected.has(row) || selected.has(other)))
        return bond;
    }
    return -1;
  }

  drawCross() {
    const { slices } = this.selection;
    const x = slices[this.right] + 0.5;
    const y = (this.down === 2 ? this.height - 1 - slices[2] : slices[this.down]) + 0.5;
    this.cross.replaceChildren(
      makeSvg('line', { x1: x, x2: x, y1: 0, y2: this.height }),
      makeSvg('line', { x1: 0, x2: this.width, y1: y, y2: y }));
  }
}
