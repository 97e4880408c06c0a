// SPDX-License-Identifier: Apache-2.0
// What the page has of the session or recording, and its requests to it.
import { Emitter } from "./dom";
import type { ChannelInfo, Message, Parameter, PlaybackState, ServerInfo, ServiceAnswer, Status } from "./protocol";
import { Protocol } from "./protocol";
import { Samples } from "./samples";
import { readValues, type Values, type Variable, variablesOf } from "./signals";

export interface InputInfo {
  name: string;
  topic: string;
  is_digital: boolean;
  is_lockstep: boolean;
}

export interface SessionState {
  step: number;
  time: number;
  is_paused: boolean;
  clients: number;
  holders: Record<string, string>;
  nodes: { role: string; state: string; overruns: number; refused: number }[];
}

export interface LogEntry {
  time: number;
  level: number; // of foxglove.Log: 1 debug, 2 info, 3 warning, 4 error, 5 fatal
  source: string;
  text: string;
  isEarlier?: boolean; // of the time before a reset
}

// A body that bends, with the places of its nodes [m] in its frame; their deflections are variables.
export interface BentBody {
  body: string;
  nodes: { id: number; position: [number, number, number] }[];
}

interface Description {
  session: string;
  scene: string;
  is_recording: boolean;
  may_steer: boolean;
  scene_file?: string; // that this page may edit
  bending?: BentBody[];
  recordings?: string[]; // of which the window has curves: the one that is played, and those beside it
  inputs: InputInfo[];
}

const kMostEntries = 500;
const kSameSeconds = 0.1; // a seek reads events again, at times that differ a little

export class Session {
  readonly changed = new Emitter(); // the description, the variables or the connection
  readonly stateChanged = new Emitter();
  readonly valuesChanged = new Emitter();
  readonly parametersChanged = new Emitter<string[]>();
  readonly logged = new Emitter();
  readonly noticed = new Emitter<Status>(); // for the person at the page
  readonly restarted = new Emitter(); // a reset or a loaded state: the time begins again
  readonly playbackChanged = new Emitter();

  info?: ServerInfo;
  description?: Description;
  state?: SessionState;
  lostReason?: string; // while there is no connection
  time = 0;
  readonly variables = new Map<string, Variable>(); // by name, in the order of the session
  readonly elements = new Map<string, Variable[]>();
  readonly values: Values = new Map(); // of the watched elements
  readonly parameters = new Map<string, Parameter>();
  readonly log: LogEntry[] = [];
  readonly samples = new Samples();
  playback: PlaybackState = { status: "paused", time: 0, speed: 1 };

  readonly protocol: Protocol;
  #token: string | null;
  #channels = new Map<string, ChannelInfo>(); // by topic
  #wanted = new Map<string, Set<(message: Message) => void>>(); // by topic
  #subscriptions = new Map<string, number>(); // by topic
  #recorded = new Map<string, { count: number; end: () => void }>(); // by element
  #answers = new Map<string, (answer: { parameter?: Parameter; problem?: string }) => void>(); // by request
  #problems = new Map<string, string>(); // of refused parameters
  #inputChannels = new Map<string, number>();

