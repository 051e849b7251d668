// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarGeoJSONWriter
 * @brief Writes the echoes from a certain energy on as GeoJSON (RFC 7946), for maps.
 *
 * One point feature an echo: longitude and latitude in degrees (9 decimals), height above the WGS84
 * ellipsoid in metres (4 decimals): at most 0.06 mm off. Its properties are all numeric point
 * arrays of one component, with the digits that give the same numbers back, and, where `object_id`
 * and `material_id` lead to names in the field data, `object`, `object_class` and `material`. Units
 * of the properties stand in the collection's member `units`.
 *
 * **Place.** From the point arrays `longitude`, `latitude`, `height` (degrees, metres) of
 * vtkAvianLidarGeodeticTransform if they are there (then they are no properties), else from the
 * points, in metres east, north and up of the field data `geodetic_origin`. Without either: an
 * error. The point array `energy` (J) is needed. A file is written as a whole or not at all, see
 * vtkAvianLidarCloudWriter. No echo at or above the limit: a collection of none.
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

  ///@{
  /**
   * Take the limit from the input's field data `lower_energy_limit`, where the sensor leaves it (0
   * where it is not), instead of MinimumEnergy. Default on.
   */
  vtkSetMacro(UseFieldDataLimit, bool);
  vtkGetMacro(UseFieldDataLimit, bool);
  vtkBooleanMacro(UseFieldDataLimit, bool);
  ///@}

  ///@{
  /**
   * Echoes whose `energy` is below are left out, in joules; used when UseFieldDataLimit is off.
   * Default 0.
   */
  vtkSetMacro(MinimumEnergy, double);
  vtkGetMacro(MinimumEnergy, double);
  ///@}

protected:
  vtkAvianLidarGeoJSONWriter();
  ~vtkAvianLidarGeoJSONWriter() override;

  void WriteCloud(vtkPointSet* input) override;

  bool UseFieldDataLimit;
  double MinimumEnergy;

private:
  vtkAvianLidarGeoJSONWriter(const vtkAvianLidarGeoJSONWriter&) = delete;
  void operator=(const vtkAvianLidarGeoJSONWriter&) = delete;
};

#endif
