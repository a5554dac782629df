// The two halves of browser.sh around Chromium. `bundle`: packs an engine's render.js, the list of spheres and the maps into
// page.html of the current folder. `pictures`: reads the page's text from stdin, and writes the pictures as PFM. The last argument says
// what is drawn: nothing for the engine's own light, `ours` for our bakes, `assets` for its levels and tables in place of spheres.
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname } from 'node:path';
import { text } from 'node:stream/consumers';

const [step, engine, out, here, kind] = process.argv.slice(2);
const listed = JSON.parse(readFileSync(`${out}/spheres.json`));

const stop = (why) => {
    console.error(`${engine}: ${why}`);
    process.exit(2);
};

const bundle = async () => {
    const { dependencies, maps: form, bake } = JSON.parse(readFileSync(`${here}/${engine}/package.json`));
    for (const [name, pinned] of Object.entries(dependencies)) {
        const { version } = JSON.parse(readFileSync(`node_modules/${name}/package.json`));
        if (version !== pinned) stop(`expected ${name} ${pinned}, found ${version}: remove ${process.cwd()}`);
    }
    const { build } = createRequire(`${process.cwd()}/`)('esbuild');
    const start = kind === 'assets' ? `
        import { assets } from '${here}/${engine}/assets.js';
        import { keep } from '${here}/page.js';
        keep(assets);` : `
        import { engine } from '${here}/${engine}/render.js';
        import { draw } from '${here}/page.js';
        draw(engine);`;
    const made = await build({
        stdin: { contents: start, resolveDir: process.cwd() }, nodePaths: [`${process.cwd()}/node_modules`],
        bundle: true, format: 'esm', write: false, logLevel: 'error',
    });
    const file = (name) => kind === 'ours' ? `${out}/bakes/${engine}/${name}/${bake}` : `${out}/maps/${name}.${form}`;
    const maps = Object.fromEntries(listed.maps.map((name) => [name, readFileSync(file(name)).toString('base64')]));
    const script = made.outputFiles[0].text.replaceAll('</script', '<\\/script');
    writeFileSync('page.html', `<!doctype html><meta charset=utf-8><body><script>window.LISTED = ${JSON.stringify(listed)}; ` +
        `window.MAPS = ${JSON.stringify(maps)}; window.OURS = ${kind === 'ours'}</script><script type=module>${script}</script>`);
};

const pictures = async () => {
    const lines = (await text(process.stdin)).replaceAll(/<[^>]*>/g, '').split('\n');
    const of = (word) => lines.filter((line) => line.startsWith(`${word} `)).map((line) => line.slice(word.length + 1));
    for (const line of of('SAYS')) console.log(`${engine}: ${line}`);
    if (of('FAILED').length) stop(of('FAILED').join('\n'));
    if (!lines.includes('DONE')) stop('the page ended early');
    for (const line of of('PICTURE')) {
        const [name, width, height, base64] = line.split(' ');
        const path = `${out}/${engine}${kind ? `-${kind}` : ''}/${name}.pfm`;
        mkdirSync(dirname(path), { recursive: true });
        writeFileSync(path, Buffer.concat([Buffer.from(`PF\n${width} ${height}\n-1.0\n`), Buffer.from(base64, 'base64')]));
    }
};

await { bundle, pictures }[step]();
