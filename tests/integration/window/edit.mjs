// SPDX-License-Identifier: Apache-2.0
// The scene in the page.
import { readFileSync, renameSync } from "node:fs";
import { placeOfColor, require, rest, run, select, waitFor } from "./support.mjs";

// The named point of Bag is drawn on the bag; a click puts it into the field that was used last.
async function picksAPoint(page) {
  const mark = await waitFor("the mark of the point", () => placeOfColor(page, [0x0a, 0x5f, 0xb4]));
  await page.mouse.move(...mark);
  await waitFor("the name of the point", async () => (await page.locator(".hover").textContent()).startsWith("Bag.top  [0, 0.1, 0] m"));
  await select(page, "JibBoom_Hook");
  const field = page.locator('.scene-field[data-field="point1"] input, .scene-field[data-field="point1"] textarea');
  const before = await field.inputValue();
  await field.click();
  await page.mouse.click(...mark);
  await waitFor("the point in the field", async () => (await field.inputValue()) === "Bag.top");
  const note = page.locator('.scene-field[data-field="point1"] .note');
  await waitFor("the problem of another body's point", async () => (await note.textContent()).includes("the point is on 'Bag'"));
  await field.fill(before);
  await field.press("Enter");
  await waitFor("no problem at the field", async () => (await note.textContent()) === "");
  console.log("a named point was picked into a field");
}

// An included file names the hook.
async function refusesARename(page) {
  await select(page, "Truck_Hook");
  await page.click('[aria-label="Rename the element (F2)"]');
  await page.fill('.dialog [aria-label="Name"]', "Hook");
  await page.locator('.dialog button:text-is("Rename")').click();
  await waitFor("the line of the included file", async () =>
    /included files name 'Truck_Hook'.*: Hook\.variables \(.*side\.yaml:2\)/.test(await page.locator(".dialog .note").textContent()),
  );
  await page.locator('.dialog button:text-is("Cancel")').click();
  await select(page, "Bag");
}

// A field with an error and without, an element copied and taken back, the file, and the session that begins again.
export async function edit({ page }) {
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
  await refusesARename(page);
  await page.click('[aria-label="Copy the element"]');
  await page.locator('.dialog button:text-is("Copy")').click();
  await page.waitForSelector('.row.is-new[data-element="Bag_2"]');
  await picksAPoint(page);
  page.on("dialog", (dialog) => dialog.accept()); // what was not saved
  // a file that cannot be read just then takes nothing away
  renameSync(file, `${file}.away`);
  await page.reload();
  await page.locator(".notices p", { hasText: "nothing was changed" }).first().waitFor();
  renameSync(`${file}.away`, file);
  await page.reload();
  await page.waitForSelector('.row[data-element="Bag_2"]');
  await select(page, "Bag");
  await waitFor("the text after a reload", async () => (await field.locator("input").inputValue()) === "650 kg");
  const press = async (key) => {
    await page.locator(".panel-tree h2").click();
    await page.keyboard.press(key);
    await waitFor("the answer", async () => (await page.locator(".edit-bar .count").textContent()) !== "checking");
    return page.locator('.row[data-element="Bag_2"]').count();
  };
  let undone = 0; // changes of the picked field may be one step or two
  while ((await press("Control+z")) > 0) require(++undone < 4, "undo does not take the copy back after a reload");
  require((await press("Control+Shift+z")) === 1, "redo does not bring the copy back");
  require((await press("Control+z")) === 0, "undo does not take the copy back a second time");
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

