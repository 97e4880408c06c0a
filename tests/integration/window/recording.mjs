// SPDX-License-Identifier: Apache-2.0
// The page of recordings.
import { require, rest, rowsOfCsv, run, savesSvg, select, shown, showsTheCircuit, showsTheMachine, waitFor } from "./support.mjs";

export async function recording({ page }) {
  await page.waitForSelector(".mode.is-recording");
  await showsTheMachine(page);
  const table = run("export", rest[0], "--csv", "Cyl_Lift.stroke").trim().split("\n").slice(1);
  const stored = table.map((line) => line.split(",").map(Number));
  await select(page, "Cyl_Lift");
  await plotsTheWholeRecording(page, rest.slice(0, 1));
  const slider = page.locator(".playback input");
  let picture;
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
    // the view is drawn after the values
    picture = await waitFor(`another pose at ${time} s`, async () => {
      const now = (await page.locator(".view canvas").screenshot()).toString("base64");
      return now !== picture && now;
    });
  }
  // the slider stands at 1 s
  const pressures = run("export", rest[0], "--csv", "Vol_LiftCyl_A.pressure").trim().split("\n").slice(1);
  const [, pascals] = pressures.map((line) => line.split(",").map(Number)).findLast(([t]) => t <= 1 + 1e-9);
  await showsTheCircuit(page, (bars) =>
    require(Math.abs(bars - pascals * 1e-5) <= 0.5, `the diagram has ${bars} bar, the recording ${pascals} Pa`),
  );
  await page.selectOption('[aria-label="Speed"]', "4");
  await page.click('.playback [aria-label="Play"]');
  await waitFor("the end", async () => Number.parseFloat(await page.locator(".top .time").textContent()) >= 1.99);
  const states = () => page.locator(".nodes").textContent();
  await waitFor("the end in the panel of health", async () => (await states()).includes("ended"));
  await slider.fill("0.5");
  await waitFor("nodes that run again", async () => !(await states()).includes("ended") && (await states()).includes("running"));
  console.log("values, poses and states follow the slider, the recording plays to its end");
}

// The second run of the test may have begun in the second of the first one, and then has its name.
function nameOf(recording, i) {
  const name = recording.split("/").at(-1);
  return i > 0 && name === rest[0].split("/").at(-1) ? `${name} #${i + 1}` : name;
}

// Before anything has been played. recordings: files.
async function plotsTheWholeRecording(page, recordings) {
  const plot = page.locator(".plot", { has: page.locator('[data-variable="Cyl_Lift.stroke"]') }).first();
  const { head, rows } = await waitFor("the samples", async () => {
    const table = await rowsOfCsv(page, plot);
    return table.rows.length > 1 && table;
  });
  for (const [i, recording] of recordings.entries()) {
    const name = nameOf(recording, i);
    const column = head.indexOf(recordings.length > 1 ? `Cyl_Lift.stroke (${name}) [m]` : "Cyl_Lift.stroke [m]");
    require(column > 0, `the columns are ${head}`);
    const [, ...stored] = run("export", recording, "--csv", "Cyl_Lift.stroke").trim().split("\n");
    const shown = rows.filter((row) => row[column] !== "").map((row) => [Number(row[0]), Number(row[column])]);
    require(shown.length === stored.length, `recording ${i}: ${shown.length} of ${stored.length} samples`);
    stored.forEach((line, at) => {
      const [time, value] = line.split(",").map(Number);
      require(shown[at][0] === time && shown[at][1] === value, `recording ${i}: the plot has ${shown[at]}, the file ${line}`);
    });
  }
  console.log(`the plot has all ${rows.length} samples of ${recordings.length} recordings`);
}

// Two recordings in one plot, each with its name.
export async function beside({ page }) {
  await page.waitForSelector(".mode.is-recording");
  const names = rest.map(nameOf);
  await waitFor("the names", async () =>
    JSON.stringify(await page.locator(".recordings .recording").allTextContents()) === JSON.stringify(names),
  );
  await plotsTheWholeRecording(page, rest);
  const curve = page.locator('[data-variable="Bag.mass"]');
  await page.locator(".plot .add-variable").first().fill("Bag.mass");
  await page.locator(".plot .add-variable").first().press("Enter");
  await waitFor("the values of both", async () =>
    JSON.stringify(await curve.locator(".number").allTextContents()) === JSON.stringify(["500.00", "900.00"]),
  );
  await page.uncheck(".recordings input");
  await waitFor("one value", async () => (await curve.locator(".number").count()) === 1);
  await page.check(".recordings input");
  await savesSvg(page, page.locator(".plot").nth(1), await captionsOf(page.locator(".plot").nth(1), names));
  console.log("two recordings are shown beside each other");
}

async function captionsOf(plot, names) {
  const variables = await plot.locator("[data-variable]").evaluateAll((all) => all.map((one) => one.dataset.variable));
  return variables.flatMap((variable) => names.map((name) => `${variable} (${name})`));
}

