// Triangles as three.js draws them: buffers, and two shaders.

const CREASE_COSINE = 0.8;  // where facet and smooth normal are farther apart, the facet's holds: edges of parts stay sharp

const VERTEX_SHADER = `
attribute float distanceShare;
varying vec3 vWorld, vView, vNormal;
varying float vDistance;
void main() {
    vec4 view = viewMatrix * vec4(position, 1.0);
    vWorld = position;
    vView = view.xyz;
    vNormal = normalMatrix * normal;
    vDistance = distanceShare;
    gl_Position = projectionMatrix * view;
}`;

// A solid that is cut shows its inside in one hatched colour where a ray meets the surface from within.
const FRAGMENT_SHADER = `
uniform vec3 albedo, section;
uniform vec4 cut;          // what has dot(cut.xyz, world) > cut.w is away
uniform bool cuts, closed, coloured;
uniform float range;       // of distanceShare, that the colours span
uniform float opacity, crease;
uniform sampler2D colours;
varying vec3 vWorld, vView, vNormal;
varying float vDistance;
void main() {
    if (cuts && dot(cut.xyz, vWorld) > cut.w) discard;
    if (cuts && closed && !gl_FrontFacing) {
        float stripe = step(0.72, fract((gl_FragCoord.x + gl_FragCoord.y) / 9.0));
        gl_FragColor = vec4(section * (1.0 - 0.16 * stripe), opacity);
        return;
    }
    vec3 facet = normalize(cross(dFdx(vView), dFdy(vView)));
    vec3 n = normalize(vNormal) * (gl_FrontFacing ? 1.0 : -1.0);
    if (!(dot(n, facet) > crease)) n = facet;
    vec3 eye = normalize(-vView);
    float key = max(dot(n, normalize(vec3(-0.45, 0.65, 0.75))), 0.0);
    float fill = max(dot(n, normalize(vec3(0.75, 0.05, 0.65))), 0.0);
    float sky = 0.5 + 0.5 * n.y;
    vec3 base = coloured ? texture2D(colours, vec2(clamp(vDistance / range, 0.002, 0.998), 0.5)).rgb : albedo;
    float light = 0.30 + 0.12 * sky + 0.50 * key + 0.26 * fill;
    vec3 colour = base * (coloured ? 0.42 + 0.6 * light : light);
    float gloss = pow(max(dot(n, normalize(eye + vec3(-0.45, 0.65, 0.75))), 0.0), 40.0);
    colour += coloured ? 0.0 : 0.09 * gloss;
    colour *= 0.86 + 0.14 * smoothstep(0.0, 0.45, dot(n, eye));
    gl_FragColor = vec4(colour, opacity);
}`;

function distanceTexture() {
    const pixels = new Uint8Array(4 * 256);
    for (let i = 0; i < 256; ++i) pixels.set([...distanceColour(i / 255), 255], 4 * i);
    const texture = new THREE.DataTexture(pixels, 256, 1, THREE.RGBAFormat);
    texture.minFilter = texture.magFilter = THREE.LinearFilter;
    texture.needsUpdate = true;
    return texture;
}

function surfaceMaterial(colours) {
    return new THREE.ShaderMaterial({
        vertexShader: VERTEX_SHADER,
        fragmentShader: FRAGMENT_SHADER,
        side: THREE.DoubleSide,
        extensions: { derivatives: true },
        polygonOffset: true,
        polygonOffsetFactor: 1,
        polygonOffsetUnits: 1,
        uniforms: {
            albedo: { value: new THREE.Color() }, section: { value: new THREE.Color() },
            cut: { value: new THREE.Vector4() }, cuts: { value: false }, closed: { value: true },
            coloured: { value: false }, range: { value: 1 }, opacity: { value: 1 },
            crease: { value: CREASE_COSINE }, colours: { value: colours },
        },
    });
}

