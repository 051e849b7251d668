// SPDX-License-Identifier: BSD-3-Clause
// Writers of clouds and the reader, in C++, where sanitizers look: what is written comes back.
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCloudWriter.h"
#include "vtkAvianLidarKITTIWriter.h"
#include "vtkAvianLidarLASWriter.h"
#include "vtkAvianLidarPCDWriter.h"
#include "vtkAvianLidarPLYWriter.h"
#include "vtkAvianLidarPointCloudReader.h"

#include "Checks.h"
#include "vtkDoubleArray.h"
#include "vtkIntArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"

#include <cmath>
#include <string>

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using checks::At;
using checks::Check;

vtkSmartPointer<vtkPolyData> Echoes(int size)
{
  auto cloud = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  auto energy = Arrays::Make<vtkDoubleArray>(Arrays::Energy, size);
  auto object = Arrays::Make<vtkIntArray>(Arrays::ObjectId, size);
  auto rgb = Arrays::Make<vtkUnsignedCharArray>(Arrays::Rgb, size, 3);
  for (int i = 0; i < size; ++i)
  {
    points->InsertNextPoint(0.1 * i, 100.0 - 0.3 * i, std::sin(i));
    energy->SetValue(i, 1e-6 * (i + 1));
    object->SetValue(i, i % 3 - 1);
    rgb->SetTuple3(i, i % 256, (i + 50) % 256, (i + 100) % 256);
  }
  cloud->SetPoints(points);
  cloud->GetPointData()->AddArray(energy);
  cloud->GetPointData()->AddArray(object);
  cloud->GetPointData()->AddArray(rgb);
  auto origin = Arrays::Make<vtkDoubleArray>(Arrays::GeodeticOrigin, 1, 3);
  origin->SetTuple3(0, 31.0, 121.0, 3.0);
  cloud->GetFieldData()->AddArray(origin);
  auto position = Arrays::Make<vtkDoubleArray>(Arrays::Position, 1, 3);
  position->SetTuple3(0, 0.0, 0.0, 0.0);
  cloud->GetFieldData()->AddArray(position);
  Arrays::SetFieldStrings(cloud->GetFieldData(), Arrays::ObjectClasses, { "runway", "hangar" });
  return cloud;
}

/// What is written comes back: places to the given accuracy, energies and colours as they were.
void CheckFile(vtkAvianLidarCloudWriter* writer, const std::string& name, double accuracy)
{
  for (const int size : { 0, 1, 40000 })
  {
    const std::string what = name + " with " + std::to_string(size) + " points";
    auto echoes = Echoes(size);
    writer->SetInputData(echoes);
    writer->SetFileName(name.c_str());
    Check(writer->Write() == 1, what + ": written");
    vtkNew<vtkAvianLidarPointCloudReader> reader;
    reader->SetFileName(name.c_str());
    reader->Update();
    vtkPolyData* cloud = reader->GetOutput();
    bool same = cloud->GetNumberOfPoints() == size;
    for (int i = 0; same && i < size; ++i)
    {
      for (int c = 0; c < 3; ++c)
      {
        same = same && std::abs(cloud->GetPoint(i)[c] - echoes->GetPoint(i)[c]) <= accuracy;
        for (const char* name : { "energy", "rgb" })
        {
          const double value = At(cloud->GetPointData(), name, i, c);
          same = same && (std::isnan(value) || value == At(echoes->GetPointData(), name, i, c));
        }
      }
    }
    Check(same, what + ": the same echoes");
  }
}
}

int TestPointCloudFiles(int, char*[])
{
  vtkNew<vtkAvianLidarLASWriter> las;
  vtkNew<vtkAvianLidarPCDWriter> pcd;
  vtkNew<vtkAvianLidarPLYWriter> ply;
  vtkNew<vtkAvianLidarKITTIWriter> kitti;
  const std::string stem = "TestPointCloudFiles.";
  CheckFile(las, stem + "las", 1e-5);
  las->SetCoordinateSystemToGeocentric();
  CheckFile(las, stem + "las", 1e-5);
  CheckFile(pcd, stem + "pcd", 5e-4);
  pcd->SetPrecisionToDouble();
  pcd->SetFileTypeToASCII();
  CheckFile(pcd, stem + "pcd", 0.0);
  CheckFile(ply, stem + "ply", 5e-4);
  ply->SetPrecisionToDouble();
  ply->SetFileTypeToASCII();
  CheckFile(ply, stem + "ply", 0.0);
  CheckFile(kitti, stem + "bin", 5e-4);
  std::remove((stem + "label").c_str());
  return checks::Result();
}
