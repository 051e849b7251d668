// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkAvianLidarMedium
 * @brief Air that weakens light and sends it back, in a part of the scene: ground fog, a bank, a
 * shower, the crown of a tree.
 *
 * **Input** (optional, vtkPolyData): the closed surface that bounds the medium, for SHAPE_SURFACE,
 * in metres. **Output** (vtkPolyData): the surface that bounds the medium, to be drawn translucent:
 * a box, an ellipsoid, and of a layer or of air everywhere a box of DisplaySize. Its field data
 * make it a medium for whatever looks at surfaces (echo filter, coverage, collision tree), where it
 * is no surface: combine it with the scene by Group Datasets. `medium` is its description (text,
 * JSON: kind, numbers, shape), `object_names` its Name, `object_classes` "air", or "vegetation" of
 * foliage.
 *
 * Numbers follow from Kind and one quantity:
 *
 * - KIND_HAZE, KIND_FOG: Visibility (Koschmieder; at the lidar's wavelength by the law of Kruse and
 *   Kim), extinction-to-backscatter ratio 50 and 18.8 sr
 * - KIND_DRIZZLE, KIND_RAIN: RainRate (Joss et al. 1968; Marshall and Palmer 1948), 20 sr, drops
 *   that are few
 * - KIND_SNOW: Visibility, 20 sr, flakes
 * - KIND_FOLIAGE: LeafAreaDensity; leaves are Lambertian discs and face all ways; light comes back
 *   through the gaps that let it in, as far as these are wider than the aperture; no threshold
 *   follows it, and its echoes belong to an object
 * - KIND_CUSTOM: Extinction and BackscatterRatio, beyond number
 *
 * Sources of all numbers, and which are assumed, stand in Filters/Media/media.json and
 * Documentation/weather.md.
 *
 * **Bad values** are an error that names the key of the description, with empty output; setters
 * keep what they are given. An open surface is an error; its triangles may be wound either way.
 * Each rank asks for all of the surface, as a piece of it is open.
 *
 * @sa vtkAvianLidarEchoFilter, vtkAvianLidarCoverage, vtkAvianLidarSceneReader
 */
#ifndef vtkAvianLidarMedium_h
#define vtkAvianLidarMedium_h

#include "vtkAvianLidarErrorsAsData.h"
#include "vtkAvianLidarModule.h" // For export macro
#include "vtkPolyDataAlgorithm.h"

#include <string> // For std::string

