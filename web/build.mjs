// SPDX-License-Identifier: Apache-2.0
// Bundles the page:  node build.mjs [FOLDER]   (without it ../build/web)
//
// FOLDER receives index.html, scripts and styles, the licences of the bundled packages, and each file compressed.
import { build } from "esbuild";
import { mkdir, readFile, readdir, rm, writeFile } from "node:fs/promises";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const here = dirname(fileURLToPath(import.meta.url));
const folder = resolve(process.argv[2] ?? join(here, "../build/web"));

// The text of a package's licence, or what its description states.
async function licenceOf(name) {
  const root = join(here, "node_modules", name);
  const about = JSON.parse(await readFile(join(root, "package.json"), "utf8"));
  const file = (await readdir(root)).find((one) => /^licen[cs]e/i.test(one));
  const author = typeof about.author === "object" ? about.author.name : about.author;
  const text = file ? await readFile(join(root, file), "utf8") : `${about.license}\nCopyright ${author}`;
  return `${about.name} ${about.version}\n\n${text.trim()}\n`;
}

await rm(folder, { recursive: true, force: true });
await mkdir(folder, { recursive: true });
const { metafile } = await build({
  absWorkingDir: here,
  entryPoints: { page: "src/main.ts" },
  outdir: folder,
  bundle: true,
  splitting: true,
  chunkNames: "[name]-[hash]",
  minify: true,
  format: "esm",
  target: "es2022",
  legalComments: "none",
  metafile: true,
  logLevel: "warning",
});
await writeFile(join(folder, "index.html"), await readFile(join(here, "index.html")));
const packages = Object.keys(metafile.inputs).map((path) => /node_modules\/((?:@[^/]+\/)?[^/]+)/.exec(path)?.[1]);
const names = [...new Set(packages.filter(Boolean))].sort();
await writeFile(
  join(folder, "licences.txt"),
  (await Promise.all(names.map(licenceOf))).join(`\n${"-".repeat(72)}\n\n`),
);

let size = 0;
for (const name of await readdir(folder)) {
  const packed = gzipSync(await readFile(join(folder, name)), { level: 9 });
  await writeFile(join(folder, `${name}.gz`), packed);
  size += packed.length;
}
console.log(`${folder}: ${Math.round(size / 1024)} KiB compressed; packages: ${names.join(", ")}`);