  constructor() {
    this.#token = new URLSearchParams(location.search).get("token");
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    this.protocol = new Protocol(`${scheme}://${location.host}/${this.#query()}`);
    const protocol = this.protocol;
    protocol.connected.on((info) => void this.#takeInfo(info));
    protocol.lost.on((reason) => {
      this.lostReason = reason;
      this.#channels.clear();
      this.#subscriptions.clear();
      this.#inputChannels.clear();
      for (const answer of this.#answers.values()) answer({ problem: "the connection was lost; nothing is known" });
      this.#answers.clear();
      this.changed.emit();
    });
    protocol.advertised.on((channels) => this.#takeChannels(channels));
    protocol.unadvertised.on((ids) => this.#dropChannels(new Set(ids)));
    protocol.message.on((message) => this.#wanted.get(message.topic)?.forEach((take) => take(message)));
    protocol.time.on((time) => this.#takeTime(time));
    protocol.parameters.on(({ parameters, id }) => this.#takeParameters(parameters, id));
    protocol.status.on((status) => {
      if (status.id?.startsWith("parameter ")) this.#problems.set(status.id.slice(10), status.message);
      else this.noticed.emit(status);
    });
    protocol.playback.on((state) => {
      this.playback = state;
      this.playbackChanged.emit();
    });
    this.subscribe("/slewring/session", (message) => {
      this.state = message.value as SessionState;
      this.stateChanged.emit();
    });
    this.subscribe("/slewring/log", (message) => this.#takeLog(message));
  }

  get isRecording(): boolean {
    return this.info?.range !== undefined;
  }
  get maySteer(): boolean {
    return this.info?.capabilities.includes("clientPublish") ?? false;
  }
  get isConnected(): boolean {
    return this.protocol.isOpen && this.lostReason === undefined;
  }

  // ---- channels

  subscribe(topic: string, take: (message: Message) => void): () => void {
    let takers = this.#wanted.get(topic);
    if (!takers) this.#wanted.set(topic, (takers = new Set()));
    takers.add(take);
    this.#open(topic);
    return () => {
      takers.delete(take);
      if (takers.size > 0 || this.#wanted.get(topic) !== takers) return;
      this.#wanted.delete(topic);
      const subscription = this.#subscriptions.get(topic);
      if (subscription !== undefined) this.protocol.unsubscribe(subscription);
      this.#subscriptions.delete(topic);
    };
  }

  // Keeps the values of an element up to date.
  watch(element: string): () => void {
    return this.subscribe(`/${element}`, (message) => {
      readValues(element, message.value, this.values);
      this.valuesChanged.emit();
    });
  }

  // Keeps all values of an element from now on, and those that it has already for others.
  record(element: string): () => void {
    let recorded = this.#recorded.get(element);
    if (!recorded) {
      const end = this.subscribe(`/${element}`, (message) => {
        readValues(element, message.value, this.values);
        const names = this.elements.get(element) ?? [];
        this.samples.put(
          message.time,
          names.map(({ name }) => [name, this.values.get(name) ?? null]),
        );
        this.valuesChanged.emit();
      });
      this.#recorded.set(element, (recorded = { count: 0, end }));
    }
    const mine = recorded;
    ++mine.count;
    return () => {
      if (--mine.count > 0) return;
      mine.end();
      this.#recorded.delete(element);
      this.samples.remove(element);
    };
  }

  #open(topic: string): void {
    const channel = this.#channels.get(topic);
    if (channel && this.#wanted.has(topic) && !this.#subscriptions.has(topic))
      this.#subscriptions.set(topic, this.protocol.subscribe(channel));
  }

  #takeChannels(channels: ChannelInfo[]): void {
    for (const channel of channels) {
      this.#channels.set(channel.topic, channel);
      if (channel.topic.startsWith("/slewring/")) continue;
      const variables = variablesOf(channel.topic.slice(1), channel.schema);
      this.elements.set(channel.topic.slice(1), variables);
      for (const variable of variables) this.variables.set(variable.name, variable);
    }
    for (const channel of channels) this.#open(channel.topic);
    this.changed.emit();
  }

  #dropChannels(ids: Set<number>): void {
    for (const [topic, channel] of this.#channels) {
      if (!ids.has(channel.id)) continue;
      this.#channels.delete(topic);
      this.#subscriptions.delete(topic);
      for (const variable of this.elements.get(topic.slice(1)) ?? []) this.variables.delete(variable.name);
      this.elements.delete(topic.slice(1));
    }
  }

  // ---- session

  // The address of a file of this window; also of an asset by its name in the protocol.
  urlOf(path: string): string {
    const asset = /^package:\/\/slewring\/(.*)$/.exec(path)?.[1];
    return new URL(asset === undefined ? path : `/assets/${asset}`, location.href).href + this.#query();
  }

  #query(): string {
    return this.#token === null ? "" : `?token=${encodeURIComponent(this.#token)}`;
  }

  async #takeInfo(info: ServerInfo): Promise<void> {
    const isRestart = this.info !== undefined && this.info.sessionId !== info.sessionId;
    const isNew = this.lostReason !== undefined || this.info === undefined;
    this.info = info;
    this.lostReason = undefined;
    if (isRestart) {
      if (isNew) this.#forgetMachine();
      this.samples.clear();
      for (const entry of this.log) entry.isEarlier = true;
      this.restarted.emit();
    }
    if (isNew) {
      this.log.length = 0;
      if (info.capabilities.includes("parameters")) this.protocol.getParameters();
      try {
        this.description = (await (await fetch(this.urlOf("session.json"))).json()) as Description;
      } catch (error) {
        this.noticed.emit({ level: 2, message: `the description of the session did not come: ${String(error)}` });
      }
    }
    this.changed.emit();
  }

  // Another session at this address may have another machine.
  #forgetMachine(): void {
    this.elements.clear();
    this.variables.clear();
    this.values.clear();
    this.parameters.clear();
  }

  #takeTime(time: number): void {
    const step = time - this.time;
    this.time = time;
    if (this.isRecording && step < 0) {
      // events are recorded ones: they come again
      const kept = this.log.filter((entry) => entry.time <= time);
      this.log.splice(0, this.log.length, ...kept);
      this.logged.emit();
    }
    this.valuesChanged.emit();
  }

  #takeLog(message: Message): void {
    const value = message.value as { level: number; name: string; message: string };
    const isSame = (entry: LogEntry) =>
      entry.source === value.name && entry.text === value.message && Math.abs(entry.time - message.time) < kSameSeconds;
    if (this.isRecording && this.log.some(isSame)) return;
    this.log.push({ time: message.time, level: value.level, source: value.name, text: value.message });
    if (this.log.length > kMostEntries) this.log.shift();
    this.logged.emit();
  }

  // ---- parameters

  // Result: the parameter as it is then, with the reason of a refusal.
  async setParameter(name: string, value: number | string): Promise<{ parameter?: Parameter; problem?: string }> {
    if (!this.isConnected) return { problem: "the window is not connected; nothing was changed" };
    this.#problems.delete(name);
    return new Promise((resolve) => this.#answers.set(this.protocol.setParameter(name, value), resolve));
  }

  #takeParameters(parameters: Parameter[], id?: string): void {
    for (const parameter of parameters) this.parameters.set(parameter.name, parameter);
    this.parametersChanged.emit(parameters.map((parameter) => parameter.name));
    if (id === "all") this.changed.emit();
    if (id === undefined || !this.#answers.has(id)) return;
    const name = /^set (.*) \d+$/.exec(id)?.[1] ?? "";
    this.#answers.get(id)!({ parameter: parameters[0], problem: this.#problems.get(name) });
    this.#answers.delete(id);
    this.#problems.delete(name);
  }

  // ---- services and inputs

  async call<T extends ServiceAnswer = ServiceAnswer>(service: string, request: object = {}): Promise<T> {
    try {
      const answer = (await this.protocol.call(service, request)) as T;
      if (answer.accepted === false) this.noticed.emit({ level: 2, message: `${service}: refused: ${answer.reason}` });
      return answer;
    } catch (error) {
      const reason = (error as Error).message;
      this.noticed.emit({ level: 2, message: `${service}: ${reason}` });
      return { accepted: false, step: -1, reason } as T;
    }
  }

  publishInput(input: string, value: number): void {
    if (!this.isConnected) return;
    let channel = this.#inputChannels.get(input);
    if (channel === undefined) {
      channel = this.protocol.advertise(`/inputs/${input}`);
      this.#inputChannels.set(input, channel);
    }
    this.protocol.publish(channel, { value });
  }

  controlPlayback(change: { isPlaying?: boolean; speed?: number; seek?: number }): void {
    const isPlaying = change.isPlaying ?? this.playback.status === "playing";
    this.protocol.controlPlayback(isPlaying, change.speed ?? this.playback.speed, change.seek);
  }
}
