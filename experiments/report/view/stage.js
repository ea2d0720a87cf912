// SPDX-License-Identifier: GPL-3.0-or-later
// What is on the canvas, by three.js. Everything stands in a group that takes the grid to about unit size, z up.

const fieldOfView = 18; // degrees
const palette = [0xe3cdb9, 0xb9cfe3, 0xcfe0b8, 0xe6c3cb, 0xd3c6e4, 0xe7dca9];

// Looseness as colour: from 1 to `loosest`, on a logarithmic scale; beyond, the last.
const loosest = 8;
const ramp = ['#1662a8', '#189a98', '#74ad3a', '#e5a50a', '#dd5f1c', '#9a1038'];
const unknownColour = '#8a8f98';

function colourOf(ratio) {
    if (ratio === null)
        return new THREE.Color(unknownColour);
    const at = Math.min(Math.max(Math.log(ratio) / Math.log(loosest), 0), 1) * (ramp.length - 1), i = Math.min(Math.floor(at), ramp.length - 2);
    return new THREE.Color(ramp[i]).lerp(new THREE.Color(ramp[i + 1]), at - i);
}

// Normals of all vertices, as the mean of their triangles' weighted by area.
function normals(positions, corners, out) {
    out.fill(0);
    for (let i = 0; i < corners.length; i += 3) {
        const a = 3 * corners[i], b = 3 * corners[i + 1], c = 3 * corners[i + 2];
        const ux = positions[b] - positions[a], uy = positions[b + 1] - positions[a + 1], uz = positions[b + 2] - positions[a + 2];
        const vx = positions[c] - positions[a], vy = positions[c + 1] - positions[a + 1], vz = positions[c + 2] - positions[a + 2];
        const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
        for (const at of [a, b, c]) {
            out[at] += x;
            out[at + 1] += y;
            out[at + 2] += z;
        }
    }
    for (let i = 0; i < out.length; i += 3) {
        const length = Math.sqrt(out[i] * out[i] + out[i + 1] * out[i + 1] + out[i + 2] * out[i + 2]) || 1;
        out[i] /= length;
        out[i + 1] /= length;
        out[i + 2] /= length;
    }
}

// Edges of polytopes as pairs of points, each once: an edge runs both ways along the two faces that share it.
function edges(faces) {
    const out = [];
    for (const face of faces)
        face.forEach((p, i) => {
            const q = face[(i + 1) % face.length];
            if (p[0] < q[0] || (p[0] === q[0] && (p[1] < q[1] || (p[1] === q[1] && p[2] < q[2]))))
                out.push(...p, ...q);
        });
    return out;
}

class Stage {
    constructor(canvas, model) {
        this.model = model;
        this.renderer = new THREE.WebGLRenderer({canvas, antialias: true});
        this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
        this.renderer.setClearColor(0xf6f7f9);
        this.scene = new THREE.Scene();
        this.camera = new THREE.PerspectiveCamera(fieldOfView, 1, 0.01, 100);
        this.camera.up.set(0, 0, 1);
        const sun = new THREE.DirectionalLight(0xffffff, 0.6);
        sun.position.set(-0.6, 0.9, 1);
        this.camera.add(sun);
        this.scene.add(this.camera, new THREE.HemisphereLight(0xffffff, 0x9a958e, 0.62));

        // What is shown first, in the middle and about 1 in size.
        this.first = model.extent(model.data.first);
        const {low, high} = this.first, size = Math.hypot(...minus(high, low)) || 1;
        this.grid = new THREE.Group();
        this.grid.scale.setScalar(1 / size);
        this.grid.position.set(...low.map((x, r) => -(x + high[r]) / 2 / size));
        const upright = new THREE.Group();
        if (model.data.up === 'y')
            upright.rotation.set(Math.PI / 2, Math.PI, 0); // y up, and what faces z faces the first look
        upright.add(this.grid);
        this.scene.add(upright);
        this.addSurface();
        this.addNodes();
        this.addBounds();
        this.controls = new THREE.OrbitControls(this.camera, canvas);
        this.controls.enableKeys = false; // view.js has them
        this.controls.enableZoom = false; // until the canvas has the focus: the page scrolls
        this.controls.addEventListener('change', () => this.render());
        this.lookFrom(model.data.first);
    }

