// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file FormatFacts.h
 * @brief Reads facts from mesh files that Assimp 5.2 ignores and without which the geometry would
 * be wrong.
 */
#ifndef AvianLidarFormatFacts_h
#define AvianLidarFormatFacts_h

#include "SceneTypes.h"

#include <map>
#include <vector>

namespace avianlidar::scene
{
/**
 * Refuses glTF 2.0 files whose geometry depends on extensions that Assimp does not support:
 * required ones (specification, section 3.12), except those of materials, textures and lights, and
 * instances, quantization and the centre of a tile even where they are only used. Refuses positions
 * that are not of single precision, too.
 * @param text of the file, JSON or binary. Throws Error, which names the extension.
 * @return warnings: skins and weights of morph targets are left out
 */
std::vector<std::string> CheckGltf(const std::string& text);

/**
 * The length of an IFC file's unit, m, where it is a conversion-based unit such as the foot; Assimp
 * supports only the metre with its prefixes, which give 1 here.
 * @param text of the file. Throws Error where the unit cannot be read.
 * @param elements becomes how many elements of each type, such as "IFCWALL", have a shape. What is
 * not solid is left out: spaces, openings, annotations.
 */
double ReadIfc(const std::string& text, std::map<std::string, std::size_t>& elements);

/// The length of an X3D file's unit, m (version 3.3 and later). @param text XML
double X3dUnit(const std::string& text);

/// The length of an OpenGEX file's unit, m. @param upAxis becomes 'y' or 'z'
double OpenGexUnit(const std::string& text, char& upAxis);

/// Refuses PLY files with triangle strips, which Assimp reads wrong, and files whose header has no
/// end, which it never ends on. @param text of the file. Throws Error.
void CheckPly(const std::string& text);

/// Refuses 3MF files that build an object that they do not hold. @param text XML. Throws Error.
/// @return warnings: materials of triangles are left out
std::vector<std::string> Check3mf(const std::string& text);

/**
 * The length, m, of the unit that the root element of a 3MF or AMF file names; a millimetre where
 * it names none, as both specifications say.
 * @param text XML. Throws Error where it is another unit.
 */
double PrintUnit(const std::string& text);

/// Refuses AMF files that Assimp reads wrong: it does not turn objects of constellations, and it
/// keeps only the first volume of a mesh. @param text XML. Throws Error.
void CheckAmf(const std::string& text);

/**
 * Moves the vertices of an OBJ file so that they lie near the origin, since Assimp reads single
 * precision. Only files whose coordinates reach 8192 (there they are kept to 0.001) are changed.
 * @return by how much: to be added to what is read
 */
Vec3 MoveObjToOrigin(std::vector<char>& bytes);
}

#endif
