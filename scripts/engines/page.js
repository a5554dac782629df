// Draws the spheres of LISTED in the page, and leaves the pictures as its text: linear RGB, float32, rows from the bottom.
const base64 = (floats) => {
    const bytes = new Uint8Array(floats.buffer);
    let text = '';
    for (let at = 0; at < bytes.length; at += 32768) text += String.fromCharCode(...bytes.subarray(at, at + 32768));
    return btoa(text);
};

// The orthographic image shows [-EXTENT, EXTENT]² of the unit sphere.
export const EXTENT = 1.05;
export const SIZE = LISTED.size;

// The camera of engines without orthographic views: so far away that directions of view differ by 0.12 degrees at most.
export const DISTANCE = 500;
export const FOV = 2 * Math.atan(EXTENT / DISTANCE);

export const mapUrl = (name) => `data:application/octet-stream;base64,${MAPS[name]}`;
export const mapBytes = (name) => Uint8Array.from(atob(MAPS[name]), (c) => c.charCodeAt(0)).buffer;

// The arrays of a sphere about +y of BANDS rings; u grows to the east, from +z over +x.
const BANDS = 256;
export const sphereMesh = () => {
    const [positions, uvs, tangents, indices] = [[], [], [], []];
    for (let j = 0; j <= BANDS; j++) for (let i = 0; i <= 2 * BANDS; i++) {
        const [theta, phi] = [Math.PI * j / BANDS, Math.PI * i / BANDS];
        positions.push(Math.sin(theta) * Math.sin(phi), Math.cos(theta), Math.sin(theta) * Math.cos(phi));
        uvs.push(i / BANDS / 2, 1 - j / BANDS);
        tangents.push(Math.cos(phi), 0, -Math.sin(phi), 1);
        if (i === 2 * BANDS || j === BANDS) continue;
        const here = j * (2 * BANDS + 1) + i;
        const below = here + 2 * BANDS + 1;
        indices.push(here, below, below + 1, here, below + 1, here + 1);
    }
    return { positions, normals: positions.slice(), uvs, tangents, indices };
};

// Leaves what `run(said)` adds as the page's text.
const leave = async (run) => {
    const said = [];
    try {
        await run(said);
        said.push('DONE');
    } catch (error) { said.push(`FAILED ${error.stack ?? error}`.replaceAll('\n', ' ')); }
    document.body.textContent = `\n${said.join('\n')}\n`;
};

// `engine.light(name)` prepares a map; `engine.draw(sphere, light)` gives RGBA floats, rows from the bottom.
export const draw = (engine) => leave(async (said) => {
    for (const name of LISTED.maps) {
        const light = await engine.light(name);
        for (const sphere of LISTED.spheres.filter((sphere) => sphere.map === name)) {
            const rgba = await engine.draw(sphere, light);
            const rgb = new Float32Array(3 * SIZE * SIZE);
            rgb.forEach((_, i) => { rgb[i] = rgba[4 * Math.floor(i / 3) + i % 3]; });
            said.push(`PICTURE ${sphere.name} ${SIZE} ${SIZE} ${base64(rgb)}`);
        }
    }
});

// `assets(names, save)` saves images of RGB floats, rows from the top.
export const keep = (assets) => leave((said) => assets(LISTED.maps, (name, width, height, rgb) => {
    const up = new Float32Array(rgb.length);
    for (let y = 0; y < height; y++) up.set(rgb.subarray(3 * width * y, 3 * width * (y + 1)), 3 * width * (height - 1 - y));
    said.push(`PICTURE ${name} ${width} ${height} ${base64(up)}`);
}));
