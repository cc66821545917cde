// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// The view in three dimensions with its controls, or the picture in its place.
import { Camera, steer } from './camera.js';
import { element } from './decode.js';
import { drawOverlay } from './overlay.js';
import { make } from './sample.js';
import { saveView } from './save.js';
import { contextOf, Scene, Space } from './scene.js';

/// Columns that say nothing as a color.
const notColors = /^(id$|first$|second$|centroid_|representative_|box_|normal_|neck_normal_|axis[123]_[xyz]$)/;

export function newCamera(sample) {
  return new Camera(sample.about.view, 2 * new Space(sample.about).radius);
}

/// @return the scene, or null where there is none
export async function startView(sample, selection, camera) {
  const stage = element('stage');
  // Its height is such that it fits on the screen with what is above it (page.css).
  stage.style.setProperty('--above', `${stage.getBoundingClientRect().top + window.scrollY}px`);
  const context = sample.about.mesh && contextOf(element('canvas'));
  const mesh = context && await sample.loadMesh();
  element('wait').remove();
  if (!mesh) {
    document.body.classList.add('flat');
    element('view').querySelector('.hint').textContent = sample.about.mesh
      ? 'This browser shows no WebGL 2: a picture in the place of the view that turns. Slices, charts and tables work.'
      : '';
    controls(sample, selection, null);
    return null;
  }
  const scene = new Scene(element('canvas'), context, sample, mesh, selection, camera);
  const overlay = element('overlay');
  scene.onDrawn = () => drawOverlay(overlay, scene, sample, selection);
  new ResizeObserver(() => scene.resize()).observe(stage);
  scene.resize();
  steer(stage, camera, () => scene.scale, () => selection.changed('camera'), (x, y, more) => {
    stage.focus({ preventScroll: true });
    const row = scene.pick(x, y);
    if (row >= 0) selection.select([row], more); else if (!more) selection.select([]);
  });
  controls(sample, selection, camera);
  element('controls').append(labelled('Picture',
    make('button', { type: 'button', onclick: () => saveView(scene) }, 'Save as PNG'), 'div'));
  window.addEventListener('beforeprint', () => {
    scene.draw();
    element('picture').src = element('canvas').toDataURL();
  });
  return scene;
}

function controls(sample, selection, camera) {
  const box = element('controls');
  const color = columnChoice(sample, 'grains', 'color', 'a color each');
  bind(color, selection, 'colorBy', 'looks');
  box.append(labelled('Color by', color));
  const bondColor = columnChoice(sample, 'bonds', 'bond-color', 'one color');
  bind(bondColor, selection, 'bondColorBy', 'looks');
  // To choose a color of bonds is to want to see them.
  bondColor.addEventListener('input', () => {
    if (selection.bondsAs !== 'none' || !bondColor.value) return;
    selection.bondsAs = 'discs';
    selection.changed('selection');
  });
  const others = choice('others', { pale: 'pale', plain: 'as they are', hidden: 'hidden' });
  bind(others, selection, 'others', 'selection');
  const bonds = choice('bonds-as', { none: 'not shown', discs: 'discs', lines: 'lines' });
  bind(bonds, selection, 'bondsAs', 'selection');
  box.append(labelled('Beside the selected', others), labelled('Bonds', bonds), labelled('Color bonds by', bondColor));
  const hint = make('p', { className: 'hint', id: 'color-hint' });
  const explain = () => {
    hint.textContent = [selection.colorBy, selection.bondColorBy].map((name) => sample.hintOf(name)).join(' ').trim();
  };
  selection.listen((what) => { if (what === 'looks') explain(); });
  explain();
  box.append(hint);
  if (!camera) return;
  const explode = make('input', { id: 'explode', type: 'range', min: 0, max: 1.5, step: 0.05 });
  bind(explode, selection, 'explode', 'looks', Number);
  box.append(labelled('Explode', explode));
  ['x', 'y', 'z'].forEach((name, axis) => box.append(cutControl(selection, name, axis)));
  const views = make('span', { className: 'buttons' });
  for (const name of ['x', 'y', 'z'])
    views.append(button(`along ${name}`, () => camera.axis(name), selection));
  views.append(button('home', () => camera.home(), selection));
  box.append(labelled('Look', views, 'div'));
}

function columnChoice(sample, kind, id, usual) {
  const select = make('select', { id }, make('option', { value: '' }, usual));
  for (const { name } of sample[kind].columns)
    if (!notColors.test(name)) select.append(make('option', { value: name }, sample.titleWithUnit(kind, name)));
  return select;
}

function button(title, act, selection) {
  return make('button', { type: 'button', onclick: () => { act(); selection.changed('camera'); } }, title);
}

export function choice(id, texts) {
  const select = make('select', { id });
  for (const [value, title] of Object.entries(texts)) select.append(make('option', { value }, title));
  return select;
}

/// Keeps a control and a member of the selection the same.
export function bind(control, selection, member, what, parse = String) {
  control.value = selection[member];
  control.addEventListener('input', () => {
    selection[member] = parse(control.value);
    selection.changed(what);
  });
  selection.listen(() => {
    if (control.value !== String(selection[member])) control.value = selection[member];
  });
}

function cutControl(selection, name, axis) {
  const slider = make('input', { type: 'range', min: 0, max: 1, step: 0.005, id: `cut-${name}` });
  const flip = make('button', { type: 'button', title: `Keep the other side of the cut along ${name}` }, 'flip');
  const show = () => { slider.value = selection.cuts[axis]; };
  slider.addEventListener('input', () => {
    selection.cuts[axis] = Number(slider.value);
    selection.changed('cuts');
  });
  flip.addEventListener('click', () => {
    selection.flips[axis] = !selection.flips[axis];
    const { cuts } = selection;
    if (cuts[axis] === 0 || cuts[axis] === 1) cuts[axis] = 1 - cuts[axis];
    selection.changed('cuts');
  });
  selection.listen((what) => { if (what === 'cuts') show(); });
  show();
  return labelled(`Cut ${name}`, make('span', { className: 'buttons' }, slider, flip), 'div');
}

export function labelled(title, control, tag = 'label') {
  return make(tag, { className: 'control' }, make('span', {}, title), control);
}
