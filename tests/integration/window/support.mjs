// SPDX-License-Identifier: Apache-2.0
// What all scripts over the page share: a browser, waiting, and what the page shows.
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { chromium } from "playwright-core";

export const [name, address, slewring, program, ...rest] = process.argv.slice(2); // as page.mjs and tutorial.mjs have them
export const deadline = 60_000; // ms, of each wait

export const run = (...words) => execFileSync(slewring, words, { encoding: "utf8" });

export function require(condition, text) {
  if (!condition) throw new Error(text);
}

export async function waitFor(what, condition) {
  const end = Date.now() + deadline;
  while (Date.now() < end) {
    const result = await condition();
    if (result) return result;
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
  throw new Error(`${what} did not happen within ${deadline} ms`);
}

export async function startBrowser() {
  return chromium.launch({
    executablePath: program,
    args: ["--headless=new", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"],
  });
}

export async function openPage() {
  const browser = await startBrowser();
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, acceptDownloads: true });
  context.setDefaultTimeout(2 * deadline);
  const page = await context.newPage();
  const errors = [];
  page.on("pageerror", (error) => errors.push(error.stack));
  await page.goto(`http://${address}/`);
  await page.waitForSelector('.row[data-element="Cyl_Lift"]');
  return { browser, context, page, errors };
}

// Number of colours in the picture of the machine.
export async function colorsOf(page) {
  const picture = (await page.locator(".view canvas").screenshot()).toString("base64");
  return page.evaluate(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [image.width, image.height];
    const draw = canvas.getContext("2d");
    draw.drawImage(image, 0, 0);
    return new Set(new Uint32Array(draw.getImageData(0, 0, image.width, image.height).data.buffer)).size;
  }, picture);
}

// Middle of the pixels of a colour in the picture of the machine, in the page; undefined: there are none.
export async function placeOfColor(page, color) {
  const canvas = page.locator(".view canvas");
  const box = await canvas.boundingBox();
  const picture = (await canvas.screenshot()).toString("base64");
  const place = await page.evaluate(
    async ([data, [r, g, b]]) => {
      const image = new Image();
      image.src = `data:image/png;base64,${data}`;
      await image.decode();
      const copy = document.createElement("canvas");
      [copy.width, copy.height] = [image.width, image.height];
      const draw = copy.getContext("2d");
      draw.drawImage(image, 0, 0);
      const { data: bytes } = draw.getImageData(0, 0, image.width, image.height);
      let [x, y, count] = [0, 0, 0];
      for (let i = 0; i < bytes.length; i += 4) {
        if (Math.abs(bytes[i] - r) + Math.abs(bytes[i + 1] - g) + Math.abs(bytes[i + 2] - b) > 12) continue;
        x += (i / 4) % image.width;
        y += Math.floor(i / 4 / image.width);
        ++count;
      }
      return count > 5 ? [x / count, y / count] : undefined;
    },
    [picture, color],
  );
  return place && [box.x + place[0], box.y + place[1]];
}

export async function showsTheMachine(page) {
  await waitFor("a picture of the machine", async () => (await colorsOf(page)) > 100);
  const rows = await page.locator(".tree .row").allTextContents();
  for (const element of ["Bag", "Truck_LiftBoom", "Cyl_Lift", "Input_Lift"])
    require(rows.includes(element), `the tree has no ${element}: ${rows}`);
  await page.fill(".panel-tree input", "stroke");
  await waitFor("the filter", async () => (await page.locator(".tree .row").allTextContents()).includes("Cyl_Lift"));
  require(!(await page.locator(".tree .row").allTextContents()).includes("Bag"), "the filter leaves Bag");
  await page.fill(".panel-tree input", "");
  console.log(`the view is drawn, the tree has ${rows.length} rows`);
}

// The value of a variable in the object panel, in the unit that is shown.
export async function shown(page, label) {
  const row = page.locator(".values tr", { has: page.locator(`.name:text-is("${label}")`) });
  return Number(await row.locator(".number").textContent());
}

export const select = (page, element) => page.click(`.row[data-element="${element}"]`);

export const input = (page, name) => page.locator(`.input[data-input="${name}"]`);
export const raw = async (page, name) => Number(await input(page, name).locator("> .number").textContent());

export const sessionTime = async (page) => Number.parseFloat(await page.locator(".top .time").textContent());

// Waits until the session is that much further [s].
export async function letRun(page, seconds) {
  const start = await sessionTime(page);
  await waitFor(`${seconds} s of the session`, async () => (await sessionTime(page)) > start + seconds);
}

export async function rowsOfCsv(page, plot) {
  const [file] = await Promise.all([page.waitForEvent("download"), plot.locator('[aria-label*="CSV"]').click()]);
  const [head, ...lines] = readFileSync(await file.path(), "utf8")
    .trim()
    .split("\n");
  return { head: head.split(","), rows: lines.map((line) => line.split(",")) };
}

// The visible window as a picture of vectors: a path for each curve, with captions.
export async function savesSvg(page, plot, names) {
  const [file] = await Promise.all([page.waitForEvent("download"), plot.locator('[aria-label*="SVG"]').click()]);
  const text = readFileSync(await file.path(), "utf8");
  const paths = await page.evaluate((source) => {
    const svg = new DOMParser().parseFromString(source, "image/svg+xml").documentElement;
    if (svg.nodeName !== "svg") return [];
    return [...svg.querySelectorAll("path[clip-path]")].map((path) => path.getAttribute("d").length);
  }, text);
  require(paths.length === names.length && Math.min(...paths) > 200, `the SVG has paths of ${paths} characters`);
  for (const name of names) require(text.includes(`>${name}`), `the SVG has no caption ${name}`);
}

// The diagram, with the pressures of the session; a click on a symbol selects.
export async function showsTheCircuit(page, pressureOf) {
  await page.click('.panel-view .center-switch [data-center="circuit"]');
  const volume = page.locator('.panel-circuit .volume[data-volume="Vol_LiftCyl_A"]');
  await waitFor("the pressure in the diagram", async () =>
    /^[\d.]+ bar$/.test((await volume.locator(".value").textContent()) ?? ""),
  );
  await pressureOf?.(Number.parseFloat(await volume.locator(".value").textContent()));
  const symbols = page.locator(".panel-circuit .symbol[data-element]");
  require((await symbols.count()) > 15, `the diagram has ${await symbols.count()} symbols`);
  await waitFor("a value at the pump", async () =>
    /%/.test((await page.locator('.panel-circuit [data-element="MainPump"] .value').textContent()) ?? ""),
  );
  await page.click('.panel-circuit [data-element="Cyl_Jib"]');
  await page.waitForSelector('.tree .row[data-element="Cyl_Jib"][aria-selected="true"]');
  await page.click('.panel-circuit .center-switch [data-center="view"]');
  await page.waitForSelector(".view canvas", { state: "visible" });
  console.log("the circuit shows pressures, a click on a symbol selects");
}

