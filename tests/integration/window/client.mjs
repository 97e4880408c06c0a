// SPDX-License-Identifier: Apache-2.0
// A client of the window by @foxglove/ws-protocol:  client.mjs live|recording ADDRESS SLEWRING [ARGUMENT...]
//
// live: ARGUMENT are those with which `slewring` finds the session. recording: ARGUMENT is the recording. Ends with an
// error, and a sentence, at the first value that is not as `slewring` itself gives it.
import foxglove from "@foxglove/ws-protocol";
import { execFileSync, spawn } from "node:child_process";
import WebSocket from "ws";

const [mode, address, slewring, ...rest] = process.argv.slice(2);
const deadline = 60_000; // ms, of each wait
const decoder = new TextDecoder();
const encoder = new TextEncoder();

function require(condition, text) {
  if (!condition) throw new Error(text);
}

async function waitFor(what, condition) {
  const end = Date.now() + deadline;
  while (Date.now() < end) {
    const result = condition();
    if (result) return result;
    await new Promise((resolve) => setTimeout(resolve, 10));
  }
  throw new Error(`${what} did not happen within ${deadline} ms`);
}

class Client {
  channels = new Map(); // by topic
  services = new Map(); // id by name
  values = new Map(); // last message by topic
  times = new Map(); // its time [ns] by topic
  counts = new Map();
  statuses = [];
  parameters = [];
  answers = new Map(); // by call
  playback = [];
  #topics = new Map(); // by subscription
  #calls = 0;

  constructor(subprotocol = foxglove.FoxgloveClient.SUPPORTED_SUBPROTOCOL) {
    this.socket = new WebSocket(address, [subprotocol]);
    // opcode 5 is newer than the package
    this.socket.on("message", (data, isBinary) => {
      const bytes = new Uint8Array(data);
      if (isBinary && bytes[0] === 5) this.playback.push(new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength));
    });
    this.client = new foxglove.FoxgloveClient({ ws: this.socket });
    this.client.on("serverInfo", (info) => (this.info = info));
    this.client.on("advertise", (list) => list.forEach((channel) => this.channels.set(channel.topic, channel)));
    this.client.on("advertiseServices", (list) => list.forEach((s) => this.services.set(s.name, s.id)));
    this.client.on("status", (status) => this.statuses.push(status.message));
    this.client.on("parameterValues", (values) => this.parameters.push(values));
    this.client.on("serviceCallResponse", (response) =>
      this.answers.set(response.callId, JSON.parse(decoder.decode(response.data))));
    this.client.on("serviceCallFailure", (failure) => this.answers.set(failure.callId, { failure: failure.message }));
    this.client.on("message", (message) => {
      const topic = this.#topics.get(message.subscriptionId);
      const isJson = this.channels.get(topic).encoding === "json";
      // a message of the wire: little-endian XCDR1 (OMG DDSI-RTPS, 10.2.1.2)
      const bytes = new Uint8Array(message.data.buffer, message.data.byteOffset, message.data.byteLength);
      if (!isJson && (bytes[0] !== 0 || bytes[1] !== 1 || bytes.length < 8)) this.statuses.push(`no CDR on ${topic}`);
      this.values.set(topic, isJson ? JSON.parse(decoder.decode(message.data)) : bytes);
      this.times.set(topic, message.timestamp);
      this.counts.set(topic, (this.counts.get(topic) ?? 0) + 1);
    });
    this.client.on("error", () => {}); // of opcode 5; others show as a value that does not come
  }
  async ready(topic) {
    await waitFor(`the channel ${topic}`, () => this.info && this.channels.has(topic));
  }
  subscribe(topic) {
    this.#topics.set(this.client.subscribe(this.channels.get(topic).id), topic);
  }
  async call(name, request) {
    await waitFor(`the service ${name}`, () => this.services.has(name));
    const callId = ++this.#calls;
    const data = encoder.encode(JSON.stringify(request));
    this.client.sendServiceCallRequest({ serviceId: this.services.get(name), callId, encoding: "json", data });
    return waitFor(`the answer to ${name}`, () => this.answers.get(callId));
  }
  control(command, speed, seekNs, id) {
    const name = encoder.encode(id);
    const bytes = new Uint8Array(19 + name.length);
    const view = new DataView(bytes.buffer);
    view.setUint8(0, 3);
    view.setUint8(1, command);
    view.setFloat32(2, speed, true);
    view.setUint8(6, seekNs === undefined ? 0 : 1);
    view.setBigUint64(7, seekNs ?? 0n, true);
    view.setUint32(15, name.length, true);
    bytes.set(name, 19);
    this.socket.send(bytes);
  }
}

const run = (...words) => execFileSync(slewring, words, { encoding: "utf8" });

// Numbers of a message by name, "position.x".
function numbers(message, prefix = "") {
  return Object.entries(message).flatMap(([key, value]) =>
    value !== null && typeof value === "object" ? numbers(value, `${prefix}${key}.`) : [[prefix + key, value]]);
}

// ---- a live session -----------------------------------------------------------------------------------------------------