    // From so far that the box of the first picture fits.
    lookFrom({azimuth, elevation}) {
        const a = azimuth * Math.PI / 180, e = elevation * Math.PI / 180, tangent = Math.tan(fieldOfView / 2 * Math.PI / 180), {low, high} = this.first;
        const shown = this.model.data.up === 'y' ? [0, 2, 1] : [0, 1, 2], extent = shown.map(r => high[r] - low[r]);
        const towards = [Math.cos(a) * Math.cos(e), Math.sin(a) * Math.cos(e), Math.sin(e)], right = [-Math.sin(a), Math.cos(a), 0], up = cross(towards, right);
        let distance = 0;
        for (let i = 0; i < 8; ++i) {
            const corner = [0, 1, 2].map(r => 0.52 * (i >> r & 1 ? 1 : -1) * extent[r] * this.grid.scale.x);
            distance = Math.max(distance, dot(corner, towards) + Math.max(Math.abs(dot(corner, right)) / 1.6, Math.abs(dot(corner, up))) / tangent);
        }
        this.controls.target.set(0, 0, 0);
        this.camera.position.set(...towards).multiplyScalar(distance || 2);
        this.controls.update();
    }

    addSurface() {
        const {model} = this, geometry = new THREE.BufferGeometry(), colours = new Uint8Array(3 * model.vertices);
        let first = 0;
        model.data.bodies.forEach((body, b) => {
            const colour = new THREE.Color(palette[b % palette.length]).toArray().map(x => Math.round(255 * x));
            for (let v = first; v < first + body.vertices; ++v)
                colours.set(colour, 3 * v);
            first += body.vertices;
        });
        geometry.setIndex(new THREE.BufferAttribute(model.corners, 1));
        geometry.setAttribute('position', new THREE.BufferAttribute(new Uint16Array(3 * model.vertices), 3));
        geometry.setAttribute('normal', new THREE.BufferAttribute(new Float32Array(3 * model.vertices), 3));
        geometry.setAttribute('color', new THREE.BufferAttribute(colours, 3, true));
        this.surface = new THREE.Mesh(geometry, new THREE.MeshPhongMaterial({vertexColors: THREE.VertexColors, specular: 0x1c1c1c, shininess: 24}));
        const touching = new THREE.BufferGeometry();
        touching.setAttribute('position', geometry.getAttribute('position'));
        touching.setAttribute('normal', geometry.getAttribute('normal'));
        this.touching = new THREE.Mesh(touching, new THREE.MeshPhongMaterial(
            {color: 0xe3001b, emissive: 0x500008, specular: 0x111111, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -2}));
        this.behind = new THREE.Mesh(touching, new THREE.MeshBasicMaterial({color: 0xe3001b, transparent: true, opacity: 0.3, depthTest: false, side: THREE.DoubleSide}));
        this.behind.renderOrder = 1; // what other triangles hide shines through
        for (const mesh of [this.surface, this.touching, this.behind]) {
            mesh.frustumCulled = false;
            this.grid.add(mesh);
        }
    }

    addNodes() {
        const material = new THREE.ShaderMaterial({
            uniforms: {size: {value: 6 * this.renderer.getPixelRatio()}},
            vertexShader: 'uniform float size; void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); gl_PointSize = size; }',
            fragmentShader: `void main() {
                float r = 2.0 * length(gl_PointCoord - vec2(0.5));
                if (r > 1.0) discard;
                gl_FragColor = vec4(mix(vec3(0.10, 0.32, 0.62), vec3(1.0), smoothstep(0.68, 0.78, r)), 1.0);
            }`});
        this.nodes = new THREE.Points(new THREE.BufferGeometry(), material);
        this.nodes.frustumCulled = false;
        this.grid.add(this.nodes);
    }

