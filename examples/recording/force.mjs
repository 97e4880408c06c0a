// SPDX-License-Identifier: Apache-2.0
// prints times [s] and values of one variable of a recording: node force.mjs RECORDING VARIABLE
import { readFile } from "node:fs/promises";
import { parseIDL } from "@foxglove/omgidl-parser";
import { MessageReader } from "@foxglove/omgidl-serialization";
import { McapStreamReader } from "@mcap/core";
import { decompress } from "fzstd";

const file = new McapStreamReader({ decompressHandlers: { zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size))) } });
file.append(await readFile(process.argv[2]));

const schemas = new Map(), channels = new Map(), places = new Map();
for (let record; (record = file.nextRecord()); ) {
  if (record.type === "Schema") {
    schemas.set(record.id, new MessageReader(record.name, parseIDL(new TextDecoder().decode(record.data))));
  } else if (record.type === "Channel") {
    channels.set(record.id, { topic: record.topic, reader: schemas.get(record.schemaId) });
  } else if (record.type === "Message") {
    const { topic, reader } = channels.get(record.channelId);
    if (topic === "variable_directory") {
      const directory = reader.readMessage(record.data);
      directory.entries.forEach((entry, i) => places.set(`${directory.header.role}:${directory.first + i}`, entry.name));
    } else if (topic === "variables") {
      const block = reader.readMessage(record.data);
      block.values.forEach((value, i) => {
        if (places.get(`${block.header.role}:${block.first + i}`) === process.argv[3]) {
          console.log(Number(record.logTime) * 1e-9, value);
        }
      });
    }
  }
}
