#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Weather over one airport, as received by Search905: echoes of surfaces, points of drops, and the range at which a
gull is seen.

    PYTHONPATH=$(cat build/paraview/python-path) /usr/bin/python3 Examples/airport/weather.py --out build/weather
"""
import argparse
import pathlib
import warnings

import numpy as np

import avianlidar as al
import tools
from avianlidar import reach
from avianlidar.vtkAvianLidar import vtkAvianLidarMedium

SCENE = pathlib.Path(__file__).resolve().parent / "scene" / "hongqiao.lidarscene.json"
SENSOR, SPECIES = "Search905", "herring gull"
WEATHER = (
    ("clear, 23 km", {"visibility": 23e3, "air_backscatter": True}),
    ("haze, 5 km", {"visibility": 5e3, "air_backscatter": True}),
    ("fog, 1 km", {"visibility": 1e3, "air_backscatter": True}),
    ("fog, 200 m", {"visibility": 200, "air_backscatter": True}),
    ("ground fog up to 5 m, 400 m", {"visibility": 23e3, "air_backscatter": True},
     {"Visibility": 400.0, "Top": 5.0, "Softness": 3.0}),
    ("rain, 1 mm/h", {"visibility": 23e3, "air_backscatter": True, "rain_rate": 1}),
    ("rain, 10 mm/h", {"visibility": 10e3, "air_backscatter": True, "rain_rate": 10}),
    ("rain, 50 mm/h", {"visibility": 5e3, "air_backscatter": True, "rain_rate": 50}),
)
SHOWN = ("clear, 23 km", "ground fog up to 5 m, 400 m", "fog, 1 km", "rain, 10 mm/h")
WIDE = 900.0  # m, half the width of the picture


def fog(properties):
    """A layer of fog."""
    source = vtkAvianLidarMedium()
    for name, value in properties.items():
        getattr(source, "Set" + name)(value)
    source.Update()
    return source.GetOutput()


def scan(scene, weather):
    sensor = al.Sensor(SENSOR, position=scene.lidar_position)
    return al.Scan(scene, sensor, **weather).echoes


def row(name, weather, echoes, layered):
    objects, away = np.array(echoes["object_id"]), np.array(echoes["distance_m"])
    air = away[objects == -2]
    to = None if layered else reach.within_beams(al.Sensor(SENSOR), SPECIES, **weather).to(0.5)
    farthest = f"{air.max():.0f} m" if len(air) else "–"
    return (name, f"{(objects >= 0).sum():,}", f"{len(air):,}", f"{(objects == -1).sum():,}", farthest,
            f"{float(f'{to:.2g}'):g} m" if to else "–")


def draw(axes, name, scene, echoes):
    objects, points = np.array(echoes["object_id"]), np.array(echoes.points)
    at = points[:, :2] - np.array(scene.lidar_position)[:2]
    axes.plot(*at[objects == -2].T, ",", color="C0")
    axes.plot(*at[objects >= 0].T, ".", color="k", markersize=1.5)
    axes.plot(0, 0, "r^", markersize=5)
    axes.set(xlim=(-WIDE, WIDE), ylim=(-WIDE, WIDE), aspect="equal")
    drops = f", {(objects == -2).sum():,} of drops" if (objects == -2).any() else ""
    axes.set_title(f"{name}\n{(objects >= 0).sum():,} echoes of surfaces{drops}", fontsize=9)
    axes.tick_params(labelsize=8)


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/weather"),
                        help="folder of the results, default build/weather")
    options = parser.parse_args(arguments)
    warnings.simplefilter("ignore", RuntimeWarning)  # some weather gives no echoes, with a warning
    clear, foggy = al.load_scene(SCENE), al.load_scene(SCENE)
    rows = []
    with tools.figure(options.out / "weather.png", 1, len(SHOWN), figsize=(14.0, 4.2), dpi=90) as panels:
        for name, weather, *layers in WEATHER:
            for layer in layers:
                foggy.add(fog(layer), name=name)
            echoes = scan(foggy if layers else clear, weather)
            rows.append(row(name, weather, echoes, layers))
            if name in SHOWN:
                draw(panels[SHOWN.index(name)], name, clear, echoes)
        panels[0].figure.supxlabel("east of the lidar, m", fontsize=9)
        panels[0].figure.supylabel("north, m", fontsize=9)
    columns = ("weather", "echoes of surfaces", "points of the air", "points of noise", "farthest point of the air",
               "range at which half of the gulls are detected")
    tools.leave(options.out, "weather-gulls", columns, rows)


if __name__ == "__main__":
    main()
