// SPDX-License-Identifier: GPL-3.0-or-later
// A view: the stage, its controls, mouse and keyboard.

const markup = `
<div class="view-stage">
  <canvas tabindex="0" aria-label="3-D view; arrow keys change frame and level"></canvas>
  <div class="view-info" aria-live="polite"></div>
  <div class="view-legend"><span class="view-legend-title"></span><span class="view-ramp"></span><span class="view-ticks"></span></div>
</div>
<div class="view-controls">
  <label class="view-wide">Frame <button type="button" name="play" title="Play or pause (space)">Play</button><input type="range" name="frame" min="0" step="1" aria-label="Frame"><output name="frame"></output></label>
  <label class="view-wide">Level <input type="range" name="level" min="0" step="1" aria-label="Level"><output name="level"></output></label>
  <label>Method <select name="method"></select></label>
  <label>k-DOP <select name="k"></select></label>
  <label>Colour <select name="measure"><option value="area">surface area</option><option value="volume">volume</option></select></label>
  <label>Surface <select name="surface"><option>solid</option><option>glass</option><option>hidden</option></select></label>
  <label><input type="checkbox" name="bounds"> fast bounds</label>
  <label><input type="checkbox" name="truth"> true bounds</label>
  <label><input type="checkbox" name="nodes"> simulation nodes</label>
  <label><input type="checkbox" name="contacts"> intersecting triangles</label>
</div>
<details class="view-keys"><summary>Mouse and keys</summary>
  <p>Drag turns, the right button (or two fingers) moves, the wheel zooms once the picture was clicked. Keys, once the picture was clicked:</p>
  <ul><li><kbd>←</kbd> <kbd>→</kbd> frame, <kbd>Home</kbd> <kbd>End</kbd> first and last</li><li><kbd>↑</kbd> <kbd>↓</kbd> level</li><li><kbd>space</kbd> play, pause</li>
  <li><kbd>m</kbd> method, <kbd>M</kbd> backwards</li><li><kbd>k</kbd> k-DOP</li><li><kbd>c</kbd> colour by area or volume</li><li><kbd>s</kbd> surface solid, glass, hidden</li>
  <li><kbd>f</kbd> fast bounds</li><li><kbd>t</kbd> true bounds</li><li><kbd>n</kbd> simulation nodes</li><li><kbd>i</kbd> intersecting triangles</li>
  <li><kbd>+</kbd> <kbd>-</kbd> zoom</li><li><kbd>r</kbd> the camera as at first</li></ul>
</details>`;

const grouped = n => n.toLocaleString('en-US');
const counted = (n, one, many) => grouped(n) + ' ' + (n === 1 ? one : many);

class View {
    constructor(section, model) {
        const {data} = model, frame = document.createElement('div');
        frame.innerHTML = markup;
        section.append(...frame.children);
        Object.assign(this, {section, model, canvas: section.querySelector('canvas')});
        this.state = {...data.first, measure: 'area', truth: true, contacts: true};
        this.state.k = model.kdop === 26 ? 6 : model.kdop;
        this.stage = new Stage(this.canvas, model);
        this.control('frame').max = model.frames - 1;
        this.control('level').max = model.levels - 1;
        this.offer('method', model.methods);
        this.offer('k', model.kdops());
        if (!model.nodes.length)
            this.control('nodes').closest('label').remove();
        if (!data.contacts)
            this.control('contacts').closest('label').remove();
        section.querySelector('.view-ramp').style.background = `linear-gradient(to right, ${ramp.join(',')})`;
        this.listen();
        this.update(Object.keys(this.state));
    }

    control(name) { return this.section.querySelector(`.view-controls [name=${name}]`); }

    offer(name, values) {
        for (const value of values)
            this.control(name).append(new Option(name === 'k' && value === 6 ? '6 (box)' : value, value));
    }

