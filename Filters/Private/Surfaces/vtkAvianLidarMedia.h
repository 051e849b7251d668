// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarMedia.h
 * @brief Makes media from visibility, rain rate or leaf area density by the numbers of media.json,
 * and reads and writes the media of a scene as text. Not installed.
 *
 * The text of a medium, field data `medium` of its block, is JSON: see vtkAvianLidarMedium.
 */
#ifndef vtkAvianLidarMedia_h
#define vtkAvianLidarMedia_h

#include "Air.h"

#include "vtkSmartPointer.h"

#include <array>
#include <string>
#include <vector>

class vtkPolyData;

namespace vtkAvianLidarMedia
{
/// A kind or a shape, with the keys that describe the kind or the shape.
struct Word
{
  std::string name;
  std::vector<std::string> keys;
};

/// The kinds of media.json, in the order of vtkAvianLidarMedium::Kinds. The first key is the
/// quantity that gives the density.
const std::vector<Word>& Kinds();

/// The shapes, in the order of avianlidar::MediumShape and vtkAvianLidarMedium::Shapes.
const std::vector<Word>& Shapes();

/// Haze, or fog if the visibility is in the range of fog. @param visibility visibility, m, above 0
/// @param extinction extinction at the lidar's wavelength, 1/m
avianlidar::Medium HazeOf(double visibility, double extinction);

/// Rain. @param rate rain rate, mm/h, above 0 @param view view of the lidar @param kind name of a
/// kind with a rain rate
avianlidar::Medium RainOf(
  double rate, const avianlidar::LidarView& view, const std::string& kind = "rain");

/// The medium of a text, or one medium for each ellipsoid of the text. Throws std::runtime_error,
/// which names the medium and the key. @param view view of the lidar
std::vector<avianlidar::PlacedMedium> Read(
  const std::string& text, const avianlidar::LidarView& view);

/// The surface that bounds a medium, with the text in field data. Throws as Read(). @param closed
/// surface of a medium bounded by a surface, may be null @param size side of an unbounded medium, m
vtkSmartPointer<vtkPolyData> Surface(const std::string& text, vtkPolyData* closed, double size);

/// True if a leaf is a medium and not a surface.
bool IsMedium(vtkPolyData* leaf);

/// The text of a leaf that is a medium, with the closed surface if the medium is bounded by a
/// surface. Empty if the leaf is not a medium. Throws as Read().
std::string TextOf(vtkPolyData* leaf, const std::string& name);

/// True if echoes of a medium belong to an object of their own, as in foliage. @param id id of the
/// object, or -1 @param name name of the object
bool IsObject(const std::string& text, int& id, std::string& name);

/// The text with the name and the id of an object.
std::string WithObject(const std::string& text, const std::string& name, int id);

/// The text with ellipsoids about `middles` as its shape. Without points, the text is unchanged.
/// @param sizes width and height of each ellipsoid, m
std::string WithCrowns(
  const std::string& text, vtkPolyData* middles, const std::vector<std::array<double, 2>>& sizes);

/// The text without its surface, for display.
std::string InWords(const std::string& text);
}

#endif
