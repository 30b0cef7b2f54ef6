// What stands beside the picture: the table of levels, plots over them, the histogram of distances; and, over the picture, the
// cube of axes. All of it is made of the document alone; strings become text, never markup.

const SVG = "http://www.w3.org/2000/svg";

function element(name, attributes = {}, ...children) {
    const drawn = ["svg", "g", "rect", "path", "line", "polygon", "text", "title"].includes(name);
    const node = drawn ? document.createElementNS(SVG, name) : document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    node.append(...children);
    return node;
}

// key of the facts, head of the column, how a value is written, whether it gets a plot, whether that is logarithmic
const COLUMNS = [
    { key: "voxel", head: "voxel", length: true, digits: 3 },
    { key: "faces", head: "faces" },
    { key: "triangles", head: "triangles", plot: true, log: true },
    { key: "points", head: "points", plot: true, log: true },
    { key: "rings", head: "rings", plot: true },
    { key: "holes", head: "holes", plot: true },
    { key: "parts", head: "parts", plot: true },
    { key: "handles", head: "handles", plot: true },
    { key: "cavities", head: "cavities", plot: true },
    { key: "area", head: "area", planar: true },
    { key: "volumeError", head: "volume", write: shareText, plot: true, name: "volume error" },
    { key: "rms", head: "rms", length: true, digits: 3, plot: true, name: "rms to first" },
    { key: "max", head: "max", length: true, digits: 3 },
];

function columnsOf(page) {
    return COLUMNS.filter(({ key, planar }) => (!planar || page.planar) && page.levels.some((level) => level.facts[key] !== undefined));
}
function written(column, value) {
    return value === undefined ? "–" : column.write ? column.write(value) : shortNumber(value, column.digits);
}

class Table {
    constructor(page, choose) {
        this.columns = columnsOf(page);
        const head = (column) => element("th", { scope: "col" }, column.head,
            ...(column.length && page.unit ? [element("small", {}, page.unit)] : []));
        this.rows = page.levels.map((level, index) => {
            const row = element("tr", { tabindex: 0, "data-level": index, title: level.facts.file || level.facts.name },
                element("th", { scope: "row" }, level.facts.name),
                ...this.columns.map((column) => element("td", {}, written(column, level.facts[column.key]))));
            row.addEventListener("click", (e) => choose(index, e.shiftKey));
            row.addEventListener("keydown", (e) => e.key === "Enter" && choose(index, e.shiftKey));
            return row;
        });
        this.node = element("table", {},
            element("thead", {}, element("tr", {}, element("th", {}), ...this.columns.map(head))),
            element("tbody", {}, ...this.rows));
    }
    mark(state) {
        this.rows.forEach((row, index) => {
            row.classList.toggle("a", index === state.a);
            row.classList.toggle("b", state.mode !== "single" && index === state.b);
            if (index === state.a) row.setAttribute("aria-current", "true");
            else row.removeAttribute("aria-current");
        });
    }
}

// A small line plot a column: levels from left to right.
class Plots {
    constructor(page, choose) {
        this.page = page;
        this.plots = columnsOf(page).filter((column) => column.plot && page.levels.length > 1)
            .map((column) => this.plot(column, choose));
        this.node = element("div", { class: "plots" }, ...this.plots.map((plot) => plot.node));
    }
    plot(column, choose) {
        const width = 200, height = 34, levels = this.page.levels;
        const values = levels.map((level) => level.facts[column.key]);
        const scaled = values.map((v) => (v === undefined ? null : column.log ? Math.log10(Math.max(v, 1)) : v));
        const known = scaled.filter((v) => v !== null);
        const low = column.log ? Math.min(...known) : Math.min(0, ...known), high = Math.max(...known, low + 1e-12);
        const x = (i) => 6 + ((width - 12) * i) / Math.max(levels.length - 1, 1);
        const y = (v) => height - 5 - ((height - 10) * (v - low)) / (high - low);
        const svg = element("svg", { viewBox: `0 0 ${width} ${height}`, preserveAspectRatio: "none", role: "img",
            "aria-label": `${column.name || column.head} over the levels` });
        const path = scaled.map((v, i) => (v === null ? "" : `${i === 0 || scaled[i - 1] === null ? "M" : "L"}${x(i)} ${y(v)}`));
        svg.append(element("line", { x1: 6, x2: width - 6, y1: y(low <= 0 && !column.log ? 0 : low), y2: y(low <= 0 && !column.log ? 0 : low) }),
            element("path", { class: "curve", d: path.join("") }));
        // A line of no length with round ends stays a circle however the plot is stretched.
        const dots = scaled.map((v, i) => element("path", v === null ? {} : { d: `M${x(i)} ${y(v)}h0` }));
        svg.append(...dots);
        svg.addEventListener("click", (e) => {
            const box = svg.getBoundingClientRect();
            const at = Math.round((((e.clientX - box.left) / box.width) * width - 6) / ((width - 12) / Math.max(levels.length - 1, 1)));
            choose(Math.min(Math.max(at, 0), levels.length - 1), e.shiftKey);
        });
        const value = element("output", {});
        const unit = column.length ? this.page.unit : "";
        return { column, dots, values, value, unit,
            node: element("div", { class: "plot" }, element("span", {}, column.name || column.head), svg, value) };
    }
    mark(state) {
        for (const { column, dots, values, value, unit } of this.plots) {
            dots.forEach((dot, i) => dot.setAttribute("class",
                `dot ${i === state.a ? "a" : state.mode !== "single" && i === state.b ? "b" : ""}`));
            value.textContent = withUnit(written(column, values[state.a]), values[state.a] === undefined ? "" : unit);
        }
    }
}

