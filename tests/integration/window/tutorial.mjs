// SPDX-License-Identifier: Apache-2.0
// Does what docs/tutorial/in-the-window.md describes, checks it, and makes its pictures:
//
//   tutorial.mjs - ADDRESS SLEWRING CHROMIUM SCENE FOLDER ARGUMENT...
//
// SCENE: a copy of scenes/truck_crane.yaml beside its files, of whose session ADDRESS is the window and which `slewring`
// finds with ARGUMENT. FOLDER receives the pictures.
import { readFileSync } from "node:fs";
import { openPage, raw, require, rest, rowsOfCsv, run, select, shown, showsTheMachine, waitFor } from "./support.mjs";

const [file, folder, ...ofSession] = rest;
const boom = "Truck_JibBoom";

// Part of the page; without selectors all of it.
async function picture(page, name, ...selectors) {
  await page.waitForTimeout(1500); // the last frames of view and plots
  await page.locator(".notices p").evaluateAll((all) => all.forEach((one) => one.click())); // of a busy machine
  const boxes = await Promise.all(selectors.map((selector) => page.locator(selector).boundingBox()));
  const left = Math.min(...boxes.map((box) => box.x));
  const top = Math.min(...boxes.map((box) => box.y));
  const right = Math.max(...boxes.map((box) => box.x + box.width));
  const bottom = Math.max(...boxes.map((box) => box.y + box.height));
  const clip = boxes.length > 0 ? { x: left, y: top, width: right - left, height: bottom - top } : undefined;
  await page.screenshot({ path: `${folder}/tutorial_${name}.png`, clip });
}

const time = async (page) => Number.parseFloat(await page.locator(".top .time").textContent());
const passes = async (page, seconds) => {
  const start = await time(page);
  await waitFor(`${seconds} s of the session`, async () => (await time(page)) > start + seconds);
};

// ---- 1. the rigid crane

async function opensTheModel(page) {
  await showsTheMachine(page);
  await page.selectOption('[aria-label="Graphics"]', "low"); // the same pictures on every machine
  await select(page, boom);
  require((await page.locator(".values .name").allTextContents()).every((name) => !name.startsWith("deflection")), "it bends");
  await picture(page, "rigid");
}

// ---- 2. flexible by four fields

async function makesTheBoomFlexible(page) {
  await page.click('[aria-label="Edit the scene"]');
  const field = (key) => page.locator(`.scene-field[data-field="${key}"]`);
  await field("type").locator("select").selectOption("flexible");
  await waitFor("the problem of the missing files", async () => (await page.locator(".problem-count").textContent()) !== "No problems");
  await page.locator(".scene-form details").evaluateAll((all) => all.forEach((one) => (one.open = true)));
  for (const [key, value] of [
    ["flex_file_prefix", "beam_hard"],
    ["flex_modes", "1;2"],
    ["relative_damping", "0.005;0.005"],
  ]) {
    await field(key).locator("input").fill(value);
    await field(key).locator("input").press("Enter");
  }
  await waitFor("a scene without problems", async () => (await page.locator(".problem-count").textContent()) === "No problems");
  // all fields at once: a high window, in which the border above the form goes up
  await page.setViewportSize({ width: 1280, height: 1800 });
  const border = await page.locator(".border-object").boundingBox();
  await page.mouse.move(border.x + 100, border.y + 2);
  await page.mouse.down();
  await page.mouse.move(border.x + 100, 420, { steps: 4 });
  await page.mouse.up();
  await page.locator(".panel-object .object").evaluate((object) => object.scrollTo(0, 0));
  await picture(page, "fields", ".panel-object");
  await page.dblclick(".border-object");
  await page.setViewportSize({ width: 1280, height: 800 });
  await page.click('.edit-bar button:text-is("Restart")');
  await page.waitForSelector(".mode.is-not-connected");
  await page.waitForSelector(".mode.is-running");
  const text = readFileSync(file, "utf8");
  for (const line of ["type: flexible", "flex_file_prefix: beam_hard", "flex_modes: 1;2", "relative_damping: 0.005;0.005"])
    require(text.includes(line), `the file has no '${line}'`);
  await page.click('[aria-label="End the editing"]');
  await select(page, "Bag");
  await select(page, boom);
  // at rest under 500 kg the tip hangs 64 mm low (docs/tutorial/flexible-body.md, section 5)
  await waitFor("the deflection at rest", async () => Math.abs((await shown(page, "deflection.y")) + 0.064) < 0.006);
  console.log("the boom bends by four fields");
}

// ---- 3. plots

async function makesPlots(page) {
  const add = async (plot, name) => {
    const entry = page.locator(".plot").nth(plot).locator(".add-variable");
    await entry.fill(name);
    await entry.press("Enter");
    await page.locator(".plot").nth(plot).locator(`[data-variable="${name}"]`).waitFor();
  };
  while ((await page.locator(".plot .curve button").count()) > 0) await page.locator(".plot .curve button").first().click();
  await add(0, "Cyl_Lift.force");
  await add(0, "Cyl_Jib.force");
  await add(1, `${boom}.deflection.y`);
  await add(1, `${boom}.deflection.z`);
}

