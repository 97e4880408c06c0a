// SPDX-License-Identifier: Apache-2.0
// The page of a gateway without a built page: values in a table.
#pragma once

#include <string_view>

namespace slew::view_node {

inline constexpr std::string_view kBuiltInHtml = R"html(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>Slewring</title>
<style>
  :root { color-scheme: light dark; font: 15px/1.4 system-ui, sans-serif; }
  body { max-width: 60rem; margin: 1.5rem auto; padding: 0 1rem; }
  h1 { font-size: 1.3rem; margin: 0; }
  table { border-collapse: collapse; width: 100%; margin-top: 0.8rem; }
  td, th { text-align: left; padding: 0.15rem 0.6rem; border-bottom: 1px solid #8884; }
  td:nth-child(2) { text-align: right; font-variant-numeric: tabular-nums; }
  #playback[hidden] { display: none; }
  #slider { width: 20rem; vertical-align: middle; }
</style>
</head>
<body>
<h1 id="name">Slewring</h1>
<p id="state">connecting</p>
<p>For plots and a view of the machine, open <code id="address"></code> in Foxglove or Lichtblick
  (connection "Foxglove WebSocket").</p>
<p id="playback" hidden><button id="play">Play</button>
  <label>Time <input id="slider" type="range" min="0" max="1" step="0.01"></label></p>
<p><label>Show names that contain <input id="filter" type="search"></label></p>
<table><thead><tr><th>variable</th><th>value</th><th>unit</th></tr></thead><tbody id="values"></tbody></table>
<script src="page.js"></script>
</body>
</html>
)html";

inline constexpr std::string_view kBuiltInScript = R"js("use strict";
const element = (id) => document.getElementById(id);
const token = new URLSearchParams(location.search).get("token");
const query = token === null ? "" : "?token=" + encodeURIComponent(token);
const scheme = location.protocol === "https:" ? "wss" : "ws";
const address = `${scheme}://${location.host}/${query}`;
element("address").textContent = address;

const channels = new Map(); // by id
const latest = new Map(); // decoded message by id of the channel
const services = new Map(); // id by name
let socket, time = 0, range = null, calls = 0, isPlaying = false;

function leaves(schema, message, name, found) {
  for (const [key, field] of Object.entries(schema.properties ?? {})) {
    const value = message?.[key];
    const path = `${name}.${key}`;
    if (field.type === "object") leaves(field, value, path, found);
    else if (field.type === "number") found.push([path, value, field.unit ?? ""]);
  }
}

function show() {
  const wanted = element("filter").value.toLowerCase();
  const found = [];
  for (const [id, channel] of channels) {
    if (channel.isSignal) leaves(channel.fields, latest.get(id), channel.topic.slice(1), found);
  }
  const body = element("values");
  const rows = found.filter(([name]) => name.toLowerCase().includes(wanted)).slice(0, 500);
  while (body.rows.length > rows.length) body.deleteRow(-1);
  rows.forEach((row, index) => {
    const line = body.rows[index] ?? body.insertRow();
    while (line.cells.length < 3) line.insertCell();
    const texts = [row[0], typeof row[1] === "number" ? row[1].toPrecision(6) : "none", row[2]];
    texts.forEach((text, cell) => {
      if (line.cells[cell].textContent !== text) line.cells[cell].textContent = text;
    });
  });
  element("state").textContent = socket.readyState === WebSocket.OPEN ? `t = ${time.toFixed(3)} s` : element("state").textContent;
  if (range && document.activeElement !== element("slider")) element("slider").value = time;
}

function call(name, request) {
  const encoding = new TextEncoder().encode("json");
  const payload = new TextEncoder().encode(JSON.stringify(request));
  const bytes = new Uint8Array(13 + encoding.length + payload.length);
  const data = new DataView(bytes.buffer);
  data.setUint8(0, 2);
  data.setUint32(1, services.get(name), true);
  data.setUint32(5, ++calls, true);
  data.setUint32(9, encoding.length, true);
  bytes.set(encoding, 13);
  bytes.set(payload, 13 + encoding.length);
  socket.send(bytes);
}

function takeText(message) {
  if (message.op === "serverInfo") {
    element("name").textContent = message.name;
    document.title = message.name;
    if (message.dataEndTime) {
      const seconds = (t) => t.sec + t.nsec / 1e9;
      range = [seconds(message.dataStartTime), seconds(message.dataEndTime)];
      element("slider").min = range[0];
      element("slider").max = range[1];
      element("playback").hidden = false;
    }
  } else if (message.op === "advertise") {
    const inJson = message.channels.filter((channel) => channel.encoding === "json");
    for (const channel of inJson) {
      channel.isSignal = !channel.topic.startsWith("/slewring/");
      channel.fields = JSON.parse(channel.schema);
      channels.set(channel.id, channel);
    }
    const subscriptions = inJson.filter((c) => c.isSignal).map((c) => ({ id: c.id, channelId: c.id }));
    socket.send(JSON.stringify({ op: "subscribe", subscriptions }));
  } else if (message.op === "unadvertise") {
    for (const id of message.channelIds) channels.delete(id);
  } else if (message.op === "advertiseServices") {
    for (const service of message.services) services.set(service.name, service.id);
  } else if (message.op === "status" || message.op === "serviceCallFailure") {
    element("state").textContent = message.message;
  }
}

function takeBinary(buffer) {
  const data = new DataView(buffer);
  if (data.getUint8(0) === 2) time = Number(data.getBigUint64(1, true)) / 1e9;
  if (data.getUint8(0) === 1)
    latest.set(data.getUint32(1, true), JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 13))));
  if (data.getUint8(0) === 3) {
    const answer = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 13 + data.getUint32(9, true))));
    isPlaying = answer.status === "playing";
    element("play").textContent = isPlaying ? "Pause" : "Play";
  }
}

function connect() {
  socket = new WebSocket(address, ["foxglove.sdk.v1"]);
  socket.binaryType = "arraybuffer";
  socket.onmessage = (event) => (typeof event.data === "string" ? takeText(JSON.parse(event.data)) : takeBinary(event.data));
  socket.onclose = (event) => {
    channels.clear();
    element("state").textContent = `not connected${event.reason ? ": " + event.reason : ""}; connecting again each second`;
    setTimeout(connect, 1000);
  };
}

element("play").onclick = () => call(isPlaying ? "pause" : "play", {});
element("slider").oninput = () => call("seek", { time: Number(element("slider").value) });
connect();
setInterval(show, 100);
)js";

}  // namespace slew::view_node
