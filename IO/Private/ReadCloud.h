// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ReadCloud.h
 * @brief Reads a cloud of any known format and gives its arrays the names and units of this
 * project.
 */
#ifndef AvianLidarReadCloud_h
#define AvianLidarReadCloud_h

#include "ByteSource.h"
#include "CloudData.h"
#include "PacketFormat.h"

#include <string>
#include <vector>

namespace avianlidar::formats
{
/// A format of files. All code gets the formats from cloudFormats(), so a new format is a row
/// there.
struct CloudFormat
{
  std::vector<std::string> endings; ///< endings of names, in lower case
  bool (*fits)(ByteSource& file);   ///< by its first bytes; may throw, which is no
  Cloud (*read)(ByteSource& file, ByteSource* labels, const KeepGoing& keepGoing);
  bool hasLabels = false; ///< in a file of their own, see labelFileOf(); else they are null
  bool hasTurns = false;  ///< packets; read() gives the first revolution
};

const std::vector<CloudFormat>& cloudFormats();

/// All endings, as in ".las, .laz or .pcd".
std::string knownEndings();

/// The ending of a name, in lower case: ".las".
std::string endingOf(const std::string& fileName);

/// The format by the ending of the name, case aside; null for an unknown ending.
const CloudFormat* formatOf(const std::string& fileName);

/// SemanticKITTI's labels of a .bin file: the same name with .label beside it or in a folder
/// `labels` beside the one it is in; empty if there are none.
std::string labelFileOf(const std::string& fileName);

/// Reads the file and its labels or, if the file has packets, the revolution `turn`.
Cloud readCloud(const std::string& fileName, const KeepGoing& keepGoing,
  const PacketIndex* packets = nullptr, std::size_t turn = 0);

/// Gives arrays the names and units of this project where a format says what they are:
/// - notes of this project's writers become units of columns and notes of the cloud;
/// - `ring` and `channel` are `laser_id`;
/// - a name of this project without a unit in the file (an `azimuth` in any unit) gets the prefix
///   `file_`;
/// - `distance_m`, `azimuth` and `vertical_angle` are computed where the sensor's place is known
/// and
///   the file does not have them;
/// - packed colours of PCD and the `red`, `green` and `blue` of PLY become `rgb`.
void harmonise(Cloud& cloud);
}

#endif
