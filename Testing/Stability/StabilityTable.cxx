// SPDX-License-Identifier: BSD-3-Clause
#include "StabilityTable.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

namespace stability
{
void record(const Row& row)
{
  EXPECT_TRUE(row.worst <= row.bar)
    << row.extreme << ", " << row.range << ", " << row.promise << ": " << row.worst
    << " where at most " << row.bar << " was promised";
  if (const char* file = std::getenv("AVIANLIDAR_STABILITY_ROWS"))
  {
    std::ofstream out(file, std::ios::app);
    out.precision(3);
    out << row.extreme << '\t' << row.range << '\t' << row.view << '\t' << row.promise << '\t'
        << row.bar << '\t' << row.worst << '\n';
  }
}
}
