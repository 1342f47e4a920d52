// SPDX-License-Identifier: Apache-2.0
// usage: page_test.mjs, in page.sh's folder: every mode of the page and its keys in Chromium, sizes, time to the first paint,
// no console error, no request. Leaves screenshots/.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { cpSync, mkdirSync, rmSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const here = import.meta.dirname, shots = join(here, "screenshots");
const program = process.env.PHOTONLOOM;
rmSync(shots, { recursive: true, force: true });
mkdirSync(shots, { recursive: true });

const report = (...args) => execFileSync(program, ["report", ...args], { cwd: here, encoding: "utf8" });
const megabytes = (file) => statSync(join(here, file)).size / 1e6;

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--no-first-run"],
});

let checks = 0;
/** Opens the page, runs `use`, and fails for any console error or request. */
async function withPage(file, use, scheme = "light") {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, colorScheme: scheme, offline: true });
  const page = await context.newPage(), wrong = [];
  page.on("console", (m) => { if (m.type() === "error" || m.type() === "warning") wrong.push(m.text()); });
  page.on("pageerror", (e) => wrong.push(String(e)));
  page.on("request", (r) => { if (!/^(file|data):/.test(r.url())) wrong.push(`request of ${r.url()}`); });
  await page.goto(pathToFileURL(join(here, file)).href);
  await use(page);
  assert.equal(await page.locator("[role=alert]").count(), 0, `${file} shows an error`);
  assert.deepEqual(wrong, [], `${file} made the console speak`);
  ++checks;
  await context.close();
}
async function open(page, id) {
  await page.locator(`#${id}`).scrollIntoViewIfNeeded();
  await page.locator(`#${id}[data-built]`).waitFor();
  return page.locator(`#${id}`);
}
const shot = (page, name) => page.screenshot({ path: join(shots, `${name}.png`) });
/** What the canvas shows, as text. */
const sum = (canvas) => canvas.evaluate((c) => c.toDataURL());
async function firstPaint(page) {
  return page.evaluate(() => new Promise((done) => {
    const known = performance.getEntriesByName("first-contentful-paint")[0];
    if (known) return done(known.startTime);
    return new PerformanceObserver((list) => done(list.getEntriesByName("first-contentful-paint")[0].startTime)).observe({ type: "paint", buffered: true });
  }));
}

