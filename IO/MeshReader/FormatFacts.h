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

/// Returns the unit of length of an X3D file (version 3.3 and later), m. @param text XML
double X3dUnit(const std::string& text);

/// Returns the unit of length of an OpenGEX file, m.
/// @param upAxis becomes 'y' or 'z' if the file gives the axis that points up
double OpenGexUnit(const std::string& text, char& upAxis);

/// Refuses PLY files with triangle strips, which Assimp reads wrong, files whose header has no end,
/// on which Assimp never stops, and ASCII files that are cut short, for which Assimp invents
/// triangles. @param text contents of the file. Throws Error.
void CheckPly(const std::string& text);

/// Returns an OFF file as OBJ, because Assimp reads no OFF faces of more than 9 corners. Colours,
/// normals and texture coordinates are left out. @param text contents of the file. Throws Error if
/// the file is cut short, binary or of four or n dimensions.
std::string OffAsObj(const std::string& text);

/// Refuses files that are cut short, for which Assimp invents triangles. @param text contents of
/// the file. Throws Error.
void CheckNff(const std::string& text);

/// Refuses OBJ files with vertices of fewer than three numbers, which Assimp leaves out or reads
/// wrong. @param text contents of the file. Throws Error, which names the line.
void CheckObj(const std::string& text);

/// Refuses 3MF files that name an object that the file does not contain. @param text XML. Throws
/// Error.
/// @return warnings of materials of triangles, which are left out
std::vector<std::string> Check3mf(const std::string& text);

/**
 * Returns the unit of length that the root element of a 3MF or AMF file names, m. Without a name
 * the unit is the millimetre, as the specifications of 3MF and AMF say.
 * @param text XML. Throws Error if the unit is unknown, or if a 3MF file requires an extension
 * other than the materials extension.
 */
double PrintUnit(const std::string& text);

/// Refuses AMF files with turned objects of constellations, or with several volumes in a mesh.
/// Assimp ignores turns and all volumes but the first. @param text XML. Throws Error.
void CheckAmf(const std::string& text);

/**
 * Moves the vertices of an OBJ file towards the origin, because Assimp reads single precision.
 * Files with coordinates below 8192, which single precision rounds by less than 0.001, are not
 * changed.
 * @return vector to be added to the vertices that Assimp reads, in the unit of the file
 */
Vec3 MoveObjToOrigin(std::vector<char>& bytes);
}

#endif