    addBounds() {
        this.faces = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshBasicMaterial(
            {vertexColors: THREE.VertexColors, transparent: true, opacity: 0.1, side: THREE.DoubleSide, depthWrite: false}));
        this.boundEdges = new THREE.LineSegments2(new THREE.LineSegmentsGeometry(), new THREE.LineMaterial({vertexColors: THREE.VertexColors, linewidth: 2.2}));
        this.trueEdges = new THREE.LineSegments2(new THREE.LineSegmentsGeometry(), new THREE.LineMaterial({color: 0x22262e, linewidth: 1.4}));
        this.faces.renderOrder = 2;
        for (const object of [this.faces, this.boundEdges, this.trueEdges]) {
            object.frustumCulled = false;
            this.grid.add(object);
        }
    }

    setFrame(frame) {
        const {model} = this, positions = model.positionsOf(frame), geometry = this.surface.geometry;
        geometry.getAttribute('position').array.set(positions);
        normals(positions, model.corners, geometry.getAttribute('normal').array);
        geometry.getAttribute('position').needsUpdate = true;
        geometry.getAttribute('normal').needsUpdate = true;
        const corners = [];
        for (const t of model.touchingOf(frame))
            corners.push(model.corners[3 * t], model.corners[3 * t + 1], model.corners[3 * t + 2]);
        this.touching.geometry.setIndex(corners.length ? corners : [0, 0, 0]);
        this.nodes.geometry.setAttribute('position', new THREE.BufferAttribute(Float32Array.from(model.nodesOf(frame)), 3));
    }

    // Volumes as Model.volumes() has them, coloured by 'area' or 'volume'.
    setVolumes(volumes, measure) {
        const points = [], colours = [], lines = [], lineColours = [], thin = [];
        for (const v of volumes) {
            thin.push(...edges(v.truth));
            if (!v.bound)
                continue;
            const colour = colourOf(v[measure]).toArray();
            for (const face of v.bound)
                for (let i = 2; i < face.length; ++i) {
                    points.push(...face[0], ...face[i - 1], ...face[i]);
                    colours.push(...colour, ...colour, ...colour);
                }
            const own = edges(v.bound);
            lines.push(...own);
            for (let i = 0; i < own.length; i += 3)
                lineColours.push(...colour);
        }
        this.faces.geometry.dispose();
        this.faces.geometry = new THREE.BufferGeometry();
        this.faces.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(points), 3));
        this.faces.geometry.setAttribute('color', new THREE.BufferAttribute(new Float32Array(colours), 3));
        this.faces.material.opacity = 0.1 / (1 + volumes.length / 24);
        const replace = (object, positions, colors) => {
            object.geometry.dispose();
            object.geometry = new THREE.LineSegmentsGeometry();
            object.geometry.setPositions(positions.length ? positions : [0, 0, 0, 0, 0, 0]);
            if (colors)
                object.geometry.setColors(colors.length ? colors : [0, 0, 0, 0, 0, 0]);
        };
        replace(this.boundEdges, lines, lineColours);
        replace(this.trueEdges, thin);
        const crowded = Math.min(1, volumes.length / 64);
        this.boundEdges.material.linewidth = 2.2 - crowded;
        this.trueEdges.material.linewidth = 1.4 - 0.6 * crowded;
    }

    show({surface, nodes, bounds, truth, contacts}) {
        const glass = surface === 'glass', material = this.surface.material;
        this.surface.visible = surface !== 'hidden';
        material.transparent = glass;
        material.opacity = glass ? 0.38 : 1;
        material.needsUpdate = true;
        this.nodes.visible = nodes;
        this.faces.visible = this.boundEdges.visible = bounds;
        this.trueEdges.visible = truth;
        this.touching.visible = this.behind.visible = contacts;
    }

    resize(width, height) {
        this.renderer.setSize(width, height, false);
        this.camera.aspect = width / height;
        this.camera.fov = width < height ? 2 * Math.atan(Math.tan(fieldOfView / 2 * Math.PI / 180) * height / width) * 180 / Math.PI : fieldOfView;
        this.camera.updateProjectionMatrix();
        for (const object of [this.boundEdges, this.trueEdges])
            object.material.resolution.set(width, height);
        this.render();
    }

    // Once before the next repaint, however often it is asked for.
    render() {
        if (this.waiting)
            return;
        this.waiting = true;
        requestAnimationFrame(() => {
            this.waiting = false;
            this.renderer.render(this.scene, this.camera);
        });
    }
}