// A run.
console.log(report("run", "-o", "run.html"));
await withPage("run.html", async (page) => {
  await open(page, "run0-summary");
  assert.match(await page.locator("#run0-summary").innerText(), /every packet equal/);
  assert.match(await page.locator("#run0-summary").innerText(), /No region is short of photons|short of photons: /);
  await shot(page, "run-summary");

  const images = await open(page, "run0-images"), viewer = images.locator(".viewer"), canvas = images.locator("canvas").first();
  await viewer.scrollIntoViewIfNeeded();
  await viewer.focus();
  const single = await sum(canvas);
  await shot(page, "images-single");
  await page.keyboard.press("f");
  assert.match(await images.locator("figcaption").first().innerText(), /^A: reference/);
  assert.notEqual(await sum(canvas), single, "flip shows the other image");
  await page.keyboard.press("f");
  assert.equal(await sum(canvas), single, "flip twice shows the first");
  await page.keyboard.press("]");
  assert.notEqual(await sum(canvas), single, "exposure changes the picture");
  await page.keyboard.press("[");
  assert.equal(await sum(canvas), single);
  await page.keyboard.press("2");
  assert.equal(await images.locator("figure:visible").count(), 2);
  await shot(page, "images-side-by-side");
  await page.keyboard.press("3");
  assert.match(await images.locator("figcaption").first().innerText(), /A − B/);
  assert.match(await images.locator(".legend").innerText(), /A is brighter/);
  await shot(page, "images-difference");
  await page.keyboard.press("4");
  await shot(page, "images-error-map");
  const absolute = await sum(canvas);
  await images.getByLabel("error", { exact: true }).selectOption("relative");
  assert.notEqual(await sum(canvas), absolute);
  await images.getByLabel("error", { exact: true }).selectOption("flip");
  assert.match(await images.locator("figcaption").first().innerText(), /HDR-FLIP.*mean 0\.\d/);
  await shot(page, "images-flip");
  await viewer.focus();
  await page.keyboard.press("1");
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("Shift+ArrowDown");
  assert.match(await images.locator(".inspector h4").innerText(), /Pixel \(17, 26\)/);
  for (const channel of ["R", "direct.G", "caustic.B", "N.X", "Z"])
    assert.equal(await images.locator(".inspector td", { hasText: new RegExp(`^${channel.replace(".", "\\.")}$`) }).count(), 1, channel);
  for (let i = 0; i < 6; ++i) await page.keyboard.press("+");
  assert.match(await images.locator(".status").innerText(), /zoom 3\.8/);
  await shot(page, "images-zoom-inspector");
  await page.keyboard.press("0");
  await page.keyboard.press("l");
  assert.doesNotMatch(await images.locator("figcaption").first().innerText(), /, image\./);
  await page.keyboard.press("Shift+L");
  await page.keyboard.press("a");
  assert.match(await images.locator("figcaption").first().innerText(), /^A: rtl \(every layer equal to golden/);
  await canvas.click({ position: { x: 5, y: 5 } });
  assert.match(await images.locator(".inspector h4").innerText(), /Pixel \(0, 0\)/);

  assert.match(await (await open(page, "run0-first-divergence")).innerText(), /There was none: [\d,]+ packets compared/);
  const units = await open(page, "run0-units-over-time");
  assert.equal(await units.locator(".uplot").count(), 3);
  await units.scrollIntoViewIfNeeded();
  await page.waitForTimeout(300);
  await units.screenshot({ path: join(shots, "units-over-time.png") });
  const fields = await open(page, "run0-bits-given-and-used");
  assert.ok((await fields.locator("tbody tr").count()) > 25);
  await fields.screenshot({ path: join(shots, "bits.png") });
  const packets = await open(page, "run0-packets");
  assert.match(await packets.locator(".status").innerText(), /1 to 100 of 1,000 that match; the first 1,000 of [\d,]+ packets/);
  await packets.getByLabel("search packets").fill("pixel=3 map=0");
  const hits = await packets.locator("tbody tr").count();
  assert.ok(hits > 0 && hits < 100, `${hits} hits`);
  await packets.screenshot({ path: join(shots, "packets.png") });
  await packets.getByLabel("search packets").fill("teapot=3");
  assert.match(await packets.locator(".status").innerText(), /No field teapot/);
  await packets.getByLabel("search packets").fill("");
  await packets.getByLabel("stream").selectOption("gather_result");
  const resources = await open(page, "run0-resources");
  assert.match(await resources.innerText(), /all units/);
  const plan = await open(page, "run0-plan");
  await plan.getByLabel("search the plan").fill("gather.k");
  assert.match(await plan.innerText(), /gather\.k\s+8/);
  await plan.getByLabel("search the plan").fill("");
  await plan.screenshot({ path: join(shots, "plan.png") });
  await page.locator("#keys").scrollIntoViewIfNeeded();
  await page.locator("#keys").screenshot({ path: join(shots, "keys.png") });

  // Every control by Tab alone.
  await page.evaluate(() => { document.activeElement?.blur(); window.scrollTo(0, 0); });
  const reached = new Set();
  for (let i = 0; i < 120; ++i) {
    await page.keyboard.press("Tab");
    reached.add(await page.evaluate(() => document.activeElement?.className + document.activeElement?.tagName + (document.activeElement?.textContent ?? "").slice(0, 12)));
  }
  for (const what of ["viewerDIV", "BUTTONside by side", "INPUT", "BUTTONnext"])
    assert.ok([...reached].some((r) => r.includes(what)), `Tab reaches ${what}`);
});

// Dark, by the system and by the button.
await withPage("run.html", async (page) => {
  await open(page, "run0-summary");
  const back = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  assert.equal(await back(), "rgb(20, 23, 26)");
  await shot(page, "run-dark");
  await page.locator("#theme").press("Enter");
  assert.equal(await back(), "rgb(255, 255, 255)");
}, "dark");

// A run that diverges.
report("wrong", "-o", "wrong.html");
await withPage("wrong.html", async (page) => {
  assert.match(await (await open(page, "run0-summary")).innerText(), /is not golden/);
  const first = await open(page, "run0-first-divergence");
  assert.match(await first.locator("pre").innerText(), /photon_gatherer, stream result: packet \d+ differs from golden[^]*\* flux\[0\]/);
  await first.screenshot({ path: join(shots, "first-divergence.png") });
  const images = await open(page, "run0-images");
  await images.locator(".viewer").focus();
  await page.keyboard.press("3");
  await shot(page, "wrong-difference");
});

// A study, with a run whose plan is none of its points'.
report("study", "run", "-o", "study.html");
await withPage("study.html", async (page) => {
  assert.match(await (await open(page, "study0-summary")).innerText(), /What accepting more error saves/);
  await shot(page, "study-summary");
  const plot = await open(page, "study0-error-against-cost"), box = plot.locator(".plot");
  await box.scrollIntoViewIfNeeded();
  await plot.locator(".uplot").waitFor();
  await box.focus();
  await page.keyboard.press("Home");
  const first = await plot.locator(".status").innerText();
  assert.match(first, /^point \d+, cornell/);
  await page.keyboard.press("ArrowRight");
  assert.notEqual(await plot.locator(".status").innerText(), first);
  await page.keyboard.press("End");
  await plot.scrollIntoViewIfNeeded();
  await shot(page, "study-plot");
  await page.keyboard.press("Enter");
  const detail = plot.locator(".detail");
  assert.match(await detail.innerText(), /photonloom plan[^]*Its plan, and why each line[^]*gather\.k/);
  await detail.screenshot({ path: join(shots, "study-point.png") });
  const drawn = () => plot.locator("[aria-label='points drawn'] tbody tr").count();
  assert.equal(await drawn(), 14);
  assert.match(await plot.locator("[aria-label='points not drawn']").innerText(), /refused/);
  await plot.getByLabel("filter points").fill("gather.k = 8");
  assert.equal(await drawn(), 4);
  await plot.getByLabel("filter points").fill("");
  await plot.getByLabel("scene").selectOption("cornell");
  assert.equal(await drawn(), 7);
  await plot.getByLabel("cost", { exact: true }).selectOption("resources.gatherer_lut");
  await plot.getByLabel("error", { exact: true }).selectOption("visible.flip");
  await plot.getByLabel("ratio to the default").uncheck();
  await plot.getByLabel("logarithmic").uncheck();
  await box.scrollIntoViewIfNeeded();
  await shot(page, "study-plot-lut");
  // Hover: over the default plan's ring.
  await box.focus();
  await page.keyboard.press("Home");
  const at = await plot.locator(".tip").boundingBox();
  assert.ok(at, "the key shows a tip");
  const over = await plot.locator(".u-over").boundingBox();
  await page.mouse.move(over.x + 1, over.y + 1);
  for (let x = 0; x < over.width && !(await plot.locator(".tip").isVisible()); x += 12)
    for (let y = 0; y < over.height; y += 12) {
      await page.mouse.move(over.x + x, over.y + y);
      if (await plot.locator(".tip").isVisible()) break;
    }
  assert.ok(await plot.locator(".tip").isVisible(), "hover shows a tip");
  const images = await open(page, "study0-images");
  await images.locator(".viewer").nth(1).waitFor();
  assert.equal(await images.locator(".viewer").count(), 2);
});
await withPage("study.html", async (page) => {
  const plot = await open(page, "study0-error-against-cost");
  await plot.locator(".uplot").waitFor();
  await plot.locator(".plot").scrollIntoViewIfNeeded();
  await shot(page, "study-plot-dark");
}, "dark");

// Sizes. 300 points, two scenes of 512 × 512.
const points = [], scenes = ["balls", "glossy"];
for (let i = 0; i < 300; ++i) {
  const value = (mean) => ({ mean, error: mean / 50, ratio: mean, ratio_error: mean / 50 }), t = (i % 150) / 150;
  points.push({ point: i, scene: scenes[Math.floor(i / 150)], plan: i.toString(16).padStart(16, "0"), origin: "grid", state: i % 40 === 39 ? "failed" : "done",
    reason: i % 40 === 39 ? "planted" : undefined, lines: { "gather.k": String(4 + i % 60), "photon.position_bits": String(8 + i % 9) },
    command: `photonloom plan scenes/${scenes[Math.floor(i / 150)]}.xml --photons 65536 --set gather.k=${4 + i % 60}`, front: [],
    values: i % 40 === 39 ? {} : { "visible.relmse": value(0.005 * (1 + 3 * Math.exp(-4 * t) + ((i * 7919) % 97) / 97)), "gather.cycles": value(20 + 400 * t),
      "gather.bytes": value(200 + 3000 * t), "resources.gatherer_lut": value(2000 + 6000 * t) } });
}
mkdirSync(join(here, "large"), { recursive: true });
writeFileSync(join(here, "large", "points.json"), "{}");
const column = (name, unit) => ({ name, unit, meaning: name });
writeFileSync(join(here, "large", "summary.json"), JSON.stringify({ study: "large", seeds: [1, 2, 3],
  scenes: scenes.map((scene, i) => ({ scene, file: `${scene}.xml`, hash: "", failure: "", baseline: 150 * i, reference_relmse: 1e-4 })),
  measures: [{ measure: "visible", meaning: "error against path tracing", columns: [column("relmse", "")] },
    { measure: "gather", meaning: "cycles and bytes", columns: [column("cycles", "cycles"), column("bytes", "bytes")] },
    { measure: "resources", meaning: "predicted", columns: [column("gatherer_lut", "LUT-equivalents")] }],
  fronts: [{ front: "cycles", cost: "gather.cycles" }, { front: "lut", cost: "resources.gatherer_lut" }, { front: "bytes", cost: "gather.bytes" }], points }));
console.log(report("large", "-o", "large.html", "--image", "balls/reference=traced1.exr", "--image", "balls/golden=traced2.exr",
  "--image", "glossy/reference=traced2.exr", "--image", "glossy/golden=traced1.exr"));
assert.ok(megabytes("large.html") < 6, `300 points and two scenes take ${megabytes("large.html")} MB, expected less than 6`);
await withPage("large.html", async (page) => {
  const paint = await firstPaint(page);
  console.log(`large.html: ${megabytes("large.html").toFixed(2)} MB, first paint ${paint.toFixed(0)} ms`);
  assert.ok(paint < 2000, `first paint after ${paint} ms, expected less than 2000`);
  const plot = await open(page, "study0-error-against-cost");
  await plot.locator(".uplot").waitFor();
  await plot.locator(".plot").scrollIntoViewIfNeeded();
  assert.match(await plot.locator(".quiet", { hasText: "points drawn" }).innerText(), /^293 points drawn, 7 listed below/);
  await shot(page, "study-300-points");
});

// Two runs of 512 × 512 with all layers: this run's files, and images of that size in the place of its own.
for (const [run, order] of [["balls", [1, 2]], ["glossy", [2, 1]]]) {
  cpSync(join(here, "run"), join(here, run), { recursive: true });
  cpSync(join(here, `layers${order[0]}.exr`), join(here, run, "reference.exr"));
  for (const name of ["golden.exr", "rtl.exr"]) cpSync(join(here, `layers${order[1]}.exr`), join(here, run, name));
}
console.log(report("balls", "glossy", "-o", "layers.html"));
assert.ok(megabytes("layers.html") < 25, `two scenes with all layers take ${megabytes("layers.html")} MB, expected less than 25`);
await withPage("layers.html", async (page) => {
  const paint = await firstPaint(page);
  console.log(`layers.html: ${megabytes("layers.html").toFixed(2)} MB, first paint ${paint.toFixed(0)} ms`);
  assert.ok(paint < 2000, `first paint after ${paint} ms, expected less than 2000`);
  const images = await open(page, "run0-images");
  await images.locator(".viewer").focus();
  const start = Date.now();
  await page.keyboard.press("ArrowRight");
  await images.locator(".inspector table").waitFor();
  console.log(`all layers of 512 × 512 unpacked in ${Date.now() - start} ms`);
  await shot(page, "layers-512");
});

await browser.close();
console.log(`page: ${checks} pages without a console error or a request; screenshots in ${shots}`);
