# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Files that the page of a report saves."""

import xml.etree.ElementTree

from command import demand

# What is saved from now on: window.saved is the text of the last file, window.savedBlob its bytes.
SAVED = """
window.saved = '';
window.savedBlob = null;
const make = URL.createObjectURL, {click} = HTMLAnchorElement.prototype;
URL.createObjectURL = (blob) => {
  blob.text().then((text) => { window.saved = text; window.savedBlob = blob; });
  return make(blob);
};
HTMLAnchorElement.prototype.click = function () {
  window.savedName = this.download;
  click.call(this);
};
"""

# Of the picture that is saved: its size, two of its pixels, how often something begins in a row
# at a pixel that is even, and at one that is odd; and how many pixels have the color of letters.
PICTURE = """
const done = arguments[0];
createImageBitmap(window.savedBlob).then((image) => {
  const {width, height} = image;
  const canvas = document.createElement('canvas');
  Object.assign(canvas, {width, height});
  const context = canvas.getContext('2d');
  context.drawImage(image, 0, 0);
  const {data} = context.getImageData(0, 0, width, height);
  const at = (x, y) => Array.from(data.slice(4 * (y * width + x), 4 * (y * width + x) + 4)).join();
  const starts = [0, 0], ground = at(0, 0);
  for (let y = Math.round(0.3 * height); y < 0.7 * height; ++y)
    for (let x = 1; x < 0.8 * width; ++x)
      if (at(x, y) !== ground && at(x - 1, y) === ground) starts[x % 2] += 1;
  let letters = 0;
  for (let y = height - 80; y < height; ++y)
    for (let x = width - 400; x < width; ++x) if (at(x, y) === arguments[1]) letters += 1;
  done({width, height, ground, middle: at(width >> 1, height >> 1), starts, letters});
});
"""

# Of the picture in the place of the view: how much its corner and its middle cover of the page, how
# many of its pixels have the color of letters, and the contrast of these with the page.
STILL = """
const picture = document.getElementById('picture'), canvas = document.createElement('canvas');
[canvas.width, canvas.height] = [picture.naturalWidth, picture.naturalHeight];
const context = canvas.getContext('2d');
context.drawImage(picture, 0, 0);
const {data} = context.getImageData(0, 0, canvas.width, canvas.height);
let letters = 0;
for (let i = 0; i < data.length; i += 4)
  if (data.slice(i, i + 4).join() === '120,126,132,255') ++letters;
const light = (color) => color.map((value) => value / 255)
  .map((value) => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4))
  .reduce((sum, value, k) => sum + value * [0.2126, 0.7152, 0.0722][k], 0.05);
const ground = getComputedStyle(document.body).backgroundColor.match(/[0-9]+/g).map(Number);
const both = [light(ground), light([120, 126, 132])].sort((a, b) => a - b);
const middle = 4 * ((canvas.height >> 1) * canvas.width + (canvas.width >> 1));
return [data[3], data[middle + 3], letters, both[1] / both[0]];
"""


def check_still(page):
    """Without WebGL a picture has the ground of the page, light or dark or on paper."""
    for features in ({}, {"color_scheme": "dark"}, {"color_scheme": "dark", "media": "print"}):
        page.screen(1400, 900, **features)
        corner, middle, letters, contrast = page.run(STILL)
        demand(corner == 0 and middle == 255, f"the picture covers {corner}, {middle}")
        demand(letters > 100 and contrast > 4, f"{letters} pixels of letters, at {contrast}")
        demand(page.find("#picture").is_displayed(), f"no picture on {features}")
    page.screen(1400, 900)


def check_pictures(page):
    """The view, drawn anew at twice its size with its scales, and charts, both as they look."""
    page.run(SAVED)
    page.run("document.documentElement.dataset.theme = 'dark'; const {selection} = window.report;"
             "selection.colorBy = 'sphericity'; selection.changed('looks')")
    page.settle()
    dark = page.run("return getComputedStyle(document.body).backgroundColor")
    width, height = page.run("const {width, height} = window.report.scene; return [width, height]")
    seen = "return document.getElementById('canvas').width"
    before = page.run(seen)
    page.button("Save as PNG").click()
    page.wait("return window.savedBlob")
    told = page.driver.execute_async_script(
        PICTURE.replace("arguments[1]", "'228,232,236,255'"))
    name = page.run("return window.savedName")
    demand(name == "l_view.png", f"the picture is called {name}")
    demand((told["width"], told["height"]) == (2 * width, 2 * height) and before == width,
           f"a view of {width} x {height} is saved as {told}")
    demand(page.run(seen) == before, "the view stays large")
    demand("rgb(" + ", ".join(told["ground"].split(",")[:3]) + ")" == dark != told["middle"],
           f"the ground is {told['ground']}, that of the page {dark}")
    even, odd = told["starts"]
    demand(0.3 < even / (even + odd) < 0.7, f"pixels are only enlarged: {even}, {odd}")
    demand(told["letters"] > 200, "there is no scale bar in the picture")
    page.run("window.savedBlob = null; window.report.selection.colorBy = '';"
             "window.report.selection.changed('looks')")

    page.find("#charts figure button").click()
    page.wait("return window.savedBlob")
    demand(page.run("return window.savedName") == "l_Diameter_by_number.svg", "the chart's name")
    text = page.run("return window.saved")
    chart = xml.etree.ElementTree.fromstring(text)
    bars, color = page.run(
        "const bars = document.querySelectorAll('#charts figure:first-child rect.shown');"
        "return [bars.length, getComputedStyle(bars[0]).fill]")
    same = [node for node in chart if node.get("fill") == color]
    demand(len(same) == bars > 4 and chart[0].get("fill") == dark,
           f"of {bars} bars there are {len(same)}")
    demand("var(" not in text and "class=" not in text, "the chart needs the page")
    page.run("document.documentElement.dataset.theme = 'light'")