    listen() {
        for (const name of ['frame', 'level', 'k'])
            this.control(name).addEventListener('input', e => this.set({[name]: Number(e.target.value)}));
        for (const name of ['method', 'measure', 'surface'])
            this.control(name).addEventListener('input', e => this.set({[name]: e.target.value}));
        for (const name of ['bounds', 'truth', 'nodes', 'contacts'])
            if (this.control(name))
                this.control(name).addEventListener('input', e => this.set({[name]: e.target.checked}));
        this.control('play').addEventListener('click', () => this.play(!this.playing));
        this.section.addEventListener('keydown', e => this.key(e));
        this.canvas.addEventListener('focus', () => { this.stage.controls.enableZoom = true; });
        this.canvas.addEventListener('blur', () => { this.stage.controls.enableZoom = false; });
        new ResizeObserver(() => this.fit()).observe(this.canvas);
    }

    fit() {
        if (this.canvas.clientWidth > 0 && this.canvas.clientHeight > 0)
            this.stage.resize(this.canvas.clientWidth, this.canvas.clientHeight);
    }

    set(changes) {
        const {frames, levels} = this.model;
        if ('frame' in changes)
            changes.frame = Math.min(Math.max(changes.frame, 0), frames - 1);
        if ('level' in changes)
            changes.level = Math.min(Math.max(changes.level, 0), levels - 1);
        const changed = Object.keys(changes).filter(name => changes[name] !== this.state[name]);
        Object.assign(this.state, changes);
        if (changed.length)
            this.update(changed);
    }

    // Brings up to date what depends on the parts of the state that changed.
    update(changed) {
        const {state, stage, model} = this, any = (...names) => names.some(name => changed.includes(name));
        if (any('frame'))
            stage.setFrame(state.frame);
        if (any('frame', 'level', 'method', 'k'))
            this.volumes = model.volumes(state);
        if (any('frame', 'level', 'method', 'k', 'measure'))
            stage.setVolumes(this.volumes, state.measure);
        stage.show(state);
        stage.render();
        this.describe();
    }

    describe() {
        const {state, model, section, volumes} = this, {data} = model;
        for (const name of ['frame', 'level', 'method', 'k', 'measure', 'surface'])
            this.control(name).value = state[name];
        for (const name of ['bounds', 'truth', 'nodes', 'contacts'])
            if (this.control(name))
                this.control(name).checked = state[name];
        this.section.querySelector('output[name=frame]').textContent = `${state.frame + 1} of ${model.frames}, ${data.time_s[state.frame].toFixed(2)} s`;
        this.section.querySelector('output[name=level]').textContent = `${state.level}: ${counted(volumes.length, 'BV', 'BVs')}`;
        const ratios = volumes.map(v => v[state.measure]).filter(r => r !== null), open = volumes.filter(v => !v.bound).length;
        const measure = state.measure === 'area' ? 'surface area' : 'volume';
        const lines = [`${state.method}, ${state.k === 6 ? 'boxes' : `${state.k}-DOPs`}, level ${state.level}`];
        if (ratios.length)
            lines.push(`${measure} of fast / true bounds: ${(ratios.reduce((a, b) => a + b, 0) / ratios.length).toFixed(3)}` +
                       (ratios.length > 1 ? ` on average, ${Math.max(...ratios).toFixed(3)} at most` : ''));
        if (open)
            lines.push(`${counted(open, 'BV has', 'BVs have')} no finite bound`);
        if (data.contacts)
            lines.push(`${counted(data.contacts.pairs[state.frame], 'pair', 'pairs')} of intersecting triangles`);
        const info = section.querySelector('.view-info');
        info.textContent = lines.join('\n');
        section.querySelector('.view-legend').hidden = !state.bounds;
        section.querySelector('.view-legend-title').textContent = `fast / true ${measure}`;
        section.querySelector('.view-ticks').innerHTML = [1, 2, 4, loosest].map(r => `<i>${r}${r === loosest ? '+' : ''}</i>`).join('');
    }

