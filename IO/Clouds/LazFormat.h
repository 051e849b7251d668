// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LazFormat.h
 * @brief Reads and writes point records of LAZ, the compressed form of LAS, with LASzip.
 *
 * LASzip compresses and decompresses records one by one and keeps one chunk, usually 50,000 points,
 * in memory. LasFormat.h reads and writes all other parts of a file. In a build without LASzip the
 * functions throw FormatError.
 *
 * Sources: laszip_api.h and the chunks and chunk tables in files of LASzip 3. The code reads chunks
 * of one size and, for formats 6 to 8, of several sizes (COPC). LASzip does not check the sizes in
 * a file. The code therefore first compares all sizes with the length of the file: the sizes in
 * the record of the compression, in the table of chunks, in the layers of each chunk and in the
 * first bytes of each decoder.
 */
#ifndef AvianLidarLazFormat_h
#define AvianLidarLazFormat_h

#include "LasFormat.h"

namespace avianlidar::formats
{
/// Bit of the point data record format that marks compressed points.
constexpr int LazFlag = 0x80;
/// User and number of the variable-length record that describes the compression.
constexpr const char* LazUser = "laszip encoded";
constexpr int LazRecord = 22204;

/// Compressed points in a file: offset of the first byte, number of points, and layout of a record.
struct LazPoints
{
  std::uint64_t begin = 0;
  std::uint64_t count = 0;
  LasLayout layout;
  std::vector<unsigned char> record; ///< variable-length record of the compression
};

/// Throws FormatError if the build has no LASzip, or if the points are damaged or cut short. Finds
/// only damage that shows before memory is allocated for the points.
void checkLaz(ByteSource& source, const LazPoints& points);

/// Calls take(i, bytes) for each record of points that passed checkLaz(). Throws FormatError if a
/// record is damaged or cut short.
void forEachLazRecord(ByteSource& source, const LazPoints& points,
  const std::function<void(std::uint64_t, const unsigned char*)>& take);

/// Returns the contents of the variable-length record for points that are written, formats 6 and 7.
std::vector<unsigned char> lazRecordOf(const LasLayout& layout);

/// Writes `count` records from the offset `begin` on, which must be the end of the file so far. The
/// function make(i, bytes) fills record i.
void writeLazRecords(OutputFile& file, std::uint64_t begin, const LasLayout& layout,
  std::int64_t count, const std::function<void(std::int64_t, unsigned char*)>& make);
}

#endif
