// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarGeodeticTransform
 * @brief Where points lie on the Earth: local east-north-up, geodetic, geocentric and UTM
 * coordinates.
 *
 * **Input** (port 0): any vtkPointSet, or a composite (vtkMultiBlockDataSet, vtkPartitionedDataSet,
 * vtkPartitionedDataSetCollection) of them, whose points are coordinates of SourceFrame.
 * **Output**: the same, shallow copies with three point arrays more (double, one component each):
 *
 * - `longitude` (deg): in [-180, 180]; 0 at a pole
 * - `latitude` (deg): in [-90, 90]
 * - `height` (m): above the WGS84 ellipsoid (not above sea level)
 *
 * and, if MovePoints is on, with the points moved to TargetFrame, in double precision. Vectors
 * (directions, normals) are not turned. Field data: `geodetic_origin` (one tuple: latitude deg,
 * longitude deg, height m) where an origin was used, and `utm_zone` (int, negative in the south)
 * where one of the frames is UTM; `crs_wkt` (of vtkAvianLidarPointCloudReader) goes when points
 * move.
 *
 * **Frames**, all on WGS84, coordinates in the order x, y, z:
 * - ENU: metres east, north and up of the origin, on its tangent plane;
 * - geodetic: longitude and latitude in degrees, height in metres (moved there, points draw a
 * needle: degrees and metres do not mix in a picture);
 * - ECEF: geocentric metres;
 * - UTM: easting and northing in metres, height above the ellipsoid.
 *
 * **Error**: the conversions are GeographicLib's (Karney, J. Geodesy 85(8), 2011): below 10 nm
 * within 5000 km of the Earth's surface, plus the rounding of the numbers (a longitude in degrees
 * is rounded to 3 nm, an ECEF coordinate to 1 nm). UTM holds up to 3900 km from the central
 * meridian of its zone; points beyond are refused.
 *
 * **Bad input**: an origin that is needed but missing, a latitude outside [-90, 90] degrees (of the
 * origin or of a geodetic point), longitudes of the origin outside [-360, 360], coordinates that
 * are not finite or beyond the reach of UTM, a zone outside [-60, 60], a block that is no
 * vtkPointSet: an error that names it, with an empty output. No points: empty output, silence.
 * After an abort the output is empty. The result does not depend on pieces.
 *
 * @sa vtkAvianLidarSceneReader
 */
#ifndef vtkAvianLidarGeodeticTransform_h
#define vtkAvianLidarGeodeticTransform_h

#include "vtkAvianLidarErrorsAsData.h"
#include "vtkAvianLidarModule.h" // For export macro
#include "vtkPassInputTypeAlgorithm.h"

class VTKAVIANLIDAR_EXPORT vtkAvianLidarGeodeticTransform : public vtkPassInputTypeAlgorithm
{
public:
  static vtkAvianLidarGeodeticTransform* New();
  vtkTypeMacro(vtkAvianLidarGeodeticTransform, vtkPassInputTypeAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Values of SourceFrame and TargetFrame.
  enum Frames
  {
    FRAME_ENU = 0,
    FRAME_GEODETIC = 1,
    FRAME_ECEF = 2,
    FRAME_UTM = 3
  };

  ///@{
  /**
   * The frame in which the points are given. Default FRAME_ENU.
   */
  vtkSetMacro(SourceFrame, int);
  vtkGetMacro(SourceFrame, int);
  void SetSourceFrameToENU() { this->SetSourceFrame(FRAME_ENU); }
  void SetSourceFrameToGeodetic() { this->SetSourceFrame(FRAME_GEODETIC); }
  void SetSourceFrameToECEF() { this->SetSourceFrame(FRAME_ECEF); }
  void SetSourceFrameToUTM() { this->SetSourceFrame(FRAME_UTM); }
  ///@}

  ///@{
  /**
   * The frame to which the points are moved if MovePoints is on. Default FRAME_GEODETIC.
   */
  vtkSetMacro(TargetFrame, int);
  vtkGetMacro(TargetFrame, int);
  void SetTargetFrameToENU() { this->SetTargetFrame(FRAME_ENU); }
  void SetTargetFrameToGeodetic() { this->SetTargetFrame(FRAME_GEODETIC); }
  void SetTargetFrameToECEF() { this->SetTargetFrame(FRAME_ECEF); }
  void SetTargetFrameToUTM() { this->SetTargetFrame(FRAME_UTM); }
  ///@}

  ///@{
  /**
   * Move the points to TargetFrame; otherwise only arrays are added. Default off.
   */
  vtkSetMacro(MovePoints, bool);
  vtkGetMacro(MovePoints, bool);
  vtkBooleanMacro(MovePoints, bool);
  ///@}

  ///@{
  /**
   * Take the origin from the field data `geodetic_origin` (three numbers: latitude deg, longitude
   * deg, height m) of the block or else of the whole input, instead of Origin. Default on.
   */
  vtkSetMacro(UseFieldDataOrigin, bool);
  vtkGetMacro(UseFieldDataOrigin, bool);
  vtkBooleanMacro(UseFieldDataOrigin, bool);
  ///@}

  ///@{
  /**
   * Origin of ENU, used when UseFieldDataOrigin is off: latitude within [-90, 90] and longitude
   * within [-360, 360] in degrees, height above the ellipsoid in metres. Also gives the automatic
   * zone of UTM. An origin is needed if, and only if, one of the frames in use is ENU, or UTM with
   * an automatic zone. Default (0, 0, 0).
   */
  vtkSetVector3Macro(Origin, double);
  vtkGetVector3Macro(Origin, double);
  ///@}

  ///@{
  /**
   * Zone of UTM: 1 to 60 in the northern hemisphere, -1 to -60 in the southern one (northings from
   * 10,000 km), or 0, automatic: zone and hemisphere of the origin, with the exceptions of Norway
   * and Svalbard. Default 0.
   */
  vtkSetMacro(UTMZone, int);
  vtkGetMacro(UTMZone, int);
  ///@}

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarGeodeticTransform();
  ~vtkAvianLidarGeodeticTransform() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  int SourceFrame;
  int TargetFrame;
  bool MovePoints;
  bool UseFieldDataOrigin;
  double Origin[3];
  int UTMZone;

private:
  vtkAvianLidarGeodeticTransform(const vtkAvianLidarGeodeticTransform&) = delete;
  void operator=(const vtkAvianLidarGeodeticTransform&) = delete;

  class vtkWork;
};

#endif
