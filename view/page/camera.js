// Where one looks from, and how mouse, fingers and keys change it. A turntable: z stays up.
//
//   target     the point in the middle of the picture
//   height     of the picture at the target, world units: zooming changes it, in perspective and without
//   azimuth    radians about z; 0 looks along +y, from the front of a patient
//   elevation  radians above the plane z = 0

const FIELD_OF_VIEW = 24;  // degrees; small, so that sizes compare
const MOST_ELEVATION = Math.PI / 2 - 1e-4;

class Orbit {
    constructor(changed) {
        this.changed = changed;
        this.target = [0, 0, 0];
        this.height = 1;
        this.azimuth = 0;
        this.elevation = 0;
        this.goal = null;  // of a turn that is under way
        this.speed = [0, 0];
    }

    // The unit vectors to the right, up, and from the target to the eye.
    axes() {
        const ca = Math.cos(this.azimuth), sa = Math.sin(this.azimuth);
        const ce = Math.cos(this.elevation), se = Math.sin(this.elevation);
        return { right: [ca, sa, 0], up: [-sa * se, ca * se, ce], back: [sa * ce, -ca * ce, se] };
    }

    // dx, dy: part of the picture's height.
    turn(dx, dy) {
        this.azimuth -= dx * Math.PI;
        this.elevation = Math.min(Math.max(this.elevation + dy * Math.PI, -MOST_ELEVATION), MOST_ELEVATION);
        this.changed();
    }
    pan(dx, dy) {
        const { right, up } = this.axes();
        for (let k = 0; k < 3; ++k) this.target[k] -= (dx * right[k] - dy * up[k]) * this.height;
        this.changed();
    }
    // (x, y): what stays where it is, in heights from the middle of the picture.
    zoom(factor, x = 0, y = 0) {
        const { right, up } = this.axes();
        const grown = this.height * (1 - factor);
        for (let k = 0; k < 3; ++k) this.target[k] += (x * right[k] - y * up[k]) * grown;
        this.height *= factor;
        this.changed();
    }
    turnTo(azimuth, elevation) {
        const turns = Math.round((this.azimuth - azimuth) / (2 * Math.PI));
        this.goal = [azimuth + 2 * Math.PI * turns, elevation];
        this.changed();
    }

    // What goes on without a hand: a turn to a goal, and the swing after a drag. True while something moves.
    tick(seconds) {
        if (this.goal) {
            const part = 1 - Math.exp(-12 * seconds);
            const left = [this.goal[0] - this.azimuth, this.goal[1] - this.elevation];
            const there = Math.hypot(...left) < 1e-3;
            this.azimuth += left[0] * (there ? 1 : part);
            this.elevation += left[1] * (there ? 1 : part);
            if (there) this.goal = null;
            return true;
        }
        if (Math.hypot(...this.speed) < 0.02) return false;
        this.turn(this.speed[0] * seconds, this.speed[1] * seconds);
        const kept = Math.exp(-7 * seconds);
        this.speed = this.speed.map((v) => v * kept);
        return true;
    }
}

// Pointers on `element` -> the orbit (turn: false, for planes, where every drag pans). paneOf(x, y): the rectangle that the
// place lies in.
class Hands {
    constructor(element, orbit, paneOf, turns) {
        Object.assign(this, { element, orbit, paneOf, turns, pointers: new Map(), last: 0 });
        element.addEventListener("pointerdown", (e) => this.down(e));
        element.addEventListener("pointermove", (e) => this.move(e));
        for (const end of ["pointerup", "pointercancel"]) element.addEventListener(end, (e) => this.up(e));
        element.addEventListener("wheel", (e) => this.wheel(e), { passive: false });
        element.addEventListener("contextmenu", (e) => e.preventDefault());
    }
    get busy() {
        return this.pointers.size > 0;
    }

    down(e) {
        this.element.setPointerCapture(e.pointerId);
        this.pointers.set(e.pointerId, [e.clientX, e.clientY]);
        this.orbit.speed = [0, 0];
        this.orbit.goal = null;
        this.last = e.timeStamp;
    }
    move(e) {
        const before = this.pointers.get(e.pointerId);
        if (!before) return;
        const now = [e.clientX, e.clientY];
        if (this.pointers.size === 1) this.drag(e, before, now);
        else this.pinch(e.pointerId, before, now);
        this.pointers.set(e.pointerId, now);
    }
    drag(e, before, now) {
        const height = this.paneOf(...now).height;
        const dx = (now[0] - before[0]) / height, dy = (now[1] - before[1]) / height;
        if (!this.turns || e.shiftKey || e.buttons & 6) return this.orbit.pan(dx, dy);
        this.orbit.turn(dx, dy);
        const seconds = Math.max((e.timeStamp - this.last) / 1000, 0.004);
        this.last = e.timeStamp;
        this.orbit.speed = [dx, dy].map((d, k) => 0.6 * this.orbit.speed[k] + (0.4 * d) / seconds);
    }
    // The other finger stays; the middle moves by half, the distance says the zoom.
    pinch(id, before, now) {
        const other = [...this.pointers].find(([key]) => key !== id)[1];
        const { height } = this.paneOf(...now);
        this.orbit.pan((now[0] - before[0]) / 2 / height, (now[1] - before[1]) / 2 / height);
        const length = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
        const middle = this.inPane((now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
        if (length(now) > 0) this.orbit.zoom(length(before) / length(now), ...middle);
        this.orbit.speed = [0, 0];
    }
    up(e) {
        this.pointers.delete(e.pointerId);
        if (e.timeStamp - this.last > 60) this.orbit.speed = [0, 0];
        this.orbit.changed();
    }
    wheel(e) {
        e.preventDefault();
        const pixels = e.deltaY * (e.deltaMode === 1 ? 16 : 1);
        this.orbit.zoom(Math.exp(Math.min(Math.max(pixels, -240), 240) * 0.0016), ...this.inPane(e.clientX, e.clientY));
    }
    inPane(x, y) {
        const pane = this.paneOf(x, y);
        return [(x - pane.left - pane.width / 2) / pane.height, (y - pane.top - pane.height / 2) / pane.height];
    }
}
