// SPDX-License-Identifier: Apache-2.0
// The Foxglove WebSocket protocol: the only file that uses @foxglove/ws-protocol. Adds the control of a playback
// (opcodes 3 and 5), which is newer than the package, and connects again after a lost connection.
import type { Channel, Service } from "@foxglove/ws-protocol";
import FoxgloveClient from "@foxglove/ws-protocol/dist/esm/src/FoxgloveClient";
import { Emitter } from "./dom";

const retryMs = 1000;
const playbackState = 5; // opcode of the server
const playbackControl = 3; // opcode of the client
const decoder = new TextDecoder();
const encoder = new TextEncoder();

export interface ServerInfo {
  name: string;
  sessionId: string;
  capabilities: string[];
  metadata: Record<string, string>;
  range?: { from: number; to: number }; // s, of a recording
}

export interface ChannelInfo {
  id: number;
  topic: string;
  schema: string;
}

export interface Message {
  topic: string;
  time: number; // s
  value: unknown; // decoded JSON
}

export interface Parameter {
  name: string;
  value: number | string;
  unit: string;
  range: string;
  doc: string;
  minimum?: number;
  maximum?: number;
  choices?: string[];
  step?: number;
}

export interface Status {
  level: number; // 0 info, 1 warning, 2 error
  message: string;
  id?: string;
}

export type PlaybackStatus = "playing" | "paused" | "buffering" | "ended";
export interface PlaybackState {
  status: PlaybackStatus;
  time: number; // s
  speed: number;
}

export interface ServiceAnswer {
  accepted: boolean;
  step: number;
  reason: string;
}

type Time = { sec: number; nsec: number };
const seconds = (time: Time) => time.sec + time.nsec * 1e-9;

export class Protocol {
  readonly connected = new Emitter<ServerInfo>();
  readonly lost = new Emitter<string>();
  readonly advertised = new Emitter<ChannelInfo[]>();
  readonly unadvertised = new Emitter<number[]>();
  readonly message = new Emitter<Message>();
  readonly time = new Emitter<number>();
  readonly status = new Emitter<Status>();
  readonly parameters = new Emitter<{ parameters: Parameter[]; id?: string }>();
  readonly playback = new Emitter<PlaybackState>();
  readonly services = new Map<string, number>(); // id by name

  #address: string;
  #socket?: WebSocket;
  #client?: FoxgloveClient;
  #topics = new Map<number, string>(); // by subscription
  #calls = new Map<number, { resolve: (answer: unknown) => void; reject: (error: Error) => void }>();
  #lastCall = 0;
  #lastRequest = 0;

  constructor(address: string) {
    this.#address = address;
  }

  get isOpen(): boolean {
    return this.#socket?.readyState === WebSocket.OPEN;
  }

