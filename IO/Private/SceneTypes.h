// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SceneTypes.h
 * @brief Values of a scene file, checked and with defaults filled in, and the error that reading
 * may throw.
 *
 * Plain values; no VTK, no JSON. Lengths in metres, angles in degrees.
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
using Vec3 = std::array<double, 3>;
/// Rows of a 3 x 3 matrix, one after the other.
using Mat3 = std::array<double, 9>;

/// Anything wrong with a scene.
using Error = FileError;

/// Degrees on WGS84 and metres above its ellipsoid.
struct Geodetic
{
  double latitude = 0;
  double longitude = 0;
  double height = 0;
};

/// The index in Scene::materials is the material id; coefficients that a scene file leaves out stay
/// as here.
struct Material
{
  std::string name;
  avianlidar::Material coefficients{ 0.0, 0.0, 1.0 };
};

/// A mesh's material whose name fits the pattern (`*`, `?`) is the scene's material.
struct MaterialRule
{
  std::string pattern;
  int material = 0;
};

/// Where an object stands: p = frame(position + rotation * (scale * v)).
struct Placement
{
  std::optional<Vec3> position;
  std::optional<Geodetic> geodetic;
  Mat3 rotation{ 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  Vec3 scale{ 1, 1, 1 };
};

/// Facades with a share of glass: bays of about the given width, each with one centred strip.
struct Glazing
{
  int material = 1;
  double share = 0;
  double bay = 1;
};

/// An attribute that a feature must have, with a value that fits the pattern.
struct AttributeFilter
{
  std::string attribute;
  std::string pattern;
};

struct FootprintOptions
{
  std::string layer;
  std::vector<AttributeFilter> filters;
  double base = 0;
  std::optional<double> height;
  std::string heightAttribute;
  std::string minHeightAttribute;
  bool flat = false;
  std::optional<double> width;
  std::string widthAttribute;
  int roofMaterial = -1;
  std::optional<Glazing> glazing;
  bool separate = false;
  std::string nameAttribute = "name";
  /// Name of the object before it that it stands on; empty: the level of the origin.
  std::string on;
};

struct GroundOptions
{
  double sizeEast = 0;
  double sizeNorth = 0;
  double height = 0;
};

enum class ObjectKind
{
  Mesh,
  Footprints,
  Ground,
  Medium ///< a medium with a shape of its own
};

struct Object
{
  /// Where it stands in the file, as "objects[3]", for messages.
  std::string key;
  ObjectKind kind = ObjectKind::Mesh;
  std::string file;
  std::string name;
  std::string objectClass;
  /// Material of the whole object; -1: by the rules, from the mesh's own names.
  int material = -1;
  std::vector<MaterialRule> rules;
  Placement placement;
  /// 'y', 'z', or 0 for what the format says.
  char upAxis = 0;
  /// Coordinate reference system of the coordinates; empty: that of the file, or local metres.
  std::string crs;
  FootprintOptions footprints;
  GroundOptions ground;
  /// JSON of a medium (vtkAvianLidarMedium.h): what fills its surface, or by itself; empty: none.
  std::string medium;
};

struct Scene
{
  std::string file;
  std::optional<Geodetic> origin;
  std::optional<Vec3> lidar;
  bool lidarInside = false;
  std::vector<Material> materials;
  std::vector<MaterialRule> rules;
  std::vector<Object> objects;
  std::vector<std::string> attribution;
};

/// Triangles with a material each: an index in materialNames as read from a file, or a scene's
/// material id.
struct Mesh
{
  std::vector<Vec3> points;
  std::vector<std::array<std::int64_t, 3>> triangles;
  std::vector<int> materials;
  std::vector<std::string> materialNames;
  /// Faces that are points or lines, which no ray hits.
  std::int64_t skippedFaces = 0;
  /// Distance between neighbouring single-precision numbers at the largest coordinate, in the
  /// file's unit; 0 if the reader keeps double precision.
  double rounding = 0.0;
  /// 'y' or 'z', the axis that points up according to the file; 0 if the file does not say.
  char upAxis = 0;
  /// Sentences on what was left out.
  std::vector<std::string> warnings;
};

/// One object of the output.
struct Part
{
  std::string name;
  std::string objectClass;
  Mesh mesh;
  std::string medium{}; ///< JSON; empty: a surface
  /// Width and height of ellipsoids about the points of the mesh, which has no triangles then.
  std::vector<std::array<double, 2>> crowns{};
};
}

#endif
