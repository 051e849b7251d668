// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file FormatFacts.h
 * @brief Reads facts that Assimp 5.2 ignores in mesh files and without which the geometry would be
 * wrong.
 */
#ifndef AvianLidarFormatFacts_h
#define AvianLidarFormatFacts_h

#include "SceneTypes.h"

#include <map>
#include <vector>

namespace avianlidar::scene
{
/**
 * Returns the unit of length of an IFC file, m, if the unit is conversion-based, such as the foot.
 * Returns 1 without a unit and for SI units, because Assimp supports the metre and its prefixes.
 * @param text contents of the file. Throws Error if the unit cannot be read, or if the file has
 * shapes that came with IFC4, on which Assimp crashes.
 * @param elements becomes the number of elements with a shape, by type, such as "IFCWALL". Types
 * that are not solid, such as spaces, openings and annotations, are left out.
 */
double ReadIfc(const std::string& text, std::map<std::string, std::size_t>& elements);

/// Returns the schema that a STEP file names, such as "IFC4", or an empty text.
std::string SchemaOf(const std::string& text);

/// Refuses PLY files with triangle strips, which Assimp reads wrong, files whose header has no end,
/// on which Assimp never stops, and ASCII files that are cut short, for which Assimp invents
/// triangles. @param text contents of the file. Throws Error.
void CheckPly(const std::string& text);

/// Refuses OBJ files with vertices of fewer than three numbers, which Assimp leaves out or reads
/// wrong. @param text contents of the file. Throws Error, which names the line.
void CheckObj(const std::string& text);

/**
 * Moves the vertices of an OBJ file towards the origin, because Assimp reads single precision.
 * Files with coordinates below 8192, which single precision rounds by less than 0.001, are not
 * changed.
 * @return vector to be added to the vertices that Assimp reads, in the unit of the file
 */
Point3 MoveObjToOrigin(std::vector<char>& bytes);
}

#endif