  connect(): void {
    const socket = new WebSocket(this.#address, ["foxglove.sdk.v1", FoxgloveClient.SUPPORTED_SUBPROTOCOL]);
    const client = new FoxgloveClient({ ws: socket });
    this.#socket = socket;
    this.#client = client;
    this.#topics.clear();
    this.services.clear();
    const forward = socket.onmessage;
    socket.onmessage = (event: MessageEvent<ArrayBuffer | string>) => {
      if (event.data instanceof ArrayBuffer && new DataView(event.data).getUint8(0) === playbackState)
        this.#takePlayback(new DataView(event.data));
      else forward?.call(socket, event);
    };
    client.on("serverInfo", (info) => {
      const { dataStartTime: from, dataEndTime: to } = info as unknown as Record<string, Time | undefined>;
      this.connected.emit({
        name: info.name,
        sessionId: info.sessionId ?? "",
        capabilities: info.capabilities,
        metadata: info.metadata ?? {},
        range: from && to ? { from: seconds(from), to: seconds(to) } : undefined,
      });
    });
    // messages of the wire itself, in CDR, are for other clients
    client.on("advertise", (channels: Channel[]) =>
      this.advertised.emit(channels.filter((channel) => channel.encoding === "json")),
    );
    client.on("unadvertise", (ids) => this.unadvertised.emit(ids));
    client.on("advertiseServices", (list: Service[]) => list.forEach((one) => this.services.set(one.name, one.id)));
    client.on("message", ({ subscriptionId, timestamp, data }) => {
      const topic = this.#topics.get(subscriptionId);
      if (topic !== undefined)
        this.message.emit({ topic, time: Number(timestamp) * 1e-9, value: JSON.parse(decoder.decode(data)) });
    });
    client.on("time", ({ timestamp }) => this.time.emit(Number(timestamp) * 1e-9));
    client.on("status", (status) => this.status.emit(status));
    client.on("parameterValues", ({ parameters, id }) =>
      this.parameters.emit({ parameters: parameters as unknown as Parameter[], id }),
    );
    client.on("serviceCallResponse", ({ callId, data }) => this.#answer(callId, JSON.parse(decoder.decode(data))));
    client.on("serviceCallFailure", ({ callId, message }) => this.#answer(callId, new Error(message)));
    client.on("error", (error) => console.warn(error));
    client.on("close", (event) => {
      for (const call of [...this.#calls.keys()]) this.#answer(call, new Error("the connection was lost"));
      this.lost.emit((event as CloseEvent).reason);
      setTimeout(() => this.connect(), retryMs);
    });
  }

  subscribe(channel: ChannelInfo): number {
    const id = this.#client!.subscribe(channel.id);
    this.#topics.set(id, channel.topic);
    return id;
  }

  unsubscribe(subscription: number): void {
    this.#topics.delete(subscription);
    if (this.isOpen) this.#client!.unsubscribe(subscription);
  }

  getParameters(): void {
    this.#client!.getParameters([], "all");
    this.#client!.subscribeParameterUpdates([]);
  }

  // Result: the id of the answer.
  setParameter(name: string, value: number | string): string {
    const id = `set ${name} ${++this.#lastRequest}`;
    this.#client!.setParameters([{ name, value }], id);
    return id;
  }

  async call(name: string, request: object): Promise<unknown> {
    const serviceId = this.services.get(name);
    if (serviceId === undefined || !this.isOpen)
      throw new Error(this.isOpen ? `this window has no service '${name}'` : "the window is not connected");
    const callId = ++this.#lastCall;
    const data = encoder.encode(JSON.stringify(request));
    return new Promise((resolve, reject) => {
      this.#calls.set(callId, { resolve, reject });
      this.#client!.sendServiceCallRequest({ serviceId, callId, encoding: "json", data });
    });
  }

  advertise(topic: string): number {
    return this.#client!.advertise({ topic, encoding: "json", schemaName: "slewring.Input" });
  }

  publish(channel: number, value: object): void {
    if (this.isOpen) this.#client!.sendMessage(channel, encoder.encode(JSON.stringify(value)));
  }

  controlPlayback(isPlaying: boolean, speed: number, seek?: number): void {
    if (!this.isOpen) return;
    const id = encoder.encode(`page ${++this.#lastRequest}`);
    const bytes = new Uint8Array(19 + id.length);
    const view = new DataView(bytes.buffer);
    view.setUint8(0, playbackControl);
    view.setUint8(1, isPlaying ? 0 : 1);
    view.setFloat32(2, speed, true);
    view.setUint8(6, seek === undefined ? 0 : 1);
    view.setBigUint64(7, BigInt(Math.round((seek ?? 0) * 1e9)), true);
    view.setUint32(15, id.length, true);
    bytes.set(id, 19);
    this.#socket!.send(bytes);
  }

  #takePlayback(view: DataView): void {
    const names: PlaybackStatus[] = ["playing", "paused", "buffering", "ended"];
    this.playback.emit({
      status: names[view.getUint8(1)] ?? "paused",
      time: Number(view.getBigUint64(2, true)) * 1e-9,
      speed: view.getFloat32(10, true),
    });
  }

  #answer(id: number, answer: unknown): void {
    const call = this.#calls.get(id);
    this.#calls.delete(id);
    if (answer instanceof Error) call?.reject(answer);
    else call?.resolve(answer);
  }
}
