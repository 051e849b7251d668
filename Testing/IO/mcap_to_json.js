// SPDX-License-Identifier: BSD-3-Clause
// What the library @mcap/core finds in an MCAP file, and the library rosmsg2-serialization in its messages, as JSON.
// usage: node mcap_to_json.js <file.mcap>   (NODE_PATH names the folder with both)
'use strict'
const fs = require('fs')
const { McapIndexedReader, McapStreamReader } = require('@mcap/core')
const { parse } = require('@foxglove/rosmsg')
const { MessageReader } = require('@foxglove/rosmsg2-serialization')

const asJson = (key, value) => typeof value === 'bigint' ? value.toString()
  : value instanceof Uint8Array ? Buffer.from(value).toString('base64')
  : value instanceof Map ? Object.fromEntries(value) : value

async function main(name) {
  const bytes = fs.readFileSync(name)
  const whole = new McapStreamReader({ validateCrcs: true }) // from begin to end
  whole.append(bytes)
  const kinds = []
  for (let record = whole.nextRecord(); record; record = whole.nextRecord()) {
    kinds.push(record.type)
  }
  const reader = await McapIndexedReader.Initialize({ readable: { // by its indices
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => bytes.subarray(Number(offset), Number(offset + size)),
  } })
  const readers = new Map()
  for (const [id, channel] of reader.channelsById) {
    const text = Buffer.from(reader.schemasById.get(channel.schemaId).data).toString()
    readers.set(id, new MessageReader(parse(text, { ros2: true })))
  }
  const messages = []
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId)
    messages.push({ topic: channel.topic, schema: reader.schemasById.get(channel.schemaId).name, logTime: message.logTime,
      message: readers.get(message.channelId).readMessage(message.data) })
  }
  return { header: reader.header, statistics: reader.statistics, done: whole.done(), kinds, messages }
}

main(process.argv[2]).then(
  (result) => process.stdout.write(JSON.stringify(result, asJson)),
  (error) => {
    console.error(error)
    process.exit(1)
  })
