// A shown mesh as a binary STL, in the coordinates of its input.

function stlOf(mesh, centre, title) {
    const count = mesh.triangles.length / 3, bytes = new ArrayBuffer(84 + 50 * count), view = new DataView(bytes);
    // A header that begins with "solid" would be taken for text.
    const header = new TextEncoder().encode(`isowave ${title}`).subarray(0, 80);
    new Uint8Array(bytes).set(header);
    view.setUint32(80, count, true);
    for (let t = 0, at = 84; t < count; ++t, at += 50) {
        const corners = [0, 1, 2].map((k) => {
            const v = 3 * mesh.triangles[3 * t + k];
            return [0, 1, 2].map((axis) => mesh.positions[v + axis] + centre[axis]);
        });
        [facetNormal(corners), ...corners].flat().forEach((x, i) => view.setFloat32(at + 4 * i, x, true));
    }
    return new Blob([bytes], { type: "model/stl" });
}

function facetNormal([a, b, c]) {
    const u = b.map((x, k) => x - a[k]), v = c.map((x, k) => x - a[k]);
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const length = Math.hypot(...n) || 1;
    return n.map((x) => x / length);
}

function saveAs(blob, name) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