function wireMaterial() {
    return new THREE.ShaderMaterial({
        vertexShader: `
varying vec3 vWorld;
varying float vFacing;
void main() {
    vWorld = position;
    vec4 view = viewMatrix * vec4(position, 1.0);
    vFacing = dot(normalMatrix * normal, -view.xyz);
    gl_Position = projectionMatrix * view;
}`,
        fragmentShader: `
uniform vec3 albedo;
uniform float opacity;
uniform vec4 cut;
uniform bool cuts;
varying vec3 vWorld;
varying float vFacing;
void main() {
    // Of a cut solid, edges that face away would be drawn on the section.
    if (cuts && (dot(cut.xyz, vWorld) > cut.w || vFacing < 0.0)) discard;
    gl_FragColor = vec4(albedo, opacity);
}`,
        transparent: true,
        depthWrite: false,
        uniforms: {
            albedo: { value: new THREE.Color() }, opacity: { value: 0.35 },
            cut: { value: new THREE.Vector4() }, cuts: { value: false },
        },
    });
}

// One vector a vertex, from 127 steps a half axis: of the triangles around it, weighted by area.
function vertexNormals(positions, triangles) {
    const sums = new Float32Array(positions.length), normals = new Int8Array(4 * (positions.length / 3));
    for (let t = 0; t < triangles.length; t += 3) {
        const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
        const ux = positions[b] - positions[a], uy = positions[b + 1] - positions[a + 1], uz = positions[b + 2] - positions[a + 2];
        const vx = positions[c] - positions[a], vy = positions[c + 1] - positions[a + 1], vz = positions[c + 2] - positions[a + 2];
        const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
        sums[a] += nx; sums[a + 1] += ny; sums[a + 2] += nz;
        sums[b] += nx; sums[b + 1] += ny; sums[b + 2] += nz;
        sums[c] += nx; sums[c + 1] += ny; sums[c + 2] += nz;
    }
    for (let v = 0; v < sums.length / 3; ++v) {
        const scale = 127 / (Math.hypot(sums[3 * v], sums[3 * v + 1], sums[3 * v + 2]) || 1);
        for (let k = 0; k < 3; ++k) normals[4 * v + k] = Math.round(sums[3 * v + k] * scale);
    }
    return normals;
}

function geometryOf(mesh) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(mesh.positions, 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(vertexNormals(mesh.positions, mesh.triangles), 4, true));
    geometry.setAttribute("distanceShare", new THREE.BufferAttribute(mesh.distances, 1, true));
    geometry.setIndex(new THREE.BufferAttribute(mesh.triangles, 1));
    return geometry;
}

// The edges of a mesh, each once where two triangles run along it in opposite ways, as in every closed one.
function edgesOf(mesh, closed) {
    const edges = new Uint32Array(closed ? mesh.triangles.length : 2 * mesh.triangles.length);
    let count = 0;
    for (let t = 0; t < mesh.triangles.length; t += 3)
        for (let k = 0; k < 3; ++k) {
            const a = mesh.triangles[t + k], b = mesh.triangles[t + ((k + 1) % 3)];
            if (closed && a > b) continue;
            edges[count++] = a;
            edges[count++] = b;
        }
    return edges.subarray(0, count);
}

// A stand-in that is drawn while a hand moves a mesh that this computer draws slowly: vertices that share a cell of a coarse
// lattice become the first of them (Rossignac and Borrel 1993), and triangles that lose their area go.
function draftOf(mesh, lattice) {
    const shift = 9, side = 65536 >> shift;
    const cell = new Int32Array(side * side * side).fill(-1), to = new Uint32Array(lattice.length / 3);
    const first = [];
    for (let v = 0; v < to.length; ++v) {
        const key = ((lattice[3 * v] >> shift) * side + (lattice[3 * v + 1] >> shift)) * side + (lattice[3 * v + 2] >> shift);
        if (cell[key] < 0) cell[key] = first.push(v) - 1;
        to[v] = cell[key];
    }
    const triangles = [];
    for (let t = 0; t < mesh.triangles.length; t += 3) {
        const a = to[mesh.triangles[t]], b = to[mesh.triangles[t + 1]], c = to[mesh.triangles[t + 2]];
        if (a !== b && b !== c && c !== a) triangles.push(a, b, c);
    }
    const positions = new Float32Array(3 * first.length), distances = new Uint16Array(first.length);
    first.forEach((v, i) => {
        positions.set(mesh.positions.subarray(3 * v, 3 * v + 3), 3 * i);
        distances[i] = mesh.distances[v];
    });
    return { positions, distances, triangles: Uint32Array.from(triangles) };
}
