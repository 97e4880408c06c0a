// SPDX-License-Identifier: Apache-2.0
// The page of the window in a browser:  page.mjs CASE ADDRESS SLEWRING CHROMIUM [ARGUMENT...]
//
// live, inputs, phone: ARGUMENT are those with which `slewring` finds the session. edit: before them the file of its scene.
// recording, beside: ARGUMENT are the recordings.
// Ends with an error, and a sentence, at the first thing that is not as it should be.
import { edit } from "./edit.mjs";
import { inputs, live } from "./live.mjs";
import { phone } from "./phone.mjs";
import { beside, recording } from "./recording.mjs";
import { name, openPage, require } from "./support.mjs";

const opened = await openPage();
try {
  await { live, inputs, edit, recording, beside, phone }[name](opened);
  require(opened.errors.length === 0, `errors in the page: ${opened.errors.join("\n")}`);
} catch (error) {
  console.error(`FAILED: ${error.message}`);
  process.exitCode = 1;
}
await opened.browser.close();
