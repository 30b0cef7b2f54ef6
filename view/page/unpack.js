// What view/mesh_packing.h and view/page.h have packed, taken apart again. The comments there say what the streams hold.

async function inflated(id) {
    const text = document.getElementById(id).textContent;
    const binary = atob(text), packed = new Uint8Array(binary.length);
    for (let i = 0; i < packed.length; ++i) packed[i] = binary.charCodeAt(i);
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

const unzigzag = (code) => (code >>> 1) ^ -(code & 1);

// Groups of seven bits. Numbers stay below 2^53: products, since shifts are of 32 bits.
class Varints {
    constructor(bytes, at) {
        this.bytes = bytes;
        this.at = at;
    }
    next() {
        let value = 0, weight = 1;
        for (;; weight *= 128) {
            const byte = this.bytes[this.at++];
            value += (byte & 127) * weight;
            if (byte < 128) return value;
        }
    }
    nextSigned() {
        const code = this.next();
        return code % 2 ? -(code + 1) / 2 : code / 2;
    }
}

const KIND = { fresh: 0, before: 1, behind: 2 };
const THROUGH_BC = 4, THROUGH_CA = 8, WALKED_BC = 16, WALKED_CA = 32;

// -> { lattice: Int32Array (x y z of a vertex), triangles: Uint32Array }
function unpackedMesh(bytes, vertexCount, triangleCount) {
    const lattice = new Int32Array(3 * vertexCount), triangles = new Uint32Array(3 * triangleCount);
    const before = new Int32Array(vertexCount).fill(-1), behind = new Int32Array(vertexCount).fill(-1);
    const names = new Varints(bytes, triangleCount + 6 * vertexCount);
    const gates = [];
    let count = 0;  // of vertices so far

    function put(gx, gy, gz) {
        const guess = [gx, gy, gz];
        for (let axis = 0; axis < 3; ++axis) {
            const low = triangleCount + 2 * axis * vertexCount + count;
            const code = bytes[low] | (bytes[low + vertexCount] << 8);
            lattice[3 * count + axis] = (guess[axis] + unzigzag(code)) & 0xffff;
        }
        return count++;
    }
    function named(near) {
        const name = names.next();
        if (name > 0) return count - name;
        return near < 0 ? put(0, 0, 0) : put(lattice[3 * near], lattice[3 * near + 1], lattice[3 * near + 2]);
    }

    for (let t = 0; t < triangleCount; ++t) {
        let a, b, d;
        if (gates.length === 0) {
            a = named(count - 1);
            b = named(a);
            d = a;
            behind[b] = a;
            before[a] = b;
        } else {
            d = gates.pop();
            b = gates.pop();
            a = gates.pop();
        }
        const kind = bytes[t] & 3;
        let c;
        if (kind === KIND.fresh) {
            const guess = (axis) => lattice[3 * a + axis] + lattice[3 * b + axis] - lattice[3 * d + axis];
            c = put(guess(0), guess(1), guess(2));
        } else if (kind === KIND.before) c = before[a];
        else if (kind === KIND.behind) c = behind[b];
        else c = count - names.next();
        if (kind !== KIND.before && !(bytes[t] & WALKED_CA)) (behind[a] = c), (before[c] = a);
        if (kind !== KIND.behind && !(bytes[t] & WALKED_BC)) (behind[c] = b), (before[b] = c);
        if (bytes[t] & THROUGH_CA) gates.push(a, c, b);
        if (bytes[t] & THROUGH_BC) gates.push(c, b, a);
        triangles[3 * t] = a;
        triangles[3 * t + 1] = b;
        triangles[3 * t + 2] = c;
    }
    return { lattice, triangles };
}

// -> Uint16Array: 65535 is the largest value.
function unpackedValues(bytes) {
    const values = new Uint16Array(bytes.length / 2);
    let value = 0;
    for (let i = 0; i < values.length; ++i) {
        value += unzigzag(bytes[i] | (bytes[values.length + i] << 8));
        values[i] = value;
        value = values[i];
    }
    return values;
}

// -> { begin: of each ring's points and behind the last, points: Float64Array (x y) }, in the input's coordinates
function unpackedRings(bytes, level) {
    const numbers = new Varints(bytes, 0), begin = [0];
    for (let ring = 0; ring < level.rings; ++ring) begin.push(begin[ring] + numbers.next());
    const points = new Float64Array(2 * level.points);
    let x = 0, y = 0;
    for (let i = 0; i < level.points; ++i) {
        x += numbers.nextSigned();
        y += numbers.nextSigned();
        points[2 * i] = level.low[0] + level.step * x;
        points[2 * i + 1] = level.low[1] + level.step * y;
    }
    return { begin, points };
}
