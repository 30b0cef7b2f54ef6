// The page: what is shown (state), who changes it (buttons, keys, hands), and when it is drawn (only when it has changed).

const page = JSON.parse(document.getElementById("document").textContent);
const byId = (id) => document.getElementById(id);
const ROOT = document.documentElement;
const REST = 180;  // ms without a hand after which a draft gives way to the mesh

const LOOKS = {
    light: { ground: "#f4f2ee", solid: page.anatomical ? "#e3d8c2" : "#b9c4cf", section: "#d98c6a", second: "#d9742f", wire: "#1c2733",
        wireOpacity: 0.3, line: "#2b3440" },
    dark: { ground: "#15181d", solid: page.anatomical ? "#d9ccb4" : "#9fb0c1", section: "#c97f5f", second: "#f09a52", wire: "#0a0d12",
        wireOpacity: 0.42, line: "#dfe5ec" },
};

const state = {
    a: 0, b: Math.min(page.levels.length - 1, 2), mode: "single", colours: false, wire: false, flat: false, parallel: false,
    cut: { on: false, axis: page.anatomical ? 0 : 1, at: 0.5, flip: false }, range: 0, rangeShare: null,
};

let stage, orbit, hands, cube, marked = [];
let dirty = true, lastMove = 0, lastFrame = 0;

function redraw() {
    dirty = true;
}
function moved() {
    lastMove = performance.now();
    redraw();
}

// ---- what is shown

const shownLevels = () => (state.mode === "single" ? [state.a] : [state.a, state.b]);

async function choose(index, second = false) {
    state[second ? "b" : "a"] = Math.min(Math.max(index, 0), page.levels.length - 1);
    if (second && state.mode === "single") keepingFit(() => (state.mode = "side"));
    await refresh();
}

// Everything that follows from the state; levels that are not there yet are unpacked first.
async function refresh() {
    putRange();
    mark();
    for (const index of shownLevels()) {
        if (stage.loaded.has(index)) continue;
        byId("busy").textContent = `unpacking ${page.levels[index].facts.name} …`;
        byId("busy").hidden = false;
        await new Promise((done) => setTimeout(done, 20));  // so that the line is seen
        await stage.load(index);
    }
    byId("busy").hidden = true;
    redraw();
}

// The range of the colours: what 98 % of the levels shown lie within, or a share of their maximum that a hand has chosen.
function putRange() {
    const shown = shownLevels().map((index) => page.levels[index].distance).filter(Boolean);
    const most = Math.max(0, ...shown.map((d) => d.max));
    state.range = state.rangeShare === null ? Math.max(0, ...shown.map(usualRange)) : state.rangeShare ** 2 * most;
    const slider = byId("legend").querySelector("input");
    if (document.activeElement !== slider) slider.value = most > 0 ? Math.sqrt(state.range / most) : 1;
    byId("legend").hidden = !state.colours;
    byId("legend").querySelector("output").textContent = withUnit(shortNumber(state.range), page.unit);
    byId("legend").lastElementChild.lastElementChild.textContent = (state.range < most ? "≥ " : "") + withUnit(shortNumber(state.range), page.unit);
}

function mark() {
    for (const part of marked) part.mark(state);
    const facts = page.levels[state.a].facts, unit = page.unit;
    const pieces = page.planar
        ? [`${grouped(facts.points)} points`, counted(facts.rings, "ring", "rings")]
        : [`${grouped(facts.triangles)} triangles`, counted(facts.parts, "part"), counted(facts.handles, "handle"), counted(facts.cavities, "cavity", "cavities")];
    if (facts.rms) pieces.push(`rms ${withUnit(shortNumber(facts.rms), unit)}`);
    byId("subtitle").textContent = [facts.name, ...pieces.filter(Boolean)].join(" · ");
    Object.assign(ROOT.dataset, { level: facts.name, triangles: facts.triangles ?? "", points: facts.points ?? "", mode: state.mode });
    for (const button of document.querySelectorAll("[data-mode]")) button.setAttribute("aria-pressed", button.dataset.mode === state.mode);
    for (const button of document.querySelectorAll("[data-flag]")) {
        const flag = button.dataset.flag;
        button.setAttribute("aria-pressed", flag === "cut" ? state.cut.on : state[flag]);
    }
    byId("levels-b").hidden = state.mode === "single";
    byId("levels-a").firstElementChild.hidden = state.mode === "single";
    byId("cut").hidden = !state.cut.on;
    putLabels();
}
const grouped = (n) => (n === undefined ? "" : n.toLocaleString("en-US"));
const counted = (n, one, many = one + "s") => (n === undefined ? "" : `${grouped(n)} ${n === 1 ? one : many}`);

