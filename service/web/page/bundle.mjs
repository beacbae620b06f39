// Makes dist/ of src/: `npm ci && node bundle.mjs`. The same sources give the same bytes; CI compares.
import { build } from "esbuild";
import { cpSync, readFileSync, writeFileSync } from "node:fs";

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
  outdir: "dist",
});
for (const file of ["index.html", "icon.svg"]) cpSync(`src/${file}`, `dist/${file}`);
const notices = ["preact", "uplot"].map((name) => {
  const version = JSON.parse(readFileSync(`node_modules/${name}/package.json`, "utf8")).version;
  return `${name} ${version}\n\n${readFileSync(`node_modules/${name}/LICENSE`, "utf8").trim()}\n`;
});
writeFileSync("dist/notices.txt",
  `The page contains:\n\n${notices.join("\n----------------------------------------\n\n")}`);
