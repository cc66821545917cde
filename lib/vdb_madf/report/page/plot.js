// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// Axes with bars or points, in which ranges can be dragged.
import { roundLength } from './overlay.js';
import { makeSvg, written } from './sample.js';
import { figureOf } from './save.js';

const size = { width: 320, height: 210 };
const frame = { left: 46, right: 304, top: 10, bottom: 168 };

/// Round numbers from low to high.
export function ticks(low, high, most) {
  const rough = (high - low) / most;
  const step = [1, 2, 2.5, 5, 10].map((factor) => factor * roundLength(rough)).find((value) => value >= rough);
  const found = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i)
    found.push(Number((i * step).toPrecision(12)));
  return found;
}

export class Plot {
  /// `isLog`: y has logarithms to the base 10.
  constructor(title, xTitle, yTitle, { x, y, isLog = false }) {
    Object.assign(this, { title, xTitle, yTitle, x, y, isLog });
    this.svg = makeSvg('svg', { viewBox: `0 0 ${size.width} ${size.height}`, role: 'img' });
    this.svg.setAttribute('aria-label', title);
    this.figure = figureOf(title, this.svg);
  }

  toX(value) {
    return frame.left + (value - this.x[0]) / (this.x[1] - this.x[0]) * (frame.right - frame.left);
  }
  toY(value) {
    const [low, high] = this.y || [0, this.most];
    return frame.bottom - (value - low) / (high - low) * (frame.bottom - frame.top);
  }

  clear(most) {
    this.most = most > 0 ? 1.05 * most : 1;
    this.svg.replaceChildren();
    this.add('rect', { class: 'field', x: frame.left, y: frame.top,
      width: frame.right - frame.left, height: frame.bottom - frame.top });
    for (const value of ticks(...this.x, 5)) {
      const x = this.toX(value);
      this.add('line', { class: 'tick', x1: x, x2: x, y1: frame.bottom, y2: frame.bottom + 4 });
      this.text(x, frame.bottom + 17, written(value), 'middle');
    }
    for (const value of ticks(...(this.y || [0, this.most]), 4)) {
      const y = this.toY(value);
      this.add('line', { class: 'grid', x1: frame.left, x2: frame.right, y1: y, y2: y });
      this.text(frame.left - 5, y + 4, this.isLog ? written(10 ** value, 2) : written(value), 'end');
    }
    this.text((frame.left + frame.right) / 2, size.height - 6, this.xTitle, 'middle');
    this.text(11, (frame.top + frame.bottom) / 2, this.yTitle, 'middle',
      { transform: `rotate(-90 11 ${(frame.top + frame.bottom) / 2})` });
  }

  add(tag, attributes) {
    this.svg.append(makeSvg(tag, attributes));
  }
  text(x, y, content, anchor, more = {}) {
    this.svg.append(makeSvg('text', { x, y, 'text-anchor': anchor, ...more }, content));
  }

  bars(edges, heights, look) {
    heights.forEach((height, i) => {
      const x = this.toX(edges[i]), y = this.toY(height);
      if (height > 0)
        this.add('rect', { class: look, x: x + 0.5, y, width: Math.max(0.5, this.toX(edges[i + 1]) - x - 1),
          height: frame.bottom - y });
    });
  }

  /// Up and down from the top of each bar; `place`: where across it.
  whiskers(edges, heights, doubts, color, place = 0.5) {
    heights.forEach((height, i) => {
      const x = this.toX(edges[i] + place * (edges[i + 1] - edges[i]));
      if (height > 0)
        this.add('line', { class: 'whisker', x1: x, x2: x, y1: this.toY(Math.max(0, height - doubts[i])),
          y2: this.toY(height + doubts[i]), ...(color && { style: `stroke: ${color}` }) });
    });
  }

  /// The outline of bars.
  steps(edges, heights, color) {
    const tops = heights.map((height, i) =>
      `V${this.toY(height).toFixed(1)}H${this.toX(edges[i + 1]).toFixed(1)}`);
    this.add('path', { class: 'steps', stroke: color,
      d: `M${this.toX(edges[0]).toFixed(1)} ${frame.bottom}${tops.join('')}V${frame.bottom}` });
  }

