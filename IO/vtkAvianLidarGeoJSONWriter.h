// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarGeoJSONWriter
 * @brief Writes echoes from a certain energy on as GeoJSON (RFC 7946), for maps.
 *
 * Input port 0 is a vtkPointSet with the point array `energy` and a place: the point arrays
 * `longitude`, `latitude` and `height`, else the field data `geodetic_origin` for points in metres
 * east, north and up. Without a place: an error.
 *
 * Each echo is a point feature, to 9 decimals of a degree and 4 of a metre. Its properties are all
 * numeric point arrays of one component, and `object`, `object_class` and `material` by their names
 * in field data; units stand in the collection's member `units`. No echo: a collection of none.
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

  ///@{
  /** Take the limit from field data `lower_energy_limit` (0 if missing). Default: on. */
  vtkSetMacro(UseFieldDataLimit, bool);
  vtkGetMacro(UseFieldDataLimit, bool);
  vtkBooleanMacro(UseFieldDataLimit, bool);
  ///@}

  ///@{
  /** Least `energy` of the echoes written if UseFieldDataLimit is off, J. Default 0. */
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