// The names of two panes, and the line between them.
function putLabels() {
    const labels = byId("labels");
    labels.replaceChildren();
    if (state.mode === "single" || !stage.size) return;
    const panes = stage.panes(state);
    shownLevels().forEach((index, i) => {
        const facts = page.levels[index].facts, pane = panes[Math.min(i, panes.length - 1)];
        const label = element("span", {}, element("b", { class: i ? "b" : "a" }, i ? "B" : "A"),
            `${facts.name} · ${grouped(facts.triangles ?? facts.points)} ${page.planar ? "points" : "triangles"}`);
        label.style.left = `${pane.left + pane.width * (panes.length > 1 ? 0.5 : 0.25 + 0.5 * i)}px`;
        label.style.top = `${pane.top + (pane.top > 0 ? 12 : 74)}px`;
        labels.append(label);
    });
    if (panes.length < 2) return;
    const line = element("i"), second = panes[1];
    Object.assign(line.style, second.left > 0
        ? { left: `${second.left}px`, top: 0, bottom: 0, width: "1px" } : { top: `${second.top}px`, left: 0, right: 0, height: "1px" });
    labels.append(line);
}

// ---- who changes it

// A mode that is on goes off. Two levels that are one are no comparison: the second becomes the first of all, or the next.
function setMode(mode) {
    keepingFit(() => (state.mode = state.mode === mode ? "single" : mode));
    if (state.mode !== "single" && state.a === state.b) state.b = state.a > 0 ? 0 : 1;
    return refresh();
}
function toggle(flag) {
    if (flag === "cut") state.cut.on = !state.cut.on;
    else state[flag] = !state[flag];
    if (flag === "colours" && state.colours && !page.levels[state.a].distance && page.levels.length > 1 && state.mode === "single")
        return choose(firstWithDistance());
    return refresh();
}
const firstWithDistance = () => Math.max(0, page.levels.findIndex((level) => level.distance));

function setTheme(theme) {
    ROOT.dataset.theme = theme;
    redraw();
}
function cutAlong(axis) {
    Object.assign(state.cut, { axis, on: true });
    byId("cut").querySelector("select").value = axis;
    refresh();
}
function flip() {
    state.cut.flip = !state.cut.flip;
    refresh();
}
function fit() {
    orbit.target = [0, 0, 0];
    orbit.height = stage.fitHeight(orbit, stage.panes(state)[0]);
    redraw();
}
// Calls `change`, which makes panes of another size, and keeps what was in the picture in it.
function keepingFit(change) {
    const height = () => stage.fitHeight(orbit, stage.panes(state)[0]);
    const before = stage.size ? height() : 0;
    change();
    if (before > 0) orbit.height *= height() / before;
    redraw();
}
async function save() {
    if (page.planar) return;
    await stage.load(state.a);
    const name = page.levels[state.a].facts.name.replace(/\.[a-z]+$/i, "");
    saveAs(stage.stl(state.a, page.title), `${page.levels.length > 1 ? page.title + "_" : ""}${name}.stl`);
}
function togglePanel() {
    byId("panel").classList.toggle("closed");
    resize();
}
function view(to) {
    if (!page.planar) orbit.turnTo(...lookingAt(to));
}

const solidOnly = (action) => () => page.planar || action();
const KEYS = [
    ["←", "the finer level", "ArrowLeft", () => choose(state.a - 1)],
    ["→", "the coarser level", "ArrowRight", () => choose(state.a + 1)],
    ["Home, End", "the first, the last level", "Home", () => choose(0)],
    [null, null, "End", () => choose(page.levels.length - 1)],
    ["[ ]", "the second level, finer or coarser", "[", () => choose(state.b - 1, true)],
    [null, null, "]", () => choose(state.b + 1, true)],
    ["S", "side by side", "s", () => setMode("side")],
    ["O", "overlaid", "o", () => setMode("overlay")],
    ["D", "colours by distance", "d", () => toggle("colours")],
    ["W", "wireframe", "w", () => toggle("wire")],
    ["C", "cut plane; X, Y, Z choose its axis, V the side", "c", solidOnly(() => toggle("cut"))],
    [null, null, "x", solidOnly(() => cutAlong(0))],
    [null, null, "y", solidOnly(() => cutAlong(1))],
    [null, null, "z", solidOnly(() => cutAlong(2))],
    [null, null, "v", solidOnly(flip)],
    ["G", "flat triangles", "g", solidOnly(() => toggle("flat"))],
    ["P", "parallel projection", "p", solidOnly(() => toggle("parallel"))],
    ["1 to 6", "from the front, back, left, right, top, bottom", "1", () => view([0, -1, 0])],
    [null, null, "2", () => view([0, 1, 0])],
    [null, null, "3", () => view([1, 0, 0])],
    [null, null, "4", () => view([-1, 0, 0])],
    [null, null, "5", () => view([0, 0, 1])],
    [null, null, "6", () => view([0, 0, -1])],
    ["F", "all of it in the picture", "f", fit],
    ["E", "save the shown mesh as STL", "e", save],
    ["T", "dark or light", "t", () => setTheme(ROOT.dataset.theme === "dark" ? "light" : "dark")],
    ["L", "table", "l", togglePanel],
    ["?", "these keys", "?", () => byId("keys").showModal()],
];