async function watchesTheSameValues(client) {
  for (const topic of ["/Cyl_Lift", "/Bag", "/slewring/transforms", "/slewring/scene", "/slewring/session"])
    client.subscribe(topic);
  await waitFor("values of the crane", () => (client.counts.get("/Cyl_Lift") ?? 0) > 3);
  require((await client.call("pause", {})).accepted, "the pause was refused");
  await waitFor("the pause", () => client.values.get("/slewring/session")?.is_paused);
  // a program that comes in a pause receives the values of the next step
  const watch = spawn(slewring, ["watch", "Cyl_Lift.*", "Bag.*", ...rest, "--json"]);
  let lines = "";
  watch.stdout.on("data", (data) => (lines += data));
  const last = () => JSON.parse(lines.trim().split("\n").at(-1));
  await waitFor("the first line of slewring watch", () => lines.includes("\n"));
  const names = last().left_out ?? [];
  require(names.length === 0, `values are left out: ${names}`);
  // more than recording.every
  require((await client.call("step", { steps: 20 })).accepted, "the steps were refused");
  let expected = {};
  let compared = 0;
  const isEqual = () => {
    compared = 0;
    if (!lines.endsWith("\n")) return false;
    expected = last().values ?? {};
    return ["Cyl_Lift", "Bag"].every((element) =>
      numbers(client.values.get(`/${element}`)).every(([name, value]) => {
        ++compared;
        return value === expected[`${element}.${name}`];
      }));
  };
  await waitFor("values equal to those of slewring watch", isEqual);
  watch.kill("SIGINT");
  require(compared === Object.keys(expected).length, `${compared} of ${Object.keys(expected).length} variables came`);
  const bag = client.values.get("/slewring/transforms").transforms.find((t) => t.child_frame_id === "Bag");
  require(bag.translation.y === expected["Bag.position.y"], "the frame of the bag is not at its position");
  require(client.values.get("/slewring/scene").entities.some((e) => e.id === "Cyl_Lift/rod"), "the lift has no rod");
  require(client.channels.get("/Cyl_Lift").schema.includes('"unit":"N"'), "the schema has no unit");
  console.log(`${compared} values equal those of slewring watch`);
}

async function changesAParameter(client) {
  client.client.setParameters([{ name: "Bag.mass", value: 600 }], "set");
  const answer = await waitFor("the answer to the parameter", () => client.parameters.find((p) => p.id === "set"));
  require(answer.parameters[0].value === 600 && answer.parameters[0].step > 0, JSON.stringify(answer));
  require((await client.call("resume", {})).accepted, "the session did not go on");
  const present = () => JSON.parse(run("param", "get", "Bag.mass", ...rest, "--json")).value;
  await waitFor("the new mass", () => present() === 600);
  client.client.setParameters([{ name: "Bag.mass", value: -1 }], "wrong");
  const refusal = await waitFor("the refusal", () => client.parameters.find((p) => p.id === "wrong"));
  require(refusal.parameters[0].value === 600, "a refused value was shown");
  require(client.statuses.some((text) => text.includes("nothing was changed")), "the refusal has no reason");
  console.log(`Bag.mass = 600 kg from step ${answer.parameters[0].step} on`);
}

function drive(client, value) {
  const id = client.client.advertise({ topic: "/inputs/Input_Lift", encoding: "json", schemaName: "slewring.Input" });
  const send = () => client.client.sendMessage(id, encoder.encode(JSON.stringify({ value })));
  return setInterval(send, 20);
}

// The session's own limit for silent controllers is a minute here.
async function isNeutralWhenSilentAndWhenGone(client) {
  client.subscribe("/Input_Lift");
  const raw = () => client.values.get("/Input_Lift")?.raw;
  const silent = drive(client, 0.2);
  await waitFor("the input of the client", () => raw() === 0.2);
  const other = new Client("foxglove.sdk.v1");
  await other.ready("/Input_Lift");
  const refused = await other.call("lease", { input: "Input_Lift" });
  require(refused.accepted === false && refused.reason.includes("is held by"), JSON.stringify(refused));
  clearInterval(silent);
  await waitFor("neutral after silence", () => raw() === 0);
  require((await client.call("release", { input: "Input_Lift" })).accepted, "the release was refused");
  const gone = drive(other, -0.3);
  await waitFor("the input of the other client", () => raw() === -0.3);
  clearInterval(gone);
  other.socket.terminate();
  await waitFor("neutral after the end of the connection", () => raw() === 0);
  await waitFor("a free input", () => !client.values.get("/slewring/session").holders.Input_Lift);
  console.log("neutral after silence, and after the end of a connection");
}

async function savesAndLoads(client) {
  const saved = await client.call("save", { name: "here" });
  require(saved.accepted && saved.step > 0, JSON.stringify(saved));
  const again = await client.call("save", { name: "here" });
  require(!again.accepted && again.reason.includes("exists already"), JSON.stringify(again));
  const session = client.info.sessionId;
  const loaded = await client.call("load", { name: "here" });
  require(loaded.accepted, JSON.stringify(loaded));
  await waitFor("a new session id after the load", () => client.info.sessionId !== session);
  require((await client.call("load", { name: "there" })).accepted === false, "a state that was not saved was loaded");
  console.log(`saved and loaded the state of step ${saved.step}`);
}

