// SPDX-License-Identifier: Apache-2.0
// prints times [s] and Cyl_Lift.force of the window at port 8765; packages: npm install @foxglove/ws-protocol ws
import foxglove from "@foxglove/ws-protocol";
import WebSocket from "ws";
const ws = new WebSocket("ws://127.0.0.1:8765/", [foxglove.FoxgloveClient.SUPPORTED_SUBPROTOCOL]);
const client = new foxglove.FoxgloveClient({ ws });
client.on("advertise", (channels) =>
  channels.filter((c) => c.topic === "/Cyl_Lift").forEach((c) => client.subscribe(c.id)));
client.on("message", ({ timestamp, data }) =>
  console.log(Number(timestamp) / 1e9, JSON.parse(new TextDecoder().decode(data)).force));
