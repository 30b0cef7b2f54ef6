// node decode.mjs MODULES NEUROGLANCER_FOLDER OUT: every fragment through neuroglancer's own decoder, as its mesh source
// calls it; a file OUT/LEVEL_FRAGMENT each: counts of indices and positions (uint32), nine offsets of octants, indices, positions.
// node decode.mjs MODULES --glb FILE...: Khronos' validator on each; the first error ends it.
import { readFileSync, writeFileSync } from "node:fs";
import { fileURLToPath, pathToFileURL } from "node:url";

const [modules, folder, ...rest] = process.argv.slice(2);

async function validate(files) {
    const { default: validator } = await import(pathToFileURL(`${modules}/gltf-validator/index.js`));
    for (const file of files) {
        const report = await validator.validateBytes(new Uint8Array(readFileSync(file)));
        const { numErrors, numWarnings } = report.issues;
        if (numErrors + numWarnings > 0) throw new Error(`${file}: ${JSON.stringify(report.issues.messages[0])}`);
    }
}

async function decode(out) {
    globalThis.fetch = async (url) =>
        new Response(readFileSync(fileURLToPath(url)), { headers: { "content-type": "application/wasm" } });
    const { decodeDracoPartitioned } = await import(pathToFileURL(`${modules}/neuroglancer/lib/mesh/draco/index.js`));
    const info = JSON.parse(readFileSync(`${folder}/info`));
    const index = readFileSync(`${folder}/1.index`), data = readFileSync(`${folder}/1`);
    const word = (i) => index.readUInt32LE(4 * i);
    const levels = word(6);
    let place = 7 + 5 * levels, offset = 0;
    for (let level = 0; level < levels; ++level) {
        const count = word(7 + 4 * levels + level);
        for (let i = 0; i < count; ++i) {
            const bytes = word(place + 3 * count + i);
            if (bytes > 0) {
                const piece = new Uint8Array(data.subarray(offset, offset + bytes));
                const mesh = await decodeDracoPartitioned(piece, info.vertex_quantization_bits, level > 0);
                const octants = new Uint32Array(9);
                octants.set(mesh.subChunkOffsets);
                const counts = new Uint32Array([mesh.indices.length, mesh.vertexPositions.length]);
                writeFileSync(`${out}/${level}_${i}`,
                    Buffer.concat([counts, octants, mesh.indices, mesh.vertexPositions].map((a) => Buffer.from(a.buffer))));
            }
            offset += bytes;
        }
        place += 4 * count;
    }
}

if (folder === "--glb") await validate(rest);
else await decode(rest[0]);