    play(on) {
        this.playing = on;
        this.control('play').textContent = on ? 'Pause' : 'Play';
        const {time_s} = this.model.data, length = time_s[time_s.length - 1] - time_s[0];
        const pause = Math.min(Math.max(1000 * length / this.model.frames, 1000 / 30), 200) || 1000 / 20;
        let last = -Infinity;
        const step = now => {
            if (!this.playing)
                return;
            if (now - last >= pause - 4) { // repaints come every 16 ms or so
                last = now;
                this.set({frame: (this.state.frame + 1) % this.model.frames});
            }
            requestAnimationFrame(step);
        };
        if (on)
            requestAnimationFrame(step);
    }

    cycle(name, by = 1) {
        const options = [...this.control(name).options], i = options.findIndex(o => o.value === String(this.state[name]));
        const {value} = options[(i + by + options.length) % options.length];
        this.set({[name]: name === 'k' ? Number(value) : value});
    }

    zoom(by) {
        this.stage.camera.position.sub(this.stage.controls.target).multiplyScalar(by).add(this.stage.controls.target);
        this.stage.controls.update();
        this.stage.render();
    }

    key(event) {
        const {state} = this, target = event.target;
        if (event.ctrlKey || event.altKey || event.metaKey || target.tagName === 'SELECT')
            return;
        if (event.key === ' ' && target !== this.canvas && target.type !== 'range') // presses what has the focus
            return;
        if (target.type === 'range' && /^(Arrow|Home$|End$|Page)/.test(event.key)) // moves the slider that has it
            return;
        const toggle = name => () => { if (this.control(name)) this.set({[name]: !state[name]}); };
        const action = {
            ArrowLeft: () => this.set({frame: state.frame - 1}), ArrowRight: () => this.set({frame: state.frame + 1}),
            ArrowUp: () => this.set({level: state.level + 1}), ArrowDown: () => this.set({level: state.level - 1}),
            Home: () => this.set({frame: 0}), End: () => this.set({frame: Infinity}),
            ' ': () => this.play(!this.playing), m: () => this.cycle('method'), M: () => this.cycle('method', -1),
            k: () => this.cycle('k'), c: () => this.cycle('measure'), s: () => this.cycle('surface'),
            f: toggle('bounds'), t: toggle('truth'), n: toggle('nodes'), i: toggle('contacts'),
            '+': () => this.zoom(1 / 1.15), '-': () => this.zoom(1.15), r: () => { this.stage.lookFrom(this.model.data.first); this.stage.render(); },
        }[event.key];
        if (!action)
            return;
        event.preventDefault();
        action();
    }
}

function note(section, text) {
    const p = document.createElement('p');
    p.className = 'view-note';
    p.textContent = text;
    section.append(p);
}

async function start(section) {
    if (section.dataset.state)
        return;
    section.dataset.state = 'loading';
    const probe = document.createElement('canvas');
    const context = probe.getContext('webgl2') || probe.getContext('webgl');
    if (!context)
        note(section, 'The 3-D view needs WebGL, which this browser does not have, or has switched off.');
    else if (typeof DecompressionStream === 'undefined')
        note(section, 'The 3-D view needs a browser of 2023 or later (it has no DecompressionStream).');
    if (context && context.getExtension('WEBGL_lose_context'))
        context.getExtension('WEBGL_lose_context').loseContext(); // browsers allow few at a time
    if (!context || typeof DecompressionStream === 'undefined') {
        section.dataset.state = 'unsupported';
        return;
    }
    const view = new View(section, await Model.from(JSON.parse(section.querySelector('script').textContent)));
    view.fit();
    section.dataset.state = 'ready';
}

// Views begin when they are about to be seen.
const watch = new IntersectionObserver(entries => entries.filter(e => e.isIntersecting).forEach(e => start(e.target)), {rootMargin: '300px'});
document.querySelectorAll('section.view').forEach(section => watch.observe(section));
