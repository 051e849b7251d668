// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Scenes.h
 * @brief The scenes that are measured: generated ones, and the airports where their data are.
 */
#ifndef avianlidar_Scenes_h
#define avianlidar_Scenes_h

#include "Reflectance.h"
#include "ScanPattern.h"
#include "Sensor.h"
#include "TriangleMesh.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace benchmarks
{
using avianlidar::TriangleMesh;
using avianlidar::Vec3;

/// Surfaces, and the scan that looks at them.
struct Scene
{
  std::string name;
  std::shared_ptr<TriangleMesh> mesh = std::make_shared<TriangleMesh>();
  std::vector<avianlidar::Material> materials; ///< one per triangle
  std::vector<int> objectIds; ///< one per triangle; each wall, box, plate has its own
  Vec3 apex{ 0.0 };           ///< the lidar, m
  avianlidar::ScanPattern pattern;
  avianlidar::Sensor sensor;              ///< the airport's
  double attenuationCoefficient = 3.5e-5; ///< 1/m
  bool airport = false;
};

/// A scene that can be made. `make` returns a scene without triangles where its data are absent.
struct SceneEntry
{
  std::string name;
  std::function<Scene()> make;
  std::string file = {};    ///< scene file, empty if generated
  std::string repaint = {}; ///< pattern of the blocks whose material is changed to light again
};

/// The paper's airport scan (Sec. 5.3): 0 to 6 degrees in `channels`, the same step horizontally.
avianlidar::ScanPattern airportPattern(int channels);

/// `boxes` boxes on a plain of 6 km, the lidar in the middle, 3 m above ground.
Scene makeBoxes(int boxes);

/// A sphere of radius 30 m, 100 m north of the lidar, that a scan of 128 x 120 beams is aimed at
/// (a window of 40 x 37.5 degrees; the sphere takes half of it). About `triangles` triangles of
/// like size: 8 n^2, an octahedron divided n times.
Scene makeSphere(std::size_t triangles);

/// A corridor of 27.5 m with doors, a stairwell and a handrail, all wall, and the scan of Sec. 5.2.
Scene makeCorridor();

/// The same with the four materials of Table 1 and the lidar of Sec. 5.2, as CorridorC16 has it.
Scene makePaperCorridor();

/// Three fronts of open loggias, 3 m wide and high and 1.5 m deep, 60 to 80 m away in a U around
/// the lidar, and the airport scan: concave edges of wall in most beams that meet them.
Scene makeLoggias();

/// Rolling ground of a million triangles on 4 km, seen from 3 m above it at 0 to 1.5 degrees below
/// the horizon.
Scene makeTerrain();

/// Airports: Hongqiao as shipped, with its structures, with everything, and Honolulu.
std::vector<SceneEntry> airports();

/// The generated scenes of the matrix.
std::vector<SceneEntry> generatedScenes();
}

#endif
