// SPDX-License-Identifier: Apache-2.0
// usage: node build.mjs [DIR]: bundles page/ into DIR (bundle/): page.js and page.css, the same bytes on every machine.
import { build } from "esbuild";

await build({
  absWorkingDir: import.meta.dirname,
  entryPoints: { page: "page/main.ts" },
  bundle: true,
  minify: true,
  charset: "ascii",
  legalComments: "inline",
  target: "es2022",
  format: "iife",
  outdir: process.argv[2] ?? "bundle",
  logLevel: "warning",
});
