// SPDX-License-Identifier: Apache-2.0
// The page of a live session.
import foxglove from "@foxglove/ws-protocol";
import { readFileSync, writeFileSync } from "node:fs";
import WebSocket from "ws";
import {
  address, input, letRun, raw, require, rest, rowsOfCsv, run, savesSvg, select, shown, showsTheCircuit, showsTheMachine, waitFor
} from "./support.mjs";

const decoder = new TextDecoder();

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
  await page.click('.panel-view .center-switch [data-center="circuit"]');
  await page.click(".menu summary");
  await page.selectOption('[aria-label="Theme"]', "dark");
  await page.keyboard.press("Escape");
  await page.waitForFunction(() => (localStorage.getItem("slewring.workspace.truck_crane") ?? "").includes('"dark"'));
  await page.reload();
  await page.waitForSelector('html[data-theme="dark"][data-center="circuit"] .row[data-element="Cyl_Lift"]');
  console.log("the workspace is there after a reload");
}

export async function live({ page }) {
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
  // released while a command key is down
  await page.keyboard.down("KeyS");
  await waitFor("the key again", async () => (await raw(page, "Input_Lift")) === -1);
  await page.keyboard.down("Control");
  await page.keyboard.up("KeyS");
  await page.keyboard.up("Control");
  await waitFor("neutral after a command", async () => (await raw(page, "Input_Lift")) === 0);
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
  await letRun(page, 12);
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
  await letRun(page, 1);
  require(JSON.stringify(first) ===
    JSON.stringify((await rowsOfCsv(page, plot)).rows), "a held plot has other samples");
  await page.click('[aria-label="Follow the newest samples"]');
  const all = (await rowsOfCsv(page, plot)).rows.map((one) => Number(one[0]));
  require(Math.max(...all.slice(1).map((time, i) => time - all[i])) < 1, "samples are lost while a plot is held");
  const [file] = await Promise.all([page.waitForEvent("download"), plot.locator('[aria-label*="PNG"]').click()]);
  require(readFileSync(await file.path())
    .subarray(1, 4)
    .toString() === "PNG", "the picture is no PNG");
  const names = await plot.locator("[data-variable]").evaluateAll((all) => all.map((one) => one.dataset.variable));
  await savesSvg(page, plot, names);
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

// The inputs as a table, recorded while a key is held, and played after a reset.
async function recordsAndPlaysInputs(page) {
  await page.click('text="Record input"');
  await page.keyboard.down("KeyS");
  await waitFor("the key", async () => (await raw(page, "Input_Lift")) === -1);
  // long enough to be shown when it is played, on a busy machine too
  await letRun(page, 4);
  await page.keyboard.up("KeyS");
  await waitFor("neutral", async () => (await raw(page, "Input_Lift")) === 0);
  const [file] = await Promise.all([page.waitForEvent("download"), page.click('text="Stop and save"')]);
  const path = await file.path();
  const [head, ...lines] = readFileSync(path, "utf8").trim().split("\n");
  const column = head.split(",").indexOf("Input_Lift");
  const values = lines.map((line) => Number(line.split(",")[column]));
  require(head.startsWith("time,") && values.includes(-1) && values.at(-1) === 0, `the table: ${head}, ${values}`);
  await page.click('.controls [aria-label="Begin again from the start"]');
  const play = async (given) => {
    const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.click('text="Play input"')]);
    await chooser.setFiles(given);
  };
  // kept in the page, which a busy machine lets answer too late
  await input(page, "Input_Lift").locator("> .number").evaluate((number) => {
    window.shownValues = [];
    new MutationObserver(() => window.shownValues.push(Number(number.textContent)))
      .observe(number, { childList: true, characterData: true, subtree: true });
  });
  await play(path);
  await waitFor("the played value", () => page.evaluate(() => window.shownValues.includes(-1)));
  await page.locator('.tables button:text-is("Play input")').waitFor(); // its end
  await waitFor("neutral after the table", async () => (await raw(page, "Input_Lift")) === 0);
  writeFileSync(path, "time,Input_Lift\n0,0.5\n1,2\n");
  await play(path);
  await page.locator(".notices", { hasText: "line 3 is not a time and 1 values from -1 to 1" }).waitFor();
  console.log(`a table of ${lines.length} rows was recorded and played, a damaged one refused`);
}

export async function inputs({ page, context }) {
  await showsTheMachine(page);
  await page.evaluate(() => {
    window.axes = [0, 0, 0, 0];
    navigator.getGamepads = () => [{ connected: true, id: "test pad", axes: window.axes, buttons: [] }];
    window.dispatchEvent(new Event("gamepadconnected"));
  });
  await drivesByKeysAndGamepad(page);
  await recordsAndPlaysInputs(page);
  await readsAPlot(page);
  await opensAWorkspaceFile(page);
  await beginsAgain(page);
  await isNeutralWhenSuspended(page, context);
}

