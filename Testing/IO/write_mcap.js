// SPDX-License-Identifier: BSD-3-Clause
// Writes an MCAP file with the library @mcap/core, and its messages with rosmsg2-serialization: two clouds of three points (x, y, z, and
// ring), and a static transform.
// usage: node write_mcap.js <file.mcap> <chunks: true or false>   (NODE_PATH names the folder with both)
'use strict'
const fs = require('fs')
const { McapWriter } = require('@mcap/core')
const { ros2humble } = require('@foxglove/rosmsg-msgs-common')
const { MessageWriter } = require('@foxglove/rosmsg2-serialization')

const parts = { cloud: 'sensor_msgs/PointCloud2', tf: 'tf2_msgs/TFMessage' }
const definitions = (name, found = new Map()) => {
  if (!found.has(name)) {
    found.set(name, ros2humble[name])
    ros2humble[name].definitions.filter((field) => field.isComplex).forEach((field) => definitions(field.type, found))
  }
  return [...found].map(([key, value], number) => ({ ...value, name: number ? key : undefined }))
}

async function main(name, useChunks) {
  const file = fs.openSync(name, 'w')
  let size = 0n
  const mcap = new McapWriter({ useChunks, writable: {
    position: () => size,
    write: async (bytes) => { size += BigInt(fs.writeSync(file, bytes)) },
  } })
  await mcap.start({ profile: 'ros2', library: 'test' })
  const channels = {}
  for (const [key, kind] of Object.entries(parts)) {
    const schemaId = await mcap.registerSchema({ name: kind.replace('/', '/msg/'), encoding: 'ros2msg', data: new Uint8Array() })
    channels[key] = await mcap.registerChannel({ schemaId, topic: `/${key}`, messageEncoding: 'cdr', metadata: new Map() })
  }
  const put = (key, time, message) => mcap.addMessage({ channelId: channels[key], sequence: 0, logTime: time, publishTime: time,
    data: new MessageWriter(definitions(parts[key])).writeMessage(message) })
  const header = (sec, frame_id) => ({ stamp: { sec, nanosec: 500 }, frame_id })
  await put('tf', 1n, { transforms: [{ header: header(0, 'earth'), child_frame_id: 'os_sensor', transform: {
    translation: { x: 1, y: 2, z: 3 }, rotation: { x: 0, y: 0, z: 1, w: 0 } } }] })
  for (const sec of [7, 8]) {
    const data = new DataView(new ArrayBuffer(60))
    for (let i = 0; i < 15; ++i) {
      if (i % 5 === 4) {
        data.setUint16(4 * i, i, true)
      } else {
        data.setFloat32(4 * i, sec + i, true)
      }
    }
    const fields = ['x', 'y', 'z'].map((axis, k) => ({ name: axis, offset: 4 * k, datatype: 7, count: 1 }))
    await put('cloud', BigInt(sec) * 1000000000n, { header: header(sec, 'os_sensor'), height: 1, width: 3,
      fields: [...fields, { name: 'ring', offset: 16, datatype: 4, count: 1 }], is_bigendian: false, point_step: 20, row_step: 60,
      data: new Uint8Array(data.buffer), is_dense: true })
  }
  await mcap.end()
}

main(process.argv[2], process.argv[3] === 'true').catch((error) => {
  console.error(error)
  process.exit(1)
})
