// SPDX-License-Identifier: Apache-2.0
// The page on a phone.
import { address, colorsOf, deadline, raw, require, waitFor } from "./support.mjs";

// Two fingers, by the protocol of the browser.
export async function phone({ browser, page: desktop }) {
  await desktop.close();
  const context = await browser.newContext({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 });
  context.setDefaultTimeout(2 * deadline);
  const page = await context.newPage();
  await page.goto(`http://${address}/`);
  await page.waitForSelector(".stick");
  await waitFor("a picture of the machine", async () => (await colorsOf(page)) > 100);
  const protocol = await context.newCDPSession(page);
  const touch = (type, points) =>
    protocol.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
  const camera = () => page.evaluate(() => JSON.parse(localStorage.getItem("slewring.workspace.truck_crane") ?? "{}").view?.camera);
  const distance = (one) => Math.hypot(...one.position.map((p, i) => p - one.target[i]));
  // fingers go from `from` to `to`, in the view; the camera then
  const gesture = async (from, to) => {
    const before = JSON.stringify(await camera());
    const box = await page.locator(".view canvas").boundingBox();
    const at = (points) => points.map(([x, y]) => [box.x + x * box.width, box.y + y * box.height]);
    await touch("touchStart", at(from));
    for (let i = 1; i <= 8; ++i) {
      await touch("touchMove", at(from.map(([x, y], k) => [x + ((to[k][0] - x) * i) / 8, y + ((to[k][1] - y) * i) / 8])));
      await page.waitForTimeout(20);
    }
    await touch("touchEnd", []);
    return waitFor("another camera", async () => JSON.stringify(await camera()) !== before && camera());
  };
  const start = await gesture([[0.3, 0.5]], [[0.35, 0.52]]); // turned
  const apart = await gesture([[0.4, 0.5], [0.6, 0.5]], [[0.2, 0.5], [0.8, 0.5]]);
  require(distance(apart) < 0.7 * distance(start), `apart: from ${distance(start)} m to ${distance(apart)} m`);
  const moved = await gesture([[0.4, 0.4], [0.6, 0.4]], [[0.5, 0.6], [0.7, 0.6]]);
  const way = Math.hypot(...moved.target.map((p, i) => p - apart.target[i]));
  require(way > 0.05 * distance(apart) && Math.abs(distance(moved) / distance(apart) - 1) < 0.1, `moved by ${way} m`);
  require((await page.locator('.row[aria-selected="true"]').count()) === 0, "two fingers have selected an element");
  // one finger on each stick: both of the first one, one of the second
  const sticks = await page.locator(".stick").evaluateAll((all) =>
    all.map((one) => {
      const { x, y, width, height } = one.getBoundingClientRect();
      return { x, y, width, height };
    }),
  );
  const on = ({ x, y, width, height }, across, along) => [x + (width * (1 + across)) / 2, y + (height * (1 - along)) / 2];
  await touch("touchStart", [on(sticks[0], 0, 0)]);
  await touch("touchStart", [on(sticks[0], 0, 0), on(sticks[1], 0, 0)]);
  await touch("touchMove", [on(sticks[0], 0.5, 0), on(sticks[1], 0, -0.5)]);
  await waitFor("both inputs", async () => Math.abs((await raw(page, "Input_Slew")) - 0.5) < 0.05 && Math.abs((await raw(page, "Input_Jib")) + 0.5) < 0.05);
  await touch("touchMove", [on(sticks[0], 0.5, 0), on(sticks[1], 0, 0)]);
  await waitFor("neutral of one stick", async () => (await raw(page, "Input_Jib")) === 0);
  await waitFor("the value of the other stick", async () => Math.abs((await raw(page, "Input_Slew")) - 0.5) < 0.05);
  await touch("touchEnd", []);
  await waitFor("neutral of both", async () => (await raw(page, "Input_Slew")) === 0);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth > window.innerWidth);
  require(!wide, "the page is wider than the phone");
  console.log("two fingers zoom and move the view, two sticks work at the same time");
}