// Shares of the surface by distance to the first level.
class Histogram {
    constructor(page) {
        this.page = page;
        this.svg = element("svg", { viewBox: "0 0 240 64", preserveAspectRatio: "none", role: "img",
            "aria-label": "histogram of distances" });
        this.caption = element("p", { class: "caption" });
        this.node = element("section", { class: "histogram" }, element("h2", {}), this.svg,
            element("div", { class: "axis" }, element("span", {}, "0"), element("span", {})), this.caption);
    }
    mark(state) {
        const level = this.page.levels[state.a], { distance, facts } = level, first = this.page.levels[0].facts.name;
        this.node.hidden = this.page.levels.length < 2;
        this.node.querySelector("h2").textContent = distance ? `Distance of ${facts.name} to ${first}` : "Distances";
        this.svg.replaceChildren();
        this.node.querySelector(".axis").hidden = !distance;
        this.svg.style.display = distance ? "" : "none";
        Object.assign(this.node.dataset, { rms: facts.rms ?? "", max: facts.max ?? "" });
        if (!distance) {
            this.caption.textContent = `${facts.name} is what the others are measured against.`;
            return;
        }
        const bins = distance.histogram, most = Math.max(...bins), width = 240 / bins.length;
        bins.forEach((part, i) => {
            const middle = ((i + 0.5) / bins.length) * distance.max, height = 60 * Math.sqrt(part / most);
            this.svg.append(element("rect", { x: i * width + 0.4, width: width - 0.8, y: 62 - height, height: Math.max(height, part > 0 ? 0.8 : 0),
                fill: cssColour(distanceColour(middle / (state.range || distance.max || 1))) },
                element("title", {}, `${shortNumber((i * distance.max) / bins.length)} to ${shortNumber(((i + 1) * distance.max) / bins.length)}: ${shortNumber(100 * part)} %`)));
        });
        this.node.querySelector(".axis").lastChild.textContent = withUnit(shortNumber(distance.max), this.page.unit);
        this.caption.textContent = `rms ${withUnit(shortNumber(facts.rms), this.page.unit)}, max ` +
            `${withUnit(shortNumber(facts.max), this.page.unit)}. Heights are square roots of shares of the ${this.page.planar ? "length" : "area"}.`;
    }
}

// Faces of the cube of axes: where they point, and what is right and up for one who looks at them.
const FACES = [
    { to: [1, 0, 0], right: [0, 1, 0], up: [0, 0, 1], letters: ["+X", "L"] },
    { to: [-1, 0, 0], right: [0, -1, 0], up: [0, 0, 1], letters: ["−X", "R"] },
    { to: [0, 1, 0], right: [-1, 0, 0], up: [0, 0, 1], letters: ["+Y", "P"] },
    { to: [0, -1, 0], right: [1, 0, 0], up: [0, 0, 1], letters: ["−Y", "A"] },
    { to: [0, 0, 1], right: [1, 0, 0], up: [0, 1, 0], letters: ["+Z", "S"] },
    { to: [0, 0, -1], right: [1, 0, 0], up: [0, -1, 0], letters: ["−Z", "I"] },
];

class AxesCube {
    constructor(node, orbit, anatomical) {
        Object.assign(this, { node, orbit, anatomical });
    }
    draw() {
        const { right, up, back } = this.orbit.axes(), size = 23;
        const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        const flat = (v) => [size * dot(v, right), -size * dot(v, up)];
        this.node.replaceChildren();
        for (const face of FACES) {
            const facing = dot(face.to, back);
            if (facing < 0.02) continue;
            const [cx, cy] = flat(face.to), u = flat(face.right), v = flat(face.up);
            const corner = (i, j) => `${cx + i * u[0] + j * v[0]},${cy + i * u[1] + j * v[1]}`;
            const polygon = element("polygon", { points: [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)].join(" "),
                "fill-opacity": 0.35 + 0.6 * facing });
            const text = element("text", { "fill-opacity": Math.min(1, 3 * facing),
                transform: `matrix(${[u[0] / size, u[1] / size, -v[0] / size, -v[1] / size, cx, cy].join(" ")})` },
                face.letters[this.anatomical ? 1 : 0]);
            const group = element("g", {}, polygon, text);
            group.addEventListener("click", () => this.orbit.turnTo(...lookingAt(face.to)));
            this.node.append(group);
        }
    }
}

// The azimuth and elevation from which one looks at what points to `to`.
function lookingAt(to) {
    if (to[2] !== 0) return [0, to[2] * MOST_ELEVATION];
    return [Math.atan2(to[0], -to[1]), 0];
}
