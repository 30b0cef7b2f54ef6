// The canvas of solids: levels as three.js draws them, one or two of them, alone, side by side or one over the other.

const SLOW_FRAME = 60;        // ms; meshes that take longer are drawn as drafts while a hand moves them
const DRAFT_TRIANGLES = 4e5;  // smaller ones are never worth a draft

const isLarge = (level) => level.triangles > DRAFT_TRIANGLES;

class SolidStage {
    constructor(canvas, levels) {
        this.levels = levels;
        this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
        this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
        this.renderer.autoClear = false;
        this.scene = new THREE.Scene();
        this.cameras = {
            perspective: new THREE.PerspectiveCamera(FIELD_OF_VIEW), parallel: new THREE.OrthographicCamera(-1, 1, 1, -1),
        };
        const colours = distanceTexture();
        this.roles = { a: this.materials(colours), b: this.materials(colours) };
        this.roles.b.surface.transparent = true;
        this.loaded = new Map();
        this.unpacked = new Map();  // levels on their way to `loaded`: drawn as drafts, since normals take as long as all before
        this.boxOfLevels();
    }
    materials(colours) {
        return { surface: surfaceMaterial(colours), wire: wireMaterial() };
    }

    // centre: what positions are relative to, so that float32 has digits enough; low, high: the box around all levels.
    boxOfLevels() {
        const each = (key, pick) => [0, 1, 2].map((axis) => pick(...this.levels.map((level) => level[key][axis])));
        this.low = each("low", Math.min);
        this.high = each("high", Math.max);
        this.centre = this.low.map((x, axis) => (x + this.high[axis]) / 2);
        this.radius = Math.hypot(...this.high.map((x, axis) => x - this.low[axis])) / 2 || 1;
    }

    async load(index) {
        if (this.loaded.has(index)) return this.loaded.get(index);
        const shown = await this.unpack(index);
        shown.surface = this.surface(shown.mesh);
        this.loaded.set(index, shown);
        this.unpacked.delete(index);
        return shown;
    }
    async unpack(index) {
        if (this.unpacked.has(index)) return this.unpacked.get(index);
        const level = this.levels[index];
        const { lattice, triangles } = unpackedMesh(await inflated(`mesh${index}`), level.vertices, level.triangles);
        const positions = new Float32Array(lattice.length);
        for (let i = 0; i < lattice.length; ++i)
            positions[i] = level.low[i % 3] - this.centre[i % 3] + level.step * lattice[i];
        const distances = level.distance ? unpackedValues(await inflated(`distance${index}`)) : new Uint16Array(level.vertices);
        const mesh = { positions, triangles, distances };
        const shown = { mesh, lattice, surface: null, wire: null, draft: null, milliseconds: null, again: false };
        this.unpacked.set(index, shown);
        return shown;
    }
    surface(mesh) {
        const surface = new THREE.Mesh(geometryOf(mesh), this.roles.a.surface);
        surface.frustumCulled = surface.visible = false;
        this.scene.add(surface);
        return surface;
    }
    wireOf(shown, index) {
        if (shown.wire) return shown.wire;
        const geometry = new THREE.BufferGeometry();
        for (const name of ["position", "normal"]) geometry.setAttribute(name, shown.surface.geometry.getAttribute(name));
        const closed = this.levels[index].facts.closed === true;
        geometry.setIndex(new THREE.BufferAttribute(edgesOf(shown.mesh, closed), 1));
        shown.wire = new THREE.LineSegments(geometry, this.roles.a.wire);
        shown.wire.frustumCulled = shown.wire.visible = false;
        this.scene.add(shown.wire);
        return shown.wire;
    }
    draftOf(shown) {
        shown.draft = shown.draft || this.surface(draftOf(shown.mesh, shown.lattice));
        return shown.draft;
    }

    resize(width, height) {
        this.renderer.setSize(width, height, false);
        this.size = [width, height];
    }

    // Rectangles from the left and the top, in CSS pixels, each with what is drawn in it.
    panes(state) {
        const [width, height] = this.size;
        const both = [{ index: state.a, role: "a" }, { index: state.b, role: "b" }];
        const over = state.mode === "overlay" && state.a !== state.b;
        if (state.mode !== "side") return [{ left: 0, top: 0, width, height, shows: over ? both : [both[0]] }];
        const beside = width >= height;
        return both.map((one, i) => ({
            left: beside ? (i * width) / 2 : 0, top: beside ? 0 : (i * height) / 2,
            width: beside ? width / 2 : width, height: beside ? height : height / 2, shows: [{ ...one, role: "a" }],
        }));
    }

