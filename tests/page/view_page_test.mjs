// Drives the page of `saccade view` in headless Chromium, as a user would.
//   node view_page_test.mjs PROGRAM NODE_MODULES SESSION [PICTURES]
// Exit code 77 says that it was skipped: no Chromium here, or no such session. PICTURES: a folder for screenshots.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync, mkdirSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";

const kSkipped = 77;
const kReady_ms = 120_000; // on a loaded machine with software rendering
const [program, nodeModules, session, pictures] = process.argv.slice(2);
const later = session.includes(":") ? session.split(":")[1] : undefined;
const sessions = session.split(":");
const chromium = ["/usr/bin/chromium", "/usr/bin/chromium-browser"].find(existsSync);

function skip(why) {
  console.log(`skipped: ${why}`);
  process.exit(kSkipped);
}
if (chromium === undefined) skip("no /usr/bin/chromium (Debian package chromium)");
for (const file of sessions) if (!existsSync(file)) skip(`no session ${file}`);
if (!existsSync(path.join(nodeModules, "playwright-core"))) skip(`no playwright-core in ${nodeModules}`);
const playwright = createRequire(path.resolve(nodeModules, "package.json"))("playwright-core");

async function startServer() {
  const server = spawn(program, ["view", ...sessions], { stdio: ["ignore", "pipe", "inherit"] });
  const url = await new Promise((resolve, reject) => {
    let text = "";
    server.stdout.on("data", (part) => (text += part).includes("\n") && resolve(text.trim()));
    server.on("exit", (code) => reject(new Error(`saccade view ended with ${code}`)));
  });
  return { server, url };
}

/** Number of different colours among the pixels of the map's picture, from a coarse grid of them. */
const colorsShown = (page) =>
  page.evaluate(async () => {
    const source = await createImageBitmap(await saccade.picture());
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [160, 90];
    copy.getContext("2d").drawImage(source, 0, 0, 160, 90);
    const { data } = copy.getContext("2d").getImageData(0, 0, 160, 90);
    const seen = new Set();
    for (let i = 0; i < data.length; i += 4) seen.add((data[i] >> 3) | ((data[i + 1] >> 3) << 5) | ((data[i + 2] >> 3) << 10));
    return seen.size;
  });
const pixels = (page) => page.evaluate(async () => Array.from(new Uint8Array(await (await saccade.picture()).arrayBuffer())).join());
const rest = (page) => page.waitForFunction(() => document.body.dataset.rest === "true", undefined, { timeout: kReady_ms });
const dataOf = (page, name) => page.evaluate((n) => document.body.dataset[n], name);

async function picture(page, name) {
  if (pictures === undefined) return;
  mkdirSync(pictures, { recursive: true });
  await page.screenshot({ path: path.join(pictures, `${name}.png`) });
}

/** Clicks the middle of the map and around it until a leaf is hit. */
async function clickLeaf(page) {
  const box = await page.locator(".stage canvas").boundingBox();
  for (const [x, y] of [[0.5, 0.5], [0.45, 0.55], [0.55, 0.55], [0.5, 0.62], [0.4, 0.5], [0.6, 0.45], [0.5, 0.4]]) {
    await page.mouse.click(box.x + x * box.width, box.y + y * box.height);
    const found = await page.locator(".leaf-panel dl").first().waitFor({ timeout: 3000 }).then(() => true, () => false);
    if (found) return;
  }
  assert.fail("no click on the map met a leaf");
}