function listenToKeys() {
    document.addEventListener("keydown", (e) => {
        if (e.ctrlKey || e.metaKey || e.altKey || byId("keys").open) return;
        const ranges = e.target.type === "range" && e.key.startsWith("Arrow");
        const key = KEYS.find(([, , name]) => name === e.key || name === e.key.toLowerCase());
        if (!key || ranges || e.target.tagName === "SELECT") return;
        e.preventDefault();
        key[3]();
    });
    byId("keys").querySelector("dl").append(...KEYS.filter(([name]) => name)
        .flatMap(([name, what]) => [element("dt", {}, name), element("dd", {}, what)]));
}

function listenToButtons() {
    for (const button of document.querySelectorAll("[data-mode]")) button.addEventListener("click", () => setMode(button.dataset.mode));
    for (const button of document.querySelectorAll("[data-flag]")) button.addEventListener("click", () => toggle(button.dataset.flag));
    for (const [id, action] of Object.entries({ fit, save, flip, table: togglePanel, help: () => byId("keys").showModal(),
        theme: () => setTheme(ROOT.dataset.theme === "dark" ? "light" : "dark") })) byId(id).addEventListener("click", action);
    const [select, place] = ["select", "input"].map((name) => byId("cut").querySelector(name));
    "XYZ".split("").forEach((letter, axis) => select.append(new Option(page.anatomical ? ["L–R", "A–P", "S–I"][axis] : letter, axis)));
    select.value = state.cut.axis;
    select.addEventListener("change", () => cutAlong(Number(select.value)));
    place.value = state.cut.at;
    place.addEventListener("input", () => ((state.cut.at = Number(place.value)), moved()));
    const range = byId("legend").querySelector("input");
    range.addEventListener("input", () => ((state.rangeShare = Math.max(Number(range.value), 0.01)), refresh()));
    range.addEventListener("dblclick", () => ((state.rangeShare = null), refresh()));
    byId("legend").querySelector("i").style.background = distanceGradient();
    byId("legend").querySelector("i").style.display = "block";
}

// A slider over the levels, with their names below.
class LevelSlider {
    constructor(node, key) {
        Object.assign(this, { key, input: node.querySelector("input"), names: [] });
        this.input.max = page.levels.length - 1;
        this.input.addEventListener("input", () => choose(Number(this.input.value), key === "b"));
        const every = Math.ceil(page.levels.length / 14);
        page.levels.forEach((level, index) => {
            const name = element("span", {}, index % every === 0 ? shortName(level.facts.name) : "");
            name.addEventListener("click", () => choose(index, key === "b"));
            this.names.push(name);
        });
        node.querySelector(".names").append(...this.names);
    }
    mark() {
        this.input.value = state[this.key];
        this.names.forEach((name, i) => (i === state[this.key] ? name.setAttribute("aria-current", "true") : name.removeAttribute("aria-current")));
    }
}
const shortName = (name) => (name.length > 12 ? name.slice(0, 11) + "…" : name);

// ---- when it is drawn

function resize() {
    const box = byId("stage").getBoundingClientRect();
    if (box.width < 1 || box.height < 1) return;
    keepingFit(() => stage.resize(Math.round(box.width), Math.round(box.height)));
    putLabels();
}

function putScale() {
    const pane = stage.panes(state)[0], perPixel = orbit.height / pane.height;
    const length = roundBelow(Math.min(160, pane.width / 3) * perPixel);
    byId("scale").firstElementChild.style.width = `${length / perPixel}px`;
    byId("scale").lastElementChild.textContent = withUnit(shortNumber(length), page.unit);
}

