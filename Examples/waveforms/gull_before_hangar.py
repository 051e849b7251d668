#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What separates a gull from the hangar wall 2 m behind it: waveforms of pulses of 5 and 3 ns, and of a Gaussian.

    gull_before_hangar.py FOLDER

Writes the scene (gull_before_hangar.lidarscene.json with gull.ply and wall.ply, for the shell and for ParaView), and
waveforms.png with one panel for each pulse. Prints the echoes of the beam that meets the gull."""
import json
import pathlib
import sys

import avianlidar as al
from avianlidar import vtkAvianLidar as vtk
from vtkmodules.vtkIOPLY import vtkPLYWriter

RANGE = 148.2  # of the gull, m, where range units separate 3 ns but not 5; the wall is 2 m behind it
HEIGHT = 4.0  # of the gull and of the lidar, m
PULSES = {"rectangle of 5 ns": {"pulse_width": 5e-9}, "rectangle of 3 ns": {"pulse_width": 3e-9},
          "Gaussian of 3 ns, response of 1 ns": {"pulse_width": 3e-9, "pulse_shape": "Gaussian", "response_time": 1e-9}}
# A searching lidar that looks north with one row of beams.
SENSOR = {"position": (0.0, 0.0, HEIGHT), "number_of_channels": 1, "minimum_elevation": 0.0, "azimuth_range": (-2, 2),
          "digitiser_rate": 1e9}


def write_ply(surface, file) -> None:
    writer = vtkPLYWriter()
    writer.SetInputData(surface)
    writer.SetFileName(str(file))
    writer.Write()


def make_scene(folder: pathlib.Path) -> pathlib.Path:
    """A scene file with a gull before the front of a hangar. @return the file"""
    gull = vtk.vtkAvianLidarBirdSource()
    gull.SetPosition(0.0, RANGE, HEIGHT)
    gull.SetHeading(90.0)
    gull.Update()
    write_ply(gull.GetOutput(), folder / "gull.ply")
    far = RANGE + 2.0
    wall = al.mesh([(-30, far, 0), (30, far, 0), (30, far, 12), (-30, far, 12)], [(0, 1, 2), (0, 2, 3)])
    write_ply(wall, folder / "wall.ply")
    objects = [{"file": "gull.ply", "name": "gull", "class": "bird", "material": "Plumage"},
               {"file": "wall.ply", "name": "hangar", "class": "hangar", "material": "Wall"}]
    file = folder / "gull_before_hangar.lidarscene.json"
    file.write_text(json.dumps({"version": 1, "lidar": {"position": [0, 0, HEIGHT]}, "objects": objects}, indent=2))
    return file


def main(folder: pathlib.Path) -> None:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    folder.mkdir(parents=True, exist_ok=True)
    scene = al.Scene(make_scene(folder))
    figure, panels = plt.subplots(len(PULSES), 1, figsize=(9, 3.2 * len(PULSES)), constrained_layout=True)
    for axes, (words, pulse) in zip(panels, PULSES.items()):
        scan = al.Scan(scene, al.Sensor("Search905", **{**SENSOR, **pulse}))
        waveforms, echoes = scan.waveforms, scan.echoes
        beams, energies = echoes["beam_id"], echoes["energy_received"]
        off = abs((scan.report["azimuth"] / 100 + 180) % 360 - 180)  # deg from north, where the gull is
        beam = int(scan.report["beam_id"][off.argmin()])
        print(f"{words}: beam {beam}")
        for i in (beams == beam).nonzero()[0]:
            name = echoes.fields["object_names"][echoes["object_id"][i]]
            print(f"  {name:7s} {echoes['distance_m'][i]:8.2f} m  {energies[i]:.2e} J  "
                  f"width {1e9 * echoes['echo_width'][i]:.1f} ns, {echoes['echo_samples'][i]} samples")
        waveforms.plot(beam, axes)
        echoes_of_beam = (beams == beam).sum()
        axes.set(title=f"{words}: {echoes_of_beam} echo{'' if echoes_of_beam == 1 else 'es'}", xlim=(RANGE - 4, RANGE + 6))
    figure.savefig(folder / "waveforms.png", dpi=110)
    print(folder / "waveforms.png")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "."))
