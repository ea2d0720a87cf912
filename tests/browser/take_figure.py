#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""take_figure.py PAGE.html FIGURE.png

Fig. 1 from a page of 'cinch view brain-pull': at rest with its box; pulled, with its simulation nodes; the bound around
the true box."""
import base64
import pathlib
import re
import sys
import time

from browser import Browser

SET = """const view = document.querySelector('section.view'), [values] = arguments;
for (const [name, value] of Object.entries(values)) {
    const control = view.querySelector(`.view-controls [name=${name}]`);
    if (typeof value === 'boolean')
        control.checked = value;
    else
        control.value = value;
    control.dispatchEvent(new Event('input', {bubbles: true}));
}
return view.querySelector('.view-info').textContent"""

# Every panel in the middle of its place, all at the same scale.
COMPOSE = """const [panels, labels, width, height, done] = arguments, strip = 54;
const canvas = Object.assign(document.createElement('canvas'), {width: panels.length * width, height: height + strip});
const c = canvas.getContext('2d');
c.fillStyle = '#f6f7f9';
c.fillRect(0, 0, canvas.width, canvas.height);
c.imageSmoothingQuality = 'high';
c.textAlign = 'center';

function drawn(image) { // the box of what is no background
    const copy = Object.assign(document.createElement('canvas'), {width: image.width, height: image.height});
    const d = copy.getContext('2d');
    d.drawImage(image, 0, 0);
    const {data} = d.getImageData(0, 0, image.width, image.height);
    const box = {left: image.width, right: 0, top: image.height, bottom: 0};
    for (let i = 0; i < data.length; i += 4)
        if (Math.abs(data[i] - 246) + Math.abs(data[i + 1] - 247) + Math.abs(data[i + 2] - 249) > 12) {
            const x = i / 4 % image.width, y = Math.floor(i / 4 / image.width);
            if (Math.min(x, y, image.width - x, image.height - y) < 16) // the frame
                continue;
            box.left = Math.min(box.left, x); box.right = Math.max(box.right, x);
            box.top = Math.min(box.top, y); box.bottom = Math.max(box.bottom, y);
        }
    return box;
}
(async () => {
    const images = [];
    for (const data of panels) {
        const image = new Image();
        image.src = 'data:image/png;base64,' + data;
        await image.decode();
        images.push({image, box: drawn(image)});
    }
    const scale = Math.max(...images.map(({box}) =>
        Math.max((box.right - box.left) / (width - 16), (box.bottom - box.top) / (height - 16))));
    images.forEach(({image, box}, i) => {
        const x = (box.left + box.right - scale * width) / 2, y = (box.top + box.bottom - scale * height) / 2;
        c.drawImage(image, x, y, scale * width, scale * height, i * width, 0, width, height);
        c.fillStyle = '#22262e';
        labels[i].forEach((text, line) => {
            c.font = `${line ? 14 : '600 15'}px "Liberation Sans", "DejaVu Sans", sans-serif`;
            c.fillText(text, (i + 0.5) * width, height + 20 + 20 * line);
        });
    });
    done(canvas.toDataURL('image/png').split(',')[1]);
})()"""


def main(page, figure):
    with Browser(1100, 1000, scale=2) as browser:
        browser.open(page)
        browser.wait("return document.querySelector('section.view').dataset.state === 'ready'")
        browser.run("const s = document.createElement('style'); s.textContent = '.view-info, .view-legend {"
                    " visibility: hidden } canvas:focus-visible { outline: none !important }';"
                    "document.head.append(s)")

        frames = browser.run("return Number(document.querySelector('[name=frame]').max)")
        browser.click("section.view canvas")
        browser.keys("-" * 5)
        pulled = round(0.6 * frames)

        def panel(**values):
            said = browser.run(SET, values)
            browser.settle()
            time.sleep(0.3)
            return base64.b64encode(browser.picture("section.view canvas")).decode(), said

        rest, _ = panel(level=0, method="best", k=6, frame=0, surface="solid", bounds=False, truth=True, nodes=False)
        nodes, _ = panel(frame=pulled, surface="glass", truth=False, nodes=True)
        both, said = panel(surface="solid", bounds=True, truth=True, nodes=False)
        ratio = re.search(r"bounds: ([0-9.]+)", said).group(1)
        labels = [["At rest, in its box", "30,000 vertices"],
                  ["Pulled: its simulation nodes", "509 nodes move all vertices"],
                  ["The bound, in time linear in the nodes",
                   f"around the true box: {float(ratio):.2f} times its surface area"]]
        made = browser.call("POST", "/execute/async",
                            {"script": COMPOSE, "args": [[rest, nodes, both], labels, 390, 334]})
        pathlib.Path(figure).write_bytes(base64.b64decode(made))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
