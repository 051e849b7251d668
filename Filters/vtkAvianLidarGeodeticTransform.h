// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarGeodeticTransform
 * @brief Transforms points between local east-north-up, geodetic, geocentric and UTM coordinates.
 *
 * - Input port 0: any vtkPointSet, or a composite of vtkPointSet, with coordinates in SourceFrame.
 * - Output port 0: shallow copies of the input with the point arrays `longitude` (in [-180, 180]; 0
 *   at a pole), `latitude` and `height` (above the WGS84 ellipsoid), and, if MovePoints is on, with
 *   the points in TargetFrame. Vectors are not turned. Field data: `geodetic_origin` and
 *   `utm_zone`, if used. The field data `crs_wkt` are removed if points move.
 *
 * All frames are on WGS84: ENU (metres on the tangent plane of the origin), geodetic (longitude and
 * latitude in degrees, height in metres), ECEF (geocentric metres), UTM (easting, northing, height
 * in metres).
 *
 * GeographicLib makes the conversions (Karney, J. Geodesy 85(8), 2011), with errors below 10 nm
 * within 5000 km of the surface, plus the rounding of the numbers. UTM is valid up to 3900 km from
 * the central meridian. Measured errors: Documentation/reference/scene-files.md.
 *
 * A missing origin, a bad angle or zone, a coordinate that is not finite or lies outside the range
 * of UTM, or a block that is not a vtkPointSet gives an empty output and an error that names the
 * fault. The output is also empty after an abort and without points. The result does not depend on
 * the pieces into which the input is divided.
 *
 * Example: `toUtm->SetTargetFrameToUTM(); toUtm->MovePointsOn();`
 *
 * @sa vtkAvianLidarSceneReader
 */
#ifndef vtkAvianLidarGeodeticTransform_h
#define vtkAvianLidarGeodeticTransform_h

#include "vtkAvianLidarModule.h" // For export macro
#include "vtkAvianLidarProperties.h"
#include "vtkPassInputTypeAlgorithm.h"

class VTKAVIANLIDAR_EXPORT vtkAvianLidarGeodeticTransform : public vtkPassInputTypeAlgorithm
{
public:
  static vtkAvianLidarGeodeticTransform* New();
  vtkTypeMacro(vtkAvianLidarGeodeticTransform, vtkPassInputTypeAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum Frames
  {
    FRAME_ENU = 0,
    FRAME_GEODETIC = 1,
    FRAME_ECEF = 2,
    FRAME_UTM = 3
  };

  ///@{
  /// Frame in which the points are given. Default FRAME_ENU.
  vtkAvianLidarPropertyMacro(SourceFrame, int, FRAME_ENU);
  void SetSourceFrameToENU() { this->SetSourceFrame(FRAME_ENU); }
  void SetSourceFrameToGeodetic() { this->SetSourceFrame(FRAME_GEODETIC); }
  void SetSourceFrameToECEF() { this->SetSourceFrame(FRAME_ECEF); }
  void SetSourceFrameToUTM() { this->SetSourceFrame(FRAME_UTM); }
  ///@}

  ///@{
  /// Frame to which the points are moved if MovePoints is on. Default FRAME_GEODETIC.
  vtkAvianLidarPropertyMacro(TargetFrame, int, FRAME_GEODETIC);
  void SetTargetFrameToENU() { this->SetTargetFrame(FRAME_ENU); }
  void SetTargetFrameToGeodetic() { this->SetTargetFrame(FRAME_GEODETIC); }
  void SetTargetFrameToECEF() { this->SetTargetFrame(FRAME_ECEF); }
  void SetTargetFrameToUTM() { this->SetTargetFrame(FRAME_UTM); }
  ///@}

  /// Whether points are moved to TargetFrame. Otherwise only arrays are added. Default: off.
  vtkAvianLidarSwitchMacro(MovePoints, false);

  /// Whether the origin is the field data `geodetic_origin` of the block, or else of the input.
  /// Default: on.
  vtkAvianLidarSwitchMacro(UseFieldDataOrigin, true);

  /// Origin of ENU and of the automatic UTM zone, if UseFieldDataOrigin is off: latitude in [-90,
  /// 90], longitude in [-360, 360], deg, height above the ellipsoid, m. Default (0, 0, 0).
  vtkAvianLidarVectorMacro(Origin, 3, 0.0, 0.0, 0.0);

  /// UTM zone: 1 to 60 in the northern hemisphere, -1 to -60 in the southern hemisphere. Default 0:
  /// the zone of the origin.
  vtkAvianLidarPropertyMacro(UTMZone, int, 0);

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarGeodeticTransform() = default;
  ~vtkAvianLidarGeodeticTransform() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkAvianLidarGeodeticTransform(const vtkAvianLidarGeodeticTransform&) = delete;
  void operator=(const vtkAvianLidarGeodeticTransform&) = delete;

  class vtkWork;
};

#endif
