// SPDX-License-Identifier: BSD-3-Clause
// The comparison of the echoes of two scans, bit for bit, whatever members an echo has.
#ifndef SameEchoes_h
#define SameEchoes_h

#include "Scan.h"

#include <algorithm>
#include <cstring>

namespace echotest
{
inline bool sameBits(const avianlidar::Echo& a, const avianlidar::Echo& b)
{
  return std::memcmp(&a, &b, sizeof(a)) == 0;
}

/// Number of the first echo of which two scans differ; that of all echoes if there is none.
inline std::size_t firstDifference(const avianlidar::ScanResult& a, const avianlidar::ScanResult& b)
{
  std::size_t i = 0;
  while (i < a.echoes.size() && i < b.echoes.size() && sameBits(a.echoes[i], b.echoes[i]) &&
    a.beamOfEcho[i] == b.beamOfEcho[i])
  {
    ++i;
  }
  return i;
}

/// Number of echoes from the first one on of which two scans differ.
inline std::size_t differingEchoes(const avianlidar::ScanResult& a, const avianlidar::ScanResult& b)
{
  return std::max(a.echoes.size(), b.echoes.size()) - firstDifference(a, b);
}

inline bool sameEchoes(const avianlidar::ScanResult& a, const avianlidar::ScanResult& b)
{
  return differingEchoes(a, b) == 0;
}
}

#endif