// One that reads nothing costs the other client nothing, and is given the number of values that it missed.
async function aStalledClientStopsNoOther(client) {
  const stalled = new Client();
  await stalled.ready("/Bag");
  for (const topic of stalled.channels.keys()) stalled.subscribe(topic);
  await waitFor("values of the second client", () => (stalled.counts.get("/Bag") ?? 0) > 0);
  stalled.socket._socket.pause();
  // more than the buffers of both sockets hold
  const before = client.counts.get("/Bag");
  await waitFor("values beside a stalled client", () => client.counts.get("/Bag") > before + 600);
  stalled.socket._socket.resume();
  await waitFor("the number of left out values", () => stalled.statuses.some((text) => text.includes("were replaced")));
  stalled.socket.terminate();
  console.log("a stalled client was given the number of values that it missed");
}

async function live() {
  const client = new Client();
  await client.ready("/Cyl_Lift");
  require(client.socket.protocol === "foxglove.websocket.v1", `the subprotocol is ${client.socket.protocol}`);
  await watchesTheSameValues(client);
  await changesAParameter(client);
  await isNeutralWhenSilentAndWhenGone(client);
  await savesAndLoads(client);
  await aStalledClientStopsNoOther(client);
}

// ---- a recording --------------------------------------------------------------------------------------------------------

async function recording() {
  const client = new Client();
  await client.ready("/Cyl_Lift");
  const seconds = (time) => time.sec + time.nsec / 1e9;
  require(client.info.capabilities.includes("playbackControl"), "there is no capability playbackControl");
  require(seconds(client.info.dataStartTime) === 0 && seconds(client.info.dataEndTime) >= 2, JSON.stringify(client.info));
  client.subscribe("/Cyl_Lift");
  const table = run("export", rest[0], "--csv", "Cyl_Lift.stroke").trim().split("\n").slice(1);
  const rows = table.map((line) => line.split(",").map(Number));
  // forwards, backwards, and to times between two steps
  for (const time of [1.5, 0.25, 1.0005, 1.9]) {
    client.playback.length = 0;
    client.control(1, 1, BigInt(Math.round(time * 1e9)), `to ${time}`);
    const state = await waitFor(`the answer to the seek to ${time} s`, () => client.playback[0]);
    require(state.getUint8(1) === 1 && state.getUint8(14) === 1, "the playback does not stand at the new time");
    require(Number(state.getBigUint64(2, true)) === Math.round(time * 1e9), "the time is another one");
    // values have the time of their sample
    const [sampled, expected] = rows.filter(([t]) => t <= time + 1e-9).at(-1);
    await waitFor(`values at ${time} s`, () => Number(client.times.get("/Cyl_Lift")) === Math.round(sampled * 1e9));
    require(client.values.get("/Cyl_Lift").stroke === expected,
      `at ${time} s the stroke is ${client.values.get("/Cyl_Lift").stroke}, in the recording ${expected}`);
  }
  client.playback.length = 0;
  client.control(1, 1000, undefined, "too fast");
  await waitFor("the answer", () => client.playback.length > 0);
  require(client.statuses.some((text) => text.includes("0.01 to 100")), "a speed of 1000 was not refused");
  client.control(0, 100, undefined, "go");
  await waitFor("the end of the recording", () => client.playback.some((state) => state.getUint8(1) === 3));
  require((await client.call("seek", { time: 0.5 })).status === "paused", "the service does not seek");
  require((await client.call("seek", { time: 1e6 })).failure.includes("not in the recording"), "a seek beyond the end");
  require((await client.call("speed", { factor: 0 })).failure.includes("0.01 to 100"), "a speed of 0 was not refused");
  await readsCurves(client, rows);
  console.log("values at four times equal those of the recording");
}

// All samples of a variable, and the least and the largest ones of many. rows: [time, stroke] of the recording.
async function readsCurves(client, rows) {
  const request = { names: ["Cyl_Lift.stroke", "Nothing.here"], from: 0, to: 2 };
  const { curves, samples } = await client.call("curves", request);
  require(curves.length === 1 && samples === 1, `${curves.length} curves, of ${samples} samples a value`);
  const read = curves[0].times.map((time, i) => [time, curves[0].values[i]]);
  require(JSON.stringify(read) === JSON.stringify(rows), "the curve is not that of the recording");
  const thin = await client.call("curves", { ...request, most: 20 });
  const { values } = thin.curves[0];
  require(thin.samples > 1 && values.length <= 20, `${values.length} values of ${thin.samples} samples`);
  const strokes = rows.map(([, stroke]) => stroke);
  require(Math.max(...values) === Math.max(...strokes) && Math.min(...values) === Math.min(...strokes), "an extreme is lost");
  require((await client.call("curves", { ...request, recording: 1 })).failure.includes("no number"), "another recording");
}

try {
  await (mode === "live" ? live() : recording());
} catch (error) {
  console.error(`FAILED: ${error.message}`);
  process.exit(1);
}
process.exit(0);
