# SPDX-License-Identifier: BSD-3-Clause
"""In a program of ParaView, or connected to the pvserver of the arguments: is the plugin of the package listed and
loaded, and does it scan, without LoadPlugin()?"""
import glob
import os
import runpy
import sys

from paraview import servermanager, simple

if len(sys.argv) > 2:
    simple.Connect(sys.argv[1], int(sys.argv[2]))
manager = servermanager.vtkSMProxyManager.GetProxyManager().GetPluginManager()
session = servermanager.ActiveConnection.Session
information = manager.GetRemoteInformation(session) if len(sys.argv) > 2 else manager.GetLocalInformation()
plugins = {information.GetPluginName(i): information.GetPluginLoaded(i)
           for i in range(information.GetNumberOfPlugins())}
loaded = plugins.pop("AvianLidarPlugin")

(folder,) = glob.glob("/usr/lib/paraview-*/plugins/AvianLidarPlugin")
scene = simple.AvianLidarSceneReader(FileName=f"{folder}/Scenes/hongqiao.lidarscene.json")
echoes = simple.AvianLidarEchoFilter(Beams=simple.AvianLidarAirport16(), Surfaces=scene, RaysPerBeam=10)
echoes.UpdatePipeline()
number = echoes.GetDataInformation().GetNumberOfPoints()
if len(sys.argv) <= 2 and os.environ["DISPLAY"]:
    runpy.run_path(f"{folder}/States/avian_lidar_airport.py")
    assert simple.FindSource("Scan").GetDataInformation().GetNumberOfPoints() >= 1000

others = len([name for name in plugins if not name.startswith("vtkPV")])
line = f"AvianLidarPlugin {'loaded' if loaded else 'listed'}, {'1000 echoes or more' if number >= 1000 else number}, "
os.write(1, f"{line}{others} others listed\n".encode())
os._exit(0)  # ParaView's window would stay