  line(places, color, isDashed) {
    const path = places.map(([x, y], i) => `${i ? 'L' : 'M'}${this.toX(x).toFixed(1)} ${this.toY(y).toFixed(1)}`);
    this.add('path', { class: 'steps', stroke: color, d: path.join(''), 'stroke-dasharray': isDashed ? '2 3' : 'none' });
  }

  /// A dashed line at x, if it is one of the plot's.
  upright(x) {
    if (x >= this.x[0] && x <= this.x[1])
      this.add('line', { class: 'class', x1: this.toX(x), x2: this.toX(x), y1: frame.top, y2: frame.bottom });
  }

  points(places, look) {
    const path = places.map(([x, y]) => `M${this.toX(x).toFixed(1)} ${this.toY(y).toFixed(1)}h0`).join('');
    this.add('path', { class: `points ${look}`, d: path });
  }

  /// Zingg's classes: two thirds.
  zinggLines() {
    const at = 2 / 3;
    this.add('line', { class: 'class', x1: this.toX(at), x2: this.toX(at), y1: frame.top, y2: frame.bottom });
    this.add('line', { class: 'class', x1: frame.left, x2: frame.right, y1: this.toY(at), y2: this.toY(at) });
    const names = [['disc', 0.33, 0.96], ['equant', 0.97, 0.96], ['blade', 0.33, 0.03], ['rod', 0.97, 0.03]];
    for (const [name, x, y] of names)
      this.text(this.toX(x), this.toY(y) + 4, name, x > 0.5 ? 'end' : 'middle', { class: 'class' });
  }

  /// The range of a filter, or of two.
  mark(x, y) {
    if (!x && !y) return;
    const within = (value, low, high) => Math.max(low, Math.min(high, value));
    const [low, high] = (x || this.x).map((value) => within(this.toX(value), frame.left, frame.right));
    const [bottom, top] = (y || this.y || [0, this.most]).map((value) =>
      within(this.toY(value), frame.top, frame.bottom));
    this.add('rect', { class: 'range', x: low, width: Math.max(1, high - low), y: top, height: Math.max(1, bottom - top) });
  }

  /// filter(range of x, range of y) after a drag, undo() after a click.
  onDrag(filter, undo) {
    this.svg.classList.add('drag');
    let from = null;
    const place = (event) => {
      const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.svg.getScreenCTM().inverse());
      return [Math.max(frame.left, Math.min(frame.right, point.x)), Math.max(frame.top, Math.min(frame.bottom, point.y))];
    };
    const value = ([x, y]) => {
      const [low, high] = this.y || [0, this.most];
      return [this.x[0] + (x - frame.left) / (frame.right - frame.left) * (this.x[1] - this.x[0]),
        low + (frame.bottom - y) / (frame.bottom - frame.top) * (high - low)];
    };
    const ranges = (event) => {
      const a = value(from), b = value(place(event));
      return [0, 1].map((axis) => [Math.min(a[axis], b[axis]), Math.max(a[axis], b[axis])]);
    };
    this.svg.addEventListener('pointerdown', (event) => {
      from = place(event);
      this.svg.setPointerCapture(event.pointerId);
    });
    this.svg.addEventListener('pointermove', (event) => {
      if (!from) return;
      this.svg.querySelectorAll('.range').forEach((old) => old.remove());
      const [x, y] = ranges(event);
      this.mark(x, this.y && y);
    });
    this.svg.addEventListener('pointerup', (event) => {
      if (!from) return;
      const to = place(event);
      const [x, y] = ranges(event);
      const isDrag = Math.hypot(to[0] - from[0], to[1] - from[1]) > 4;
      from = null;
      if (isDrag) filter(x, y); else undo();
    });
    this.svg.addEventListener('pointercancel', () => { from = null; });
  }
}
