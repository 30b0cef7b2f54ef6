// Colours of distances: what has not moved is pale, what has moved goes through amber and red to a dark purple. Lightness
// falls all along the way, so that it reads without hue.

const DISTANCE_STOPS = [
    [0, 226, 222, 211], [0.18, 240, 205, 120], [0.42, 232, 138, 62],
    [0.68, 196, 62, 56], [0.88, 122, 24, 72], [1, 66, 10, 62],
];

// share: 0 to 1 of the range shown; beyond it the last colour.
function distanceColour(share) {
    const at = Math.min(Math.max(share, 0), 1);
    const next = Math.max(1, DISTANCE_STOPS.findIndex((stop) => stop[0] >= at));
    const low = DISTANCE_STOPS[next - 1], high = DISTANCE_STOPS[next];
    const part = (at - low[0]) / (high[0] - low[0]);
    return [1, 2, 3].map((k) => Math.round(low[k] + part * (high[k] - low[k])));
}

const cssColour = ([r, g, b]) => `rgb(${r} ${g} ${b})`;

function distanceGradient() {
    return "linear-gradient(90deg, " +
        DISTANCE_STOPS.map((s) => `${cssColour(s.slice(1))} ${100 * s[0]}%`).join(", ") + ")";
}

// What 98 % of the area (or length) lies within: a range that a few far points do not stretch.
function usualRange(distance) {
    if (!distance || distance.max === 0) return 0;
    let sum = 0;
    const bins = distance.histogram;
    for (let i = 0; i < bins.length; ++i) {
        sum += bins[i];
        if (sum >= 0.98) return (distance.max * (i + 1)) / bins.length;
    }
    return distance.max;
}

// Four significant digits, or as many as are said; thousands grouped, as the command prints numbers.
function shortNumber(value, digits = 4) {
    if (value === 0) return "0";
    const size = Math.floor(Math.log10(Math.abs(value)));
    if (size >= 3) return Math.round(value).toLocaleString("en-US");
    if (size < -5) return value.toExponential(2);
    return String(Number(value.toPrecision(digits)));
}

const shareText = (value) => `${value > 0 ? "+" : value < 0 ? "−" : ""}${Number((100 * Math.abs(value)).toPrecision(3))} %`;

const withUnit = (text, unit) => (unit ? `${text} ${unit}` : text);

// 1, 2 or 5 times a power of ten, at most `most`.
function roundBelow(most) {
    const power = Math.pow(10, Math.floor(Math.log10(most)));
    return power * (most / power >= 5 ? 5 : most / power >= 2 ? 2 : 1);
}