async function drive(page, url) {
  const complaints = [], elsewhere = [];
  page.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("request", (request) => {
    if (!/^(http:\/\/127\.0\.0\.1:|blob:|data:)/.test(request.url())) elsewhere.push(request.url());
  });

  await page.goto(url);
  await page.waitForFunction(() => document.body.dataset.state === "ready", undefined, { timeout: kReady_ms });
  console.log(`first picture after ${await dataOf(page, "firstPictureMs")} ms`);
  await rest(page);
  assert.ok((await colorsShown(page)) > 20, "the map's picture is blank");
  await picture(page, "loaded");

  const before = await pixels(page);
  const box = await page.locator(".stage canvas").boundingBox();
  await page.mouse.move(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.7 * box.width, box.y + 0.45 * box.height, { steps: 6 });
  await page.mouse.up();
  await rest(page);
  assert.notEqual(await pixels(page), before, "dragging does not turn the map");

  const looks = new Set();
  for (const mode of ["color", "height", "occupancy", "weight", "flag", "lastseen"]) {
    await page.click(`[data-mode=${mode}]`);
    await page.waitForFunction((m) => document.body.dataset.mode === m, mode);
    await page.waitForFunction(() => !document.querySelector(".status").textContent.includes("…"), undefined, { timeout: kReady_ms });
    await page.waitForTimeout(400);
    await rest(page);
    looks.add(await pixels(page));
    assert.ok((await colorsShown(page)) > 5, `the picture of ${mode} is blank`);
    assert.ok((await page.locator(".legend b").textContent()).length > 3);
    await picture(page, mode);
  }
  assert.equal(looks.size, 6, "two ways of colouring look the same");

  await page.click("[data-mode=weight]");
  await page.click("[data-panel=frame]");
  const last = Number(await page.locator(".slider").getAttribute("max"));
  const middle = Math.floor(last / 2);
  await page.locator(".slider").fill(String(middle));
  await page.waitForFunction((n) => document.body.dataset.frame === String(n), middle, { timeout: kReady_ms });
  await page.locator(`.when`, { hasText: `frame ${middle} ` }).waitFor();
  const tick = Number(await dataOf(page, "tick"));
  assert.ok(tick > 0 && Math.abs(tick - middle) <= middle, `attention is of tick ${tick}`);
  await page.locator(".candidates tbody tr").first().waitFor();
  const { keyframes } = await page.evaluate(() => fetch("api/summary").then((answer) => answer.json()));
  for (const layer of ["2D IOR map", "Map", ...(keyframes.length > 0 ? ["Saliency", "Colour"] : [])]) {
    await page.click(`.pictures .tabs button:text-is("${layer}")`);
    await page.waitForFunction(() => document.querySelector(".picture img")?.naturalWidth > 0, undefined, { timeout: kReady_ms });
  }
  await page.waitForTimeout(400);
  await picture(page, "middle");
  await page.keyboard.press("Escape");
  await page.click(".play");
  await page.waitForFunction((n) => Number(document.body.dataset.frame) > n, middle, { timeout: kReady_ms });
  await page.click(".play");

  if (later === undefined) {
    await page.click("[data-mode=color]");
    await page.keyboard.press("f");
    await rest(page);
    await clickLeaf(page);
    assert.match(await page.locator(".leaf-panel").textContent(), /occupancy/);
    await picture(page, "leaf");
  }

  await page.click("[data-panel=objects]");
  await page.locator(".object").first().waitFor({ timeout: kReady_ms });
  const id = await page.locator(".object").first().getAttribute("data-id");
  await page.locator(".object").first().click();
  await page.waitForFunction((n) => document.body.dataset.object === n, id);
  assert.match(await page.locator(".why").textContent(), /inhibited|open/);
  await rest(page);
  await picture(page, "object");
  await page.fill(".object-panel input", id);
  assert.equal(await page.locator(".object").first().getAttribute("data-id"), id);

  await page.click("[data-panel=view]");
  await page.click('button:text-is("From above")');
  await rest(page);
  await picture(page, "above");
  const whole = await pixels(page);
  await page.locator('.interval input[aria-label="height to"]').fill("400");
  await rest(page);
  assert.notEqual(await pixels(page), whole, "slicing changes nothing");
  await page.click('button:text-is("Show all again")');

  const download = page.waitForEvent("download");
  await page.locator(".tools button").nth(1).click();
  assert.match((await download).suggestedFilename(), /\.png$/);

  await page.locator(".tools button").nth(2).click();
  await page.keyboard.press("f");
  await page.waitForTimeout(300);
  await rest(page);
  await picture(page, "light");
  await page.setViewportSize({ width: 390, height: 844 });
  await page.waitForTimeout(500);
  await rest(page);
  await picture(page, "phone");
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "the page is wider than a phone");

  assert.deepEqual(complaints, []);
  assert.deepEqual(elsewhere, [], "the page asked somebody else");
}

const { server, url } = await startServer();
const browser = await playwright.chromium.launch({
  executablePath: chromium,
  args: ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--no-sandbox"],
});
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  page.setDefaultTimeout(60_000);
  await drive(page, url);
  await page.setViewportSize({ width: 1280, height: 720 });
  console.log(`orbit at ${(await page.evaluate(() => saccade.spin(5))).toFixed(1)} frames/s, ${await dataOf(page, "voxels")} voxels`);
  console.log("the page works");
} finally {
  await browser.close();
  server.kill("SIGINT");
}
