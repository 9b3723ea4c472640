// Builds dist/: the extension, its panel, and the licenses of what is in it.

import { build } from "esbuild";
import { readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";

const common = { bundle: true, minify: true, legalComments: "none", target: "es2022", metafile: true, logLevel: "warning" };
rmSync("dist", { recursive: true, force: true });
const { metafile } = await build({
  ...common,
  entryPoints: ["src/extension.ts"],
  outfile: "dist/extension.js",
  platform: "node",
  format: "cjs",
  external: ["vscode"],
});
await build({
  ...common,
  entryPoints: ["src/panel/page.ts", "src/panel/page.css"],
  outdir: "dist/panel",
  format: "esm",
});

const packages = new Set();
for (const input of Object.keys(metafile.inputs)) {
  const found = input.match(/^(?:.*\/)?node_modules\/(?:@[^/]+\/)?[^/]+/);
  if (found) packages.add(found[0]);
}
const notices = [...packages].sort().map((folder) => {
  const { name, version } = JSON.parse(readFileSync(`${folder}/package.json`, "utf8"));
  const license = readdirSync(folder).find((file) => /^licen[cs]e/i.test(file));
  if (!license) throw new Error(`${name} has no license file`);
  return `${name} ${version}\n\n${readFileSync(`${folder}/${license}`, "utf8").trim()}\n`;
});
writeFileSync("dist/third-party-licenses.txt", notices.join("\n\n"));

const licenses = ["MIT", "APACHE"].map((name) => readFileSync(`../../LICENSE-${name}`, "utf8").trim());
const choice = "Licensed under either of the MIT License and the Apache License, Version 2.0, at your choice.";
writeFileSync("LICENSE.txt", `${[choice, ...licenses].join("\n\n\n")}\n`);
