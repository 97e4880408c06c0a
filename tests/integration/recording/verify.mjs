// SPDX-License-Identifier: Apache-2.0
// Reads a recording with libraries that are not ours and compares it with what was written.
//
//   node verify.mjs RECORDING [EXPECTED.json]
//
// Every message of every topic is decoded with the IDL text of its schema, once through the index at the end of the
// file and once from its start with all checksums. EXPECTED.json, when given:
//   { "metadata": {"name": {"key": "value"}}, "attachments": {"name": "text"},
//     "topics": {"topic": {"type": "a::B", "messages": [{"log_time": "ns", "sequence": 1, "value": {...}}]}} }
// Integers of 64 bits and numbers that JSON lacks are strings. Prints the counts; exit code 1 names the first difference.
import { open, readFile } from "node:fs/promises";

import { parseIDL } from "@foxglove/omgidl-parser";
import { MessageReader } from "@foxglove/omgidl-serialization";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { decompress } from "fzstd";

const decompressHandlers = { zstd: (buffer, size) => decompress(buffer, new Uint8Array(Number(size))) };

class FileReadable {
  constructor(handle, size) {
    this.handle = handle;
    this.length = size;
  }
  async size() {
    return this.length;
  }
  async read(offset, size) {
    const buffer = new Uint8Array(Number(size));
    const { bytesRead } = await this.handle.read(buffer, 0, buffer.length, Number(offset));
    if (bytesRead !== buffer.length) throw new Error(`${bytesRead} of ${size} bytes at ${offset}`);
    return buffer;
  }
}

// decodes by the schema that the file itself carries
class Decoder {
  constructor() {
    this.readers = new Map();
  }
  decode(channel, schema, data) {
    if (channel.messageEncoding !== "cdr") throw new Error(`${channel.topic}: message encoding ${channel.messageEncoding}`);
    if (schema?.encoding !== "omgidl") throw new Error(`${channel.topic}: schema encoding ${schema?.encoding}`);
    let reader = this.readers.get(schema.id);
    if (reader === undefined) {
      reader = new MessageReader(schema.name, parseIDL(new TextDecoder().decode(schema.data)));
      this.readers.set(schema.id, reader);
    }
    return reader.readMessage(data);
  }
}

function compare(where, actual, expected) {
  const differ = (a, e) => {
    throw new Error(`${where}: ${a} in the file, expected ${e}`);
  };
  if (Array.isArray(expected)) {
    if (actual?.length !== expected.length) differ(`${actual?.length} elements`, expected.length);
    expected.forEach((value, i) => compare(`${where}[${i}]`, actual[i], value));
  } else if (expected !== null && typeof expected === "object") {
    const names = Object.keys(expected).sort().join(" ");
    const found = Object.keys(actual ?? {}).sort().join(" ");
    if (names !== found) differ(`fields {${found}}`, `{${names}}`);
    for (const [name, value] of Object.entries(expected)) compare(`${where}.${name}`, actual[name], value);
  } else if (typeof expected === "string" && typeof actual !== "string") {
    if (String(actual) !== expected) differ(String(actual), expected);
  } else if (!Object.is(actual, expected)) {
    differ(String(actual), String(expected));
  }
}

async function readIndexed(readable) {
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const decoder = new Decoder();
  const topics = {};
  for (const channel of reader.channelsById.values()) {
    topics[channel.topic] = { type: reader.schemasById.get(channel.schemaId)?.name, messages: [] };
  }
  let count = 0n;
  let lastTime = 0n;
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId);
    const value = decoder.decode(channel, reader.schemasById.get(channel.schemaId), message.data);
    topics[channel.topic].messages.push({ log_time: message.logTime, sequence: message.sequence, value });
    if (message.logTime < lastTime) throw new Error(`${channel.topic}: time goes back to ${message.logTime}`);
    lastTime = message.logTime;
    ++count;
  }
  if (count !== reader.statistics?.messageCount) {
    throw new Error(`${count} messages, the statistics say ${reader.statistics?.messageCount}`);
  }
  const attachments = {};
  for await (const attachment of reader.readAttachments()) {
    attachments[attachment.name] = new TextDecoder().decode(attachment.data);
  }
  const metadata = {};
  for await (const record of reader.readMetadata()) metadata[record.name] = Object.fromEntries(record.metadata);
  return { topics, attachments, metadata, count };
}

// from the first byte to the last; the messages must be those that the index leads to, in the same order by topic
async function readStream(path, indexed) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  reader.append(await readFile(path));
  const decoder = new Decoder();
  const channels = new Map();
  const schemas = new Map();
  const next = {};
  let messages = 0n;
  for (let record; (record = reader.nextRecord()) != undefined; ) {
    if (record.type === "Schema") schemas.set(record.id, record);
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type !== "Message") continue;
    const channel = channels.get(record.channelId);
    const position = (next[channel.topic] = (next[channel.topic] ?? -1) + 1);
    const value = decoder.decode(channel, schemas.get(channel.schemaId), record.data);
    const same = indexed.topics[channel.topic].messages[position];
    if (JSON.stringify(value, textOfBigInt) !== JSON.stringify(same?.value, textOfBigInt)) {
      throw new Error(`${channel.topic}: message ${position} differs between index and stream`);
    }
    ++messages;
  }
  if (!reader.done()) throw new Error("the stream ends before the file's end");
  if (messages !== indexed.count) throw new Error(`${messages} messages in the stream, ${indexed.count} in the index`);
}

function textOfBigInt(_key, value) {
  return typeof value === "bigint" ? value.toString() : value;
}

function compareWithExpected(actual, expected) {
  for (const [name, entries] of Object.entries(expected.metadata ?? {})) {
    compare(`metadata ${name}`, actual.metadata[name], entries);
  }
  for (const [name, text] of Object.entries(expected.attachments ?? {})) {
    compare(`attachment ${name}`, actual.attachments[name], text);
  }
  compare("topics", Object.keys(actual.topics).sort(), Object.keys(expected.topics).sort());
  for (const [topic, content] of Object.entries(expected.topics)) compare(topic, actual.topics[topic], content);
}

const [path, expectedPath] = process.argv.slice(2);
if (path === undefined) {
  console.error("usage: node verify.mjs RECORDING [EXPECTED.json]");
  process.exit(2);
}
const handle = await open(path);
try {
  const size = BigInt((await handle.stat()).size);
  const actual = await readIndexed(new FileReadable(handle, size));
  await readStream(path, actual);
  if (expectedPath !== undefined) compareWithExpected(actual, JSON.parse(await readFile(expectedPath, "utf8")));
  for (const [topic, { type, messages }] of Object.entries(actual.topics)) {
    console.log(`${topic}: ${messages.length} messages of ${type}`);
  }
  console.log(`verified: ${actual.count} messages${expectedPath === undefined ? "" : ", all values as expected"}`);
} catch (error) {
  console.error(`${path}: ${error.message}`);
  process.exitCode = 1;
} finally {
  await handle.close();
}
