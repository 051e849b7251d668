// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SceneTypes.h
 * @brief Values of a scene file, checked and with defaults, and the error that reading may throw.
 *
 * The values need neither VTK nor JSON. Lengths are in metres, angles in degrees.
 */
#ifndef AvianLidarSceneTypes_h
#define AvianLidarSceneTypes_h

#include "FileError.h"
#include "ParallelLoop.h"
#include "Reflectance.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace avianlidar::scene
{
using Point3 = std::array<double, 3>;
/// Rows of a 3 x 3 matrix, one after the other.
using Mat3 = std::array<double, 9>;

/// Error about a fault of a scene or of a file of the scene.
using Error = FileError;

/// Position on WGS84: latitude and longitude, deg, and height above the ellipsoid, m.
struct Geodetic
{
  double latitude = 0;
  double longitude = 0;
  double height = 0;
};

/// Material of a scene. Its index in Scene::materials is the material id. A coefficient that the
/// scene file leaves out has the default given here.
struct Material
{
  std::string name;
  avianlidar::Material coefficients{ 0.0, 0.0, 1.0 };
};

/// Rule that gives a material of the scene to triangles of a mesh. The name that the material of
/// these triangles has in the mesh must fit the pattern (`*`, `?`).
struct MaterialRule
{
  std::string pattern;
  int material = 0;
};

/// Position, rotation and scale of an object: p = frame(position + rotation * (scale * v)).
struct Placement
{
  std::optional<Point3> position;
  std::optional<Geodetic> geodetic;
  Mat3 rotation{ 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  Point3 scale{ 1, 1, 1 };
};

/// Glass of facades. A facade has bays of equal width, and each bay has one centred strip of glass.
struct Glazing
{
  int material = 1;
  double share = 0; ///< share of the area that is glass, 0 to 1
  double bay = 1;   ///< approximate width of a bay, m
};

/// Condition that a feature has an attribute with a value that fits the pattern.
struct AttributeFilter
{
  std::string attribute;
  std::string pattern;
};

struct FootprintOptions
{
  std::string layer;
  std::vector<AttributeFilter> filters;
  double base = 0;              ///< height of the underside above the ground, m
  std::optional<double> height; ///< height if no attribute gives one, m
  std::string heightAttribute;
  std::string minHeightAttribute;
  bool flat = false;
  std::optional<double> width; ///< width of lines and points if no attribute gives one, m
  std::string widthAttribute;
  int roofMaterial = -1; ///< material id of roofs; -1: material of the object
  std::optional<Glazing> glazing;
  bool separate = false;
  std::string nameAttribute = "name";
  /// Name of an earlier object on which the footprints stand; empty: the level of the origin.
  std::string on;
};

struct GroundOptions
{
  double sizeEast = 0;  ///< extent from west to east, m
  double sizeNorth = 0; ///< extent from south to north, m
  double height = 0;
};

enum class ObjectKind
{
  Mesh,
  Footprints,
  Ground,
  Medium ///< a medium that gives its own shape
};

struct Object
{
  /// Key of the object in the scene file for messages, such as "objects[3]".
  std::string key;
  ObjectKind kind = ObjectKind::Mesh;
  std::string file;
  std::string name;
  std::string objectClass;
  /// Material id of the whole object; -1: the rules choose by the material names of the mesh.
  int material = -1;
  std::vector<MaterialRule> rules;
  Placement placement;
  /// Axis of the file that points up, 'y' or 'z'; 0: the axis that the format gives.
  char upAxis = 0;
  /// Coordinate reference system of the coordinates; empty: the system of the file, or local
  /// metres.
  std::string crs;
  FootprintOptions footprints;
  GroundOptions ground;
  /// JSON of the medium (vtkAvianLidarMedium.h) that fills the surface or gives its own shape;
  /// empty without a medium.
  std::string medium;
};

struct Scene
{
  std::string file;
  std::optional<Geodetic> origin;
  std::optional<Point3> lidar; ///< position of the lidar, m east, north and up
  bool lidarInside = false;    ///< whether the lidar may be inside a part
  std::vector<Material> materials;
  std::vector<MaterialRule> rules;
  std::vector<Object> objects;
  std::vector<std::string> attribution;
};

/// Triangles, each with a material. The material is an index in materialNames if the mesh was read
/// from a file, or a material id of the scene.
struct Mesh
{
  std::vector<Point3> points;
  std::vector<std::array<std::int64_t, 3>> triangles;
  std::vector<int> materials;
  std::vector<std::string> materialNames;
  /// Number of faces left out because they are points or lines, which no ray hits.
  std::int64_t skippedFaces = 0;
  /// Distance between neighbouring single-precision numbers at the largest coordinate, in the
  /// file's unit; 0 if the reader keeps double precision.
  double rounding = 0.0;
  /// Axis that points up according to the file, 'y' or 'z'; 0 if the file does not give the axis.
  char upAxis = 0;
  /// Sentences on parts of the file that were left out.
  std::vector<std::string> warnings;
};

/// Block of the output: an object, or a feature of footprints.
struct Part
{
  std::string name;
  std::string objectClass;
  Mesh mesh;
  std::string medium{}; ///< medium that fills the part, JSON, or empty
  /// Widths and heights, m, of ellipsoids about the points of a mesh without triangles.
  std::vector<std::array<double, 2>> crowns{};
};
}

#endif
