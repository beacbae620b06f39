// Makes dist/, or the folder that is named, of src/: `npm ci && node bundle.mjs [FOLDER]`. The same
// sources give the same bytes; a test compares.
import { build } from "esbuild";
import { cpSync, readFileSync, writeFileSync } from "node:fs";

const target = process.argv[2] ?? "dist";

await build({
  entryPoints: ["src/main.tsx"],
  entryNames: "page",
  bundle: true,
  minify: true,
  format: "esm",
  target: ["chrome100", "firefox100", "safari15"],
  legalComments: "none",
  jsx: "automatic",
  jsxImportSource: "preact",
  outdir: target,
});
for (const file of ["index.html", "icon.svg"]) cpSync(`src/${file}`, `${target}/${file}`);
const notices = ["preact", "uplot"].map((name) => {
  const version = JSON.parse(readFileSync(`node_modules/${name}/package.json`, "utf8")).version;
  return `${name} ${version}\n\n${readFileSync(`node_modules/${name}/LICENSE`, "utf8").trim()}\n`;
});
writeFileSync(`${target}/notices.txt`,
  `The page contains:\n\n${notices.join("\n----------------------------------------\n\n")}`);
