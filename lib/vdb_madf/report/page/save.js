// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0
// Texts, charts and the view as files; pictures look as on the page.
import { element } from './decode.js';
import { make, makeSvg } from './sample.js';

const kTimes = 2;  // as large as on the screen

/// What the page's styles say of a drawing.
const looks = ['fill', 'stroke', 'stroke-width', 'stroke-dasharray', 'stroke-linecap', 'stroke-linejoin',
  'paint-order', 'font-family', 'font-size', 'text-anchor'];

function save(name, blob) {
  const address = URL.createObjectURL(blob);
  make('a', { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}

export function saveText(name, text) {
  save(name, new Blob([text], { type: 'text/plain' }));
}

function nameOf(what, ending) {
  const [title, part] = [document.title.replace(/\.vdb$/, ''), what].map((text) => text.replace(/[^\p{L}\p{N}.-]+/gu, '_'));
  return `${title}_${part}.${ending}`;
}

function ground() {
  return getComputedStyle(document.body).backgroundColor;
}

/// A drawing that needs no page around it.
function standalone(svg, times = 1) {
  const copy = svg.cloneNode(true), copies = copy.querySelectorAll('*');
  copy.removeAttribute('class');
  svg.querySelectorAll('*').forEach((node, i) => {
    const style = getComputedStyle(node);
    for (const name of ['class', 'style']) copies[i].removeAttribute(name);
    for (const name of looks) copies[i].setAttribute(name, style.getPropertyValue(name));
  });
  for (const side of ['width', 'height']) copy.setAttribute(side, times * svg.viewBox.baseVal[side]);
  return copy;
}

function textOf(svg) {
  return new XMLSerializer().serializeToString(svg);
}

/// A chart with its title and a button to save it.
export function figureOf(title, svg) {
  const saveChart = () => {
    const { x, y, width, height } = svg.viewBox.baseVal, chart = standalone(svg);
    chart.prepend(makeSvg('rect', { x, y, width, height, fill: ground() }));
    save(nameOf(title, 'svg'), new Blob([textOf(chart)], { type: 'image/svg+xml' }));
  };
  return make('figure', {}, make('figcaption', {}, title,
    make('button', { type: 'button', className: 'link', title: 'Save this chart', onclick: saveChart }, 'SVG')), svg);
}

/// The view with what is written over it.
export async function saveView(scene) {
  const picture = scene.picture(kTimes, ground());
  const letters = new Image();
  letters.src = `data:image/svg+xml,${encodeURIComponent(textOf(standalone(element('overlay'), picture.width / scene.width)))}`;
  await letters.decode();
  picture.getContext('2d').drawImage(letters, 0, 0);
  picture.toBlob((blob) => save(nameOf('view', 'png'), blob));
}
