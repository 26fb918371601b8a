// Prints the messages of an MCAP file as JSON, decoded by Foxglove's own packages from the
// schemas in the file alone.
import { open } from "node:fs/promises";

import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { McapIndexedReader } from "@mcap/core";
import { FileHandleReadable } from "@mcap/nodejs";

const plain = (_, value) => {
  if (typeof value === "bigint") return Number(value);
  return ArrayBuffer.isView(value) ? Array.from(value, (one) => plain("", one)) : value;
};

const file = await open(process.argv[2]);
const mcap = await McapIndexedReader.Initialize({ readable: new FileHandleReadable(file) });
const readers = new Map();
for (const channel of mcap.channelsById.values()) {
  const schema = mcap.schemasById.get(channel.schemaId);
  const definition = parse(new TextDecoder().decode(schema.data), { ros2: true });
  // For these decoders, a type without fields, such as std_msgs/Empty, has no root.
  const hasFields = definition.some((one) => one.definitions.some((field) => !field.isConstant));
  const known = hasFields ? definition : [{ definitions: [] }];
  readers.set(channel.id, new MessageReader(known, { timeType: "sec,nanosec" }));
}
const found = {};
for await (const message of mcap.readMessages()) {
  const { topic } = mcap.channelsById.get(message.channelId);
  (found[topic] ??= []).push(readers.get(message.channelId).readMessage(message.data));
}
console.log(JSON.stringify({ profile: mcap.header.profile, messages: found }, plain));
await file.close();
