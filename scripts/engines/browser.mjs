// The two halves of browser.sh around Chromium. `bundle`: packs an engine's render.js, the list of spheres and the maps into
// page.html of the current folder. `pictures`: reads the page's text from stdin, and writes the pictures as PFM.
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { text } from 'node:stream/consumers';

const [step, engine, out, here] = process.argv.slice(2);
const listed = JSON.parse(readFileSync(`${out}/spheres.json`));

const stop = (why) => {
    console.error(`${engine}: ${why}`);
    process.exit(2);
};

const bundle = async () => {
    const { dependencies, maps: form } = JSON.parse(readFileSync(`${here}/${engine}/package.json`));
    for (const [name, pinned] of Object.entries(dependencies)) {
        const { version } = JSON.parse(readFileSync(`node_modules/${name}/package.json`));
        if (version !== pinned) stop(`expected ${name} ${pinned}, found ${version}: remove ${process.cwd()}`);
    }
    const { build } = createRequire(`${process.cwd()}/`)('esbuild');
    const start = `
        import { engine } from '${here}/${engine}/render.js';
        import { draw } from '${here}/page.js';
        draw(engine);`;
    const made = await build({
        stdin: { contents: start, resolveDir: process.cwd() }, nodePaths: [`${process.cwd()}/node_modules`],
        bundle: true, format: 'esm', write: false, logLevel: 'error',
    });
    const maps = Object.fromEntries(listed.maps.map((name) => [name, readFileSync(`${out}/maps/${name}.${form}`).toString('base64')]));
    const script = made.outputFiles[0].text.replaceAll('</script', '<\\/script');
    writeFileSync('page.html', `<!doctype html><meta charset=utf-8><body><script>window.LISTED = ${JSON.stringify(listed)}; ` +
        `window.MAPS = ${JSON.stringify(maps)}</script><script type=module>${script}</script>`);
};

const pictures = async () => {
    const lines = (await text(process.stdin)).replaceAll(/<[^>]*>/g, '').split('\n');
    const of = (word) => lines.filter((line) => line.startsWith(`${word} `)).map((line) => line.slice(word.length + 1));
    for (const line of of('SAYS')) console.log(`${engine}: ${line}`);
    if (of('FAILED').length) stop(of('FAILED').join('\n'));
    if (!lines.includes('DONE')) stop('the page ended early');
    mkdirSync(`${out}/${engine}`, { recursive: true });
    for (const line of of('PICTURE')) {
        const [name, base64] = line.split(' ');
        const header = `PF\n${listed.size} ${listed.size}\n-1.0\n`;
        writeFileSync(`${out}/${engine}/${name}.pfm`, Buffer.concat([Buffer.from(header), Buffer.from(base64, 'base64')]));
    }
};

await { bundle, pictures }[step]();
