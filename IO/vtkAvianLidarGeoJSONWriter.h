// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarGeoJSONWriter
 * @brief Writes echoes of at least a given energy as GeoJSON (RFC 7946), for maps.
 *
 * Input port 0 is a vtkPointSet with the point array `energy` and a geodetic position: the point
 * arrays `longitude`, `latitude` and `height`, or else the field data `geodetic_origin` for points
 * in metres east, north and up. Without a geodetic position the writer gives an error.
 *
 * Each echo becomes a point feature, with 9 decimals for degrees and 4 decimals for metres. The
 * properties of a feature are all numeric point arrays, and the texts `object`, `object_class` and
 * `material` from the field data. An array of several components becomes the properties `name_0`,
 * `name_1`, ... An array is left out with a warning if another property already has its name. The
 * member `units` of the collection gives the units of the properties. Without echoes the collection
 * has no features.
 *
 * Example: `writer->SetFileName("echoes.geojson"); writer->Write();` Documentation:
 * reference/formats.md.
 *
 * @sa vtkAvianLidarCloudWriter, vtkAvianLidarGeodeticTransform
 */
#ifndef vtkAvianLidarGeoJSONWriter_h
#define vtkAvianLidarGeoJSONWriter_h

#include "vtkAvianLidarCloudWriter.h"

class VTKAVIANLIDAR_EXPORT vtkAvianLidarGeoJSONWriter : public vtkAvianLidarCloudWriter
{
public:
  static vtkAvianLidarGeoJSONWriter* New();
  vtkTypeMacro(vtkAvianLidarGeoJSONWriter, vtkAvianLidarCloudWriter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Whether the least `energy` of written echoes is the field data `lower_energy_limit`, J, or 0 J
  /// without these field data. Default: on.
  vtkAvianLidarSwitchMacro(UseFieldDataLimit, true);

  /// Least `energy` of written echoes if UseFieldDataLimit is off, J. Default 0.
  vtkAvianLidarPropertyMacro(MinimumEnergy, double, 0.0);

protected:
  vtkAvianLidarGeoJSONWriter() = default;
  ~vtkAvianLidarGeoJSONWriter() override = default;

  void WriteCloud(vtkPointSet* input) override;

private:
  vtkAvianLidarGeoJSONWriter(const vtkAvianLidarGeoJSONWriter&) = delete;
  void operator=(const vtkAvianLidarGeoJSONWriter&) = delete;
};

#endif
