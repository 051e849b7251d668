# SPDX-License-Identifier: BSD-3-Clause
"""The look of the picture, as a macro that airport_gui.xml runs: grey surfaces, large dots, from the air."""

from paraview import simple

view = simple.GetActiveView()
tree = simple.FindSource("AvianLidarCollisionTree1")
beams = simple.FindSource("AvianLidarAirport161")
echoes = simple.FindSource("AvianLidarEchoFilter1")

simple.ColorBy(simple.GetDisplayProperties(tree, view), ("CELLS", "kd"))
grey = simple.GetColorTransferFunction("kd")
grey.ApplyPreset("Grayscale", True)
# Concrete in a middle grey: dots and legend stand out.
grey.RescaleTransferFunction(-0.05, 0.6)
simple.GetDisplayProperties(echoes, view).PointSize = 5
# The sensor.
simple.GetDisplayProperties(beams, view).PointSize = 12
# Parallel: its depth buffer tells an apron from the grass 2 cm below it.
view.CameraParallelProjection = 1
view.CameraParallelScale = 760
view.CameraPosition = [50, -4000, 4000]
view.CameraFocalPoint = [-210, -190, 0]
view.CameraViewUp = [0, 0, 1]
simple.Render(view)
