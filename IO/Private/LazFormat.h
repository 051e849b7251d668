// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LazFormat.h
 * @brief Point records of LAZ, the compressed form of LAS, by the library LASzip.
 *
 * LASzip (de)compresses records one by one and holds one chunk, usually 50,000 points. LasFormat.h
 * does all else. A build without LASzip throws an error that says so.
 *
 * Source: the header of LASzip 3 (laszip_api.h); the layout of chunks and their table as LASzip 3
 * writes them. Read: chunks of one size, and of formats 6 to 8 of several sizes (COPC). LASzip
 * trusts what a file says, so that is compared with the file's length first: the record of the
 * compression, the table of chunks, the layers of each chunk and the first bytes of each decoder.
 */
#ifndef AvianLidarLazFormat_h
#define AvianLidarLazFormat_h

#include "LasFormat.h"

namespace avianlidar::formats
{
/// Bit of the point data record format that says: compressed.
constexpr int LazFlag = 0x80;
/// The variable-length record that says how.
constexpr const char* LazUser = "laszip encoded";
constexpr int LazRecord = 22204;

/// Where a file's compressed points are.
struct LazPoints
{
  std::uint64_t begin = 0;
  std::uint64_t count = 0;
  LasLayout layout;
  std::vector<unsigned char> record; ///< how they are compressed
};

/// Throws what is wrong with them, as far as it is known before memory is taken for what they
/// claim: damaged, cut short, or no LASzip here.
void checkLaz(ByteSource& source, const LazPoints& points);

/// Calls take(i, bytes) for each record of points that checkLaz() has passed. FormatError: damaged
/// or cut short.
void forEachLazRecord(ByteSource& source, const LazPoints& points,
  const std::function<void(std::uint64_t, const unsigned char*)>& take);

/// What the variable-length record holds for points that are written; formats 6 and 7.
std::vector<unsigned char> lazRecordOf(const LasLayout& layout);

/// Writes `count` records, which make(i, bytes) fills, from there on, the end of the file so far.
void writeLazRecords(OutputFile& file, std::uint64_t begin, const LasLayout& layout,
  std::int64_t count, const std::function<void(std::int64_t, unsigned char*)>& make);
}

#endif
