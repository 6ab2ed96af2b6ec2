// Reads an MCAP file with @mcap/core (checksums checked), decodes every message of every channel by the schema that the file brings along,
// and prints what it found as JSON. usage: node decode.mjs FILE [--stream]
// With --stream the file is read from its begin on, without an index, and may break off.
import { open, readFile } from "node:fs/promises";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { decompress } from "fzstd";

const decompressHandlers = { zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size))) };

class Topics {
  constructor() {
    this.schemas = new Map();
    this.channels = new Map();
    this.topics = {};
  }

  take(record) {
    if (record.type === "Schema") this.schemas.set(record.id, record);
    if (record.type === "Channel") this.addChannel(record);
    if (record.type === "Message") this.addMessage(record);
  }

  addChannel(channel) {
    if (this.channels.has(channel.id)) return;
    const schema = this.schemas.get(channel.schemaId);
    const definitions = parse(new TextDecoder().decode(schema.data), { ros2: true });
    this.channels.set(channel.id, { channel, reader: new MessageReader(definitions) });
    this.topics[channel.topic] = { type: schema.name, encoding: schema.encoding, messages: 0, stamps: [], first: null, last: null };
  }

  addMessage(message) {
    const { channel, reader } = this.channels.get(message.channelId);
    const topic = this.topics[channel.topic];
    const value = reader.readMessage(message.data);
    topic.messages += 1;
    topic.first ??= value;
    topic.last = value;
    if (value.header) topic.stamps.push(value.header.stamp.sec + value.header.stamp.nanosec * 1e-9);
  }
}

async function indexed(path, topics) {
  const file = await open(path);
  const readable = {
    size: async () => BigInt((await file.stat()).size),
    read: async (offset, length) => {
      const bytes = new Uint8Array(Number(length));
      await file.read(bytes, 0, Number(length), Number(offset));
      return bytes;
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  for (const schema of reader.schemasById.values()) topics.take(schema);
  for (const channel of reader.channelsById.values()) topics.take(channel);
  for await (const message of reader.readMessages()) topics.take(message);
  const attachments = [];
  for await (const attachment of reader.readAttachments()) attachments.push([attachment.name, attachment.data.byteLength]);
  const metadata = [];
  for await (const record of reader.readMetadata()) metadata.push([record.name, Object.fromEntries(record.metadata)]);
  await file.close();
  return { profile: reader.header.profile, chunks: reader.chunkIndexes.length, statistics: Number(reader.statistics.messageCount), attachments, metadata };
}

async function streamed(path, topics) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  reader.append(await readFile(path));
  for (let record = reader.nextRecord(); record; record = reader.nextRecord()) topics.take(record);
  return { done: reader.done() };
}

const [path, mode] = process.argv.slice(2);
const topics = new Topics();
const about = mode === "--stream" ? await streamed(path, topics) : await indexed(path, topics);
const plain = (key, value) => {
  if (typeof value === "bigint") return Number(value);
  if (ArrayBuffer.isView(value)) return value.length > 64 ? { length: value.length } : Array.from(value);
  return value;
};
console.log(JSON.stringify({ ...about, topics: topics.topics }, plain));
