// SPDX-License-Identifier: BSD-3-Clause
// Every writer of clouds and the reader, in C++, where sanitizers look: what is written comes back,
// what goes wrong is said and leaves nothing.
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarGeoJSONWriter.h"
#include "vtkAvianLidarKITTIWriter.h"
#include "vtkAvianLidarLASWriter.h"
#include "vtkAvianLidarPCDWriter.h"
#include "vtkAvianLidarPLYWriter.h"
#include "vtkAvianLidarPointCloudReader.h"

#include "vtkCommand.h"
#include "vtkDoubleArray.h"
#include "vtkExecutive.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTestErrorObserver.h"
#include "vtkUnsignedCharArray.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <utility>

namespace
{
namespace Arrays = vtkAvianLidarArrays;

int Failures = 0;

void Check(bool good, const std::string& what)
{
  if (!good)
  {
    std::cerr << "Failed: " << what << "\n";
    ++Failures;
  }
}

bool Heard(vtkTest::ErrorObserver* observer, const std::string& words)
{
  return observer->GetErrorMessage().find(words) != std::string::npos;
}

vtkSmartPointer<vtkPolyData> Echoes(int size)
{
  auto cloud = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  auto energy = Arrays::Make<vtkDoubleArray>(Arrays::Energy, size);
  auto intensity = Arrays::Make<vtkDoubleArray>(Arrays::Intensity, size);
  auto object = Arrays::Make<vtkIntArray>(Arrays::ObjectId, size);
  auto rgb = Arrays::Make<vtkUnsignedCharArray>(Arrays::Rgb, size, 3);
  for (int i = 0; i < size; ++i)
  {
    points->InsertNextPoint(0.1 * i, 100.0 - 0.3 * i, std::sin(i));
    energy->SetValue(i, 1e-6 * (i + 1));
    intensity->SetValue(i, i % 256);
    object->SetValue(i, i % 3 - 1);
    for (int c = 0; c < 3; ++c)
    {
      rgb->SetTypedComponent(i, c, static_cast<unsigned char>(i + 50 * c));
    }
  }
  cloud->SetPoints(points);
  for (vtkDataArray* array :
    { static_cast<vtkDataArray*>(energy.Get()), static_cast<vtkDataArray*>(intensity.Get()),
      static_cast<vtkDataArray*>(object.Get()), static_cast<vtkDataArray*>(rgb.Get()) })
  {
    cloud->GetPointData()->AddArray(array);
  }
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
template <class Writer>
void CheckFile(Writer* writer, const std::string& name, double accuracy)
{
  for (const int size : { 0, 1, 40000 })
  {
    const std::string what = name + " with " + std::to_string(size) + " points";
    auto echoes = Echoes(size);
    writer->SetInputData(echoes);
    writer->SetFileName(name.c_str());
    Check(writer->Write() == 1, what + ": written");
    Check(vtkAvianLidarPointCloudReader::CanReadFile(name.c_str()) == 1, what + ": can be read");
    vtkNew<vtkAvianLidarPointCloudReader> reader;
    reader->SetFileName(name.c_str());
    reader->Update();
    vtkPolyData* cloud = reader->GetOutput();
    Check(cloud->GetNumberOfPoints() == size, what + ": number of points");
    vtkDataArray* energy = cloud->GetPointData()->GetArray("energy");
    vtkDataArray* rgb = cloud->GetPointData()->GetArray("rgb");
    bool same = cloud->GetNumberOfPoints() == size;
    for (int i = 0; same && i < size; ++i)
    {
      const double* a = cloud->GetPoint(i);
      const double at[] = { a[0], a[1], a[2] };
      const double* b = echoes->GetPoint(i);
      for (int c = 0; c < 3; ++c)
      {
        same = same && std::abs(at[c] - b[c]) <= accuracy;
        same = same &&
          (!rgb ||
            rgb->GetComponent(i, c) == echoes->GetPointData()->GetArray("rgb")->GetComponent(i, c));
      }
      same = same &&
        (!energy ||
          energy->GetComponent(i, 0) ==
            echoes->GetPointData()->GetArray("energy")->GetComponent(i, 0));
    }
    Check(same, what + ": the same echoes");
    std::remove(name.c_str());
  }
}

template <class Writer>
void CheckErrors(const std::string& name)
{
  vtkNew<Writer> writer;
  vtkNew<vtkTest::ErrorObserver> heard;
  writer->AddObserver(vtkCommand::ErrorEvent, heard);
  auto echoes = Echoes(10);
  writer->SetInputData(echoes);
  Check(writer->Write() == 0 && Heard(heard, "FileName is not set"), name + ": no name");
  writer->SetFileName(("no-such-folder/" + name).c_str());
  Check(writer->Write() == 0 && Heard(heard, "cannot be opened"), name + ": no folder");
  echoes->GetPoints()->SetPoint(7, NAN, 0.0, 0.0);
  writer->SetFileName(name.c_str());
  // There such a point is an empty cell.
  if (!writer->IsA("vtkAvianLidarPCDWriter") && !writer->IsA("vtkAvianLidarPLYWriter"))
  {
    Check(writer->Write() == 0 && Heard(heard, "point 7"), name + ": not a number");
    Check(!std::ifstream(name), name + ": nothing is left");
  }
}

void CheckGeoJson()
{
  const char* name = "TestPointCloudFiles.geojson";
  vtkNew<vtkAvianLidarGeoJSONWriter> writer;
  auto echoes = Echoes(100);
  writer->SetInputData(echoes);
  writer->SetFileName(name);
  writer->UseFieldDataLimitOff();
  writer->SetMinimumEnergy(50.5e-6);
  Check(writer->Write() == 1, "GeoJSON: written");
  std::ifstream file(name);
  std::string line;
  int features = 0;
  while (std::getline(file, line))
  {
    features += line.find("\"Feature\"") != std::string::npos;
  }
  Check(features == 50, "GeoJSON: echoes from the limit on");
  std::remove(name);
}

/// Whatever a file begins with: an error, and nothing read that is not there.
void CheckDamagedFiles()
{
  vtkNew<vtkAvianLidarLASWriter> las;
  vtkNew<vtkAvianLidarPCDWriter> pcd;
  vtkNew<vtkAvianLidarPLYWriter> ply;
  auto echoes = Echoes(20);
  const std::pair<vtkAvianLidarCloudWriter*, const char*> writers[] = { { las, "las" },
    { pcd, "pcd" }, { ply, "ply" } };
  for (const auto& [writer, ending] : writers)
  {
    const std::string name = std::string("TestPointCloudFiles-damaged.") + ending;
    writer->SetInputData(echoes);
    writer->SetFileName(name.c_str());
    writer->Write();
    std::ifstream whole(name, std::ios::binary);
    const std::string bytes(
      (std::istreambuf_iterator<char>(whole)), std::istreambuf_iterator<char>());
    whole.close();
    for (std::size_t cut = 0; cut < bytes.size(); cut += 97)
    {
      std::ofstream(name, std::ios::binary) << bytes.substr(0, cut);
      vtkNew<vtkAvianLidarPointCloudReader> reader;
      vtkNew<vtkTest::ErrorObserver> heard;
      reader->AddObserver(vtkCommand::ErrorEvent, heard);
      reader->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, heard);
      reader->SetFileName(name.c_str());
      reader->Update();
      Check(heard->GetError() && reader->GetOutput()->GetNumberOfPoints() == 0,
        name + " cut at " + std::to_string(cut));
    }
    std::remove(name.c_str());
  }
}
}