class VTKAVIANLIDAR_EXPORT vtkAvianLidarMedium : public vtkPolyDataAlgorithm
{
public:
  static vtkAvianLidarMedium* New();
  vtkTypeMacro(vtkAvianLidarMedium, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Values of Kind.
  enum Kinds
  {
    KIND_HAZE = 0,
    KIND_FOG = 1,
    KIND_DRIZZLE = 2,
    KIND_RAIN = 3,
    KIND_SNOW = 4,
    KIND_FOLIAGE = 5,
    KIND_CUSTOM = 6
  };

  /// Values of Shape.
  enum Shapes
  {
    SHAPE_EVERYWHERE = 0,
    SHAPE_LAYER = 1,
    SHAPE_BOX = 2,
    SHAPE_ELLIPSOID = 3,
    SHAPE_SURFACE = 4
  };

  ///@{
  /**
   * What fills the air; see above. Default KIND_FOG.
   */
  vtkSetMacro(Kind, int);
  vtkGetMacro(Kind, int);
  void SetKindToHaze() { this->SetKind(KIND_HAZE); }
  void SetKindToFog() { this->SetKind(KIND_FOG); }
  void SetKindToDrizzle() { this->SetKind(KIND_DRIZZLE); }
  void SetKindToRain() { this->SetKind(KIND_RAIN); }
  void SetKindToSnow() { this->SetKind(KIND_SNOW); }
  void SetKindToFoliage() { this->SetKind(KIND_FOLIAGE); }
  void SetKindToCustom() { this->SetKind(KIND_CUSTOM); }
  ///@}

  ///@{
  /**
   * Meteorological visibility in haze, fog or snow, m, 0.001 to 1e9. Default 300.
   */
  vtkSetMacro(Visibility, double);
  vtkGetMacro(Visibility, double);
  ///@}

  ///@{
  /**
   * Of rain or drizzle, mm/h, 1e-6 to 500. Default 10.
   */
  vtkSetMacro(RainRate, double);
  vtkGetMacro(RainRate, double);
  ///@}

  ///@{
  /**
   * One-sided leaf area for each volume, m2/m3, 1e-6 to 1000. Crowns have some 0.3 to 3. Default 1
   * (assumed).
   */
  vtkSetMacro(LeafAreaDensity, double);
  vtkGetMacro(LeafAreaDensity, double);
  ///@}

  ///@{
  /**
   * mu, 1/m, 0 to 1e30, of KIND_CUSTOM. Default 0.01.
   */
  vtkSetMacro(Extinction, double);
  vtkGetMacro(Extinction, double);
  ///@}

  ///@{
  /**
   * S, extinction over backscatter, sr, 0.001 to 1e9, of KIND_CUSTOM. Default 18.8.
   */
  vtkSetMacro(BackscatterRatio, double);
  vtkGetMacro(BackscatterRatio, double);
  ///@}

  ///@{
  /**
   * Share of the drops or leaves that are others from scan to scan, 0 to 1; -1: as the kind has it
   * (1 of drops and flakes, 0.3 of leaves, assumed). Haze and fog have none. Default -1.
   */
  vtkSetMacro(RenewedShare, double);
  vtkGetMacro(RenewedShare, double);
  ///@}

  ///@{
  /**
   * Where the medium is: SHAPE_EVERYWHERE; SHAPE_LAYER between Bottom and Top, and fading above by
   * Softness; SHAPE_BOX and SHAPE_ELLIPSOID of Lengths about Center, turned by Heading;
   * SHAPE_SURFACE inside the closed surface of the input. Default SHAPE_LAYER.
   */
  vtkSetMacro(Shape, int);
  vtkGetMacro(Shape, int);
  void SetShapeToEverywhere() { this->SetShape(SHAPE_EVERYWHERE); }
  void SetShapeToLayer() { this->SetShape(SHAPE_LAYER); }
  void SetShapeToBox() { this->SetShape(SHAPE_BOX); }
  void SetShapeToEllipsoid() { this->SetShape(SHAPE_ELLIPSOID); }
  void SetShapeToSurface() { this->SetShape(SHAPE_SURFACE); }
  ///@}

  ///@{
  /**
   * Heights of a layer, m, finite, Bottom below Top. Default -1000 and 20.
   */
  vtkSetMacro(Bottom, double);
  vtkGetMacro(Bottom, double);
  vtkSetMacro(Top, double);
  vtkGetMacro(Top, double);
  ///@}

  ///@{
  /**
   * Height over which a layer fades to 1/e above its top, m, 0 to 1e6; 0: it ends there. Default 5.
   */
  vtkSetMacro(Softness, double);
  vtkGetMacro(Softness, double);
  ///@}

  ///@{
  /**
   * Middle of a box or an ellipsoid, m (x east, y north, z up). Default (0, 0, 0).
   */
  vtkSetVector3Macro(Center, double);
  vtkGetVector3Macro(Center, double);
  ///@}

  ///@{
  /**
   * Whole lengths of a box or an ellipsoid, m, 2e-6 to 2e7. Default (100, 100, 20).
   */
  vtkSetVector3Macro(Lengths, double);
  vtkGetVector3Macro(Lengths, double);
  ///@}

  ///@{
  /**
   * Direction in which the second of the Lengths points, degrees from north (y), clockwise. Default
   * 0.
   */
  vtkSetMacro(Heading, double);
  vtkGetMacro(Heading, double);
  ///@}

  ///@{
  /**
   * Velocity of the medium, m/s; it is where the other properties say at the time 0 of the beams.
   * Default (0, 0, 0).
   */
  vtkSetVector3Macro(Velocity, double);
  vtkGetVector3Macro(Velocity, double);
  ///@}

  ///@{
  /**
   * Name of the medium, in messages, and of foliage among the objects; empty: that of its block, as
   * of any surface. Default "medium".
   */
  vtkSetMacro(Name, std::string);
  vtkGetMacro(Name, std::string);
  ///@}

  ///@{
  /**
   * Side, m, of what is drawn of a layer or of air everywhere. More than 0, default 2000.
   */
  vtkSetMacro(DisplaySize, double);
  vtkGetMacro(DisplaySize, double);
  ///@}

  vtkAvianLidarErrorsAsDataMacro();

protected:
  vtkAvianLidarMedium();
  ~vtkAvianLidarMedium() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  int Kind = KIND_FOG;
  double Visibility = 300.0;
  double RainRate = 10.0;
  double LeafAreaDensity = 1.0;
  double Extinction = 0.01;
  double BackscatterRatio = 18.8;
  double RenewedShare = -1.0;
  int Shape = SHAPE_LAYER;
  double Bottom = -1000.0;
  double Top = 20.0;
  double Softness = 5.0;
  double Center[3] = { 0.0, 0.0, 0.0 };
  double Lengths[3] = { 100.0, 100.0, 20.0 };
  double Heading = 0.0;
  double Velocity[3] = { 0.0, 0.0, 0.0 };
  std::string Name = "medium";
  double DisplaySize = 2000.0;

private:
  vtkAvianLidarMedium(const vtkAvianLidarMedium&) = delete;
  void operator=(const vtkAvianLidarMedium&) = delete;

  std::string Description() const;
};

#endif
