// The canvas of planar curves: the same face as SolidStage, drawn by the browser's own two-dimensional canvas.

const MOST_DOTS = 20000;     // points that are shown as such
const COLOUR_CLASSES = 24;   // of distances along a curve

class PlaneStage {
    constructor(canvas, levels, yUp) {
        this.canvas = canvas;
        this.context = canvas.getContext("2d");
        this.levels = levels;
        this.up = yUp ? 1 : -1;
        this.loaded = new Map();
        this.slowest = 0;
        const each = (key, pick) => [0, 1].map((axis) => pick(...levels.map((level) => level[key][axis])));
        this.low = each("low", Math.min);
        this.high = each("high", Math.max);
        this.centre = this.low.map((x, axis) => (x + this.high[axis]) / 2);
        this.radius = Math.hypot(...this.high.map((x, axis) => x - this.low[axis])) / 2 || 1;
    }
    async load(index) {
        if (this.loaded.has(index)) return this.loaded.get(index);
        const level = this.levels[index], rings = unpackedRings(await inflated(`rings${index}`), level);
        const points = rings.points.map((x, i) => (i % 2 ? this.up : 1) * (x - this.centre[i % 2]));
        const distances = level.distance ? unpackedValues(await inflated(`distance${index}`)) : null;
        const shown = { begin: rings.begin, points, distances, path: new Path2D(), classes: null, range: 0 };
        this.eachRing(shown, (from, to) => {
            for (let i = from; i < to; ++i) shown.path[i === from ? "moveTo" : "lineTo"](points[2 * i], points[2 * i + 1]);
            shown.path.closePath();
        });
        this.loaded.set(index, shown);
        return shown;
    }
    waitForPicture() {}  // this canvas draws at once
    eachRing(shown, visit) {
        for (let r = 0; r + 1 < shown.begin.length; ++r) visit(shown.begin[r], shown.begin[r + 1]);
    }
    // The segments by the colour of their farther end.
    classesOf(shown, level, range) {
        if (shown.classes && shown.range === range) return shown.classes;
        const paths = Array.from({ length: COLOUR_CLASSES }, () => new Path2D());
        this.eachRing(shown, (from, to) => {
            for (let i = from; i < to; ++i) {
                const j = i + 1 < to ? i + 1 : from;
                const far = shown.distances ? (Math.max(shown.distances[i], shown.distances[j]) / 65535) * level.distance.max : 0;
                const path = paths[Math.min(Math.floor((far / (range || 1)) * COLOUR_CLASSES), COLOUR_CLASSES - 1)];
                path.moveTo(shown.points[2 * i], shown.points[2 * i + 1]);
                path.lineTo(shown.points[2 * j], shown.points[2 * j + 1]);
            }
        });
        Object.assign(shown, { classes: paths, range });
        return paths;
    }

    resize(width, height) {
        this.size = [width, height];
        this.ratio = Math.min(window.devicePixelRatio, 2);
        this.canvas.width = width * this.ratio;
        this.canvas.height = height * this.ratio;
    }
    panes(state) {
        return SolidStage.prototype.panes.call(this, state);
    }

    draw(state, orbit, look) {
        const { context } = this;
        context.setTransform(1, 0, 0, 1, 0, 0);
        context.fillStyle = look.ground;
        context.fillRect(0, 0, this.canvas.width, this.canvas.height);
        for (const pane of this.panes(state)) {
            context.save();
            context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
            context.beginPath();
            context.rect(pane.left, pane.top, pane.width, pane.height);
            context.clip();
            const scale = pane.height / orbit.height;
            context.translate(pane.left + pane.width / 2, pane.top + pane.height / 2);
            context.scale(scale, -scale);
            context.translate(-orbit.target[0], -orbit.target[1]);
            for (const { index, role } of pane.shows) this.show(index, role, state, look, scale);
            context.restore();
        }
    }
    show(index, role, state, look, scale) {
        const shown = this.loaded.get(index), { context } = this, second = role === "b";
        if (!shown) return;
        context.lineJoin = "round";
        context.lineWidth = 1.4 / scale;
        context.fillStyle = second ? look.second : look.solid;
        context.globalAlpha = second ? 0.3 : 0.75;
        context.fill(shown.path, "evenodd");
        context.globalAlpha = 1;
        if (state.colours && !second) {
            context.lineWidth = 2.4 / scale;
            this.classesOf(shown, this.levels[index], state.range).forEach((path, i) => {
                context.strokeStyle = cssColour(distanceColour((i + 0.5) / COLOUR_CLASSES));
                context.stroke(path);
            });
        } else {
            context.strokeStyle = second ? look.second : look.line;
            context.stroke(shown.path);
        }
        if (state.wire && shown.points.length / 2 <= MOST_DOTS) this.dots(shown, look, scale);
    }
    dots(shown, look, scale) {
        const side = 3.2 / scale;
        this.context.fillStyle = look.line;
        for (let i = 0; i < shown.points.length; i += 2)
            this.context.fillRect(shown.points[i] - side / 2, shown.points[i + 1] - side / 2, side, side);
    }

    fitHeight(orbit, pane) {
        const size = this.high.map((x, k) => x - this.low[k]);
        return 1.12 * Math.max(size[1], (size[0] * pane.height) / pane.width);
    }
}