int TestPointCloudFiles(int, char*[])
{
  vtkNew<vtkAvianLidarLASWriter> las;
  CheckFile(las.Get(), "TestPointCloudFiles.las", 1e-5);
  las->SetCoordinateSystemToGeocentric();
  CheckFile(las.Get(), "TestPointCloudFiles.las", 1e-5);
  las->SetCoordinateSystemToLocal();
  CheckFile(las.Get(), "TestPointCloudFiles.las", 1e-5);
  vtkNew<vtkAvianLidarPCDWriter> pcd;
  CheckFile(pcd.Get(), "TestPointCloudFiles.pcd", 5e-4);
  pcd->SetPrecisionToDouble();
  pcd->SetFileTypeToASCII();
  CheckFile(pcd.Get(), "TestPointCloudFiles.pcd", 0.0);
  vtkNew<vtkAvianLidarPLYWriter> ply;
  CheckFile(ply.Get(), "TestPointCloudFiles.ply", 5e-4);
  ply->SetPrecisionToDouble();
  ply->SetFileTypeToASCII();
  CheckFile(ply.Get(), "TestPointCloudFiles.ply", 0.0);
  vtkNew<vtkAvianLidarKITTIWriter> kitti;
  CheckFile(kitti.Get(), "TestPointCloudFiles.bin", 5e-4);
  std::remove("TestPointCloudFiles.label");
  CheckGeoJson();
  CheckErrors<vtkAvianLidarLASWriter>("TestPointCloudFiles.las");
  CheckErrors<vtkAvianLidarPCDWriter>("TestPointCloudFiles.pcd");
  CheckErrors<vtkAvianLidarPLYWriter>("TestPointCloudFiles.ply");
  CheckErrors<vtkAvianLidarKITTIWriter>("TestPointCloudFiles.bin");
  CheckErrors<vtkAvianLidarGeoJSONWriter>("TestPointCloudFiles.geojson");
  CheckDamagedFiles();
  return Failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
