// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarMedia.h
 * @brief Media of the air by visibility, rain rate or leaf area density, with the numbers of
 * media.json, and media of a scene, which travel as text. Not installed.
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
/// Haze, or fog where one sees no farther than it lets one. @param visibility m, above 0 @param
/// extinction at the lidar's wavelength, 1/m
avianlidar::Medium HazeOf(double visibility, double extinction);

/// @param rate mm/h, above 0 @param view of the lidar
avianlidar::Medium RainOf(double rate, const avianlidar::LidarView& view);

/// A medium by its text: one, or one for each of its ellipsoids. Throws std::runtime_error, which
/// names the medium and the key. @param view of the lidar
std::vector<avianlidar::PlacedMedium> Read(
  const std::string& text, const avianlidar::LidarView& view);

/// The surface that bounds a medium, with its text in field data. Throws as Read(). @param closed
/// the surface of a medium of that shape, may be null @param size m, of what has no bounds
vtkSmartPointer<vtkPolyData> Surface(const std::string& text, vtkPolyData* closed, double size);

/// Whether a leaf is a medium, and no surface.
bool IsMedium(vtkPolyData* leaf);

/// The text of a leaf that is a medium, with the closed surface that bounds it if that is its
/// shape; empty: it is none. Throws as Read().
std::string TextOf(vtkPolyData* leaf, const std::string& name);

/// Whether what a medium returns belongs to an object of its own: foliage. @param id that it has,
/// or -1 @param name of it
bool IsObject(const std::string& text, int& id, std::string& name);

/// The text with a name and an object.
std::string WithObject(const std::string& text, const std::string& name, int id);

/// The text with ellipsoids about some points in place of its shape; as it is if there are none.
/// @param sizes width and height of each, m
std::string WithCrowns(
  const std::string& text, vtkPolyData* middles, const std::vector<std::array<double, 2>>& sizes);

/// The text without its surface, for people.
std::string InWords(const std::string& text);
}

#endif