    placeCamera(state, orbit, pane) {
        const camera = state.parallel ? this.cameras.parallel : this.cameras.perspective;
        const { up, back } = orbit.axes(), aspect = pane.width / pane.height;
        const away = orbit.height / 2 / Math.tan((FIELD_OF_VIEW * Math.PI) / 360);
        const distance = state.parallel ? 4 * this.radius + orbit.height : away;
        if (state.parallel) {
            camera.top = orbit.height / 2;
            camera.bottom = -camera.top;
            camera.right = camera.top * aspect;
            camera.left = -camera.right;
        } else camera.aspect = aspect;
        const reach = this.radius + Math.hypot(...orbit.target);
        camera.near = Math.max(distance - 1.2 * reach, distance / 500);
        camera.far = distance + 1.2 * reach;
        camera.position.set(...orbit.target.map((x, k) => x + distance * back[k]));
        camera.up.set(...up);
        camera.lookAt(...orbit.target);
        camera.updateProjectionMatrix();
        return camera;
    }

    dress(state, look) {
        const plane = this.cutPlane(state);
        for (const [name, { surface, wire }] of Object.entries(this.roles)) {
            const second = name === "b";
            const set = (material, values) => {
                for (const [key, value] of Object.entries(values)) material.uniforms[key].value = value;
            };
            const colour = new THREE.Color(second ? look.second : look.solid);
            set(surface, { albedo: colour, section: new THREE.Color(look.section), cuts: state.cut.on, cut: plane,
                crease: state.flat ? 2 : CREASE_COSINE, opacity: second ? 0.38 : 1 });
            surface.depthWrite = !second;
            set(wire, { albedo: new THREE.Color(second ? look.second : look.wire), cuts: state.cut.on, cut: plane,
                opacity: second ? 0.5 : look.wireOpacity });
        }
    }
    cutPlane(state) {
        const { axis, at, flip } = state.cut, normal = [0, 0, 0], sign = flip ? -1 : 1;
        normal[axis] = sign;
        const place = this.low[axis] + at * (this.high[axis] - this.low[axis]) - this.centre[axis];
        return new THREE.Vector4(...normal, sign * place);
    }

    // Each level's distances are stored as shares of its own maximum; state.range is in world units.
    draw(state, orbit, look, moving) {
        const { renderer, scene } = this;
        renderer.setClearColor(look.ground);
        renderer.setScissorTest(false);
        renderer.clear();
        renderer.setScissorTest(true);
        this.dress(state, look);
        const start = performance.now(), timed = [];
        for (const pane of this.panes(state)) {
            for (const object of scene.children) object.visible = false;
            for (const { index, role } of pane.shows) this.show(index, role, state, moving, timed);
            const bottom = this.size[1] - pane.top - pane.height;
            renderer.setViewport(pane.left, bottom, pane.width, pane.height);
            renderer.setScissor(pane.left, bottom, pane.width, pane.height);
            renderer.render(scene, this.placeCamera(state, orbit, pane));
        }
        if (timed.length > 0) this.measure(start, timed);
    }
    show(index, role, state, moving, timed) {
        const shown = this.loaded.get(index) || this.unpacked.get(index);
        if (!shown || (!shown.surface && !isLarge(this.levels[index]))) return;
        const slow = !shown.surface || (moving && shown.milliseconds > SLOW_FRAME && isLarge(this.levels[index]));
        const surface = slow ? this.draftOf(shown) : shown.surface, level = this.levels[index];
        if (!slow && (shown.milliseconds === null || shown.again)) timed.push(shown);
        surface.material = this.roles[role].surface;
        surface.visible = true;
        surface.renderOrder = role === "b" ? 1 : 0;
        const coloured = state.colours && role === "a";
        const range = level.distance && level.distance.max > 0 ? Math.max(state.range, 1e-12) / level.distance.max : 1;
        const closed = level.facts.closed === true;
        surface.onBeforeRender = (r, s, c, g, material) => {
            Object.entries({ coloured, range, closed }).forEach(([key, value]) => (material.uniforms[key].value = value));
            material.uniformsNeedUpdate = true;
        };
        if (!state.wire || slow) return;
        const wire = this.wireOf(shown, index);
        wire.material = this.roles[role].wire;
        wire.visible = true;
    }
    // A pixel that is read back waits for the picture.
    waitForPicture() {
        const gl = this.renderer.getContext();
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    }
    measure(start, timed) {
        this.waitForPicture();
        const took = performance.now() - start;
        for (const shown of timed) {
            // The first one has the transfer of the buffers in it: where it is neither short nor hopeless, once more.
            shown.again = shown.milliseconds === null && took > SLOW_FRAME && took < 2000;
            shown.milliseconds = Math.min(took, shown.milliseconds ?? took);
        }
    }
    get wantsToMeasureAgain() {
        return [...this.loaded.values()].some((shown) => shown.again && shown.surface.visible);
    }
    get slowest() {
        return Math.max(0, ...[...this.loaded.values()].map((shown) => shown.milliseconds || 0));
    }

    // Of the picture that holds all, as it is turned.
    fitHeight(orbit, pane) {
        const size = this.high.map((x, k) => x - this.low[k]), { right, up } = orbit.axes();
        const extent = (axis) => size.reduce((sum, x, k) => sum + x * Math.abs(axis[k]), 0);
        return 1.18 * Math.max(extent(up), (extent(right) * pane.height) / pane.width, this.radius * 0.2);
    }
    stl(index, title) {
        return stlOf(this.loaded.get(index).mesh, this.centre, title);
    }
}
