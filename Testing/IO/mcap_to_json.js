// SPDX-License-Identifier: BSD-3-Clause
// What the library @mcap/core finds in an MCAP file, and the library rosmsg2-serialization in its messages, as JSON; definitions of messages
// that are not those of ROS 2 Humble.
// usage: node mcap_to_json.js <file.mcap>   (NODE_PATH names the folder with both)
'use strict'
const fs = require('fs')
const { McapIndexedReader, McapStreamReader } = require('@mcap/core')
const { parse } = require('@foxglove/rosmsg')
const { ros2humble } = require('@foxglove/rosmsg-msgs-common')
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
  const strange = []
  const plain = (definition) => JSON.stringify(definition.definitions.filter((field) => !field.isConstant)
    .map((field) => [field.name, field.type, field.isArray === true]))
  for (const [id, channel] of reader.channelsById) {
    const text = Buffer.from(reader.schemasById.get(channel.schemaId).data).toString()
    const definitions = parse(text, { ros2: true })
    for (const one of definitions) {
      const name = one.name ?? reader.schemasById.get(channel.schemaId).name.replace('/msg/', '/')
      if (!(name in ros2humble) || plain(one) !== plain(ros2humble[name])) {
        strange.push(name)
      }
    }
    readers.set(id, new MessageReader(definitions))
  }
  const messages = []
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId)
    messages.push({ topic: channel.topic, schema: reader.schemasById.get(channel.schemaId).name, logTime: message.logTime,
      message: readers.get(message.channelId).readMessage(message.data) })
  }
  return { header: reader.header, statistics: reader.statistics, done: whole.done(), kinds, messages, strange }
}

main(process.argv[2]).then(
  (result) => process.stdout.write(JSON.stringify(result, asJson)),
  (error) => {
    console.error(error)
    process.exit(1)
  })
