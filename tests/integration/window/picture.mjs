// SPDX-License-Identifier: Apache-2.0
// The picture of docs/howto/window.md, of a window of a recording of the truck crane:
//
//   picture.mjs ADDRESS CHROMIUM FILE.png     in the folder with the packages of page.mjs
import { chromium } from "playwright-core";

const [address, program, file] = process.argv.slice(2);
const browser = await chromium.launch({
  executablePath: program,
  args: ["--headless=new", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"],
});
const page = await browser.newPage({ viewport: { width: 1280, height: 800 }, colorScheme: "light" });
page.setDefaultTimeout(120_000);
await page.goto(`http://${address}/`);
await page.click('.row[data-element="Cyl_Lift"]');
await page.selectOption('[aria-label="Graphics"]', "high");
await page.locator(".playback input").fill("9");
await page.waitForTimeout(4000); // the last frames of view and plots
await page.locator(".notices p").evaluateAll((all) => all.forEach((one) => one.click())); // of a busy machine
await page.screenshot({ path: file });
await browser.close();
