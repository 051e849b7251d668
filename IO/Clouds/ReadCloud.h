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
/// Format of files. A new format needs only a row in the table of cloudFormats().
struct CloudFormat
{
  std::vector<std::string> endings; ///< file extensions, in lower case, with the dot
  bool (*fits)(ByteSource& file);   ///< check of the first bytes; an exception counts as false
  /// @param beside file of labels or of waveform packets, or null
  Cloud (*read)(ByteSource& file, ByteSource* beside, const KeepGoing& keepGoing);
  bool hasLabels = false; ///< whether a file of labels is possible (labelFileOf())
  bool hasTurns = false;  ///< whether files have packets (read() gives the first revolution)
};

const std::vector<CloudFormat>& cloudFormats();

/// Returns all file extensions as a text, such as ".las, .laz or .pcd".
std::string knownEndings();

/// Returns the file extension in lower case, with the dot: ".las".
std::string endingOf(const std::string& fileName);

/// Returns the format of a file extension, in upper or lower case, or null if unknown.
const CloudFormat* formatOf(const std::string& fileName);

/// Returns the file of SemanticKITTI's labels of a .bin file: the same name with .label, in the
/// folder of the .bin file or in a folder `labels` beside that folder. If the .bin file is a link,
/// its target counts after the link. Returns an empty text if the file of labels does not exist.
std::string labelFileOf(const std::string& fileName);

/// Reads a file and its labels or waveform packets or, if `packets` is not null, the revolution
/// `turn`.
Cloud readCloud(const std::string& fileName, const KeepGoing& keepGoing,
  const PacketIndex* packets = nullptr, std::size_t turn = 0);

/// Gives columns the names and units of this project:
/// - units and notes that a writer of this project put into a comment or text area of the file
///   become units and notes of the cloud;
/// - `ring` or `channel` becomes `laser_id` if the cloud has no `laser_id`;
/// - the prefix `file_` is added to a name if another column has this name, or if the name has a
///   unit in this project, such as `azimuth`, but not in the file;
/// - `distance_m`, `azimuth` and `vertical_angle` are computed if the sensor's place is known and
///   the file does not have these columns;
/// - packed colours of PCD, and `red`, `green` and `blue` of PLY, become `rgb`.
void harmonise(Cloud& cloud);
}

#endif
