// SPDX-License-Identifier: Apache-2.0
// The page of the window in a browser:  page.mjs CASE ADDRESS SLEWRING CHROMIUM [ARGUMENT...]
//
// live, inputs: ARGUMENT are those with which `slewring` finds the session. edit: before them the file of its scene.
// recording: ARGUMENT is the recording. Ends with an error, and a sentence, at the first thing that is not as it should be.
import foxglove from "@foxglove/ws-protocol";
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { chromium } from "playwright-core";
import WebSocket from "ws";

const [name, address, slewring, program, ...rest] = process.argv.slice(2);
const deadline = 60_000; // ms, of each wait
const decoder = new TextDecoder();
const run = (...words) => execFileSync(slewring, words, { encoding: "utf8" });

function require(condition, text) {
  if (!condition) throw new Error(text);
}

async function waitFor(what, condition) {
  const end = Date.now() + deadline;
  while (Date.now() < end) {
    const result = await condition();
    if (result) return result;
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
  throw new Error(`${what} did not happen within ${deadline} ms`);
}

async function openPage() {
  const browser = await chromium.launch({
    executablePath: program,
    args: [
      "--headless=new",
      "--use-gl=angle",
      "--use-angle=swiftshader",
      "--enable-unsafe-swiftshader",
      "--no-sandbox",
    ],
  });
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
async function colorsOf(page) {
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

async function showsTheMachine(page) {
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
async function shown(page, label) {
  const row = page.locator(".values tr", { has: page.locator(`.name:text-is("${label}")`) });
  return Number(await row.locator(".number").textContent());
}

const select = (page, element) => page.click(`.row[data-element="${element}"]`);

// ---- a live session -----------------------------------------------------------------------------------------------------

async function changesAParameter(page) {
  await select(page, "Bag");
  const field = page.locator(".parameter", { has: page.locator('label:text-is("mass")') });
  await field.locator("input").fill("600 kg");
  await field.locator("button").click();
  await waitFor("the step from which the mass holds", async () =>
    /holds from step \d+/.test(await field.locator(".note").textContent()),
  );
  const present = () => JSON.parse(run("param", "get", "Bag.mass", ...rest, "--json")).value;
  // a mass changes over half a second or so
  await waitFor("600 kg by slewring param get", () => present() === 600);
  await field.locator("input").fill("-1");
  await field.locator("button").click();
  const problem = await waitFor(
    "the refusal",
    async () =>
      (await field.getAttribute("class")).includes("is-refused") && (await field.locator(".note").textContent()),
  );
  require(problem.includes("nothing was changed"), `the refusal: ${problem}`);
  require(present() === 600, "a refused value was taken");
  console.log(`Bag.mass is 600 kg; -1: ${problem}`);
}

// The strokes by a client of its own, by their times.
function strokesOf(element) {
  const strokes = new Map();
  const socket = new WebSocket(`ws://${address}/`, ["foxglove.sdk.v1"]);
  const client = new foxglove.FoxgloveClient({ ws: socket });
  client.on("advertise", (channels) => {
    for (const channel of channels) if (channel.topic === `/${element}`) client.subscribe(channel.id);
  });
  client.on("message", ({ timestamp, data }) =>
    strokes.set(Number(timestamp), JSON.parse(decoder.decode(data)).stroke),
  );
  client.on("error", (error) => console.error(error.message));
  return { strokes, end: () => socket.terminate() };
}

async function rowsOfCsv(page, plot) {
  const [file] = await Promise.all([page.waitForEvent("download"), plot.locator('[aria-label*="CSV"]').click()]);
  const [head, ...lines] = readFileSync(await file.path(), "utf8")
    .trim()
    .split("\n");
  return { head: head.split(","), rows: lines.map((line) => line.split(",")) };
}

async function plotsWhatTheChannelHas(page) {
  const plot = page.locator(".plot", { has: page.locator('[data-variable="Cyl_Lift.stroke"]') }).first();
  const channel = strokesOf("Cyl_Lift");
  await waitFor("fifty values of the channel", () => channel.strokes.size > 50);
  const { head, rows } = await rowsOfCsv(page, plot);
  channel.end();
  const column = head.indexOf("Cyl_Lift.stroke [m]");
  require(column > 0, `the columns are ${head}`);
  let compared = 0;
  for (const row of rows) {
    const expected = channel.strokes.get(Math.round(Number(row[0]) * 1e9));
    if (expected === undefined || row[column] === "") continue;
    require(Number(row[column]) === expected, `at ${row[0]} s the plot has ${row[column]}, the channel ${expected}`);
    ++compared;
  }
  require(compared > 10, `${compared} of ${rows.length} values could be compared`);
  console.log(`${compared} values of the plot equal those of the channel`);
}

const input = (page, name) => page.locator(`.input[data-input="${name}"]`);
const raw = async (page, name) => Number(await input(page, name).locator("> .number").textContent());

async function holdSlider(page, part) {
  const box = await input(page, "Input_Lift").locator(".slider").boundingBox();
  await page.mouse.move(box.x + box.width * part, box.y + box.height / 2);
  await page.mouse.down();
}

async function drivesTheCrane(page) {
  await select(page, "Cyl_Lift");
  const before = await waitFor("the stroke", () => shown(page, "stroke"));
  await holdSlider(page, 0.9);
  await waitFor("the input", async () => (await raw(page, "Input_Lift")) > 0.7);
  await waitFor("a motion of the lift", async () => Math.abs((await shown(page, "stroke")) - before) > 2e-3);
  const holder = await input(page, "Input_Lift").locator(".holder").textContent();
  require(holder === "held by this page", `the holder is '${holder}'`);
  await page.mouse.up();
  await waitFor("neutral", async () => (await raw(page, "Input_Lift")) === 0);
  await input(page, "Input_Lift").locator("> button").click();
  await waitFor(
    "a free input",
    async () => (await input(page, "Input_Lift").locator(".holder").textContent()) === "free",
  );
  console.log(`the stroke went from ${before} m to ${await shown(page, "stroke")} m`);
}

async function pausesAndSteps(page) {
  await page.click('.controls [aria-label="Pause"]');
  await page.waitForSelector(".mode.is-paused");
  const step = async () => Number(/\d+/.exec(await page.locator(".step").textContent())[0]);
  await page.fill('[aria-label="Steps at once"]', "20");
  const before = await waitFor("a step that stands still", async () => {
    const first = await step();
    await page.waitForTimeout(300);
    return first === (await step()) && first;
  });
  await page.click('.controls [aria-label^="Compute"]');
  await waitFor("twenty steps", async () => (await step()) === before + 20);
  await page.click('.controls [aria-label="Run"]');
  await page.waitForSelector(".mode.is-running");
  console.log(`paused at step ${before}, and 20 steps further`);
}

async function keepsTheWorkspace(page) {
  await page.click(".menu summary");
  await page.selectOption('[aria-label="Theme"]', "dark");
  await page.keyboard.press("Escape");
  await page.waitForFunction(() => (localStorage.getItem("slewring.workspace.truck_crane") ?? "").includes('"dark"'));
  await page.reload();
  await page.waitForSelector('html[data-theme="dark"] .row[data-element="Cyl_Lift"]');
  console.log("the workspace is there after a reload");
}

// The diagram, with the pressures of the session; a click on a symbol selects.
async function showsTheCircuit(page, pressureOf) {
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

async function live({ page }) {
  await showsTheMachine(page);
  await showsTheCircuit(page);
  await changesAParameter(page);
  await plotsWhatTheChannelHas(page);
  await drivesTheCrane(page);
  await pausesAndSteps(page);
  await keepsTheWorkspace(page);
}

// ---- more of a live session ---------------------------------------------------------------------------------------------

async function drivesByKeysAndGamepad(page) {
  await page.click(".keys");
  await page.keyboard.down("KeyS");
  await waitFor("the key", async () => (await raw(page, "Input_Lift")) === -1);
  await page.keyboard.up("KeyS");
  await waitFor("neutral after the key", async () => (await raw(page, "Input_Lift")) === 0);
  // axis 1 of the standard layout points down; half of the way behind a dead zone of 0.12
  await page.evaluate(() => (window.axes = [0, -0.56, 0, 0]));
  await waitFor("the gamepad", async () => Math.abs((await raw(page, "Input_Lift")) - 0.5) < 2e-3);
  await page.click('[aria-label="Axes of the gamepad"]');
  await page.check('[aria-label="Invert Input_Lift"]');
  await page.uncheck('[aria-label="Invert Input_Lift"]');
  await waitFor("the other direction", async () => (await raw(page, "Input_Lift")) < -0.4);
  await page.evaluate(() => (window.axes = [0, 0, 0, 0]));
  await waitFor("neutral after the gamepad", async () => (await raw(page, "Input_Lift")) === 0);
  console.log("keys and gamepad move the input");
}

// Its script stands still, as that of a page of a machine that sleeps, and another page is open.
async function isNeutralWhenSuspended(page, context) {
  await holdSlider(page, 0.8);
  await waitFor("the input", async () => (await raw(page, "Input_Lift")) > 0.5);
  const other = await context.newPage();
  await other.goto(`http://${address}/`);
  await other.waitForSelector(".input");
  await waitFor("the value in the other page", async () => (await raw(other, "Input_Lift")) > 0.5);
  const protocol = await context.newCDPSession(page);
  await protocol.send("Debugger.enable");
  await protocol.send("Debugger.pause");
  await waitFor("neutral", async () => (await raw(other, "Input_Lift")) === 0);
  const holder = await input(other, "Input_Lift").locator(".holder").textContent();
  require(/^held by window-/.test(holder), `the other page shows '${holder}'`);
  await page.close();
  await waitFor(
    "a free input",
    async () => (await input(other, "Input_Lift").locator(".holder").textContent()) === "free",
  );
  console.log("a suspended page is neutral, a closed one gives its input back");
  return other;
}

async function readsAPlot(page) {
  await select(page, "Bag");
  // the plot begins with what was seen in the panel
  const time = async () => Number.parseFloat(await page.locator(".top .time").textContent());
  const start = await time();
  await waitFor("twelve seconds", async () => (await time()) > start + 12);
  const plot = page.locator(".plot").first();
  const row = page.locator(".values tr", { has: page.locator('.name:text-is("position.y")') });
  await row.dragTo(plot.locator(".chart"));
  await plot.locator('[data-variable="Bag.position.y"]').waitFor();
  await plot.locator('[aria-label="Two cursors with differences"]').click();
  await waitFor("differences of the cursors", async () =>
    /A -?[\d.]+ +B -?[\d.]+ +Δ -?[\d.]/.test(
      await plot.locator('[data-variable="Bag.position.y"] .number').textContent(),
    ),
  );
  const box = await plot.locator(".u-over").boundingBox();
  await page.mouse.move(box.x + box.width * 0.5, box.y + 20);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width * 0.8, box.y + 22, { steps: 4 });
  await page.mouse.up();
  await waitFor("plots that stand still", async () =>
    (await page.locator(".panel-plots > header").textContent()).includes("Follow"),
  );
  const first = (await rowsOfCsv(page, plot)).rows;
  await page.waitForTimeout(1000);
  require(JSON.stringify(first) ===
    JSON.stringify((await rowsOfCsv(page, plot)).rows), "a held plot has other samples");
  await page.click('[aria-label="Follow the newest samples"]');
  const all = (await rowsOfCsv(page, plot)).rows.map((one) => Number(one[0]));
  require(Math.max(...all.slice(1).map((time, i) => time - all[i])) < 1, "samples are lost while a plot is held");
  const [file] = await Promise.all([page.waitForEvent("download"), plot.locator('[aria-label*="PNG"]').click()]);
  require(readFileSync(await file.path())
    .subarray(1, 4)
    .toString() === "PNG", "the picture is no PNG");
  console.log("a variable was dragged into a plot, read by cursors, zoomed, held and saved");
}

async function opensAWorkspaceFile(page) {
  const save = async () => {
    await page.click(".menu summary");
    const [file] = await Promise.all([
      page.waitForEvent("download"),
      page.click('text="Save the workspace as a file"'),
    ]);
    return file.path();
  };
  const path = await save();
  const workspace = JSON.parse(readFileSync(path, "utf8"));
  require(workspace.version === 1 && workspace.plots.plots.length > 0, JSON.stringify(workspace));
  const open = async (text) => {
    writeFileSync(path, text);
    await page.click(".menu summary");
    const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.click('text="Open a workspace file"')]);
    await chooser.setFiles(path);
  };
  await open(JSON.stringify({ ...workspace, plots: { length: 5, plots: [["Bag.mass"]] } }));
  await page.locator('[data-variable="Bag.mass"]').waitFor();
  await open(JSON.stringify({ ...workspace, plots: "none" }));
  await page.locator(".notices", { hasText: "its part 'plots' is missing or damaged" }).waitFor();
  require((await page.locator('[data-variable="Bag.mass"]').count()) === 1, "a damaged workspace was opened");
  console.log("a workspace was saved and opened, a damaged one refused");
}

async function beginsAgain(page) {
  await page.click('.controls [aria-label="Begin again from the start"]');
  await waitFor("a small step", async () => Number(/\d+/.exec(await page.locator(".step").textContent())[0]) < 1000);
  await page.locator(".log", { hasText: "the session began again" }).waitFor();
  await page.keyboard.down("KeyS");
  await waitFor("the key after the reset", async () => (await raw(page, "Input_Lift")) === -1);
  await page.keyboard.up("KeyS");
  console.log("the session was reset");
}

async function inputs({ page, context }) {
  await showsTheMachine(page);
  await page.evaluate(() => {
    window.axes = [0, 0, 0, 0];
    navigator.getGamepads = () => [{ connected: true, id: "test pad", axes: window.axes, buttons: [] }];
    window.dispatchEvent(new Event("gamepadconnected"));
  });
  await drivesByKeysAndGamepad(page);
  await readsAPlot(page);
  await opensAWorkspaceFile(page);
  await beginsAgain(page);
  await isNeutralWhenSuspended(page, context);
}

// ---- the scene ----------------------------------------------------------------------------------------------------------

// A field with an error and without, an element copied and taken back, the file, and the session that begins again.
async function edit({ page }) {
  const [file, ...ofSession] = rest;
  const before = readFileSync(file, "utf8");
  const field = page.locator('.scene-field[data-field="mass"]');
  const count = page.locator(".problem-count");
  const save = page.locator('.edit-bar button:text-is("Save")');
  await select(page, "Bag");
  await page.click('[aria-label="Edit the scene"]');
  await field.locator("input").fill("-5 kg");
  await waitFor("the problem at the field", async () =>
    (await field.locator(".note").textContent()).includes("out of range"),
  );
  require((await count.textContent()) === "1 problem", `the page counts ${await count.textContent()}`);
  require(await save.isDisabled(), "a scene with a problem can be saved");
  await field.locator("input").fill("650 kg # heavy");
  await waitFor("the refusal", async () => (await field.locator(".note").textContent()).includes("needs quotes"));
  await field.locator("input").fill("650 kg");
  await waitFor("no problem", async () => (await count.textContent()) === "No problems");
  await page.click('[aria-label="Copy the element"]');
  await page.locator('.dialog button:text-is("Copy")').click();
  await page.waitForSelector('.row.is-new[data-element="Bag_2"]');
  await page.locator(".panel-tree h2").click();
  await page.keyboard.press("Control+z");
  await page.waitForSelector('.row[data-element="Bag_2"]', { state: "detached" });
  require(readFileSync(file, "utf8") === before, "the file was written before it was saved");
  await save.click();
  const expected = before.replace("    mass: 500 kg\n", "    mass: 650 kg\n");
  await waitFor("the file", () => readFileSync(file, "utf8") === expected);
  await page.click('.edit-bar button:text-is("Restart")');
  await page.waitForSelector(".mode.is-not-connected");
  await page.waitForSelector(".mode.is-running");
  const mass = JSON.parse(run("param", "get", "Bag.mass", ...ofSession, "--json")).value;
  require(mass === 650, `Bag.mass is ${mass} kg after the restart`);
  console.log("the scene was edited, saved and restarted at the same address");
}

// ---- a recording --------------------------------------------------------------------------------------------------------

async function recording({ page }) {
  await page.waitForSelector(".mode.is-recording");
  await showsTheMachine(page);
  const table = run("export", rest[0], "--csv", "Cyl_Lift.stroke").trim().split("\n").slice(1);
  const stored = table.map((line) => line.split(",").map(Number));
  await select(page, "Cyl_Lift");
  const slider = page.locator(".playback input");
  const pictures = [];
  for (const time of [0.1, 1.9, 1]) {
    await slider.fill(String(time));
    await waitFor(
      `the time ${time} s`,
      async () => (await page.locator(".top .time").textContent()) === `${time.toFixed(3)} s`,
    );
    const expected = stored.filter(([t]) => t <= time + 1e-9).at(-1)[1];
    await waitFor(
      `the stroke ${expected} m at ${time} s`,
      async () => Math.abs((await shown(page, "stroke")) - expected) <= 0.5e-5 * 1.001,
    );
    await page.waitForTimeout(500); // the view is drawn after the values
    pictures.push((await page.locator(".view canvas").screenshot()).toString("base64"));
  }
  require(pictures[0] !== pictures[1], "the view has the same pose at 0.1 s and at 1.9 s");
  // the slider stands at 1 s
  const pressures = run("export", rest[0], "--csv", "Vol_LiftCyl_A.pressure").trim().split("\n").slice(1);
  const [, pascals] = pressures.map((line) => line.split(",").map(Number)).findLast(([t]) => t <= 1 + 1e-9);
  await showsTheCircuit(page, (bars) =>
    require(Math.abs(bars - pascals * 1e-5) <= 0.5, `the diagram has ${bars} bar, the recording ${pascals} Pa`),
  );
  await page.selectOption('[aria-label="Speed"]', "4");
  await page.click('.playback [aria-label="Play"]');
  await waitFor("the end", async () => Number.parseFloat(await page.locator(".top .time").textContent()) >= 1.99);
  console.log("values and poses follow the slider, the recording plays to its end");
}

// -------------------------------------------------------------------------------------------------------------------------

const opened = await openPage();
try {
  await { live, inputs, edit, recording }[name](opened);
  require(opened.errors.length === 0, `errors in the page: ${opened.errors.join("\n")}`);
} catch (error) {
  console.error(`FAILED: ${error.message}`);
  process.exitCode = 1;
}
await opened.browser.close();