function frame(now) {
    requestAnimationFrame(frame);
    const seconds = Math.min((now - lastFrame) / 1000, 0.1);
    lastFrame = now;
    if (!hands.busy && orbit.tick(seconds)) moved();
    const moving = hands.busy || performance.now() - lastMove < REST;
    if (!dirty) return;
    stage.draw(state, orbit, LOOKS[ROOT.dataset.theme], moving);
    if (cube) cube.draw();
    putScale();
    const slow = moving && stage.slowest > 60;
    dirty = slow || Boolean(stage.wantsToMeasureAgain);  // slow: until the hand rests, when the mesh itself is drawn
    if (!stage.loaded.has(state.a)) return;  // so far an empty picture, or a preview
    ROOT.dataset.drawn = `${page.levels[state.a].facts.name}`;
    markPicture("first picture");
    markPicture("chosen level");
}

// Marks of the browser's performance timeline, ms since the page was asked for, once each, when the picture is there: the first
// one that shows the solid, and the first of the level that is chosen. bench/first_picture reads them.
function markPicture(name) {
    if (performance.getEntriesByName(name).length > 0) return;
    stage.waitForPicture();
    performance.mark(name);
}

// Levels that nobody looks at yet, smallest first, while nothing else happens.
async function unpackTheRest() {
    const most = 6e6;  // triangles in memory that were not asked for
    let sum = 0;
    for (let index = page.levels.length - 1; index >= 0; --index) {
        sum += page.levels[index].triangles ?? 0;
        if (sum > most) return;
        await new Promise((done) => setTimeout(done, 60));
        await stage.load(index);
    }
}

function putNotes() {
    const rounding = `Coordinates here are rounded to ${withUnit(shortNumber(page.rounding), page.unit)}; the files of the levels have all digits.`;
    for (const note of [...page.notes, rounding, page.program]) byId("notes").append(element("p", {}, note));
}

async function start() {
    document.title = page.title;
    byId("title").textContent = page.title;
    const canvas = byId("canvas");
    orbit = new Orbit(moved);
    try {
        stage = page.planar ? new PlaneStage(canvas, page.levels, page.yUp) : new SolidStage(canvas, page.levels);
    } catch (error) {
        byId("busy").textContent = "This browser draws no WebGL: " + error.message;
        byId("busy").hidden = false;
        return;
    }
    const paneOf = (x, y) => {
        const box = byId("stage").getBoundingClientRect();
        const panes = stage.panes(state).map((p) => ({ ...p, left: p.left + box.left, top: p.top + box.top }));
        return panes.find((p) => x < p.left + p.width && y < p.top + p.height) || panes[0];
    };
    hands = new Hands(canvas, orbit, paneOf, !page.planar);
    canvas.addEventListener("dblclick", fit);
    if (page.planar) {
        orbit.elevation = Math.PI / 2;
        byId("cube").remove();
        for (const node of document.querySelectorAll(".solid-only")) node.hidden = true;
    } else {
        [orbit.azimuth, orbit.elevation] = page.anatomical ? [0.45, 0.16] : [-0.62, 0.5];
        cube = new AxesCube(byId("cube"), orbit, page.anatomical);
    }
    const table = new Table(page, choose), plots = new Plots(page, choose), histogram = new Histogram(page);
    byId("levels").append(table.node);
    byId("plots").append(plots.node);
    byId("distances").append(histogram.node);
    marked = [table, plots, histogram, new LevelSlider(byId("levels-a"), "a"), new LevelSlider(byId("levels-b"), "b")];
    if (page.levels.length < 2) {
        byId("levels-a").hidden = true;
        for (const node of document.querySelectorAll("[data-mode], [data-flag=colours]")) node.hidden = true;
    }
    putNotes();
    listenToButtons();
    listenToKeys();
    setTheme(matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
    new ResizeObserver(resize).observe(byId("stage"));
    resize();
    fit();
    requestAnimationFrame(frame);
    await preview();
    await refresh();
    ROOT.dataset.ready = "true";
    unpackTheRest();
}

// A first picture that is quickly there: of a level of few triangles, or, where there is none, a draft of the chosen one.
async function preview() {
    const quick = page.levels.findIndex((level) => (level.triangles ?? 0) < 2.5e4);
    if (quick === 0 || (quick < 0 && !isLarge(page.levels[state.a]))) return;
    mark();
    const first = quick < 0 ? state.a : quick;
    await (quick < 0 ? stage.unpack(first) : stage.load(first));
    const wanted = state.a;
    state.a = first;
    stage.draw(state, orbit, LOOKS[ROOT.dataset.theme], false);
    if (cube) cube.draw();
    markPicture("first picture");
    state.a = wanted;
    await new Promise((done) => setTimeout(done, 30));
}

start();