// The sample before the pointer is that of the file.
async function hovers(page) {
  const plot = page.locator(".plot").first();
  await page.locator(".panel-plots > header button").first().click(); // hold
  const box = await plot.locator(".u-over").boundingBox();
  await page.mouse.move(box.x + 0.6 * box.width, box.y + 0.4 * box.height);
  const note = await waitFor("the note of the sample", async () => /sample at ([\d.]+) s/.exec(await page.locator(".plot-note").textContent()));
  const value = await plot.locator('[data-variable="Cyl_Lift.force"] .number').textContent();
  await picture(page, "hover");
  const { head, rows } = await rowsOfCsv(page, plot);
  const row = rows.find((one) => Math.abs(Number(one[0]) - Number(note[1])) < 6e-4);
  require(row, `the file has no sample at ${note[1]} s`);
  const stored = Number(row[head.indexOf("Cyl_Lift.force [N]")]) / 1000;
  require(Math.abs(stored - Number(value)) < 0.006, `at the pointer ${value} kN, in the file ${stored} kN`);
  await page.click('[aria-label="Follow the newest samples"]');
  console.log(`${value} kN at ${note[1]} s`);
}

// ---- 4. a heavier bag

async function raisesTheMass(page) {
  const before = readFileSync(file, "utf8");
  await select(page, "Bag");
  const field = page.locator(".parameter", { has: page.locator('label:text-is("mass")') });
  await field.locator("input").fill("1500 kg");
  await field.locator("button").click();
  await waitFor("the step from which the mass holds", async () => /holds from step/.test(await field.locator(".note").textContent()));
  const present = () => JSON.parse(run("param", "get", "Bag.mass", ...ofSession, "--json")).value;
  await waitFor("1500 kg", () => present() === 1500);
  await field.scrollIntoViewIfNeeded();
  await passes(page, 3);
  await picture(page, "mass");
  await select(page, boom);
  await waitFor("a boom that bends further", async () => (await shown(page, "deflection.y")) < -0.15);
  require(readFileSync(file, "utf8") === before, "the file has changed");
  console.log("1500 kg bend the boom further; the file has 500 kg");
}

// ---- 5. input, recorded and played

// The fields of a busy page follow the session late.
async function atRest(page, label) {
  for (;;) {
    const before = await shown(page, label);
    await passes(page, 0.5);
    const now = await shown(page, label);
    if (Math.abs(now - before) < 1e-4) return now;
  }
}

async function recordsAndPlays(page) {
  const reset = '.controls [aria-label="Begin again from the start"]';
  const stroke = () => atRest(page, "stroke");
  await select(page, "Cyl_Lift");
  await page.click(reset);
  await waitFor("the begin", async () => (await time(page)) < 5);
  await page.click('text="Record input"');
  await page.click(".keys");
  const start = await stroke();
  await page.keyboard.down("KeyW");
  await passes(page, 3);
  await picture(page, "record", ".panel-operate");
  await page.keyboard.up("KeyW");
  await passes(page, 2);
  const [saved] = await Promise.all([page.waitForEvent("download"), page.click('text="Stop and save"')]);
  const table = `${folder}/input.csv`;
  await saved.saveAs(table);
  const way = (await stroke()) - start;
  require(Math.abs(way) > 0.02, `the lift cylinder has moved by ${way} m`);
  await page.click(reset);
  await waitFor("the begin", async () => (await time(page)) < 2);
  const again = await stroke();
  const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.click('text="Play input"')]);
  await chooser.setFiles(table);
  await waitFor("the played value", async () => Math.abs(await raw(page, "Input_Lift")) > 0.9);
  await page.locator('.tables button:text-is("Play input")').waitFor();
  const played = (await stroke()) - again;
  require(Math.abs(played - way) < 0.15 * Math.abs(way), `recorded ${way} m, played ${played} m`);
  await picture(page, "played");
  console.log(`the lift cylinder went ${way.toFixed(4)} m, and with the played input ${played.toFixed(4)} m`);
}

// ---- 6. the workspace

async function keepsTheWorkspace(page) {
  const path = `${folder}/workspace.json`;
  const variables = () => page.locator(".plot [data-variable]").evaluateAll((all) => all.map((one) => one.dataset.variable).join());
  const before = await variables();
  await page.click(".menu summary");
  await picture(page, "workspace", ".menu-body", ".top");
  const [saved] = await Promise.all([page.waitForEvent("download"), page.click('text="Save the workspace as a file"')]);
  await saved.saveAs(path);
  await page.click(".menu summary");
  await page.click('text="Reset the workspace"');
  await waitFor("the usual plots", async () => (await variables()) !== before);
  await page.click(".menu summary");
  const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.click('text="Open a workspace file"')]);
  await chooser.setFiles(path);
  await waitFor("the plots of the file", async () => (await variables()) === before);
  console.log(`the workspace with ${before} was saved and opened`);
}

const opened = await openPage();
try {
  const { page } = opened;
  page.on("dialog", (dialog) => dialog.accept());
  await opensTheModel(page);
  await makesTheBoomFlexible(page);
  await makesPlots(page);
  await passes(page, 6);
  await hovers(page);
  await raisesTheMass(page);
  await recordsAndPlays(page);
  await keepsTheWorkspace(page);
  require(opened.errors.length === 0, `errors in the page: ${opened.errors.join("\n")}`);
} catch (error) {
  console.error(`FAILED: ${error.message}`);
  process.exitCode = 1;
}
await opened.browser.close();
