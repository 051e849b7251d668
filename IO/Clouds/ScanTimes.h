// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanTimes.h
 * @brief Times of files that are the scans of one recording.
 */
#ifndef AvianLidarScanTimes_h
#define AvianLidarScanTimes_h

#include <string>
#include <vector>

namespace avianlidar::formats
{
/// Rate of scans in files without times, Hz (assumed).
constexpr double AssumedScanRate = 10.0;

/// Scans of a recording, the earliest first.
struct ScanTimes
{
  std::vector<double> seconds;    ///< times, which increase
  std::vector<std::string> files; ///< name of the file of each scan
  std::string origin;             ///< words on where the times come from
};

/// Finds the times of files, from the first of these that there is:
/// 1. the rate, Hz, if it is above 0: the number of the scan divided by the rate;
/// 2. a file times.txt or timestamps.txt beside the files or in the folder above. A line has
///    seconds, or a date and a time as in ISO 8601. If the names of the files have numbers below
///    the number of lines, these are the numbers of the lines, from 0 on;
/// 3. times in the names, if they differ: seconds, ms, us or ns since 1970, seconds and three, six
///    or nine decimals behind a dot, or nine behind `_`, or a date and a time as in ISO 8601, also
///    without separators;
/// 4. the numbers in the names, which count scans at AssumedScanRate;
/// 5. the order of the files, at AssumedScanRate.
/// Throws FormatError if two files have the same time, or if a file of times does not fit.
ScanTimes timesOfScans(const std::vector<std::string>& files, double rate = 0.0);
}

#endif
