// SPDX-License-Identifier: BSD-3-Clause
// What the library copc finds in a LAS file, as JSON: header, records, extra bytes, every dimension of every point.
// usage: node las_to_json.js <file.las>   (NODE_PATH names the folder with copc)
'use strict'
const fs = require('fs')
const { Las } = require('copc')

async function main(name) {
  const bytes = fs.readFileSync(name)
  const header = Las.Header.parse(bytes)
  const vlrs = await Las.Vlr.walk(name, header)
  const contentOf = (vlr) => bytes.subarray(vlr.contentOffset, vlr.contentOffset + vlr.contentLength)
  const described = Las.Vlr.find(vlrs, 'LASF_Spec', 4)
  const extraBytes = described ? Las.ExtraBytes.parse(contentOf(described)) : []
  const end = header.pointDataOffset + header.pointCount * header.pointDataRecordLength
  const view = Las.View.create(bytes.subarray(header.pointDataOffset, end), header, extraBytes)
  const points = {}
  for (const dimension of Object.keys(view.dimensions)) {
    const value = view.getter(dimension)
    points[dimension] = Array.from({ length: view.pointCount }, (_, i) => value(i))
  }
  const records = vlrs.map((vlr) => ({
    userId: vlr.userId,
    recordId: vlr.recordId,
    description: vlr.description,
    text: contentOf(vlr).toString('latin1'),
  }))
  return { header, records, extraBytes, points, endOfPoints: end, size: bytes.length }
}

main(process.argv[2]).then(
  (result) => process.stdout.write(JSON.stringify(result)),
  (error) => {
    console.error(error)
    process.exit(1)
  })
